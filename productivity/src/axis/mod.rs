//! The tool's axis as a field over a face, in the part's frame.
//!
//! What a pose leaves does not depend on the sense of travel, so that one axis at each place of a face serves passes to and fro:
//! they leave the same strips, and nothing turns between them. [`find`] looks for the field of least time among the axes that
//! [`osculate_tools::reach`] and the machine's [`Joints`] leave possible.

mod around;
mod field;
mod find;
mod joints;
mod lattice;
mod pace;
mod places;
mod rim;
mod search;
mod settle;

pub(crate) use around::sunk;
pub use around::{Around, Left, Surroundings};
pub use field::AxisField;
pub use find::{Found, NoField, Possibilities, Unreached, Wish, find};
pub use joints::Joints;
pub use lattice::Feed;
pub use places::PlaceAxes;
