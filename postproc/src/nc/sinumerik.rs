//! Siemens Sinumerik 840D.
//!
//! - Tool-centre-point control is `TRAORI`; `ORIMKS` and `ORIAXES` make the rotary axes interpolate linearly.
//! - Directions of the tool are `A3= B3= C3=`: with `ORIWKS` in the axes of X Y Z, with `ORIVECT` the tool goes on a great
//!   circle from one to the next.
//! - Tilted planes are `CYCLE800` without motion of its own (direction 0): the program positions the rotary axes.
//! - With a subprogram the text is an archive: `%_N_NAME_MPF` is the main program with everything around the moves, it
//!   calls `NAME_WAY`, and `%_N_NAME_WAY_SPF` holds the moves and ends with `M17`.
//! - Endless axes are modulo axes: `C=DC(...)` takes the shortest way, so no block turns one by half a turn or more.
//! - F is read over the axes of `FGROUP`, a rotary one as an arc of radius `FGREF`: the program says both, so that it
//!   does not depend on machine data. Rotary axes alone, outside of `FGROUP`, are read in deg/min.
//! - `G93` wants F in every block; switching between G93 and G94 deletes F.
//! - `CYCLE832` bounds what the control's compressor and smoothing may do to the path (finishing), and is off at the end.
//! - `TRANS` at the start deletes programmed frames that an aborted program may have left.
//! - `SUPA` with `D0` moves in machine coordinates without tool length, to where the machine's file has Z out of the way.

use super::Dialect;
use super::block::{FeedWord, NcMove, Program, RotaryName, WriteError};
use super::lines::Lines;
use super::modal::{Modal, Position, Which, Wording, plain};
use super::number;
use crate::feed::PathMetric;

pub(super) const WORDING: Wording = Wording {
    rapid: "G0",
    feed: "G1",
    modal: true,
    axis: plain,
    rotary,
    vector: (["A3=", "B3=", "C3="], false),
};

fn rotary(text: &mut String, name: &RotaryName, counts: i64) {
    if name.endless {
        text.push_str(&name.letter);
        text.push_str("=DC(");
        let position = Position::of(name, counts);
        number::push_rounded(text, position.counts, position.decimals);
        text.push(')');
    } else {
        plain(text, &name.letter, Position::of(name, counts));
    }
}

pub(super) fn head(program: &Program, lines: &mut Lines) -> Result<(), WriteError> {
    let work_offset = program.work_offset_words(Dialect::Sinumerik)?;
    (lines.numbered, lines.next, lines.step) = (Some("N"), 10, 10);
    if program.subprogram {
        lines.plain(&format!("%_N_{}_MPF", program.safe_name()));
    }
    lines.plain(&format!("; {}", program.safe_name()));
    for line in program.safe_comments() {
        lines.plain(&format!("; {line}"));
    }
    lines.line("G17 G40 G64 G90 G94 G710");
    lines.line("TRAFOOF");
    lines.line("TRANS");
    retract(lines, program);
    call(program, work_offset.as_deref(), lines);
    Ok(())
}

/// The tool into the spindle, which stands where the machine changes tools.
fn call(program: &Program, work_offset: Option<&str>, lines: &mut Lines) {
    lines.line(&format!("T{}", program.tool_number));
    lines.line("M6");
    lines.line("D1");
    program.next_tool.iter().for_each(|next| lines.line(&format!("T{next}")));
    work_offset.iter().for_each(|words| lines.line(words));
    if let Some(rpm) = program.spindle_rpm {
        lines.line(&format!("S{} {}", number::feed(rpm), program.spindle_word()));
    }
    if let Some(coolant) = program.coolant {
        lines.line(coolant.word());
    }
}

/// From what one program says to what the next one does with another tool.
pub(super) fn next(before: &Program, program: &Program, lines: &mut Lines) -> Result<(), WriteError> {
    if before.subprogram || program.subprogram {
        return Err(WriteError::Sections { dialect: "sinumerik" });
    }
    let work_offset = program.work_offset_words(Dialect::Sinumerik)?;
    leave(before, lines);
    program.safe_comments().iter().for_each(|line| lines.plain(&format!("; {line}")));
    call(program, work_offset.as_deref(), lines);
    Ok(())
}

