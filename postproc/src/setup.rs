//! Where the part sits on the machine and how long the tool is.
//!
//! Program zero (G54, or the preset of the control):
//! - with tool-centre-point control it lies at the part's origin; programmed X Y Z are the tip in the part's frame,
//!   turned by the rotation of [`Setup::part_zero`], so that they run along the machine's axes at zero rotation;
//! - without, it lies at the table's reference point; programmed X Y Z are the joints themselves and contain the
//!   place of the part.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::Pose;

/// Part and tool on the machine.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_postproc::Setup;
/// use osculate_tools::Pose;
///
/// // The part's origin is 100 mm along X and 20 mm above the table's reference point; the tool is 150 mm long.
/// let setup = Setup::at(Vec3::new(100.0, 0.0, 20.0), 150.0);
/// let pose = Pose { tip: Point3::new(1.0, 2.0, 3.0), axis: Vec3::z_axis() };
/// let on_table = setup.to_table(&pose);
/// assert_eq!(on_table.tip, Point3::new(101.0, 2.0, 23.0));
/// // And back.
/// assert_eq!(setup.to_part(&on_table), pose);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// From the part's frame to the frame of the table's reference point, all rotary joints at zero; mm.
    pub part_zero: Isometry3<f64>,
    /// From the tip of the tool to the gauge point, mm. Matters where a head turns the tool.
    pub gauge_length_mm: f64,
}

/// Why a setup is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetupError {
    /// NaN or infinite.
    #[error(
        "the setup has a number that is not finite (part zero {x_mm}, {y_mm}, {z_mm}; gauge length {gauge_length_mm})"
    )]
    NotFinite {
        /// Part zero.
        x_mm: f64,
        /// Part zero.
        y_mm: f64,
        /// Part zero.
        z_mm: f64,
        /// Gauge length.
        gauge_length_mm: f64,
    },
    /// A tool cannot reach into the spindle.
    #[error(
        "the gauge length is {gauge_length_mm} mm: give the length from the tip to the spindle nose, zero or more"
    )]
    GaugeLength {
        /// What was given.
        gauge_length_mm: f64,
    },
}

/// A cosine below which a turn about y counts as a quarter of one: above it the other two turns are known to 1e-16 over it.
const QUARTER_COSINE: f64 = 1e-8;

impl Setup {
    /// Part origin at this place from the table's reference point, no rotation.
    #[must_use]
    pub fn at(part_zero_mm: Vec3, gauge_length_mm: f64) -> Self {
        let part_zero = Isometry3::from_parts(Translation3::from(part_zero_mm), UnitQuaternion::identity());
        Self { part_zero, gauge_length_mm }
    }

