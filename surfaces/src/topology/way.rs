//! The curve under an edge for writers: the file's own where it has a closed form, the parameter line where the surface
//! has one there, else a cubic spline through dense points.

use super::course::{Course, Spacing};
use super::track::Track;
use crate::nurbs::NurbsCurve3;
use crate::trim::curve::{Curve, Ellipse, Form, Line, OpenConic, OpenKind, Piece};
use crate::trim::spline::Spline;
use osculate_geom::{Interval, Point3, Vec3};
use std::f64::consts::TAU;

/// What an edge runs along.
#[derive(Clone, Debug)]
pub(crate) enum Along {
    /// A straight line.
    Line(Line),
    /// A circle or an ellipse.
    Ellipse(Ellipse),
    /// A parabola or a hyperbola.
    Open(OpenConic),
    /// Straight pieces between points.
    Polyline(Vec<Point3>),
    /// A spline, with clamped knots, exactly as long as the edge.
    Spline(NurbsCurve3),
}

/// A curve, and the parameters at which the edge begins and ends.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    pub(crate) along: Along,
    pub(crate) ends: [f64; 2],
}

/// Chords of the points that a spline is put through, as a part of its length: the spline is then within 1e-8 of its
/// length from a smooth course.
const FIT_CHORD: f64 = 1e-4;

/// Points are left out where the spline keeps to them within this part of its length.
const FIT: f64 = 1e-7;

/// Chords that meet at a greater angle than this are a corner, rad.
const CORNER: f64 = 0.2;

/// The way of a course of this length.
pub(crate) fn way(course: &Course, length_mm: f64) -> Way {
    let exact = match course {
        Course::Space(piece) => of_piece(piece),
        Course::OnSurface { .. } => None,
    };
    exact.unwrap_or_else(|| fitted(course, length_mm)).settled()
}

fn of_piece(piece: &Piece) -> Option<Way> {
    let [a, b] = piece.ends;
    let (lo, hi) = (a.min(b), a.max(b));
    let along = match piece.curve.form()? {
        Form::Line(l) => Along::Line(l),
        Form::Ellipse(e) => Along::Ellipse(e),
        Form::Open(c) => Along::Open(c),
        Form::Polyline(p) => {
            let inner = p.points.iter().enumerate().filter(|(k, _)| *k as f64 > lo && (*k as f64) < hi);
            let mut points = vec![p.point(lo)];
            points.extend(inner.map(|e| *e.1));
            points.push(p.point(hi));
            let ends =
                if a <= b { [0.0, points.len() as f64 - 1.0] } else { [points.len() as f64 - 1.0, 0.0] };
            return Some(Way { along: Along::Polyline(points), ends });
        }
        Form::Spline(s) => {
            let d = s.curve().domain();
            // Across the seam of a closed spline the two parts make no single piece of it.
            if lo < d.lo - 1e-12 * d.length() || hi > d.hi + 1e-12 * d.length() {
                return None;
            }
            let knots = s.curve().knots().as_slice();
            let [lo, hi] = [lo.max(d.lo), hi.min(d.hi)].map(|t| at_knot(knots, t, HAIR * (hi - lo)));
            let part = s.curve().restricted(Interval::new(lo, hi)).ok()?;
            let d = part.domain();
            let ends = if a <= b { [d.lo, d.hi] } else { [d.hi, d.lo] };
            return Some(Way { along: Along::Spline(part), ends });
        }
    };
    Some(Way { along, ends: [a, b] })
}

/// Spans shorter than this part of a curve's interval are rounding: other kernels divide by them.
pub(super) const HAIR: f64 = 1e-10;

/// The nearest knot within `hair`, else the parameter itself: a curve cut just beside a knot would have a span of rounding.
pub(super) fn at_knot(knots: &[f64], t: f64, hair: f64) -> f64 {
    let nearest = knots.iter().copied().min_by(|a, b| (a - t).abs().total_cmp(&(b - t).abs()));
    nearest.filter(|k| (k - t).abs() <= hair).unwrap_or(t)
}

