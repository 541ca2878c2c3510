//! Plane and surfaces of revolution: u is the angle about z (plane: x), v the meridian parameter.

use super::{BadSize, positive};
use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Side};
use crate::point::{Axis, Point3, Uv, Vec3};
use crate::series::Series;
use crate::surface::Surface;
use crate::taylor::Taylor;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Breaks of an angle: every 45 degrees, so that a few Gauss points between breaks integrate to rounding.
pub(crate) fn angle_breaks(i: Interval) -> Vec<f64> {
    let n = ((i.length() / (TAU / 8.0)) - 1e-9).ceil().max(1.0) as usize;
    (0..=n).map(|k| i.at(k as f64 / n as f64)).collect()
}

/// Point and derivatives of a meridian `(r, z)(v)` turned about z by u.
fn revolve(uv: Uv, r: [f64; 3], z: [f64; 3]) -> Jet2 {
    let (s, c) = uv.u.sin_cos();
    Jet2 {
        uv,
        point: Point3::new(r[0] * c, r[0] * s, z[0]),
        du: Vec3::new(-r[0] * s, r[0] * c, 0.0),
        dv: Vec3::new(r[1] * c, r[1] * s, z[1]),
        duu: Vec3::new(-r[0] * c, -r[0] * s, 0.0),
        duv: Vec3::new(-r[1] * s, r[1] * c, 0.0),
        dvv: Vec3::new(r[2] * c, r[2] * s, z[2]),
        side: Side::Along,
    }
}

macro_rules! revolved {
    ($t:ty, $angle_v:expr) => {
        impl Surface for $t {
            fn domain(&self) -> Domain {
                self.domain
            }
            fn jet2(&self, uv: Uv) -> Jet2 {
                let (r, z) = self.meridian(uv.v);
                revolve(uv, r, z)
            }
            fn taylor(&self, uv: Uv, order: usize) -> Taylor {
                let (s, c) = Series::variable(Axis::U, uv.u, order).sin_cos();
                let [r, z] = self.meridian_series(Series::variable(Axis::V, uv.v, order));
                Taylor { uv, side: Side::Along, coordinates: [r * c, r * s, z] }
            }
            fn breaks(&self, axis: Axis) -> Vec<f64> {
                match axis {
                    Axis::U => angle_breaks(self.domain.u),
                    Axis::V if $angle_v => angle_breaks(self.domain.v),
                    Axis::V => vec![self.domain.v.lo, self.domain.v.hi],
                }
            }
        }
    };
}

/// The plane z = 0 with u = x and v = y, mm; the normal is +z.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    domain: Domain,
}

impl Plane {
    /// The rectangle `[u.lo, u.hi] x [v.lo, v.hi]` of the plane.
    #[must_use]
    pub const fn new(domain: Domain) -> Self {
        Self { domain }
    }
}

impl Surface for Plane {
    fn domain(&self) -> Domain {
        self.domain
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        Jet2 {
            uv,
            point: Point3::new(uv.u, uv.v, 0.0),
            du: Vec3::x(),
            dv: Vec3::y(),
            duu: Vec3::zeros(),
            duv: Vec3::zeros(),
            dvv: Vec3::zeros(),
            side: Side::Along,
        }
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let (x, y) = (Series::variable(Axis::U, uv.u, order), Series::variable(Axis::V, uv.v, order));
        Taylor { uv, side: Side::Along, coordinates: [x, y, Series::constant(0.0, order)] }
    }
}

/// Circular cylinder about z: u the angle, v = z.
#[derive(Clone, Copy, Debug)]
pub struct Cylinder {
    radius: f64,
    domain: Domain,
}

impl Cylinder {
    /// The cylinder of `radius_mm` between `z.lo` and `z.hi`.
    ///
    /// # Errors
    /// [`BadSize`] for a radius that is not positive.
    pub fn new(radius_mm: f64, z: Interval) -> Result<Self, BadSize> {
        let radius = positive("radius_mm", radius_mm)?;
        Ok(Self { radius, domain: Domain { u: Interval::periodic(0.0, TAU), v: z } })
    }
    fn meridian(&self, v: f64) -> ([f64; 3], [f64; 3]) {
        ([self.radius, 0.0, 0.0], [v, 1.0, 0.0])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        [Series::constant(self.radius, v.order()), v]
    }
}
revolved!(Cylinder, false);

