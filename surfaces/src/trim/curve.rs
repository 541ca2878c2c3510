//! Boundary curves in space: lines, conics, polylines and chains of them.
//!
//! Spline curves are in [`super::spline`]. A parameter-space curve of IGES is a space curve with z = 0.

use super::motion::Motion;
use super::spline::Spline;
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What a curve is, parameter included, for writers.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    /// A straight line.
    Line(Line),
    /// An ellipse or circle.
    Ellipse(Ellipse),
    /// A parabola or a hyperbola.
    Open(OpenConic),
    /// Straight pieces.
    Polyline(Polyline),
    /// A spline.
    Spline(Spline),
}

impl Form {
    /// The image under a motion; `None` where an ellipse would lose its axes or a spline leaves the range of numbers.
    fn moved(self, motion: &Motion) -> Option<Self> {
        let turned = |frame: &Placement| -> Option<(Placement, f64)> {
            let [x, y] = [frame.x, frame.y].map(|d| motion.linear * d.into_inner());
            let scale = x.norm();
            // A rotation, a reflection or a uniform scaling keeps lengths equal and right angles right.
            let kept = (y.norm() - scale).abs() <= 1e-9 * scale && x.dot(&y).abs() <= 1e-9 * scale * scale;
            let z = osculate_geom::Unit3::try_new(x.cross(&y), 0.0)?;
            kept.then(|| (Placement::new(motion.point(&frame.origin), z, Some(x)), scale))
        };
        Some(match self {
            Self::Line(l) => Self::Line(Line {
                origin: motion.point(&l.origin),
                direction: motion.linear * l.direction,
                range: l.range,
            }),
            Self::Ellipse(e) => {
                let (frame, scale) = turned(&e.frame)?;
                Self::Ellipse(Ellipse { frame, semi_axes: e.semi_axes.map(|a| a * scale), range: e.range })
            }
            Self::Open(c) => {
                let (frame, scale) = turned(&c.frame)?;
                let kind = match c.kind {
                    OpenKind::Parabola { focal_mm } if (scale - 1.0).abs() <= 1e-12 => {
                        OpenKind::Parabola { focal_mm }
                    }
                    OpenKind::Parabola { .. } => return None,
                    OpenKind::Hyperbola { semi_axes_mm } => {
                        OpenKind::Hyperbola { semi_axes_mm: semi_axes_mm.map(|a| a * scale) }
                    }
                };
                Self::Open(OpenConic { frame, kind })
            }
            Self::Polyline(p) => {
                Self::Polyline(Polyline { points: p.points.iter().map(|q| motion.point(q)).collect() })
            }
            Self::Spline(s) => Self::Spline(s.mapped(motion).ok()?),
        })
    }
}

/// A curve in space.
pub(crate) trait Curve: Send + Sync {
    /// The point at a parameter; closed curves accept parameters beyond their range.
    fn point(&self, t: f64) -> Point3;

    /// The natural range; infinite for a line without ends.
    fn range(&self) -> [f64; 2];

    /// The period of a closed curve.
    fn period(&self) -> Option<f64> {
        None
    }

    /// The parameter of the point nearest to `p`.
    fn locate(&self, p: &Point3) -> f64;

    /// Parameters strictly within `range` between which the curve is smooth.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The closed form with the same parameter, where there is one.
    fn form(&self) -> Option<Form> {
        None
    }
}

/// `origin + t * direction`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// The point at zero.
    pub(crate) origin: Point3,
    /// Change per unit of the parameter, not zero.
    pub(crate) direction: Vec3,
    /// Ends, infinite where there are none.
    pub(crate) range: [f64; 2],
}

impl Line {
    /// The segment between two points, parameter 0 to 1.
    pub(crate) fn segment(a: Point3, b: Point3) -> Self {
        Self { origin: a, direction: b - a, range: [0.0, 1.0] }
    }
}

impl Curve for Line {
    fn form(&self) -> Option<Form> {
        Some(Form::Line(*self))
    }
    fn point(&self, t: f64) -> Point3 {
        self.origin + self.direction * t
    }
    fn range(&self) -> [f64; 2] {
        self.range
    }
    fn locate(&self, p: &Point3) -> f64 {
        let d2 = self.direction.norm_squared();
        if d2 > 0.0 { (p - self.origin).dot(&self.direction) / d2 } else { 0.0 }
    }
}

