//! Down to the nearest point of a surface from a start: Newton's method on `f = |S(u, v) - q|^2 / 2` in a
//! rectangle.
//!
//! ```text
//! f_a = (S - q) . S_a        f_ab = S_a . S_b + (S - q) . S_ab
//! ```
//!
//! A parameter at an end of its range is held there while `f` falls outwards. The step is Newton's where the
//! matrix of second derivatives is positive definite, Gauss's (without the second term) elsewhere, and is
//! shortened until `f` falls, so that the distance never grows.

use osculate_geom::solve::definite;
use osculate_geom::{Domain, Interval, Jet2, Point3, Surface, Uv, uv};

/// Where jets come from.
pub(super) trait Jets {
    /// The jet at parameters in the rectangle of the descent.
    fn jet(&self, at: Uv) -> Jet2;
}

/// Jets of any surface.
pub(super) struct Of<'a, S: ?Sized>(pub(super) &'a S);

impl<S: Surface + ?Sized> Jets for Of<'_, S> {
    fn jet(&self, at: Uv) -> Jet2 {
        self.0.jet2(at)
    }
}

/// Where a descent ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) uv: Uv,
    pub(super) point: Point3,
    pub(super) distance_mm: f64,
    /// As in [`super::Foot::residual`].
    pub(super) residual: f64,
    /// `(S - q) . S_u` and `(S - q) . S_v`.
    pub(super) gradient: [f64; 2],
    pub(super) steps: u32,
}

/// Steps at most. A good start takes three or four, a bad one over a wavy surface some twenty.
const MAX_STEPS: u32 = 60;

/// Shortenings of a step by four at most: then it is below a millionth of the first one.
const MAX_SHORTENINGS: u32 = 10;

/// A position is known to this fraction of the coordinates: two units in the last place.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A step below this fraction of the coordinates changes `f` by less than its rounding: no use in shortening
/// it.
const BLIND: f64 = 1e-10;

/// After a step of Newton's below this fraction of the coordinates, or of the piece's size times
/// [`PIECE`] where the part lies far from the origin, the next one, which goes like its square, would be lost in
/// rounding. The place that it leads to needs no jet of its own: what Taylor's second-order
/// polynomial leaves out of the point goes like the cube, 1e-15 of the coordinates where pieces are as small as
/// 1e-4 of them.
const LAST_STEP: f64 = 1e-9;

/// Pieces are seldom smaller than this part of the coordinates of a face around its origin.
const PIECE: f64 = 16.0;

/// Squared sine between the columns of a step's matrix (in its own metric) below which it is not solved.
const SINGULAR: f64 = 1e-13;

/// First-order data at a place.
struct State {
    jet: Jet2,
    /// `|S - q|^2`.
    square: f64,
    gradient: [f64; 2],
    /// Squared lengths of S_u and S_v.
    metric: [f64; 2],
    held: [bool; 2],
}

impl State {
    /// Square of the offset's part along the free directions, the larger of both, mm2. Only computed where it
    /// decides: roots and quotients are half of what a step costs beyond the jet.
    fn along_square(&self) -> f64 {
        let along = |k: usize| {
            if self.held[k] || self.metric[k] == 0.0 {
                0.0
            } else {
                self.gradient[k] * self.gradient[k] / self.metric[k]
            }
        };
        along(0).max(along(1))
    }
}

#[inline(always)]
fn state(jet: Jet2, rect: &Domain, query: &Point3) -> State {
    let r = jet.point - query;
    let gradient = [r.dot(&jet.du), r.dot(&jet.dv)];
    let metric = [jet.du.norm_squared(), jet.dv.norm_squared()];
    let hold = |i: &Interval, t: f64, g: f64| {
        // At rest at an end counts as held too: the edge is where it wants to be.
        !i.periodic && ((t <= i.lo && g > 0.0) || (t >= i.hi && g < 0.0))
    };
    let held = [hold(&rect.u, jet.uv.u, gradient[0]), hold(&rect.v, jet.uv.v, gradient[1])];
    State { jet, square: r.norm_squared(), gradient, metric, held }
}

