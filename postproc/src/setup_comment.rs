//! The setup that a program is posted for, in comments at its head, and read back from there to the last bit.
//!
//! Three lines, each short enough for the blocks of any control: `setup part zero X.. Y.. Z..` in mm,
//! `setup turn I.. J.. K.. W..`, the unit quaternion i, j, k, w of [`Setup::part_zero`]'s rotation, which is left out where
//! the part is not turned, and `setup gauge length L..` in mm. Numbers are the shortest decimals that give back the same
//! bits. What stands around them for people has four decimals and no rotation.
//!
//! Programs of other hands have no such lines. Where only some of them are there, or one is not as written here, that is
//! an error: half a setup would put the part somewhere else.

use crate::nc::Dialect;
use crate::setup::Setup;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use osculate_geom::Vec3;

/// Lines at the head of a program in which the comments are looked for.
const HEAD_LINES: usize = 60;

/// What the lines begin with.
const PLACE: &str = "setup part zero ";
const TURN: &str = "setup turn ";
const GAUGE: &str = "setup gauge length ";

/// A quaternion in the comment may be this far from a unit one: far more than rounding to 17 digits, far less than
/// anything that a hand would change.
const UNIT_TOLERANCE: f64 = 1e-9;

/// A setup in a program's comments that is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupCommentError {
    /// A line that begins as the post writes it and does not go on so.
    #[error("line {line}: the setup in '{text}' is not understood")]
    Line {
        /// From 1.
        line: usize,
        /// The comment.
        text: String,
    },
    /// A line is missing.
    #[error("there is no line '{what}' beside the other lines of the setup")]
    Missing {
        /// How it begins.
        what: &'static str,
    },
}

/// The comments that say this setup.
pub(crate) fn lines(setup: &Setup) -> Vec<String> {
    let t = setup.part_zero.translation.vector;
    let q = setup.part_zero.rotation.coords;
    // Debug text of an f64 is the shortest that reads back as the same number, with an exponent where it is tiny or huge.
    let mut out = vec![format!("{PLACE}X{:?} Y{:?} Z{:?}", t.x, t.y, t.z)];
    if setup.part_zero.rotation != UnitQuaternion::identity() {
        out.push(format!("{TURN}I{:?} J{:?} K{:?} W{:?}", q.x, q.y, q.z, q.w));
    }
    out.push(format!("{GAUGE}L{:?}", setup.gauge_length_mm));
    out
}

/// The comment of a line, without the signs around it; None where it has no comment of its own.
fn comment(line: &str, dialect: Dialect) -> Option<&str> {
    let line = line.trim();
    match dialect {
        Dialect::Sinumerik => line.strip_prefix(';'),
        // After the number of the block.
        Dialect::Heidenhain => line.trim_start_matches(|c: char| c.is_ascii_digit()).trim().strip_prefix(';'),
        Dialect::Fanuc | Dialect::LinuxCnc => line.strip_prefix('(')?.strip_suffix(')'),
    }
    .map(str::trim)
}

/// Words of these letters in this order, each with a finite number, and nothing else.
fn numbers<const N: usize>(text: &str, letters: [char; N]) -> Option<[f64; N]> {
    let mut words = text.split(' ');
    let mut out = [0.0; N];
    for (o, letter) in out.iter_mut().zip(letters) {
        *o = words.next()?.strip_prefix(letter)?.parse().ok().filter(|v: &f64| v.is_finite())?;
    }
    words.next().is_none().then_some(out)
}

