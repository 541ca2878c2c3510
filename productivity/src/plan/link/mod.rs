//! Moves between passes: along the surface, off it by little, over what stands between, or over everything.
//!
//! Where the next pass begins beside the last the tool goes straight on along the surface; where that is not clear it lifts off as low as
//! keeps it off walls and far enough from faces that are not machined, or goes up its axis as far as what stands between needs; the
//! fastest of these that is clear counts (`ways`). Where none is a retract leaves along the tool's own axis until the tip is above the
//! plane that touches the part's bounding sphere (grown by the clearance) on the side the axis points to; there nothing of the part can
//! meet the tool, whose body lies beyond the tip. From the pole of that plane the axis swings over the sphere, always pointing outward,
//! to the pole of the next pass and down again. A tool that keeps its axis needs no more than a plane over the box around everything.
//! Moves are rapid where nothing may stand near the tool (`left` knows the raw material), and fed elsewhere.

mod ends;
mod improve;
mod kept;
mod left;
mod links;
mod near;
mod order;
mod rates;
mod tree;
mod walls;
mod ways;

use super::{CcPoint, Pass};
pub use ends::Freedom;
use left::Left;
pub use links::Links;
use links::contacts;
pub use order::ordered;
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};
pub use rates::Rates;
pub(in crate::plan) use rates::Step;
use rayon::prelude::*;
pub use walls::{Keeping, Walls};
use ways::{Finder, Way};

/// A linked path with the share of cutting in it.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Linked {
    /// The whole path.
    pub path: ClPath,
    /// For each move, the pass that it cuts; None for links.
    pub pass_of_move: Vec<Option<u32>>,
    /// Length of cutting moves along the tip, mm.
    pub cutting_length_mm: f64,
    /// Length of all other moves along the tip, mm.
    pub air_length_mm: f64,
}

impl Linked {
    /// Adds a move, unless it leads nowhere.
    pub(super) fn go(&mut self, pose: Pose, motion: Motion, pass: Option<u32>) {
        self.make(ClMove { pose, motion, aloft: false }, pass);
    }

    fn make(&mut self, to: ClMove, pass: Option<u32>) {
        let pose = &to.pose;
        if let Some(last) = self.path.moves.last() {
            let length = (pose.tip - last.pose.tip).norm();
            if length == 0.0 && pose.axis == last.pose.axis {
                return;
            }
            if pass.is_some() {
                self.cutting_length_mm += length;
            } else {
                self.air_length_mm += length;
            }
        }
        self.path.moves.push(to);
        self.pass_of_move.push(pass);
    }

    fn follow(&mut self, way: &Way) {
        for leg in &way.legs {
            self.make(ClMove { pose: leg.pose, motion: leg.motion, aloft: leg.aloft }, None);
        }
    }
}

/// Joins passes in their order, by ways that keep off `walls`.
#[must_use]
pub fn link(passes: &[Pass], links: &Links, walls: &Walls) -> Linked {
    link_stretches(passes, &[], links, walls)
}

/// Joins passes in their order, by ways that keep off `walls`. `skipped` is after each what was taken out of the pass that it is of, up to
/// the next: ways may follow it.
#[must_use]
pub fn link_stretches(passes: &[Pass], skipped: &[Vec<CcPoint>], links: &Links, walls: &Walls) -> Linked {
    let contacts = contacts(passes, links);
    let left = (!walls.stock().is_empty()).then(|| Left::new(walls.stock(), passes, &links.cutter));
    let finder = Finder::new(links, (&contacts, walls), left.as_ref());
    let ends: Vec<(u32, &Pass, [&CcPoint; 2])> = passes
        .iter()
        .zip(0u32..)
        .filter_map(|(pass, k)| Some((k, pass, [pass.points.first()?, pass.points.last()?])))
        .collect();
    let between = |w: &[(u32, &Pass, [&CcPoint; 2])]| {
        let [(last, _, [_, from]), (next, _, [to, _])] = [&w[0], &w[1]];
        let on = skipped.get(*last as usize).filter(|_| last + 1 == *next);
        finder.between((from, to), *next, on.map_or(&[], Vec::as_slice))
    };
    let between: Vec<Way> = ends.par_windows(2).map(between).collect();
    let mut out = Linked::default();
    let feed = Motion::Feed(links.feed_mm_min);
    if let Some((k, _, [first, _])) = ends.first() {
        if !links.dropped {
            out.go(finder.pole(&first.pose.axis), Motion::Rapid, None);
        }
        out.follow(&finder.approach(first, *k));
    }
    for (i, (k, pass, _)) in ends.iter().enumerate() {
        if let Some(way) = i.checked_sub(1).and_then(|i| between.get(i)) {
            out.follow(way);
        }
        for p in &pass.points[1..] {
            out.go(p.pose, feed, Some(*k));
        }
    }
    if let Some((k, _, [_, end])) = ends.last() {
        out.follow(&finder.retract(end, k + 1));
        if !links.dropped {
            out.go(finder.pole(&end.pose.axis), Motion::Rapid, None);
        }
    }
    out
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod order_tests;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
