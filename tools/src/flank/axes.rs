//! The axis surface of a flank motion: where the cutter's axis is at every parameter.
//!
//! `A(tau, s) = (1 - s) Q0(tau) + s Q1(tau)`, Q0 and Q1 uniform cubic B-splines with the same knots. Q0 lies nearer the tip;
//! the unit axis is `d = (Q1 - Q0) / |Q1 - Q0|` and heights z along it count from Q0, mm. Only the line through both
//! points and, for cutters that are not cylinders, the height of Q0 matter, not how far Q1 is from it.

use crate::pose::Pose;
use osculate_geom::{Interval, Point3, Unit3, Vec3};

/// Poles that carry one span.
pub(crate) const ORDER: usize = 4;

/// The cutter's axis at one instant, by two points on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisPoints {
    /// The point from which heights count.
    pub lower: Point3,
    /// Another point, nearer the spindle.
    pub upper: Point3,
}

/// The axis with its rates per unit of the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MovingAxis {
    pub lower: Vec3,
    pub direction: Vec3,
    pub length: f64,
    pub lower_rate: Vec3,
    pub upper_rate: Vec3,
}

impl MovingAxis {
    /// Rate of the unit direction.
    pub fn direction_rate(&self) -> Vec3 {
        let r = self.upper_rate - self.lower_rate;
        (r - self.direction * r.dot(&self.direction)) / self.length
    }
}

/// Axis surfaces that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AxesError {
    /// Too few places to run a cubic through.
    #[error("an axis surface needs at least {need} positions, got {got}")]
    TooFew {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// An empty or infinite parameter range.
    #[error("the parameter range [{}, {}] of an axis surface must be finite and not empty", .range.lo, .range.hi)]
    Range {
        /// The range.
        range: Interval,
    },
    /// A position whose points are not finite or coincide.
    #[error("position {index} of an axis surface gives no direction")]
    Direction {
        /// Its index.
        index: usize,
    },
}

/// The axes of a motion over a range of the parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisSurface {
    range: Interval,
    lower: Vec<Vec3>,
    upper: Vec<Vec3>,
}

/// The four cubic B-splines of a span at `t` in 0..1, and their derivatives by t.
pub(crate) fn basis(t: f64) -> ([f64; ORDER], [f64; ORDER]) {
    let s = 1.0 - t;
    let (t2, s2) = (t * t, s * s);
    (
        [
            s2 * s / 6.0,
            (3.0 * t2 * t - 6.0 * t2 + 4.0) / 6.0,
            (3.0 * s2 * s - 6.0 * s2 + 4.0) / 6.0,
            t2 * t / 6.0,
        ],
        [-0.5 * s2, 0.5 * (3.0 * t2 - 4.0 * t), 0.5 * (4.0 * s - 3.0 * s2), 0.5 * t2],
    )
}

/// Poles whose spline runs along the given places at its knots: `(-p[i-1] + 8 p[i] - p[i+1]) / 6`, which keeps cubics and
/// is off by the fourth power of the spacing elsewhere. Two places beyond each end come from the cubic through four.
fn poles_along(places: &[Vec3]) -> Vec<Vec3> {
    let n = places.len() as isize;
    let beyond = |p: [Vec3; 4], k: f64| {
        // The cubic through p at 0, 1, 2, 3, at -k.
        let x = -k;
        let (a, b, c) = (x - 1.0, x - 2.0, x - 3.0);
        p[0] * (-a * b * c / 6.0) + p[1] * (x * b * c / 2.0) - p[2] * (x * a * c / 2.0)
            + p[3] * (x * a * b / 6.0)
    };
    let at = |i: isize| -> Vec3 {
        let p = |k: isize| places[k as usize];
        if i < 0 {
            beyond([p(0), p(1), p(2), p(3)], -i as f64)
        } else if i >= n {
            beyond([p(n - 1), p(n - 2), p(n - 3), p(n - 4)], (i - n + 1) as f64)
        } else {
            p(i)
        }
    };
    (-1..=n).map(|i| (at(i) * 8.0 - at(i - 1) - at(i + 1)) / 6.0).collect()
}