impl Setup {
    /// The setup that the head of a program says it was posted for, with the bits that the post had; None where it says
    /// none, as programs of other hands.
    ///
    /// ```
    /// use osculate_geom::Vec3;
    /// use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post};
    ///
    /// let setup = Setup::at(Vec3::new(0.1, -0.2, 1.0 / 3.0), 123.456);
    /// let path = cldata::read("RAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/8,0,5\nFINI\n")?.path;
    /// let machine = Machine::built_in("trunnion-ac")?;
    /// let posted = post(&path, &machine, &setup, &PostOptions::new(Dialect::Sinumerik, FeedMode::Tcp))?;
    /// assert_eq!(Setup::of_program(&posted.text, Dialect::Sinumerik)?, Some(setup));
    /// assert_eq!(Setup::of_program("G0 X0\n", Dialect::Fanuc)?, None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where the comments have a part of a setup, or one that is changed so that it is none.
    pub fn of_program(text: &str, dialect: Dialect) -> Result<Option<Self>, SetupCommentError> {
        let (mut place, mut turn, mut gauge) = (None, None, None);
        for (k, line) in text.lines().take(HEAD_LINES).enumerate() {
            let Some(text) = comment(line, dialect) else { continue };
            let wrong = || SetupCommentError::Line { line: k + 1, text: text.to_owned() };
            if let Some(rest) = text.strip_prefix(PLACE) {
                place = Some(numbers(rest, ['X', 'Y', 'Z']).ok_or_else(wrong)?);
            } else if let Some(rest) = text.strip_prefix(TURN) {
                let [i, j, k, w] = numbers(rest, ['I', 'J', 'K', 'W']).ok_or_else(wrong)?;
                let q = Quaternion::new(w, i, j, k);
                if (q.norm() - 1.0).abs() > UNIT_TOLERANCE {
                    return Err(wrong());
                }
                // Not normalised again: that would change the last bits.
                turn = Some(UnitQuaternion::new_unchecked(q));
            } else if let Some(rest) = text.strip_prefix(GAUGE) {
                let [length] = numbers(rest, ['L']).filter(|[l]| *l >= 0.0).ok_or_else(wrong)?;
                gauge = Some(length);
            }
        }
        let missing = |what: &'static str| SetupCommentError::Missing { what: what.trim_end() };
        match (place, gauge) {
            (None, None) if turn.is_none() => Ok(None),
            (None, _) => Err(missing(PLACE)),
            (_, None) => Err(missing(GAUGE)),
            (Some(zero), Some(gauge_length_mm)) => {
                let rotation = turn.unwrap_or_else(UnitQuaternion::identity);
                let part_zero = Isometry3::from_parts(Translation3::from(Vec3::from(zero)), rotation);
                Ok(Some(Self { part_zero, gauge_length_mm }))
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::{FeedMode, Machine, PostOptions, cldata, post};

    /// A program of two positions.
    fn program(setup: &Setup, dialect: Dialect, feed: FeedMode) -> String {
        let text = "RAPID\nGOTO/0,0,5,0,0.2,1\nFEDRAT/800,MMPM\nGOTO/10,0,5,0,0.3,1\nFINI\n";
        let path = cldata::read(text).unwrap().path;
        let machine = Machine::built_in("trunnion-ac").unwrap();
        post(&path, &machine, setup, &PostOptions::new(dialect, feed)).unwrap().text
    }

    /// Numbers that four decimals do not hold, tiny ones too.
    fn turned() -> Setup {
        let turn = UnitQuaternion::from_scaled_axis(Vec3::new(0.1, 1e-17, -0.2));
        let place = Translation3::new(-20.0 / 3.0, 1e-9, 70.0 / 11.0);
        Setup { part_zero: Isometry3::from_parts(place, turn), gauge_length_mm: 250.0 / 7.0 }
    }

    #[test]
    fn setups_come_back_from_every_dialect_to_the_last_bit() {
        for dialect in Dialect::ALL {
            for feed in [FeedMode::Tcp, FeedMode::None] {
                for setup in [turned(), Setup::default(), Setup::at(Vec3::new(0.1, -3.0, 1e-7), 80.0)] {
                    let text = program(&setup, dialect, feed);
                    assert_eq!(Setup::of_program(&text, dialect), Ok(Some(setup)), "{text}");
                    let longest = text.lines().map(str::len).max().unwrap();
                    assert!(longest <= 120, "{text}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_setup_is_told_and_what_has_none_is_not() {
        let dialect = Dialect::Fanuc;
        let good = program(&turned(), dialect, FeedMode::None);
        let other = good.replace("setup", "SET-UP");
        assert_eq!(Setup::of_program(&other, dialect), Ok(None));
        // Comments of another dialect are none.
        assert_eq!(Setup::of_program(&good, Dialect::Sinumerik), Ok(None));
        let without = good.replace(GAUGE, "");
        assert_eq!(
            Setup::of_program(&without, dialect),
            Err(SetupCommentError::Missing { what: "setup gauge length" })
        );
        let place = good.lines().position(|l| l.contains(PLACE)).unwrap() + 1;
        for (from, to) in [("zero X", "zero U"), ("zero X", "zero Xnan"), ("zero X", "zero X1 X")] {
            let bad = Setup::of_program(&good.replace(from, to), dialect);
            assert!(matches!(bad, Err(SetupCommentError::Line { line, .. }) if line == place), "{bad:?}");
        }
        let bad = Setup::of_program(&good.replace("turn I", "turn I9"), dialect);
        assert!(matches!(bad, Err(SetupCommentError::Line { line, .. }) if line == place + 1), "{bad:?}");
        let bad = Setup::of_program(&good.replace("length L", "length L-"), dialect);
        assert!(matches!(bad, Err(SetupCommentError::Line { line, .. }) if line == place + 2), "{bad:?}");
    }
}
