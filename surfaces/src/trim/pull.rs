//! Space curves pulled onto a surface: polylines of parameters, followed continuously across closing sides.
//!
//! The curve is sampled from its middle outwards, so that an end in a pole takes the parameter of its neighbour, and
//! refined until the middle of every piece is within the chord tolerance of the straight parameter line. A piece is then
//! two straight lines whose corner makes up for the area between chord and arc.

use super::carrier::Carrier;
use super::curve::Curve;
use osculate_geom::{Axis, Uv, uv};
use std::cell::Cell;

/// Lengths that a pull compares with, mm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tolerance {
    /// Largest distance, measured on the surface, of the polyline from the curve.
    pub(crate) chord_mm: f64,
    /// A curve point farther from the surface than this is looked for elsewhere on it.
    pub(crate) near_mm: f64,
    /// A curve that is farther from the surface than this somewhere is not refined: it is no boundary of it.
    pub(crate) far_mm: f64,
}

/// A curve on a surface.
#[derive(Clone, Debug)]
pub(crate) struct Pulled {
    /// Unwrapped parameters along the curve.
    pub(crate) points: Vec<Uv>,
    /// Largest distance between curve and surface, mm.
    pub(crate) gap_mm: f64,
}

/// Pieces between the breaks of a curve before refinement. Eight see any inflection of a cubic or a conic's quarter.
const START_PIECES: usize = 8;

/// Halvings of a start piece at most: an eighth of a circle takes seven; below 2^-10 a kink is being chased.
const MAX_DEPTH: u32 = 10;

/// Points nearer to the end of a range than this fraction of it are asked whether they lie in a pole.
const POLE: f64 = 1e-6;

/// Samples of one curve at most, a bound for hostile input. A curve of a hundred spans takes 5000.
const MAX_POINTS: usize = 20_000;

/// Pulls a curve with parameter range `[0, 1]`.
pub(crate) fn pull(curve: &dyn Curve, carrier: &Carrier, tolerance: Tolerance) -> Pulled {
    let mut breaks = vec![0.0];
    breaks.extend(curve.breaks());
    breaks.push(1.0);
    let stride = breaks.len().div_ceil(4000);
    let last = breaks.len() - 1;
    let breaks: Vec<f64> =
        breaks.iter().enumerate().filter(|(k, _)| k % stride == 0 || *k == last).map(|b| *b.1).collect();
    let pieces = (START_PIECES * 4 / breaks.len()).clamp(2, START_PIECES);
    let mut ts = vec![0.0];
    for w in breaks.windows(2) {
        ts.extend(
            (1..=pieces)
                .map(|k| if k == pieces { w[1] } else { w[0] + (w[1] - w[0]) * k as f64 / pieces as f64 }),
        );
    }
    let gap_mm = Cell::new(0.0_f64);
    let locate = |t: f64, hint: Option<Uv>| {
        let (at, gap) = carrier.locate(&curve.point(t), hint, tolerance.near_mm);
        gap_mm.set(gap_mm.get().max(gap));
        hint.map_or(at, |h| unwrap(carrier, at, h))
    };
    // The middle first, then outwards in both directions with a neighbour as hint.
    let middle = ts.len() / 2;
    let mut start = vec![uv(0.0, 0.0); ts.len()];
    start[middle] = locate(ts[middle], None);
    for k in (0..middle).rev() {
        start[k] = locate(ts[k], Some(start[k + 1]));
    }
    for k in middle + 1..ts.len() {
        start[k] = locate(ts[k], Some(start[k - 1]));
    }
    // Where the surface shrinks to a point, a curve arrives with one value of the lost parameter and leaves with another.
    let mut ends: Vec<[Uv; 2]> = start.iter().map(|p| [*p, *p]).collect();
    for k in 0..start.len() {
        if let Some(axis) = lost(carrier, start[k], tolerance.chord_mm) {
            let with = |n: usize| Uv::from_axis(axis, start[n].get(axis), start[k].get(axis.other()));
            let (before, after) = (k.saturating_sub(1), (k + 1).min(start.len() - 1));
            ends[k] =
                [with(if k == 0 { after } else { before }), with(if after == k { before } else { after })];
        }
    }
    let mut points = vec![ends[0][1]];
    let near = gap_mm.get() <= tolerance.far_mm;
    for k in 1..ts.len() {
        // A stack of pending right ends instead of recursion.
        let mut pending = vec![(ts[k], ends[k], 0_u32)];
        let (mut t0, mut p0) = (ts[k - 1], ends[k - 1][1]);
        while let Some((t1, [p1, leave], depth)) = pending.pop() {
            let tm = 0.5 * (t0 + t1);
            let guess = uv(0.5 * (p0.u + p1.u), 0.5 * (p0.v + p1.v));
            let room = near && depth < MAX_DEPTH && points.len() + pending.len() < MAX_POINTS;
            let middle = room.then(|| locate(tm, Some(guess))).map(|pm| (pm, rise_mm(carrier, pm, guess)));
            match middle {
                Some((pm, off)) if off > tolerance.chord_mm => {
                    let both = match lost(carrier, pm, tolerance.chord_mm) {
                        Some(axis) => {
                            [p0, p1].map(|p| Uv::from_axis(axis, p.get(axis), pm.get(axis.other())))
                        }
                        None => [pm, pm],
                    };
                    pending.push((t1, [p1, leave], depth + 1));
                    pending.push((tm, both, depth + 1));
                }
                _ => {
                    points.extend(middle.map(|(pm, _)| apex(guess, pm)));
                    points.push(p1);
                    if leave != p1 && !(k + 1 == ts.len() && t1 == ts[k]) {
                        points.push(leave);
                    }
                    (t0, p0) = (t1, leave);
                }
            }
        }
    }
    Pulled { points: simplify(carrier, &points, 0.05 * tolerance.chord_mm), gap_mm: gap_mm.get() }
}

