//! Plane and surfaces of revolution: u is the angle about z (plane: x), v the meridian parameter.

use super::{BadSize, positive};
use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Jet3, Side};
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

/// `range` when its ends are numbers in order; they may be infinite.
fn upwards(what: &'static str, range: Interval) -> Result<Interval, BadSize> {
    if range.lo <= range.hi {
        Ok(range)
    } else {
        Err(BadSize { what, need: "a range from low to high", got: range.length() })
    }
}

/// Point and derivatives of a meridian `(r, z)(v)` turned about z by u.
fn revolve(uv: Uv, r: [f64; 4], z: [f64; 4]) -> Jet3 {
    let (s, c) = uv.u.sin_cos();
    let jet2 = Jet2 {
        uv,
        point: Point3::new(r[0] * c, r[0] * s, z[0]),
        du: Vec3::new(-r[0] * s, r[0] * c, 0.0),
        dv: Vec3::new(r[1] * c, r[1] * s, z[1]),
        duu: Vec3::new(-r[0] * c, -r[0] * s, 0.0),
        duv: Vec3::new(-r[1] * s, r[1] * c, 0.0),
        dvv: Vec3::new(r[2] * c, r[2] * s, z[2]),
        side: Side::Along,
    };
    Jet3 {
        jet2,
        duuu: Vec3::new(r[0] * s, -r[0] * c, 0.0),
        duuv: Vec3::new(-r[1] * c, -r[1] * s, 0.0),
        duvv: Vec3::new(-r[2] * s, r[2] * c, 0.0),
        dvvv: Vec3::new(r[3] * c, r[3] * s, z[3]),
    }
}

macro_rules! revolved {
    ($t:ty, angle_v: $angle_v:expr, |$s:ident| $side:expr) => {
        impl Surface for $t {
            fn domain(&self) -> Domain {
                self.domain
            }
            fn jet2(&self, uv: Uv) -> Jet2 {
                self.jet3(uv).jet2
            }
            fn jet3(&self, uv: Uv) -> Jet3 {
                let ($s, (r, z)) = (self, self.meridian(uv.v));
                revolve(uv, r, z).turned($side)
            }
            fn taylor(&self, uv: Uv, order: usize) -> Taylor {
                let (s, c) = Series::variable(Axis::U, uv.u, order).sin_cos();
                let [r, z] = self.meridian_series(Series::variable(Axis::V, uv.v, order));
                let $s = self;
                Taylor { uv, side: $side, coordinates: [r * c, r * s, z] }
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
    ///
    /// ```
    /// use osculate_geom::{Domain, Interval, Point3, Surface, analytic::Plane, uv};
    /// let plane = Plane::new(Domain { u: Interval::new(0.0, 80.0), v: Interval::new(0.0, 50.0) });
    /// assert_eq!(plane.point(uv(10.0, 20.0)), Point3::new(10.0, 20.0, 0.0));
    /// assert_eq!(plane.jet2(uv(10.0, 20.0)).normal()?.z, 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
    /// [`BadSize`] for a radius that is not positive and a range that is not in order.
    pub fn new(radius_mm: f64, z: Interval) -> Result<Self, BadSize> {
        let radius = positive("radius_mm", radius_mm)?;
        Ok(Self { radius, domain: Domain { u: Interval::periodic(0.0, TAU), v: upwards("z", z)? } })
    }
    /// Radius, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.radius
    }
    fn meridian(&self, v: f64) -> ([f64; 4], [f64; 4]) {
        ([self.radius, 0.0, 0.0, 0.0], [v, 1.0, 0.0, 0.0])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        [Series::constant(self.radius, v.order()), v]
    }
}
revolved!(Cylinder, angle_v: false, |_s| Side::Along);

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
    /// ```
    /// use osculate_geom::{Interval, Surface, analytic::Cone, uv};
    /// // A draft of 30 degrees: 10 mm along the generator the radius is 5 mm larger. Straight along it, r / cos 30 deg across.
    /// let cone = Cone::new(20.0, 30f64.to_radians(), Interval::new(0.0, 10.0))?;
    /// assert!((cone.point(uv(0.0, 10.0)).x - 25.0).abs() < 1e-12);
    /// let k = cone.jet2(uv(0.0, 10.0)).forms()?.principal();
    /// assert!(k.k_min.abs() < 1e-15 && (k.k_max - 30f64.to_radians().cos() / 25.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] for a negative radius, a half angle that is not strictly between -90 and 90 degrees, and a range that is
    /// not in order.
    pub fn new(radius_mm: f64, half_angle_rad: f64, v: Interval) -> Result<Self, BadSize> {
        if !(radius_mm >= 0.0 && radius_mm.is_finite()) {
            return Err(BadSize { what: "radius_mm", need: "zero or positive", got: radius_mm });
        }
        if half_angle_rad.is_nan() || half_angle_rad.abs() >= FRAC_PI_2 {
            return Err(BadSize { what: "half_angle", need: "below 90 degrees", got: half_angle_rad });
        }
        let (sin, cos) = half_angle_rad.sin_cos();
        let v = upwards("v", v)?;
        Ok(Self { radius: radius_mm, sin, cos, domain: Domain { u: Interval::periodic(0.0, TAU), v } })
    }
    /// Radius at z = 0, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.radius
    }
    /// Angle between axis and generator, rad.
    #[must_use]
    pub fn half_angle_rad(&self) -> f64 {
        self.sin.atan2(self.cos)
    }
    fn meridian(&self, v: f64) -> ([f64; 4], [f64; 4]) {
        ([self.radius + v * self.sin, self.sin, 0.0, 0.0], [v * self.cos, self.cos, 0.0, 0.0])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        [Series::constant(self.radius, v.order()) + v * self.sin, v * self.cos]
    }
}
revolved!(Cone, angle_v: false, |_s| Side::Along);

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
    /// Radius, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.radius
    }
    fn meridian(&self, v: f64) -> ([f64; 4], [f64; 4]) {
        let (s, c) = v.sin_cos();
        let a = self.radius;
        ([a * c, -a * s, -a * c, a * s], [a * s, a * c, -a * s, -a * c])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        let (s, c) = v.sin_cos();
        [c * self.radius, s * self.radius]
    }
}
revolved!(Sphere, angle_v: true, |_s| Side::Along);

