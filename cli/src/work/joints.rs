//! The figures of a program's joints, as files and screens have them.

use crate::words::number;
use osculate_postproc::motion::JointDemand;
use serde::Serialize;
use std::collections::BTreeMap;

/// The `joints` object of `summary.json`, of `verify --json` and of `time --json`, all of feed moves. Blocks are lines of the program.
///
/// A block is slowed where a joint at its greatest speed is slower than the feed of the job, or of `time` than the program's F.
#[derive(Debug, Serialize, Clone, PartialEq)]
#[non_exhaustive]
pub struct JointFigures {
    /// How far each rotary joint turns in one block at most.
    pub largest_step_deg: BTreeMap<String, f64>,
    /// In which block; 0 where it rests in all of them.
    pub largest_step_block: BTreeMap<String, usize>,
    /// Blocks.
    pub blocks: usize,
    /// Those of them that a joint slows.
    pub slowed_blocks: usize,
    /// Their share of the time of all of them.
    pub slowed_share_of_time: f64,
    /// The feed asked for over the real one, where that is greatest; absent where no joint slows a block.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slowest_ratio: Option<f64>,
    /// The block in which it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slowest_block: Option<usize>,
    /// The joint that holds it up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slowest_joint: Option<String>,
}

impl JointFigures {
    /// Of what feed moves ask.
    #[must_use]
    pub fn of(demand: &JointDemand) -> Self {
        let steps = || demand.largest_steps.iter();
        let slowest = demand.slowest.as_ref();
        Self {
            largest_step_deg: steps().map(|s| (s.letter.clone(), s.step_rad.to_degrees())).collect(),
            largest_step_block: steps().map(|s| (s.letter.clone(), s.line)).collect(),
            blocks: demand.blocks,
            slowed_blocks: demand.slowed_blocks,
            slowed_share_of_time: demand.slowed_share(),
            slowest_ratio: slowest.map(|s| s.ratio),
            slowest_block: slowest.map(|s| s.line),
            slowest_joint: slowest.map(|s| s.letter.clone()),
        }
    }

    /// The largest steps in words, by joint; nothing where no rotary joint turns.
    #[must_use]
    pub fn steps(&self) -> Vec<(&str, String)> {
        let turning = self.largest_step_deg.iter().filter(|(_, deg)| **deg > 0.0);
        turning
            .map(|(letter, deg)| {
                let block = self.largest_step_block.get(letter).copied().unwrap_or(0);
                (letter.as_str(), format!("{} deg in block {block}", number(*deg, 3)))
            })
            .collect()
    }

    /// What is slowed in words.
    #[must_use]
    pub fn slowed(&self) -> String {
        let share = 100.0 * self.slowed_share_of_time;
        let all = format!("{} of {} blocks ({share:.1} % of their time)", self.slowed_blocks, self.blocks);
        match (self.slowest_ratio, self.slowest_block, &self.slowest_joint) {
            (Some(ratio), Some(block), Some(joint)) => {
                format!("{all}, at worst {ratio:.1} times by {joint} in block {block}")
            }
            _ => all,
        }
    }

    /// All of it in a line; none where no rotary joint turns and nothing is slowed.
    #[must_use]
    pub fn words(&self) -> Option<String> {
        let steps: Vec<String> = self
            .steps()
            .into_iter()
            .map(|(letter, step)| format!("{letter} turns by up to {step}"))
            .collect();
        if steps.is_empty() && self.slowed_blocks == 0 {
            return None;
        }
        let slowed = if self.slowed_blocks == 0 {
            "no block is slower than asked".to_owned()
        } else {
            format!("slower than asked {}", self.slowed())
        };
        Some(format!("joints: {}", steps.into_iter().chain([slowed]).collect::<Vec<_>>().join("; ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_postproc::motion::{LargestStep, SlowestBlock};

    #[test]
    fn figures_and_words() {
        let step = |letter: &str, deg: f64, line| LargestStep {
            letter: letter.to_owned(),
            step_rad: deg.to_radians(),
            line,
        };
        let mut demand = JointDemand {
            largest_steps: vec![step("C", 2.25, 12), step("A", 0.0, 0)],
            blocks: 40,
            slowed_blocks: 10,
            time_min: 2.0,
            slowed_min: 0.25,
            slowest: Some(SlowestBlock { ratio: 4.41, letter: "C".to_owned(), line: 31 }),
            ..JointDemand::default()
        };
        let figures = JointFigures::of(&demand);
        let json = serde_json::to_value(&figures).expect("plain values");
        assert_eq!(json["largest_step_block"], serde_json::json!({ "A": 0, "C": 12 }));
        assert!((json["largest_step_deg"]["C"].as_f64().expect("a number") - 2.25).abs() < 1e-12);
        assert_eq!((&json["slowed_share_of_time"], &json["slowest_block"]), (&0.125.into(), &31.into()));
        let words = "joints: C turns by up to 2.25 deg in block 12; slower than asked 10 of 40 blocks (12.5 % of their time), at \
                     worst 4.4 times by C in block 31";
        assert_eq!(figures.words().as_deref(), Some(words));
        (demand.slowed_blocks, demand.slowed_min, demand.slowest) = (0, 0.0, None);
        let words = "joints: C turns by up to 2.25 deg in block 12; no block is slower than asked";
        assert_eq!(JointFigures::of(&demand).words().as_deref(), Some(words));
        // A machine without rotary joints that is fast enough has nothing to tell.
        demand.largest_steps.clear();
        assert_eq!(JointFigures::of(&demand).words(), None);
    }
}