/// The parameter that makes no difference at a point, which lies in a pole to a tenth of the chord tolerance.
fn lost(carrier: &Carrier, at: Uv, chord_mm: f64) -> Option<Axis> {
    [Axis::U, Axis::V].into_iter().find(|axis| {
        let across = carrier.domain.get(axis.other());
        let along = carrier.domain.get(*axis);
        let t = at.get(axis.other());
        let slack = POLE * across.length();
        // A cheap question first; surfaces with an unlimited range are cheap anyway.
        let end = !slack.is_finite() || (t - across.lo).abs() <= slack || (t - across.hi).abs() <= slack;
        end && along.length().is_finite() && {
            let jet = osculate_geom::Surface::jet2(&carrier.surface, at);
            let d = if *axis == Axis::U { jet.du } else { jet.dv };
            d.norm() * along.length() <= 0.1 * chord_mm
        }
    })
}

/// Distance on the surface between a curve's point and the middle of its chord.
fn rise_mm(carrier: &Carrier, on_curve: Uv, middle: Uv) -> f64 {
    let jet = osculate_geom::Surface::jet2(&carrier.surface, on_curve);
    jet.tangent(uv(on_curve.u - middle.u, on_curve.v - middle.v)).norm()
}

/// The corner over a chord that encloses as much as the arc through `on_curve`: a parabola's segment is four thirds of
/// the triangle in it (Archimedes), so the corner rises a third above the curve. Chords alone would lie on one side of
/// every arc and take away a whole strip.
fn apex(middle: Uv, on_curve: Uv) -> Uv {
    const RISE: f64 = 4.0 / 3.0;
    uv(middle.u + RISE * (on_curve.u - middle.u), middle.v + RISE * (on_curve.v - middle.v))
}

/// The parameters shifted by whole periods to be nearest to `near`.
pub(crate) fn unwrap(carrier: &Carrier, at: Uv, near: Uv) -> Uv {
    let shift = |t: f64, n: f64, k: usize| {
        let i = if k == 0 { carrier.domain.u } else { carrier.domain.v };
        if carrier.closes[k] { t + ((n - t) / i.length()).round() * i.length() } else { t }
    };
    uv(shift(at.u, near.u, 0), shift(at.v, near.v, 1))
}

/// Leaves out points that lie on the straight line between their neighbours, to `slack_mm`.
fn simplify(carrier: &Carrier, points: &[Uv], slack_mm: f64) -> Vec<Uv> {
    let scaled = |p: Uv| [p.u * carrier.speed[0], p.v * carrier.speed[1]];
    let mut kept: Vec<Uv> = Vec::with_capacity(points.len());
    let mut k = 0;
    while k < points.len() {
        kept.push(points[k]);
        let mut end = k + 1;
        // Straight runs are short or exactly straight: a window bounds the work.
        while end + 1 < points.len() && end - k < 64 {
            let (a, b) = (scaled(points[k]), scaled(points[end + 1]));
            let d = [b[0] - a[0], b[1] - a[1]];
            let length2 = d[0] * d[0] + d[1] * d[1];
            let straight = points[k + 1..=end].iter().all(|q| {
                let w = [scaled(*q)[0] - a[0], scaled(*q)[1] - a[1]];
                let along = w[0] * d[0] + w[1] * d[1];
                let across = (w[0] * d[1] - w[1] * d[0]).abs();
                along >= 0.0 && along <= length2 && across <= slack_mm * length2.sqrt()
            });
            if !straight {
                break;
            }
            end += 1;
        }
        k = end;
    }
    kept
}

/// A parameter-space curve (z = 0) with parameter range `[0, 1]` as a polyline, to the chord tolerance on the surface.
pub(crate) fn flatten(curve: &dyn Curve, carrier: &Carrier, tolerance: Tolerance) -> Vec<Uv> {
    let at = |t: f64| {
        let p = curve.point(t);
        uv(p.x, p.y)
    };
    let mut breaks = vec![0.0];
    breaks.extend(curve.breaks());
    breaks.push(1.0);
    let pieces = if breaks.len() > 64 { 1 } else { 4 };
    let mut ts = vec![0.0];
    for w in breaks.windows(2) {
        ts.extend((1..=pieces).map(|k| {
            if k == pieces { w[1] } else { w[0] + (w[1] - w[0]) * f64::from(k) / f64::from(pieces) }
        }));
    }
    let mut points = vec![at(0.0)];
    for w in ts.windows(2) {
        let mut pending = vec![(w[1], at(w[1]), 0_u32)];
        let (mut t0, mut p0) = (w[0], at(w[0]));
        while let Some((t1, p1, depth)) = pending.pop() {
            let tm = 0.5 * (t0 + t1);
            let pm = at(tm);
            let guess = uv(0.5 * (p0.u + p1.u), 0.5 * (p0.v + p1.v));
            let room = depth < MAX_DEPTH && points.len() + pending.len() < MAX_POINTS;
            if room && rise_mm(carrier, pm, guess) > tolerance.chord_mm {
                pending.push((t1, p1, depth + 1));
                pending.push((tm, pm, depth + 1));
            } else {
                if room {
                    points.push(apex(guess, pm));
                }
                points.push(p1);
                (t0, p0) = (t1, p1);
            }
        }
    }
    simplify(carrier, &points, 0.05 * tolerance.chord_mm)
}