impl AxisSurface {
    /// The surface along positions at even steps of the parameter over `range`, at least four.
    ///
    /// It is off by about the fourth power of the step times the fourth derivative, over 36 at the positions themselves: with
    /// 181 positions of a smooth motion below 1e-6 of its size. Positions that follow a cubic are met exactly.
    ///
    /// ```
    /// use osculate_geom::{Interval, Point3};
    /// use osculate_tools::flank::axes::{AxisPoints, AxisSurface};
    /// // Positions that move on evenly are met exactly, and between them too.
    /// let at = |k: f64| AxisPoints { lower: Point3::new(k, 0.0, 0.0), upper: Point3::new(k, 0.0, 50.0) };
    /// let positions: Vec<AxisPoints> = (0..=4).map(|k| at(f64::from(k))).collect();
    /// let axes = AxisSurface::along(Interval::new(0.0, 4.0), &positions)?;
    /// assert!((axes.line(2.5).lower - Point3::new(2.5, 0.0, 0.0)).norm() < 1e-12);
    /// let pose = axes.pose(1.0, -20.0);
    /// assert!((pose.tip - Point3::new(1.0, 0.0, -20.0)).norm() < 1e-12 && (pose.axis.z - 1.0).abs() < 1e-12);
    /// assert!(AxisSurface::along(Interval::new(0.0, 4.0), &positions[..2]).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AxesError`].
    pub fn along(range: Interval, positions: &[AxisPoints]) -> Result<Self, AxesError> {
        if positions.len() < ORDER {
            return Err(AxesError::TooFew { got: positions.len(), need: ORDER });
        }
        if !(range.lo.is_finite() && range.hi.is_finite() && range.lo < range.hi) {
            return Err(AxesError::Range { range });
        }
        for (index, p) in positions.iter().enumerate() {
            let length = (p.upper - p.lower).norm();
            if !(length.is_finite() && length > 0.0) {
                return Err(AxesError::Direction { index });
            }
        }
        let side = |f: fn(&AxisPoints) -> Vec3| poles_along(&positions.iter().map(f).collect::<Vec<_>>());
        Ok(Self { range, lower: side(|p| p.lower.coords), upper: side(|p| p.upper.coords) })
    }

    /// The parameter range.
    #[must_use]
    pub const fn range(&self) -> Interval {
        self.range
    }

    /// Number of spans.
    #[must_use]
    pub fn spans(&self) -> usize {
        self.lower.len() + 1 - ORDER
    }

    /// The poles of Q0 and Q1.
    pub(crate) fn poles_mut(&mut self) -> (&mut [Vec3], &mut [Vec3]) {
        (&mut self.lower, &mut self.upper)
    }

    /// The poles of Q0 and Q1.
    pub(crate) fn poles(&self) -> (&[Vec3], &[Vec3]) {
        (&self.lower, &self.upper)
    }

    /// Span of a parameter, which is brought into the range, and the place in it, 0..1.
    pub(crate) fn locate(&self, tau: f64) -> (usize, f64) {
        let n = self.spans() as f64;
        let x = ((tau - self.range.lo) / (self.range.hi - self.range.lo) * n).clamp(0.0, n);
        let k = (x.floor()).min(n - 1.0);
        (k as usize, x - k)
    }

    pub(crate) fn jet(&self, tau: f64) -> MovingAxis {
        let (k, t) = self.locate(tau);
        let (b, db) = basis(t);
        let per = self.spans() as f64 / (self.range.hi - self.range.lo);
        let (lower, upper) = (&self.lower[k..k + ORDER], &self.upper[k..k + ORDER]);
        let sum = |p: &[Vec3], w: &[f64; ORDER]| p[0] * w[0] + p[1] * w[1] + p[2] * w[2] + p[3] * w[3];
        let (q0, q1) = (sum(lower, &b), sum(upper, &b));
        let span = q1 - q0;
        let length = span.norm();
        MovingAxis {
            lower: q0,
            direction: span / length,
            length,
            lower_rate: sum(lower, &db) * per,
            upper_rate: sum(upper, &db) * per,
        }
    }