pub(super) fn first(program: &Program, modal: &mut Modal, first: &NcMove, lines: &mut Lines) {
    for line in modal.approach(program, &WORDING, first, &[Which::Rotary]) {
        lines.line(&line);
    }
    if program.tcp {
        lines.line("TRAORI");
        lines.line(if program.in_vectors() { "ORIWKS ORIVECT" } else { "ORIMKS ORIAXES" });
        // Its head has refused what has no words.
        program
            .work_offset_words(Dialect::Sinumerik)
            .into_iter()
            .flatten()
            .for_each(|words| lines.line(&words));
    }
    if program.in_planes() {
        lines.line(&plane(first));
    }
    for line in modal.approach(program, &WORDING, first, &[Which::Across, Which::Along]) {
        lines.line(&line);
    }
    lines.line(&format!("CYCLE832({:.4},1,1)", program.blend_mm));
    feed_head(lines, program);
    if program.subprogram {
        // The main program is complete before its moves: nothing has to be held back.
        let name = format!("{}_WAY", program.safe_name());
        lines.line(&name);
        end(program, lines);
        lines.plain(&format!("%_N_{name}_SPF"));
        lines.next = 10;
    }
}

/// `CYCLE800(retract, data set, new plane, mode, X0 Y0 Z0, A B C, X1 Y1 Z1, direction)`.
fn plane(m: &NcMove) -> String {
    let [a, b, c] = m.orientation.map(number::fixed);
    format!("CYCLE800(0,\"\",0,57,0,0,0,{a},{b},{c},0,0,0,0)")
}

/// Goes from one plane to another: away in machine coordinates, rotary axes, plane, back.
pub(super) fn next_plane(program: &Program, modal: &mut Modal, m: &NcMove, lines: &mut Lines) {
    retract(lines, program);
    lines.line("D1");
    modal.forget();
    modal.approach(program, &WORDING, m, &[Which::Rotary]).iter().for_each(|l| lines.line(l));
    lines.line(&plane(m));
    modal.approach(program, &WORDING, m, &[Which::Across, Which::Along]).iter().for_each(|l| lines.line(l));
}

pub(super) fn tail(program: &Program, lines: &mut Lines) {
    if program.subprogram {
        lines.line("M17");
    } else {
        end(program, lines);
    }
}

fn end(program: &Program, lines: &mut Lines) {
    leave(program, lines);
    lines.line("M30");
}

/// Away from the part, with everything off.
fn leave(program: &Program, lines: &mut Lines) {
    if program.feed_word == FeedWord::Inverse {
        lines.line("G94");
    }
    if program.cools {
        lines.line("M9");
    }
    lines.line("M5");
    lines.line("CYCLE832()");
    if program.in_planes() {
        lines.line("CYCLE800()");
    }
    lines.line("TRAFOOF");
    retract(lines, program);
}

fn retract(lines: &mut Lines, program: &Program) {
    if let Some(z) = program.retract {
        lines.line(&format!("G0 SUPA Z{} D0", number::plain(z)));
    }
}

fn feed_head(lines: &mut Lines, program: &Program) {
    let names = |linear: bool, rotary: bool| {
        let linear = program.linear_names.iter().filter(|_| linear);
        let rotary = program.rotary_names.iter().map(|r| &r.letter).filter(|_| rotary);
        let mut all: Vec<&str> = linear.chain(rotary).map(String::as_str).collect();
        all.sort_unstable_by_key(|n| (!["X", "Y", "Z"].contains(n), *n));
        all.join(",")
    };
    match program.feed_word {
        FeedWord::Inverse => lines.line("G93"),
        FeedWord::PerMinute(None) => {}
        FeedWord::PerMinute(Some(metric)) => {
            let (group, radius_mm) = match metric {
                PathMetric::Linear => (names(true, false), None),
                PathMetric::Arc { radius_mm } => (names(true, true), Some(radius_mm)),
                PathMetric::RotaryOnly => (names(false, true), Some(crate::feed::DEGREE_AS_MM)),
            };
            lines.line(&format!("FGROUP({group})"));
            if let Some(radius_mm) = radius_mm {
                let mut letters: Vec<&str> = program.rotary_names.iter().map(|r| r.letter.as_str()).collect();
                letters.sort_unstable();
                let words: Vec<String> =
                    letters.iter().map(|l| format!("FGREF[{l}]={radius_mm:.6}")).collect();
                if !words.is_empty() {
                    lines.line(&words.join(" "));
                }
            }
        }
    }
}
