//! Auxiliary words in every dialect: spindle, coolant, dwells, stops.
//!
//! Seconds of a dwell are `G4 F` with Sinumerik, `G4 P` in milliseconds with Fanuc, `G4 P` with LinuxCNC and cycle 9 with Heidenhain, where a speed is
//! changed by `TOOL CALL S`.

use super::Dialect;
use super::lines::Lines;
use super::number;
use crate::auxiliary::{AuxiliaryWord, Spindle};

/// The lines that say it.
pub(super) fn say(dialect: Dialect, word: AuxiliaryWord, lines: &mut Lines) {
    match word {
        AuxiliaryWord::Spindle(Spindle::Off) => lines.line("M5"),
        AuxiliaryWord::Spindle(Spindle::Clockwise { rpm }) => spindle(dialect, rpm, "M3", lines),
        AuxiliaryWord::Spindle(Spindle::Counter { rpm }) => spindle(dialect, rpm, "M4", lines),
        AuxiliaryWord::Coolant(Some(coolant)) => lines.line(coolant.word()),
        AuxiliaryWord::Coolant(None) => lines.line("M9"),
        AuxiliaryWord::Stop => lines.line("M0"),
        AuxiliaryWord::OptionalStop => lines.line("M1"),
        AuxiliaryWord::Dwell { seconds } => {
            let milliseconds = number::feed((1000.0 * seconds).round().max(1.0));
            let seconds = number::feed(seconds);
            match dialect {
                Dialect::Sinumerik => lines.line(&format!("G4 F{seconds}")),
                Dialect::Fanuc => lines.line(&format!("G4 P{milliseconds}")),
                Dialect::LinuxCnc => lines.line(&format!("G4 P{seconds}")),
                Dialect::Heidenhain => {
                    lines.line("CYCL DEF 9.0 DWELL TIME");
                    lines.line(&format!("CYCL DEF 9.1 DWELL {seconds}"));
                }
            }
        }
    }
}

fn spindle(dialect: Dialect, rpm: f64, turn: &str, lines: &mut Lines) {
    let speed = number::feed(rpm);
    if dialect == Dialect::Heidenhain {
        lines.line(&format!("TOOL CALL S{speed}"));
        lines.line(turn);
    } else {
        lines.line(&format!("S{speed} {turn}"));
    }
}