/// The nearest point reached from `start`, brought into `rect` first.
#[inline(always)]
pub(super) fn descend<J: Jets>(jets: &J, rect: &Domain, query: &Point3, start: Uv) -> Found {
    let mut here = state(jets.jet(place(rect, start)), rect, query);
    let size = here.jet.point.coords.norm() + query.coords.norm();
    let last_square = square(LAST_STEP) * square(size).min(piece_square(rect, &here));
    let settled = |s: &State| s.along_square() <= square(ROUNDING * size);
    let mut steps = 0;
    while steps < MAX_STEPS {
        steps += 1;
        let (step, newton) = next_step(&here, query);
        let target = |scale: f64| {
            let uv = here.jet.uv;
            place(rect, uv_minus(uv, step, scale))
        };
        // What is left of the step inside the rectangle, over a seam all of it; never too short.
        let to = target(1.0);
        let part = |i: &Interval, step: f64, from: f64, to: f64| if i.periodic { step } else { to - from };
        let du = part(&rect.u, step[0], here.jet.uv.u, to.u);
        let dv = part(&rect.v, step[1], here.jet.uv.v, to.v);
        let length_square = 2.0 * (here.metric[0] * du * du + here.metric[1] * dv * dv);
        if length_square <= square(ROUNDING * size) || length_square.is_nan() {
            break;
        }
        let inside = to == uv_minus(here.jet.uv, step, 1.0);
        if newton && inside && length_square <= last_square {
            let last = state(moved(&here.jet, to, step), rect, query);
            if settled(&last) {
                here = last;
                break;
            }
        }
        let mut scale = 1.0;
        let mut at = to;
        let mut next = None;
        for _ in 0..=MAX_SHORTENINGS {
            let there = state(jets.jet(at), rect, query);
            // Near the foot the distances differ by rounding of coordinates alone; there the offset's part
            // along the surface decides.
            let same = || {
                there.square <= here.square + 2.0 * ROUNDING * size * (here.square.sqrt() + ROUNDING * size)
            };
            if there.square < here.square || (same() && there.along_square() < here.along_square()) {
                next = Some(there);
                break;
            }
            if length_square <= square(BLIND * size) {
                break;
            }
            scale *= 0.25;
            at = target(scale);
        }
        match next {
            Some(there) => here = there,
            None => break,
        }
        let done = length_square * scale * scale;
        if done <= square(ROUNDING * size) || (newton && done <= last_square && settled(&here)) {
            break;
        }
    }
    let distance_mm = here.square.sqrt();
    // An offset of a few roundings has no direction.
    let residual = if distance_mm <= 16.0 * ROUNDING * size {
        0.0
    } else {
        noise_free(here.along_square().sqrt(), size) / distance_mm
    };
    let gradient = here.gradient;
    Found { uv: here.jet.uv, point: here.jet.point, distance_mm, residual, gradient, steps }
}

/// The square of [`PIECE`] times the size of the rectangle's image, as the start sees it; infinite for an
/// unlimited one.
#[inline(always)]
fn piece_square(rect: &Domain, start: &State) -> f64 {
    let wide = |i: &Interval, metric: f64| metric * square(i.hi - i.lo);
    let sum = square(PIECE) * (wide(&rect.u, start.metric[0]) + wide(&rect.v, start.metric[1]));
    // A collapsed start says nothing about the size.
    if sum > 0.0 { sum } else { f64::INFINITY }
}

/// The parameters in the rectangle, at its end where they are only rounding away from it: a parameter just
/// inside an end could neither be held nor move.
#[inline(always)]
fn place(rect: &Domain, at: Uv) -> Uv {
    let snap = |i: &Interval, t: f64| {
        let near = ROUNDING * i.lo.abs().max(i.hi.abs());
        if i.periodic || !near.is_finite() {
            t
        } else if t - i.lo <= near {
            i.lo
        } else if i.hi - t <= near {
            i.hi
        } else {
            t
        }
    };
    let inside = at.u >= rect.u.lo && at.u <= rect.u.hi && at.v >= rect.v.lo && at.v <= rect.v.hi;
    let at = if inside { at } else { rect.bring(at) };
    uv(snap(&rect.u, at.u), snap(&rect.v, at.v))
}

/// The jet a step further, by Taylor's polynomial.
fn moved(jet: &Jet2, to: Uv, [s, t]: [f64; 2]) -> Jet2 {
    let (uu, uv, vv) = (jet.duu * s, jet.duv, jet.dvv * t);
    let half = (uu * s + vv * t) * 0.5 + uv * (s * t);
    Jet2 {
        uv: to,
        point: jet.point - jet.du * s - jet.dv * t + half,
        du: jet.du - uu - uv * t,
        dv: jet.dv - uv * s - vv,
        ..*jet
    }
}

#[inline(always)]
fn uv_minus(at: Uv, step: [f64; 2], scale: f64) -> Uv {
    uv(at.u - scale * step[0], at.v - scale * step[1])
}

const fn square(x: f64) -> f64 {
    x * x
}

/// A length less what rounding of coordinates of this size can make of nothing.
fn noise_free(length_mm: f64, size: f64) -> f64 {
    if length_mm <= ROUNDING * size { 0.0 } else { length_mm }
}

/// The step to subtract from the parameters, and whether it is Newton's.
#[inline(always)]
fn next_step(here: &State, query: &Point3) -> ([f64; 2], bool) {
    let j = &here.jet;
    let r = j.point - query;
    let [e, g] = here.metric;
    let f = j.du.dot(&j.dv);
    let full = [e + r.dot(&j.duu), f + r.dot(&j.duv), g + r.dot(&j.dvv)];
    match definite(full, here.gradient, here.held, SINGULAR) {
        Some(step) => (step, true),
        None => {
            // Lifted by a little of itself, so that a direction without length moves by a finite amount.
            let lift = 1e-12 * (e + g);
            (
                definite([e + lift, f, g + lift], here.gradient, here.held, SINGULAR).unwrap_or([0.0, 0.0]),
                false,
            )
        }
    }
}
