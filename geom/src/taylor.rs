//! The Taylor polynomial of a surface at a place, from which jets of any order are read.

use crate::jet::{Jet2, Jet3, Side};
use crate::point::{Axis, Point3, Uv, Vec3};
use crate::series::Series;

/// A surface to a given order about a place: one [`Series`] for each coordinate, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor {
    /// The place.
    pub uv: Uv,
    /// Which way the outward normal points.
    pub side: Side,
    /// x, y and z over the steps of u and v from the place.
    pub coordinates: [Series; 3],
}

impl Taylor {
    /// Orders of derivatives that are known.
    #[must_use]
    pub fn order(&self) -> usize {
        self.coordinates.iter().map(Series::order).min().unwrap_or(0)
    }

    /// The derivative i times by u and j times by v; NaN above the order.
    #[must_use]
    pub fn derivative(&self, i: usize, j: usize) -> Vec3 {
        Vec3::from([0, 1, 2].map(|k: usize| self.coordinates[k].derivative(i, j)))
    }

    /// The partial derivatives by one parameter, as series one order shorter.
    #[must_use]
    pub fn differentiated(&self, axis: Axis) -> [Series; 3] {
        self.coordinates.map(|c| c.differentiated(axis))
    }

    /// Point and derivatives to second order.
    #[must_use]
    pub fn jet2(&self) -> Jet2 {
        Jet2 {
            uv: self.uv,
            point: self.derivative(0, 0).into(),
            du: self.derivative(1, 0),
            dv: self.derivative(0, 1),
            duu: self.derivative(2, 0),
            duv: self.derivative(1, 1),
            dvv: self.derivative(0, 2),
            side: self.side,
        }
    }

    /// Point and derivatives to second order of the polynomial at another place, with the side of this one.
    ///
    /// Off the surface's own by the first terms left out, in the steps of u and v to the power of the order and one.
    ///
    /// ```
    /// use osculate_geom::{Surface, analytic::Sphere, uv};
    /// // A polynomial of order 6 a hundredth of a radian on: off by the seventh power of that.
    /// let ball = Sphere::new(10.0)?;
    /// let near = ball.taylor(uv(0.3, 0.5), 6).jet2_at(uv(0.31, 0.5));
    /// assert!((near.point - ball.point(uv(0.31, 0.5))).norm() < 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn jet2_at(&self, at: Uv) -> Jet2 {
        let (order, x, y) = (self.order(), at.u - self.uv.u, at.v - self.uv.v);
        // Horner's rule with two derivatives, the second ones halved: in y on every row, in x on what comes of the rows.
        let (mut s, mut su, mut sv) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
        let (mut suu, mut suv, mut svv) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
        for i in (0..=order).rev() {
            let (mut r0, mut r1, mut r2) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
            for j in (0..=order - i).rev() {
                r2 = r2 * y + r1;
                r1 = r1 * y + r0;
                r0 = r0 * y + Vec3::from([0, 1, 2].map(|k: usize| self.coordinates[k].coefficient(i, j)));
            }
            suu = suu * x + su;
            su = su * x + s;
            suv = suv * x + sv;
            s = s * x + r0;
            sv = sv * x + r1;
            svv = svv * x + r2;
        }
        Jet2 {
            uv: at,
            point: s.into(),
            du: su,
            dv: sv,
            duu: suu * 2.0,
            duv: suv,
            dvv: svv * 2.0,
            side: self.side,
        }
    }

    /// Point and derivatives to third order.
    #[must_use]
    pub fn jet3(&self) -> Jet3 {
        Jet3 {
            jet2: self.jet2(),
            duuu: self.derivative(3, 0),
            duuv: self.derivative(2, 1),
            duvv: self.derivative(1, 2),
            dvvv: self.derivative(0, 3),
        }
    }

    /// The polynomial with its value moved to `point(value)` and every derivative mapped by the linear `vector`.
    #[must_use]
    pub fn mapped(&self, point: impl Fn(&Point3) -> Point3, vector: impl Fn(&Vec3) -> Vec3) -> Self {
        let order = self.order();
        let mut out = [Series::constant(0.0, order); 3];
        for (axis, series) in out.iter_mut().enumerate() {
            *series = Series::from_coefficients(order, |i, j| {
                let c = Vec3::from(self.coordinates.map(|s| s.coefficient(i, j)));
                if i + j == 0 { point(&c.into())[axis] } else { vector(&c)[axis] }
            });
        }
        Self { coordinates: out, ..*self }
    }

    /// The same surface with the material on the other side.
    #[must_use]
    pub fn flipped(self) -> Self {
        self.turned(Side::Against)
    }

    /// The polynomial with its material side as it is, or against that.
    #[must_use]
    pub fn turned(mut self, side: Side) -> Self {
        self.side = self.side.seen(side);
        self
    }
}

/// Cross product of vectors of series.
pub(crate) fn cross(a: &[Series; 3], b: &[Series; 3]) -> [Series; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The series divided by its length.
pub(crate) fn unit(a: &[Series; 3]) -> [Series; 3] {
    // Scaled first, so that squares neither overflow nor vanish.
    let size = a.iter().map(|c| c.value().abs()).fold(0.0, f64::max);
    let a = a.map(|c| c * (1.0 / size));
    let r = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt().recip();
    a.map(|c| c * r)
}

/// Series in steps measured in `lengths`.
pub(crate) fn rescaled(s: &[Series; 3], lengths: [f64; 2]) -> [Series; 3] {
    s.map(|c| {
        Series::from_coefficients(c.order(), |i, j| {
            c.coefficient(i, j) * lengths[0].powi(i as i32) * lengths[1].powi(j as i32)
        })
    })
}

/// The polynomial in steps measured in `lengths`.
pub(crate) fn scaled(t: &Taylor, lengths: [f64; 2]) -> Taylor {
    Taylor { coordinates: rescaled(&t.coordinates, lengths), ..*t }
}