    /// The axis at a parameter, which is brought into the range.
    #[must_use]
    pub fn line(&self, tau: f64) -> AxisPoints {
        let j = self.jet(tau);
        AxisPoints { lower: j.lower.into(), upper: (j.lower + j.direction * j.length).into() }
    }

    /// The pose of a cutter whose tip is `tip_mm` above Q0 along the axis (negative: below).
    #[must_use]
    pub fn pose(&self, tau: f64, tip_mm: f64) -> Pose {
        let j = self.jet(tau);
        let axis = Unit3::new_unchecked(j.direction);
        Pose { tip: (j.lower + j.direction * tip_mm).into(), axis }
    }

    /// The same axes with the spindle at the other end: Q0 and Q1 exchanged.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { range: self.range, lower: self.upper.clone(), upper: self.lower.clone() }
    }

    /// The same motion on knots `times` as dense: the family of surfaces that holds this one and more.
    #[must_use]
    pub fn refined(&self) -> Self {
        // Midpoint knot insertion of a uniform cubic: (1 6 1)/8 at old knots, (4 4)/8 between.
        let refine = |p: &[Vec3]| {
            let mut out = Vec::with_capacity(2 * p.len());
            for i in 0..p.len() - 1 {
                if i > 0 {
                    out.push((p[i - 1] + p[i] * 6.0 + p[i + 1]) / 8.0);
                }
                out.push((p[i] + p[i + 1]) / 2.0);
            }
            out
        };
        Self { range: self.range, lower: refine(&self.lower), upper: refine(&self.upper) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(u: f64) -> AxisPoints {
        let p = Point3::new(u, 0.3 * u * u - u, 0.1 * u * u * u);
        AxisPoints { lower: p, upper: p + Vec3::new(0.2 * u, 1.0 - 0.1 * u * u, 30.0) }
    }

    #[test]
    fn a_cubic_motion_is_met_exactly_with_its_rates() {
        let range = Interval::new(-1.0, 2.0);
        let positions: Vec<AxisPoints> = (0..=6).map(|k| cubic(-1.0 + 0.5 * f64::from(k))).collect();
        let s = AxisSurface::along(range, &positions).unwrap();
        assert_eq!(s.spans(), 6);
        for s in [s.clone(), s.refined()] {
            for k in 0..=20 {
                let u = -1.0 + 0.15 * f64::from(k);
                let (got, want) = (s.line(u), cubic(u));
                assert!((got.lower - want.lower).norm() < 1e-13 && (got.upper - want.upper).norm() < 1e-13);
                let j = s.jet(u);
                assert!((j.lower_rate - Vec3::new(1.0, 0.6 * u - 1.0, 0.3 * u * u)).norm() < 1e-12);
                let h = 1e-5;
                let turned = (s.jet(u + h).direction - s.jet(u - h).direction) / (2.0 * h);
                // Differences are one-sided at the ends of the range, where the parameter stops.
                if k > 0 && k < 20 {
                    assert!((turned - j.direction_rate()).norm() < 1e-8);
                }
            }
        }
        assert_eq!(s.refined().spans(), 12);
    }

    #[test]
    fn refuses_what_gives_no_surface() {
        let range = Interval::new(0.0, 1.0);
        let good = cubic(0.0);
        let three = AxisSurface::along(range, &[good; 3]);
        assert_eq!(three, Err(AxesError::TooFew { got: 3, need: 4 }));
        let bad = AxisPoints { upper: good.lower, ..good };
        assert_eq!(
            AxisSurface::along(range, &[good, good, bad, good]),
            Err(AxesError::Direction { index: 2 })
        );
        let empty = Interval::new(1.0, 1.0);
        assert!(matches!(AxisSurface::along(empty, &[good; 4]), Err(AxesError::Range { .. })));
    }
}
