//! Where the axis of a cutter lies, how far points are from it, and how it moves along a strip.

use osculate_geom::{Point3, Unit3, Vec3};

/// A straight line with a sense: the axis of a cutter, from the tip to the spindle.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_tools::flank::AxisLine;
/// let axis = AxisLine { point: Point3::new(0.0, 0.0, 10.0), direction: Vec3::z_axis() };
/// let p = Point3::new(3.0, 4.0, 25.0);
/// assert_eq!((axis.along_mm(&p), axis.distance_mm(&p)), (15.0, 5.0));
/// assert_eq!(axis.at(axis.along_mm(&p)) + axis.across(&p), p);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLine {
    /// A point of it, mm.
    pub point: Point3,
    /// Its direction.
    pub direction: Unit3,
}

impl AxisLine {
    /// How far along the line from its point the foot of `p` lies, mm.
    #[must_use]
    pub fn along_mm(&self, p: &Point3) -> f64 {
        (p - self.point).dot(&self.direction)
    }

    /// From the foot of `p` on the line to `p`, mm: perpendicular to the direction.
    #[must_use]
    pub fn across(&self, p: &Point3) -> Vec3 {
        let w = p - self.point;
        w - self.direction.into_inner() * w.dot(&self.direction)
    }

    /// Distance of `p` from the line, mm.
    #[must_use]
    pub fn distance_mm(&self, p: &Point3) -> f64 {
        // A cross product with a unit vector keeps the digits that a difference of squares loses.
        (p - self.point).cross(&self.direction).norm()
    }

    /// The point at `along_mm` from the line's point.
    #[must_use]
    pub fn at(&self, along_mm: f64) -> Point3 {
        self.point + self.direction.into_inner() * along_mm
    }
}

/// An axis with its exact derivative by the parameter u of the strip.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct AxisJet {
    /// The parameter.
    pub u: f64,
    /// The axis there.
    pub line: AxisLine,
    /// Derivative of the line's point by u, mm. The part along the axis is a matter of which point is named.
    pub point_rate: Vec3,
    /// Derivative of the direction by u: perpendicular to it.
    pub direction_rate: Vec3,
}

impl AxisJet {
    /// The axis through `point(u)` along `direction(u)`, which need not be of unit length: both with their derivatives.
    ///
    /// None where the direction vanishes or anything is not finite.
    #[must_use]
    pub fn of(u: f64, point: (Point3, Vec3), direction: (Vec3, Vec3)) -> Option<Self> {
        let length = direction.0.norm();
        let finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
        if !(length > 0.0 && finite(&point.0.coords) && finite(&point.1) && finite(&direction.1)) {
            return None;
        }
        let d = direction.0 / length;
        let turn = direction.1 / length;
        Some(Self {
            u,
            line: AxisLine { point: point.0, direction: Unit3::new_unchecked(d) },
            point_rate: point.1,
            direction_rate: turn - d * d.dot(&turn),
        })
    }

    /// Rate by u of the distance between the axis and a point that stays, mm.
    ///
    /// NaN for a point on the axis.
    #[must_use]
    pub fn distance_rate_mm(&self, p: &Point3) -> f64 {
        // The foot moves along the axis without consequence: d/du |w_perp| = -w_perp . (A' + s d') / |w_perp|.
        let across = self.line.across(p);
        let moved = self.point_rate + self.direction_rate * self.line.along_mm(p);
        -across.dot(&moved) / across.norm()
    }
}
