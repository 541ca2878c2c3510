//! Characteristic lines over a face: what tells a person how a surface wants to be machined, after M86.
//!
//! - A [`Chart`] is a face prepared for the search: cells of a stated size over its parameters, poles, scale.
//! - [`umbilics`] finds where both principal curvatures agree, with index and type, and checks the sum of the indices
//!   against the rotation of the curvature directions along the boundary.
//! - [`contours`] draws all lines on which a [`ScalarField`] has given values: heights along an axis
//!   ([`Height`]), the difference of the principal curvatures ([`CurvatureDifference`]), zero Gaussian curvature
//!   ([`Gauss`]), ridges ([`Extremality`]). [`critical_points`] finds minima, maxima and saddles, [`turned`] the axis with the
//!   fewest minima of height.
//! - [`trace`] follows a [`Course`] from a point: lines of curvature, gradient lines, asymptotic lines; [`cover`]
//!   spreads such lines evenly over the face.
//!
//! The four umbilics of an ellipsoid, and its horizontal sections:
//!
//! ```
//! use osculate_geom::{Unit3, Vec3, analytic::Ellipsoid};
//! use osculate_surfaces::lines::{Chart, Height, LineTolerance, UmbilicKind, contours, umbilics};
//! let e = Ellipsoid::new([3.0, 2.0, 1.0])?;
//! let chart = Chart::new(&e, LineTolerance::for_size(7.5))?;
//! let found = umbilics(&chart);
//! assert!(found.confirmed() && found.index_sum_twice == Some(4) && found.points.len() == 4);
//! assert!(found.points.iter().all(|u| u.kind == UmbilicKind::Lemon));
//! let height = Height { axis: Unit3::new_normalize(Vec3::z()) };
//! let sections = contours(&chart, &height, &[-0.5, 0.5], None);
//! assert_eq!(sections.lines.iter().filter(|l| l.line.is_closed()).count(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Curvature is positive where the body is convex. Lines are polylines of points on the surface with their
//! parameters; [`LineTolerance`] says how close.

mod chart;
mod contour;
mod course;
mod cover;
mod critical;
mod field;
mod near;
mod ridge;
mod standing;
mod stitch;
mod third;
mod trace;
mod umbilic;
mod web;
mod zeros;

pub use chart::{Chart, ChartError, LineTolerance, Pole};
pub use contour::{Contour, Contours, contours};
pub use course::{Course, Family};
pub use cover::{Cover, CoverEnd, Covered, cover};
pub use critical::{Critical, CriticalKind, CriticalPoints, critical_points};
pub use field::{CurvatureDifference, Extremality, FieldSample, Gauss, Height, ScalarField, Scale};
pub use ridge::{Ridge, Ridges, ridges};
pub use standing::{Standing, Turn, turned};
pub use third::{FormsRate, forms_rate};
pub use trace::{LineEnd, LinePoint, SurfacePolyline, TraceStops, curvature_line, trace};
pub use umbilic::{Umbilic, UmbilicKind, UmbilicLine, Umbilics, umbilics};
