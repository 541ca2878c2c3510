//! Fanuc 30i and its like.
//!
//! - Tool-centre-point control is `G43.4 H`, off by `G49`; without it `G43 H` applies the tool's length.
//! - `G43.5 H` is the same with directions of the tool, `I J K`, instead of rotary axes.
//! - `G68.2 X Y Z I J K` tilts the working plane, `G53.1` turns the tool there (the program has positioned the rotary axes
//!   before, so that nothing is left to turn), `G69` ends it.
//! - Endless axes are rollover axes that take the shortest way to a position inside one turn (parameter 1008).
//! - `G5.1 Q1` is contour control with look-ahead over many blocks, off by `G5.1 Q0`.
//! - F in G94 is read over all axes, a degree as a mm. G93 wants F in every block.

use super::Dialect;
use super::block::{FeedWord, NcMove, Program, RotaryName, WriteError};
use super::lines::Lines;
use super::modal::{Modal, Position, Which, Wording, plain};
use super::number;

pub(super) const WORDING: Wording =
    Wording { rapid: "G0", feed: "G1", modal: true, axis: plain, rotary, vector: (["I", "J", "K"], false) };

fn rotary(text: &mut String, name: &RotaryName, counts: i64) {
    plain(text, &name.letter, Position::of(name, counts));
}

pub(super) fn head(program: &Program, lines: &mut Lines) -> Result<(), WriteError> {
    program.single_letters("fanuc")?;
    lines.line("%");
    if !(1..=9999).contains(&program.number) {
        return Err(WriteError::Number { dialect: "fanuc", number: program.number });
    }
    let work_offset = program.work_offset_words(Dialect::Fanuc)?;
    lines.line(&format!("O{:04} ({})", program.number, program.safe_name()));
    for comment in program.safe_comments() {
        lines.line(&format!("({comment})"));
    }
    lines.line("G17 G21 G40 G49 G80 G90 G94");
    if let Some(z) = program.retract {
        lines.line(&format!("G53 G0 Z{}", number::plain(z)));
    }
    call(program, work_offset.as_deref(), lines);
    Ok(())
}

/// The tool into the spindle, which stands where the machine changes tools.
fn call(program: &Program, work_offset: Option<&str>, lines: &mut Lines) {
    lines.line(&format!("T{} M6", program.tool_number));
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
    let work_offset = program.work_offset_words(Dialect::Fanuc)?;
    leave(before, lines);
    program.safe_comments().iter().for_each(|comment| lines.line(&format!("({comment})")));
    call(program, work_offset.as_deref(), lines);
    Ok(())
}

pub(super) fn first(program: &Program, modal: &mut Modal, first: &NcMove, lines: &mut Lines) {
    modal.approach(program, &WORDING, first, &[Which::Rotary]).iter().for_each(|l| lines.line(l));
    if program.in_planes() {
        plane(first, lines);
    }
    let tcp = match (program.tcp, program.in_vectors()) {
        (true, true) => "G43.5",
        (true, false) => "G43.4",
        (false, _) => "G43",
    };
    lines.line(&format!("{tcp} H{}", program.tool_number));
    modal
        .approach(program, &WORDING, first, &[Which::Across, Which::Along])
        .iter()
        .for_each(|l| lines.line(l));
    lines.line("G5.1 Q1");
    if program.feed_word == FeedWord::Inverse {
        lines.line("G93");
    }
}

fn plane(m: &NcMove, lines: &mut Lines) {
    let [i, j, k] = m.orientation.map(number::fixed);
    lines.line(&format!("G68.2 X0 Y0 Z0 I{i} J{j} K{k}"));
    lines.line("G53.1");
}

/// Goes from one plane to another: away in machine coordinates, rotary axes, plane, back.
pub(super) fn next_plane(program: &Program, modal: &mut Modal, m: &NcMove, lines: &mut Lines) {
    lines.line("G49");
    lines.line("G69");
    if let Some(z) = program.retract {
        lines.line(&format!("G53 G0 Z{}", number::plain(z)));
    }
    modal.forget();
    modal.approach(program, &WORDING, m, &[Which::Rotary]).iter().for_each(|l| lines.line(l));
    plane(m, lines);
    lines.line(&format!("G43 H{}", program.tool_number));
    modal.approach(program, &WORDING, m, &[Which::Across, Which::Along]).iter().for_each(|l| lines.line(l));
}

pub(super) fn tail(program: &Program, lines: &mut Lines) {
    leave(program, lines);
    lines.line("M30");
    lines.line("%");
}

/// Away from the part, with everything off.
fn leave(program: &Program, lines: &mut Lines) {
    lines.line("G94");
    lines.line("G5.1 Q0");
    if program.cools {
        lines.line("M9");
    }
    lines.line("M5");
    lines.line("G49");
    if program.in_planes() {
        lines.line("G69");
    }
    if let Some(z) = program.retract {
        lines.line(&format!("G53 G0 Z{}", number::plain(z)));
    }
}
