//! Spline curves as boundary curves, and the exact spline forms of lines and arcs.
//!
//! Conics become rational quadratics ([Piegl & Tiller, The NURBS Book, 7.3]), so that every generatrix can be swept
//! to a spline surface.

use super::motion::Motion;
use crate::nurbs::{CurveError, NurbsCurve3};
use osculate_geom::{Box3, Point3, Vec3};
use std::f64::consts::FRAC_PI_2;

/// A NURBS curve that knows whether it is closed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spline {
    curve: NurbsCurve3,
    closed: bool,
}

/// Ends nearer than this fraction of a curve's size are one point: the sparest writers keep seven digits.
const SAME_POINT: f64 = 1e-7;

/// Newton steps of [`Curve::locate`] at most; from the best of four samples a degree and span three are usual.
const MAX_STEPS: u32 = 16;

impl Spline {
    /// Checks the data; no weights make a polynomial spline.
    ///
    /// # Errors
    /// [`CurveError`].
    pub(crate) fn new(
        degree: usize,
        knots: Vec<f64>,
        poles: Vec<Point3>,
        weights: Vec<f64>,
    ) -> Result<Self, CurveError> {
        let weights = (!weights.is_empty()).then_some(weights);
        NurbsCurve3::new(degree, knots, poles, weights).map(Self::from_curve)
    }

    pub(crate) fn from_curve(curve: NurbsCurve3) -> Self {
        let size = Box3::around(curve.poles()).diagonal_mm();
        let d = curve.domain();
        let closed = (curve.point(d.lo) - curve.point(d.hi)).norm() <= SAME_POINT * size;
        Self { curve, closed }
    }

    /// The straight spline of degree one through points, parameter = index.
    ///
    /// # Errors
    /// [`CurveError`] for fewer than two points.
    pub(crate) fn polyline(points: Vec<Point3>) -> Result<Self, CurveError> {
        let n = points.len();
        let mut knots = vec![0.0];
        knots.extend((0..n).map(|k| k as f64));
        knots.push(n as f64 - 1.0);
        Self::new(1, knots, points, Vec::new())
    }

    /// The arc `centre + x cos t + y sin t` for t over `range`, at most a full turn, exactly; the parameter is not
    /// the angle.
    ///
    /// # Errors
    /// [`CurveError`] for an arc that is not finite or has no length.
    pub(crate) fn arc(centre: Point3, x: Vec3, y: Vec3, range: [f64; 2]) -> Result<Self, CurveError> {
        let sweep = range[1] - range[0];
        let pieces = ((sweep.abs() / FRAC_PI_2) - 1e-9).ceil().clamp(1.0, 4.0) as usize;
        let step = sweep / pieces as f64;
        let half = (0.5 * step).cos();
        let on = |t: f64, scale: f64| centre + (x * t.cos() + y * t.sin()) * scale;
        let mut poles = vec![on(range[0], 1.0)];
        let mut weights = vec![1.0];
        let mut knots = vec![0.0; 3];
        for k in 0..pieces {
            let t = range[0] + step * k as f64;
            poles.push(on(t + 0.5 * step, 1.0 / half));
            weights.push(half);
            poles.push(on(t + step, 1.0));
            weights.push(1.0);
            let knot = (k + 1) as f64;
            knots.extend(if k + 1 == pieces { vec![knot; 3] } else { vec![knot; 2] });
        }
        Self::new(2, knots, poles, weights)
    }

    /// The curve.
    pub(crate) const fn curve(&self) -> &NurbsCurve3 {
        &self.curve
    }

    /// The same points in the opposite sense.
    pub(crate) fn reversed(&self) -> Self {
        Self { curve: self.curve.reversed(), closed: self.closed }
    }

    /// The image under an affine map.
    ///
    /// # Errors
    /// [`CurveError`] where a pole leaves the range of numbers.
    pub(crate) fn mapped(&self, motion: &Motion) -> Result<Self, CurveError> {
        let poles = self.curve.poles().iter().map(|p| motion.point(p)).collect();
        let weights = self.curve.weights().map_or_else(Vec::new, <[f64]>::to_vec);
        Self::new(self.curve.degree(), self.curve.knots().as_slice().to_vec(), poles, weights)
    }

