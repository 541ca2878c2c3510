//! Conic arcs and offset curves (entities 104 and 130).
//!
//! A conic arc is `A x^2 + B x y + C y^2 + D x + E y + F = 0` at a height z, from one point on it to another,
//! counter-clockwise where it is an ellipse. An offset curve is `C(t) + d(t) V x T(t)` with the unit tangent T and a
//! fixed unit normal V. Source: [IGES 5.3, 4.5 and 4.24].

use super::directory::Entity;
use super::geometry::{Geometry, Space, Unread};
use crate::trim::curve::{Curve, Ellipse, OpenConic, OpenKind, Piece};
use crate::trim::motion::Motion;
use crate::trim::spline::Spline;
use nalgebra::{Matrix2, Vector2};
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Unit3, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A form whose determinant is below this fraction of its squared norm is a parabola's: files carry seven digits.
const PARABOLA: f64 = 1e-7;

/// An end this fraction of the arc's size off the conic is told.
const OFF: f64 = 1e-5;

enum Conic {
    Ellipse(Ellipse),
    Open(OpenConic, [f64; 2]),
}

impl Geometry<'_> {
    /// Entity 104.
    pub(super) fn conic(&self, de: i64, e: &Entity, unit: f64) -> Result<Piece, Unread> {
        match self.conic_of(de, e, unit)? {
            Conic::Ellipse(curve) => {
                let ends = curve.range;
                Ok(Piece { curve: Arc::new(curve), ends })
            }
            Conic::Open(curve, ends) => Ok(Piece { curve: Arc::new(curve), ends }),
        }
    }

    /// Entity 104 as a rational quadratic.
    pub(super) fn conic_spline(&self, de: i64, e: &Entity, unit: f64) -> Result<Spline, Unread> {
        let bad = |e: crate::nurbs::CurveError| self.malformed(de, e.to_string());
        match self.conic_of(de, e, unit)? {
            Conic::Ellipse(c) => {
                let (x, y) = (c.frame.x.into_inner(), c.frame.z.cross(&c.frame.x));
                Spline::arc(c.frame.origin, x * c.semi_axes[0], y * c.semi_axes[1], c.range).map_err(bad)
            }
            Conic::Open(c, [t0, t1]) => {
                let (h, m) = (0.5 * (t1 - t0), 0.5 * (t0 + t1));
                // The ends and the point where their tangents meet: at the mean parameter, its distance scaled.
                let (middle, weight) = match c.kind {
                    OpenKind::Parabola { focal_mm } => {
                        (Point3::new(focal_mm * t0 * t1, 2.0 * focal_mm * m, 0.0), 1.0)
                    }
                    OpenKind::Hyperbola { semi_axes_mm: [a, b] } => {
                        (Point3::new(a * m.cosh(), b * m.sinh(), 0.0) / h.cosh(), h.cosh())
                    }
                };
                let poles = vec![c.point(t0), c.frame.point(&middle), c.point(t1)];
                Spline::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], poles, vec![1.0, weight, 1.0]).map_err(bad)
            }
        }
    }

    fn conic_of(&self, de: i64, e: &Entity, unit: f64) -> Result<Conic, Unread> {
        let n = self.numbers(de, e, 0, 11)?;
        let [a, b, c, d, ee, f] = [n[0], n[1], n[2], n[3], n[4], n[5]];
        let z = n[6];
        let ends = [Vector2::new(n[7], n[8]), Vector2::new(n[9], n[10])];
        let form = Matrix2::new(a, 0.5 * b, 0.5 * b, c);
        let eigen = form.symmetric_eigen();
        let norm = form.norm();
        if !(norm > 0.0 && norm.is_finite()) {
            return Err(self.malformed(de, "a conic without square terms"));
        }
        // Beside the coefficients the size of the arc decides what is small.
        let size = ends[0].norm().max(ends[1].norm());
        let small = |l: f64| l.abs() <= PARABOLA * norm;
        let frame = |origin: Vector2<f64>, x: Vector2<f64>| {
            let x = Vec3::new(x.x, x.y, 0.0);
            Placement::new(Point3::new(origin.x, origin.y, z) * unit, Vec3::z_axis(), Some(x))
        };
        let (l0, l1) = (eigen.eigenvalues[0], eigen.eigenvalues[1]);
        let (v0, v1): (Vector2<f64>, Vector2<f64>) =
            (eigen.eigenvectors.column(0).into(), eigen.eigenvectors.column(1).into());
        if small(l0) || small(l1) {
            // l p^2 + g p + h q + F = 0 with p along the eigenvector of l.
            let (l, p, q) = if small(l0) { (l1, v1, v0) } else { (l0, v0, v1) };
            let linear = Vector2::new(d, ee);
            let (g, h) = (linear.dot(&p), linear.dot(&q));
            if h.abs() <= PARABOLA * (norm * size).max(linear.norm()) {
                return Err(self.malformed(de, "a conic that is a pair of lines"));
            }
            let p0 = -0.5 * g / l;
            let q0 = -(f - l * p0 * p0) / h;
            let opens = q * -(l * h).signum();
            let kind = OpenKind::Parabola { focal_mm: (0.25 * h / l).abs() * unit };
            let curve = OpenConic { frame: frame(p * p0 + q * q0, opens), kind };
            return self.open(de, curve, ends, z * unit, unit);
        }
        let centre = -(form * 2.0).try_inverse().unwrap_or_else(Matrix2::zeros) * Vector2::new(d, ee);
        let rest = f + 0.5 * (d * centre.x + ee * centre.y);
        let squares = [-rest / l0, -rest / l1];
        match squares {
            [s0, s1] if s0 > 0.0 && s1 > 0.0 => {
                let frame = frame(centre, v0);
                let semi_axes = [s0.sqrt() * unit, s1.sqrt() * unit];
                let angle = |p: Vector2<f64>| {
                    let q = frame.local(&(Point3::new(p.x, p.y, z) * unit));
                    (q.y / semi_axes[1]).atan2(q.x / semi_axes[0])
                };
                let (t0, mut t1) = (angle(ends[0]), angle(ends[1]));
                if (ends[0] - ends[1]).norm() <= 1e-7 * s0.max(s1).sqrt() {
                    t1 = t0 + TAU;
                }
                if t1 <= t0 {
                    t1 += TAU;
                }
                let curve = Ellipse { frame, semi_axes, range: [t0, t1] };
                self.tell_off(de, [curve.point(t0), curve.point(t1)], ends, z, unit);
                Ok(Conic::Ellipse(curve))
            }
            [s0, s1] if s0 * s1 < 0.0 => {
                let (real, imaginary, axis) = if s0 > 0.0 { (s0, -s1, v0) } else { (s1, -s0, v1) };
                // The branch that the arc begins on.
                let axis = if (ends[0] - centre).dot(&axis) < 0.0 { -axis } else { axis };
                if (ends[1] - centre).dot(&axis) < 0.0 {
                    return Err(self.malformed(de, "a hyperbola's arc from one branch to the other"));
                }
                let kind =
                    OpenKind::Hyperbola { semi_axes_mm: [real.sqrt() * unit, imaginary.sqrt() * unit] };
                self.open(de, OpenConic { frame: frame(centre, axis), kind }, ends, z * unit, unit)
            }
            _ => Err(self.malformed(de, "a conic that no point is on")),
        }
    }

    fn open(
        &self,
        de: i64,
        curve: OpenConic,
        ends: [Vector2<f64>; 2],
        z_mm: f64,
        unit: f64,
    ) -> Result<Conic, Unread> {
        let at = ends.map(|p| curve.locate(&Point3::new(p.x * unit, p.y * unit, z_mm)));
        if !(at[0].is_finite() && at[1].is_finite() && at[0] != at[1]) {
            return Err(self.malformed(de, "a conic arc of length zero"));
        }
        self.tell_off(de, at.map(|t| curve.point(t)), ends, z_mm / unit, unit);
        Ok(Conic::Open(curve, at))
    }

    /// Says how far the named ends are from the conic.
    fn tell_off(&self, de: i64, found: [Point3; 2], named: [Vector2<f64>; 2], z: f64, unit: f64) {
        let off = (0..2)
            .map(|k| (found[k] - Point3::new(named[k].x, named[k].y, z) * unit).norm())
            .fold(0.0, f64::max);
        let size = (named[0] - named[1]).norm().max(named[0].norm()) * unit;
        if off > OFF * size {
            self.say(format!("DE {de}: an end of the conic arc lies {off:.3e} off it and was put onto it"));
        }
    }

    /// Entity 130 with a constant distance or one that is linear in the parameter.
    pub(super) fn offset_curve(
        &self,
        de: i64,
        e: &Entity,
        space: Space,
        depth: usize,
    ) -> Result<Piece, Unread> {
        let base_de = self.required(de, e, 0, "base curve")?;
        let law = self.number(de, e, 1)?;
        let unit = self.unit(space);
        let by_parameter = self.number(de, e, 4)? == 2.0;
        let distance = [self.number(de, e, 5)? * unit, self.number(de, e, 7)? * unit];
        let at = [self.number(de, e, 6)?, self.number(de, e, 8)?];
        let (d0, slope) = match law {
            1.0 => (distance[0], 0.0),
            2.0 if by_parameter && at[0] != at[1] => {
                let slope = (distance[1] - distance[0]) / (at[1] - at[0]);
                (distance[0] - slope * at[0], slope)
            }
            _ => {
                let what =
                    "an offset curve whose distance varies with arc length or by a function is not read";
                return Err(self.malformed(de, what));
            }
        };
        let normal = Unit3::try_new(self.triple(de, e, 9)?, 0.0)
            .ok_or_else(|| self.malformed(de, "an offset curve without a normal"))?;
        let mut base = self.pieces_below(base_de, space, depth)?;
        if base.len() != 1 {
            return Err(
                self.malformed(de, format!("an offset of a curve of {} parts is not read", base.len()))
            );
        }
        let base = base.remove(0);
        let ends = match [self.number(de, e, 12)?, self.number(de, e, 13)?] {
            // The ends are parameters of the base curve; an arc's begin at its own start.
            [a, b] if a < b && base.curve.range()[0].is_finite() => {
                let shift = if base.curve.period().is_some() { base.ends[0] - a } else { 0.0 };
                let [lo, hi] = base.ends;
                let found = [(a + shift).clamp(lo, hi), (b + shift).clamp(lo, hi)];
                if found[0] < found[1] { found } else { base.ends }
            }
            _ => base.ends,
        };
        Ok(Piece { curve: Arc::new(OffsetCurve { base: base.curve, ends, normal, d0, slope }), ends })
    }

    fn pieces_below(&self, de: i64, space: Space, depth: usize) -> Result<Vec<Piece>, Unread> {
        let mut out = Vec::new();
        self.add_pieces(de, space, &Motion::identity(), depth + 1, &mut out)?;
        Ok(out)
    }
}

