//! The rotary joints of every point, once branch and turn are known: piece by piece, in the order of the path.

use osculate_geom::Unit3;
use osculate_tools::cl::{ClMove, Motion};
use rayon::prelude::*;

use crate::machine::{Machine, nearest_turn};
use crate::sequence::{NO_SLOT, Slots, State, Step, all_turns};
use crate::setup::Setup;

/// The choice at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Rotary joints, endless ones counted on.
    pub rotary_rad: [f64; 2],
    /// Branch; of the next regular point inside the cone.
    pub branch: usize,
    /// The way here from the point before needs a rewind.
    pub rewind: bool,
    /// Inside the singular cone.
    pub singular: bool,
}

/// A regular point with its choice.
#[derive(Clone, Copy, Debug)]
struct Chosen {
    index: usize,
    axis: Unit3,
    state: State,
    choice: Choice,
}

/// Goes along the path.
pub(crate) struct Choices<'a> {
    pub machine: &'a Machine,
    pub setup: &'a Setup,
    cone_rad: f64,
    slots: &'a Slots,
    /// The run of slots that is next, and how many of its points have been taken.
    at: (usize, usize),
    /// The gap that is next.
    gap: usize,
    index: usize,
    before: Option<Chosen>,
    /// The regular point behind the singular ones that are being passed.
    after: Option<Chosen>,
}

impl<'a> Choices<'a> {
    pub fn new(machine: &'a Machine, setup: &'a Setup, (slots, cone_rad): (&'a Slots, f64)) -> Self {
        Self { machine, setup, cone_rad, slots, at: (0, 0), gap: 0, index: 0, before: None, after: None }
    }

    /// The choices of the next points of the path.
    pub fn next_piece(&mut self, moves: &[ClMove]) -> Vec<Choice> {
        let most = moves.len();
        let mut slots: Vec<u8> = Vec::with_capacity(most);
        let mut at = self.at;
        while slots.len() < most && at.0 < self.slots.runs.len() {
            let (points, slot) = self.slots.runs[at.0];
            let take = (points - at.1).min(most - slots.len());
            slots.extend(std::iter::repeat_n(slot, take));
            at.1 += take;
            if at.1 == points {
                at = (at.0 + 1, 0);
            }
        }
        let states: Vec<Option<(Unit3, State)>> = slots
            .par_iter()
            .zip(moves)
            .with_min_len(2048)
            .map(|(slot, m)| {
                (*slot != NO_SLOT).then(|| {
                    let axis = self.setup.to_table(&m.pose).axis;
                    (axis, self.state(&axis, *slot))
                })
            })
            .collect();
        let mut choices = Vec::with_capacity(slots.len());
        for (found, m) in states.into_iter().zip(moves) {
            let rapid = m.motion == Motion::Rapid;
            choices.push(match found {
                Some((axis, state)) => {
                    let chosen = match self.after.take() {
                        Some(after) => after,
                        None => self.regular(self.index, axis, state, rapid),
                    };
                    self.before = Some(chosen);
                    chosen.choice
                }
                None => self.in_cone(&self.setup.to_table(&m.pose).axis),
            });
            self.index += 1;
            self.at.1 += 1;
            if self.at.1 == self.slots.runs[self.at.0].0 {
                self.at = (self.at.0 + 1, 0);
            }
        }
        choices
    }

    /// The state that was chosen for an axis of the table's frame.
    fn state(&self, axis: &Unit3, slot: u8) -> State {
        let found = self.machine.orientations(axis).expect("the search has found states here");
        let state = all_turns(self.machine, &found).into_iter().nth(usize::from(slot));
        state.expect("the search has found this state here")
    }

    /// `rapid`: a rapid move lies between the regular point before and this one.
    fn regular(&self, index: usize, axis: Unit3, state: State, rapid: bool) -> Chosen {
        let mut choice =
            Choice { rotary_rad: state.rotary_rad, branch: state.branch, rewind: false, singular: false };
        if let Some(before) = &self.before {
            let gap = index > before.index + 1;
            let step = Step::between(self.machine, (&before.axis, &axis), (gap, rapid), self.cone_rad);
            choice.rewind = step.needs_rewind(self.machine, &before.state, &state);
            for (k, &place) in self.machine.rotary().iter().enumerate() {
                if self.machine.joint_at(place).is_endless() {
                    choice.rotary_rad[k] = nearest_turn(choice.rotary_rad[k], before.choice.rotary_rad[k]);
                }
            }
        }
        Chosen { index, axis, state, choice }
    }

    /// Gives a point inside the cone an outer joint: linear between the regular neighbours over the count of points,
    /// held at the ends of the path; the inner joint then points the tool best.
    fn in_cone(&mut self, axis: &Unit3) -> Choice {
        let i = self.index;
        if self.after.is_none() {
            let run = self.slots.runs[self.at.0].0 - self.at.1;
            if let (Some(&(_, slot)), Some(gap)) =
                (self.slots.runs.get(self.at.0 + 1), self.slots.gaps.get(self.gap))
            {
                let state = self.state(&gap.axis, slot);
                self.after = Some(self.regular(i + run, gap.axis, state, gap.rapid));
                self.gap += 1;
            }
        }
        let (outer, near, branch) = match (&self.before, &self.after) {
            (Some(a), Some(b)) if !b.choice.rewind => {
                let t = (i - a.index) as f64 / (b.index - a.index) as f64;
                let (p, q) = (a.choice.rotary_rad, b.choice.rotary_rad);
                let lerp = |k: usize| p[k] + (q[k] - p[k]) * t;
                (lerp(0), lerp(1), a.choice.branch)
            }
            (Some(c), _) | (None, Some(c)) => {
                (c.choice.rotary_rad[0], c.choice.rotary_rad[1], c.choice.branch)
            }
            (None, None) => {
                let joint = self.machine.joint_at(self.machine.rotary()[0]);
                let rest = 0f64
                    .max(joint.min.unwrap_or(0.0))
                    .min(joint.max.unwrap_or(0.0).max(joint.min.unwrap_or(0.0)));
                (rest, 0.0, 0)
            }
        };
        let pair = self.machine.pair().expect("only a pair of rotary joints has poles");
        let place = self.machine.rotary()[1];
        let inner = self.machine.turned_near(place, pair.inner_for(outer, axis), near);
        Choice { rotary_rad: [outer, inner], branch, rewind: false, singular: true }
    }
}
