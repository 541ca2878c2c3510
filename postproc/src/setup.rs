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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// From the part's frame to the frame of the table's reference point, all rotary joints at zero; mm.
    pub part_zero: Isometry3<f64>,
    /// From the tip of the tool to the gauge point, mm. Matters where a head turns the tool.
    pub gauge_length_mm: f64,
}

/// Why a setup is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
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

impl Setup {
    /// Part origin at this place from the table's reference point, no rotation.
    #[must_use]
    pub fn at(part_zero_mm: Vec3, gauge_length_mm: f64) -> Self {
        let part_zero = Isometry3::from_parts(Translation3::from(part_zero_mm), UnitQuaternion::identity());
        Self { part_zero, gauge_length_mm }
    }

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
