//! The posture of greatest productivity at a point: tool, direction of feed, lead, tilt and split of the tolerance.
//!
//! What is made greatest is the area per minute of [`Rate`](crate::rate::Rate): the exact strip
//! ([`exact`](osculate_tools::strip::exact)) times the feed that tooth marks ([`mark`](osculate_tools::strip::mark())), cutter
//! and machine allow. To leading order the strip is widest across the eigenvector of Q's
//! larger eigenvalue, and wider the nearer Q comes to losing its definiteness; there the leading order fails and the
//! exact strip takes over, with two contacts on hollow places [M86, 5C]: where the tool would dip below the part by more
//! than is accepted it is lifted by the rest.
//!
//! The search ranks a grid of postures by their leading order, measures the best of each neighbourhood exactly and
//! settles the best few by coordinate searches. It is a heuristic with a measured miss, not a proof.

mod posture;
mod search;
mod settle;

pub(crate) use posture::check;
pub use posture::{AxisCone, Binding, Limits, Measured, Optimum, OptimumError, Posture, Range, measure};

use osculate_geom::{Surface, Uv};
use osculate_tools::Cutter;
use osculate_tools::strip::StripError;
use search::Search;
use std::f64::consts::TAU;

/// The best posture of the best tool at a point.
///
/// ```
/// use osculate_geom::{Domain, Interval, analytic::Plane, uv};
/// use osculate_productivity::{optimum::{self, Limits, Range}, rate::Caps};
/// use osculate_tools::{Cutter, CutterSpec};
///
/// let plane = Plane::new(Domain { u: Interval::new(-30.0, 30.0), v: Interval::new(-30.0, 30.0) });
/// let ball = |diameter_mm| Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: 50.0 });
/// let tools = [ball(6.0)?, ball(10.0)?];
/// let limits = Limits {
///     scallop_mm: 0.01,
///     gouge_mm: 0.001,
///     lead: Range { least_rad: 0.1, most_rad: 0.5 },
///     tilt: Range::only(0.0),
///     axis: None,
///     caps: Caps::of_feed(2000.0),
/// };
/// // On a plane the larger ball, whichever way it goes: a strip of 2 sqrt(h (2 R - h)) at 2 m a minute, less the ten thousandth
/// // of h that tooth marks get at least.
/// let best = optimum::at(&plane, uv(0.0, 0.0), &tools, &limits)?;
/// let width_mm = 2.0 * f64::sqrt(0.01 * (10.0 - 0.01));
/// assert_eq!(best.tool, 1);
/// let ratio = best.rate.area_mm2_min / (2000.0 * width_mm);
/// assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`OptimumError`].
pub fn at(surface: &dyn Surface, at: Uv, tools: &[Cutter], limits: &Limits) -> Result<Optimum, OptimumError> {
    check(tools, limits)?;
    let mut best: Option<Optimum> = None;
    let mut last = StripError::Tolerance { got: limits.scallop_mm };
    for (tool, cutter) in tools.iter().enumerate() {
        let mut search = Search::new(surface, at, cutter, limits)?;
        if let Some((posture, m)) = search.run() {
            let better = best.is_none_or(|b| m.rate.area_mm2_min > b.rate.area_mm2_min);
            if better {
                best = Some(Optimum {
                    tool,
                    direction_rad: posture.direction_rad.rem_euclid(TAU),
                    lean: posture.lean,
                    lift_mm: m.lift_mm,
                    share: m.share,
                    rate: m.rate,
                    undercut_mm: m.undercut_mm,
                    binding: search.binding(&posture, &m),
                    evaluations: search.evaluations,
                    exact: search.exact,
                });
            }
        }
        last = search.last.unwrap_or(last);
    }
    best.ok_or(OptimumError::None { at, last })
}
