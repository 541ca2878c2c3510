//! Feed: what F must be so that a block takes the time it should.
//!
//! A block shall take `T = L_CL / F0`: the tip's way relative to the part over the wanted feed. A control without
//! tool-centre-point control reads F over a path of its own making ([`PathMetric`]), so the programmed
//! `F = L_NC / T = F0 K` differs from F0. Source: Z17, with the metrics of today's controls.

mod correction;
mod fastest;
mod inverse_time;
mod limits;

pub(crate) use correction::DEGREE_AS_MM;
pub use correction::{FeedMode, PathMetric, Step, limited_rise};
pub use fastest::fastest_durations_min;
pub use inverse_time::{duration_min, inverse_time_per_min};
pub use limits::{Capped, capped_duration};
