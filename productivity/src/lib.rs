//! How fast a free-form surface can be machined, and along which path.
//!
//! ## From curvature to a strip
//!
//! - [`closed_form`]: the strip-width formulas of Radzevich (R97) and Marciniak (M86), corrected, each beside the exact
//!   strip of [`osculate_tools::strip`] that it approximates.
//!
//! ```
//! use osculate_productivity::closed_form::{Section, leading_order, width_37};
//! // A ball of radius 10 on the outside of a cylinder of radius 100, scallop 0.01 mm.
//! let section = Section { part_per_mm: 0.01, tool_per_mm: 0.1, scallop_mm: 0.01 };
//! let exact_for_arcs = width_37(section)?;
//! assert!((exact_for_arcs - 0.852547657).abs() < 1e-9);
//! assert!((leading_order(section)? / exact_for_arcs - 1.0).abs() < 1e-3);
//! # Ok::<(), osculate_productivity::closed_form::DomainError>(())
//! ```
//!
//! ## From a face to passes
//!
//! - [`plan`]: passes over a face whose spacing the exact strip decides, and the moves between them.
//! - [`axis`]: the tool's axis as a field over a face, the same for passes to and fro.
//! - [`access`]: from where a tool reaches faces, and which axes together reach the most.
//! - [`fixed_axis`]: where a tool that does not turn would dig in next to its contact.
//! - [`compare`]: tools, strategies, directions and leads screened side by side.
//!
//! ```
//! use osculate_geom::{Axis, Domain, Interval, analytic::Plane};
//! use osculate_productivity::plan::{Along, Task, Tolerance, isoparametric};
//! use osculate_tools::{Cutter, CutterSpec, Lean};
//!
//! let plane = Plane::new(Domain { u: Interval::new(0.0, 20.0), v: Interval::new(0.0, 10.0) });
//! let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
//! let lean = Lean { lead_rad: 0.2, tilt_rad: 0.0 };
//! let tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.01, chord_mm: 0.005 };
//! let task = Task::new("top", &plane, &ball, lean, tolerance);
//! let passes = isoparametric(&task, Along::Fixed(Axis::U))?.passes;
//! // No two neighbours are further apart than a strip, 2 sqrt(h (2 R - h)).
//! let widest_mm = 2.0 * f64::sqrt(0.02 * (10.0 - 0.02));
//! assert!(passes.windows(2).all(|w| (w[1].points[0].point.y - w[0].points[0].point.y).abs() < widest_mm + 1e-6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ## From a strip to a time
//!
//! - [`rate`], [`split`]: productivity at an instant under the caps of cutter and machine, and the share of the tolerance
//!   between tooth marks and scallops that makes it greatest.
//! - [`optimum`]: the tool, feed direction, lead and tilt of greatest productivity at a point.
//! - [`field`]: the best postures over a face, as arrays.
//! - [`ideal`]: the time that the best posture at every place of the faces would take, to hold plans against.
//! - [`levels`]: productivity at an instant, along a pass and over the whole face.
//! - [`real_time`]: the same of a path as a control runs it, at every instant and over the cells of a face.
//!
//! ```
//! use osculate_productivity::rate::Caps;
//! // A strip of 0.8 mm at 1.5 m a minute: 1200 mm2 a minute.
//! let rate = Caps::of_feed(1500.0).rate(0.8, 1.0);
//! assert!((rate.area_mm2_min - 1200.0).abs() < 1e-9);
//! ```
//!
//! ## From stock to a volume
//!
//! - [`finish`], [`rough`]: area and volume of stock per minute under any change of parameters; [`given`]: tolerance and stock
//!   that vary over the face; [`engagement`]: what a cutter takes out of real stock at an instant.
//!
//! ```
//! use osculate_geom::{Domain, Interval, analytic::Plane};
//! use osculate_productivity::{given::Given, rough::layer_volume};
//! // 0.5 mm of stock on 20 x 10 mm.
//! let plane = Plane::new(Domain { u: Interval::new(0.0, 20.0), v: Interval::new(0.0, 10.0) });
//! let volume = layer_volume(&plane, &Given::uniform(0.5)?, 1e-9)?;
//! assert!((volume.value - 100.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Lengths are millimetres, angles radians, times minutes; curvature is positive where the body is convex.

pub mod access;
pub mod axis;
pub mod closed_form;
pub mod compare;
pub mod engagement;
pub mod field;
pub mod finish;
pub mod fixed_axis;
pub mod given;
pub mod ideal;
pub mod levels;
pub mod optimum;
pub mod plan;
pub mod rate;
pub mod real_time;
mod rectangle;
pub mod rough;
mod spline;
pub mod split;
mod system;
mod width;

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