/// The parts of a spindle torus, whose tube is wider than its circle: the two meet in apexes on the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Spindle {
    /// The outer part.
    Apple,
    /// The part inside the apple.
    Lemon,
}

/// Torus about z: u the angle about the axis, v the angle on the tube, 0 outermost, pi innermost.
///
/// Where the tube is wider than its circle the surface crosses itself on the axis, at `cos v = -major / minor`; these
/// two apexes have no tangent plane ([`limit`](crate::limit) says by how much the normals differ).
#[derive(Clone, Copy, Debug)]
pub struct Torus {
    major: f64,
    minor: f64,
    side: Side,
    domain: Domain,
}

impl Torus {
    /// The torus with tube centres at `major_radius_mm` and tube radius `minor_radius_mm`, all of it.
    ///
    /// # Errors
    /// [`BadSize`] for radii that are not positive.
    pub fn new(major_radius_mm: f64, minor_radius_mm: f64) -> Result<Self, BadSize> {
        let major = positive("major_radius_mm", major_radius_mm)?;
        let minor = positive("minor_radius_mm", minor_radius_mm)?;
        let domain = Domain { u: Interval::periodic(0.0, TAU), v: Interval::periodic(0.0, TAU) };
        Ok(Self { major, minor, side: Side::Along, domain })
    }

    /// One part of the torus whose tube is not narrower than its circle, from apex to apex. The outward normal points
    /// out of the tube on both; on the lemon that is against `S_u x S_v`.
    ///
    /// ```
    /// use osculate_geom::{Surface, analytic::{Spindle, Torus}};
    /// // A tube of radius 5 about a circle of radius 3: the apexes lie on the axis, 4 mm above and below.
    /// let apple = Torus::new(3.0, 5.0)?.spindle(Spindle::Apple)?;
    /// let top = apple.point(apple.domain().at(0.0, 1.0));
    /// assert!(top.x.abs() < 1e-12 && (top.z - 4.0).abs() < 1e-12);
    /// assert!(Torus::new(5.0, 3.0)?.spindle(Spindle::Apple).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BadSize`] for radii that are not positive, a tube narrower than its circle, and the lemon of equal radii,
    /// which is a point.
    pub fn spindle(self, part: Spindle) -> Result<Self, BadSize> {
        let ratio = self.major / self.minor;
        let most = if part == Spindle::Lemon { 1.0f64.next_down() } else { 1.0 };
        if ratio > most {
            let need = if part == Spindle::Lemon { "below 1" } else { "at most 1" };
            return Err(BadSize { what: "major over minor radius of a spindle torus", need, got: ratio });
        }
        let apex = (-ratio).acos();
        let (v, side) = match part {
            Spindle::Apple => (Interval::new(-apex, apex), Side::Along),
            Spindle::Lemon => (Interval::new(apex, TAU - apex), Side::Against),
        };
        Ok(Self { side, domain: Domain { v, ..self.domain }, ..self })
    }

    /// Radius of the circle of tube centres, mm.
    #[must_use]
    pub const fn major_radius_mm(&self) -> f64 {
        self.major
    }

    /// Radius of the tube, mm.
    #[must_use]
    pub const fn minor_radius_mm(&self) -> f64 {
        self.minor
    }

    fn meridian(&self, v: f64) -> ([f64; 4], [f64; 4]) {
        let (s, c) = v.sin_cos();
        let a = self.minor;
        let r = self.major + a * c;
        // On the axis the radius is what rounding makes of zero, and must not pass for a circle.
        let r = if r.abs() <= 4.0 * f64::EPSILON * (self.major + a) { 0.0 } else { r };
        ([r, -a * s, -a * c, a * s], [a * s, a * c, -a * s, -a * c])
    }
    fn meridian_series(&self, v: Series) -> [Series; 2] {
        let (s, c) = v.sin_cos();
        [Series::constant(self.major, v.order()) + c * self.minor, s * self.minor]
    }
}

revolved!(Torus, angle_v: true, |s| s.side);
