//! Finishing operations laid out again where the finished part is left a little too high: what verdicts add to what is measured, and what crests of
//! several operations leave together, is not known before.

use crate::job::{Job, Operation, OperationWord};
use crate::words::number;
use crate::work::choice;
use crate::work::operations::course::Course;
use crate::work::operations::step::Step;
use crate::work::verify::Verified;
use osculate_geom::Diagnostic;
use std::collections::{BTreeMap, BTreeSet};

/// Of what is left for scallops, what they are laid out for each time: more than so close to the limit takes verdicts long, or they do not come to
/// an end. (Tried on a mould, of which nine tenths are shown to hold and 0.97 are not.)
const LESS: [f64; 2] = [0.93, 0.93];

/// What is laid out again, by names of operations.
#[derive(Default)]
pub struct Again<'a> {
    /// The scallop that each is laid out for at most, mm.
    at_most_mm: BTreeMap<&'a str, f64>,
    /// Those that are to be laid out this time.
    asked: BTreeSet<&'a str>,
    /// Those that stay as they are.
    ready: BTreeMap<&'a str, Step<'a>>,
    /// What was left before each time and what may be, mm.
    times: Vec<[f64; 2]>,
}

impl<'a> Again<'a> {
    /// The scallop that an operation is laid out for at most, mm.
    pub fn at_most_mm(&self, operation: &Operation) -> Option<f64> {
        self.at_most_mm.get(operation.name.as_str()).copied()
    }

    /// An operation that stays as it is.
    pub fn ready(&mut self, operation: &Operation) -> Option<Step<'a>> {
        self.ready.remove(operation.name.as_str())
    }

    /// Whether some of the steps are to be laid out again as the finished part of `job` is judged so: those that left what is higher at a sample than the
    /// highest place will be.
    pub fn asks(&mut self, job: &Job, steps: &[Step<'a>], course: &Course, whole: &Verified) -> bool {
        let Some(why) = choice::objection(job, course.blend_mm(), whole) else { return false };
        let Some(less) =
            why.left.zip(LESS.get(self.times.len())).and_then(|(l, aim)| choice::less_of(l, *aim))
        else {
            return false;
        };
        let above_mm = less * whole.summary.scallop_max_mm;
        let mut leaves = vec![false; steps.len()];
        for (sample, cut) in whole.verdict.samples().iter().zip(whole.verdict.cuts()) {
            let by = cut.by.filter(|_| !sample.check_only && cut.standoff_mm > above_mm);
            if let Some(k) = by.and_then(|by| course.section_at(by.motion as usize)) {
                leaves[k] = true;
            }
        }
        self.asked.clear();
        let limit_mm = job.tolerance().scallop_mm;
        let asks = |step: &Step<'_>| is_laid_out(step) && may_leave_mm(step).is_some_and(|mm| mm <= limit_mm);
        for (step, _) in steps.iter().zip(leaves).filter(|(s, leaves)| *leaves && asks(s)) {
            self.at_most_mm.insert(&step.operation.name, less * step.job.tolerance().scallop_mm);
            self.asked.insert(&step.operation.name);
        }
        let any = !self.asked.is_empty();
        if any {
            // As the verdict counts it: with marks and blended corners, which stay.
            let stays_mm = why.left.map_or(0.0, |left| limit_mm - left.may_mm);
            self.times.push([why.left.map_or(0.0, |left| left.is_mm + stays_mm), limit_mm]);
        }
        any
    }

    /// Takes over what stays as it is: all but those that are laid out again, and what is cut of their rest.
    pub fn keep(&mut self, steps: Vec<Step<'a>>) {
        let mut changed = false;
        for step in steps {
            let name = step.operation.name.as_str();
            let again = self.asked.contains(name);
            let rest = changed && step.operation.kind == OperationWord::Rest;
            changed |= again;
            if !again && !rest {
                self.ready.insert(name, step);
            }
        }
    }

    /// What was laid out again, and why.
    pub fn notes(&self) -> Vec<Diagnostic> {
        let Some([first_mm, limit_mm]) = self.times.first() else { return Vec::new() };
        let each = self.at_most_mm.iter().map(|(name, mm)| format!("{name} for {} mm", number(*mm, 3)));
        let text = format!(
            "laid out again, as up to {} mm were left where {} mm are accepted: {}",
            number(*first_mm, 6),
            number(*limit_mm, 4),
            each.collect::<Vec<_>>().join(", ")
        );
        vec![Diagnostic::note("operations", text)]
    }
}

/// Whether passes of a step are as far apart as a scallop allows. What was chosen among many is shown to hold by itself, and for less another is chosen.
fn is_laid_out(step: &Step<'_>) -> bool {
    step.operation.kind != OperationWord::Rough && step.compared.is_empty()
}

/// What an operation may leave, mm: one that names more than the part may have leaves that for others, or on purpose.
fn may_leave_mm(step: &Step<'_>) -> Option<f64> {
    step.operation.judged().ok().map(|job| job.tolerance().scallop_mm)
}
