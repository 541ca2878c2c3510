//! Tool poses: tip and axis.

use osculate_geom::{Point3, Unit3};

/// Where a tool is: the tip (lowest point on its axis) and the unit axis from the tip towards the spindle, in the
/// part's frame. Rotation about the axis does not matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Tool tip, mm.
    pub tip: Point3,
    /// Tool axis, from tip to spindle.
    pub axis: Unit3,
}

impl Pose {
    /// The pose with the tip moved by `distance_mm` along the axis.
    ///
    /// ```
    /// use osculate_geom::{Point3, Unit3, Vec3};
    /// use osculate_tools::Pose;
    /// let pose = Pose { tip: Point3::origin(), axis: Unit3::new_normalize(Vec3::new(3.0, 0.0, 4.0)) };
    /// let away = pose.retracted(10.0);
    /// assert!((away.tip - Point3::new(6.0, 0.0, 8.0)).norm() < 1e-12 && away.axis == pose.axis);
    /// ```
    #[must_use]
    pub fn retracted(&self, distance_mm: f64) -> Self {
        Self { tip: self.tip + self.axis.into_inner() * distance_mm, axis: self.axis }
    }
}
