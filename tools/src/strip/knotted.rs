//! A surface with its knots: geodesics that are stepped from knot to knot.
//!
//! Across a knot the second derivatives of a cubic spline have a kink, and a Runge-Kutta step over it is only good to third
//! order. Between knots the surface is one polynomial, which says how closely it must be looked at to see all its waves.

use osculate_geom::geodesic::GeodesicState;
use osculate_geom::{Axis, Degenerate, Surface, Uv};

/// Knots that a step may meet one after the other.
const MOST_KNOTS: u32 = 4;
/// How near a knot a state is taken to be on it, of the step: what a kink that near does is of its cube.
const KNOT_FOUND: f64 = 1e-6;
const KNOT_SLACK: f64 = 1e-5;
/// Cuts of a step over a knot that is not found: the error falls with their cube.
const CUTS: u32 = 16;

/// A surface with its knots.
pub(super) struct Knotted<'a> {
    pub surface: &'a dyn Surface,
    /// Where the surface is less smooth, along u and along v.
    breaks: [Vec<f64>; 2],
}

impl<'a> Knotted<'a> {
    pub(super) fn new(surface: &'a dyn Surface) -> Self {
        Self { surface, breaks: [surface.breaks(Axis::U), surface.breaks(Axis::V)] }
    }

    /// The least distance of knots on a line that leaves `at` with `rate` (per mm), as far as `reach_mm` to both sides, mm;
    /// infinite without knots.
    pub(super) fn pitch_mm(&self, at: Uv, rate: Uv, reach_mm: f64) -> f64 {
        let mut least = f64::INFINITY;
        for (axis, breaks) in [Axis::U, Axis::V].into_iter().zip(&self.breaks) {
            let (x, r) = (at.get(axis), rate.get(axis).abs());
            let first = breaks.partition_point(|t| *t <= x - reach_mm * r).saturating_sub(1);
            for pair in breaks[first..].windows(2).take_while(|pair| pair[0] < x + reach_mm * r) {
                least = least.min((pair[1] - pair[0]) / r);
            }
        }
        least
    }

    /// Whether no knot lies between two states of a line.
    pub(super) fn is_clear(&self, from: &GeodesicState, to: &GeodesicState) -> bool {
        self.first_knot(from, to).is_none()
    }

    /// A geodesic `x` mm further on. A step over knots, where the line's own equation has a kink, is taken from knot to
    /// knot, and cut small where these are not found.
    pub(super) fn advance(&self, here: &GeodesicState, x: f64) -> Result<GeodesicState, Degenerate> {
        let surface = self.surface;
        let (mut state, mut left) = (*here, x);
        for _ in 0..MOST_KNOTS {
            let whole = state.step(surface, left)?;
            let Some((axis, knot)) = self.first_knot(&state, &whole) else { return Ok(whole) };
            let Some((at, way)) = on_knot(surface, &state, (axis, knot), left)? else { break };
            (state, left) = (at, left - way);
        }
        for _ in 0..CUTS {
            state = state.step(surface, left / f64::from(CUTS))?;
        }
        Ok(state)
    }

    /// The knot that a step meets first, by the share of the way in its parameter.
    fn first_knot(&self, from: &GeodesicState, to: &GeodesicState) -> Option<(Axis, f64)> {
        let mut first: Option<(f64, Axis, f64)> = None;
        for (axis, breaks) in [Axis::U, Axis::V].into_iter().zip(&self.breaks) {
            let (a, b) = (from.at.get(axis), to.at.get(axis));
            // A start on the knot itself, to rounding, has passed it.
            let slack = KNOT_SLACK * (b - a).abs();
            let knot = if b > a {
                breaks.get(breaks.partition_point(|t| *t <= a + slack)).filter(|t| **t < b)
            } else {
                let below = breaks.partition_point(|t| *t < a - slack);
                below.checked_sub(1).map(|k| &breaks[k]).filter(|t| **t > b)
            };
            if let Some(t) = knot {
                let share = (t - a) / (b - a);
                if first.is_none_or(|f| share < f.0) {
                    first = Some((share, axis, *t));
                }
            }
        }
        first.map(|f| (f.1, f.2))
    }
}

/// The state on a knot within a step of length `x`, and the way there; None where Newton's method does not find it.
fn on_knot(
    surface: &dyn Surface,
    from: &GeodesicState,
    (axis, knot): (Axis, f64),
    x: f64,
) -> Result<Option<(GeodesicState, f64)>, Degenerate> {
    let mut way = (knot - from.at.get(axis)) / from.rate.get(axis);
    for _ in 0..4 {
        if !(way / x > 0.0 && way / x < 1.0) {
            return Ok(None);
        }
        let state = from.step(surface, way)?;
        let off = (knot - state.at.get(axis)) / state.rate.get(axis);
        if off.abs() <= KNOT_FOUND * x.abs() {
            return Ok(Some((state, way)));
        }
        way += off;
    }
    Ok(None)
}
