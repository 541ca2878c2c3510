//! Passes by their ends: what it takes to go from one to another, and which is reached soonest.

use super::links::{GRAZING, Links, STRAIGHT};
use super::near::Places;
use super::rates::Step;
use super::ways::Finder;
use crate::plan::{CcPoint, Pass};
use osculate_geom::{Point3, Unit3, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};

/// What an order may do with passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Freedom {
    /// Whether a pass may be run the other way: it leaves the same either way, and nobody asked for a sense.
    pub turned: bool,
    /// Whether passes that lie beside each other stay in the order in which they come.
    pub in_turn: bool,
}

/// Places at which a closed pass may begin while an order is sought; when it is found, anywhere.
const BEGINS: usize = 16;
/// Where the tool is at an end of a pass.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub tip: Point3,
    pub axis: Unit3,
}

impl End {
    pub const fn of(p: &CcPoint) -> Self {
        Self { tip: p.pose.tip, axis: p.pose.axis }
    }
}

/// A pass in its place of an order: which, and at which of the ends of all it is entered and left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub pass: u32,
    pub enter: u32,
    pub leave: u32,
}

impl Placed {
    pub const fn turned(self) -> Self {
        Self { enter: self.leave, leave: self.enter, ..self }
    }
}

/// Passes by their ends.
pub(super) struct Ends<'a> {
    links: &'a Links,
    pub freedom: Freedom,
    /// All ends: of an open pass its first point and its last, of a closed one some of its points.
    pub ends: Vec<End>,
    /// The pass of each, and which point of it.
    pub of: Vec<(u32, u32)>,
    /// The ends of each pass.
    first: Vec<u32>,
    closed: Vec<bool>,
    /// Times of ways that were found, from end to end, min: something stands in those that nothing was thought to stand in.
    found: HashMap<(u32, u32), f64>,
}

impl<'a> Ends<'a> {
    pub fn new(passes: &[&Pass], links: &'a Links, freedom: Freedom) -> Self {
        let mut out = Self {
            links,
            freedom,
            ends: Vec::new(),
            of: Vec::new(),
            first: Vec::new(),
            closed: passes.iter().map(|p| p.closed).collect(),
            found: HashMap::new(),
        };
        for (pass, k) in passes.iter().zip(0u32..) {
            // Fewer than an index can hold, as points of passes are.
            out.first.push(out.ends.len() as u32);
            let last = pass.points.len() - 1;
            let step = if pass.closed { last.div_ceil(BEGINS).max(1) } else { last.max(1) };
            for i in (0..=last).step_by(step).filter(|i| !(pass.closed && *i == last && last > 0)) {
                out.ends.push(End::of(&pass.points[i]));
                out.of.push((k, i as u32));
            }
        }
        out.first.push(out.ends.len() as u32);
        out
    }

    pub fn passes(&self) -> usize {
        self.closed.len()
    }

    /// A pass entered at one of its ends; None where it may not be.
    fn entered(&self, end: u32) -> Option<Placed> {
        let (pass, _) = self.of[end as usize];
        let (first, next) = (self.first[pass as usize], self.first[pass as usize + 1]);
        if self.closed[pass as usize] || next - first == 1 {
            return Some(Placed { pass, enter: end, leave: end });
        }
        let other = first + next - 1 - end;
        (end == first || self.freedom.turned).then_some(Placed { pass, enter: end, leave: other })
    }

    /// Time from one end to another, min.
    pub fn min(&self, from: u32, to: u32) -> f64 {
        let expected = || self.min_between(&self.ends[from as usize], &self.ends[to as usize]);
        // The way back takes as long, or nearly.
        self.found.get(&(from.min(to), from.max(to))).copied().unwrap_or_else(expected)
    }

