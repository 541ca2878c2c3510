//! Surfaces with closed forms: plane, cylinder, cone, sphere, torus, ellipsoid and paraboloid; lines and conics.
//!
//! Each is built in a local frame; [`Placed`] puts it anywhere. The natural normal `S_u x S_v` of every closed
//! kind points away from the axis or centre, so material inside is [`Side::Along`](crate::Side::Along).
//!
//! ```
//! use osculate_geom::analytic::{Cylinder, Placed, Placement};
//! use osculate_geom::{Interval, Point3, Surface, Vec3, uv};
//! // A shaft of radius 25 mm whose axis runs along x instead of z, from x = 100 on; its angle begins at +z.
//! let placement = Placement::new(Point3::new(100.0, 0.0, 0.0), Vec3::x_axis(), Some(Vec3::z()));
//! let shaft = Placed { surface: Cylinder::new(25.0, Interval::new(0.0, 80.0))?, placement };
//! assert!((shaft.point(uv(0.0, 30.0)) - Point3::new(130.0, 0.0, 25.0)).norm() < 1e-12);
//! // Moving a surface does not bend it.
//! assert!((shaft.jet2(uv(0.7, 30.0)).forms()?.principal().k_max - 1.0 / 25.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod conic;
mod placed;
mod quadric;
mod round;

pub use conic::{Conic, ConicKind, Line};
pub use placed::{Placed, Placement};
pub use quadric::{Ellipsoid, Paraboloid};
pub(crate) use round::angle_breaks;
pub use round::{Cone, Cylinder, Plane, Sphere, Spindle, Torus};

/// A size that makes no surface.
///
/// ```
/// use osculate_geom::analytic::Sphere;
/// assert!(Sphere::new(5.0).is_ok());
/// let refused = Sphere::new(-5.0).unwrap_err();
/// assert_eq!((refused.what, refused.got), ("radius_mm", -5.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} must be {need}, got {got}")]
#[non_exhaustive]
pub struct BadSize {
    /// Which size.
    pub what: &'static str,
    /// The condition.
    pub need: &'static str,
    /// The value.
    pub got: f64,
}

/// `value` when it is finite and positive.
fn positive(what: &'static str, value: f64) -> Result<f64, BadSize> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(BadSize { what, need: "positive and finite", got: value })
    }
}
