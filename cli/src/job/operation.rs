//! One operation of a list: a job of its own, as it is judged and as it is planned.

use crate::failure::Failure;
use crate::job::problem::Places;
use crate::job::raw::{self, Raw};
use crate::job::repeat::Repeat;
use crate::job::words::{AxisKey, Gouges, OperationWord, StrategyWord};
use crate::job::{Job, SHARES, roughing};
use crate::words::number;

/// Of the scallop, what a finishing is laid out for that names none: crests of several operations, marks in hollows and what may hide between
/// samples are not known before. (Tried on a mould, whose finishing is shown to hold for 0.91 to 0.92 and not for more.)
const FIRST: f64 = 0.92;

/// One of the operations.
#[derive(Debug, Clone)]
pub struct Operation {
    /// As people name it.
    pub name: String,
    /// What it does.
    pub kind: OperationWord,
    /// Which of the clampings it is in.
    pub setup: usize,
    /// How far rest passes go beyond what stands too high, mm.
    pub overlap_mm: f64,
    /// Equal places in which it is done.
    pub repeat: Option<Repeat>,
    /// Whether tools of others in its setup keep their axis.
    pub(super) beside_kept: bool,
    pub(super) places: Places,
    pub(super) raw: Raw,
}

/// What is known of an operation when its turn comes, and no file says.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Circumstances {
    /// How high material stands on its faces at most, mm; where that is not known a layer is assumed.
    pub standing_mm: Option<f64>,
    /// How the part stands where the file says nothing, degrees.
    pub rotate_deg: Option<[f64; 3]>,
    /// The highest scallop that a finishing is laid out for, mm, where it is known to be too much otherwise; what it may leave is as the file says.
    pub at_most_mm: Option<f64>,
    /// Whether it is chosen among many, each judged by itself: as in the program of its setup then.
    pub is_chosen: bool,
}

impl Operation {
    /// The job that is judged: raw material stands as the whole list says.
    ///
    /// # Errors
    /// As [`Job::from_toml`].
    pub fn judged(&self) -> Result<Job, Failure> {
        Job::of(self.places.clone(), &self.raw)
    }

    /// The job that is planned, with what is known when its turn comes. Passes of a finishing care for what stands on their faces, a
    /// roughing for the raw material.
    ///
    /// # Errors
    /// As [`Job::from_toml`].
    pub fn planned(&self, known: &Circumstances) -> Result<Job, Failure> {
        if self.kind == OperationWord::Rough {
            return self.judged();
        }
        let mut raw = Raw {
            standing_mm: known.standing_mm,
            beside_kept: known.is_chosen && self.beside_kept,
            stock: None,
            ..self.raw.clone()
        };
        raw.setup.rotate_deg = raw.setup.rotate_deg.or(known.rotate_deg);
        let judged = Job::of(self.places.clone(), &raw)?;
        // What is chosen is judged as it is chosen.
        let named = self.places.has("operation", "scallop_mm") || judged.is_open();
        let whole_mm = raw.tolerance.scallop_mm;
        let first_mm = if named { whole_mm } else { FIRST * whole_mm };
        raw.tolerance.scallop_mm = first_mm.min(known.at_most_mm.unwrap_or(whole_mm));
        Job::of(self.places.clone(), &raw)
    }

    /// A failure at a key of its table.
    #[must_use]
    pub fn refuse(&self, key: &str, what: impl std::fmt::Display) -> Failure {
        self.places.refuse("operation", key, what)
    }
}

/// A key with what is wrong about it.
type Wrong = (&'static str, String);

/// Finishing, and what is left of it.
pub(super) fn fine(places: &Places, raw: &mut Raw, own: &raw::Operation) -> Result<(), Wrong> {
    use StrategyWord as W;
    if let Some(a) = own.allowance_mm.filter(|a| *a > 0.0) {
        let why = "only kind = \"rough\" leaves an allowance; a finishing brings faces to their tolerance";
        let what = format!("allowance_mm = {}: {why}", number(a, 4));
        return Err(("allowance_mm", what));
    }
    if let Some(key) = roughing::own_key(own) {
        return Err((key, format!("{key} is for kind = \"rough\": leave it out")));
    }
    let (s, t) = (&mut raw.strategy, &mut raw.tolerance);
    if matches!(s.kind, W::ZLevel | W::Flank) {
        return Err(("kind", format!("{} is no way of finishing here", s.kind.word())));
    }
    let given = matches!(s.axis, Some(AxisKey::Given(_)));
    if s.kind == W::Auto && (own.kind == OperationWord::Rest || given) {
        s.kind = W::Isoplanar3c;
    }
    // What a tool cannot reach without harm is for the next operation.
    if !matches!(s.kind, W::Isoplanar3c | W::Waterline3c | W::Gradient3c) && !places.has("strategy", "gouges")
    {
        s.gouges = Gouges::LeaveOut;
    }
    // An operation that leaves more on purpose is no less exact.
    t.gouge_mm = Some(own.gouge_mm.or(t.gouge_mm).unwrap_or(SHARES[0] * t.scallop_mm));
    t.chord_mm = Some(t.chord_mm.unwrap_or(SHARES[1] * t.scallop_mm));
    t.scallop_mm = own.scallop_mm.unwrap_or(t.scallop_mm);
    Ok(())
}
