//! Ellipsoid and paraboloid.

use super::{BadSize, positive};
use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Side};
use crate::point::{Axis, Point3, Uv, Vec3};
use crate::series::Series;
use crate::surface::Surface;
use crate::taylor::Taylor;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Ellipsoid: u = longitude angle, v = latitude angle of the unit sphere that is stretched to the semi-axes.
#[derive(Clone, Copy, Debug)]
pub struct Ellipsoid {
    axes: Vec3,
}

impl Ellipsoid {
    /// The ellipsoid with the given semi-axes along x, y, z, mm.
    ///
    /// ```
    /// use osculate_geom::{Surface, analytic::Ellipsoid, uv};
    /// // At its end on the x axis an ellipsoid bends by a / b^2 along y and by a / c^2 along z.
    /// let egg = Ellipsoid::new([30.0, 20.0, 10.0])?;
    /// let k = egg.jet2(uv(0.0, 0.0)).forms()?.principal();
    /// assert!((k.k_max - 30.0 / 100.0).abs() < 1e-14 && (k.k_min - 30.0 / 400.0).abs() < 1e-14);
    /// assert!(k.d_max.z.abs() > 1.0 - 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] for a semi-axis that is not positive.
    pub fn new(semi_axes_mm: [f64; 3]) -> Result<Self, BadSize> {
        for a in semi_axes_mm {
            positive("semi_axes_mm", a)?;
        }
        Ok(Self { axes: Vec3::from(semi_axes_mm) })
    }

    /// Semi-axes along x, y and z, mm.
    #[must_use]
    pub fn semi_axes_mm(&self) -> [f64; 3] {
        self.axes.into()
    }
}

impl Surface for Ellipsoid {
    fn domain(&self) -> Domain {
        Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(-FRAC_PI_2, FRAC_PI_2) }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let ((su, cu), (sv, cv)) = (uv.u.sin_cos(), uv.v.sin_cos());
        let scale = |x: f64, y: f64, z: f64| Vec3::new(x, y, z).component_mul(&self.axes);
        Jet2 {
            uv,
            point: Point3::from(scale(cv * cu, cv * su, sv)),
            du: scale(-cv * su, cv * cu, 0.0),
            dv: scale(-sv * cu, -sv * su, cv),
            duu: scale(-cv * cu, -cv * su, 0.0),
            duv: scale(sv * su, -sv * cu, 0.0),
            dvv: scale(-cv * cu, -cv * su, -sv),
            side: Side::Along,
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let (su, cu) = Series::variable(Axis::U, uv.u, order).sin_cos();
        let (sv, cv) = Series::variable(Axis::V, uv.v, order).sin_cos();
        let a = &self.axes;
        Taylor { uv, side: Side::Along, coordinates: [cv * cu * a.x, cv * su * a.y, sv * a.z] }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain().get(axis);
        let n = (i.length() / (TAU / 8.0)).round() as usize;
        (0..=n).map(|k| i.at(k as f64 / n as f64)).collect()
    }
}

/// `z = a x^2 + b y^2` over a square, u = x and v = y; the natural normal points to +z (material below).
#[derive(Clone, Copy, Debug)]
pub struct Paraboloid {
    a: f64,
    b: f64,
    half: f64,
}

impl Paraboloid {
    /// The paraboloid with coefficients `ab_per_mm` over `|x|, |y| <= half_size_mm`.
    ///
    /// ```
    /// use osculate_geom::{Flipped, Surface, analytic::Paraboloid, uv};
    /// // A bowl z = 0.01 (x^2 + y^2) has radius 50 mm at its bottom: hollow with the material below, round with it above.
    /// let bowl = Paraboloid::new([0.01, 0.01], 20.0)?;
    /// assert!((bowl.jet2(uv(0.0, 0.0)).forms()?.mean() + 1.0 / 50.0).abs() < 1e-15);
    /// let bump = Flipped(bowl);
    /// assert!((bump.jet2(uv(0.0, 0.0)).forms()?.mean() - 1.0 / 50.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] for coefficients that are not finite or a size that is not positive.
    pub fn new(ab_per_mm: [f64; 2], half_size_mm: f64) -> Result<Self, BadSize> {
        for c in ab_per_mm {
            if !c.is_finite() {
                return Err(BadSize { what: "a_per_mm and b_per_mm", need: "finite", got: c });
            }
        }
        let half = positive("half_size_mm", half_size_mm)?;
        Ok(Self { a: ab_per_mm[0], b: ab_per_mm[1], half })
    }

    /// The coefficients of x^2 and y^2, 1/mm.
    #[must_use]
    pub const fn coefficients_per_mm(&self) -> [f64; 2] {
        [self.a, self.b]
    }
}

impl Surface for Paraboloid {
    fn domain(&self) -> Domain {
        let i = Interval::new(-self.half, self.half);
        Domain { u: i, v: i }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        let (a, b, x, y) = (self.a, self.b, uv.u, uv.v);
        Jet2 {
            uv,
            point: Point3::new(x, y, a * x * x + b * y * y),
            du: Vec3::new(1.0, 0.0, 2.0 * a * x),
            dv: Vec3::new(0.0, 1.0, 2.0 * b * y),
            duu: Vec3::new(0.0, 0.0, 2.0 * a),
            duv: Vec3::zeros(),
            dvv: Vec3::new(0.0, 0.0, 2.0 * b),
            side: Side::Along,
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let (x, y) = (Series::variable(Axis::U, uv.u, order), Series::variable(Axis::V, uv.v, order));
        Taylor { uv, side: Side::Along, coordinates: [x, y, x * x * self.a + y * y * self.b] }
    }
}
