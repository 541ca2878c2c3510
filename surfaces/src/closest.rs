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
mod cell;
mod descent;
mod face;
mod foot;
mod index;
mod search;
mod tree;
mod way;

use crate::nurbs::NurbsSurface;
use descent::{Of, descend};
pub use face::FaceSearch;
pub use foot::{ClosestError, Foot, FootKind};
use foot::{finish, finite};
use osculate_geom::{Axis, Point3, Surface, Uv};
use rayon::prelude::*;
pub(crate) use tree::Index;
use way::descend_surface;

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
/// ```
/// use osculate_geom::{Point3, analytic::Torus, uv};
/// use osculate_surfaces::closest_near;
/// // Beside a ring of radii 50 and 10 on the x axis: 40 mm from the side that the hint is on.
/// let ring = Torus::new(50.0, 10.0)?;
/// let foot = closest_near(&ring, &Point3::new(100.0, 0.0, 0.0), uv(0.1, 0.1))?;
/// assert!((foot.distance_mm - 40.0).abs() < 1e-9 && foot.uv.v.abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// Most grid lines that [`closest_sampled`] lays in one direction.
const MAX_LINES: usize = 65;

/// Starts that [`closest_sampled`] follows down.
const STARTS: usize = 6;

/// The nearest point of any surface, from the nearest points of a grid: eight steps between neighbouring
/// breaks, fewer where that would be more than 64. Not certain: a feature smaller than the grid can be
/// missed.
///
/// ```
/// use osculate_geom::{Interval, Point3, analytic::Cylinder};
/// use osculate_surfaces::{ClosestError, FootKind, closest_sampled};
/// // Above the end of a shaft of radius 10: on its rim.
/// let shaft = Cylinder::new(10.0, Interval::new(0.0, 50.0))?;
/// let foot = closest_sampled(&shaft, &Point3::new(13.0, 0.0, 54.0))?;
/// assert!((foot.distance_mm - 5.0).abs() < 1e-9 && foot.kind == FootKind::Edge);
/// // A shaft without ends has no grid.
/// let endless = Cylinder::new(10.0, Interval::new(f64::NEG_INFINITY, f64::INFINITY))?;
/// assert!(matches!(closest_sampled(&endless, &Point3::origin()), Err(ClosestError::Unbounded { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
