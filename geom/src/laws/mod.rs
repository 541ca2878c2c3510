//! The suite of laws that every [`Surface`](crate::Surface) must pass, to be run from the tests of any crate that implements one.
//!
//! Each function panics with the place and the numbers where a law is broken, so that a test or a property test
//! can call it directly.
//!
//! ```
//! use osculate_geom::{analytic::Torus, laws, uv};
//! let ring = Torus::new(200.0, 60.0)?;
//! laws::breaks_are_ordered(&ring);
//! laws::jets_match_differences(&ring, uv(0.4, 0.9), 1e-5, 1e-6);
//! laws::curvature_laws(&ring, uv(0.4, 0.9), 0.2, 1e-12);
//! // Gauss and Bonnet: as a ring has one hole, its curvature adds up to nothing.
//! assert!(laws::total_curvature(&ring, 3).value.abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod local;
mod suite;
mod wrappers;

pub use local::{breaks_are_ordered, curvature_laws, jets_match_differences, taylor_matches};
pub use suite::{Accuracy, Kind, Sample, inside, suite, total_curvature};
pub use wrappers::{Reversed, Swapped};
