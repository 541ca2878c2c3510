//! The verdict on a program: held, not held, or not shown, with its scope first.
//!
//! [`prove`](super::prove()) alone makes one. Equal programs and goals give equal verdicts, byte for byte as text too.

use super::density::Hidden;
use super::feeds::TooFast;
use super::job::{Cut, Sample};
use super::stock::{Carved, Stock, Volume};
use super::tally::Tally;
use std::fmt;
use std::sync::Arc;

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Everything in the scope holds, between the samples too.
    Held,
    /// Something does not hold.
    NotHeld,
    /// The limits are met where it was looked, but that they are elsewhere is not shown.
    NotShown,
}

impl Answer {
    /// As files have it.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::NotHeld => "not_held",
            Self::NotShown => "not_shown",
        }
    }
}

/// What a part of the scope is.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ScopeRow {
    /// Which part.
    pub what: &'static str,
    /// What of it is covered, or that it is not.
    pub covers: String,
}

/// What became of declared raw material.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StockFound {
    /// Sides of cells, mm.
    pub cell_mm: f64,
    /// The side that was asked for, where memory required larger ones.
    pub coarsened_mm: Option<f64>,
    /// Rays.
    pub rays: usize,
    /// The box that it fills, mm.
    pub bounds: osculate_geom::Box3,
    /// Before.
    pub before: Volume,
    /// After.
    pub left: Volume,
    /// What every block took, and what ran into material.
    pub carved: Carved,
    /// What was taken too fast, as in [`Figures::too_fast`].
    pub too_fast: Option<TooFast>,
    /// The material that is left.
    pub stock: Arc<Stock>,
}

/// The figures behind a verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Over all samples.
    pub tally: Tally,
    /// Samples that were added where limits might be exceeded between the others.
    pub added: usize,
    /// Distance of the others, mm.
    pub spacing_mm: f64,
    /// What may hide between samples, mm.
    pub hidden: Hidden,
    /// Of the uncut area that of places between samples where something higher than the scallop may hide, which counts into it where it is
    /// accepted, mm2.
    pub open_area_mm2: f64,
    /// Area that was measured higher than the scallop, or never touched, mm2. Where an area is accepted the uncut one, but by a
    /// coarse look, is no smaller: places next to this one, about which nothing can be shown, count into that.
    pub high_area_mm2: f64,
    /// The smallest radius of curvature at a sample, mm; None where everything is flat.
    pub smallest_radius_mm: Option<f64>,
    /// Median height of the crests between passes, mm.
    pub crest_median_mm: f64,
    /// The highest tooth mark, mm; None where nothing tells the spindle's speed.
    pub mark_max_mm: Option<f64>,
    /// Highest scallop with its tooth mark, mm.
    pub height_max_mm: f64,
    /// The program is so far off that a coarse look tells: figures are of that look, and nothing was looked at closer.
    pub coarse: bool,
    /// What cuts faster than its tool's feed; None also where feeds are not known.
    pub too_fast: Option<TooFast>,
    /// Declared raw material, where it was looked at.
    pub stock: Option<StockFound>,
}

/// The verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    pub(super) answer: Answer,
    /// The faces for which alone it holds, where others are not looked at.
    pub(super) only: Option<String>,
    /// Limits that are met at the samples are enough.
    pub(super) at_samples: bool,
    pub(super) why: Vec<String>,
    /// All that fails is what is left standing.
    pub(super) leaves_only: bool,
    pub(super) remarks: Vec<String>,
    pub(super) scope: Vec<ScopeRow>,
    pub(super) figures: Figures,
    pub(super) samples: Vec<Sample>,
    pub(super) cuts: Vec<Cut>,
}

impl Verdict {
    /// The answer.
    #[must_use]
    pub const fn answer(&self) -> Answer {
        self.answer
    }

    /// Whether the answer is [`Answer::Held`].
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.answer == Answer::Held
    }

    /// Why it is not held, or not shown; the gravest first. Empty where it is held.
    #[must_use]
    pub fn why(&self) -> &[String] {
        &self.why
    }

    /// Whether all that fails is what is left standing: nothing is harmed, and what comes later may take it.
    #[must_use]
    pub const fn leaves_only(&self) -> bool {
        self.leaves_only
    }

    /// What is to be told of the state of the control, whatever the answer.
    #[must_use]
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// What it covers and what not.
    #[must_use]
    pub fn scope(&self) -> &[ScopeRow] {
        &self.scope
    }

    /// The figures.
    #[must_use]
    pub const fn figures(&self) -> &Figures {
        &self.figures
    }

    /// Where it was measured: evenly at first, then the samples that were added.
    #[must_use]
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What was measured there.
    #[must_use]
    pub fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    /// The answer as a doubt of another judge leaves it: what was held is not shown, for this reason.
    #[must_use]
    pub fn doubted(mut self, why: String) -> Self {
        if self.answer == Answer::Held {
            self.answer = Answer::NotShown;
        }
        self.why.push(why);
        self
    }

    /// The answer in words, in one line.
    #[must_use]
    pub fn words(&self) -> String {
        let only = self.only.as_ref().map_or_else(String::new, |only| format!(" for {only} only"));
        match self.answer {
            Answer::Held if self.at_samples => {
                format!("held{only}: within tolerance at the samples, which the job takes as enough")
            }
            Answer::Held => format!("held{only}: within tolerance, with all that may hide between samples"),
            Answer::NotHeld => format!("NOT held: {}", self.why.join("; ")),
            Answer::NotShown => format!("NOT SHOWN to hold{only}: {}", self.why.join("; ")),
        }
    }
}

impl fmt::Display for Verdict {
    /// Scope, then answer, then what is to be told.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.scope.iter().map(|row| row.what.len()).max().unwrap_or(0);
        for row in &self.scope {
            writeln!(f, "  {:width$}  {}", row.what, row.covers)?;
        }
        writeln!(f, "\n  {}", self.words())?;
        for remark in &self.remarks {
            writeln!(f, "  {remark}")?;
        }
        Ok(())
    }
}
