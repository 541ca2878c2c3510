//! A setup for a part that comes without one: faces towards the spindle, the middle of the part over the table's
//! reference point, its lowest point on it.

use crate::setup::Setup;
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::{Box3, Point3, Unit3, Vec3, any_perpendicular};

/// Up to this angle from the spindle faces are left as they stand, rad: with usual leads tables still reach them.
const STANDS: f64 = 1.75;

/// A suggested setup.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Suggestion {
    /// The setup.
    pub setup: Setup,
    /// Whether the part is turned.
    pub turned: bool,
}

/// The setup for faces with these outward normals (a sample of them) and points.
///
/// The part stays as its file has it where no normal is further than about 100 degrees from +z, or 112 where they look to
/// all sides; else it is turned so that the axis direction nearest to the mean normal points up, or the mean normal itself,
/// where that leaves none further, or else the direction that is nearest to all of them. Where nothing is better than how
/// it stands, it stays.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_postproc::suggest;
///
/// let corners = [Point3::new(0.0, 0.0, 0.0), Point3::new(40.0, 20.0, 10.0)];
/// // Faces that look up: the part stays as it is, its middle over the reference point and its foot on the table.
/// let upright = suggest(&[Vec3::z_axis()], &corners, 0.0);
/// assert!(!upright.turned);
/// assert_eq!(upright.setup.part_zero.translation.vector, Vec3::new(-20.0, -10.0, 0.0));
/// // Faces that look down: it is turned over.
/// let over = suggest(&[-Vec3::z_axis()], &corners, 0.0);
/// assert!(over.turned);
/// assert!(((over.setup.part_zero.rotation * -Vec3::z_axis()).z - 1.0).abs() < 1e-12);
/// ```
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

/// A mean normal shorter than this points nowhere: the faces look to all sides, and then up to this angle tables reach them, rad.
const ALL_ROUND: f64 = 0.2;
const REACHES: f64 = 1.95;

/// Directions all over the sphere that are tried, and how often the search around the best of them narrows.
const DIRECTIONS: u32 = 400;
const NARROWINGS: u32 = 40;

/// About the direction from which the furthest of some others is least far, even where they go more than half around: along
/// the pole of a belt of normals, as blades stand.
fn nearest_to_all(normals: &[Unit3]) -> Vec3 {
    // How far down the lowest one is, seen along a direction.
    let least = |up: &Vec3| normals.iter().map(|n| n.dot(up)).fold(f64::INFINITY, f64::min);
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let spread = (0..DIRECTIONS).map(|k| {
        let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(DIRECTIONS);
        let (s, c) = (golden * f64::from(k)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * c, r * s, z)
    });
    let mut best = (f64::NEG_INFINITY, Vec3::z());
    for up in spread {
        let value = least(&up);
        if value > best.0 {
            best = (value, up);
        }
    }
    let mut step = 0.1;
    for _ in 0..NARROWINGS {
        let up = Unit3::new_normalize(best.1);
        let (e, f) = any_frame(&up);
        let around = (0..8).map(|k| {
            let (s, c) = (std::f64::consts::FRAC_PI_4 * f64::from(k)).sin_cos();
            (best.1 + (e * c + f * s) * step).normalize()
        });
        let (value, next) = around
            .map(|d| (least(&d), d))
            .fold((f64::NEG_INFINITY, best.1), |a, b| if b.0 > a.0 { b } else { a });
        if value > best.0 {
            best = (value, next);
        } else {
            step *= 0.5;
        }
    }
    best.1
}

/// Two directions across one.
fn any_frame(up: &Unit3) -> (Vec3, Vec3) {
    let e = any_perpendicular(up).into_inner();
    (e, up.cross(&e))
}

/// The angle between a direction and the normal that is furthest from it.
fn lowest(normals: &[Unit3], up: &Vec3) -> f64 {
    normals.iter().map(|n| n.angle(up)).fold(0.0, f64::max)
}

fn mean(normals: &[Unit3]) -> Vec3 {
    normals.iter().map(|n| n.into_inner()).sum::<Vec3>() / normals.len().max(1) as f64
}

/// Whether a part with these normals stays as it stands.
pub(crate) fn stands(normals: &[Unit3]) -> bool {
    let all_round = mean(normals).norm() < ALL_ROUND;
    lowest(normals, &Vec3::z()) <= if all_round { REACHES } else { STANDS }
}

/// How a part is turned for its normals.
pub(crate) fn turn(normals: &[Unit3]) -> UnitQuaternion<f64> {
    if stands(normals) {
        return UnitQuaternion::identity();
    }
    let lowest = |up: &Vec3| lowest(normals, up);
    let (mean, stands) = (mean(normals), lowest(&Vec3::z()));
    let main = mean.iamax();
    let mut axis = Vec3::zeros();
    axis[main] = mean[main].signum();
    let mean = mean.try_normalize(ALL_ROUND).unwrap_or(axis);
    let up = if lowest(&axis) <= STANDS {
        axis
    } else if lowest(&mean) <= STANDS {
        mean
    } else {
        nearest_to_all(normals)
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
        // Three quarters around, as the normals of a blade that lies on its side: it stands up.
        let lies: Vec<Unit3> = (0..=90)
            .map(|k| {
                let (s, c) = (f64::from(3 * k - 45).to_radians()).sin_cos();
                unit(0.1, c, -s)
            })
            .collect();
        let s = suggest(&lies, &points, 50.0);
        let height = |n: &Unit3| (s.setup.part_zero.rotation * n.into_inner()).z;
        let least = lies.iter().map(height).fold(1.0, f64::min);
        assert!(s.turned && least > -0.01, "{least}");
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
