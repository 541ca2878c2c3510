//! A CL text posted tool by tool and read back: do the tools make the moves that the text asks for?

use std::io::Cursor;
use std::ops::ControlFlow;

use osculate_postproc::cldata::{ClOutline, ClReadOptions, ClStream};
use osculate_postproc::readback::{ReadBack, ReadMove, ReadOptions, read_tools};
use osculate_postproc::source::MoveSource;
use osculate_postproc::{
    Dialect, FeedMode, Machine, PostOptions, Section, SectionError, Setup, Spindle, built_in_text,
    post_sections_to,
};
use osculate_tools::Cutter;
use osculate_tools::cl::{ClMove, Motion};

/// Points come back within this, mm.
const TIP_MM: f64 = 0.002;

/// What became of a text.
pub struct Posted {
    pub outline: ClOutline,
    /// The moves of each section.
    pub moves: Vec<Vec<ClMove>>,
    pub text: String,
    pub back: ReadBack,
}

/// Posts a text and reads it back.
pub fn posted(
    text: &str,
    machine: &Machine,
    dialect: Dialect,
    feed: FeedMode,
) -> Result<Posted, SectionError> {
    posted_so(text, machine, (dialect, feed), false)
}

/// As [`posted`], with the next tool put ready.
pub fn posted_ready(
    text: &str,
    machine: &Machine,
    dialect: Dialect,
    feed: FeedMode,
) -> Result<Posted, SectionError> {
    posted_so(text, machine, (dialect, feed), true)
}

fn posted_so(
    text: &str,
    machine: &Machine,
    (dialect, feed): (Dialect, FeedMode),
    preselect: bool,
) -> Result<Posted, SectionError> {
    let options = ClReadOptions { cutcom_is_centre: true, ..ClReadOptions::default() };
    let cl = ClStream::new(|| Ok(Cursor::new(text.as_bytes())), options);
    let outline = cl.outline().expect("CL data");
    let parts = cl.parts(&outline);
    let mut moves = Vec::new();
    let mut sections = Vec::new();
    let mut lengths = Vec::new();
    for (part, section) in parts.iter().zip(&outline.sections) {
        let mut own = Vec::new();
        let mut take = |piece: &[ClMove]| {
            own.extend_from_slice(piece);
            ControlFlow::Continue(())
        };
        part.pieces(100, &mut take).expect("it can be read again");
        assert_eq!(own.len(), section.moves, "the outline counts what the part gives");
        moves.push(own);
        let cutter = section.tool.cutter.and_then(|c| Cutter::try_from(c).ok());
        let gauge_length_mm = cutter.map_or(0.0, |c| c.length_mm());
        let tool_number = section.tool.number.unwrap_or(1);
        lengths.push((tool_number, gauge_length_mm));
        let options = PostOptions {
            tool_number,
            spindle_rpm: section.tool.spindle.and_then(Spindle::rpm),
            counter_clockwise: matches!(section.tool.spindle, Some(Spindle::Counter { .. })),
            coolant: section.tool.coolant,
            auxiliary: section.auxiliary.clone(),
            preselect,
            ..PostOptions::new(dialect, feed)
        };
        sections.push(Section {
            name: format!("line {}", section.line),
            path: part,
            gauge_length_mm,
            options,
        });
    }
    let setup = Setup::default();
    let mut bytes = Vec::new();
    post_sections_to(&sections, machine, &setup, &mut bytes)?;
    let text = String::from_utf8(bytes).expect("text");
    let back = read_tools(&text, dialect, machine, (&setup, &lengths), &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{dialect}: {e}"));
    Ok(Posted { outline, moves, text, back })
}

impl Posted {
    /// What is read of each call of a tool, without retracts.
    fn calls(&self) -> Vec<Vec<ReadMove>> {
        let mut calls: Vec<(Option<u32>, Vec<ReadMove>)> = Vec::new();
        for m in self.back.moves.iter().filter(|m| !m.own_frame) {
            match calls.last_mut() {
                Some((tool, own)) if *tool == m.tool => own.push(*m),
                _ => calls.push((m.tool, vec![*m])),
            }
        }
        calls.into_iter().map(|c| c.1).collect()
    }

    /// Where the moves read back are not those of the text.
    pub fn difference(&self) -> Option<String> {
        self.worst_mm().err()
    }

    /// How far points come back off those of the text, mm; else where they do not.
    pub fn worst_mm(&self) -> Result<f64, String> {
        let calls = self.calls();
        let mut worst = 0.0f64;
        if calls.len() != self.moves.len() {
            return Err(format!("{} tools are called, {} are asked for", calls.len(), self.moves.len()));
        }
        for (k, (want, got)) in self.moves.iter().zip(&calls).enumerate() {
            let number = self.outline.sections[k].tool.number.unwrap_or(1);
            if got.iter().any(|m| m.tool != Some(number)) {
                return Err(format!("section {k} is made with {:?}, not with tool {number}", got[0].tool));
            }
            let mut at = 0;
            for (i, m) in want.iter().enumerate() {
                let near = |r: &ReadMove| {
                    (r.pose.tip - m.pose.tip).norm() <= TIP_MM
                        && r.pose.axis.dot(&m.pose.axis) > 1.0 - 1e-9
                        && (i == 0
                            || (r.motion == Motion::Rapid) == (m.motion == Motion::Rapid)
                            || r.time_min == 0.0)
                };
                // A point that is where the one before was has no block of its own.
                let stays = i > 0 && (m.pose.tip - want[i - 1].pose.tip).norm() <= TIP_MM;
                match got[at..].iter().position(near) {
                    Some(hit) => {
                        at += hit;
                        worst = worst.max((got[at].pose.tip - m.pose.tip).norm());
                    }
                    None if stays => {}
                    None => return Err(format!("section {k}: move {i} to {} is not met", m.pose.tip)),
                }
            }
            let length =
                |ends: &mut dyn Iterator<Item = (osculate_geom::Point3, osculate_geom::Point3, Motion)>| {
                    ends.filter(|e| e.2 != Motion::Rapid).map(|e| (e.1 - e.0).norm()).sum::<f64>()
                };
            let wanted = length(&mut want.windows(2).map(|w| (w[0].pose.tip, w[1].pose.tip, w[1].motion)));
            let made = length(&mut got.windows(2).map(|w| (w[0].pose.tip, w[1].pose.tip, w[1].motion)));
            if (made - wanted).abs() > TIP_MM + 1e-3 * wanted {
                return Err(format!(
                    "section {k}: {made:.4} mm are made at feed, {wanted:.4} mm are asked for"
                ));
            }
        }
        Ok(worst)
    }
}

/// A mill whose table turns about X without end: four axes, which reach both sides of a board.
pub fn four_axes() -> Machine {
    let text = built_in_text("3-axis").expect("a built-in machine");
    let turning = "[[joint]]\nkind = \"rotary\"\nletter = \"A\"\nside = \"table\"\ndirection = [1, 0, 0]\n\
        max_velocity_deg_s = 180\nmax_acceleration_deg_s2 = 1000\n\n[[joint]]\n";
    let mut text = text.replacen("[[joint]]\n", turning, 1).replace("\"3-axis\"", "\"4-axis\"");
    for limit in ["300", "400", "500"] {
        text = text
            .replace(&format!("_mm = {limit}"), "_mm = 1000")
            .replace(&format!("_mm = -{limit}"), "_mm = -1000");
    }
    Machine::from_toml(&text).expect("a machine")
}
