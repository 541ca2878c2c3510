//! Concrete surfaces: NURBS, trimmed faces, and their import from STEP and IGES.

mod knots;
mod nurbs;
pub mod orient;

pub use knots::{KnotError, Knots, MAX_DEGREE};
pub use nurbs::{Net, NurbsError, NurbsSurface};
