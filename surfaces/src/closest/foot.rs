//! A nearest point, and why there is none.

use super::descent::Found;
use osculate_geom::{Axis, Domain, Point3, Uv};

/// Where on the surface a nearest point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FootKind {
    /// Both parameters are free: the offset is along the normal.
    Interior,
    /// On a line across which the surface has a crease, away from its ends.
    Crease,
    /// One parameter is at an end of its range.
    Edge,
    /// Both parameters are at ends of their ranges.
    Corner,
}

/// The nearest point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Foot {
    /// Its parameters, inside the domain.
    pub uv: Uv,
    /// The point.
    pub point: Point3,
    /// Its distance from the query.
    pub distance_mm: f64,
    /// Sine of the angle by which the offset misses a right angle to the directions free to move; the larger
    /// of both. Zero where the query lies on the surface.
    pub residual: f64,
    /// Where on the surface it lies.
    pub kind: FootKind,
    /// No point of the surface is nearer than `distance_mm - gap_mm`. Zero to rounding for a complete search,
    /// the distance itself where only a neighbourhood was searched.
    pub gap_mm: f64,
}

/// Why there is no nearest point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClosestError {
    /// A query or a hint that is not finite.
    #[error("the query ({}, {}, {}) or the hint is not finite", query.x, query.y, query.z)]
    NotFinite {
        /// The query.
        query: Point3,
    },
    /// The descent stopped where the offset is not perpendicular: at a place without tangent plane, or where
    /// the coordinates leave no digits.
    #[error(
        "stopped at u = {}, v = {} after {steps} steps, {distance_mm} mm away, with the offset {residual:.1e} off the \
         normal: start nearer to the point", at.u, at.v
    )]
    NotConverged {
        /// Where it stopped.
        at: Uv,
        /// Distance there.
        distance_mm: f64,
        /// As in [`Foot::residual`].
        residual: f64,
        /// Newton steps.
        steps: u32,
    },
    /// A surface without end cannot be sampled.
    #[error("the surface has no end along {axis:?}: give a hint")]
    Unbounded {
        /// Along which parameter.
        axis: Axis,
    },
}

/// Largest sine off a right angle that counts as perpendicular. The descent reaches about 1e-15 of the
/// coordinates over the distance; a thousandth of a radian would be a wrong foot.
pub(super) const PERPENDICULAR: f64 = 1e-6;

pub(super) fn finite(query: &Point3, hint: Uv) -> bool {
    query.iter().all(|c| c.is_finite()) && hint.u.is_finite() && hint.v.is_finite()
}

/// The foot of a descent over the whole domain.
pub(super) fn finish(found: &Found, domain: &Domain, gap_mm: f64) -> Result<Foot, ClosestError> {
    if found.residual > PERPENDICULAR || found.residual.is_nan() {
        return Err(ClosestError::NotConverged {
            at: found.uv,
            distance_mm: found.distance_mm,
            residual: found.residual,
            steps: found.steps,
        });
    }
    let at_end = [Axis::U, Axis::V].map(|axis| {
        let (i, t) = (domain.get(axis), found.uv.get(axis));
        !i.periodic && (t <= i.lo || t >= i.hi)
    });
    let kind = match at_end {
        [true, true] => FootKind::Corner,
        [false, false] => FootKind::Interior,
        _ => FootKind::Edge,
    };
    Ok(Foot {
        uv: found.uv,
        point: found.point,
        distance_mm: found.distance_mm,
        residual: found.residual,
        kind,
        gap_mm,
    })
}