    /// What was taken out between two ends, the lower number first: of the end of a pass and the beginning of the next.
    pub fn skipped<'s>(&self, from: u32, to: u32, all: &[&'s [CcPoint]]) -> &'s [CcPoint] {
        let pass = self.of[from as usize].0 as usize;
        let is_next = to == from + 1 && self.of[to as usize].0 as usize != pass && !self.closed[pass];
        if is_next { all[pass] } else { &[] }
    }

    /// Finds the ways of an order of which the time is not known yet.
    pub fn find(
        &mut self,
        order: &[Placed],
        (passes, skipped): (&[&Pass], &[&[CcPoint]]),
        finder: &Finder<'_>,
    ) {
        let wanted: BTreeSet<(u32, u32)> =
            order.windows(2).map(|w| (w[0].leave, w[1].enter)).map(|(a, b)| (a.min(b), a.max(b))).collect();
        let wanted: Vec<_> = wanted.into_iter().filter(|pair| !self.found.contains_key(pair)).collect();
        let point = |end: u32| {
            let (pass, point) = self.of[end as usize];
            &passes[pass as usize].points[point as usize]
        };
        let min = |(a, b): &(u32, u32)| {
            finder.between((point(*a), point(*b)), 0, self.skipped(*a, *b, skipped)).min
        };
        let times: Vec<f64> = wanted.par_iter().map(min).collect();
        self.found.extend(wanted.into_iter().zip(times));
    }

    pub fn min_between(&self, a: &End, b: &End) -> f64 {
        let l = self.links;
        let step = Step { length_mm: (b.tip - a.tip).norm(), turn_rad: a.axis.angle(&b.axis) };
        let fed = if step.length_mm <= STRAIGHT * l.cutter.radius_mm() {
            l.rates.feed_min(Step { length_mm: l.grazed_mm(step), ..step }, GRAZING * l.plunge_mm_min)
        } else {
            l.rates.feed_min(step, l.feed_mm_min) + 2.0 * l.hop_mm / l.feed_mm_min
        };
        fed.min(self.least_over() + l.rates.rapid_min(step))
    }

    /// Off the surface and down to it.
    fn least_over(&self) -> f64 {
        let l = self.links;
        l.approach_mm / l.feed_mm_min + l.approach_mm / l.plunge_mm_min
    }

    /// No end at a distance is reached sooner, min.
    fn least_min(&self, far_mm: f64) -> f64 {
        let l = self.links;
        let step = Step { length_mm: far_mm, turn_rad: 0.0 };
        l.rates.feed_min(step, l.feed_mm_min).min(self.least_over() + l.rates.rapid_min(step))
    }

    /// Time of all moves of an order, min.
    pub fn whole_min(&self, order: &[Placed]) -> f64 {
        order.windows(2).map(|w| self.min(w[0].leave, w[1].enter)).sum()
    }

    /// Passes as they come.
    pub fn as_given(&self) -> Vec<Placed> {
        (0..self.passes()).filter_map(|k| self.entered(self.first[k])).collect()
    }

    /// The end that is farthest from the middle of all.
    pub fn farthest(&self) -> u32 {
        let middle =
            self.ends.iter().fold(Vec3::zeros(), |sum, e| sum + e.tip.coords) / self.ends.len().max(1) as f64;
        let far = |k: u32| (self.ends[k as usize].tip.coords - middle).norm();
        let all = (0..self.ends.len() as u32).filter(|k| self.entered(*k).is_some());
        all.reduce(|a, b| if far(b) > far(a) { b } else { a }).unwrap_or(0)
    }

    /// From an end on always that which is reached soonest, of those that need not wait for another.
    pub fn soonest(&self, begin: u32, waits: &[Vec<u32>]) -> Vec<Placed> {
        let mut places = Places::new(&self.ends.iter().map(|e| e.tip).collect::<Vec<_>>());
        let mut waiting = vec![0u32; self.passes()];
        waits.iter().flatten().for_each(|k| waiting[*k as usize] += 1);
        let mut out: Vec<Placed> = Vec::with_capacity(self.passes());
        while out.len() < self.passes() {
            let next = match out.last() {
                None => self.entered(begin),
                Some(last) => {
                    let mut cost = |end: u32| {
                        let may =
                            self.entered(end).is_some() && waiting[self.of[end as usize].0 as usize] == 0;
                        if may { self.min(last.leave, end) } else { f64::INFINITY }
                    };
                    let best = places.best(
                        &self.ends[last.leave as usize].tip,
                        &|far| self.least_min(far),
                        &mut cost,
                    );
                    best.and_then(|(_, end)| self.entered(end))
                }
            };
            let Some(next) = next else { break };
            let own = self.first[next.pass as usize]..self.first[next.pass as usize + 1];
            own.for_each(|end| places.strike(end));
            if let Some(after) = waits.get(next.pass as usize) {
                after.iter().for_each(|k| waiting[*k as usize] -= 1);
            }
            out.push(next);
        }
        out
    }
}
