//! Rapid moves of a path that would go through raw material.

use crate::failure::Failure;
use crate::job::Job;
use osculate_productivity::plan::Linked;
use osculate_tools::cl::Motion;
use osculate_tools::removal::stock::{Stock, StockJob, Upper};
use osculate_tools::removal::{Body, Limits, Swept};

/// Feed of moves down into material, of that of passes.
const PLUNGE: f64 = 0.5;

/// Takes from raw material what a path takes. Its rapid moves that would go through some are made at the feed of plunges; how many they are comes
/// back.
pub fn slow(stock: &mut Stock, job: &Job, linked: &mut Linked) -> Result<usize, Failure> {
    let (flutes, shank) = job.flutes();
    let uppers = Upper::all(&flutes, shank.as_ref(), job.holder());
    let t = job.tolerance();
    let touch_mm = Limits::new(t.scallop_mm, t.gouge_mm).collision_mm;
    let motions = Swept::along(&linked.path);
    let work = StockJob { cutter: &flutes, uppers: &uppers, motions: &motions, touch_mm };
    let carved = stock.carve(&work, &|_| {}).map_err(Failure::job)?;
    let plunge = Motion::Feed(PLUNGE * job.feed_mm_min());
    let mut slowed = 0;
    for c in carved.collisions.iter().filter(|c| c.rapid && c.body == Body::Cutter) {
        // A motion ends at the point after that with which it begins.
        linked.path.moves[c.motion as usize + 1].motion = plunge;
        slowed += 1;
    }
    Ok(slowed)
}
