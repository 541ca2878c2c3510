//! Cutters as convex bodies of revolution: distance, and where a straight line enters them.
//!
//! A ball, flat or toroidal cutter of outer radius R and corner radius r is the r-offset of a cylinder of radius
//! `core = R - r` standing on the plane z = r, cut off at the length: one formula for all three kinds (ball: core = 0, flat:
//! r = 0). Cones, barrels and APT's general cutter have a [`crate::meridian`] of their own. Local coordinates: rho is the
//! distance from the axis, z the height above the tip.

mod bounds;
mod error;

pub use error::CutterError;

use crate::meridian::{Arc, LocalNear, Meridian, end_mill_corner};
use crate::pose::Pose;
use osculate_geom::{Point3, Unit3, Vec3};

/// A validated cutter, made from a [`CutterSpec`](crate::CutterSpec).
///
/// ```
/// use osculate_tools::{Cutter, CutterSpec};
/// let spec = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
/// let cutter = Cutter::try_from(spec)?;
/// assert_eq!((cutter.radius_mm(), cutter.corner_mm(), cutter.core_mm()), (10.0, 2.0, 8.0));
/// assert!(cutter.is_end_mill() && !cutter.is_ball() && cutter.length_mm() == 60.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutter {
    pub(crate) radius: f64,
    pub(crate) corner: f64,
    pub(crate) length: f64,
    /// None for ball, flat and toroidal ends.
    pub(crate) meridian: Option<Meridian>,
}

/// The part of the cutter's boundary that a line meets first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Part {
    /// The flat bottom.
    Bottom,
    /// The rounded corner or ball.
    Corner,
    /// The cylindrical side.
    Side,
    /// The upper end.
    Top,
}

/// A line enters a cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Entry {
    /// Line parameter of the entry, mm.
    pub at_mm: f64,
    /// Where on the boundary.
    pub part: Part,
}

/// A straight line `origin + s direction`, s in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Point at s = 0.
    pub origin: Point3,
    /// Unit direction.
    pub direction: Unit3,
}

impl Line {
    /// The point at `s_mm`.
    #[must_use]
    pub fn point(&self, s_mm: f64) -> Point3 {
        self.origin + self.direction.into_inner() * s_mm
    }
}

/// A line in a cutter's local coordinates: `z = wz + s dz`, `rho^2 = c + 2 b s + a s^2`.
struct LocalLine {
    wz: f64,
    dz: f64,
    a: f64,
    b: f64,
    c: f64,
}

impl LocalLine {
    fn new(line: &Line, pose: &Pose) -> Self {
        let w = line.origin - pose.tip;
        let (wz, dz) = (w.dot(&pose.axis), line.direction.dot(&pose.axis));
        // Perpendicular parts taken as vectors: 1 - dz^2 would cancel for a line along the axis.
        let wp = w - pose.axis.into_inner() * wz;
        let dp = line.direction.into_inner() - pose.axis.into_inner() * dz;
        Self { wz, dz, a: dp.norm_squared(), b: wp.dot(&dp), c: wp.norm_squared() }
    }

    fn rho(&self, s: f64) -> f64 {
        (self.c + s * (2.0 * self.b + s * self.a)).max(0.0).sqrt()
    }

    fn z(&self, s: f64) -> f64 {
        self.wz + s * self.dz
    }
}

/// Distance from the axis and height above the tip.
fn local(pose: &Pose, p: &Point3) -> (f64, f64) {
    let w = p - pose.tip;
    let z = w.dot(&pose.axis);
    ((w - pose.axis.into_inner() * z).norm(), z)
}

/// What a bottom keeps off a plane at its heel, mm: closer it rubs where it should cut.
pub const HEEL_CLEARANCE_MM: f64 = 0.05;

/// Newton steps towards the entry into the rounded corner. The distance along a line is convex, so the iteration
/// from outside is monotone and quadratic; more steps than this happen only for lines that graze.
const MAX_CORNER_STEPS: u32 = 60;

impl Cutter {
    pub(crate) fn new(diameter: f64, corner: f64, length: f64) -> Result<Self, CutterError> {
        for (what, got) in [("diameter_mm", diameter), ("length_mm", length)] {
            if !(got.is_finite() && got > 0.0) {
                return Err(CutterError::Size { what, got });
            }
        }
        let radius = 0.5 * diameter;
        if !(corner >= 0.0 && corner <= radius) {
            return Err(CutterError::Corner { corner_mm: corner, radius_mm: radius });
        }
        if length <= corner {
            return Err(CutterError::Length { length_mm: length, corner_mm: corner });
        }
        Ok(Self { radius, corner, length, meridian: None })
    }

