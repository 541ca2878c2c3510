//! A case of a sweep: its job, and what became of it.

use crate::failure::Failure;
use crate::job::{Job, Operations};
use crate::work::operations;
use crate::work::plan::{self, Plan, plan};
use crate::work::summary::Summary;
use crate::{Part, Watch};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A case with its job.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Case {
    /// From 1 on.
    pub number: usize,
    /// The job.
    pub text: String,
    /// Beside the job of the sweep.
    pub path: PathBuf,
    /// Of the job, the files that it names and the version of the program.
    pub key: String,
}

/// A job of one operation, or a list of them.
pub enum Work {
    /// Of one.
    One(Box<Job>),
    /// Of several.
    List(Box<Operations>),
}

impl Case {
    /// The job in which everything is checked that can be without its part.
    ///
    /// # Errors
    /// As [`Job::from_toml`] and [`Operations::from_toml`], and where another verb is for it.
    pub fn work(&self) -> Result<Work, Failure> {
        if Operations::are_in(&self.text) {
            return Ok(Work::List(Box::new(Operations::from_toml(&self.text, &self.path)?)));
        }
        let job = Job::from_toml(&self.text, &self.path)?;
        plan::check(&job)?;
        Ok(Work::One(Box::new(job)))
    }

    /// Plans and judges it.
    ///
    /// # Errors
    /// Where it cannot be planned as asked.
    pub fn plan(&self, watch: &dyn Watch) -> Result<Plan, Failure> {
        match self.work()? {
            Work::One(job) => plan(&Part::watched(&job, watch)?, &job, watch),
            Work::List(list) => {
                let (part, list) = operations::part(*list, watch)?;
                operations::plan(&part, &list, watch)
            }
        }
    }
}

/// What a case ended in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The case's number.
    pub case: usize,
    /// The case's key.
    pub key: String,
    /// `held`, `not_held`, `not_shown`, or `failed` where there is no plan.
    pub answer: String,
    /// Why it is not held, or why there is no plan.
    pub why: String,
    /// Of a plan.
    pub figures: Option<Figures>,
    /// How long it took, s.
    pub wall_s: f64,
}

/// The answer of a case without a plan.
pub const FAILED: &str = "failed";

/// Figures of a plan. What is not finite is absent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// The strategy by name.
    pub strategy: String,
    /// The tool in words.
    pub tool: String,
    /// Passes.
    pub passes: usize,
    /// CL points.
    pub points: usize,
    /// Numbers with their units, in the order of [`NAMES`].
    pub numbers: [Option<f64>; NAMES.len()],
}

/// What the numbers are.
pub const NAMES: [&str; 12] = [
    "time_min",
    "cutting_time_min",
    "control_time_min",
    "cutting_length_mm",
    "air_length_mm",
    "area_mm2",
    "ideal_min",
    "efficiency_percent",
    "height_mm",
    "gouge_mm",
    "uncut_mm2",
    "left_out_mm2",
];

impl Figures {
    /// Those of a plan.
    fn of(s: &Summary) -> Self {
        let v = &s.verification;
        let numbers = [
            Some(s.time_min),
            Some(s.cutting_time_min),
            s.control_time_min,
            Some(s.cutting_length_mm),
            Some(s.air_length_mm),
            Some(s.area_mm2),
            s.ideal.as_ref().map(|i| i.ideal.time_min),
            s.ideal.as_ref().map(|i| i.efficiency_percent),
            Some(v.height_max_mm),
            Some(v.gouge_max_mm),
            Some(v.uncut_area_mm2),
            Some(s.left_out.iter().map(|f| f.area_mm2).sum()),
        ];
        Self {
            strategy: s.strategy.clone(),
            tool: s.tool_words.clone(),
            passes: s.passes,
            points: s.points,
            // No minus before a zero, which is what an empty sum has.
            numbers: numbers.map(|x| x.filter(|x| x.is_finite()).map(|x| x + 0.0)),
        }
    }

    /// A number by its name; None where there is none.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        NAMES.iter().position(|n| *n == name).and_then(|k| self.numbers[k])
    }
}

impl Row {
    /// Of a case that was planned, or not.
    #[must_use]
    pub fn of(case: &Case, planned: Result<&Plan, &str>, wall_s: f64) -> Self {
        let (answer, why, figures) = match planned {
            Ok(plan) => {
                let s = &plan.summary;
                (s.verdict.answer, s.verdict.why.join("; "), Some(Figures::of(s)))
            }
            // Where the job lies is another place on another machine.
            Err(why) => (FAILED, why.replace(&format!("{}: ", case.path.display()), ""), None),
        };
        Self { case: case.number, key: case.key.clone(), answer: answer.to_owned(), why, figures, wall_s }
    }

    /// Whether the plan holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.answer == "held"
    }

    /// A number of the plan by its name.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        self.figures.as_ref()?.number(name)
    }
}

/// Bytes as a number, the same on every machine (Fowler, Noll and Vo, 64 bits).
#[derive(Debug, Clone, Copy)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Adds bytes, and that they end here.
    pub fn add(&mut self, bytes: &[u8]) {
        let mut one = |b: u8| self.0 = (self.0 ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3);
        bytes.iter().for_each(|b| one(*b));
        (bytes.len() as u64).to_le_bytes().into_iter().for_each(one);
    }

    /// The number.
    #[must_use]
    pub const fn value(self) -> u64 {
        self.0
    }

    /// The number as text.
    #[must_use]
    pub fn hex(self) -> String {
        format!("{:016x}", self.0)
    }
}
