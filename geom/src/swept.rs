//! Surfaces swept by curves: revolved, extruded, ruled. Exact kinds, for any [`Curve`].
//!
//! ```text
//! revolved  S(u, v) = O + z (z.w) + cos u (w - z (z.w)) + sin u (z x w),  w = C(v) - O      u the angle, rad
//! extruded  S(u, v) = C(u) + v d
//! ruled     S(u, v) = (1 - v) A(u) + v B(u)
//! ```
//!
//! These are the parametrisations of ISO 10303-42. The natural normal is `S_u x S_v`. A meridian that meets the
//! axis makes a pole there: see [`crate::limit`].

use crate::curve::{Curve, CurveJet3, CurveTaylor};
use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Side};
use crate::point::{Axis, Point3, Unit3, Uv, Vec3};
use crate::series::Series;
use crate::surface::Surface;
use crate::taylor::Taylor;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use std::f64::consts::TAU;

/// Why a curve sweeps no surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The axis has no place.
    #[error("the axis goes through ({}, {}, {}), which is no point", origin.x, origin.y, origin.z)]
    Axis {
        /// The point given.
        origin: Point3,
    },
    /// The turn is empty, more than a full one, or not finite.
    #[error("a turn from {from_rad} to {to_rad} rad: it must go upwards, by one turn at most")]
    Turn {
        /// Where it begins, rad.
        from_rad: f64,
        /// Where it ends, rad.
        to_rad: f64,
    },
    /// The direction of an extrusion vanishes or is not finite.
    #[error("the direction of the extrusion has the length {length_mm} mm")]
    Direction {
        /// Its length, mm per unit of v.
        length_mm: f64,
    },
    /// The range along the direction is empty.
    #[error("the extrusion from {from} to {to} is empty")]
    Range {
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// A curve without ends spans no ruled surface.
    #[error("the directrix over [{lo}, {hi}] has no two ends")]
    Unlimited {
        /// Lower end of its domain.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
}

/// The axis of a revolution: a point and a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnAxis {
    /// A point of it, mm.
    pub origin: Point3,
    /// Its direction; the turn is right-handed about it.
    pub direction: Unit3,
}

impl TurnAxis {
    /// The rigid motion that turns by an angle about the axis.
    #[must_use]
    pub fn turn(&self, angle_rad: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_axis_angle(&self.direction, angle_rad);
        let shift = self.origin.coords - rotation * self.origin.coords;
        Isometry3::from_parts(Translation3::from(shift), rotation)
    }

    /// The parts of a vector along the axis, across it, and turned by 90 degrees about it.
    fn parts(&self, w: &Vec3) -> [Vec3; 3] {
        let z = self.direction.into_inner();
        let along = z * w.dot(&z);
        [along, w - along, z.cross(w)]
    }
}

/// A curve turned about an axis.
#[derive(Clone, Debug)]
pub struct Revolved<C> {
    curve: C,
    axis: TurnAxis,
    turn: Interval,
}

impl<C: Curve> Revolved<C> {
    /// The curve turned from the angle `turn.lo` to `turn.hi`, rad; a full turn closes.
    ///
    /// ```
    /// use osculate_geom::analytic::{Conic, ConicKind, Placement};
    /// use osculate_geom::{Interval, Point3, Revolved, Surface, TurnAxis, Vec3, uv};
    /// use std::f64::consts::{FRAC_PI_2, TAU};
    /// // Half a circle about the axis makes a ball.
    /// let frame = Placement::new(Point3::origin(), -Vec3::y_axis(), Some(Vec3::x()));
    /// let kind = ConicKind::Ellipse { semi_axes_mm: [10.0, 10.0] };
    /// let arc = Conic::new(kind, frame, Interval::new(-FRAC_PI_2, FRAC_PI_2))?;
    /// let axis = TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() };
    /// let ball = Revolved::new(arc, axis, Interval::new(0.0, TAU))?;
    /// assert!((ball.jet2(uv(0.3, 0.5)).forms()?.gauss() - 0.01).abs() < 1e-15);
    /// assert!(ball.domain().u.periodic);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::Axis`], [`SweepError::Turn`].
    pub fn new(curve: C, axis: TurnAxis, turn: Interval) -> Result<Self, SweepError> {
        if !(axis.origin.iter().all(|c| c.is_finite()) && axis.direction.iter().all(|c| c.is_finite())) {
            return Err(SweepError::Axis { origin: axis.origin });
        }
        let length = turn.length();
        // Rounding of the ends' difference.
        if !(length > 0.0 && length <= TAU * (1.0 + 1e-12)) {
            return Err(SweepError::Turn { from_rad: turn.lo, to_rad: turn.hi });
        }
        let periodic = length >= TAU * (1.0 - 1e-12);
        Ok(Self { curve, axis, turn: Interval { periodic, ..turn } })
    }