/// Ellipse `origin + a cos t x + b sin t y`; a circle where both semi-axes agree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    /// Its frame; z is the axis.
    pub(crate) frame: Placement,
    /// Semi-axes along x and y, mm.
    pub(crate) semi_axes: [f64; 2],
    /// Angles of the ends, at most a full turn.
    pub(crate) range: [f64; 2],
}

impl Curve for Ellipse {
    fn form(&self) -> Option<Form> {
        Some(Form::Ellipse(*self))
    }
    fn point(&self, t: f64) -> Point3 {
        let (s, c) = t.sin_cos();
        self.frame.point(&Point3::new(self.semi_axes[0] * c, self.semi_axes[1] * s, 0.0))
    }
    fn range(&self) -> [f64; 2] {
        self.range
    }
    fn period(&self) -> Option<f64> {
        Some(TAU)
    }
    fn locate(&self, p: &Point3) -> f64 {
        let q = self.frame.local(p);
        let [a, b] = self.semi_axes;
        // Exact for points on the curve; a few Newton steps settle points off it.
        let mut t = (q.y / b).atan2(q.x / a);
        for _ in 0..8 {
            let (s, c) = t.sin_cos();
            let (dx, dy) = (q.x - a * c, q.y - b * s);
            let f = -dx * a * s + dy * b * c;
            let df = a * a * s * s + b * b * c * c + dx * a * c + dy * b * s;
            if df <= 0.0 {
                break;
            }
            t += f / df;
        }
        t
    }
    fn breaks(&self) -> Vec<f64> {
        // Quarters, so that no sampling ever sees a full turn as a point.
        let [lo, hi] = self.range;
        (1..8).map(|k| lo + (hi - lo) * f64::from(k) / 8.0).collect()
    }
}

/// The conics without end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum OpenKind {
    /// `f (t^2 x + 2 t y)`.
    Parabola {
        /// Distance from the vertex to the focus, mm.
        focal_mm: f64,
    },
    /// `a cosh t x + b sinh t y`.
    Hyperbola {
        /// Semi-axes along x and y, mm.
        semi_axes_mm: [f64; 2],
    },
}

/// A parabola or one branch of a hyperbola in the xy plane of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenConic {
    pub(crate) frame: Placement,
    pub(crate) kind: OpenKind,
}

impl Curve for OpenConic {
    fn form(&self) -> Option<Form> {
        Some(Form::Open(*self))
    }
    fn point(&self, t: f64) -> Point3 {
        let (x, y) = match self.kind {
            OpenKind::Parabola { focal_mm } => (focal_mm * t * t, 2.0 * focal_mm * t),
            OpenKind::Hyperbola { semi_axes_mm: [a, b] } => (a * t.cosh(), b * t.sinh()),
        };
        self.frame.point(&Point3::new(x, y, 0.0))
    }
    fn range(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }
    /// Exact for points on the curve, which is where it is asked: y grows along the whole of it.
    fn locate(&self, p: &Point3) -> f64 {
        let y = self.frame.local(p).y;
        match self.kind {
            OpenKind::Parabola { focal_mm } => y / (2.0 * focal_mm),
            OpenKind::Hyperbola { semi_axes_mm: [_, b] } => (y / b).asinh(),
        }
    }
}

/// Straight pieces through points, parameter = index.
#[derive(Clone, Debug)]
pub(crate) struct Polyline {
    /// At least two points.
    pub(crate) points: Vec<Point3>,
}

impl Curve for Polyline {
    fn form(&self) -> Option<Form> {
        Some(Form::Polyline(self.clone()))
    }
    fn point(&self, t: f64) -> Point3 {
        let last = self.points.len() - 1;
        let k = (t.max(0.0) as usize).min(last.saturating_sub(1));
        let f = (t - k as f64).clamp(0.0, 1.0);
        self.points[k] + (self.points[(k + 1).min(last)] - self.points[k]) * f
    }
    fn range(&self) -> [f64; 2] {
        [0.0, (self.points.len() - 1) as f64]
    }
    fn locate(&self, p: &Point3) -> f64 {
        let mut best = (f64::INFINITY, 0.0);
        for (k, w) in self.points.windows(2).enumerate() {
            let t = Line::segment(w[0], w[1]).locate(p).clamp(0.0, 1.0);
            let d = (w[0] + (w[1] - w[0]) * t - p).norm_squared();
            if d < best.0 {
                best = (d, k as f64 + t);
            }
        }
        best.1
    }
    fn breaks(&self) -> Vec<f64> {
        (1..self.points.len() - 1).map(|k| k as f64).collect()
    }
}

