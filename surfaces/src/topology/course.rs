//! The way of an edge through space: a curve of the file, or a line of parameters on a face.
//!
//! Both are sampled densely once; between the samples a course is taken as straight, so the samples are as near to
//! each other as the finest use of them asks.

use crate::trim::curve::{Curve, Piece};
use osculate_geom::{Point3, Surface, Uv, uv};
use std::sync::Arc;

/// A course with parameter 0 to 1.
#[derive(Clone)]
pub(crate) enum Course {
    /// A curve of the file.
    Space(Piece),
    /// Straight pieces in the parameters of a surface.
    OnSurface {
        /// The surface.
        surface: Arc<dyn Surface>,
        /// At least two parameter pairs, unwrapped.
        points: Vec<Uv>,
    },
}

/// The parameters on a polyline at `s`, counted in pieces.
pub(crate) fn on_polyline(points: &[Uv], s: f64) -> Uv {
    let last = points.len() - 1;
    let k = (s.max(0.0) as usize).min(last.saturating_sub(1));
    let f = (s - k as f64).clamp(0.0, 1.0);
    let (a, b) = (points[k], points[(k + 1).min(last)]);
    // The ends are met without rounding.
    if f == 1.0 { b } else { uv(a.u + f * (b.u - a.u), a.v + f * (b.v - a.v)) }
}

impl Course {
    /// The point at a parameter of `[0, 1]`.
    pub(crate) fn point(&self, t: f64) -> Point3 {
        match self {
            Self::Space(piece) => piece.point(t),
            Self::OnSurface { surface, points } => {
                surface.point(on_polyline(points, t * (points.len() - 1) as f64))
            }
        }
    }

    /// Parameters between which the course is smooth, ends included.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let mut out = vec![0.0];
        match self {
            Self::Space(piece) => out.extend(piece.breaks()),
            Self::OnSurface { points, .. } => {
                let n = points.len() - 1;
                out.extend((1..n).map(|k| k as f64 / n as f64));
            }
        }
        out.push(1.0);
        out
    }

    /// Samples `(t, point)` whose chords keep within `chord_mm` of the course and below `length_mm`.
    pub(crate) fn samples(&self, limit: Spacing) -> Vec<(f64, Point3)> {
        /// Samples at most, a bound for hostile curves.
        const MOST: usize = 20_000;
        let breaks = self.breaks();
        let start = (16_usize).div_ceil(breaks.len()).clamp(1, 8);
        let mut out = vec![(0.0, self.point(0.0))];
        for w in breaks.windows(2) {
            for k in 1..=start {
                let t1 = if k == start { w[1] } else { w[0] + (w[1] - w[0]) * k as f64 / start as f64 };
                let mut pending = vec![(t1, self.point(t1), 0_u32)];
                while let Some((t1, p1, depth)) = pending.pop() {
                    let (t0, p0) = out[out.len() - 1];
                    let tm = 0.5 * (t0 + t1);
                    let pm = self.point(tm);
                    let bent = (pm - (p0 + (p1 - p0) * 0.5)).norm() > limit.chord_mm;
                    let long = (p1 - p0).norm() > limit.length_mm;
                    if (bent || long) && depth < 12 && out.len() + pending.len() < MOST {
                        pending.push((t1, p1, depth + 1));
                        pending.push((tm, pm, depth + 1));
                    } else {
                        out.push((t1, p1));
                    }
                }
            }
        }
        out
    }
}

/// How near samples of a course stand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spacing {
    /// Distance of the middle of a chord from the course at most, mm.
    pub(crate) chord_mm: f64,
    /// Length of a chord at most, mm.
    pub(crate) length_mm: f64,
}

/// Where along a polyline of parameters the image of a point is, mm and pieces.
pub(crate) struct Follower<'a> {
    surface: &'a dyn Surface,
    points: &'a [Uv],
    /// `(s, point, length so far)`.
    table: Vec<(f64, Point3, f64)>,
}

impl<'a> Follower<'a> {
    /// A table along `points`.
    pub(crate) fn new(surface: &'a dyn Surface, points: &'a [Uv], spacing: Spacing) -> Self {
        let n = points.len() - 1;
        let at = |s: f64| surface.point(on_polyline(points, s));
        let start = (16_usize).div_ceil(n).clamp(1, 8);
        let mut table = vec![(0.0, at(0.0), 0.0)];
        for k in 0..n {
            for j in 1..=start {
                let s1 = k as f64 + j as f64 / start as f64;
                let mut pending = vec![(s1, at(s1), 0_u32)];
                while let Some((s1, p1, depth)) = pending.pop() {
                    let (s0, p0, so_far) = table[table.len() - 1];
                    let sm = 0.5 * (s0 + s1);
                    let pm = at(sm);
                    if depth < 8 && (pm - (p0 + (p1 - p0) * 0.5)).norm() > spacing.chord_mm {
                        pending.push((s1, p1, depth + 1));
                        pending.push((sm, pm, depth + 1));
                    } else {
                        table.push((s1, p1, so_far + (pm - p0).norm() + (p1 - pm).norm()));
                    }
                }
            }
        }
        Self { surface, points, table }
    }

    /// Length of the image, mm.
    pub(crate) fn length_mm(&self) -> f64 {
        self.table[self.table.len() - 1].2
    }

    /// The polyline parameter of the point nearest to `p`, looked for at the fraction `f` of the length and not
    /// before `from`.
    pub(crate) fn place(&self, p: &Point3, f: f64, from: f64) -> f64 {
        let last = (self.points.len() - 1) as f64;
        let target = f.clamp(0.0, 1.0) * self.length_mm();
        let k = self.table.partition_point(|e| e.2 < target).clamp(1, self.table.len() - 1);
        let (a, b) = (self.table[k - 1], self.table[k]);
        let part = if b.2 > a.2 { (target - a.2) / (b.2 - a.2) } else { 0.5 };
        let guess = (a.0 + part * (b.0 - a.0)).max(from);
        let near = self.newton(p, guess, [from, last]);
        let spacing = (b.1 - a.1).norm();
        if near.1 <= spacing {
            return near.0;
        }
        // Lengths disagree: the nearest of all samples that are left.
        let best = self
            .table
            .iter()
            .filter(|e| e.0 >= from)
            .min_by(|x, y| (x.1 - p).norm_squared().total_cmp(&(y.1 - p).norm_squared()));
        let far = best.map_or(near, |e| self.newton(p, e.0, [from, last]));
        if far.1 < 0.5 * near.1 { far.0 } else { near.0 }
    }

    fn newton(&self, p: &Point3, guess: f64, [lo, hi]: [f64; 2]) -> (f64, f64) {
        let distance = |s: f64| (self.surface.point(on_polyline(self.points, s)) - p).norm();
        let (mut s, mut d) = (guess.clamp(lo, hi), distance(guess.clamp(lo, hi)));
        for _ in 0..6 {
            let k = (s as usize).min(self.points.len() - 2);
            let (a, b) = (self.points[k], self.points[k + 1]);
            let jet = self.surface.jet2(on_polyline(self.points, s));
            let speed = jet.tangent(uv(b.u - a.u, b.v - a.v));
            let step = (p - jet.point).dot(&speed) / speed.norm_squared();
            if !step.is_finite() {
                break;
            }
            // One piece at a time: the speed changes at the corners of the polyline.
            let next = (s + step.clamp(-1.0, 1.0)).clamp(lo, hi);
            let reached = distance(next);
            if reached >= d {
                break;
            }
            (s, d) = (next, reached);
        }
        (s, d)
    }
}
