//! The mean of a face's normals over a short stretch of a line: a tool's axis and contact are not to swing with every ripple between knots.

use crate::rectangle::Rectangle;
use osculate_geom::{Axis, Jet2, Surface, Unit3, Uv, Vec3};
use rayon::prelude::*;

/// The normal is averaged over this part of the tool's radius to both sides, or less where knots stand closer.
pub(super) const AVERAGE: f64 = 0.05;
/// ... and over so many knot spans: ripples have the length of one or two. (Tuned on a turbine blade with a cutter of 6 mm by the time on
/// the control, min: 0.75 spans 10.96, 1.5 9.34, 3 8.58, 6 and 20 8.32.)
const SPANS: f64 = 6.0;
/// Places to each side of one that count.
pub(super) const PLACES: i32 = 3;

/// Normals to both sides of a crease differ by more than this, rad, so far from it as a part of the knot spans beside it.
const CREASE_RAD: f64 = 0.01;
const BESIDE: f64 = 1e-6;
/// Where across a face its knots are asked, as shares of the other parameter.
const ACROSS: [f64; 5] = [0.02, 0.25, 0.5, 0.75, 0.98];

/// Length of the knot spans around a parameter, in the parameter: that of a span in its middle, and even from there to the next one's, so
/// that nothing that is looked for as far as a span jumps from one to the next.
fn span_at(breaks: &[f64], t: f64) -> f64 {
    let last = breaks.len() - 1;
    let k = breaks.partition_point(|b| *b <= t).clamp(1, last);
    let length = |k: usize| breaks[k] - breaks[k - 1];
    let middle = |k: usize| 0.5 * (breaks[k] + breaks[k - 1]);
    let next = if t < middle(k) { k.max(2) - 1 } else { (k + 1).min(last) };
    if next == k {
        return length(k);
    }
    let share = (t - middle(k)) / (middle(next) - middle(k));
    length(k) + (length(next) - length(k)) * share
}

/// The knots along a parameter at which the normals of a face jump, with both ends where it meets itself in a crease.
fn creases(surface: &dyn Surface, axis: Axis, breaks: &[f64], closes: bool) -> Vec<f64> {
    let across = surface.domain().get(axis.other());
    let jumps = |before: f64, after: f64| {
        ACROSS.iter().any(|share| {
            let normal = |t: f64| surface.jet2(Uv::from_axis(axis, t, across.at(*share))).normal();
            matches!([before, after].map(normal), [Ok(a), Ok(b)] if a.angle(&b) > CREASE_RAD)
        })
    };
    let last = breaks.len() - 1;
    let before = |k: usize| breaks[k] - BESIDE * (breaks[k] - breaks[k - 1]);
    let after = |k: usize| breaks[k] + BESIDE * (breaks[k + 1] - breaks[k]);
    let round = closes && jumps(before(last), after(0));
    let is_crease = |k: &usize| if *k == 0 || *k == last { round } else { jumps(before(*k), after(*k)) };
    (0..=last).into_par_iter().filter(is_crease).map(|k| breaks[k]).collect()
}

/// Knots of a face, fetched once, and how far normals are averaged between them.
pub(crate) struct Ripples {
    breaks: [Vec<f64>; 2],
    creases: [Vec<f64>; 2],
    /// The face's parameters and where it meets itself.
    pub(super) rectangle: Rectangle,
    radius_mm: f64,
}

impl Ripples {
    /// Those of a face as a tool of this radius sees them.
    pub(crate) fn new(surface: &dyn Surface, radius_mm: f64) -> Self {
        let breaks = [Axis::U, Axis::V].map(|axis| surface.breaks(axis));
        let rectangle = Rectangle::of(surface);
        let creases = [Axis::U, Axis::V].map(|axis| {
            creases(surface, axis, &breaks[usize::from(axis == Axis::V)], rectangle.closes(axis))
        });
        Self { breaks, creases, rectangle, radius_mm }
    }

    /// The knots along a parameter.
    pub(super) fn breaks(&self, axis: Axis) -> &[f64] {
        &self.breaks[usize::from(axis == Axis::V)]
    }

