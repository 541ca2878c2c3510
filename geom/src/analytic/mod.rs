//! Surfaces with closed forms: plane, cylinder, cone, sphere, torus, ellipsoid and paraboloid; lines and conics.
//!
//! Each is built in a local frame; [`Placed`] puts it anywhere. The natural normal `S_u x S_v` of every closed
//! kind points away from the axis or centre, so material inside is [`Side::Along`](crate::Side::Along).

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
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} must be {need}, got {got}")]
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