/// Part of a curve, possibly against its sense: parameter 0 to 1.
#[derive(Clone)]
pub(crate) struct Piece {
    /// The whole curve.
    pub(crate) curve: Arc<dyn Curve>,
    /// Curve parameters at 0 and 1.
    pub(crate) ends: [f64; 2],
}

impl Piece {
    /// The whole curve; `None` where it has no ends.
    pub(crate) fn whole(curve: Arc<dyn Curve>) -> Option<Self> {
        let ends = curve.range();
        ends.iter().all(|e| e.is_finite()).then_some(Self { curve, ends })
    }

    /// The same points in the opposite sense.
    pub(crate) fn reversed(&self) -> Self {
        Self { curve: self.curve.clone(), ends: [self.ends[1], self.ends[0]] }
    }

    /// The part of `curve` from `from` to `to` in the curve's own sense where `forward`, else against it. A closed
    /// curve is followed across its seam; equal ends of a closed curve mean all of it.
    pub(crate) fn between(
        curve: Arc<dyn Curve>,
        ends: [Point3; 2],
        forward: bool,
        slack_mm: f64,
    ) -> Option<Self> {
        let [from, to] = if forward { ends } else { [ends[1], ends[0]] };
        let [lo, hi] = curve.range();
        let at = |t: f64, p: &Point3| t.is_finite() && (curve.point(t) - p).norm() <= slack_mm;
        let t0 = if at(lo, &from) { lo } else { curve.locate(&from) };
        let mut t1 = if at(hi, &to) { hi } else { curve.locate(&to) };
        let same = (from - to).norm() <= slack_mm;
        if let Some(period) = curve.period() {
            let hair = 1e-9 * period;
            if same && (t1 - t0).rem_euclid(period).min(period - (t1 - t0).rem_euclid(period)) < 1e-3 * period
            {
                t1 = t0 + period;
            }
            while t1 <= t0 + hair {
                t1 += period;
            }
            while t1 > t0 + period + hair {
                t1 -= period;
            }
        } else if !(t1 != t0 && t0.is_finite() && t1.is_finite()) {
            return None;
        }
        let piece = Self { curve, ends: [t0, t1] };
        Some(if forward { piece } else { piece.reversed() })
    }

    /// The points at both ends.
    pub(crate) fn end_points(&self) -> [Point3; 2] {
        [self.curve.point(self.ends[0]), self.curve.point(self.ends[1])]
    }
}

impl Curve for Piece {
    fn point(&self, t: f64) -> Point3 {
        // The ends are met without rounding.
        let at = if t == 1.0 { self.ends[1] } else { self.ends[0] + t * (self.ends[1] - self.ends[0]) };
        self.curve.point(at)
    }
    fn range(&self) -> [f64; 2] {
        [0.0, 1.0]
    }
    fn locate(&self, p: &Point3) -> f64 {
        let mut t = self.curve.locate(p);
        if let Some(period) = self.curve.period() {
            // Of all turns the one nearest to the middle of the piece.
            t += ((0.5 * (self.ends[0] + self.ends[1]) - t) / period).round() * period;
        }
        ((t - self.ends[0]) / (self.ends[1] - self.ends[0])).clamp(0.0, 1.0)
    }
    fn breaks(&self) -> Vec<f64> {
        let [a, b] = self.ends;
        let (lo, hi) = (a.min(b), a.max(b));
        let shifts = match self.curve.period() {
            Some(p) => vec![-p, 0.0, p],
            None => vec![0.0],
        };
        let mut ts: Vec<f64> = Vec::new();
        let own = self.curve.breaks();
        for s in shifts {
            ts.extend(own.iter().map(|t| t + s).filter(|t| *t > lo && *t < hi).map(|t| (t - a) / (b - a)));
        }
        ts.sort_by(f64::total_cmp);
        ts.dedup();
        ts
    }
}

/// A curve moved by a rigid motion or scaled: `linear * p + shift`.
#[derive(Clone)]
pub(crate) struct Moved {
    /// The curve before.
    pub(crate) curve: Arc<dyn Curve>,
    /// The motion.
    pub(crate) motion: Motion,
}