/// A cubic spline with continuous tangents through dense points of a course; corners stay corners.
fn fitted(course: &Course, length_mm: f64) -> Way {
    let spacing = Spacing { chord_mm: FIT_CHORD * length_mm, length_mm: 0.05 * length_mm };
    let mut points: Vec<Point3> = course.samples(spacing).into_iter().map(|s| s.1).collect();
    points.dedup_by(|next, kept| (*next - *kept).norm() <= HAIR * length_mm);
    let end = course.point(1.0);
    if points.len() < 2 {
        points = vec![course.point(0.0), end];
    } else if let Some(last) = points.last_mut() {
        *last = end;
    }
    let n = points.len();
    let mut t = vec![0.0];
    for w in points.windows(2) {
        t.push(t[t.len() - 1] + (w[1] - w[0]).norm().max(f64::MIN_POSITIVE));
    }
    let slope = |k: usize| (points[k + 1] - points[k]) / (t[k + 1] - t[k]);
    let corner: Vec<bool> =
        (0..n).map(|k| k > 0 && k + 1 < n && slope(k - 1).angle(&slope(k)) > CORNER).collect();
    // The parabola through three points; at ends and corners that of the side.
    let inner = |k: usize| {
        let (h0, h1) = (t[k] - t[k - 1], t[k + 1] - t[k]);
        (slope(k - 1) * h1 + slope(k) * h0) / (h0 + h1)
    };
    let one_sided = |k: usize, near: Vec3, next: usize| {
        let usable = next > 0 && next + 1 < n && !corner[next];
        if usable { near * 2.0 - inner(next) } else { near }
            .try_normalize(0.0)
            .unwrap_or_else(|| near.try_normalize(0.0).unwrap_or_else(|| points[k].coords))
    };
    let after = |k: usize| if k > 0 && !corner[k] { inner(k) } else { one_sided(k, slope(k), k + 1) };
    let before =
        |k: usize| if k + 1 < n && !corner[k] { inner(k) } else { one_sided(k, slope(k - 1), k - 1) };
    let piece = |a: usize, b: usize| {
        let third = (t[b] - t[a]) / 3.0;
        [points[a], points[a] + after(a) * third, points[b] - before(b) * third, points[b]]
    };
    let within = |a: usize, b: usize| {
        let poles = piece(a, b);
        (a + 1..b).all(|k| {
            let on = cubic(&poles, (t[k] - t[a]) / (t[b] - t[a]));
            !corner[k] && (on - points[k]).norm() <= FIT * length_mm
        })
    };
    let mut knots = vec![0.0; 4];
    let mut poles = vec![points[0]];
    let mut from = 0;
    while from + 1 < n {
        let mut to = from + 1;
        // Twice as far, while the cubic keeps to the points between.
        while to + 1 < n && within(from, (2 * to - from).min(n - 1)) {
            to = (2 * to - from).min(n - 1);
        }
        let [_, b, c, d] = piece(from, to);
        poles.extend([b, c]);
        let last = to + 1 == n;
        if last || corner[to] {
            poles.push(d);
        }
        let times = if last { 4 } else { 2 + usize::from(corner[to]) };
        knots.extend(std::iter::repeat_n(t[to], times));
        from = to;
    }
    let straight = || {
        let line = Line::segment(points[0], points[n - 1]);
        Way { along: Along::Line(line), ends: [0.0, 1.0] }
    };
    match NurbsCurve3::new(3, knots, poles, None) {
        Ok(curve) => Way { along: Along::Spline(curve), ends: [0.0, t[n - 1]] },
        // Points so near to each other that their distances vanish in rounding: a line is as good.
        Err(_) => straight(),
    }
}

/// The point of a cubic with these poles at a part of its way.
fn cubic(poles: &[Point3; 4], f: f64) -> Point3 {
    let g = 1.0 - f;
    let [a, b, c, d] = poles.map(|p| p.coords);
    Point3::from(a * (g * g * g) + b * (3.0 * f * g * g) + c * (3.0 * f * f * g) + d * (f * f * f))
}

impl Way {
    /// With the parameters that other kernels take: lengths along a line, angles of an ellipse from the first turn on.
    fn settled(mut self) -> Self {
        match &mut self.along {
            Along::Line(l) => {
                let length = l.direction.norm();
                if length > 0.0 && length.is_finite() {
                    l.direction /= length;
                    l.range = l.range.map(|t| t * length);
                    self.ends = self.ends.map(|t| t * length);
                }
            }
            Along::Ellipse(_) => {
                let turns = (self.ends[0].min(self.ends[1]) / TAU).floor() * TAU;
                self.ends = self.ends.map(|t| t - turns);
            }
            Along::Open(_) | Along::Polyline(_) | Along::Spline(_) => {}
        }
        self
    }

