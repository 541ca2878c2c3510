//! Parameters of points that lie on a surface or close to it, by tracking: Newton's method from the parameters of the
//! point before, on a rectangle whose sides may be joined.
//!
//! Minimises `|S(u, v) - p|^2`. A step that leaves the rectangle stops at an open side and goes on behind a joined
//! one. [`crate::closest`] answers the general question; this one is for the hundreds of thousands of boundary points
//! of a part, all with a neighbour at hand.

use osculate_geom::solve::definite;
use osculate_geom::{Axis, Interval, Point3, Surface, Uv, uv};

/// What is searched.
pub(crate) struct Target<'a> {
    /// The surface.
    pub(crate) surface: &'a dyn Surface,
    /// Directions whose sides are joined.
    pub(crate) closes: [bool; 2],
    /// The point in space.
    pub(crate) point: Point3,
}

/// Squared sine between the directions of the two parameters below which the matrix counts as singular.
const SINGULAR: f64 = 1e-14;

/// Newton steps at most. From a neighbour on the same curve three are usual; a start from a grid takes ten.
const MAX_STEPS: u32 = 40;

/// `t` brought into the interval.
fn bring(t: f64, i: Interval, closes: bool) -> f64 {
    if closes && !(t >= i.lo && t <= i.hi) {
        let r = (t - i.lo).rem_euclid(i.length()) + i.lo;
        if r.is_finite() { r } else { i.lo }
    } else {
        t.clamp(i.lo, i.hi)
    }
}

/// The nearest point reached from `start`: parameters within the rectangle and the distance, mm.
pub(crate) fn newton(target: &Target<'_>, start: Uv) -> (Uv, f64) {
    let domain = target.surface.domain();
    let place = |p: Uv| uv(bring(p.u, domain.u, target.closes[0]), bring(p.v, domain.v, target.closes[1]));
    let mut at = place(start);
    let mut jet = target.surface.jet2(at);
    let mut distance = (jet.point - target.point).norm();
    for _ in 0..MAX_STEPS {
        let r = jet.point - target.point;
        let g = [r.dot(&jet.du), r.dot(&jet.dv)];
        let (e, f, h) = (jet.du.dot(&jet.du), jet.du.dot(&jet.dv), jet.dv.dot(&jet.dv));
        // A direction is held where the point sits on an open side and wants to go out.
        let held = [
            !target.closes[0] && ((at.u <= domain.u.lo && g[0] > 0.0) || (at.u >= domain.u.hi && g[0] < 0.0)),
            !target.closes[1] && ((at.v <= domain.v.lo && g[1] > 0.0) || (at.v >= domain.v.hi && g[1] < 0.0)),
        ];
        let full = [e + r.dot(&jet.duu), f + r.dot(&jet.duv), h + r.dot(&jet.dvv)];
        let step = definite(full, g, held, SINGULAR)
            .or_else(|| {
                // Gauss and Newton's matrix, lifted where the surface has no tangent plane.
                let lift = 1e-12 * (e + h) + 1e-300;
                definite([e + lift, f, h + lift], g, held, SINGULAR)
            })
            .unwrap_or([0.0, 0.0]);
        // Halve until the distance shrinks.
        let mut scale = 1.0;
        let mut moved = false;
        for _ in 0..12 {
            let next = place(uv(at.u - scale * step[0], at.v - scale * step[1]));
            let there = target.surface.jet2(next);
            let d = (there.point - target.point).norm();
            if d < distance {
                moved = true;
                at = next;
                jet = there;
                distance = d;
                break;
            }
            scale *= 0.25;
        }
        let length = (step[0] * step[0] * e + step[1] * step[1] * h).sqrt();
        if !moved || scale * length <= 1e-15 * (jet.point.coords.norm() + length) {
            break;
        }
    }
    (at, distance)
}

/// Points of a surface on a grid, for a start without neighbour.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seeds {
    points: Vec<(Uv, Point3)>,
}

/// Most grid lines in one direction.
const MAX_LINES: usize = 96;

impl Seeds {
    /// A grid between the breaks of the surface.
    pub(crate) fn new(surface: &dyn Surface) -> Self {
        let lines = |axis: Axis| -> Vec<f64> {
            let breaks = surface.breaks(axis);
            let per_span = (MAX_LINES / breaks.len().max(1)).clamp(1, 8);
            let mut ts = Vec::new();
            for w in breaks.windows(2) {
                ts.extend((0..per_span).map(|k| w[0] + (w[1] - w[0]) * k as f64 / per_span as f64));
            }
            ts.push(surface.domain().get(axis).hi);
            let stride = ts.len().div_ceil(MAX_LINES);
            ts.into_iter().step_by(stride).collect()
        };
        let (us, vs) = (lines(Axis::U), lines(Axis::V));
        let mut points = Vec::with_capacity(us.len() * vs.len());
        for u in &us {
            for v in &vs {
                let at = uv(*u, *v);
                points.push((at, surface.point(at)));
            }
        }
        Self { points }
    }

    /// The nearest point found from the best grid points.
    pub(crate) fn global(&self, target: &Target<'_>) -> (Uv, f64) {
        // The eight nearest grid points: enough to reach both sides of a thin part.
        let mut best: Vec<(f64, Uv)> = Vec::with_capacity(9);
        for (at, p) in &self.points {
            let d = (p - target.point).norm_squared();
            if best.len() < 8 || d < best[best.len() - 1].0 {
                let k = best.partition_point(|b| b.0 <= d);
                best.insert(k, (d, *at));
                best.truncate(8);
            }
        }
        let mut result = (target.surface.domain().at(0.5, 0.5), f64::INFINITY);
        for (_, start) in best {
            let got = newton(target, start);
            if got.1 < result.1 {
                result = got;
            }
        }
        result
    }
}
