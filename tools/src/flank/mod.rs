//! Flank milling: the side of a cutter along the rules of a ruled surface.
//!
//! ```text
//! S(u, v) = (1 - v) C0(u) + v C1(u)                                       the strip, v from 0 to 1
//! P_i = C_i(u), T_i = C_i'(u), h_p = |P1 - P0|, z = (P1 - P0)/h_p         the rule at u
//! N_i = unit(T_i x z), y = sigma unit(N0 + N1), x = y x z                 its frame; sigma = +-1 the tool's side
//! ```
//!
//! sigma = +1 is the side of `S_u x S_v`, [`Side::Along`](osculate_geom::Side). A cylinder of radius R about an axis deviates
//! from a point of the strip by `delta = dist(point, axis) - R`: above zero material is left, below zero the part is
//! gouged. Source: D98, with the errata of `docs/papers/d98.md`.
//!
//! - [`RuledStrip`] is the surface between two directrices, [`Rule`] its rule at a parameter with frame and derivatives.
//! - [`place`] puts a [`SideTool`] (cylinder, cone, barrel) against a rule in one of the [`Setting`]s; [`profile`] is the
//!   static deviation along the rule, [`Placed::verdict`] what the position is worth.
//! - [`mod@closed`] has the paper's closed forms beside the exact values, [`largest_radius`] the largest tool within a tolerance.
//! - [`envelope`] is what a moving cutter leaves, [`fn@global::optimise`] the motion that leaves least over a whole face.
//! - [`AxisLine`] is where a cutter's axis lies, [`AxisJet`] how it moves with the parameter.
//!
//! ```
//! use osculate_geom::{Point3, Side, Vec3, analytic::Line};
//! use osculate_tools::flank::{RuledStrip, Setting, SideTool, Stations, place};
//! // Two straight directrices, 80 mm apart and turned against each other by 60 degrees: a hyperbolic paraboloid.
//! let line = |z: f64, turn: f64| {
//!     let (s, c) = turn.to_radians().sin_cos();
//!     Line::segment(Point3::new(-40.0 * c, -40.0 * s, z), Point3::new(40.0 * c, 40.0 * s, z))
//! };
//! let strip = RuledStrip::new(line(0.0, 30.0)?, line(80.0, -30.0)?, Side::Along, 1.0)?;
//! let (tool, stations) = (SideTool::cylinder(10.0)?, Stations::new(&strip, 48));
//! let depth = |setting| -> Result<f64, Box<dyn std::error::Error>> {
//!     let placed = place(&strip, &stations, 0.5, tool, setting)?;
//!     Ok(-placed.profile(&strip, &stations, &tool, 65).lowest.deviation_mm)
//! };
//! // Along the rule the tool gouges by R (1 - cos 30 deg), touching three times by a fiftieth of that.
//! assert!((depth(Setting::Distributed)? - 1.339746).abs() < 1e-6);
//! assert!((depth(Setting::ThreeTangent)? - 0.026010).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod axes;
mod axis;
pub mod closed;
pub mod cutter_side;
pub mod deviation;
mod directrix;
pub mod envelope;
pub mod global;
mod largest;
mod lp;
mod minimax;
#[cfg(test)]
mod oracle;
pub mod path;
mod rule;
mod ruled;
mod section;
mod setting;
mod standard;
mod three;
mod tool;
mod touch;

pub use axis::{AxisJet, AxisLine};
pub use directrix::CurveJet2;
pub use largest::{LargestRadius, RadiusLimit, RadiusSearch, RadiusSearchError, largest_radius};
pub use minimax::{Hold, MinimaxAxis, MinimaxSearch, minimax};
pub use rule::{Rule, RuleError, RuleFrame};
pub use ruled::{RuledError, RuledStrip};
pub use section::{Least, Profile, Stations, least_at, profile};
pub use setting::{Placed, Setting, Verdict, place};
pub use standard::balanced_fraction;
pub use three::{ThreeTangent, three_tangent};
pub use tool::{SideNear, SideTool, SideToolError};
pub use touch::{PlaceError, Touch};