    /// A plain cylinder, for holders and shanks: a flat cutter of this size.
    ///
    /// # Errors
    /// [`CutterError::Size`].
    pub fn cylinder(diameter_mm: f64, length_mm: f64) -> Result<Self, CutterError> {
        Self::new(diameter_mm, 0.0, length_mm)
    }

    /// The lower part of the cutter, up to `length_mm`.
    ///
    /// ```
    /// use osculate_tools::{Cutter, CutterError};
    /// // Of 60 mm the lower 25 cut. Nothing of a cutter reaches beyond its length.
    /// let whole = Cutter::cylinder(10.0, 60.0)?;
    /// assert_eq!(whole.shortened(25.0)?.length_mm(), 25.0);
    /// assert!(matches!(whole.shortened(61.0), Err(CutterError::ShapeLength { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CutterError::Length`] where that is not above the corner, [`CutterError::ShapeLength`] where it is longer.
    pub fn shortened(&self, length_mm: f64) -> Result<Self, CutterError> {
        if length_mm.is_nan() || length_mm <= self.corner {
            return Err(CutterError::Length { length_mm, corner_mm: self.corner });
        }
        if length_mm > self.length {
            return Err(CutterError::ShapeLength { length_mm, least_mm: self.corner, most_mm: self.length });
        }
        Ok(Self { length: length_mm, ..*self })
    }

    /// Outer radius R, mm: the greatest distance of the cutter's body from its axis.
    #[must_use]
    #[inline]
    pub const fn radius_mm(&self) -> f64 {
        self.radius
    }

    /// Corner radius r, mm: R for a ball, 0 for a flat end.
    #[must_use]
    #[inline]
    pub const fn corner_mm(&self) -> f64 {
        self.corner
    }

    /// Radius of the circle of corner centres, mm: R - r for ball, flat and toroidal ends.
    #[must_use]
    #[inline]
    pub const fn core_mm(&self) -> f64 {
        match &self.meridian {
            None => self.radius - self.corner,
            Some(m) => m.corner.centre_rho_mm,
        }
    }

    /// The least lean at which the bottom cuts and does not rub, rad: the one that lifts its heel, as far behind as the circle of corner
    /// centres is wide, by [`HEEL_CLEARANCE_MM`] off a plane, and never more than a degree. Zero for a ball, which has no bottom.
    ///
    /// ```
    /// use osculate_tools::{Cutter, CutterSpec};
    /// let large = CutterSpec::Toroidal { diameter_mm: 63.0, corner_radius_mm: 6.0, length_mm: 80.0 };
    /// assert!((Cutter::try_from(large)?.least_lean_rad() - (0.05f64 / 51.0).asin()).abs() < 1e-15);
    /// # Ok::<(), osculate_tools::CutterError>(())
    /// ```
    #[must_use]
    pub fn least_lean_rad(&self) -> f64 {
        let behind_mm = (2.0 * self.core_mm()).max(HEEL_CLEARANCE_MM);
        let lean_rad = (HEEL_CLEARANCE_MM / behind_mm).asin().min(1f64.to_radians());
        if self.is_ball() { 0.0 } else { lean_rad }
    }

    /// Whether the cutter is a ball, flat or toroidal end, told by its radius and corner radius alone.
    #[must_use]
    #[inline]
    pub const fn is_end_mill(&self) -> bool {
        self.meridian.is_none()
    }

    #[inline]
    pub(crate) const fn meridian(&self) -> Option<&Meridian> {
        self.meridian.as_ref()
    }

    /// The arc of the meridian that touches a plane whose normal the axis leans away from by `lean_rad` (0: upright).
    #[must_use]
    pub fn touching(&self, lean_rad: f64) -> Arc {
        match &self.meridian {
            None => end_mill_corner(self.core_mm(), self.corner),
            Some(m) => {
                let (s, c) = lean_rad.abs().sin_cos();
                m.touching([s, -c])
            }
        }
    }

    /// Length from the tip, mm.
    #[must_use]
    #[inline]
    pub const fn length_mm(&self) -> f64 {
        self.length
    }

