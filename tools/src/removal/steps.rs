//! Operations of a program, each judged when it ends.
//!
//! An operation that finishes some of the faces of the whole goal is judged on the same samples, as they are when its last motion is made:
//! nothing is measured twice. One whose faces are not those of the whole, such as a roughing that is judged outside by its allowance,
//! has samples of its own. Either way it is not looked at between samples, as the whole is.

use super::conclude::{Closing, check, concluded, looked_at};
use super::goal::{Goal, Program};
use super::job::{Change, Cut, Sample};
use super::trial::{ProveError, Sampled, Trial, changes_of, unbounded};
use super::verdict::{StockFound, Verdict};
use std::ops::Range;

/// Samples of an operation at which tooth marks are looked for: what they are at is told, not bounded.
const MARKED: usize = 100_000;

/// An operation of a program.
pub struct GoalStep<'a> {
    /// What must be so when it ends, with the tools of the program up to there. Of a roughing those of the motions from `from` on.
    pub goal: Goal<'a>,
    /// Its motions in the whole program.
    pub motions: Range<usize>,
    /// The first motion by which a roughing is judged: that of the first of the roughings that lead up to it and leave no less.
    pub from: usize,
}

/// Where a face of the whole goal is among those of a step: its number there, and whether it is to be machined.
type Seat = Option<(u32, bool)>;

impl GoalStep<'_> {
    /// Whether it is a roughing, judged by the roughings up to it alone: faces that are finished already have no allowance any more.
    const fn is_alone(&self) -> bool {
        self.goal.roughing_mm.is_some()
    }

    /// The first motion by which it is judged.
    const fn begin(&self) -> usize {
        if self.is_alone() { self.from } else { 0 }
    }

    /// Where the faces of the whole goal are in the step; None where it has samples of its own.
    pub(super) fn seats(&self, whole: &Goal<'_>) -> Option<Vec<Seat>> {
        let known = |name: &str| whole.machined.iter().any(|f| f.name == name);
        if self.is_alone() || !self.goal.machined.iter().all(|f| known(f.name)) {
            return None;
        }
        let first = self.goal.machined.len();
        let seat = |name: &str| {
            let machined = self.goal.machined.iter().position(|f| f.name == name).map(|k| (k as u32, true));
            let checked = || self.goal.checked.iter().position(|f| f.name == name);
            machined.or_else(|| checked().map(|k| ((first + k) as u32, false)))
        };
        Some(whole.machined.iter().chain(&whole.checked).map(|f| seat(f.name)).collect())
    }

    /// What of the program it is judged by.
    fn stretch<'p>(&self, program: &Program<'p>, changes: &'p [usize]) -> Program<'p> {
        let begin = self.begin();
        let motions = &program.motions[begin..self.motions.end];
        let times_min =
            if program.times_min.is_empty() { &[][..] } else { &program.times_min[begin..self.motions.end] };
        Program { motions, times_min, changes }
    }

    /// Changes of tools in what it is judged by, counted from its first motion.
    fn changes(&self, program: &Program<'_>) -> Vec<usize> {
        let begin = self.begin();
        let within = |c: &&usize| **c > begin && **c < self.motions.end;
        program.changes.iter().filter(within).map(|c| c - begin).collect()
    }

    /// The verdict by the samples of the whole goal, as they are now.
    pub(super) fn on_samples_of_all(
        &self,
        (program, seats): (&Program<'_>, &[Seat]),
        (sampled, cuts): (&Sampled, &[Cut]),
        stock: Option<StockFound>,
    ) -> Result<Verdict, ProveError> {
        let changes = self.changes(program);
        let program = self.stretch(program, &changes);
        check(&self.goal, &program)?;
        let tools = changes_of(&self.goal, &program, &[]);
        let trial = Trial::new(&self.goal, program, &tools);
        let (own, cuts) = taken(sampled, cuts, seats);
        let look = trial.seen(own, cuts)?;
        let marks = trial.marks(&look.measured, MARKED)?;
        let stock = stock.map(|found| found.deeper_than(trial.limits.collision_mm));
        let closing =
            Closing { coarse: false, refined: unbounded(), open_mm2: 0.0, stock, notes: Vec::new() };
        let crest_median_mm = trial.crests(&look.measured)?;
        Ok(concluded(&trial, look, (&marks, crest_median_mm), closing))
    }

    /// The verdict by samples of its own.
    pub(super) fn on_its_own(
        &self,
        program: &Program<'_>,
        stock: Option<StockFound>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Verdict, ProveError> {
        let changes = self.changes(program);
        let program = self.stretch(program, &changes);
        check(&self.goal, &program)?;
        let tools: Vec<Change<'_>> = changes_of(&self.goal, &program, &[]);
        let trial = Trial::new(&self.goal, program, &tools);
        let stock = stock.map(|found| found.deeper_than(trial.limits.collision_mm));
        looked_at(&trial, stock, progress)
    }
}

/// Of the samples of the whole goal those on the faces of a step; of those on faces that it does not machine the ones that were harmed.
fn taken(sampled: &Sampled, cuts: &[Cut], seats: &[Seat]) -> (Sampled, Vec<Cut>) {
    let mut out =
        Sampled { samples: Vec::new(), patches: Vec::new(), density: sampled.density, lost: Vec::new() };
    let mut left = Vec::new();
    let all = sampled.samples.iter().zip(&sampled.patches).zip(cuts);
    for ((sample, patch), cut) in all {
        let Some((face, machined)) = seats[sample.face as usize] else { continue };
        let cut = if machined { Some(*cut) } else { harm(cut) };
        if let Some(cut) = cut {
            out.samples.push(Sample { face, check_only: !machined, ..*sample });
            out.patches.push(*patch);
            left.push(cut);
        }
    }
    (out, left)
}

/// What was taken below a place that is not to be machined; None where nothing was. What stood above it does not count.
fn harm(cut: &Cut) -> Option<Cut> {
    if cut.standoff_mm >= 0.0 {
        return None;
    }
    let below = |t: super::Touch| super::Touch { removed_mm: t.removed_mm.min(-cut.standoff_mm), ..t };
    Some(Cut { rapid: cut.rapid.map(below), holder: cut.holder.map(below), ..*cut })
}
