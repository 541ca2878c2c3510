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
//! gouged. Source: [D98], with the errata of `docs/papers/d98.md`.
//!
//! - [`RuledStrip`] is the surface between two directrices, [`Rule`] its rule at a parameter with frame and derivatives.
//! - [`AxisLine`] is where a cutter's axis lies, [`AxisJet`] how it moves with the parameter.

mod axis;
mod directrix;
mod rule;
mod ruled;

pub use axis::{AxisJet, AxisLine};
pub use directrix::CurveJet2;
pub use rule::{Rule, RuleError, RuleFrame};
pub use ruled::{RuledError, RuledStrip};
