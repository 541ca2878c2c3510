//! Curves and surfaces through or near points: interpolation, least squares, and lofts over sections.
//!
//! - [`interpolate`] and [`approximate`] make a `NurbsCurve` of a row of points, open or closed;
//! - [`interpolate_grid`] and [`approximate_grid`] a surface of a grid of points;
//! - [`loft`] a surface of sections with differing numbers of points, [`skin`] one of curves.
//!
//! Every point gets a parameter first ([`Spacing`]); the error of a result is measured at these parameters, so
//! that no point is farther from the curve or surface than it says. Sources: [The NURBS Book, chapter 9; Lee,
//! Choosing nodes in parametric curve interpolation; de Boor, A practical guide to splines].

mod curve;
mod grid;
mod loft;
mod misfit;
mod params;
mod solve;

pub use curve::{CurveFit, Ends, approximate, approximate_within, interpolate};
pub use grid::{Grid, SurfaceFit, approximate_grid, interpolate_grid};
pub use loft::{LoftOptions, compatible, loft, skin};
pub use misfit::{FitError, Misfit};
pub use params::Spacing;
