//! Heidenhain Klartext.
//!
//! - Tool-centre-point control is `FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS`: F at the tip, rotary axes interpolate
//!   linearly. `FUNCTION RESET TCPM` turns it off.
//! - Directions of the tool are `LN X Y Z TX TY TZ`, with `FUNCTION TCPM` on.
//! - `PLANE SPATIAL ... STAY` tilts the working plane without motion: the program positions the rotary axes before.
//! - Every position carries a sign; `FMAX` holds for its own block only.
//! - `CYCL DEF 32` bounds what smoothing may do to the path (finishing); without a value it is off.
//! - `PLANE RESET STAY` at the start deletes a tilted plane that an aborted program may have left.
//! - `M126` makes endless axes take the shortest way. There is no inverse time feed. `M91` is machine coordinates.

use super::Dialect;
use super::block::{FeedWord, NcMove, Program, RotaryName, WriteError};
use super::lines::Lines;
use super::modal::{Modal, Position, Which, Wording};
use super::number;

pub(super) const WORDING: Wording =
    Wording { rapid: "L", feed: "L", modal: false, axis, rotary, vector: (["TX", "TY", "TZ"], true) };

/// Lines that say the direction of the tool.
pub(super) const DIRECTED: Wording = Wording { rapid: "LN", feed: "LN", ..WORDING };

fn axis(text: &mut String, name: &str, position: Position) {
    text.push_str(name);
    if position.counts >= 0 {
        text.push('+');
    }
    number::push_rounded(text, position.counts, position.decimals);
}

/// A position with all decimals.
fn signed(name: &str, counts: i64) -> String {
    let mut text = String::new();
    axis(&mut text, name, Position { counts, decimals: number::DECIMALS });
    text
}

fn rotary(text: &mut String, name: &RotaryName, counts: i64) {
    axis(text, &name.letter, Position::of(name, counts));
}

pub(super) fn head(program: &Program, lines: &mut Lines) -> Result<(), WriteError> {
    program.single_letters("heidenhain")?;
    if program.feed_word == FeedWord::Inverse {
        return Err(WriteError::Feed { dialect: "heidenhain", what: "inverse time feed (G93)" });
    }
    let work_offset = program.work_offset_words(Dialect::Heidenhain)?;
    (lines.numbered, lines.step) = (Some(""), 1);
    lines.line(&format!("BEGIN PGM {} MM", program.safe_name()));
    if let Some([least, most]) = program.blank {
        let corner = |p: [i64; 3]| {
            ["X", "Y", "Z"].into_iter().zip(p).map(|(n, c)| signed(n, c)).collect::<Vec<_>>().join(" ")
        };
        lines.line(&format!("BLK FORM 0.1 Z {}", corner(least)));
        lines.line(&format!("BLK FORM 0.2 {}", corner(most)));
    }
    for comment in program.safe_comments() {
        lines.line(&format!("; {comment}"));
    }
    lines.line("FUNCTION RESET TCPM");
    if !program.rotary_names.is_empty() {
        lines.line("PLANE RESET STAY");
    }
    lines.line("M126");
    work_offset.iter().for_each(|words| lines.line(words));
    if let Some(z) = program.retract {
        lines.line(&format!("L {} R0 FMAX M91", signed("Z", z)));
    }
    call(program, lines);
    Ok(())
}

/// The tool into the spindle, which stands where the machine changes tools.
fn call(program: &Program, lines: &mut Lines) {
    let speed = program.spindle_rpm.map_or(String::new(), |rpm| format!(" S{}", number::feed(rpm)));
    lines.line(&format!("TOOL CALL {} Z{speed}", program.tool_number));
    program.next_tool.iter().for_each(|next| lines.line(&format!("TOOL DEF {next}")));
    if program.spindle_rpm.is_some() {
        lines.line(program.spindle_word());
    }
    if let Some(coolant) = program.coolant {
        lines.line(coolant.word());
    }
}

/// From what one program says to what the next one does with another tool.
pub(super) fn next(before: &Program, program: &Program, lines: &mut Lines) -> Result<(), WriteError> {
    let work_offset = program.work_offset_words(Dialect::Heidenhain)?;
    leave(before, lines);
    program.safe_comments().iter().for_each(|comment| lines.line(&format!("; {comment}")));
    if program.work_offset != before.work_offset {
        work_offset.iter().for_each(|words| lines.line(words));
    }
    call(program, lines);
    Ok(())
}

pub(super) fn first(program: &Program, modal: &mut Modal, first: &NcMove, lines: &mut Lines) {
    let mut approach = |lines: &mut Lines, which: &[Which]| {
        for words in modal.approach(program, &WORDING, first, which) {
            lines.line(&format!("{words} FMAX"));
        }
    };
    approach(lines, &[Which::Rotary]);
    if program.tcp {
        let axis = if program.in_vectors() { "SPAT" } else { "POS" };
        let way = if program.in_vectors() { "VECTOR" } else { "AXIS" };
        lines.line(&format!("FUNCTION TCPM F TCP AXIS {axis} PATHCTRL {way}"));
    }
    if program.in_planes() {
        lines.line(&plane(first));
    }
    approach(lines, &[Which::Across, Which::Along]);
    lines.line("CYCL DEF 32.0 TOLERANCE");
    lines.line(&format!("CYCL DEF 32.1 T{:.4}", program.blend_mm));
    lines.line("CYCL DEF 32.2 HSC-MODE:0");
}

fn plane(m: &NcMove) -> String {
    let mut text = String::from("PLANE SPATIAL");
    for (name, c) in ["SPA", "SPB", "SPC"].iter().zip(m.orientation) {
        text.push(' ');
        text.push_str(&signed(name, c));
    }
    text + " STAY"
}

/// Goes from one plane to another: away in machine coordinates, rotary axes, plane, back.
pub(super) fn next_plane(program: &Program, modal: &mut Modal, m: &NcMove, lines: &mut Lines) {
    lines.line("PLANE RESET STAY");
    if let Some(z) = program.retract {
        lines.line(&format!("L {} R0 FMAX M91", signed("Z", z)));
    }
    modal.forget();
    let mut approach = |lines: &mut Lines, which: &[Which]| {
        for words in modal.approach(program, &WORDING, m, which) {
            lines.line(&format!("{words} FMAX"));
        }
    };
    approach(lines, &[Which::Rotary]);
    lines.line(&plane(m));
    approach(lines, &[Which::Across, Which::Along]);
}

pub(super) fn tail(program: &Program, lines: &mut Lines) {
    leave(program, lines);
    lines.line("M30");
    lines.line(&format!("END PGM {} MM", program.safe_name()));
}

/// Away from the part, with everything off.
fn leave(program: &Program, lines: &mut Lines) {
    if program.cools {
        lines.line("M9");
    }
    lines.line("M5");
    lines.line("CYCL DEF 32.0 TOLERANCE");
    lines.line("CYCL DEF 32.1");
    if program.in_planes() {
        lines.line("PLANE RESET STAY");
    }
    lines.line("FUNCTION RESET TCPM");
    if let Some(z) = program.retract {
        lines.line(&format!("L {} R0 FMAX M91", signed("Z", z)));
    }
}