impl Curve for Spline {
    fn form(&self) -> Option<Form> {
        Some(Form::Spline(self.clone()))
    }
    fn point(&self, t: f64) -> Point3 {
        Self::point(self, t)
    }
    fn range(&self) -> [f64; 2] {
        Self::range(self)
    }
    fn period(&self) -> Option<f64> {
        Self::period(self)
    }
    fn locate(&self, p: &Point3) -> f64 {
        Self::locate(self, p)
    }
    fn breaks(&self) -> Vec<f64> {
        Self::breaks(self)
    }
}

impl Curve for Moved {
    fn form(&self) -> Option<Form> {
        self.curve.form()?.moved(&self.motion)
    }
    fn point(&self, t: f64) -> Point3 {
        self.motion.point(&self.curve.point(t))
    }
    fn range(&self) -> [f64; 2] {
        self.curve.range()
    }
    fn period(&self) -> Option<f64> {
        self.curve.period()
    }
    fn locate(&self, p: &Point3) -> f64 {
        let back = self.motion.linear.try_inverse().unwrap_or_else(nalgebra::Matrix3::identity);
        self.curve.locate(&Point3::from(back * (p.coords - self.motion.shift)))
    }
    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_is_cut_between_points_in_both_senses() {
        let frame = Placement::identity();
        let circle: Arc<dyn Curve> = Arc::new(Ellipse { frame, semi_axes: [2.0, 2.0], range: [0.0, TAU] });
        let at = |a: f64| Point3::new(2.0 * a.cos(), 2.0 * a.sin(), 0.0);
        // From 350 to 10 degrees with the sense: through 0; against it: the long way round.
        let ends = [at(350_f64.to_radians()), at(10_f64.to_radians())];
        let short = Piece::between(circle.clone(), ends, true, 1e-9).unwrap();
        assert!((short.point(0.5) - at(0.0)).norm() < 1e-12);
        let long = Piece::between(circle.clone(), ends, false, 1e-9).unwrap();
        assert!((long.point(0.5) - at(TAU / 2.0)).norm() < 1e-12);
        assert!((long.point(0.0) - ends[0]).norm() < 1e-12 && (long.point(1.0) - ends[1]).norm() < 1e-12);
        // A point on the piece is found on it, whatever turn the circle counts it in.
        for f in [0.1, 0.5, 0.9] {
            assert!((long.locate(&long.point(f)) - f).abs() < 1e-12);
            assert!((short.locate(&short.point(f)) - f).abs() < 1e-12);
        }
        // Equal ends: the full turn.
        let full = Piece::between(circle, [at(1.0), at(1.0)], true, 1e-9).unwrap();
        assert!((full.point(0.5) - at(1.0 + TAU / 2.0)).norm() < 1e-12);
    }

    #[test]
    fn open_conics_know_their_parameters() {
        let frame = Placement::identity();
        let parabola = OpenConic { frame, kind: OpenKind::Parabola { focal_mm: 0.7 } };
        let hyperbola = OpenConic { frame, kind: OpenKind::Hyperbola { semi_axes_mm: [2.0, 0.5] } };
        for t in [-1.3, 0.0, 0.4, 2.0] {
            // y^2 = 4 f x and (x/a)^2 - (y/b)^2 = 1.
            let (p, h) = (parabola.point(t), hyperbola.point(t));
            assert!((p.y * p.y - 2.8 * p.x).abs() < 1e-14);
            assert!(((h.x / 2.0).powi(2) - (h.y / 0.5).powi(2) - 1.0).abs() < 1e-13);
            assert!((parabola.locate(&p) - t).abs() < 1e-15 && (hyperbola.locate(&h) - t).abs() < 1e-14);
        }
    }

    #[test]
    fn nearest_parameters() {
        let ellipse = Ellipse { frame: Placement::identity(), semi_axes: [3.0, 1.0], range: [0.0, TAU] };
        for t in [0.1, 1.4, 2.9, -1.0] {
            assert!((ellipse.locate(&ellipse.point(t)) - t).abs() < 1e-12);
        }
        let path = Polyline {
            points: vec![Point3::origin(), Point3::new(2.0, 0.0, 0.0), Point3::new(2.0, 1.0, 0.0)],
        };
        assert_eq!(path.locate(&Point3::new(1.0, -3.0, 0.0)), 0.5);
        assert_eq!(path.point(1.5), Point3::new(2.0, 0.5, 0.0));
    }
}
