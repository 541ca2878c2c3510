//! Moves of a path that are too fast for the raw material that they would go through.

use crate::failure::Failure;
use crate::job::Job;
use osculate_productivity::plan::Linked;
use osculate_tools::cl::Motion;
use osculate_tools::removal::stock::{Stock, StockJob, Upper};
use osculate_tools::removal::{Body, Swept};

/// Feed of moves down into material, of that of passes.
const PLUNGE: f64 = 0.5;
/// Of the least chip that a verdict counts this share is one here: words of programs are rounded.
const SURE: f64 = 0.5;

/// Takes from raw material what a path takes. Its rapid moves that would go through some are made at the feed of plunges; how many they are comes
/// back. Moves at the feed of the air that take more than a chip of `touch_mm` across the tool are made at that of passes.
pub fn slow(stock: &mut Stock, job: &Job, touch_mm: f64, linked: &mut Linked) -> Result<usize, Failure> {
    let (flutes, shank) = job.flutes();
    let uppers = Upper::all(&flutes, shank.as_ref(), job.holder());
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
    let feed_mm_min = job.feed_mm_min();
    for w in carved.work.iter().filter(|w| w.is_cut(flutes.radius_mm(), SURE * touch_mm)) {
        let motion = &mut linked.path.moves[w.motion as usize + 1].motion;
        if matches!(motion, Motion::Feed(feed) if *feed > feed_mm_min) {
            *motion = Motion::Feed(feed_mm_min);
        }
    }
    Ok(slowed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Box3, Point3, Vec3};
    use osculate_tools::Pose;
    use osculate_tools::cl::ClMove;
    use osculate_tools::removal::stock::{Blank, Resolution};
    use std::path::Path;

    /// Over a block, through it, back over what was taken, and through the rest in rapid.
    #[test]
    fn what_takes_material_is_as_slow_as_that_asks_for() {
        let text = "format = 1\npart = { builtin = { kind = \"plane\", half_size_mm = 10 } }\n\
                    tool = { kind = \"flat\", diameter_mm = 4, length_mm = 30 }\ntolerance = { scallop_mm = 0.1 }\n\
                    cutting = { feed_mm_min = 1000, air_feed_mm_min = 4000 }\n";
        let job = Job::from_toml(text, Path::new("block.toml")).unwrap();
        let block = Box3 { min: Point3::new(-10.0, -10.0, -4.0), max: Point3::new(10.0, 10.0, 0.0) };
        let resolution = Resolution { cell_mm: 0.4, tri: true, budget_bytes: 1 << 26 };
        let mut stock = Stock::fill(&Blank::Box(block), &resolution).unwrap().stock;
        let air = Motion::Feed(job.air_mm_min());
        let ways = [
            ([-20.0, 0.0, 0.1], Motion::Rapid),
            ([20.0, 0.0, 0.1], air),
            ([20.0, 0.0, -1.0], air),
            ([-20.0, 0.0, -1.0], air),
            ([20.0, 0.0, -1.0], air),
            ([20.0, 5.0, -1.0], Motion::Rapid),
            ([-20.0, 5.0, -1.0], Motion::Rapid),
        ];
        let mut linked = Linked::default();
        for (at, motion) in ways {
            let pose = Pose { tip: Point3::from(at), axis: Vec3::z_axis() };
            linked.path.moves.push(ClMove { pose, motion, aloft: false });
            linked.pass_of_move.push(None);
        }
        assert_eq!(slow(&mut stock, &job, job.tolerance().gouge_mm, &mut linked).unwrap(), 1);
        let [passes, plunge] = [1.0, PLUNGE].map(|share| Motion::Feed(share * job.feed_mm_min()));
        let got: Vec<Motion> = linked.path.moves.iter().map(|m| m.motion).collect();
        assert_eq!(got, [Motion::Rapid, air, air, passes, air, Motion::Rapid, plunge]);
    }
}
