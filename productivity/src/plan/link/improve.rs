//! An order made shorter, move by move.
//!
//! Two moves are tried, each between ends that lie near each other: a stretch of the order is run the other way, all of its passes
//! turned, or a few passes that follow each other go elsewhere, turned or not. A move is made where it saves time. Where passes may
//! not be turned only the second is left, and keeps them as they are.

use super::ends::{Ends, Placed};
use super::near::Places;
use rayon::prelude::*;

/// Ends near each end that moves are tried with.
const NEAR: usize = 10;
/// Most passes that go elsewhere together.
const TOGETHER: usize = 3;
/// Rounds through the whole order; few orders change after the fifth.
const ROUNDS: usize = 12;
/// Moves, of the number of passes: each moves as much as all of the order in memory.
const MOVES: usize = 20;
/// Gains below this, min, are rounding.
const LEAST_GAIN: f64 = 1e-9;

struct Tour<'a> {
    ends: &'a Ends<'a>,
    order: &'a mut Vec<Placed>,
    /// Where each pass stands.
    stands: Vec<usize>,
    moves: usize,
}

/// Makes an order shorter.
pub(super) fn improve(ends: &Ends<'_>, order: &mut Vec<Placed>) {
    if order.len() < 3 {
        return;
    }
    let tips: Vec<_> = ends.ends.iter().map(|e| e.tip).collect();
    let places = Places::new(&tips);
    let near: Vec<Vec<u32>> = tips.par_iter().map(|tip| places.nearest(tip, NEAR)).collect();
    let mut tour = Tour { ends, stands: vec![0; ends.passes()], moves: MOVES * order.len(), order };
    tour.stand(0);
    for _ in 0..ROUNDS {
        let mut gained = false;
        for k in 0..tour.order.len() {
            gained |= ends.freedom.turned && tour.turn_around(k, &near);
            gained |= tour.send_elsewhere(k, &near);
        }
        if !gained || tour.moves == 0 {
            break;
        }
    }
}

impl Tour<'_> {
    fn stand(&mut self, from: usize) {
        for k in from..self.order.len() {
            self.stands[self.order[k].pass as usize] = k;
        }
    }

    /// Time from the pass in one place to that in another; nothing where there is none.
    fn link(&self, from: Option<Placed>, to: Option<Placed>) -> f64 {
        match (from, to) {
            (Some(a), Some(b)) => self.ends.min(a.leave, b.enter),
            _ => 0.0,
        }
    }

    fn at(&self, k: usize) -> Option<Placed> {
        self.order.get(k).copied()
    }

    fn before(&self, k: usize) -> Option<Placed> {
        self.at(k.checked_sub(1)?)
    }

    /// What is gained by running a stretch of the order the other way.
    fn by_turning(&self, first: usize, last: usize) -> f64 {
        let (a, b) = (self.before(first), self.at(last + 1));
        let [i, j] = [self.order[first], self.order[last]];
        let is = self.link(a, Some(i)) + self.link(Some(j), b);
        is - self.link(a, Some(j.turned())) - self.link(Some(i.turned()), b)
    }

    /// Runs a stretch that begins or ends in a place the other way, where that gains.
    fn turn_around(&mut self, k: usize, near: &[Vec<u32>]) -> bool {
        if self.moves == 0 {
            return false;
        }
        let place = |end: &u32| self.stands[self.ends.of[*end as usize].0 as usize];
        let mut best = (LEAST_GAIN, 0, 0);
        // From the pass before to what is left near its end, and to the pass after from what is entered near its beginning.
        let stretches = self.before(k).into_iter().flat_map(|a| &near[a.leave as usize]).filter_map(|end| {
            let j = place(end);
            (j >= k && self.order[j].leave == *end).then_some((k, j))
        });
        let others = self.at(k + 1).into_iter().flat_map(|b| &near[b.enter as usize]).filter_map(|end| {
            let i = place(end);
            (i <= k && self.order[i].enter == *end).then_some((i, k))
        });
        for (i, j) in stretches.chain(others) {
            let gain = self.by_turning(i, j);
            if gain > best.0 {
                best = (gain, i, j);
            }
        }
        let (gain, first, last) = best;
        if gain <= LEAST_GAIN {
            return false;
        }
        self.order[first..=last].reverse();
        self.order[first..=last].iter_mut().for_each(|p| *p = p.turned());
        self.stand(first);
        self.moves -= 1;
        true
    }

    /// Sends the passes that follow each other from a place on elsewhere, where that gains.
    fn send_elsewhere(&mut self, first: usize, near: &[Vec<u32>]) -> bool {
        if self.moves == 0 {
            return false;
        }
        let n = self.order.len();
        // Gain, last of the stretch, the place before which it goes, and whether turned.
        let mut best = (LEAST_GAIN, 0, 0, false);
        for last in first..(first + TOGETHER).min(n) {
            let [i, j] = [self.order[first], self.order[last]];
            let (a, b) = (self.before(first), self.at(last + 1));
            let out = self.link(a, Some(i)) + self.link(Some(j), b) - self.link(a, b);
            if out <= LEAST_GAIN {
                continue;
            }
            for (end, begins) in [(i.enter, true), (j.leave, false)] {
                for other in &near[end as usize] {
                    let k = self.stands[self.ends.of[*other as usize].0 as usize];
                    if (first..=last).contains(&k) {
                        continue;
                    }
                    // After the pass that is left there, or before the one that is entered there.
                    for (is, before, turned) in [
                        (self.order[k].leave == *other, k + 1, !begins),
                        (self.order[k].enter == *other, k, begins),
                    ] {
                        if !is
                            || (turned && !self.ends.freedom.turned)
                            || before == first
                            || before == last + 1
                        {
                            continue;
                        }
                        let (c, d) = (self.before(before), self.at(before));
                        let (head, tail) = if turned { (j.turned(), i.turned()) } else { (i, j) };
                        let gain =
                            out + self.link(c, d) - self.link(c, Some(head)) - self.link(Some(tail), d);
                        if gain > best.0 {
                            best = (gain, last, before, turned);
                        }
                    }
                }
            }
        }
        let (gain, last, before, turned) = best;
        if gain <= LEAST_GAIN {
            return false;
        }
        if turned {
            self.order[first..=last].reverse();
            self.order[first..=last].iter_mut().for_each(|p| *p = p.turned());
        }
        if before > last {
            self.order[first..before].rotate_left(last + 1 - first);
        } else {
            self.order[before..=last].rotate_right(last + 1 - first);
        }
        self.stand(first.min(before));
        self.moves -= 1;
        true
    }
}
