//! NURBS curves and surfaces: data, evaluation by pieces, batches, Taylor polynomials, changes that keep the shape.

mod batch;
mod curve;
mod degree;
mod edit;
mod edit_error;
mod eval;
mod net;
mod pieces;
mod surface;
mod taylor;

pub use curve::{CurveError, CurveJet, NurbsCurve, NurbsCurve2, NurbsCurve3};
pub use degree::{RemovedCurve, RemovedSurface};
pub use edit::BezierPatch;
pub use edit_error::EditError;
pub use net::Net;
pub(crate) use pieces::{Pieces, piece_powers};
pub use surface::{NurbsError, NurbsSurface};
