//! The exact strip: how wide a band around the contact the swept tool leaves within a tolerance of the part.
//!
//! Across the feed, along the geodesic through the CC point that is perpendicular to it, each point S of the part
//! sends a line along its outward normal; the swept tool stands above S by the deepest entry of that line into the
//! tool over its true motion along the feed line ([`ContactMotion`]), geodesic curvature and torsion of the line
//! included. The strip reaches as far as this standoff stays at or below the tolerance. Nothing is expanded in the
//! tolerance: the closed forms of strip width are approximations of this.

mod asked;
mod chart;
mod exact;
mod knotted;
mod local;
mod mark;
mod passages;
mod side;
mod traced;
mod undercut;

pub use asked::{Demand, Strip, StripError};
pub use chart::{Chart, ChartError, Nearly, Within};
pub use exact::{exact, exact_to, standoff};
pub use mark::{Mark, mark};

use crate::contact::ContactMotion;
