//! What holds the feed of a program, place by place: the cap on the feed that the job asks for, a joint at its greatest speed, or the
//! joints' accelerations.

use crate::job::Job;
use osculate_postproc::motion::JointDemand;
use osculate_productivity::rate::FeedLimit;
use osculate_productivity::real_time::{Cells, FinishedPlace, Finishing, Stretch};
use osculate_tools::removal::Swept;
use std::collections::BTreeMap;

/// Slower than this share of the feed of the job counts as held back.
pub const SLOWER: f64 = 0.95;

/// The cap that a job's feed is held to, as files have it.
const fn word(limit: FeedLimit) -> &'static str {
    match limit {
        FeedLimit::ToothMark => "tooth_mark",
        FeedLimit::FeedPerTooth => "feed_per_tooth",
        _ => "feed",
    }
}

/// What holds each stretch of a path.
pub struct Held {
    /// Names: the job's cap, `acceleration`, and `joint X`.
    names: Vec<String>,
    /// Of each stretch its name's place.
    of_stretch: Vec<usize>,
}

impl Held {
    /// Of stretches of a program, with what its blocks ask of the joints.
    pub fn of(job: &Job, motions: &[Swept], stretches: &[Stretch], demand: &JointDemand) -> Self {
        let fixed = [word(job.feed_limit()).to_owned(), "acceleration".to_owned()];
        let first = fixed.len();
        let names = fixed.into_iter().chain(demand.letters.iter().map(|l| format!("joint {l}"))).collect();
        // A line of a program may be several blocks: one that is slowed counts.
        let slowed: BTreeMap<usize, usize> = demand.slowed.iter().map(|b| (b.line, b.joint)).collect();
        let fast_mm_min = SLOWER * job.feed_mm_min();
        let of = |s: &Stretch| {
            if s.speed_mm_min() >= fast_mm_min {
                return 0;
            }
            let mut blocks = vec![0usize; demand.letters.len()];
            for m in motions.get(s.motions.clone()).unwrap_or_default() {
                if let Some(joint) = slowed.get(&(m.block as usize)).and_then(|j| blocks.get_mut(*j)) {
                    *joint += 1;
                }
            }
            // Of joints with as many blocks the inner one.
            let most = blocks.iter().enumerate().filter(|(_, n)| **n > 0).max_by_key(|(_, n)| **n);
            most.map_or(1, |(joint, _)| first + joint)
        };
        Self { names, of_stretch: stretches.iter().map(of).collect() }
    }

    /// The share of the time in which each holds the feed, those that do.
    pub fn shares(&self, stretches: &[Stretch]) -> BTreeMap<String, f64> {
        let mut times = vec![0.0; self.names.len()];
        for (s, by) in stretches.iter().zip(&self.of_stretch) {
            times[*by] += s.time_min;
        }
        let all: f64 = times.iter().sum();
        let each = self.names.iter().zip(times).filter(|(_, t)| *t > 0.0);
        each.map(|(name, t)| (name.clone(), t / all)).collect()
    }

    /// What holds most of the area of each cell; none where nothing was finished.
    pub fn by_cell(
        &self,
        places: &[FinishedPlace],
        finishing: &Finishing,
        cells: &Cells,
    ) -> Vec<Option<String>> {
        let mut areas = vec![0.0; cells.count() * self.names.len()];
        for (p, stretch) in places.iter().zip(&finishing.of_place).filter(|(p, _)| p.face == cells.face) {
            if let Some(by) = stretch.and_then(|s| self.of_stretch.get(s as usize)) {
                areas[cells.of(p.at) * self.names.len() + by] += p.area_mm2;
            }
        }
        let most = |cell: &[f64]| {
            let best = cell.iter().enumerate().filter(|(_, a)| **a > 0.0).max_by(|a, b| a.1.total_cmp(b.1));
            best.map(|(by, _)| self.names[by].clone())
        };
        areas.chunks(self.names.len()).map(most).collect()
    }
}