    /// The meridian at angle zero.
    #[must_use]
    pub const fn curve(&self) -> &C {
        &self.curve
    }

    /// The axis.
    #[must_use]
    pub const fn axis(&self) -> &TurnAxis {
        &self.axis
    }
}

impl<C: Curve> Surface for Revolved<C> {
    fn domain(&self) -> Domain {
        Domain { u: self.turn, v: self.curve.domain() }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let CurveJet3 { point, first, second, .. } = self.curve.taylor(uv.v, 2).jet();
        let (s, c) = uv.u.sin_cos();
        let [w, w1, w2] = [point - self.axis.origin, first, second].map(|w| self.axis.parts(&w));
        let at = |w: &[Vec3; 3]| w[0] + w[1] * c + w[2] * s;
        let turned = |w: &[Vec3; 3]| w[2] * c - w[1] * s;
        Jet2 {
            uv,
            point: self.axis.origin + at(&w),
            du: turned(&w),
            dv: at(&w1),
            duu: -(w[1] * c + w[2] * s),
            duv: turned(&w1),
            dvv: at(&w2),
            side: Side::Along,
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let t = self.curve.taylor(uv.v, order);
        let part = |k: usize| {
            CurveTaylor::from_coefficients(uv.v, t.order(), |n| {
                let w = t.coefficient(n) - if n == 0 { self.axis.origin.coords } else { Vec3::zeros() };
                self.axis.parts(&w)[k]
            })
            .along(Axis::V, 1.0)
        };
        let (s, c) = Series::variable(Axis::U, uv.u, t.order()).sin_cos();
        let [along, across, turned] = [part(0), part(1), part(2)];
        let coordinates = [0, 1, 2].map(|k| {
            along[k] + across[k] * c + turned[k] * s + Series::constant(self.axis.origin[k], t.order())
        });
        Taylor { uv, side: Side::Along, coordinates }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        match axis {
            Axis::U => crate::analytic::angle_breaks(self.turn),
            Axis::V => self.curve.breaks(),
        }
    }
}

/// A curve moved along a direction.
#[derive(Clone, Debug)]
pub struct Extruded<C> {
    curve: C,
    direction: Vec3,
    range: Interval,
}

impl<C: Curve> Extruded<C> {
    /// The curve moved by `v direction` for v over `range`, which may be infinite.
    ///
    /// ```
    /// use osculate_geom::analytic::{Conic, Placement};
    /// use osculate_geom::{Extruded, Interval, Point3, SweepError, Surface, Vec3, uv};
    /// let circle = Conic::circle(25.0, Placement::identity())?;
    /// let shaft = Extruded::new(circle, Vec3::z(), Interval::new(0.0, 80.0))?;
    /// assert_eq!(shaft.point(uv(0.0, 30.0)), Point3::new(25.0, 0.0, 30.0));
    /// let nowhere = Extruded::new(circle, Vec3::zeros(), Interval::new(0.0, 80.0));
    /// assert!(matches!(nowhere, Err(SweepError::Direction { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::Direction`], [`SweepError::Range`].
    pub fn new(curve: C, direction: Vec3, range: Interval) -> Result<Self, SweepError> {
        let length_mm = direction.norm();
        if !(length_mm > 0.0 && length_mm.is_finite()) {
            return Err(SweepError::Direction { length_mm });
        }
        if range.lo < range.hi {
            Ok(Self { curve, direction, range: Interval::new(range.lo, range.hi) })
        } else {
            Err(SweepError::Range { from: range.lo, to: range.hi })
        }
    }

    /// The directrix at v = 0.
    #[must_use]
    pub const fn curve(&self) -> &C {
        &self.curve
    }

