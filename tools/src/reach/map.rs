//! The axes that are possible at places, decided for many axes and many points at a time.
//!
//! For each place a tree of cones of axes is walked from the top with a list of balls of points that are undecided. A ball
//! that is clear of the tool for all axes of the cone is dropped; one that is too deep for all of them ends the cone; any
//! other is split where it is larger than the tool moves over the cone, and handed on to both halves of the cone. What is
//! left for a single axis is decided by the distances themselves, as [`Reach::gap`] does.

use super::bits::Bits;
use super::problem::{Place, Reach};
use super::stance::Stance;
use super::view::{View, lean_rad, may_lean};
use rayon::prelude::*;
use std::ops::Range;

/// A ball is split where its radius is more than this many times the way that the tool moves there over the cone. Measured
/// on a blade channel: from 0.5 to 4 the time changes by less than a third, less with a ball end for small values and with a
/// bull nose for large ones.
const SPLIT: f64 = 2.0;
/// Balls near a place are handed to the cones once they are smaller than this part of the tool: larger ones are clear of it
/// in no direction that matters, and all cones would split them again.
const NEAR: f64 = 0.25;

impl Reach<'_> {
    /// The possible directions at a place: those that the machine allows, whose lean is within the limits and at which all
    /// points keep theirs. The same as asking [`Reach::is_clear`] for each direction.
    #[must_use]
    pub fn bits(&self, place: &Place) -> Bits {
        Walk::new(self).bits(place)
    }

    /// [`Reach::bits`] of many places, on all threads.
    #[must_use]
    pub fn map(&self, places: &[Place]) -> Vec<Bits> {
        places.par_iter().map_init(|| Walk::new(self), |walk, place| walk.bits(place)).collect()
    }
}

/// A ball whose points are not decided for these solids, one bit for each.
#[derive(Clone, Copy)]
struct Open {
    ball: u32,
    solids: u32,
}

/// What is used again from place to place.
struct Walk<'a> {
    reach: &'a Reach<'a>,
    /// The lists of all cones from the root to the present one, one after the other.
    open: Vec<Open>,
    stack: Vec<Open>,
    deep: Vec<[u32; 2]>,
    /// The ball that ended a cone last: often it ends the next one too.
    blocker: Option<u32>,
}

impl<'a> Walk<'a> {
    fn new(reach: &'a Reach<'a>) -> Self {
        Self { reach, open: Vec::new(), stack: Vec::new(), deep: Vec::new(), blocker: None }
    }

    fn bits(&mut self, place: &Place) -> Bits {
        let mut bits = Bits::none(self.reach.directions.all().len());
        self.gather(place);
        self.blocker = None;
        let all = 0..self.open.len();
        self.visit(place, 0, all, &mut bits);
        bits
    }

    /// The balls that the tool can meet at all.
    fn gather(&mut self, place: &Place) {
        let extent = self.reach.extent_mm;
        let solids = u32::MAX >> (32 - self.reach.solids.len());
        self.open.clear();
        self.stack.clear();
        self.stack.extend(self.reach.obstacles.roots().map(|ball| Open { ball, solids }));
        while let Some(at) = self.stack.pop() {
            let ball = &self.reach.obstacles.balls()[at.ball as usize];
            if (ball.centre - place.point).norm() - ball.radius_mm > extent {
                continue;
            }
            if ball.second != 0 && ball.radius_mm > NEAR * extent {
                self.stack.extend([ball.second, at.ball + 1].map(|ball| Open { ball, solids }));
            } else {
                self.open.push(at);
            }
        }
    }

    fn visit(&mut self, place: &Place, index: usize, list: Range<usize>, bits: &mut Bits) {
        let reach = self.reach;
        if !reach.is_open(index) {
            return;
        }
        let cone = &reach.directions.tree.cones[index];
        let lean = lean_rad(place, &cone.axis);
        if !may_lean(reach, cone, lean) {
            return;
        }
        let members = &reach.directions.tree.order[cone.members.clone()];
        if list.is_empty() {
            for &k in members.iter().filter(|&&k| reach.allows(place, k as usize)) {
                bits.set(k as usize);
            }
            return;
        }
        let Some(second) = cone.second else {
            let k = members[0] as usize;
            if reach.allows(place, k) && self.is_clear(place, k, list) {
                bits.set(k);
            }
            return;
        };
        let start = self.open.len();
        let list = match View::new(reach, place, cone, lean) {
            None => list,
            Some(view) => {
                if self.sift(&view, list) {
                    self.open.truncate(start);
                    return;
                }
                start..self.open.len()
            }
        };
        self.visit(place, index + 1, list.clone(), bits);
        self.visit(place, second, list, bits);
        self.open.truncate(start);
    }

    /// Appends what of a list is undecided over a cone; true where some point is too deep for all of its axes.
    fn sift(&mut self, view: &View, list: Range<usize>) -> bool {
        let start = self.open.len();
        let mut deepest = (f64::INFINITY, start);
        let reach = self.reach;
        let balls = reach.obstacles.balls();
        if let Some(at) = self.blocker {
            let ball = &balls[at as usize];
            let (polar, kind) = (view.polar(ball), reach.obstacles.kind(at));
            let ends = |s| view.most_mm(&polar, s) + ball.radius_mm < s.limit_mm(kind);
            if reach.solids.iter().any(ends) {
                return true;
            }
        }
        for i in list {
            self.stack.clear();
            self.stack.push(self.open[i]);
            while let Some(at) = self.stack.pop() {
                let ball = &balls[at.ball as usize];
                let (polar, kind) = (view.polar(ball), reach.obstacles.kind(at.ball));
                let (mut open, mut left, mut depth) = (0, at.solids, f64::INFINITY);
                while left != 0 {
                    let k = left.trailing_zeros();
                    left &= left - 1;
                    let solid = &reach.solids[k as usize];
                    let limit = solid.limit_mm(kind);
                    if k == 0 && view.least_at_contact_mm(&polar, ball) >= limit {
                        continue;
                    }
                    if view.least_mm(&polar, solid) - ball.radius_mm >= limit {
                        continue;
                    }
                    depth = depth.min(view.most_mm(&polar, solid) + ball.radius_mm - limit);
                    if depth < 0.0 {
                        self.blocker = Some(at.ball);
                        return true;
                    }
                    open |= 1 << k;
                }
                if open == 0 {
                    continue;
                }
                if ball.second != 0 && ball.radius_mm > SPLIT * polar.move_mm {
                    let halves = [ball.second, at.ball + 1];
                    self.stack.extend(halves.map(|ball| Open { ball, solids: open }));
                } else {
                    if depth < deepest.0 {
                        deepest = (depth, self.open.len());
                    }
                    self.open.push(Open { ball: at.ball, solids: open });
                }
            }
        }
        // What is nearly too deep for all axes of the cone may be so for all of one half: it is looked at first.
        if deepest.1 < self.open.len() {
            self.open.swap(start, deepest.1);
        }
        false
    }

    /// Whether one direction is clear of what is undecided.
    fn is_clear(&mut self, place: &Place, direction: usize, list: Range<usize>) -> bool {
        let stance = Stance::new(self.reach, place, &self.reach.directions.all()[direction]);
        let all = u32::MAX >> (32 - self.reach.solids.len());
        let last = self.blocker.map(|ball| Open { ball, solids: all });
        let list = &self.open[list];
        for at in last.iter().chain(list) {
            if let Some(found) = stance.blocker(self.reach, at.ball, at.solids, &mut self.deep) {
                self.blocker = Some(found);
                return false;
            }
        }
        true
    }
}
