//! A setup for a part that comes without one: faces towards the spindle, the middle of the part over the table's
//! reference point, its lowest point on it.

use crate::setup::Setup;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::{Box3, Point3, Unit3, Vec3};

/// Up to this angle from the spindle faces are left as they stand, rad: with usual leads tables still reach them.
const STANDS: f64 = 1.75;
/// A mean normal shorter than this points nowhere: the faces look to all sides.
const ALL_ROUND: f64 = 0.2;

/// A suggested setup.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suggestion {
    /// The setup.
    pub setup: Setup,
    /// Whether the part is turned.
    pub turned: bool,
}

/// The setup for faces with these outward normals (a sample of them) and points.
///
/// The part stays as its file has it where no normal is further than about 100 degrees from +z or where the normals
/// look to all sides; else it is turned so that the axis direction nearest to the mean normal points up, or where that
/// leaves a normal lower, the mean normal or the axis of the narrowest cone around all normals, whichever leaves them higher.
#[must_use]
pub fn suggest(normals: &[Unit3], points: &[Point3], gauge_length_mm: f64) -> Suggestion {
    let rotation = turn(normals);
    let mut turned = Box3::empty();
    for p in points {
        turned.add(&(rotation * p));
    }
    let zero = if turned.is_empty() {
        Vec3::zeros()
    } else {
        let middle = turned.centre();
        -Vec3::new(middle.x, middle.y, turned.min.z)
    };
    let part_zero = Isometry3::from_parts(Translation3::from(zero), rotation);
    let is_turned = rotation != UnitQuaternion::identity();
    Suggestion { setup: Setup { part_zero, gauge_length_mm }, turned: is_turned }
}

/// Steps towards the axis of the narrowest cone; what is left of the way falls with their number.
const CONE_STEPS: u32 = 400;

/// The axis of about the narrowest cone around directions that lie within a half space, from a first guess: the middle of
/// the smallest ball around their ends, by ever shorter steps towards the furthest.
fn cone_axis(normals: &[Unit3], first: Vec3) -> Vec3 {
    let mut middle = first;
    for k in 1..=CONE_STEPS {
        let away = |n: &&Unit3| (n.into_inner() - middle).norm_squared();
        let Some(far) = normals.iter().max_by(|a, b| away(a).total_cmp(&away(b))) else { break };
        middle += (far.into_inner() - middle) / f64::from(k + 1);
    }
    middle.try_normalize(1e-6).unwrap_or(first)
}

fn turn(normals: &[Unit3]) -> UnitQuaternion<f64> {
    let lowest = |up: &Vec3| normals.iter().map(|n| n.angle(up)).fold(0.0, f64::max);
    let mean: Vec3 = normals.iter().map(|n| n.into_inner()).sum::<Vec3>() / normals.len().max(1) as f64;
    let stands = lowest(&Vec3::z());
    if stands <= STANDS || mean.norm() < ALL_ROUND {
        return UnitQuaternion::identity();
    }
    let main = mean.iamax();
    let mut axis = Vec3::zeros();
    axis[main] = mean[main].signum();
    let (mean, cone) = (mean.normalize(), cone_axis(normals, mean.normalize()));
    let up = if lowest(&axis) <= STANDS {
        axis
    } else if lowest(&cone) < lowest(&mean) {
        cone
    } else {
        mean
    };
    if lowest(&up) >= stands {
        return UnitQuaternion::identity();
    }
    // Straight down there is no single shortest turn: about x it is.
    UnitQuaternion::rotation_between(&up, &Vec3::z())
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vec3::x_axis(), std::f64::consts::PI))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(x: f64, y: f64, z: f64) -> Unit3 {
        Unit3::new_normalize(Vec3::new(x, y, z))
    }

    #[test]
    fn what_looks_up_stays_and_what_looks_away_is_turned() {
        let points = [Point3::new(10.0, 20.0, 5.0), Point3::new(30.0, 40.0, 9.0)];
        let s = suggest(&[unit(0.0, 0.1, 1.0)], &points, 50.0);
        assert!(!s.turned);
        // The middle over the reference point, the lowest point on it.
        assert_eq!(s.setup.part_zero.translation.vector, Vec3::new(-20.0, -30.0, -5.0));
        for down in [unit(0.0, 0.1, -1.0), unit(0.2, -0.9, -0.6)] {
            let s = suggest(&[down], &points, 50.0);
            assert!(s.turned);
            let up = s.setup.part_zero.rotation * down.into_inner();
            assert!(up.z > 0.7, "{up:?}");
            let low = points.iter().map(|p| (s.setup.part_zero * p).z).fold(f64::INFINITY, f64::min);
            assert!(low.abs() < 1e-12);
        }
        // Many look one way, one far aside: what is up is between the two, not the mean.
        let mut skew = vec![unit(0.0, 0.0, -1.0); 40];
        skew.push(unit(1.0, 0.0, 0.5));
        let s = suggest(&skew, &points, 50.0);
        let height = |n: &Unit3| (s.setup.part_zero.rotation * n.into_inner()).z;
        let (least, half) =
            (skew.iter().map(height).fold(1.0, f64::min), (0.5 * skew[0].angle(&skew[40])).cos());
        assert!(s.turned && (least - half).abs() < 0.01, "{least} {half}");
        // All around a post: as it stands.
        let around: Vec<Unit3> = (0..12)
            .map(|k| {
                let (s, c) = (f64::from(k) * std::f64::consts::FRAC_PI_6).sin_cos();
                unit(c, s, -0.2)
            })
            .collect();
        assert!(!suggest(&around, &points, 50.0).turned);
    }
}
