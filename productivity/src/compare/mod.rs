//! Candidates of a plan side by side: tool, strategy, direction and lead, screened before any is planned.
//!
//! A candidate is looked at on two levels that cost no plan. *Pointwise*: the integral of `dA / (S f)` over the face, S the strip
//! at a place in the direction that the strategy has there, f the tool's feed; no layout of its lines is faster. *Layout*: as
//! pointwise, but neighbouring passes of strategies whose spacing is constant along a pass (parameter lines, planes) stand as
//! close as the narrowest strip on the way wants. Both are sums over places; strips come from a
//! [`Chart`](osculate_tools::strip::Chart). The third level is the plan itself.

mod around;
mod candidate;
mod course;
mod screen;

pub use around::Around;
pub use candidate::{Axes, Candidate, Reason, Screened, Setting, Tool};
pub use screen::screen;