/// Circular cone about z: u the angle, v the distance along the generator from the circle of `radius_mm` at z = 0.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    radius: f64,
    sin: f64,
    cos: f64,
    domain: Domain,
}

impl Cone {
    /// The cone whose radius at z = 0 is `radius_mm` and grows with z at `half_angle_rad`.
    ///
    /// # Errors
    /// [`BadSize`] for a negative radius or a half angle that is not strictly between -90 and 90 degrees.
    pub fn new(radius_mm: f64, half_angle_rad: f64, v: Interval) -> Result<Self, BadSize> {
        if !(radius_mm >= 0.0 && radius_mm.is_finite()) {
            return Err(BadSize { what: "radius_mm", need: "zero or positive", got: radius_mm });
        }
        if half_angle_rad.is_nan() || half_angle_rad.abs() >= FRAC_PI_2 {
            return Err(BadSize { what: "half_angle", need: "below 90 degrees", got: half_angle_rad });
        }
        let (sin, cos) = half_angle_rad.sin_cos();
        Ok(Self { radius: radius_mm, sin, cos, domain: Domain { u: Interval::periodic(0.0, TAU), v } })
    }
    fn meridian(&self, v: f64) -> ([f64; 3], [f64; 3]) {
        ([self.radius + v * self.sin, self.sin, 0.0], [v * self.cos, self.cos, 0.0])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        [Series::constant(self.radius, v.order()) + v * self.sin, v * self.cos]
    }
}
revolved!(Cone, false);

/// Sphere: u = longitude, v = latitude.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    radius: f64,
    domain: Domain,
}

impl Sphere {
    /// The sphere of `radius_mm` about the origin.
    ///
    /// # Errors
    /// [`BadSize`] for a radius that is not positive.
    pub fn new(radius_mm: f64) -> Result<Self, BadSize> {
        let radius = positive("radius_mm", radius_mm)?;
        let domain = Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(-FRAC_PI_2, FRAC_PI_2) };
        Ok(Self { radius, domain })
    }
    fn meridian(&self, v: f64) -> ([f64; 3], [f64; 3]) {
        let (s, c) = v.sin_cos();
        let a = self.radius;
        ([a * c, -a * s, -a * c], [a * s, a * c, -a * s])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        let (s, c) = v.sin_cos();
        [c * self.radius, s * self.radius]
    }
}
revolved!(Sphere, true);

/// Torus about z: u the angle about the axis, v the angle on the tube, 0 outermost, pi innermost.
#[derive(Clone, Copy, Debug)]
pub struct Torus {
    major: f64,
    minor: f64,
    domain: Domain,
}

impl Torus {
    /// The torus with tube centres at `major_radius_mm` and tube radius `minor_radius_mm`.
    ///
    /// # Errors
    /// [`BadSize`] for radii that are not positive.
    pub fn new(major_radius_mm: f64, minor_radius_mm: f64) -> Result<Self, BadSize> {
        let major = positive("major_radius_mm", major_radius_mm)?;
        let minor = positive("minor_radius_mm", minor_radius_mm)?;
        let domain = Domain { u: Interval::periodic(0.0, TAU), v: Interval::periodic(0.0, TAU) };
        Ok(Self { major, minor, domain })
    }
    fn meridian(&self, v: f64) -> ([f64; 3], [f64; 3]) {
        let (s, c) = v.sin_cos();
        let a = self.minor;
        ([self.major + a * c, -a * s, -a * c], [a * s, a * c, -a * s])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        let (s, c) = v.sin_cos();
        [Series::constant(self.major, v.order()) + c * self.minor, s * self.minor]
    }
}
revolved!(Torus, true);