    /// Weight of a pole.
    pub(crate) fn weight(&self, k: usize) -> f64 {
        self.curve.weights().map_or(1.0, |w| w[k])
    }

    /// The point at a parameter; a closed spline accepts parameters beyond its range.
    pub(crate) fn point(&self, t: f64) -> Point3 {
        let [lo, hi] = self.range();
        if self.closed && !(t >= lo && t <= hi) {
            return self.curve.point(lo + (t - lo).rem_euclid(hi - lo));
        }
        self.curve.point(t)
    }

    /// The natural range.
    pub(crate) fn range(&self) -> [f64; 2] {
        self.curve.knots().domain()
    }

    /// The period of a closed spline.
    pub(crate) fn period(&self) -> Option<f64> {
        let [lo, hi] = self.range();
        self.closed.then_some(hi - lo)
    }

    /// The parameter of the point nearest to `p`.
    pub(crate) fn locate(&self, p: &Point3) -> f64 {
        let [lo, hi] = self.range();
        let d2 = |t: f64| (self.curve.point(t) - p).norm_squared();
        let n = 4 * self.curve.degree();
        let mut best = (d2(hi), hi);
        for w in self.curve.knots().breaks().windows(2) {
            for k in 0..n {
                let t = w[0] + (w[1] - w[0]) * k as f64 / n as f64;
                let d = d2(t);
                if d < best.0 {
                    best = (d, t);
                }
            }
        }
        let (mut d, mut t) = best;
        for _ in 0..MAX_STEPS {
            let jet = self.curve.jet(t);
            let r = jet.point - p;
            let slope = r.dot(&jet.first);
            let bend = jet.first.norm_squared() + r.dot(&jet.second);
            // Where the second derivative overrules the tangent, the tangent alone still leads downhill.
            let step = slope / if bend > 0.0 { bend } else { jet.first.norm_squared() };
            if !step.is_finite() {
                break;
            }
            let mut scale = 1.0;
            let mut next = (t - step).clamp(lo, hi);
            while d2(next) > d && scale > 1e-3 {
                scale *= 0.25;
                next = (t - scale * step).clamp(lo, hi);
            }
            let reached = d2(next);
            if next == t || reached > d {
                break;
            }
            (d, t) = (reached, next);
        }
        t
    }

    /// Parameters strictly within the range between which it is smooth.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let all = self.curve.knots().breaks();
        all[1..all.len() - 1].to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_turn_is_a_circle() {
        let c = Point3::new(1.0, 2.0, 3.0);
        let arc =
            Spline::arc(c, Vec3::x() * 2.0, Vec3::z() * 2.0, [0.3, 0.3 + std::f64::consts::TAU]).unwrap();
        let [lo, hi] = arc.range();
        assert_eq!(arc.period(), Some(hi - lo));
        for k in 0..50 {
            let p = arc.point(lo + (hi - lo) * f64::from(k) / 49.0);
            // Six operations on numbers of size 5.
            assert!(((p - c).norm() - 2.0).abs() < 1e-14 && (p.y - 2.0).abs() < 1e-14);
        }
    }

    #[test]
    fn a_cubic_is_met_where_it_is() {
        let poles = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [2.0, -1.0, 1.0], [3.0, 0.0, 0.0], [5.0, 1.0, 0.0]]
            .map(Point3::from)
            .to_vec();
        let s = Spline::new(3, vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0], poles, Vec::new()).unwrap();
        assert_eq!(s.point(0.0), Point3::origin());
        assert_eq!(s.point(1.0), Point3::new(5.0, 1.0, 0.0));
        for t in [0.0, 0.13, 0.4, 0.77, 1.0] {
            assert!((s.locate(&s.point(t)) - t).abs() < 1e-12, "{t}");
        }
    }
}
