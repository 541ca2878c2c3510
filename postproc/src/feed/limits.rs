//! Caps: what joints can do bounds how short a block may be.

use crate::machine::{JointValues, Machine};

/// A block's duration and what bounded it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capped {
    /// Duration, min.
    pub duration_min: f64,
    /// The joint whose speed made it longer than wanted, by place.
    pub joint: Option<usize>,
}

/// The wanted duration, or that of the slowest joint at full speed where it is longer.
#[must_use]
pub fn capped_duration(machine: &Machine, from: &JointValues, to: &JointValues, wanted_min: f64) -> Capped {
    let mut capped = Capped { duration_min: wanted_min, joint: None };
    for (place, joint) in machine.joints().iter().enumerate() {
        let least = (to[place] - from[place]).abs() / (60.0 * joint.drive.velocity_per_s);
        if least > capped.duration_min {
            capped = Capped { duration_min: least, joint: Some(place) };
        }
    }
    capped
}
