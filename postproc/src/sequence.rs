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
//! between the neighbours afterwards while the inner one follows the axis as well as it can.

use osculate_geom::Unit3;
use osculate_tools::cl::Motion;

use crate::machine::{Candidate, LIMIT_SLACK, Machine, angle_between, nearest_turn};

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
    /// How the point is reached.
    pub motion: Motion,
}

/// One choice at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    /// Rotary joints; endless ones in (-pi, pi].
    pub rotary_rad: [f64; 2],
    /// Branch.
    pub branch: usize,
}

/// The choice at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Rotary joints, endless ones counted on.
    pub rotary_rad: [f64; 2],
    /// Branch; of the next regular point inside the cone.
    pub branch: usize,
    /// The way here from the point before needs a rewind.
    pub rewind: bool,
}

/// Every turn of the candidate that the rotary limits allow.
pub(crate) fn turns(machine: &Machine, candidate: &Candidate) -> Vec<State> {
    let options = |slot: usize| -> Vec<f64> {
        let q = candidate.rotary_rad[slot];
        let Some(&place) = machine.rotary().get(slot) else { return vec![0.0] };
        let joint = machine.joint_at(place);
        if joint.is_endless() {
            return vec![q];
        }
        let all = (-MOST_TURNS..=MOST_TURNS).map(|k| q + f64::from(k) * std::f64::consts::TAU);
        all.filter(|q| joint.excess(*q) <= LIMIT_SLACK).collect()
    };
    let inner = options(1);
    let pairs = options(0).into_iter().flat_map(|a| inner.iter().map(move |b| [a, *b]));
    pairs.map(|rotary_rad| State { rotary_rad, branch: candidate.branch }).collect()
}

/// The cheapest states over the nodes. Every node that is not singular must have a state.
pub(crate) fn choose(machine: &Machine, nodes: &[Node], cone_rad: f64) -> Vec<Choice> {
    let regular: Vec<usize> = (0..nodes.len()).filter(|&i| !nodes[i].singular).collect();
    let mut picked = vec![Choice { rotary_rad: [0.0; 2], branch: 0, rewind: false }; nodes.len()];
    if let Some(&first) = regular.first() {
        let states = cheapest(machine, nodes, &regular, cone_rad);
        let mut last = states[0].rotary_rad;
        for (slot, (&node, state)) in regular.iter().zip(&states).enumerate() {
            let before = slot.checked_sub(1).map(|s| regular[s]);
            let step = before.map(|b| Step::between(machine, nodes, b, node, cone_rad));
            let rewind = step.is_some_and(|s| s.needs_rewind(machine, &states[slot - 1], state));
            let mut rotary_rad = state.rotary_rad;
            if node != first {
                for (k, &place) in machine.rotary().iter().enumerate() {
                    if machine.joint_at(place).is_endless() {
                        rotary_rad[k] = nearest_turn(rotary_rad[k], last[k]);
                    }
                }
            }
            last = rotary_rad;
            picked[node] = Choice { rotary_rad, branch: state.branch, rewind };
        }
    }
    fill_cone(machine, nodes, &regular, &mut picked);
    picked
}

fn cheapest(machine: &Machine, nodes: &[Node], regular: &[usize], cone_rad: f64) -> Vec<State> {
    let start = |s: &State| {
        let q = s.rotary_rad;
        START_COST * (q[0].abs() + q[1].abs())
    };
    let mut cost: Vec<f64> = nodes[regular[0]].states.iter().map(start).collect();
    let mut next: Vec<f64> = Vec::with_capacity(cost.len());
    // Where each state comes from, all nodes in one list.
    let mut from: Vec<usize> = Vec::with_capacity(2 * regular.len());
    let mut starts: Vec<usize> = Vec::with_capacity(regular.len());
    for pair in regular.windows(2) {
        let step = Step::between(machine, nodes, pair[0], pair[1], cone_rad);
        let before = &nodes[pair[0]].states;
        starts.push(from.len());
        next.clear();
        for to in &nodes[pair[1]].states {
            let mut best = (f64::INFINITY, 0);
            for (i, (s, c)) in before.iter().zip(&cost).enumerate() {
                let total = c + step.cost_s(machine, s, to);
                if total < best.0 {
                    best = (total, i);
                }
            }
            next.push(best.0);
            from.push(best.1);
        }
        std::mem::swap(&mut cost, &mut next);
    }
    let mut at = cost.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(i, _)| i);
    let mut states = vec![nodes[regular[regular.len() - 1]].states[at]];
    for (slot, start) in starts.iter().enumerate().rev() {
        at = from[start + at];
        states.push(nodes[regular[slot]].states[at]);
    }
    states.reverse();
    states
}

/// What the way between two points allows.
#[derive(Clone, Copy, Debug)]
struct Step {
    rapid: bool,
    through_pole: bool,
}

impl Step {
    fn between(machine: &Machine, nodes: &[Node], a: usize, b: usize, cone_rad: f64) -> Self {
        let rapid = nodes[a + 1..=b].iter().any(|n| n.motion == Motion::Rapid);
        let through_pole = b > a + 1
            || machine.pair().is_some_and(|p| {
                let pole = p.pole();
                least_angle(&nodes[a].axis, &nodes[b].axis, &pole).min(least_angle(
                    &nodes[a].axis,
                    &nodes[b].axis,
                    &-pole,
                )) <= cone_rad
            });
        Self { rapid, through_pole }
    }

    fn needs_rewind(self, machine: &Machine, a: &State, b: &State) -> bool {
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

/// Gives the points inside the cone an outer joint: linear between the regular neighbours over the count of points,
/// held at the ends of the path; the inner joint then points the tool best.
fn fill_cone(machine: &Machine, nodes: &[Node], regular: &[usize], picked: &mut [Choice]) {
    let Some(pair) = machine.pair() else { return };
    let mut next = 0;
    for i in 0..nodes.len() {
        if !nodes[i].singular {
            next += 1;
            continue;
        }
        let after = regular.get(next).map(|&n| (n, picked[n]));
        let before = next.checked_sub(1).map(|s| (regular[s], picked[regular[s]]));
        let (outer, near, branch) = match (before, after) {
            (Some((p, a)), Some((n, b))) if !b.rewind => {
                let t = (i - p) as f64 / (n - p) as f64;
                let lerp = |k: usize| a.rotary_rad[k] + (b.rotary_rad[k] - a.rotary_rad[k]) * t;
                (lerp(0), lerp(1), a.branch)
            }
            (Some((_, a)), _) => (a.rotary_rad[0], a.rotary_rad[1], a.branch),
            (None, Some((_, b))) => (b.rotary_rad[0], b.rotary_rad[1], b.branch),
            (None, None) => {
                let joint = machine.joint_at(machine.rotary()[0]);
                let rest = 0f64
                    .max(joint.min.unwrap_or(0.0))
                    .min(joint.max.unwrap_or(0.0).max(joint.min.unwrap_or(0.0)));
                (rest, 0.0, 0)
            }
        };
        let inner = machine.turned_near(machine.rotary()[1], pair.inner_for(outer, &nodes[i].axis), near);
        picked[i] = Choice { rotary_rad: [outer, inner], branch, rewind: false };
    }
}
