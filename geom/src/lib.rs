//! Differential geometry for multi-axis machining: no input or output, no file formats, no NURBS.
//!
//! - [`Surface`] is the one view that machining code has of a part: a domain, a second-order jet, and derivatives of
//!   higher order ([`Surface::jet3`], [`Surface::taylor`]) that are exact, never differences.
//! - [`Jet2::forms`] gives both fundamental forms and the curvature matrix; [`Forms::principal`] the principal
//!   curvatures. **Curvature is positive where the body is convex**, with the normal out of the material.
//! - [`Darboux`] is the moving frame along a line on the surface, [`mod@line`] the lines themselves.
//! - [`Relative`] is the form `Q = W_P + W_T` on which strip width and local gouging depend.
//! - [`batch`] holds jets and curvatures of many places as a structure of arrays.
//! - [`analytic`] has the surfaces with closed forms, [`laws`] the suite that every surface must pass.
//!
//! Lengths are millimetres, angles radians.
//!
//! # From a surface to curvature
//!
//! A place of a surface is a pair of parameters; the jet there has point and derivatives, and everything local follows from it.
//!
//! ```
//! use osculate_geom::{analytic::Sphere, uv, Surface};
//! let ball = Sphere::new(10.0)?;
//! let k = ball.jet2(uv(0.3, 0.5)).forms()?.principal();
//! assert!((k.k_max - 0.1).abs() < 1e-12 && (k.k_min - 0.1).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From curves to a surface
//!
//! A [`Curve`] is turned, moved or joined to another one: [`Revolved`], [`Extruded`], [`Ruled`]. What comes out is a [`Surface`]
//! as exact as the curve.
//!
//! ```
//! use osculate_geom::analytic::Line;
//! use osculate_geom::{Interval, Point3, Revolved, Surface, TurnAxis, Vec3, uv};
//! // A line beside the z axis, turned about it: a cylinder of radius 25.
//! let side = Line::segment(Point3::new(25.0, 0.0, 0.0), Point3::new(25.0, 0.0, 80.0))?;
//! let axis = TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() };
//! let shaft = Revolved::new(side, axis, Interval::new(0.0, std::f64::consts::TAU))?;
//! assert!((shaft.jet2(uv(1.0, 0.5)).forms()?.mean().abs() - 0.5 / 25.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a surface to a line on it
//!
//! A tool follows a line with the surface's normal as its measure. The frame and how it turns:
//!
//! ```
//! use osculate_geom::{Axis, Flipped, Interval, analytic::Cylinder, line::{IsoLine, SurfaceLine}};
//! // Along a bore of radius 20 the frame does not turn; around it, once in 2 pi 20 mm.
//! let bore = Flipped(Cylinder::new(20.0, Interval::new(0.0, 80.0))?);
//! let turn = |along, fixed| {
//!     let line = IsoLine { surface: &bore, along, fixed, reversed: false };
//!     line.frame(1.0).map(|(frame, _)| frame.turn.norm())
//! };
//! assert!(turn(Axis::V, 0.0)?.abs() < 1e-15 && (turn(Axis::U, 40.0)? - 1.0 / 20.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From a part and a tool to what fits
//!
//! Both curvatures add up to [`Relative`]; where its smaller eigenvalue is negative the tool digs in.
//!
//! ```
//! use osculate_geom::{Flipped, Interval, Relative, Surface, ToolCurvature, analytic::Cylinder, uv};
//! let bore = Flipped(Cylinder::new(20.0, Interval::new(0.0, 80.0))?).jet2(uv(0.0, 40.0)).forms()?;
//! let ball = |radius_mm: f64| ToolCurvature {
//!     along: 1.0 / radius_mm,
//!     across: 1.0 / radius_mm,
//!     direction: bore.frame[0],
//! };
//! assert!(Relative::new(&bore, &ball(19.0)).min > 0.0 && Relative::new(&bore, &ball(21.0)).min < 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod analytic;
pub mod batch;
pub mod convex;
pub mod curve;
pub mod diagnostic;
mod domain;
mod facets;
mod forms;
mod frame;
pub mod geodesic;
pub mod indicatrix;
mod jet;
pub mod lanes;
pub mod laws;
pub mod limit;
pub mod line;
pub mod ode;
pub mod offset;
mod point;
pub mod quadrature;
mod relative;
pub mod roots;
mod series;
pub mod solve;
mod surface;
mod swept;
mod taylor;

/// The linear algebra of the signatures: dependents that take it from here have the same version.
pub use nalgebra;

pub use curve::{Curve, CurveJet3, CurveTaylor, Frenet, FrenetError};
pub use diagnostic::{Diagnostic, Severity};
pub use domain::{Domain, Interval};
pub use facets::{Facets, FacetsError};
pub use forms::{Degenerate, Forms, Principal, SymEigen, project_to_tangent};
pub use frame::{Darboux, LineCurvature, geodesic_curvature, line_curvature};
pub use jet::{Jet2, Jet3, Side};
pub use offset::{Offset, OffsetError};
pub use point::{Axis, Box3, Point3, Unit3, Uv, Vec3, any_perpendicular, uv};
pub use relative::{Relative, ToolCurvature};
pub use series::{MAX_ORDER, Series};
pub use surface::{Flipped, Patch, Surface};
pub use swept::{Extruded, Revolved, Ruled, SweepError, TurnAxis};
pub use taylor::Taylor;

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
