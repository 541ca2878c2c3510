//! Taylor data of a surface at a point to second and third order, and what follows from it alone.

use crate::point::{Point3, Uv, Vec3};

/// Which side of a surface the material is on.
///
/// The outward normal `n` points out of the material, towards the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Side {
    /// `n` is along `S_u x S_v`.
    #[default]
    Along,
    /// `n` is against `S_u x S_v`.
    Against,
}

impl Side {
    /// `+1` for [`Side::Along`], `-1` for [`Side::Against`].
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Along => 1.0,
            Self::Against => -1.0,
        }
    }

    /// This side [`Side::Along`] itself, the other one [`Side::Against`] itself.
    #[must_use]
    pub const fn seen(self, side: Self) -> Self {
        match side {
            Self::Along => self,
            Self::Against => self.flipped(),
        }
    }

    /// The other side.
    #[must_use]
    pub const fn flipped(self) -> Self {
        match self {
            Self::Along => Self::Against,
            Self::Against => Self::Along,
        }
    }
}

/// A point of a surface with its partial derivatives to second order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet2 {
    /// Where the jet was taken.
    pub uv: Uv,
    /// S, mm.
    pub point: Point3,
    /// S_u.
    pub du: Vec3,
    /// S_v.
    pub dv: Vec3,
    /// S_uu.
    pub duu: Vec3,
    /// S_uv.
    pub duv: Vec3,
    /// S_vv.
    pub dvv: Vec3,
    /// Which way the outward normal points.
    pub side: Side,
}

impl Jet2 {
    /// The jet with its material side as it is, or against that.
    #[must_use]
    pub const fn turned(mut self, side: Side) -> Self {
        self.side = self.side.seen(side);
        self
    }

    /// The tangent vector `a S_u + b S_v`.
    ///
    /// ```
    /// use osculate_geom::{Interval, Surface, Vec3, analytic::Cylinder, uv};
    /// // A radian around a shaft of radius 25 is 25 mm, and bends towards the axis.
    /// let jet = Cylinder::new(25.0, Interval::new(0.0, 80.0))?.jet2(uv(0.0, 40.0));
    /// assert!((jet.tangent(uv(1.0, 2.0)) - Vec3::new(0.0, 25.0, 2.0)).norm() < 1e-12);
    /// assert!((jet.second(uv(1.0, 2.0)) - Vec3::new(-25.0, 0.0, 0.0)).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn tangent(&self, rate: Uv) -> Vec3 {
        self.du * rate.u + self.dv * rate.v
    }

    /// The second derivative of S along a curve with parameter rate `rate` and no parameter acceleration.
    #[must_use]
    pub fn second(&self, rate: Uv) -> Vec3 {
        self.duu * (rate.u * rate.u) + self.duv * (2.0 * rate.u * rate.v) + self.dvv * (rate.v * rate.v)
    }
}

/// A point of a surface with its partial derivatives to third order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet3 {
    /// Point and derivatives to second order.
    pub jet2: Jet2,
    /// S_uuu.
    pub duuu: Vec3,
    /// S_uuv.
    pub duuv: Vec3,
    /// S_uvv.
    pub duvv: Vec3,
    /// S_vvv.
    pub dvvv: Vec3,
}

impl Jet3 {
    /// The jet with its material side as it is, or against that.
    #[must_use]
    pub const fn turned(mut self, side: Side) -> Self {
        self.jet2 = self.jet2.turned(side);
        self
    }

    /// The third derivative of S along a curve with parameter rate `rate` that runs straight in the parameters.
    #[must_use]
    pub fn third(&self, rate: Uv) -> Vec3 {
        let (a, b) = (rate.u, rate.v);
        self.duuu * (a * a * a)
            + self.duuv * (3.0 * a * a * b)
            + self.duvv * (3.0 * a * b * b)
            + self.dvvv * (b * b * b)
    }
}