    /// The motion of a unit of v, mm.
    #[must_use]
    pub const fn direction(&self) -> &Vec3 {
        &self.direction
    }
}

impl<C: Curve> Surface for Extruded<C> {
    fn domain(&self) -> Domain {
        Domain { u: self.curve.domain(), v: self.range }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let CurveJet3 { point, first, second, .. } = self.curve.taylor(uv.u, 2).jet();
        Jet2 {
            uv,
            point: point + self.direction * uv.v,
            du: first,
            dv: self.direction,
            duu: second,
            duv: Vec3::zeros(),
            dvv: Vec3::zeros(),
            side: Side::Along,
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let along = self.curve.taylor(uv.u, order).along(Axis::U, 1.0);
        let v = Series::variable(Axis::V, uv.v, order);
        let coordinates = [0, 1, 2].map(|k| along[k] + v * self.direction[k]);
        Taylor { uv, side: Side::Along, coordinates }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        match axis {
            Axis::U => self.curve.breaks(),
            Axis::V => vec![self.range.lo, self.range.hi],
        }
    }
}

/// Straight lines between two curves: `a` at v = 0, `b` at v = 1. u is the parameter of `a`; that of `b` runs
/// proportionally over its own domain.
#[derive(Clone, Debug)]
pub struct Ruled<A, B> {
    a: A,
    b: B,
}

impl<A: Curve, B: Curve> Ruled<A, B> {
    /// The ruled surface between two curves with ends.
    ///
    /// ```
    /// use osculate_geom::{Point3, Ruled, Surface, analytic::Line, uv};
    /// // Two straight edges that are turned against each other: a saddle.
    /// let edge = |y: f64, rise: f64| Line::segment(Point3::new(0.0, y, 0.0), Point3::new(10.0, y, rise));
    /// let ruled = Ruled::new(edge(0.0, 0.0)?, edge(10.0, 10.0)?)?;
    /// assert_eq!(ruled.point(uv(0.5, 0.5)), Point3::new(5.0, 5.0, 2.5));
    /// assert!(ruled.jet2(uv(0.5, 0.5)).forms()?.gauss() < 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SweepError::Unlimited`] for a curve without ends.
    pub fn new(at_zero: A, at_one: B) -> Result<Self, SweepError> {
        for d in [at_zero.domain(), at_one.domain()] {
            if !(d.length() > 0.0 && d.length().is_finite()) {
                return Err(SweepError::Unlimited { lo: d.lo, hi: d.hi });
            }
        }
        Ok(Self { a: at_zero, b: at_one })
    }

    /// The directrices at v = 0 and v = 1.
    #[must_use]
    pub const fn curves(&self) -> (&A, &B) {
        (&self.a, &self.b)
    }

    /// Parameter of `b` at u, and its rate.
    fn other(&self, u: f64) -> (f64, f64) {
        let (a, b) = (self.a.domain(), self.b.domain());
        let rate = b.length() / a.length();
        // Equal domains map to the same parameter without rounding, and ends to ends.
        let t = if a.lo == b.lo && rate == 1.0 {
            u
        } else if u == a.hi {
            b.hi
        } else {
            b.lo + (u - a.lo) * rate
        };
        (t, rate)
    }
}

impl<A: Curve, B: Curve> Surface for Ruled<A, B> {
    fn domain(&self) -> Domain {
        let (a, b) = (self.a.domain(), self.b.domain());
        let u = Interval { periodic: a.periodic && b.periodic, ..a };
        Domain { u, v: Interval::new(0.0, 1.0) }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let (t, rate) = self.other(uv.u);
        let (p, q) = (self.a.taylor(uv.u, 2).jet(), self.b.taylor(t, 2).jet());
        let mix = |x: &Vec3, y: &Vec3| x + (y - x) * uv.v;
        let (q1, q2) = (q.first * rate, q.second * (rate * rate));
        let ruling = q.point - p.point;
        Jet2 {
            uv,
            point: p.point + ruling * uv.v,
            du: mix(&p.first, &q1),
            dv: ruling,
            duu: mix(&p.second, &q2),
            duv: q1 - p.first,
            dvv: Vec3::zeros(),
            side: Side::Along,
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let (t, rate) = self.other(uv.u);
        let p = self.a.taylor(uv.u, order).along(Axis::U, 1.0);
        let q = self.b.taylor(t, order).along(Axis::U, rate);
        let v = Series::variable(Axis::V, uv.v, order);
        Taylor { uv, side: Side::Along, coordinates: [0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * v) }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        if axis == Axis::V {
            return vec![0.0, 1.0];
        }
        let (a, b) = (self.a.domain(), self.b.domain());
        let back = a.length() / b.length();
        let inner = |t: &f64| *t > b.lo && *t < b.hi;
        let mut all = self.a.breaks();
        all.extend(self.b.breaks().into_iter().filter(inner).map(|t| a.lo + (t - b.lo) * back));
        all.sort_by(f64::total_cmp);
        // Breaks of both curves at one place, but for the rounding of the map.
        all.dedup_by(|x, y| *x - *y <= 1e-13 * a.length());
        if let Some(last) = all.last_mut() {
            *last = a.hi;
        }
        all
    }
}