/// `C(t) + (d0 + slope t) V x T(t)`, with the tangent by central differences of the base curve.
struct OffsetCurve {
    base: Arc<dyn Curve>,
    ends: [f64; 2],
    normal: Unit3,
    d0: f64,
    slope: f64,
}

/// Step of the difference that gives the tangent, as a fraction of the range: the error of a central difference,
/// `h^2 C''' / 6`, and the rounding, `eps / h`, are both about 1e-10 there.
const STEP: f64 = 1e-5;

impl Curve for OffsetCurve {
    fn point(&self, t: f64) -> Point3 {
        let [lo, hi] = self.ends;
        let h = STEP * (hi - lo);
        // One-sided of second order at the ends.
        let c = |x: f64| self.base.point(x).coords;
        let tangent = if t - h < lo {
            c(t + h) * 4.0 - c(t + 2.0 * h) - c(t) * 3.0
        } else if t + h > hi {
            c(t) * 3.0 - c(t - h) * 4.0 + c(t - 2.0 * h)
        } else {
            c(t + h) - c(t - h)
        };
        let side =
            Unit3::try_new(self.normal.cross(&tangent), 0.0).map_or_else(Vec3::zeros, Unit3::into_inner);
        self.base.point(t) + side * (self.d0 + self.slope * t)
    }
    fn range(&self) -> [f64; 2] {
        self.ends
    }
    fn locate(&self, p: &Point3) -> f64 {
        // The foot on the base curve is that of the offset where the distance is constant; a few halvings of a
        // neighbourhood settle it where it is not.
        let [lo, hi] = self.ends;
        let d2 = |t: f64| (self.point(t) - p).norm_squared();
        let mut best = self.base.locate(p).clamp(lo, hi);
        let mut step = (hi - lo) / 64.0;
        for k in 0..=64 {
            let t = lo + (hi - lo) * f64::from(k) / 64.0;
            if d2(t) < d2(best) {
                best = t;
            }
        }
        for _ in 0..48 {
            let next = [best - step, best + step]
                .map(|t| t.clamp(lo, hi))
                .into_iter()
                .min_by(|a, b| d2(*a).total_cmp(&d2(*b)))
                .unwrap_or(best);
            if d2(next) < d2(best) {
                best = next;
            } else {
                step *= 0.5;
            }
        }
        best
    }
    fn breaks(&self) -> Vec<f64> {
        let [lo, hi] = self.ends;
        self.base.breaks().into_iter().filter(|t| *t > lo && *t < hi).collect()
    }
}
