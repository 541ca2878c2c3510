//! The fastest feed that the joints can follow, block by block.
//!
//! Time of every block from a backward and a forward pass over the joints' speeds and accelerations with the corners'
//! tolerance ([`crate::motion::block_times_s`]); written as F, the control runs at the machine's limits without
//! having to slow down by itself. A cap on the tip's feed keeps the cutting conditions.

use osculate_tools::cl::Motion;

use crate::joint_path::JointPath;
use crate::machine::Machine;
use crate::motion::{LookAhead, block_times_s};

/// Time of every block of the path, min; 0 for rapid moves and for the first block.
#[must_use]
pub fn fastest_durations_min(machine: &Machine, path: &JointPath, tip_mm_min: Option<f64>) -> Vec<f64> {
    let mut asked = Vec::with_capacity(path.blocks.len());
    let mut feeds = Vec::with_capacity(path.blocks.len());
    for pair in path.blocks.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        let is_feed = to.motion != Motion::Rapid && from.joints != to.joints;
        feeds.push(is_feed);
        asked.push(is_feed.then(|| {
            let wanted_s = tip_mm_min.map_or(0.0, |f| 60.0 * to.tip_length_mm / f);
            (from.joints, to.joints, wanted_s)
        }));
    }
    // The last stretch comes to rest by itself.
    let mut times = block_times_s(machine, &LookAhead::default(), asked).into_iter();
    let mut durations = vec![0.0];
    durations.extend(feeds.iter().map(|f| if *f { times.next().unwrap_or(0.0) / 60.0 } else { 0.0 }));
    durations
}
