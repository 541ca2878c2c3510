//! What a control remembers between blocks, as far as the way of the tool depends on it.

use std::collections::BTreeSet;

use nalgebra::Isometry3;
use osculate_geom::{Unit3, Vec3};

use super::Dialect;
use crate::feed::{PathMetric, Step};
use crate::linearize::slerp;
use crate::machine::{JointValues, MAX_JOINTS, Machine};
use crate::setup::Setup;

/// How F is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FeedReading {
    PerMinute,
    PerTurn,
    Inverse,
}

/// Sinumerik's declaration of what F is read over.
#[derive(Clone, Debug, PartialEq, Default)]
pub(super) struct Group {
    pub letters: BTreeSet<String>,
    pub radius_mm: Option<f64>,
}

/// The state of the control.
#[derive(Clone, Debug)]
pub(super) struct State {
    pub dialect: Dialect,
    /// mm per unit of programmed length.
    pub unit_mm: f64,
    pub absolute: bool,
    /// Rapid, feed, or not yet said.
    pub rapid: Option<bool>,
    /// On an arc, and which way.
    pub clockwise: Option<bool>,
    /// Axes of the plane of arcs.
    pub arc_plane: [&'static str; 2],
    pub reading: FeedReading,
    pub feed: Option<f64>,
    /// mm per unit of length when F was said: a change of units leaves it alone.
    pub feed_unit_mm: f64,
    pub speed: Option<f64>,
    pub tcp: bool,
    /// The tilted plane: X Y Z of the tip in its axes.
    pub plane: Option<Isometry3<f64>>,
    /// The tool goes on a great circle from one direction to the next.
    pub great_circle: bool,
    /// I J K are a direction.
    pub vectors: bool,
    /// Programmed positions: linear in mm (in chain order, or X Y Z with tool-centre-point control), rotary in rad.
    pub linear: [Option<f64>; 3],
    pub rotary: [Option<f64>; 2],
    pub group: Option<Group>,
}

/// A place of which every axis is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    pub linear: [f64; 3],
    pub rotary: [f64; 2],
    /// X Y Z are of the tip.
    pub tcp: bool,
    /// In the axes of a tilted plane.
    pub plane: Option<Isometry3<f64>>,
    /// The tool's direction in the table's frame, where it and not the rotary axes is what goes evenly.
    pub axis: Option<Unit3>,
}

impl State {
    pub fn new(dialect: Dialect) -> Self {
        Self {
            dialect,
            unit_mm: 1.0,
            absolute: true,
            rapid: None,
            clockwise: None,
            arc_plane: ["X", "Y"],
            reading: FeedReading::PerMinute,
            feed: None,
            feed_unit_mm: 1.0,
            speed: None,
            tcp: false,
            plane: None,
            great_circle: false,
            vectors: false,
            linear: [None; 3],
            rotary: [None; 2],
            group: None,
        }
    }

    /// The place, once every axis of the machine has been named.
    pub fn known(&self, machine: &Machine) -> Option<Known> {
        let mut known =
            Known { linear: [0.0; 3], rotary: [0.0; 2], tcp: self.of_tip(), plane: self.plane, axis: None };
        for (to, from) in known.linear.iter_mut().zip(self.linear) {
            *to = from?;
        }
        for slot in 0..machine.rotary().len() {
            known.rotary[slot] = self.rotary[slot]?;
        }
        if self.great_circle && self.tcp {
            known.axis = Some(machine.axis_at(&known.rotary));
        }
        Some(known)
    }

    /// X Y Z are of the tip.
    pub const fn of_tip(&self) -> bool {
        self.tcp || self.plane.is_some()
    }

    /// Another plane, or none. What X Y Z are there is not known before they are named.
    pub fn tilt(&mut self, plane: Option<Isometry3<f64>>) {
        if self.plane != plane {
            self.plane = plane;
            self.linear = [None; 3];
        }
    }

    /// Turns tool-centre-point control on or off. The machine stands still; what X Y Z mean changes.
    pub fn switch_tcp(&mut self, on: bool, machine: &Machine, setup: &Setup) {
        if self.tcp == on {
            return;
        }
        let joints = self.known(machine).and_then(|k| k.joints(machine, setup));
        self.tcp = on;
        match joints.filter(|_| self.plane.is_none()) {
            None => self.linear = [None; 3],
            Some(q) => self.stand_at(&q, machine, setup),
        }
    }

    /// Another gauge length with the slides where they are: what X Y Z are for the new tip.
    pub fn take_length(&mut self, length_mm: f64, machine: &Machine, setup: &mut Setup) {
        let before_mm = setup.gauge_length_mm;
        if length_mm == before_mm {
            return;
        }
        let stands = self.known(machine).and_then(|k| k.joints(machine, setup));
        setup.gauge_length_mm = length_mm;
        let word = |place: usize, value: f64| {
            let joint = &machine.joints()[place];
            joint.word_at(joint.at_nose(value, before_mm), length_mm)
        };
        match stands {
            Some(mut joints) => {
                for place in machine.linear() {
                    joints[place] = word(place, joints[place]);
                }
                self.stand_at(&joints, machine, setup);
            }
            None if self.of_tip() => self.linear = [None; 3],
            None => {
                for (place, slot) in machine.linear().into_iter().zip(&mut self.linear) {
                    *slot = slot.map(|value| word(place, value));
                }
            }
        }
    }

