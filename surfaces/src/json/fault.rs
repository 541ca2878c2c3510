//! Why a face of the JSON is none, and checks that its readers share.

use crate::knots::MAX_DEGREE;
use crate::nurbs::{CurveError, NurbsError};
use crate::trimmed::TrimError;
use osculate_geom::analytic::BadSize;
use osculate_geom::uv;

/// What is wrong with a face.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FaceFault {
    /// A kind that is not known.
    #[error(
        "kind {got:?} is none of plane, cylinder, cone, sphere, torus, bspline, bezier, revolution, extrusion, offset, ruled, other"
    )]
    Kind {
        /// The word found.
        got: String,
    },
    /// Axes that make no frame.
    #[error("a frame with x = {x:?} and z = {z:?}: both must be unit vectors at right angles, to 1e-9")]
    Frame {
        /// First axis.
        x: [f64; 3],
        /// Third axis.
        z: [f64; 3],
    },
    /// A number that is not finite.
    #[error("{what} is not finite or not positive")]
    Number {
        /// Which one.
        what: &'static str,
    },
    /// Rows of different lengths.
    #[error("row {row} of the {what} has {got} entries, the first one {need}")]
    Rows {
        /// Poles or weights.
        what: &'static str,
        /// Which row, from 0.
        row: usize,
        /// Its length.
        got: usize,
        /// The first one's.
        need: usize,
    },
    /// An edge with neither a curve and its ends nor parameters, or with both.
    #[error("edge {edge} of loop {of}: it needs either a curve with ends or parameters (two pairs or more)")]
    Edge {
        /// Which loop, from 0.
        of: usize,
        /// Which edge, from 0.
        edge: usize,
    },
    /// A size of a surface.
    #[error(transparent)]
    Size(#[from] BadSize),
    /// A spline surface.
    #[error(transparent)]
    Surface(#[from] NurbsError),
    /// A spline curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// Loops.
    #[error(transparent)]
    Trim(#[from] TrimError),
}

/// A parameter pair that is two finite numbers.
pub(super) fn finite_uv([u, v]: [f64; 2]) -> Result<osculate_geom::Uv, FaceFault> {
    if u.is_finite() && v.is_finite() { Ok(uv(u, v)) } else { Err(FaceFault::Number { what: "a parameter" }) }
}

/// Degrees are bounded before anything is made of them.
pub(super) const fn possible(degree: usize) -> bool {
    degree >= 1 && degree <= MAX_DEGREE
}
