//! Passes of one of several equal places, carried over to all of them by rigid motions.
//!
//! A motion keeps lengths and angles: what a pass leaves at the place that it was planned for, its image leaves at the other. The surface
//! parameters of its points stay those of the face that was planned.

use super::{CcPoint, Pass, Stretches};
use nalgebra::Isometry3;
use osculate_geom::Unit3;
use osculate_tools::Pose;

/// The images of passes under each of the motions, in the order of the motions and within each in that of the passes.
///
/// ```
/// use osculate_geom::{Point3, Vec3, nalgebra::Isometry3, uv};
/// use osculate_productivity::plan::{CcPoint, Pass, Stretches, repeated};
/// use osculate_tools::Pose;
///
/// let at = |x: f64| {
///     let point = Point3::new(x, 0.0, 0.0);
///     CcPoint { uv: uv(x, 0.0), point, normal: Vec3::z_axis(), pose: Pose { tip: point, axis: Vec3::z_axis() }, width_mm: 1.0 }
/// };
/// let one = Stretches::from(vec![Pass { points: vec![at(0.0), at(5.0)], closed: false }]);
/// // The same pocket again, 30 mm on along y.
/// let both = repeated(&one, &[Isometry3::identity(), Isometry3::translation(0.0, 30.0, 0.0)]);
/// assert_eq!(both.passes.len(), 2);
/// assert_eq!(both.passes[1].points[1].pose.tip, Point3::new(5.0, 30.0, 0.0));
/// ```
#[must_use]
pub fn repeated(stretches: &Stretches, motions: &[Isometry3<f64>]) -> Stretches {
    let image = |motion| Stretches {
        passes: stretches
            .passes
            .iter()
            .map(|pass| Pass { points: moved(&pass.points, motion), closed: pass.closed })
            .collect(),
        skipped: stretches.skipped.iter().map(|way| moved(way, motion)).collect(),
    };
    motions.iter().map(image).collect()
}

fn moved(points: &[CcPoint], motion: &Isometry3<f64>) -> Vec<CcPoint> {
    // A turn keeps unit vectors but for rounding, which is not to grow.
    let direction = |d: &Unit3| Unit3::new_normalize(motion * d.into_inner());
    let point = |c: &CcPoint| CcPoint {
        point: motion * c.point,
        normal: direction(&c.normal),
        pose: Pose { tip: motion * c.pose.tip, axis: direction(&c.pose.axis) },
        ..*c
    };
    points.iter().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Point3, TurnAxis, Vec3, uv};
    use proptest::prelude::*;

    proptest! {
        /// Distances between contacts and tips, and angles between normals and axes, are those of the pass that was planned.
        #[test]
        fn a_turned_pass_is_the_same_pass(
            at in prop::array::uniform3(-50.0..50.0f64),
            axis in prop::array::uniform3(-1.0..1.0f64),
            points in proptest::collection::vec(prop::array::uniform3(-80.0..80.0f64), 2..6),
            count in 2usize..9,
        ) {
            prop_assume!(Vec3::from(axis).norm() > 0.1);
            let about = TurnAxis { origin: Point3::from(at), direction: Unit3::new_normalize(Vec3::from(axis)) };
            let own = |p: &[f64; 3]| {
                let (normal, axis) = (Unit3::new_normalize(Vec3::new(p[0], 1.0, 0.5)), Unit3::new_normalize(Vec3::new(0.3, p[1], 1.0)));
                let pose = Pose { tip: Point3::new(p[0], p[1] + 1.0, p[2]), axis };
                CcPoint { uv: uv(0.0, 0.0), point: Point3::from(*p), normal, pose, width_mm: 0.5 }
            };
            let pass = Pass { points: points.iter().map(own).collect(), closed: false };
            let turns: Vec<_> =
                (0..count).map(|k| about.turn(std::f64::consts::TAU * k as f64 / count as f64)).collect();
            let way = pass.points.clone();
            let one = |pass: &Pass| Stretches { passes: vec![pass.clone()], skipped: vec![way.clone()] };
            let Stretches { passes: all, skipped } = repeated(&one(&pass), &turns);
            prop_assert_eq!((all.len(), skipped.len()), (count, count));
            prop_assert!(all.iter().zip(&skipped).all(|(p, way)| p.points == *way));
            for image in &all {
                for (a, b) in pass.points.iter().zip(&image.points) {
                    let off = (a.pose.tip - a.point).norm() - (b.pose.tip - b.point).norm();
                    prop_assert!(off.abs() < 1e-12 * 200.0);
                    prop_assert!((a.normal.dot(&a.pose.axis) - b.normal.dot(&b.pose.axis)).abs() < 1e-12);
                    let far = |c: &CcPoint| (c.point - about.origin).cross(&about.direction).norm();
                    prop_assert!((far(a) - far(b)).abs() < 1e-11 * 200.0);
                }
            }
            // The last turn goes on to the first pass again.
            let on = repeated(&one(&all[count - 1]), &turns[1..2]);
            for (a, b) in pass.points.iter().zip(&on.passes[0].points) {
                prop_assert!((a.point - b.point).norm() < 1e-11 * 200.0);
            }
        }
    }
}
