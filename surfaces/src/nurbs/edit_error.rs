//! Why a surface or curve cannot be changed as asked, and the checks that curves and surfaces share.

use crate::knots::Knots;

/// Why a surface or curve cannot be changed as asked.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A parameter outside the domain, at its end where that makes no sense, or NaN.
    #[error("parameter {got} is not inside ({lo}, {hi})")]
    Outside {
        /// The parameter.
        got: f64,
        /// Lower end of the domain.
        lo: f64,
        /// Upper end of the domain.
        hi: f64,
    },
    /// A piece without length, or one that reaches outside.
    #[error("[{from}, {to}] is no interval inside [{lo}, {hi}]")]
    Interval {
        /// Where the piece begins.
        from: f64,
        /// Where it ends.
        to: f64,
        /// Lower end of the domain.
        lo: f64,
        /// Upper end of the domain.
        hi: f64,
    },
    /// A degree above the largest one.
    #[error("degree {degree} is above the largest possible, {most}")]
    Degree {
        /// The degree asked for.
        degree: usize,
        /// The largest.
        most: usize,
    },
    /// A knot to remove that does not stand there, or not often enough.
    #[error("knot {at} stands {multiplicity} times and cannot be removed {times} times")]
    NoKnot {
        /// The knot.
        at: f64,
        /// How often it stands there.
        multiplicity: usize,
        /// How often it should be removed.
        times: usize,
    },
    /// A weight that would not be positive.
    #[error("weight {index} would become {got}")]
    Weight {
        /// Its place among the new poles.
        index: usize,
        /// Its value.
        got: f64,
    },
    /// A knot that would stand more often than the degree.
    #[error("knot {at} would stand {multiplicity} times, above the degree {degree}")]
    Multiplicity {
        /// The knot.
        at: f64,
        /// How often it would stand there.
        multiplicity: usize,
        /// The degree.
        degree: usize,
    },
}

/// Checks that a knot may be inserted.
pub(crate) fn check_insertion(knots: &Knots, t: f64, times: usize) -> Result<(), EditError> {
    let [lo, hi] = knots.domain();
    if !(t > lo && t < hi) {
        return Err(EditError::Outside { got: t, lo, hi });
    }
    let multiplicity = knots.multiplicity(t).saturating_add(times);
    if multiplicity > knots.degree() {
        return Err(EditError::Multiplicity { at: t, multiplicity, degree: knots.degree() });
    }
    Ok(())
}

/// Checks that `[from, to]` is a piece of the domain.
pub(crate) fn check_piece(knots: &Knots, from: f64, to: f64) -> Result<(), EditError> {
    let [lo, hi] = knots.domain();
    if from >= lo && to <= hi && from < to { Ok(()) } else { Err(EditError::Interval { from, to, lo, hi }) }
}