    /// The turn of the part about x, then y, then z of the machine, rad, the one about y from -pi/2 to pi/2; where that is a quarter of a
    /// turn, which leaves only the sum of the others, the one about x is zero.
    ///
    /// ```
    /// use osculate_geom::{Vec3, nalgebra::UnitQuaternion};
    /// use osculate_postproc::Setup;
    /// use std::f64::consts::FRAC_PI_2;
    ///
    /// let mut setup = Setup::default();
    /// setup.part_zero.rotation = UnitQuaternion::from_axis_angle(&Vec3::z_axis(), FRAC_PI_2);
    /// let [x, y, z] = setup.turn_rad();
    /// assert!(x.abs() < 1e-12 && y.abs() < 1e-12 && (z - FRAC_PI_2).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn turn_rad(&self) -> [f64; 3] {
        let rotation = self.part_zero.rotation.to_rotation_matrix();
        let m = rotation.matrix();
        let about_y = (-m[(2, 0)]).atan2(m[(0, 0)].hypot(m[(1, 0)]));
        if m[(0, 0)].hypot(m[(1, 0)]) < QUARTER_COSINE {
            return [0.0, about_y, (-m[(0, 1)]).atan2(m[(1, 1)])];
        }
        [m[(2, 1)].atan2(m[(2, 2)]), about_y, m[(1, 0)].atan2(m[(0, 0)])]
    }

    /// Whether its numbers can be used; whatever takes a setup asks this first.
    ///
    /// ```
    /// use osculate_geom::Vec3;
    /// use osculate_postproc::{Setup, SetupError};
    ///
    /// assert_eq!(Setup::default().check(), Ok(()));
    /// let inside = Setup::at(Vec3::zeros(), -5.0);
    /// assert_eq!(inside.check(), Err(SetupError::GaugeLength { gauge_length_mm: -5.0 }));
    /// ```
    ///
    /// # Errors
    /// Where a number is not finite or the gauge length is negative.
    pub fn check(&self) -> Result<(), SetupError> {
        let t = self.part_zero.translation.vector;
        let q = self.part_zero.rotation.coords;
        let gauge_length_mm = self.gauge_length_mm;
        if !(t.iter().chain(q.iter()).all(|c| c.is_finite()) && gauge_length_mm.is_finite()) {
            return Err(SetupError::NotFinite { x_mm: t.x, y_mm: t.y, z_mm: t.z, gauge_length_mm });
        }
        if gauge_length_mm < 0.0 {
            return Err(SetupError::GaugeLength { gauge_length_mm });
        }
        Ok(())
    }

    /// A pose of the part's frame in the table's.
    #[must_use]
    pub fn to_table(&self, pose: &Pose) -> Pose {
        Pose { tip: self.part_zero * pose.tip, axis: self.part_zero.rotation * pose.axis }
    }

    /// A pose of the table's frame in the part's.
    #[must_use]
    pub fn to_part(&self, pose: &Pose) -> Pose {
        let back = self.part_zero.rotation.inverse();
        Pose {
            tip: self.part_zero.inverse_transform_point(&pose.tip),
            axis: Unit3::new_normalize(back * pose.axis.into_inner()),
        }
    }

    /// Programmed X Y Z with tool-centre-point control, for a tip in the part's frame.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3, nalgebra::UnitQuaternion};
    /// use osculate_postproc::Setup;
    ///
    /// // Turned by a quarter about Z the part's x lies along the machine's Y; where the part stands is in the work offset.
    /// let mut setup = Setup::at(Vec3::new(300.0, 200.0, 50.0), 0.0);
    /// setup.part_zero.rotation = UnitQuaternion::from_axis_angle(&Vec3::z_axis(), std::f64::consts::FRAC_PI_2);
    /// let xyz = setup.to_program(&Point3::new(7.0, 0.0, 0.0));
    /// assert!((xyz - Vec3::new(0.0, 7.0, 0.0)).norm() < 1e-12);
    /// assert!((setup.from_program(&xyz) - Point3::new(7.0, 0.0, 0.0)).norm() < 1e-12);
    /// ```
    #[must_use]
    pub fn to_program(&self, tip: &Point3) -> Vec3 {
        self.part_zero.rotation * tip.coords
    }

    /// The tip in the part's frame for programmed X Y Z with tool-centre-point control.
    #[must_use]
    pub fn from_program(&self, xyz: &Vec3) -> Point3 {
        Point3::from(self.part_zero.rotation.inverse() * xyz)
    }
}

impl Default for Setup {
    /// Part origin at the table's reference point, gauge length zero.
    fn default() -> Self {
        Self::at(Vec3::zeros(), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Made again of its three turns a rotation is the same, quarters about y included.
    #[test]
    fn three_turns_make_the_rotation() {
        let about = |axis: Vec3, angle_rad: f64| UnitQuaternion::from_scaled_axis(axis * angle_rad);
        let made = |[x, y, z]: [f64; 3]| about(Vec3::z(), z) * about(Vec3::y(), y) * about(Vec3::x(), x);
        let quarter = std::f64::consts::FRAC_PI_2;
        for y in [-quarter, -0.3, 0.0, 1.2, quarter] {
            for (x, z) in [(0.0, 0.0), (quarter, 0.4), (3.0, -2.0), (-quarter, quarter), (0.1, 3.1)] {
                let mut setup = Setup::default();
                setup.part_zero.rotation = made([x, y, z]);
                let again = made(setup.turn_rad());
                assert!(again.angle_to(&setup.part_zero.rotation) < 1e-7, "{x} {y} {z}");
            }
        }
        let mut setup = Setup::default();
        setup.part_zero.rotation = made([0.0, -quarter, 0.0]);
        assert!(setup.turn_rad().iter().zip([0.0, -quarter, 0.0]).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
