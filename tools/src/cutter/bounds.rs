//! Bounds of the height at which a line enters a cutter, at a fraction of what the entry itself costs.

use super::{Cutter, Line, LocalLine};
use crate::pose::Pose;

impl Cutter {
    /// A height that a line does not enter the cutter below, by the plane of the tip alone: a fraction of what the entry costs.
    /// -infinity where the line does not rise along the axis.
    #[must_use]
    pub(crate) fn least_entry_mm(pose: &Pose, line: &Line) -> f64 {
        let rise = line.direction.dot(&pose.axis);
        if rise > 0.0 { (pose.tip - line.origin).dot(&pose.axis) / rise } else { f64::NEG_INFINITY }
    }

    /// Whether a line surely enters the cutter above a height, or nowhere: at a fraction of what the entry costs, and for ball, flat and
    /// toroidal ends alone. The distance to a convex body is convex along a line: where it is positive and falls the entry is yet to come.
    #[must_use]
    pub(crate) fn enters_above(&self, pose: &Pose, line: &Line, height_mm: f64) -> bool {
        if self.meridian.is_some() || !height_mm.is_finite() {
            return false;
        }
        let l = LocalLine::new(line, pose);
        let rho = l.rho(height_mm);
        let (x, y) = (rho - self.core_mm(), self.corner - l.z(height_mm));
        // How fast the line leaves the axis.
        let outwards = if rho > 0.0 { (l.b + l.a * height_mm) / rho } else { 0.0 };
        if x > 0.0 && y > 0.0 {
            x * x + y * y > self.corner * self.corner && x * outwards < y * l.dz
        } else if x > y {
            x > self.corner && outwards < 0.0
        } else {
            y > self.corner && l.dz > 0.0
        }
    }
}
