//! How fast a free-form surface can be machined, and along which path.
//!
//! - [`closed_form`]: the strip-width formulas of Radzevich (R97) and Marciniak (M86), corrected, each beside the exact
//!   strip of [`osculate_tools::strip`] that it approximates.
//! - [`plan`]: passes over a face whose spacing the exact strip decides, and the moves between them.
//! - [`rate`], [`split`]: productivity at an instant under the caps of cutter and machine, and the share of the tolerance
//!   between tooth marks and scallops that makes it greatest.
//! - [`optimum`]: the tool, feed direction, lead and tilt of greatest productivity at a point.
//! - [`field`]: the best postures over a face, as arrays.
//! - [`compare`]: tools, strategies, directions and leads screened side by side.
//! - [`access`]: from where a tool reaches faces, and which axes together reach the most.
//! - [`ideal`]: the time that the best posture at every place of the faces would take, to hold plans against.
//! - [`levels`]: productivity at an instant, along a pass and over the whole face.
//! - [`finish`], [`rough`]: area and volume of stock per minute under any change of parameters; [`given`]: tolerance and stock
//!   that vary over the face; [`engagement`]: what a cutter takes out of real stock at an instant.
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

pub mod access;
pub mod axis;
pub mod closed_form;
pub mod compare;
pub mod engagement;
pub mod field;
pub mod finish;
pub mod given;
pub mod ideal;
pub mod levels;
pub mod optimum;
pub mod plan;
pub mod rate;
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
