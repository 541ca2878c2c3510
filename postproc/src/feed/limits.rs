//! Caps: what joints can do bounds how short a block may be.

use crate::machine::{JointValues, Machine};

/// A block's duration and what bounded it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Capped {
    /// Duration, min.
    pub duration_min: f64,
    /// The joint whose speed made it longer than wanted, by place.
    pub joint: Option<usize>,
}

/// The wanted duration, or that of the slowest joint at full speed where it is longer.
///
/// ```
/// use osculate_postproc::{Machine, feed::capped_duration};
///
/// // C turns by 360 degrees a second: half a turn takes half a second, whatever F asks.
/// let machine = Machine::built_in("trunnion-ac")?;
/// let c = machine.joint_named("C").expect("it has one");
/// let (from, mut to) = ([0.0; 5], [0.0; 5]);
/// to[c] = std::f64::consts::PI;
/// let capped = capped_duration(&machine, &from, &to, 0.001);
/// assert!((60.0 * capped.duration_min - 0.5).abs() < 1e-12);
/// assert_eq!(capped.joint, Some(c));
/// // What is asked for is longer: it stays.
/// assert_eq!(capped_duration(&machine, &from, &to, 1.0).duration_min, 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
