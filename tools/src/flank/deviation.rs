//! The deviation of an envelope over a patch of a surface: a grid of values and the extremes between its places.

use crate::flank::envelope::{Envelope, Scratch};
use osculate_geom::{Interval, Surface, Uv, uv};
use rayon::prelude::*;

/// Extremes of the grid that are followed between its places.
const FOLLOWED: usize = 40;
/// The search for an extreme ends when its step has shrunk by this much.
const FINEST: f64 = 1e-5;
/// Most moves and halvings of that search.
const MOST_MOVES: usize = 300;

/// Where a deviation is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Range of u, along the directrices.
    pub u: Interval,
    /// Range of v, along the rules.
    pub v: Interval,
    /// Places along u and v, at least two each.
    pub count: [usize; 2],
}

impl Patch {
    /// Parameters of the grid's places, by u and then v. Even steps in u; in v denser towards the ends of the rule, where
    /// the extremes are.
    #[must_use]
    pub fn parameters(&self) -> Vec<Uv> {
        let [nu, nv] = self.count.map(|n| n.max(2));
        let across = |k: usize| 0.5 - 0.5 * (std::f64::consts::PI * k as f64 / (nv - 1) as f64).cos();
        (0..nu)
            .flat_map(|i| {
                let u = self.u.at(i as f64 / (nu - 1) as f64);
                (0..nv).map(move |k| uv(u, self.v.at(across(k))))
            })
            .collect()
    }
}

/// A value and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Extreme {
    /// Deviation, mm.
    pub value_mm: f64,
    /// Where.
    pub at: Uv,
}

/// Deviations over a patch.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Deviation {
    /// The patch.
    pub patch: Patch,
    /// Parameters of the grid.
    pub at: Vec<Uv>,
    /// Deviation at each, mm: positive is material left.
    pub values_mm: Vec<f64>,
    /// The least value over the patch, the deepest gouge where negative.
    pub min: Extreme,
    /// The greatest value over the patch.
    pub max: Extreme,
}

impl Deviation {
    /// Greatest absolute value, mm.
    #[must_use]
    pub fn worst_mm(&self) -> f64 {
        self.max.value_mm.max(-self.min.value_mm)
    }
}

/// The deviation of an envelope from a surface over a patch. The result does not depend on the number of threads.
///
/// Extremes of the grid are followed between its places until the step is 1e-5 of the grid's: they are exact for
/// deviations that the grid resolves.
///
/// ```
/// use osculate_geom::{Interval, Point3, Side, analytic::Line};
/// use osculate_tools::Cutter;
/// use osculate_tools::flank::RuledStrip;
/// use osculate_tools::flank::axes::{AxisPoints, AxisSurface};
/// use osculate_tools::flank::cutter_side::CutterSide;
/// use osculate_tools::flank::deviation::{Patch, deviation};
/// use osculate_tools::flank::envelope::Envelope;
/// // A cylinder of radius 8 along a plane wall, 0.1 mm off it: that is left everywhere.
/// let edge = |z: f64| Line::segment(Point3::new(0.0, 0.0, z), Point3::new(50.0, 0.0, z));
/// let wall = RuledStrip::new(edge(0.0)?, edge(30.0)?, Side::Along, 1.0)?;
/// let at = |x: f64| AxisPoints { lower: Point3::new(x, -8.1, 0.0), upper: Point3::new(x, -8.1, 30.0) };
/// let positions: Vec<AxisPoints> = (-1..=6).map(|k| at(10.0 * f64::from(k))).collect();
/// let pieces = [AxisSurface::along(Interval::new(-0.2, 1.2), &positions)?];
/// let envelope = Envelope::new(CutterSide::of(&Cutter::cylinder(16.0, 60.0)?, -5.0), &pieces);
/// let patch = Patch { u: Interval::new(0.0, 1.0), v: Interval::new(0.0, 1.0), count: [9, 5] };
/// let found = deviation(&envelope, &wall, patch);
/// assert!((found.min.value_mm - 0.1).abs() < 1e-9 && (found.worst_mm() - 0.1).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn deviation(envelope: &Envelope<'_>, surface: &dyn Surface, patch: Patch) -> Deviation {
    let at = patch.parameters();
    let values_mm: Vec<f64> = at
        .par_iter()
        .map_init(Scratch::default, |scratch, uv| envelope.distance_mm(&surface.point(*uv), scratch))
        .collect();
    let [min, max] = [1.0, -1.0].map(|sign| extreme(envelope, surface, &patch, &at, &values_mm, sign));
    Deviation { patch, at, values_mm, min, max }
}

/// The least value of `sign` times the deviation.
fn extreme(
    envelope: &Envelope<'_>,
    surface: &dyn Surface,
    patch: &Patch,
    at: &[Uv],
    values: &[f64],
    sign: f64,
) -> Extreme {
    let nv = patch.count[1].max(2);
    let value = |k: usize| sign * values[k];
    let mut low: Vec<usize> = (0..values.len())
        .filter(|&k| {
            let j = k % nv;
            let beside = [
                (k >= nv).then(|| k - nv),
                (k + nv < values.len()).then(|| k + nv),
                (j > 0).then(|| k - 1),
                (j + 1 < nv).then(|| k + 1),
            ];
            beside.into_iter().flatten().all(|o| value(k) <= value(o))
        })
        .collect();
    low.sort_by(|a, b| value(*a).total_cmp(&value(*b)));
    low.truncate(FOLLOWED);
    let mut scratch = Scratch::default();
    let step = [patch.u.length() / (patch.count[0].max(2) - 1) as f64, patch.v.length() / nv as f64];
    let mut best = Extreme { value_mm: f64::INFINITY, at: at.first().copied().unwrap_or_default() };
    for k in low {
        // Compass search: halve the step where no neighbour is lower.
        let (mut here, mut f, mut size) = (at[k], value(k), 0.5);
        for _ in 0..MOST_MOVES {
            if size < FINEST {
                break;
            }
            let moves = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
            let lower = moves.iter().find_map(|[a, b]| {
                let u = (here.u + a * size * step[0]).clamp(patch.u.lo, patch.u.hi);
                let v = (here.v + b * size * step[1]).clamp(patch.v.lo, patch.v.hi);
                let there = uv(u, v);
                let g = sign * envelope.distance_mm(&surface.point(there), &mut scratch);
                (g < f).then_some((there, g))
            });
            match lower {
                Some((there, g)) => (here, f) = (there, g),
                None => size *= 0.5,
            }
        }
        if f < best.value_mm {
            best = Extreme { value_mm: f, at: here };
        }
    }
    Extreme { value_mm: sign * best.value_mm, at: best.at }
}
