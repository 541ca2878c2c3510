//! Productivity at the three levels of R97: instantaneous, regional and global.
//!
//! Finishing is measured in area of the part per minute. At an instant it is the feed times the strip width,
//! `E = |S_L x S_C|` per minute [R97, eqs. 1, 2, the product being the cross product]; regionally its mean along one pass; globally
//! the face's area over the whole time, overlaps, links and air included.

use crate::plan::Pass;

/// Productivity of a plan, mm2/min.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Levels {
    /// Least instantaneous productivity on any pass.
    pub instantaneous_min: f64,
    /// Greatest instantaneous productivity on any pass.
    pub instantaneous_max: f64,
    /// Mean along each pass, in the order of the passes.
    pub regional: Vec<f64>,
    /// Area over total time.
    pub global: f64,
}

/// Area and time of a whole plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals {
    /// Area machined, mm2.
    pub area_mm2: f64,
    /// Machining time, links and air included, min.
    pub time_min: f64,
}

/// Productivity of passes cut at a tip feed of `feed_mm_min`.
///
/// Places without a computed strip width count neither way.
///
/// ```
/// use osculate_geom::{Point3, Vec3, uv};
/// use osculate_productivity::{levels::{Totals, levels}, plan::{CcPoint, Pass}};
/// use osculate_tools::Pose;
///
/// // One pass of 50 mm with a strip of 2 mm, at 1000 mm a minute.
/// let at = |x: f64| {
///     let point = Point3::new(x, 0.0, 0.0);
///     CcPoint { uv: uv(x, 0.0), point, normal: Vec3::z_axis(), pose: Pose { tip: point, axis: Vec3::z_axis() }, width_mm: 2.0 }
/// };
/// let pass = Pass { points: vec![at(0.0), at(50.0)], closed: false };
/// // It takes 0.05 min, and as much again is spent in the air.
/// let found = levels(&[pass], 1000.0, Totals { area_mm2: 100.0, time_min: 0.1 });
/// assert!((found.instantaneous_max - 2000.0).abs() < 1e-9 && (found.regional[0] - 2000.0).abs() < 1e-9);
/// assert!((found.global - 1000.0).abs() < 1e-9);
/// ```
#[must_use]
pub fn levels(passes: &[Pass], feed_mm_min: f64, totals: Totals) -> Levels {
    let (mut least, mut greatest) = (f64::INFINITY, 0.0f64);
    let mut regional = Vec::with_capacity(passes.len());
    for pass in passes {
        let (mut area, mut length) = (0.0, 0.0);
        for w in pass.points.windows(2) {
            let step = (w[1].point - w[0].point).norm();
            let width = 0.5 * (w[0].width_mm + w[1].width_mm);
            if width.is_finite() {
                area += width * step;
                length += step;
                least = least.min(width * feed_mm_min);
                greatest = greatest.max(width * feed_mm_min);
            }
        }
        regional.push(if length > 0.0 { feed_mm_min * area / length } else { 0.0 });
    }
    Levels {
        instantaneous_min: if least.is_finite() { least } else { 0.0 },
        instantaneous_max: greatest,
        regional,
        global: if totals.time_min > 0.0 { totals.area_mm2 / totals.time_min } else { 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::CcPoint;
    use osculate_geom::{Point3, Vec3, uv};
    use osculate_tools::Pose;

    fn at(x: f64, width_mm: f64) -> CcPoint {
        let point = Point3::new(x, 0.0, 0.0);
        let pose = Pose { tip: point, axis: Vec3::z_axis() };
        CcPoint { uv: uv(x, 0.0), point, normal: Vec3::z_axis(), pose, width_mm }
    }

    #[test]
    fn means_are_weighted_by_length() {
        // 1 mm at width 1 and 3 mm at width 2, with the trapezoid between: (1 + 3 * 2) / 4 less the joint.
        let pass =
            Pass { points: vec![at(0.0, 1.0), at(1.0, 1.0), at(1.0, 2.0), at(4.0, 2.0)], closed: false };
        let l = levels(&[pass], 100.0, Totals { area_mm2: 50.0, time_min: 2.0 });
        assert!((l.regional[0] - 100.0 * 7.0 / 4.0).abs() < 1e-12);
        assert_eq!((l.instantaneous_min, l.instantaneous_max, l.global), (100.0, 200.0, 25.0));
    }
}
