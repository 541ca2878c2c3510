//! The nearest point of a surface.
//!
//! - [`closest`] searches a whole NURBS surface and says how sure the result is: pieces are left out only
//!   where a proven bound puts them farther than the best point found ([`index`], [`search`]).
//! - [`closest_near`] follows any surface down from a hint ([`descent`]): for neighbouring points, one after
//!   the other.
//! - [`FaceSearch`] does both on a trimmed face.
//! - [`closest_sampled`] starts that from a grid, for surfaces without pieces.
//!
//! The point minimises `|S(u, v) - q|`; it may lie on an edge, a corner, a crease or a seam. There the offset
//! `S - q` is perpendicular to the directions in which the parameters are free to move, not to all of the
//! tangent plane.

mod bounds;
mod descent;
mod face;
mod index;
mod search;
mod tree;
mod way;

use crate::nurbs::NurbsSurface;
use descent::{Found, Of, descend};
pub use face::FaceSearch;
pub(crate) use index::Index;
use osculate_geom::{Axis, Domain, Point3, Surface, Uv};
use rayon::prelude::*;
use way::descend_surface;

/// Where on the surface a nearest point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
const PERPENDICULAR: f64 = 1e-6;

/// The nearest point of a NURBS surface: of all of it without a hint, of the neighbourhood of the hint with
/// one (see [`closest_near`]).
///
/// The first search of a surface builds its index. Queries for which whole regions are equally far (the
/// centre of a sphere) end after a bounded amount of work with [`Foot::gap_mm`] above zero.
///
/// ```
/// use osculate_geom::{Point3, Surface, Vec3, uv};
/// use osculate_surfaces::{FootKind, closest, gallery};
/// let s = gallery::m86(3);
/// let jet = s.jet2(uv(0.3, 0.6));
/// let above = jet.point + jet.normal()?.into_inner() * 2.0;
/// let foot = closest(&s, &above, None)?;
/// assert!((foot.distance_mm - 2.0).abs() < 1e-9 && foot.kind == FootKind::Interior);
/// assert!(foot.residual < 1e-9 && foot.gap_mm < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ClosestError`] for numbers that are not finite, and for a descent from a hint that does not converge.
pub fn closest(surface: &NurbsSurface, query: &Point3, hint: Option<Uv>) -> Result<Foot, ClosestError> {
    match hint {
        Some(hint) if !finite(query, hint) => Err(ClosestError::NotFinite { query: *query }),
        Some(hint) => {
            let domain = surface.domain();
            let found = descend_surface(surface, None, &domain, query, hint);
            finish(&found, &domain, found.distance_mm)
        }
        None if !query.iter().all(|c| c.is_finite()) => Err(ClosestError::NotFinite { query: *query }),
        None => search::search(surface, query),
    }
}

/// [`closest`] for many queries on all threads, in their order. A hint for each query, or none at all: of hints
/// that are fewer than the queries the rest go without.
pub fn closest_batch(
    surface: &NurbsSurface,
    queries: &[Point3],
    hints: Option<&[Uv]>,
) -> Vec<Result<Foot, ClosestError>> {
    let hint = |k: usize| hints.and_then(|h| h.get(k).copied());
    if hints.is_none_or(|h| h.len() < queries.len()) {
        // Once, before the threads would wait for each other.
        surface.index();
    }
    // A chunk is worth waking a thread for.
    queries.par_iter().with_min_len(64).enumerate().map(|(k, q)| closest(surface, q, hint(k))).collect()
}

/// The nearest point in the neighbourhood of a hint: where the distance stops shrinking on the way down from
/// there. A parameter stops at the ends of its range and wraps where the surface is periodic.
///
/// # Errors
/// [`ClosestError::NotFinite`], [`ClosestError::NotConverged`].
pub fn closest_near<S: Surface + ?Sized>(
    surface: &S,
    query: &Point3,
    hint: Uv,
) -> Result<Foot, ClosestError> {
    if !finite(query, hint) {
        return Err(ClosestError::NotFinite { query: *query });
    }
    let domain = surface.domain();
    let found = descend(&Of(surface), &domain, query, hint);
    finish(&found, &domain, found.distance_mm)
}

fn finite(query: &Point3, hint: Uv) -> bool {
    query.iter().all(|c| c.is_finite()) && hint.u.is_finite() && hint.v.is_finite()
}

/// Most grid lines that [`closest_sampled`] lays in one direction.
const MAX_LINES: usize = 65;

/// Starts that [`closest_sampled`] follows down.
const STARTS: usize = 6;

/// The nearest point of any surface, from the nearest points of a grid: eight steps between neighbouring
/// breaks, fewer where that would be more than 64. Not certain: a feature smaller than the grid can be
/// missed.
///
/// # Errors
/// [`ClosestError::Unbounded`] where the domain has no end; otherwise as [`closest_near`].
pub fn closest_sampled(surface: &dyn Surface, query: &Point3) -> Result<Foot, ClosestError> {
    let domain = surface.domain();
    let lines = |axis: Axis| -> Result<Vec<f64>, ClosestError> {
        let i = domain.get(axis);
        if !(i.lo.is_finite() && i.hi.is_finite()) {
            return Err(ClosestError::Unbounded { axis });
        }
        let spans = surface.breaks(axis).len().max(2) - 1;
        let steps = if 8 * spans < MAX_LINES { 8 * spans } else { MAX_LINES - 1 };
        Ok((0..=steps).map(|k| i.at(k as f64 / steps as f64)).collect())
    };
    let (us, vs) = (lines(Axis::U)?, lines(Axis::V)?);
    let mut starts: Vec<(f64, Uv)> = Vec::with_capacity(STARTS + 1);
    for u in &us {
        for v in &vs {
            let at = Uv { u: *u, v: *v };
            let d = (surface.point(at) - query).norm_squared();
            if starts.len() < STARTS || d < starts[STARTS - 1].0 {
                starts.insert(starts.partition_point(|s| s.0 <= d), (d, at));
                starts.truncate(STARTS);
            }
        }
    }
    let mut best: Option<Result<Foot, ClosestError>> = None;
    for (_, at) in starts {
        let foot = closest_near(surface, query, at);
        let better = match (&best, &foot) {
            (None | Some(Err(_)), _) => true,
            (Some(Ok(old)), Ok(new)) => new.distance_mm < old.distance_mm,
            (Some(Ok(_)), Err(_)) => false,
        };
        if better {
            best = Some(foot);
        }
    }
    // A grid has four points or more, but all may be NaN.
    best.unwrap_or(Err(ClosestError::NotFinite { query: *query }))
}

/// The foot of a descent over the whole domain.
fn finish(found: &Found, domain: &Domain, gap_mm: f64) -> Result<Foot, ClosestError> {
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
