//! Where the part stands, from the comments at a program's head.
//!
//! `setup part zero X.. Y.. Z..`, `setup turn I.. J.. K.. W..` (a unit quaternion, left out where the part is not turned) and
//! `setup gauge length L..`.

use super::refusal::NoOpinion;
use super::vector::{M, V, add, back, sub, usual};

/// Lines in which the comments are looked for.
const HEAD_LINES: usize = 60;

/// A quaternion may be this far from a unit one: rounding to 17 digits is far less.
const UNIT_TOLERANCE: f64 = 1e-9;

/// Part and tool on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// The part's origin from the table's reference point, mm.
    pub part_zero_mm: [f64; 3],
    /// The unit quaternion i, j, k, w that turns the part's axes into the table's.
    pub turn: [f64; 4],
    /// From the tip to the gauge point, mm.
    pub gauge_length_mm: f64,
}

impl Setup {
    /// What the head of a program says; None where it says nothing.
    ///
    /// # Errors
    /// Where it says half of it, or what is none.
    pub fn of_program(program: &str) -> Result<Option<Self>, NoOpinion> {
        let (mut zero, mut turn, mut gauge) = (None, None, None);
        for line in program.lines().take(HEAD_LINES) {
            let Some(at) = line.find("setup ") else { continue };
            let before = &line[..at];
            // The sign of a comment, behind a block number at most.
            let sign = before.trim_start_matches(|c: char| c.is_ascii_digit()).trim();
            if sign != ";" && sign != "(" {
                continue;
            }
            let said = line[at..].trim_end().trim_end_matches(')');
            let wrong = || NoOpinion::Setup { what: format!("'{said}' is not understood") };
            if let Some(rest) = said.strip_prefix("setup part zero ") {
                zero = Some(numbers(rest, ["X", "Y", "Z"]).ok_or_else(wrong)?);
            } else if let Some(rest) = said.strip_prefix("setup turn ") {
                turn = Some(numbers(rest, ["I", "J", "K", "W"]).ok_or_else(wrong)?);
            } else if let Some(rest) = said.strip_prefix("setup gauge length ") {
                gauge = Some(numbers(rest, ["L"]).ok_or_else(wrong)?[0]);
            }
        }
        match (zero, gauge) {
            (Some(part_zero_mm), Some(gauge_length_mm)) => {
                let turn = turn.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                Ok(Some(Self { part_zero_mm, turn, gauge_length_mm }))
            }
            (None, None) if turn.is_none() => Ok(None),
            _ => Err(NoOpinion::Setup { what: "the program's head says only a part of it".into() }),
        }
    }
}

/// Words of these letters in this order and nothing else.
fn numbers<const N: usize>(text: &str, letters: [&str; N]) -> Option<[f64; N]> {
    let mut words = text.split_whitespace();
    let mut out = [0.0; N];
    for (o, letter) in out.iter_mut().zip(letters) {
        *o = words.next()?.strip_prefix(letter)?.parse().ok().filter(|v: &f64| v.is_finite())?;
    }
    words.next().is_none().then_some(out)
}

/// The setup as it is calculated with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    /// From the part's axes to the table's.
    turn: M,
    zero: V,
    /// From the tip to the gauge point, mm.
    pub gauge_mm: f64,
}

impl Stand {
    pub fn of(setup: &Setup) -> Result<Self, NoOpinion> {
        let wrong = |what: &str| Err(NoOpinion::Setup { what: what.into() });
        let [i, j, k, w] = setup.turn;
        if !setup.part_zero_mm.iter().all(|x| usual(*x)) {
            return wrong("part zero is no place");
        }
        if !((i * i + j * j + k * k + w * w).sqrt() - 1.0).abs().le(&UNIT_TOLERANCE) {
            return wrong("the turn is no unit quaternion");
        }
        if !(usual(setup.gauge_length_mm) && setup.gauge_length_mm >= 0.0) {
            return wrong("the gauge length is no length");
        }
        let turn = [
            [1.0 - 2.0 * (j * j + k * k), 2.0 * (i * j - k * w), 2.0 * (i * k + j * w)],
            [2.0 * (i * j + k * w), 1.0 - 2.0 * (i * i + k * k), 2.0 * (j * k - i * w)],
            [2.0 * (i * k - j * w), 2.0 * (j * k + i * w), 1.0 - 2.0 * (i * i + j * j)],
        ];
        Ok(Self { turn, zero: setup.part_zero_mm, gauge_mm: setup.gauge_length_mm })
    }

    /// A point of the table's frame in the part's.
    pub fn point(&self, at: V) -> V {
        back(&self.turn, sub(at, self.zero))
    }

    /// A direction of the table's frame in the part's.
    pub fn direction(&self, v: V) -> V {
        back(&self.turn, v)
    }

    /// X Y Z of a program with tool-centre-point control, for a tip in the table's frame.
    pub fn words_of(&self, tip: V) -> V {
        sub(tip, self.zero)
    }

    /// The tip in the table's frame for such X Y Z.
    pub fn tip_of(&self, words: V) -> V {
        add(words, self.zero)
    }
}
