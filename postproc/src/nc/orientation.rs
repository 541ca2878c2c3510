//! How a program says where the tool points: rotary joints, a direction, or a tilted plane per position.
//!
//! Tilted planes are named by three angles, and every control composes them in its own order; with x, y, z the axes of
//! the program:
//!
//! ```text
//! Sinumerik   CYCLE800, mode 57 (axis by axis, X Y Z)   R = Rx(a) Ry(b) Rz(c), about the axes as turned so far
//! Heidenhain  PLANE SPATIAL SPA SPB SPC                 R = Rz(c) Ry(b) Rx(a): A, B, C about fixed axes
//! Fanuc       G68.2 I J K (Euler angles)                R = Rz(i) Rx(j) Rz(k), about the axes as turned so far
//! ```
//!
//! The columns of R are the plane's axes, R z is the tool. Of all planes across the tool the one without a spin of its
//! own is taken (c = 0, or k = -i).
//!
//! Sources: Siemens, Sinumerik 840D sl / 828D, operating manual milling, "Swiveling - CYCLE800"; Heidenhain, TNC 620 user's
//! manual for conversational programming, "Defining the working plane with the spatial angle: PLANE SPATIAL"; Fanuc,
//! Series 30i operator's manual, "Tilted working plane indexing (G68.2)".

use nalgebra::Rotation3;
use osculate_geom::{Unit3, Vec3};

use super::{Dialect, number};

/// Where the tool points, in words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Orientation {
    /// Rotary joints.
    #[default]
    Joints,
    /// The direction of the tool: `A3= B3= C3=`, `TX TY TZ`, `I J K`. The control finds the joints.
    Vectors,
    /// A tilted plane per position (3+2): `CYCLE800`, `PLANE SPATIAL`, `G68.2`. The tool must not turn at feed.
    Planes,
}

/// Decimals of a direction's components: 6e-6 deg.
pub(super) const VECTOR_DECIMALS: usize = 7;

/// The components of a direction in counts.
pub(crate) fn vector_counts(axis: &Unit3) -> [i64; 3] {
    // A unit vector's components are far within the integers.
    #[allow(clippy::cast_possible_truncation)]
    [axis.x, axis.y, axis.z].map(|c| (c * 1e7).round() as i64)
}

/// The angles of the plane across the tool, in counts of the output.
pub(crate) fn plane_counts(dialect: Dialect, axis: &Unit3) -> [i64; 3] {
    let w = axis.into_inner();
    let angles = match dialect {
        Dialect::Sinumerik => {
            let b = w.x.clamp(-1.0, 1.0).asin();
            [(-w.y).atan2(w.z), b, 0.0]
        }
        Dialect::Heidenhain => [(-w.y).clamp(-1.0, 1.0).asin(), w.x.atan2(w.z), 0.0],
        Dialect::Fanuc | Dialect::LinuxCnc => {
            let tilt = w.x.hypot(w.y).atan2(w.z);
            let round = if w.x.hypot(w.y) > 0.0 { w.x.atan2(-w.y) } else { 0.0 };
            [round, tilt, -round]
        }
    };
    angles.map(|a| number::counts(a.to_degrees()).unwrap_or_default())
}

/// The plane that the angles name, deg.
pub(crate) fn plane(dialect: Dialect, angles_deg: [f64; 3]) -> Rotation3<f64> {
    let [a, b, c] = angles_deg.map(f64::to_radians);
    let (x, y, z) = (Vec3::x_axis(), Vec3::y_axis(), Vec3::z_axis());
    let turn = |axis: &Unit3, angle: f64| Rotation3::from_axis_angle(axis, angle);
    match dialect {
        Dialect::Sinumerik => turn(&x, a) * turn(&y, b) * turn(&z, c),
        Dialect::Heidenhain => turn(&z, c) * turn(&y, b) * turn(&x, a),
        Dialect::Fanuc | Dialect::LinuxCnc => turn(&z, a) * turn(&x, b) * turn(&z, c),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The plane's third axis is the tool, to the rounding of the angles.
        #[test]
        fn planes_lie_across_the_tool(v in prop::array::uniform3(-1.0..1.0f64), which in 0..3usize) {
            let dialect = [Dialect::Sinumerik, Dialect::Heidenhain, Dialect::Fanuc][which];
            let Some(axis) = Unit3::try_new(Vec3::from(v), 0.1) else { return Ok(()) };
            let counts = plane_counts(dialect, &axis);
            let got = plane(dialect, counts.map(number::value)) * Vec3::z();
            prop_assert!((got - axis.into_inner()).norm() < 2e-6, "{counts:?}");
        }
    }

    /// The manual's own example: SPA+45 SPB+0 SPC+90 is A+45 about the fixed X, then C+90 about the fixed Z.
    #[test]
    fn spatial_angles_of_the_manual() {
        let got = plane(Dialect::Heidenhain, [45.0, 0.0, 90.0]) * Vec3::z();
        let h = 0.5f64.sqrt();
        assert!((got - Vec3::new(h, 0.0, h)).norm() < 1e-12, "{got}");
    }
}
