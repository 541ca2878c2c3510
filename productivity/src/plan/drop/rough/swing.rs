//! Ways from one axis to another: over a sphere around everything, the tool pointing outward.

use crate::plan::Linked;
use osculate_geom::{Box3, Point3, Unit3};
use osculate_tools::Pose;
use osculate_tools::cl::Motion;

/// Largest swing of the axis in one piece, rad.
const STEP: f64 = 0.1;

/// A sphere around everything that the tool must stay clear of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    centre: Point3,
    radius_mm: f64,
}

impl Sphere {
    pub fn around(b: &Box3, clearance_mm: f64) -> Self {
        Self { centre: b.centre(), radius_mm: 0.5 * b.diagonal_mm() + clearance_mm }
    }

    /// The pose on the axis of another whose tip is on the plane that touches the sphere there, never below that other.
    fn above(&self, pose: &Pose) -> Pose {
        let height = (pose.tip - self.centre).dot(&pose.axis);
        pose.retracted((self.radius_mm - height).max(0.0))
    }

    fn pole(&self, axis: &Unit3) -> Pose {
        Pose { tip: self.centre + axis.into_inner() * self.radius_mm, axis: *axis }
    }

    /// Leads a path on to the first pose of another: up, over the sphere, and down to it.
    pub fn lead(&self, out: &mut Linked, to: &Pose) {
        let last = out.path.moves.last().map(|m| m.pose);
        let mut rapid = |pose: Pose| out.go(pose, Motion::Rapid, None);
        match last {
            None => rapid(self.pole(&to.axis)),
            Some(from) if from.axis == to.axis => rapid(self.above(&from)),
            Some(from) => {
                rapid(self.above(&from));
                rapid(self.pole(&from.axis));
                let angle = from.axis.angle(&to.axis);
                let steps = (angle / STEP).ceil() as usize;
                // Opposite axes have no single arc between them: any will do.
                let side = to.axis.into_inner() - from.axis.into_inner() * to.axis.dot(&from.axis);
                let side = Unit3::try_new(side, 1e-9)
                    .unwrap_or_else(|| osculate_geom::any_perpendicular(&from.axis));
                for k in 1..=steps {
                    let (s, c) = (angle * k as f64 / steps as f64).sin_cos();
                    let between = Unit3::new_normalize(from.axis.into_inner() * c + side.into_inner() * s);
                    rapid(self.pole(if k == steps { &to.axis } else { &between }));
                }
            }
        }
        rapid(self.above(to));
    }

    /// Leads a path out.
    pub fn leave(&self, out: &mut Linked) {
        if let Some(last) = out.path.moves.last().map(|m| m.pose) {
            out.go(self.above(&last), Motion::Rapid, None);
            out.go(self.pole(&last.axis), Motion::Rapid, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Vec3;

    /// On the way from one axis to any other no tip comes into the sphere, and every pose looks outward.
    #[test]
    fn a_swing_stays_outside() {
        let b = Box3 { min: Point3::new(-10.0, -5.0, 0.0), max: Point3::new(10.0, 5.0, 8.0) };
        let sphere = Sphere::around(&b, 3.0);
        let radius = 0.5 * b.diagonal_mm() + 3.0;
        let axes = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.0, -1.0], [-0.6, 0.8, 0.0]];
        let axes = axes.map(|a| Unit3::new_normalize(Vec3::from(a)));
        let mut out = Linked::default();
        for axis in axes {
            let tip = Point3::new(2.0, 1.0, 8.0) + axis.into_inner() * 9.0;
            sphere.lead(&mut out, &Pose { tip, axis });
        }
        sphere.leave(&mut out);
        for w in out.path.moves.windows(2) {
            for f in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let tip = w[0].pose.tip + (w[1].pose.tip - w[0].pose.tip) * f;
                let away = (tip - b.centre()).norm();
                assert!(away > radius * (0.5 * STEP).cos() - 1e-9, "{away} {radius}");
            }
            let m = &w[1];
            assert!((m.pose.tip - b.centre()).dot(&m.pose.axis) > radius - 1e-9 && m.motion == Motion::Rapid);
        }
        assert_eq!(out.path.moves.last().unwrap().pose.axis, axes[3]);
    }
}
