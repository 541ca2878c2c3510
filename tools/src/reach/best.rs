//! The best axis at a place, by branch and bound over cones of axes.
//!
//! The point that has the least spare for the middle axis of a cone bounds the spare of all its members from above: over
//! the cone the distance of this one point grows by no more than its range says. Cones wait in a queue, the most promising
//! first; the first single direction that comes out of it is the best.

use super::gap::Gap;
use super::problem::{Place, Reach};
use super::view::{View, lean_rad, may_lean};
use osculate_geom::Unit3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The axis with the greatest spare at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Best {
    /// Its index in the set of directions.
    pub direction: usize,
    /// The axis.
    pub axis: Unit3,
    /// Its gap: what stands in the way where the spare is negative.
    pub gap: Gap,
}

/// Points that a cone remembers from the cones around it.
const REMEMBERED: usize = 4;

/// A cone that waits; equal bounds come out in the order of the tree.
#[derive(Clone, Copy)]
struct Waiting {
    most_mm: f64,
    cone: usize,
    /// Whether the bound is that of its own middle axis, not only of remembered points.
    is_own: bool,
    /// Balls of points that had the least spare, with the solids that had it, the last one first.
    points: [Option<(u32, usize)>; REMEMBERED],
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
        queue.extend(self.waiting(
            place,
            Waiting { most_mm: f64::INFINITY, cone: 0, is_own: false, points: [None; REMEMBERED] },
        ));
        while let Some(at) = queue.pop() {
            let cone = &tree.cones[at.cone];
            match cone.second {
                None if at.is_own => {
                    let direction = tree.order[cone.members.start] as usize;
                    return Some(Best { direction, axis: cone.axis, gap: self.gap(place, &cone.axis) });
                }
                Some(second) if at.is_own => {
                    for cone in [at.cone + 1, second] {
                        queue.extend(self.waiting(place, Waiting { cone, is_own: false, ..at }));
                    }
                }
                _ => queue.push(self.looked_at(place, at)),
            }
        }
        None
    }

    /// A cone with its bound from the points that it remembers; None where nothing of it is allowed.
    fn waiting(&self, place: &Place, mut at: Waiting) -> Option<Waiting> {
        let tree = &self.directions.tree;
        let cone = &tree.cones[at.cone];
        if !self.is_open(at.cone) {
            return None;
        }
        if cone.second.is_none() {
            return self.allows(place, tree.order[cone.members.start] as usize).then_some(at);
        }
        let lean = lean_rad(place, &cone.axis);
        if !may_lean(self, cone, lean) {
            return None;
        }
        if let Some(view) = View::new(self, place, cone, lean) {
            let bounds = at.points.iter().flatten().map(|point| self.most_spare_mm(&view, *point));
            at.most_mm = bounds.fold(at.most_mm, f64::min);
        }
        Some(at)
    }

    /// A cone with its bound from the point that has the least spare of its middle axis; for a single direction the spare
    /// itself.
    fn looked_at(&self, place: &Place, mut at: Waiting) -> Waiting {
        let cone = &self.directions.tree.cones[at.cone];
        at.is_own = true;
        let (spare, found) = self.least_spare(place, &cone.axis, at.points[0].map(|(ball, _)| ball));
        if cone.second.is_none() {
            return Waiting { most_mm: spare, ..at };
        }
        let lean = lean_rad(place, &cone.axis);
        if let Some(point) = found.filter(|point| at.points[0] != Some(*point)) {
            at.points.rotate_right(1);
            at.points[0] = Some(point);
        }
        if let (Some(point), Some(view)) = (found, View::new(self, place, cone, lean)) {
            at.most_mm = at.most_mm.min(self.most_spare_mm(&view, point));
        }
        at
    }

    /// An upper bound of the spare of one point over a cone.
    fn most_spare_mm(&self, view: &View, (ball, solid): (u32, usize)) -> f64 {
        let polar = view.polar(&self.obstacles.balls()[ball as usize]);
        let solid = &self.solids[solid];
        view.most_mm(&polar, solid) - solid.limit_mm(self.obstacles.kind(ball))
    }
}
