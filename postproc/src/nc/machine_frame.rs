//! Moves to places of the machine's own frame: `G53`, `SUPA`, `M91`, and `G28` by way of a point to the home.
//!
//! The control's own coordinate of a joint is the joint's value less the value at which it reads zero
//! ([`crate::machine::Joint::own_zero`]), of slides at the spindle nose: G53 of Fanuc and LinuxCNC, M91 and SUPA with D0 leave the tool's
//! length out, so the tip of the tool in hand is that much beyond. All
//! joints that are not named stay, also with tool-centre-point control or in a tilted plane, where X Y Z mean
//! something else: what they are afterwards follows from the joints.

use super::Dialect;
use super::asked::Asked;
use super::event::Sink;
use super::interpret::Interpreter;
use super::read_error::ReadError;
use super::state::Known;
use super::token::Manner;
use crate::machine::{JointKind, JointValues, nearest_turn};

impl<S: Sink> Interpreter<'_, S> {
    /// An axis goes to a place that is not known.
    const fn sent(&mut self, line: usize) {
        if self.placed {
            self.record.sent.again(line);
        } else {
            self.record.sent_first.again(line);
        }
    }

    /// Where the named joints go, by their places; `None` where that is not known.
    fn own_targets(&mut self, line: usize, asked: &Asked) -> Result<Vec<(usize, Option<f64>)>, ReadError> {
        let mut targets = Vec::with_capacity(asked.axes.len());
        for (name, value, manner) in &asked.axes {
            let Some(place) = self.machine.joint_named(name) else {
                self.refuse(line, &format!("{name} in the machine's own coordinates"))?;
                continue;
            };
            if *manner == Manner::Incremental {
                self.refuse(line, &format!("an increment of {name} in the machine's own coordinates"))?;
            }
            let joint = &self.machine.joints()[place];
            let value = match joint.kind {
                JointKind::Linear => value * self.state.unit_mm,
                JointKind::Rotary => value.to_radians(),
            };
            let zero = joint.own_zero().filter(|_| !asked.builders_place);
            let told = joint.machine_zero.is_some() || joint.letter == "Z";
            if joint.kind == JointKind::Linear && zero.is_some() && !told {
                self.record.guessed.again(line);
            }
            if zero.is_none() {
                self.sent(line);
            }
            targets.push((place, zero.map(|zero| joint.word_at(value + zero, self.setup.gauge_length_mm))));
        }
        Ok(targets)
    }

    /// Home of the named joints, or of all where none is named.
    fn home_targets(&mut self, line: usize, asked: &Asked) -> Vec<(usize, Option<f64>)> {
        let joints = self.machine.joints();
        let named = |letter: &String| asked.axes.is_empty() || asked.axes.iter().any(|a| a.0 == *letter);
        let mut targets = Vec::new();
        for (place, joint) in joints.iter().enumerate().filter(|(_, j)| named(&j.letter)) {
            let home = joint.home.zip(joint.own_zero()).map(|(home, zero)| home + zero);
            if home.is_none() {
                self.sent(line);
            }
            targets.push((place, home.map(|home| joint.word_at(home, self.setup.gauge_length_mm))));
        }
        targets
    }

    /// A move in the machine's own coordinates.
    pub(super) fn go_in_own_frame(&mut self, line: usize, asked: &Asked) -> Result<(), ReadError> {
        let targets = self.own_targets(line, asked)?;
        let rapid = self.rapid(line)?;
        self.go_to_joints(line, &targets, (rapid, asked))
    }

    /// From where the machine is now to its home.
    pub(super) fn go_home(&mut self, line: usize, asked: &Asked) -> Result<(), ReadError> {
        let targets = self.home_targets(line, asked);
        self.go_to_joints(line, &targets, (true, asked))
    }

    fn go_to_joints(
        &mut self,
        line: usize,
        targets: &[(usize, Option<f64>)],
        manner: (bool, &Asked),
    ) -> Result<(), ReadError> {
        let (machine, setup) = (self.machine, &self.setup);
        let before = self.state.known(machine);
        let from = before.and_then(|k| k.joints(machine, setup)).filter(|_| self.state.of_tip());
        let manner = (Some(manner.0), manner.1);
        let (Some(from), true) = (from, targets.iter().all(|t| t.1.is_some())) else {
            self.note_targets(targets);
            let to = self.state.known(machine);
            return self.arrive(line, (before, to), manner);
        };
        let mut to: JointValues = from;
        for (place, value) in targets {
            to[*place] = value.map_or(from[*place], |v| self.turned(*place, v, Some(from[*place])));
        }
        self.state.stand_at(&to, machine, setup);
        let at = |joints: &JointValues| Some(Known::of_joints(machine, joints));
        self.arrive(line, (at(&from), at(&to)), manner)
    }

    /// The turn of an endless axis at which the control reaches an angle.
    fn turned(&self, place: usize, value: f64, before: Option<f64>) -> f64 {
        match before {
            Some(b) if self.dialect != Dialect::LinuxCnc && self.machine.joints()[place].is_endless() => {
                nearest_turn(value, b)
            }
            _ => value,
        }
    }

    /// Enters the joints that are known one by one. With X Y Z of the tip none of them is known unless all are.
    fn note_targets(&mut self, targets: &[(usize, Option<f64>)]) {
        for (place, value) in targets {
            if let Some(slot) = self.machine.rotary().iter().position(|r| r == place) {
                let before = self.state.rotary[slot];
                self.state.rotary[slot] = value.map(|v| self.turned(*place, v, before));
            } else if self.state.of_tip() {
                self.state.linear = [None; 3];
            } else if let Some(slot) = self.machine.linear().iter().position(|l| l == place) {
                self.state.linear[slot] = *value;
            }
        }
    }
}
