//! Heidenhain Klartext.
//!
//! - Tool-centre-point control is `FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS`: F at the tip, rotary axes interpolate
//!   linearly. `FUNCTION RESET TCPM` turns it off.
//! - Every position carries a sign; `FMAX` holds for its own block only.
//! - `CYCL DEF 32` bounds what smoothing may do to the path (finishing).
//! - `M126` makes endless axes take the shortest way. There is no inverse time feed. `M91` is machine coordinates.

use super::block::{FeedWord, NcMove, Program, RotaryName, WriteError};
use super::modal::{Modal, Which, Wording, in_turn};
use super::number;

const WORDING: Wording = Wording { rapid: "L", feed: "L", modal: false, axis, rotary };

fn axis(text: &mut String, name: &str, counts: i64) {
    text.push_str(name);
    if counts >= 0 {
        text.push('+');
    }
    number::push_fixed(text, counts);
}

fn rotary(text: &mut String, name: &RotaryName, counts: i64) {
    axis(text, &name.letter, if name.endless { in_turn(counts) } else { counts });
}

pub(super) fn write(program: &Program) -> Result<String, WriteError> {
    program.single_letters("heidenhain")?;
    if program.feed_word == FeedWord::Inverse {
        return Err(WriteError::Feed { dialect: "heidenhain", what: "inverse time feed (G93)" });
    }
    let name = program.safe_name();
    let mut text = Numbered::default();
    text.line(&format!("BEGIN PGM {name} MM"));
    for comment in program.safe_comments() {
        text.line(&format!("; {comment}"));
    }
    text.line("FUNCTION RESET TCPM");
    text.line("M126");
    let speed = program.spindle_rpm.map_or(String::new(), |rpm| format!(" S{}", number::feed(rpm)));
    if program.has_z() {
        text.line("L Z+0.0000 R0 FMAX M91");
    }
    text.line(&format!("TOOL CALL {} Z{speed}", program.tool_number));
    if program.spindle_rpm.is_some() {
        text.line("M3");
    }
    let mut modal = Modal::new(program);
    if let Some((first, rest)) = program.moves.split_first() {
        approach(&mut text, &mut modal, program, first, &[Which::Rotary]);
        if program.tcp {
            text.line("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS");
        }
        approach(&mut text, &mut modal, program, first, &[Which::Across, Which::Along]);
        text.line("CYCL DEF 32.0 TOLERANCE");
        text.line(&format!("CYCL DEF 32.1 T{:.4}", program.blend_mm));
        text.line("CYCL DEF 32.2 HSC-MODE:0");
        let mut words = String::new();
        for m in rest {
            words.clear();
            modal.block(program, &WORDING, m, &mut words);
            if words.is_empty() {
                continue;
            }
            if m.rapid {
                words.push_str(" FMAX");
            }
            text.line(&words[1..]);
        }
    }
    text.line("M5");
    text.line("FUNCTION RESET TCPM");
    if program.has_z() {
        text.line("L Z+0.0000 R0 FMAX M91");
    }
    text.line("M30");
    text.line(&format!("END PGM {name} MM"));
    Ok(text.text)
}

fn approach(text: &mut Numbered, modal: &mut Modal, program: &Program, first: &NcMove, which: &[Which]) {
    for words in modal.approach(program, &WORDING, first, which) {
        text.line(&format!("{words} FMAX"));
    }
}

#[derive(Default)]
struct Numbered {
    text: String,
    next: u64,
}

impl Numbered {
    fn line(&mut self, words: &str) {
        number::push_whole(&mut self.text, self.next);
        self.text.push(' ');
        self.text.push_str(words);
        self.text.push('\n');
        self.next += 1;
    }
}