    /// The way with its own parameter.
    pub(crate) fn track(&self) -> Track<'_> {
        let [a, b] = self.ends;
        let (lo, hi) = (a.min(b), a.max(b));
        let mut breaks = vec![lo];
        match &self.along {
            Along::Polyline(points) => breaks.extend((1..points.len() - 1).map(|k| k as f64)),
            Along::Spline(s) => {
                breaks.extend(s.knots().as_slice().iter().copied().filter(|t| *t > lo && *t < hi));
                breaks.dedup();
            }
            Along::Line(_) | Along::Ellipse(_) | Along::Open(_) => {}
        }
        breaks.push(hi);
        Track { jet: Box::new(|t| self.jet(t)), breaks, forward: self.forward() }
    }

    /// Point and derivative; at a corner those behind it.
    fn jet(&self, t: f64) -> (Point3, Vec3) {
        match &self.along {
            Along::Line(l) => (l.point(t), l.direction),
            Along::Ellipse(e) => {
                let (s, c) = t.sin_cos();
                let [a, b] = e.semi_axes;
                (e.point(t), e.frame.y.into_inner() * (b * c) - e.frame.x.into_inner() * (a * s))
            }
            Along::Open(o) => {
                let (x, y) = match o.kind {
                    OpenKind::Parabola { focal_mm } => (2.0 * focal_mm * t, 2.0 * focal_mm),
                    OpenKind::Hyperbola { semi_axes_mm: [a, b] } => (a * t.sinh(), b * t.cosh()),
                };
                (o.point(t), o.frame.x.into_inner() * x + o.frame.y.into_inner() * y)
            }
            Along::Polyline(points) => {
                let k = (t.max(0.0) as usize).min(points.len() - 2);
                let d = points[k + 1] - points[k];
                (points[k] + d * (t - k as f64), d)
            }
            Along::Spline(s) => {
                let jet = s.jet(t);
                (jet.point, jet.first)
            }
        }
    }

    /// Whether the edge runs along its curve's own sense.
    pub(crate) fn forward(&self) -> bool {
        self.ends[0] <= self.ends[1]
    }

    /// The way as a spline in its own sense; `None` for a piece of a hyperbola, which a writer of splines has to fit.
    pub(crate) fn spline(&self) -> Option<NurbsCurve3> {
        let [a, b] = self.ends;
        let made = match &self.along {
            Along::Line(l) => {
                let poles = vec![l.point(a), l.point(b)];
                NurbsCurve3::new(1, vec![0.0, 0.0, 1.0, 1.0], poles, None).ok()?
            }
            Along::Ellipse(e) => {
                let x = e.frame.x.into_inner() * e.semi_axes[0];
                let y = e.frame.y.into_inner() * e.semi_axes[1];
                Spline::arc(e.frame.origin, x, y, [a, b]).ok()?.curve().clone()
            }
            Along::Open(c) => match c.kind {
                OpenKind::Parabola { focal_mm } => {
                    let local = |x: f64, y: f64| c.frame.point(&Point3::new(focal_mm * x, focal_mm * y, 0.0));
                    let poles = vec![local(a * a, 2.0 * a), local(a * b, a + b), local(b * b, 2.0 * b)];
                    NurbsCurve3::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], poles, None).ok()?
                }
                OpenKind::Hyperbola { .. } => return None,
            },
            Along::Polyline(points) => {
                let s = Spline::polyline(points.clone()).ok()?.curve().clone();
                if self.forward() { s } else { s.reversed() }
            }
            Along::Spline(s) => {
                if self.forward() {
                    s.clone()
                } else {
                    s.reversed()
                }
            }
        };
        Some(made)
    }
}

/// The way of a course as a spline whatever it runs along.
pub(crate) fn as_spline(course: &Course, length_mm: f64) -> Option<NurbsCurve3> {
    way(course, length_mm).spline().or_else(|| fitted(course, length_mm).spline())
}
