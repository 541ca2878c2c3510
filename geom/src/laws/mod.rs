//! The suite of laws that every [`Surface`](crate::Surface) must pass, to be run from the tests of any crate that implements one.
//!
//! Each function panics with the place and the numbers where a law is broken, so that a test or a property test
//! can call it directly.

mod local;
mod suite;
mod wrappers;

pub use local::{breaks_are_ordered, curvature_laws, jets_match_differences, taylor_matches};
pub use suite::{Accuracy, Kind, Sample, inside, suite, total_curvature};
pub use wrappers::{Reversed, Swapped};
