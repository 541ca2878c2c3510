//! Cutters, their contact with a surface, the strips they leave, and what is left on a part.
//!
//! - [`Cutter`] is a validated end mill, cone, barrel or APT cutter: a convex body that can be asked for distances and for
//!   where a line enters it. [`CutterSpec`] is its plain description.
//! - [`Contact`] puts a cutter on a surface with [`Lean`] (lead and tilt) and a feed; [`ContactMotion`] drives it along.
//! - [`sweep`] finds how deep a moving cutter reaches along a line; [`mod@strip`] turns that into the exact strip width.
//! - [`reach`] says which axes are possible at the places of a part.
//! - [`removal`] judges whole paths: scallop, gouge and uncut area on sampled faces.
//! - [`flank`] puts the side of a cutter against ruled surfaces.
//! - [`cl`] is the path that planning hands on to posting and verification.
//!
//! Lengths are millimetres, angles radians. The tool axis points from the tip to the spindle.
//!
//! ```
//! use osculate_geom::{Axis, Flipped, analytic::Torus, uv};
//! use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
//! // A bull-nose cutter along a groove: the inside of a torus' tube.
//! let groove = Flipped(Torus::new(200.0, 60.0)?);
//! let spec = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
//! let cutter = Cutter::try_from(spec)?;
//! let lean = Lean { lead_rad: 12f64.to_radians(), tilt_rad: 0.0 };
//! let at = uv(0.0, std::f64::consts::PI);
//! let contact = Contact::new(&groove, at, &cutter, FeedLine::Iso(Axis::U), lean)?;
//! let exact = strip::exact(&contact, 0.01)?;
//! assert!((exact.width_mm - 3.107566922).abs() < 1e-8 && exact.error_mm < 1e-8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod cl;
pub mod contact;
mod cutter;
pub mod flank;
mod holder;
mod make;
pub mod meridian;
mod pose;
pub mod reach;
pub mod removal;
mod spec;
pub mod strip;
pub mod sweep;

pub use contact::{Contact, ContactError, ContactMotion, FeedLine, Lean, moving_with_axis, pose_with_axis};
pub use cutter::{Cutter, CutterError, Entry, Line, Part};
pub use holder::{Holder, HolderError, HolderSection};
pub use pose::Pose;
pub use spec::{CutterSpec, HolderSpec};

/// The example of the package's README is run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
