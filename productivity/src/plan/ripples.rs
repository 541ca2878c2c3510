//! The mean of a face's normals over a short stretch of a line: a tool's axis and contact are not to swing with every ripple between knots.

use crate::rectangle::Rectangle;
use osculate_geom::{Axis, Surface, Unit3, Uv, Vec3};

/// The normal is averaged over this part of the tool's radius to both sides, or less where knots stand closer.
pub(super) const AVERAGE: f64 = 0.05;
/// ... and over this part of the knot span: ripples have the length of one or two spans.
const SPANS: f64 = 0.75;
/// Places to each side of one that count, the nearer the more.
const PLACES: i32 = 3;

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

/// Knots of a face, fetched once, and how far normals are averaged between them.
pub(crate) struct Ripples {
    breaks: [Vec<f64>; 2],
    /// The face's parameters and where it meets itself.
    pub(super) rectangle: Rectangle,
    radius_mm: f64,
}

impl Ripples {
    /// Those of a face as a tool of this radius sees them.
    pub(crate) fn new(surface: &dyn Surface, radius_mm: f64) -> Self {
        let breaks = [surface.breaks(Axis::U), surface.breaks(Axis::V)];
        Self { breaks, rectangle: Rectangle::of(surface), radius_mm }
    }

    /// The knots along a parameter.
    pub(super) fn breaks(&self, axis: Axis) -> &[f64] {
        &self.breaks[usize::from(axis == Axis::V)]
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
    pub(crate) fn mean_normal(&self, surface: &dyn Surface, at: Uv, way: &Vec3) -> Option<Unit3> {
        let jet = surface.jet2(at);
        let rate = jet.forms().ok()?.rate(&jet, way);
        let reach = self.reach(at, rate, jet.tangent(rate).norm());
        let mut sum = Vec3::zeros();
        for (share, weight) in places() {
            let by = reach * share;
            let next = Uv { u: at.u + rate.u * by, v: at.v + rate.v * by };
            sum += surface.jet2(self.rectangle.held(next).0).normal().ok()?.into_inner() * weight;
        }
        Unit3::try_new(sum, 1e-6)
    }
}

/// The places of a mean, as shares of its reach, and what they count.
pub(super) fn places() -> impl Iterator<Item = (f64, f64)> {
    (-PLACES..=PLACES).map(|k| {
        let k = f64::from(k);
        (k / f64::from(PLACES), f64::from(PLACES) + 1.0 - k.abs())
    })
}
