//! Roughing: layers along one axis or several, out of what operations before have left, down to an even allowance.
//!
//! The cutter grown by the allowance is dropped onto the faces at the nodes of a lattice across the axis, which gives the lowest height T
//! of its tip there; stock stands over the same nodes as columns ([`columns`]). A layer from c down to z is where `T < c`, at the height
//! `max(z, T)`: it ends along the allowance, and the layer below finds above it what this one has cleared. Lines lead through it as
//! the job wants ([`ways`]); where they come next to the faces these are asked, so that the path is as good as a drop. Of lines only
//! those stretches are run that take something of what stands there when their turn comes ([`moves`]): rapids go over what is taken
//! already, and the feed follows the section that the tool moves into ([`pace`]).
//!
//! Where axes are to be found ([`directions`]) the one that takes most comes first, and the next is sought for what is left then.

mod across;
mod around;
mod been;
mod clear;
mod climb;
mod columns;
mod contour;
mod directions;
mod enter;
mod field;
mod grid;
mod heading;
mod layer;
mod material;
mod moves;
mod pace;
mod profile;
mod relief;
mod site;
mod straight;
mod straights;
mod swing;
mod task;
mod trial;
mod ways;
mod whole;

pub use task::{Entry, Heading, Headings, Places, RoughTask, Roughing, Rows, Search, Sizes};
pub use whole::rough;
