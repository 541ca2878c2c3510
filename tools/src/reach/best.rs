//! The best axis at a place, by branch and bound over cones of axes.
//!
//! The point that has the least spare for the middle axis of a cone bounds the spare of all its members from above: over
//! the cone the distance of this one point grows by no more than its range says. Cones wait in a queue, the most promising
//! first; the first single direction that comes out of it is the best.

use super::gap::Gap;
use super::map::lean_rad;
use super::problem::{Place, Reach};
use super::view::View;
use osculate_geom::Unit3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The axis with the greatest spare at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    /// Its index in the set of directions.
    pub direction: usize,
    /// The axis.
    pub axis: Unit3,
    /// Its gap: what stands in the way where the spare is negative.
    pub gap: Gap,
}

/// A cone that waits; equal bounds come out in the order of the tree.
struct Waiting {
    most_mm: f64,
    cone: usize,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most_mm.total_cmp(&other.most_mm).then_with(|| other.cone.cmp(&self.cone))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Waiting {}

impl Reach<'_> {
    /// The direction with the greatest spare among those that the machine and the limits of the lean allow, whether it is
    /// possible or not; None where they allow none. Of equally good ones any, always the same.
    #[must_use]
    pub fn best(&self, place: &Place) -> Option<Best> {
        let tree = &self.directions.tree;
        let mut queue = BinaryHeap::new();
        queue.push(Waiting { most_mm: f64::INFINITY, cone: 0 });
        while let Some(Waiting { most_mm, cone }) = queue.pop() {
            let Some(second) = tree.cones[cone].second else {
                let direction = tree.order[tree.cones[cone].members.start] as usize;
                let axis = self.directions.all()[direction];
                return Some(Best { direction, axis, gap: self.gap(place, &axis) });
            };
            for half in [cone + 1, second] {
                let bound = self.most_spare_mm(place, half).map(|own| own.min(most_mm));
                queue.extend(bound.map(|most_mm| Waiting { most_mm, cone: half }));
            }
        }
        None
    }

    /// An upper bound of the spare over a cone, the spare itself for a single direction; None where nothing of the cone is
    /// allowed.
    fn most_spare_mm(&self, place: &Place, index: usize) -> Option<f64> {
        let tree = &self.directions.tree;
        let cone = &tree.cones[index];
        if !self.is_open(index) {
            return None;
        }
        if cone.second.is_none() {
            let direction = tree.order[cone.members.start] as usize;
            return self.allows(place, direction).then(|| self.least_spare(place, &cone.axis).0);
        }
        let lean = lean_rad(place, &cone.axis);
        let apart = cone.angle_rad + 1e-7;
        if lean - apart > self.limits.most_lean_rad || lean + apart < self.limits.least_lean_rad {
            return None;
        }
        let (_, Some((ball, solid))) = self.least_spare(place, &cone.axis) else {
            return Some(f64::INFINITY);
        };
        let Some(view) = View::new(self, place, cone, lean) else { return Some(f64::INFINITY) };
        let polar = view.polar(&self.obstacles.balls()[ball as usize]);
        let solid = &self.solids[solid];
        Some(view.range(&polar, solid).most_mm - solid.limit_mm(self.obstacles.kind(ball)))
    }
}
