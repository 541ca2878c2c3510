//! The ruled surface between two curves; rules found in faces (`rulings`, `mates`).
//!
//! `S(u, v)` runs along the straight line from `A(u)` at v = 0 to `B(u)` at v = 1. It is exact: the curves'
//! poles are the two rows of its net. Where the curves have different weights the point at v does not divide
//! the ruling as v to 1 - v, but it lies on it.

mod asked;
mod mates;
mod rulings;
mod surface;

pub use asked::{Band, RulingError, RulingOptions};
pub use mates::Mate;
pub use rulings::{RuledBand, Ruling, ruled_bands, ruling};
pub use surface::{RuledError, ruled};
