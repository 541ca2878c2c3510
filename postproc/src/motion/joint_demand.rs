//! What the feed moves of a program ask of the joints: how far rotary ones turn in one block, and which blocks a joint makes slower.
//!
//! A block is slowed where a joint at its greatest speed needs longer than the feed asked for allows
//! ([`crate::feed::capped_duration`]), whether the program's F says so already or leaves it to the control. Speeding up and
//! slowing down are not in it.

use crate::feed::capped_duration;
use crate::machine::{JointValues, Machine};

/// A block counts as slowed where it takes longer than asked by this ratio: F and places are rounded in programs, which changes
/// the time of a short block by some thousandths.
const SLOWED_RATIO: f64 = 1.01;

/// A feed move of a program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FeedBlock {
    /// Line of the text, from 1.
    pub line: usize,
    /// Joints before.
    pub from: JointValues,
    /// Joints after.
    pub to: JointValues,
    /// How long it takes by its F, min.
    pub time_min: f64,
    /// How long it takes at the feed asked for, min; zero where the tip rests.
    pub asked_min: f64,
}

/// The largest step of a rotary joint.
#[derive(Clone, Debug, PartialEq)]
pub struct LargestStep {
    /// The joint.
    pub letter: String,
    /// How far it turns in that block, rad.
    pub step_rad: f64,
    /// The line of the block; 0 where the joint rests in all feed moves.
    pub line: usize,
}

/// The block that a joint slows most.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowestBlock {
    /// The feed asked for over the real one.
    pub ratio: f64,
    /// The joint that holds it up.
    pub letter: String,
    /// The line of the block.
    pub line: usize,
}

/// A block that a joint slows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlowedBlock {
    /// The line of the block.
    pub line: usize,
    /// The joint, as a place in [`JointDemand::letters`].
    pub joint: usize,
}

/// What the feed moves of a program ask of the joints.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct JointDemand {
    /// Of each rotary joint, outer first.
    pub largest_steps: Vec<LargestStep>,
    /// Feed moves.
    pub blocks: usize,
    /// Those of them that a joint makes slower than asked. A block in which the tip rests is one.
    pub slowed_blocks: usize,
    /// Time of all feed moves, min.
    pub time_min: f64,
    /// Time of those that a joint slows, min.
    pub slowed_min: f64,
    /// The one that is slowed most; none where no joint slows a block in which the tip moves.
    pub slowest: Option<SlowestBlock>,
    /// The letters of all joints of the machine, outer first.
    pub letters: Vec<String>,
    /// Every block that a joint slows, in the order of the program.
    pub slowed: Vec<SlowedBlock>,
}

impl JointDemand {
    /// Before the first feed move.
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        let rest = |&place: &usize| LargestStep {
            letter: machine.joint_at(place).letter.clone(),
            step_rad: 0.0,
            line: 0,
        };
        Self {
            largest_steps: machine.rotary().iter().map(rest).collect(),
            letters: machine.joints().iter().map(|j| j.letter.clone()).collect(),
            ..Self::default()
        }
    }

    /// Adds a feed move of a program for the machine.
    pub fn add(&mut self, machine: &Machine, block: &FeedBlock) {
        let FeedBlock { line, from, to, time_min, asked_min } = *block;
        for (largest, &place) in self.largest_steps.iter_mut().zip(machine.rotary()) {
            let step_rad = (to[place] - from[place]).abs();
            if step_rad > largest.step_rad {
                (largest.step_rad, largest.line) = (step_rad, line);
            }
        }
        let capped = capped_duration(machine, &from, &to, asked_min);
        let real_min = time_min.max(capped.duration_min);
        self.blocks += 1;
        self.time_min += real_min;
        let Some(place) = capped.joint.filter(|_| capped.duration_min > SLOWED_RATIO * asked_min) else {
            return;
        };
        self.slowed_blocks += 1;
        self.slowed.push(SlowedBlock { line, joint: place });
        self.slowed_min += real_min;
        let ratio = real_min / asked_min;
        if ratio.is_finite() && self.slowest.as_ref().is_none_or(|s| ratio > s.ratio) {
            let letter = machine.joint_at(place).letter.clone();
            self.slowest = Some(SlowestBlock { ratio, letter, line });
        }
    }

    /// Share of the time of all feed moves that goes into those that a joint slows; zero where there is none.
    #[must_use]
    pub fn slowed_share(&self) -> f64 {
        if self.time_min > 0.0 { self.slowed_min / self.time_min } else { 0.0 }
    }
}
