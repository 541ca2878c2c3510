//! Branch and turn of the rotary joints over a whole path.
//!
//! At every CL point the tool axis leaves a few choices: two branches, and whole turns of joints whose range is wider
//! than one. The choice over the path is a shortest path through these states (dynamic programming, one sweep):
//!
//! - an edge costs the time that the rotary joints need at full speed;
//! - the tool axis moves continuously, so a joint may only move by the difference of angles in (-pi, pi]; another turn
//!   at a limit is a **rewind** (leave the part, turn back, return) and costs [`REWIND_COST_S`] more;
//! - the branch may change without a rewind only where the tool axis passes through a pole.
//!
//! Points inside the singular cone have no states of their own: there the outer joint is free, and it is interpolated
//! between the neighbours afterwards ([`crate::choices`]) while the inner one follows the axis as well as it can.
//!
//! The sweep keeps no points. What it keeps is where each state comes from, and as neighbours nearly always agree in
//! that, a run of points that do is one entry: a few bytes for every place where the states change, none for the points
//! between. Where every point differed it would be 24 bytes a point and two a state.

use crate::machine::{Candidate, LIMIT_SLACK, Machine, Orientations, angle_between, nearest_turn};
use osculate_geom::Unit3;

/// Price of a rewind in cutting: more than any path's rotary travel that would avoid one.
const REWIND_COST_S: f64 = 1e4;

/// Price of a rewind on a rapid move: taken before one in cutting, not for saving a few seconds.
const RAPID_REWIND_COST_S: f64 = 20.0;

/// Whole turns looked at on each side of the principal value of a limited joint.
const MOST_TURNS: i32 = 3;

/// A price so small that it only decides between equals: the first point starts near zero.
const START_COST: f64 = 1e-3;

/// One point as the search sees it.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// States within limits; empty inside the singular cone.
    pub states: Vec<State>,
    /// Tool axis in the table's frame.
    pub axis: Unit3,
    /// Inside the singular cone.
    pub singular: bool,
    /// Reached by a rapid move.
    pub rapid: bool,
}

/// One choice at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    /// Rotary joints; endless ones in (-pi, pi].
    pub rotary_rad: [f64; 2],
    /// Branch.
    pub branch: usize,
    /// Its place among all turns of all candidates ([`all_turns`]), those beyond limits counted.
    pub slot: u8,
}

/// The slot of points inside the singular cone.
pub(crate) const NO_SLOT: u8 = u8::MAX;

/// Every turn of every candidate that the rotary limits allow: at most twice 7 times 7.
pub(crate) fn all_turns(machine: &Machine, found: &Orientations) -> Vec<State> {
    let mut all = Vec::with_capacity(4);
    for candidate in found.candidates() {
        turns(machine, candidate, &mut all);
    }
    all
}

/// Adds every turn of the candidate that the rotary limits allow.
fn turns(machine: &Machine, candidate: &Candidate, all: &mut Vec<State>) {
    each_turn(machine, candidate, 0, |outer| {
        each_turn(machine, candidate, 1, |inner| {
            let slot = u8::try_from(all.len()).unwrap_or(NO_SLOT - 1);
            all.push(State { rotary_rad: [outer, inner], branch: candidate.branch, slot });
        });
    });
}

/// Every turn of the candidate's `k`-th rotary joint that its limits allow; zero once where there is no such joint.
pub(crate) fn each_turn(machine: &Machine, candidate: &Candidate, k: usize, mut take: impl FnMut(f64)) {
    let q = candidate.rotary_rad[k];
    let Some(&place) = machine.rotary().get(k) else { return take(0.0) };
    let joint = machine.joint_at(place);
    if joint.is_endless() {
        return take(q);
    }
    for turn in -MOST_TURNS..=MOST_TURNS {
        let q = q + f64::from(turn) * std::f64::consts::TAU;
        if joint.excess(q) <= LIMIT_SLACK {
            take(q);
        }
    }
}

/// Points in a row whose states come from the same states of the point before.
#[derive(Clone, Copy, Debug)]
struct Run {
    points: usize,
    /// Where its links start in the list of all, and how many there are.
    links: (usize, usize),
}

/// Where a state comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Link {
    slot: u8,
    from: u8,
}

/// The sweep: points go in one after the other, the slots of the cheapest way come out.
pub(crate) struct Search<'a> {
    machine: &'a Machine,
    cone_rad: f64,
    runs: Vec<Run>,
    links: Vec<Link>,
    /// The last regular point with the price of each of its states.
    last: Option<(Node, Vec<f64>)>,
    /// Singular points since, and a rapid move since.
    gap: bool,
    rapid: bool,
    gaps: Vec<Gap>,
}

impl<'a> Search<'a> {
    pub fn new(machine: &'a Machine, cone_rad: f64) -> Self {
        let (runs, links) = (Vec::new(), Vec::new());
        Self { machine, cone_rad, runs, links, last: None, gap: false, rapid: false, gaps: Vec::new() }
    }

