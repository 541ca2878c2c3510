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

    /// Signed distance of a local point to the cutter, negative inside. Exact but for points above the top end,
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

    /// Signed distance of a point to the cutter in a pose, see [`Cutter::local_distance`].
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
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cutter(d: f64, r: f64) -> Cutter {
        Cutter::new(d, r, 60.0).unwrap()
    }

    #[test]
    fn refuses_impossible_cutters() {
        assert!(matches!(Cutter::new(-1.0, 0.0, 10.0), Err(CutterError::Size { .. })));
        assert!(matches!(Cutter::new(f64::NAN, 0.0, 10.0), Err(CutterError::Size { .. })));
        assert!(matches!(Cutter::new(10.0, 5.1, 10.0), Err(CutterError::Corner { .. })));
        assert!(matches!(Cutter::new(10.0, -0.1, 10.0), Err(CutterError::Corner { .. })));
        assert!(matches!(Cutter::new(10.0, f64::NAN, 10.0), Err(CutterError::Corner { .. })));
        assert!(matches!(Cutter::new(10.0, 5.0, 4.0), Err(CutterError::Length { .. })));
    }

    #[test]
    fn closed_forms() {
        let upright = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
        let up = |x: f64| Line { origin: Point3::new(x, 0.0, -3.0), direction: Vec3::z_axis() };
        // Straight up below the flat, the corner and outside.
        let t = cutter(20.0, 2.0);
        assert_eq!(t.entry(&upright, &up(7.0)).unwrap().at_mm, 3.0);
        let corner = t.entry(&upright, &up(9.0)).unwrap();
        assert!((corner.at_mm - (3.0 + 2.0 - 3f64.sqrt())).abs() < 1e-14, "{corner:?}");
        assert!(t.entry(&upright, &up(10.01)).is_none());
        // A ball: 2 - sqrt(4 - x^2).
        let b = cutter(4.0, 2.0);
        let e = b.entry(&upright, &up(1.2)).unwrap().at_mm;
        assert!((e - (3.0 + 2.0 - (4f64 - 1.44).sqrt())).abs() < 1e-14);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        /// Wherever a line enters, the distance is zero, negative just behind and positive before; where it misses,
        /// no sampled point of the line is inside.
        #[test]
        fn entry_is_the_first_zero_of_the_distance(
            kind in 0usize..5, r in 0.0..=1.0f64, o in prop::array::uniform3(-30.0..30.0f64), d in prop::array::uniform3(-1.0..1.0f64),
            a in prop::array::uniform3(-1.0..1.0f64)
        ) {
            let c = if kind == 0 { cutter(20.0, 10.0 * r) } else { crate::make::tests::shaped()[kind - 1] };
            let (Some(direction), Some(axis)) = (Unit3::try_new(Vec3::from(d), 0.1), Unit3::try_new(Vec3::from(a), 0.1))
            else { return Ok(()) };
            let pose = Pose { tip: Point3::new(0.3, -0.2, 0.1), axis };
            let line = Line { origin: Point3::from(o), direction };
            match c.entry(&pose, &line) {
                Some(e) => {
                    prop_assert!(c.distance(&pose, &line.point(e.at_mm)).abs() < 1e-9);
                    prop_assert!(c.distance(&pose, &line.point(e.at_mm - 0.5)) > 0.0);
                    prop_assert!(e.at_mm > Cutter::least_entry_mm(&pose, &line) - 1e-9);
                    prop_assert!(!c.enters_above(&pose, &line, e.at_mm + 1e-6));
                    // The body of this question has no top.
                    if kind == 0 && e.part != Part::Top {
                        prop_assert!(c.enters_above(&pose, &line, e.at_mm - 1e-3));
                    }
                    // The normal points against the line.
                    let n = c.normal_at(&pose, &line.point(e.at_mm), e.part);
                    prop_assert!(n.dot(&direction) <= 1e-6, "{n:?}");
                }
                None => {
                    for k in -400..400 {
                        // A grazing line within rounding of the boundary counts as a miss.
                        prop_assert!(c.distance(&pose, &line.point(0.3 * f64::from(k))) > -1e-9);
                    }
                }
            }
        }
    }
}
