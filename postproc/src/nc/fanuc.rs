//! Fanuc 30i and its like.
//!
//! - Tool-centre-point control is `G43.4 H`, off by `G49`; without it `G43 H` applies the tool's length.
//! - Endless axes are rollover axes that take the shortest way to a position inside one turn (parameter 1008).
//! - `G5.1 Q1` is contour control with look-ahead over many blocks, off by `G5.1 Q0`.
//! - F in G94 is read over all axes, a degree as a mm. G93 wants F in every block.

use super::block::{FeedWord, Program, RotaryName, WriteError};
use super::modal::{Modal, Which, Wording, in_turn, plain};
use super::number;

const WORDING: Wording = Wording { rapid: "G0", feed: "G1", modal: true, axis: plain, rotary };

fn rotary(text: &mut String, name: &RotaryName, counts: i64) {
    plain(text, &name.letter, if name.endless { in_turn(counts) } else { counts });
}

pub(super) fn write(program: &Program) -> Result<String, WriteError> {
    program.single_letters("fanuc")?;
    let mut text = String::new();
    let mut line = |words: &str| {
        text.push_str(words);
        text.push('\n');
    };
    line("%");
    line(&format!("O0001 ({})", program.safe_name()));
    for comment in program.safe_comments() {
        line(&format!("({comment})"));
    }
    line("G17 G21 G40 G49 G80 G90 G94");
    if program.has_z() {
        line("G53 G0 Z0");
    }
    line(&format!("T{} M6", program.tool_number));
    line("G54");
    if let Some(rpm) = program.spindle_rpm {
        line(&format!("S{} M3", number::feed(rpm)));
    }
    let mut modal = Modal::new(program);
    if let Some((first, rest)) = program.moves.split_first() {
        modal.approach(program, &WORDING, first, &[Which::Rotary]).iter().for_each(|l| line(l));
        let tcp = if program.tcp { "G43.4" } else { "G43" };
        line(&format!("{tcp} H{}", program.tool_number));
        modal.approach(program, &WORDING, first, &[Which::Across, Which::Along]).iter().for_each(|l| line(l));
        line("G5.1 Q1");
        if program.feed_word == FeedWord::Inverse {
            line("G93");
        }
        let mut words = String::new();
        for m in rest {
            words.clear();
            modal.block(program, &WORDING, m, &mut words);
            if !words.is_empty() {
                line(&words[1..]);
            }
        }
    }
    line("G94");
    line("G5.1 Q0");
    line("M5");
    line("G49");
    if program.has_z() {
        line("G53 G0 Z0");
    }
    line("M30");
    line("%");
    Ok(text)
}