    /// The next point; one that is not singular must have a state.
    pub fn add(&mut self, node: Node) {
        self.rapid |= node.rapid;
        let start = self.links.len();
        if node.singular {
            self.gap = true;
            return self.close(start);
        }
        if self.gap {
            self.gaps.push(Gap { axis: node.axis, rapid: self.rapid });
        }
        let cost = match &self.last {
            None => {
                self.links.extend(node.states.iter().map(|s| Link { slot: s.slot, from: 0 }));
                let first = |s: &State| START_COST * (s.rotary_rad[0].abs() + s.rotary_rad[1].abs());
                node.states.iter().map(first).collect()
            }
            Some((before, cost)) => {
                let ends = (&before.axis, &node.axis);
                let step = Step::between(self.machine, ends, (self.gap, self.rapid), self.cone_rad);
                let mut next = Vec::with_capacity(node.states.len());
                for to in &node.states {
                    let mut best = (f64::INFINITY, 0u8);
                    for ((s, c), i) in before.states.iter().zip(cost).zip(0u8..) {
                        let total = c + step.cost_s(self.machine, s, to);
                        if total < best.0 {
                            best = (total, i);
                        }
                    }
                    next.push(best.0);
                    self.links.push(Link { slot: to.slot, from: best.1 });
                }
                next
            }
        };
        self.last = Some((node, cost));
        (self.gap, self.rapid) = (false, false);
        self.close(start);
    }

    /// Makes the links from `start` on a point of the last run, or a run of their own.
    fn close(&mut self, start: usize) {
        let count = self.links.len() - start;
        if let Some(run) = self.runs.last_mut() {
            let (at, n) = run.links;
            if n == count && self.links[at..at + n] == self.links[start..] {
                run.points += 1;
                self.links.truncate(start);
                return;
            }
        }
        self.runs.push(Run { points: 1, links: (start, count) });
    }

    /// The cheapest way.
    pub fn finish(self) -> Slots {
        let cost = self.last.map(|(_, cost)| cost).unwrap_or_default();
        let mut at = cost.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i);
        let mut slots = Slots { runs: Vec::new(), gaps: self.gaps };
        for run in self.runs.iter().rev() {
            let links = &self.links[run.links.0..run.links.0 + run.links.1];
            let mut left = run.points;
            if links.is_empty() {
                slots.push(left, NO_SLOT);
                continue;
            }
            while left > 0 {
                let link = links[at];
                let here = if usize::from(link.from) == at { left } else { 1 };
                slots.push(here, link.slot);
                left -= here;
                at = usize::from(link.from);
            }
        }
        slots.runs.reverse();
        slots
    }
}

/// The chosen slot of every point: runs of equal ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slots {
    /// Points and their slot, in the order of the path.
    pub runs: Vec<(usize, u8)>,
    /// What comes after each run of singular points; nothing after one at the end of the path.
    pub gaps: Vec<Gap>,
}

/// The regular point behind a run of singular ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    /// Its tool axis in the table's frame.
    pub axis: Unit3,
    /// A rapid move leads to it, or to one of the singular points.
    pub rapid: bool,
}

impl Slots {
    fn push(&mut self, points: usize, slot: u8) {
        match self.runs.last_mut() {
            Some(last) if last.1 == slot => last.0 += points,
            _ => self.runs.push((points, slot)),
        }
    }
}

/// What the way between two points allows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    rapid: bool,
    through_pole: bool,
}

impl Step {
    /// Between the axes of two regular points, where singular points (`gap`) or a rapid move may lie between.
    pub fn between(
        machine: &Machine,
        ends: (&Unit3, &Unit3),
        (gap, rapid): (bool, bool),
        cone_rad: f64,
    ) -> Self {
        let (a, b) = ends;
        let through_pole = gap
            || machine.pair().is_some_and(|p| {
                let pole = p.pole();
                // Far from the pole, told without angles: the sine is below the angle, and the arc below pi / 2 chords.
                let cosine = a.dot(&pole).abs().max(b.dot(&pole).abs());
                let chord = (b.into_inner() - a.into_inner()).norm();
                let least = (1.0 - cosine * cosine).max(0.0).sqrt() - std::f64::consts::FRAC_PI_2 * chord;
                if least > cone_rad {
                    return false;
                }
                least_angle(a, b, &pole).min(least_angle(a, b, &-pole)) <= cone_rad
            });
        Self { rapid, through_pole }
    }

    pub fn needs_rewind(self, machine: &Machine, a: &State, b: &State) -> bool {
        let turned = machine.rotary().iter().enumerate().any(|(k, &place)| {
            let d = (b.rotary_rad[k] - a.rotary_rad[k]).abs();
            // Half a turn is the most that a continuous axis can ask of a joint between neighbours.
            !machine.joint_at(place).is_endless() && d > std::f64::consts::PI + 1e-6
        });
        turned || (a.branch != b.branch && !self.through_pole)
    }

    fn cost_s(self, machine: &Machine, a: &State, b: &State) -> f64 {
        let mut cost = 0.0;
        for (k, &place) in machine.rotary().iter().enumerate() {
            let joint = machine.joint_at(place);
            let mut d = b.rotary_rad[k] - a.rotary_rad[k];
            if joint.is_endless() {
                d = nearest_turn(d, 0.0);
            }
            cost += d.abs() / joint.drive.velocity_per_s;
        }
        if self.needs_rewind(machine, a, b) {
            cost += if self.rapid { RAPID_REWIND_COST_S } else { REWIND_COST_S };
        }
        cost
    }
}

/// The least angle between `pole` and the arc of a great circle from `a` to `b`.
fn least_angle(a: &Unit3, b: &Unit3, pole: &Unit3) -> f64 {
    let normal = a.cross(b);
    let ends = angle_between(a, pole).min(angle_between(b, pole));
    let Some(n) = Unit3::try_new(normal, 1e-12) else { return ends };
    let foot = pole.into_inner() - n.into_inner() * n.dot(pole);
    let between = a.cross(&foot).dot(&n) >= 0.0 && foot.cross(b).dot(&n) >= 0.0;
    if between { n.dot(pole).abs().min(1.0).asin() } else { ends }
}
