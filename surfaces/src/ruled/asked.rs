//! What is asked of rules and bands, and why there are none.

use super::surface::RuledError;
use crate::closest::ClosestError;
use crate::fit::FitError;
use osculate_geom::{Axis, Interval, Point3, Surface, Uv};

/// How rules are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RulingOptions {
    /// A rule strays from the face by at most so much, mm.
    pub tolerance_mm: f64,
    /// Rules laid on a band.
    pub rules: usize,
    /// Places of a rule at which its distance from the face is measured, ends not counted.
    pub checks: usize,
    /// Rules begin and end at the corners of the face, so that they cover it. Without that oblique rules are found, and
    /// the corners they leave out are not covered.
    pub keep_corners: bool,
    /// Bands at most.
    pub most_bands: usize,
}

impl Default for RulingOptions {
    fn default() -> Self {
        Self { tolerance_mm: 0.01, rules: 17, checks: 7, keep_corners: true, most_bands: 64 }
    }
}

/// A part of a face between two lines of constant parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// The parameter along both lines; the rules run across.
    pub along: Axis,
    /// Range of the other parameter.
    pub across: Interval,
}

/// Why no rules were looked for or found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RulingError {
    /// A number that makes no sense.
    #[error("{what} is {got}; it must be {need}")]
    Option {
        /// Which option.
        what: &'static str,
        /// Its value.
        got: f64,
        /// What it may be.
        need: &'static str,
    },
    /// A range without end.
    #[error("the range [{lo}, {hi}] along {axis:?} must be finite and not empty")]
    Range {
        /// Along which parameter.
        axis: Axis,
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// No nearest point of the face.
    #[error(transparent)]
    Closest(#[from] ClosestError),
    /// A border that gives no curve: it is a single point or not finite.
    #[error("a border gives no directrix: {0}")]
    Border(#[from] FitError),
    /// Both directrices do not go together.
    #[error(transparent)]
    Ruled(#[from] RuledError),
    /// Too many bands.
    #[error(
        "{bands} bands still miss the tolerance of {tolerance_mm} mm by {error_mm} mm between {lo} and {hi} along {across:?}"
    )]
    TooMany {
        /// Bands used.
        bands: usize,
        /// Tolerance, mm.
        tolerance_mm: f64,
        /// Error of the band that misses it, mm.
        error_mm: f64,
        /// The parameter across the bands.
        across: Axis,
        /// Where the band begins.
        lo: f64,
        /// Where it ends.
        hi: f64,
    },
}

pub(super) fn border(surface: &dyn Surface, band: &Band, end: usize, t: f64) -> Point3 {
    let along = surface.domain().get(band.along);
    let across = if end == 0 { band.across.lo } else { band.across.hi };
    surface.point(Uv::from_axis(band.along, along.at(t), across))
}