    /// The machine stands at these joints: what X Y Z and the rotary words are there.
    pub fn stand_at(&mut self, joints: &JointValues, machine: &Machine, setup: &Setup) {
        for (slot, place) in machine.rotary().iter().enumerate() {
            self.rotary[slot] = Some(joints[*place]);
        }
        self.linear = if self.of_tip() {
            let xyz = setup.to_program(&machine.forward(joints, setup).tip);
            let xyz =
                self.plane.map_or(xyz, |plane| plane.rotation.inverse() * (xyz - plane.translation.vector));
            [Some(xyz.x), Some(xyz.y), Some(xyz.z)]
        } else {
            machine.linear().map(|place| Some(joints[place]))
        };
    }

    /// The metric over which F is read now.
    pub fn metric(&self, machine: &Machine) -> PathMetric {
        let own = self.dialect.feed_metric(machine);
        match &self.group {
            Some(group) => {
                let names = |place: &usize| group.letters.contains(&machine.joints()[*place].letter);
                let rotary = machine.rotary().iter().any(names);
                let linear = machine.linear().iter().any(names);
                match (linear, rotary) {
                    (true, true) => PathMetric::Arc { radius_mm: group.radius_mm.unwrap_or(own.radius_mm()) },
                    (false, true) => PathMetric::RotaryOnly,
                    _ => PathMetric::Linear,
                }
            }
            None if self.of_tip() => PathMetric::Linear,
            None => own,
        }
    }

    /// What F is fed along, in the program's unit of length, or degrees where only rotary axes count.
    fn path_over(&self, machine: &Machine, step: &Step) -> f64 {
        let metric = self.metric(machine);
        let degrees = match metric {
            PathMetric::Linear => step.linear_mm == 0.0,
            PathMetric::RotaryOnly => step.rotary_rad != [0.0; 2],
            PathMetric::Arc { .. } => false,
        };
        metric.length(step) / if degrees { 1.0 } else { self.feed_unit_mm }
    }

    /// Duration of a feed move, min; `None` where F or S is not known.
    pub fn duration_min(&self, machine: &Machine, step: &Step) -> Option<f64> {
        let feed = self.feed.filter(|f| *f > 0.0)?;
        match self.reading {
            FeedReading::Inverse => Some(1.0 / feed),
            FeedReading::PerMinute => Some(self.path_over(machine, step) / feed),
            FeedReading::PerTurn => {
                Some(self.path_over(machine, step) / (feed * self.speed.filter(|s| *s > 0.0)?))
            }
        }
    }
}

impl Known {
    /// A place in words of the joints.
    pub fn of_joints(machine: &Machine, joints: &JointValues) -> Self {
        let linear = machine.linear().map(|place| joints[place]);
        Self { linear, rotary: machine.rotary_of(joints), tcp: false, plane: None, axis: None }
    }

    /// The place between two of one kind.
    pub fn between(&self, to: &Self, t: f64) -> Self {
        let mut at = *self;
        for k in 0..3 {
            at.linear[k] += (to.linear[k] - self.linear[k]) * t;
        }
        for k in 0..2 {
            at.rotary[k] += (to.rotary[k] - self.rotary[k]) * t;
        }
        at.axis = self.axis.zip(to.axis).map(|(a, b)| slerp(&a, &b, t));
        at
    }

    /// By how much F's axes move.
    pub fn step_to(&self, to: &Self) -> Step {
        let d = Vec3::from(to.linear) - Vec3::from(self.linear);
        let rotary_rad = [to.rotary[0] - self.rotary[0], to.rotary[1] - self.rotary[1]];
        Step { linear_mm: d.norm(), rotary_rad }
    }

    /// Programmed X Y Z of the tip, out of the plane.
    pub fn tip(&self) -> Vec3 {
        let words = Vec3::from(self.linear);
        self.plane.map_or(words, |plane| plane.rotation * words + plane.translation.vector)
    }

    /// The joints at this place.
    pub fn joints(&self, machine: &Machine, setup: &Setup) -> Option<JointValues> {
        if self.tcp {
            let tip = setup.part_zero * setup.from_program(&self.tip());
            return machine.with_tip(&self.rotary, &tip, setup.gauge_length_mm);
        }
        let mut joints = [0.0; MAX_JOINTS];
        for (place, value) in machine.linear().into_iter().zip(self.linear) {
            joints[place] = value;
        }
        for (place, value) in machine.rotary().iter().zip(self.rotary) {
            joints[*place] = value;
        }
        Some(joints)
    }
}