    /// Points of the meridian from the tip to the length, (rho, z), mm, turning by at most `turn_rad` on arcs.
    ///
    /// ```
    /// use osculate_tools::{Cutter, CutterSpec};
    /// // A cone of 45 degrees with a ball of radius 1: points on the ball are 1 mm from its centre, the last is the upper end.
    /// let spec = CutterSpec::Cone {
    ///     diameter_mm: 10.0,
    ///     taper_deg: 45.0,
    ///     corner_radius_mm: 1.0,
    ///     tip_diameter_mm: None,
    ///     length_mm: 30.0,
    /// };
    /// let outline = Cutter::try_from(spec)?.outline_mm(0.1);
    /// assert!(outline.iter().take(3).all(|[rho, z]| (rho.hypot(z - 1.0) - 1.0).abs() < 1e-12));
    /// assert_eq!(outline.last(), Some(&[5.0, 30.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn outline_mm(&self, turn_rad: f64) -> Vec<[f64; 2]> {
        let own = || Meridian::end_mill(self.radius, end_mill_corner(self.core_mm(), self.corner));
        self.meridian.unwrap_or_else(own).outline(self.length, turn_rad)
    }

    /// Whether the cutter is a ball end.
    #[must_use]
    pub fn is_ball(&self) -> bool {
        self.meridian.is_none() && self.core_mm() == 0.0
    }

    /// Signed distance of a local point to the cutter, mm, negative inside. Exact but for points above the top end,
    /// where it is a lower bound.
    #[must_use]
    #[inline]
    pub fn local_distance(&self, rho_mm: f64, z_mm: f64) -> f64 {
        self.local_endless_distance(rho_mm, z_mm).max(z_mm - self.length)
    }

    /// The same for a cutter that goes on upwards without end.
    #[inline]
    pub(crate) fn local_endless_distance(&self, rho_mm: f64, z_mm: f64) -> f64 {
        if let Some(m) = &self.meridian {
            return m.near(rho_mm, z_mm).distance;
        }
        let (x, y) = (rho_mm - self.core_mm(), self.corner - z_mm);
        // Millimetres neither overflow nor underflow: the plain form, several times faster than hypot.
        (if x > 0.0 && y > 0.0 { (x * x + y * y).sqrt() } else { x.max(y) }) - self.corner
    }

    /// Signed distance of a point to the cutter in a pose, mm, see [`Cutter::local_distance`].
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3};
    /// use osculate_tools::{Cutter, CutterSpec, Pose};
    /// // A ball of radius 5 with its tip at the origin has its centre at z = 5.
    /// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
    /// let pose = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
    /// assert!((ball.distance(&pose, &Point3::new(3.0, 0.0, 1.0))).abs() < 1e-12);
    /// assert!((ball.distance(&pose, &Point3::new(0.0, 0.0, -2.0)) - 2.0).abs() < 1e-12);
    /// assert!((ball.distance(&pose, &Point3::new(4.0, 0.0, 20.0)) + 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn distance(&self, pose: &Pose, p: &Point3) -> f64 {
        let (rho, z) = local(pose, p);
        self.local_distance(rho, z)
    }

    /// Signed distance to the cutter with a shank that goes on without end.
    pub(crate) fn endless_distance(&self, pose: &Pose, p: &Point3) -> f64 {
        let (rho, z) = local(pose, p);
        self.local_endless_distance(rho, z)
    }

    /// Outward unit normal of the boundary part next to a point, in world coordinates.
    #[must_use]
    pub fn normal_at(&self, pose: &Pose, p: &Point3, part: Part) -> Vec3 {
        let axis = pose.axis.into_inner();
        let w = p - pose.tip;
        let z = w.dot(&axis);
        let radial = w - axis * z;
        let rho = radial.norm();
        let out =
            if rho > 0.0 { radial / rho } else { osculate_geom::any_perpendicular(&pose.axis).into_inner() };
        if part != Part::Top
            && let Some(m) = &self.meridian
        {
            let near = m.near(rho, z);
            return out * near.by_rho + axis * near.by_z;
        }
        match part {
            Part::Bottom => -axis,
            Part::Top => axis,
            Part::Side => out,
            Part::Corner => {
                let (x, y) = (rho - self.core_mm(), self.corner - z);
                let r = (x * x + y * y).sqrt();
                if r > 0.0 { (out * x - axis * y) / r } else { -axis }
            }
        }
    }

    /// Where a line enters the cutter, coming from s = -infinity. None where it misses.
    #[must_use]
    pub fn entry(&self, pose: &Pose, line: &Line) -> Option<Entry> {
        self.local_entry(&LocalLine::new(line, pose))
    }

    fn local_entry(&self, l: &LocalLine) -> Option<Entry> {
        // Enter the circumscribed cylinder first: the later of its three entries.
        let disc = l.b * l.b - l.a * (l.c - self.radius * self.radius);
        if disc < 0.0 {
            return None;
        }
        let (mut lo, mut hi, mut part) = (f64::NEG_INFINITY, f64::INFINITY, Part::Side);
        if l.a > 0.0 {
            let root = disc.sqrt();
            // The form without cancellation for each sign of b.
            let q = -(l.b + root.copysign(l.b));
            let (s1, s2) = if q == 0.0 {
                (-root / l.a, root / l.a)
            } else {
                (q / l.a, (l.c - self.radius * self.radius) / q)
            };
            (lo, hi) = (s1.min(s2), s1.max(s2));
        } else if l.c > self.radius * self.radius {
            return None;
        }
        if l.dz == 0.0 {
            if l.wz < 0.0 || l.wz > self.length {
                return None;
            }
        } else {
            let (bottom, top) = (-l.wz / l.dz, (self.length - l.wz) / l.dz);
            let (enter, leave, first) =
                if l.dz > 0.0 { (bottom, top, Part::Bottom) } else { (top, bottom, Part::Top) };
            if enter > lo {
                (lo, part) = (enter, first);
            }
            hi = hi.min(leave);
        }
        if lo > hi {
            return None;
        }
        if let Some(m) = &self.meridian {
            return self.shaped_entry(m, l, (lo, hi, part));
        }
        if self.corner == 0.0 || part == Part::Top {
            return Some(Entry { at_mm: lo, part });
        }
        let in_corner = |s: f64| l.rho(s) > self.core_mm() && l.z(s) < self.corner;
        if !in_corner(lo) {
            return Some(Entry { at_mm: lo, part });
        }
        if self.core_mm() == 0.0 {
            return self.ball_entry(l, hi);
        }
        self.corner_entry(l, lo, hi)
    }

    /// Entry into the ball, for a line that enters the circumscribed cylinder below the ball's centre.
    fn ball_entry(&self, l: &LocalLine, hi: f64) -> Option<Entry> {
        let z = l.wz - self.corner;
        let b = l.b + z * l.dz;
        let c = l.c + z * z - self.corner * self.corner;
        let a = l.a + l.dz * l.dz;
        let disc = b * b - a * c;
        if disc < 0.0 {
            return None;
        }
        let root = disc.sqrt();
        let s = if b > 0.0 {
            (-b - root) / a
        } else {
            let q = root - b;
            if q > 0.0 { c / q } else { 0.0 }
        };
        // A grazing line may pass the ball above its centre: it then met the side instead, which `lo` excluded.
        (s <= hi && l.z(s) <= self.corner).then_some(Entry { at_mm: s, part: Part::Corner })
    }

    /// Entry into a body with a meridian of its own: Newton on the convex distance from the entry into the circumscribed
    /// cylinder, which is monotone from outside.
    fn shaped_entry(&self, m: &Meridian, l: &LocalLine, (lo, hi, first): (f64, f64, Part)) -> Option<Entry> {
        let tol = 4.0 * f64::EPSILON * (self.radius + self.length + l.wz.abs() + l.c.sqrt());
        let mut s = lo;
        for _ in 0..MAX_CORNER_STEPS {
            let (rho, z) = (l.rho(s), l.z(s));
            let LocalNear { distance, by_rho, by_z, .. } = m.near(rho, z);
            if distance <= tol {
                let part = if s == lo && first == Part::Top {
                    Part::Top
                } else if by_rho == 0.0 {
                    Part::Bottom
                } else if by_z == 0.0 {
                    Part::Side
                } else {
                    Part::Corner
                };
                return Some(Entry { at_mm: s, part });
            }
            let outwards = if rho > 0.0 { (l.b + l.a * s) / rho } else { 0.0 };
            let slope = by_rho * outwards + by_z * l.dz;
            if slope >= 0.0 {
                return None;
            }
            s -= distance / slope;
            if s > hi {
                return None;
            }
        }
        // Grazing to within rounding: no entry that would matter.
        None
    }

    /// Monotone Newton from the entry into the circumscribed cylinder.
    fn corner_entry(&self, l: &LocalLine, lo: f64, hi: f64) -> Option<Entry> {
        let mut s = lo;
        let tol = 4.0 * f64::EPSILON * (self.radius + l.wz.abs() + l.c.sqrt());
        for _ in 0..MAX_CORNER_STEPS {
            let (rho, z) = (l.rho(s), l.z(s));
            let (x, y) = (rho - self.core_mm(), self.corner - z);
            if x <= 0.0 || y <= 0.0 {
                // Newton stepped over the edge of the corner: the boundary met is the plane or the side.
                let part = if x <= 0.0 { Part::Bottom } else { Part::Side };
                let f = x.max(y) - self.corner;
                if f <= tol {
                    return Some(Entry { at_mm: s, part });
                }
                let slope = if x <= 0.0 { -l.dz } else { (l.b + l.a * s) / rho };
                if slope >= 0.0 {
                    return None;
                }
                s -= f / slope;
            } else {
                // Both are of the size of the corner: no need of hypot's care.
                let r = (x * x + y * y).sqrt();
                let f = r - self.corner;
                if f <= tol {
                    return Some(Entry { at_mm: s, part: Part::Corner });
                }
                let slope = (x * (l.b + l.a * s) / rho - y * l.dz) / r;
                if slope >= 0.0 {
                    return None;
                }
                s -= f / slope;
            }
            if s > hi {
                return None;
            }
        }
        // Grazing to within rounding: no entry that would matter.
        None
    }
}

#[cfg(test)]
mod tests;
