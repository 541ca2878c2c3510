//! LinuxCNC 2.9.
//!
//! - Machines with switchable kinematics take M-words for it; they are data of the machine file (the sample machines
//!   with a tilting rotary table have M428 for the tip in the part's frame and M429 for plain joints).
//! - F in G94 is read over X Y Z; a move of rotary axes alone is read in deg/min. G93 wants F in every block.
//! - Rotary axes count on through whole turns; nothing is wrapped.
//! - `G92.1` at the start deletes offsets of `G92` that an aborted program may have left.
//! - `G64 P` bounds how far blending may leave the programmed corner, of X Y Z: where rotary axes stop or start without
//!   tool-centre-point control the tip would stray further, so that moves end there by `G61.1`. Straight moves of X Y Z alone are joined
//!   within as much again, unless `Q0` says that they are not. `G53` moves in machine coordinates.

use super::Dialect;
use super::block::{FeedWord, NcMove, Program, RotaryName, WriteError};
use super::lines::Lines;
use super::modal::{Modal, Position, Which, Wording, plain};
use super::number;
use super::orientation::Orientation;

pub(super) const WORDING: Wording =
    Wording { rapid: "G0", feed: "G1", modal: true, axis: plain, rotary, vector: (["", "", ""], false) };

fn rotary(text: &mut String, name: &RotaryName, counts: i64) {
    plain(text, &name.letter, Position { counts, decimals: name.decimals });
}

pub(super) fn head(program: &Program, lines: &mut Lines) -> Result<(), WriteError> {
    program.single_letters("linuxcnc")?;
    let what = match program.orientation {
        Orientation::Joints => None,
        Orientation::Vectors => Some("a direction"),
        Orientation::Planes => Some("a tilted plane"),
    };
    if let Some(what) = what {
        return Err(WriteError::Orientation { dialect: "linuxcnc", what });
    }
    let switch = program.linuxcnc_tcp.as_ref();
    if program.tcp && switch.is_none() {
        return Err(WriteError::NoTcpSwitch);
    }
    let work_offset = program.work_offset_words(Dialect::LinuxCnc)?;
    lines.line(&format!("({})", program.safe_name()));
    for comment in program.safe_comments() {
        lines.line(&format!("({comment})"));
    }
    lines.line("G17 G21 G40 G49 G80 G90 G94");
    lines.line("G92.1");
    corners(program, false, lines);
    if let Some(words) = switch {
        lines.line(&words.off);
    }
    if let Some(z) = program.retract {
        lines.line(&format!("G53 G0 Z{}", number::plain(z)));
    }
    call(program, work_offset.as_deref(), lines);
    Ok(())
}

/// The tool into the spindle, which stands where the machine changes tools.
fn call(program: &Program, work_offset: Option<&str>, lines: &mut Lines) {
    lines.line(&format!("T{} M6", program.tool_number));
    lines.line(&format!("G43 H{}", program.tool_number));
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
    let work_offset = program.work_offset_words(Dialect::LinuxCnc)?;
    leave(before, lines);
    program.safe_comments().iter().for_each(|comment| lines.line(&format!("({comment})")));
    corners(program, false, lines);
    call(program, work_offset.as_deref(), lines);
    Ok(())
}

/// How the moves that follow end: at rest, or blended with the next.
pub(super) fn corners(program: &Program, rests: bool, lines: &mut Lines) {
    if rests {
        lines.line("G61.1");
    } else {
        let joins = if program.joins { "" } else { " Q0" };
        lines.line(&format!("G64 P{:.4}{joins}", program.blend_mm));
    }
}

/// A rotary axis that turns by no more than this in a move goes too slowly for its start or stop to be seen, counts: a hundredth of a
/// degree, of which drives of 2000 deg/s2 at one move in 2 ms leave 0.0016 deg.
const FEW: i64 = 100;

/// Whether a rotary axis stops or starts between a move, which begins at the rotary axes `before`, and the next one; rapid
/// moves are left alone.
pub(super) fn rests(before: [i64; 2], m: &NcMove, next: &NcMove) -> bool {
    let stops = |k: usize| {
        let turned = [m.rotary[k] - before[k], next.rotary[k] - m.rotary[k]].map(i64::abs);
        turned.contains(&0) && turned.into_iter().any(|t| t > FEW)
    };
    !(m.rapid && next.rapid) && (0..2).any(stops)
}

pub(super) fn first(program: &Program, modal: &mut Modal, first: &NcMove, lines: &mut Lines) {
    let switch = program.linuxcnc_tcp.as_ref();
    modal.approach(program, &WORDING, first, &[Which::Rotary]).iter().for_each(|l| lines.line(l));
    if let (true, Some(words)) = (program.tcp, switch) {
        lines.line(&words.on);
    }
    modal
        .approach(program, &WORDING, first, &[Which::Across, Which::Along])
        .iter()
        .for_each(|l| lines.line(l));
    if program.feed_word == FeedWord::Inverse {
        lines.line("G93");
    }
}

pub(super) fn tail(program: &Program, lines: &mut Lines) {
    leave(program, lines);
    lines.line("M30");
}

/// Away from the part, with everything off.
fn leave(program: &Program, lines: &mut Lines) {
    let switch = program.linuxcnc_tcp.as_ref();
    lines.line("G94");
    if program.cools {
        lines.line("M9");
    }
    lines.line("M5");
    if let Some(words) = switch {
        lines.line(&words.off);
    }
    if let Some(z) = program.retract {
        lines.line(&format!("G53 G0 Z{}", number::plain(z)));
    }
}