    /// Those of them at which the face has a crease.
    pub(super) fn creases(&self, axis: Axis) -> &[f64] {
        &self.creases[usize::from(axis == Axis::V)]
    }

    /// Length of the knot span around a value of a parameter, in the parameter.
    pub(super) fn span(&self, axis: Axis, t: f64) -> f64 {
        span_at(self.breaks(axis), t)
    }

    /// How far to each side of a place of a line normals are averaged, in the line's parameter: the line's `rate` by it, and its `speed`.
    pub(super) fn reach(&self, at: Uv, rate: Uv, speed: f64) -> f64 {
        let at = self.rectangle.domain.bring(at);
        let of = |axis: Axis| self.span(axis, at.get(axis)) / rate.get(axis).abs();
        (AVERAGE * self.radius_mm / speed.abs().max(1e-12)).min(SPANS * of(Axis::U).min(of(Axis::V)))
    }

    /// The normal at a place averaged along a line through it in a direction, `way`, as a pass' is. None where the face has none.
    pub(crate) fn mean_normal(&self, surface: &dyn Surface, jet: &Jet2, way: &Vec3) -> Option<Unit3> {
        let at = jet.uv;
        let rate = jet.forms().ok()?.rate(jet, way);
        let reach = self.reach(at, rate, jet.tangent(rate).norm());
        let mut sum = Vec3::zeros();
        for (share, weight) in places(PLACES) {
            let by = reach * share;
            let next = Uv { u: at.u + rate.u * by, v: at.v + rate.v * by };
            sum += surface.jet2(self.rectangle.held(next).0).normal().ok()?.into_inner() * weight;
        }
        Unit3::try_new(sum, 1e-6)
    }
}

/// The places of a mean, so many to each side, as shares of its reach, and what they count: the nearer the more.
pub(super) fn places(sides: i32) -> impl Iterator<Item = (f64, f64)> {
    let most = f64::from(sides);
    (-sides..=sides).map(move |k| {
        let k = f64::from(k);
        (k / most, most + 1.0 - k.abs())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Point3;
    use osculate_surfaces::{Net, NurbsSurface};

    /// A strip of width 2 over points of a line in a plane, of some degree in u with a knot wherever it can have one.
    fn strip(degree: usize, line: &[[f64; 2]]) -> NurbsSurface {
        let n = line.len();
        let points = line.iter().flat_map(|[x, z]| [0.0, 2.0].map(|y| Point3::new(*x, y, *z))).collect();
        let last = (n - degree) as f64;
        let inner = (1..n - degree).map(|k| k as f64);
        let ends = |t: f64| std::iter::repeat_n(t, degree + 1);
        let knots = ends(0.0).chain(inner).chain(ends(last)).collect();
        NurbsSurface::new(
            [degree, 1],
            [knots, vec![0.0, 0.0, 1.0, 1.0]],
            Net { count: [n, 2], points, weights: None },
        )
        .unwrap()
    }

    #[test]
    fn a_knot_is_a_crease_only_where_the_normal_jumps() {
        let open = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 1.0], [4.0, 2.0], [5.0, 2.0]];
        let at = |surface: &NurbsSurface, axis| Ripples::new(surface, 3.0).creases(axis).to_vec();
        // The line bends at its third and fifth point only: the other knots are none, nor are its ends.
        let bent = strip(1, &open);
        assert_eq!(Ripples::new(&bent, 3.0).breaks(Axis::U).len(), 6);
        assert_eq!(at(&bent, Axis::U), [2.0, 4.0]);
        assert_eq!(at(&bent, Axis::V), [0.0; 0]);
        // The same points as poles of a quadric: its tangent is steady over every knot.
        assert_eq!(at(&strip(2, &open), Axis::U), [0.0; 0]);
        // A square closes in an edge: both ends of its seam are one.
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
        assert_eq!(at(&strip(1, &square), Axis::U), [0.0, 1.0, 2.0, 3.0, 4.0]);
        // Cut in the middle of a side it closes without one.
        let cut = [[0.5, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [0.5, 0.0]];
        assert_eq!(at(&strip(1, &cut), Axis::U), [1.0, 2.0, 3.0, 4.0]);
    }
}
