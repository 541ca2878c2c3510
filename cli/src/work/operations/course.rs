//! What the programs of a list of operations do, one after the other.

use crate::failure::Failure;
use crate::job::{Job, Operations};
use crate::part::Part;
use crate::work::goal::{Aim, Left};
use crate::work::nc::{self, Call};
use crate::work::operations::Judged;
use crate::work::verify::{self, Reading, Verified};
use crate::work::{posted_setup, reading, stock};
use osculate_geom::Diagnostic;
use osculate_postproc::Setup;
use osculate_tools::removal::stock::Stock;
use osculate_tools::removal::{GoalControl, GoalFixture, Program, Remark, Swept, carve};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Lengths this far apart are those of two tools, mm.
const APART_MM: f64 = 1e-3;

/// A program of one of the setups.
#[derive(Debug, Clone, Copy)]
pub struct Text<'a> {
    /// Where it is from, for messages.
    pub file: &'a Path,
    /// What stands in it.
    pub text: &'a str,
}

/// The motions of all programs in the part's frame, with the tools that make them.
#[derive(Default)]
pub struct Course {
    /// Straight pieces, each with its line in the program of its setup.
    pub motions: Vec<Swept>,
    /// Time at the end of each, min; the changes from setup to setup take none.
    pub times_min: Vec<f64>,
    /// Where the tools after the first take over.
    changes: Vec<usize>,
    /// The whole job with each tool in hand, in the order in which they are called.
    tools: Vec<Job>,
    speeds_rpm: Vec<Option<f64>>,
    control: GoalControl,
    /// The motions of each setup.
    pub setups: Vec<Range<usize>>,
    /// Time of each setup's program, min.
    pub setup_min: Vec<f64>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Where the part of a setup sits, as the head of its program says it.
fn place(job: &Job, part: &Part, text: &str) -> (Setup, Vec<Diagnostic>) {
    let dialect = job.control().dialect;
    let jobs = job.each_tool();
    let head = Setup::of_program(text, dialect).ok().flatten();
    // The head has the length of the tool that is called first.
    let is_first = |j: &&Job| head.is_some_and(|h| (nc::gauge_mm(j) - h.gauge_length_mm).abs() < APART_MM);
    let first = jobs.iter().find(is_first).unwrap_or(&jobs[0]);
    posted_setup::of_program(first, part, text, dialect)
}

impl Course {
    /// Reads the programs of all setups, in their order.
    ///
    /// # Errors
    /// Where there are more or fewer programs than setups, and where one cannot be read or calls a tool that the job has not.
    pub fn read(list: &Operations, part: &Part, texts: &[Text<'_>], lenient: bool) -> Result<Self, Failure> {
        let setups = list.setups();
        if texts.len() != setups.len() {
            let names: Vec<&str> = setups.iter().map(|s| s.name.as_str()).collect();
            let what = format!(
                "{} programs are given for {} setups: one for each of {}, in this order",
                texts.len(),
                setups.len(),
                names.join(", ")
            );
            return Err(Failure::file(list.path(), what));
        }
        let mut out = Self::default();
        for (setup, text) in setups.iter().zip(texts) {
            let job = &setup.job;
            let (place, notes) = place(job, part, text.text);
            let tools = job.each_tool();
            let read = nc::read_back_tools(text.text, (job, &tools), job.control(), &place, lenient)
                .map_err(|why| Failure::file(text.file, why))?;
            if read.motions.is_empty() {
                return Err(Failure::file(text.file, "has no motion: at least two positions are needed"));
            }
            out.diagnostics.extend(notes);
            out.diagnostics.extend(reading::meet(text.file, &read.motions, part)?);
            out.diagnostics.extend(read.diagnostics);
            let (begin, clock) = (out.motions.len(), out.times_min.last().copied().unwrap_or(0.0));
            out.take_calls(text.file, begin, &read.calls, &tools)?;
            out.motions.extend(read.motions);
            out.times_min.extend(read.times_min.iter().map(|t| t + clock));
            out.setups.push(begin..out.motions.len());
            out.setup_min.push(read.time_min);
            let prefix = if setups.len() > 1 { format!("{}: ", setup.name) } else { String::new() };
            let named = |r: Remark| Remark { text: format!("{prefix}{}", r.text), ..r };
            out.control.remarks.extend(read.control.remarks.into_iter().map(named));
            out.control.blend_mm = out.control.blend_mm.max(read.control.blend_mm);
            if out.control.words.is_empty() {
                out.control.words = read.control.words;
            }
        }
        Ok(out)
    }

    /// The tools of a program whose first motion is `begin`.
    fn take_calls(
        &mut self,
        file: &Path,
        begin: usize,
        calls: &[Call],
        tools: &[Job],
    ) -> Result<(), Failure> {
        let first = calls.iter().find_map(|c| c.number);
        for (k, call) in calls.iter().enumerate() {
            // What moves before a tool is called moves with the first.
            if call.number.is_none() && k == 0 && calls.len() > 1 {
                continue;
            }
            let number = call.number.or(first);
            let Some(tool) = tools.iter().find(|t| number.is_none() || Some(t.tool().number()) == number)
            else {
                let have: Vec<String> = tools.iter().map(|t| t.tool().number().to_string()).collect();
                let what = format!(
                    "calls T{}, but the tools of the job are {}",
                    number.unwrap_or_default(),
                    have.join(", ")
                );
                return Err(Failure::file(file, what));
            };
            let at = if self.tools.is_empty() || (k == 1 && calls[0].number.is_none()) {
                begin
            } else {
                begin + call.first
            };
            if !self.tools.is_empty() {
                self.changes.push(at);
            }
            self.tools.push(tool.clone());
            self.speeds_rpm.push(call.spindle_rpm);
        }
        Ok(())
    }

    /// Tools, changes and motions of a stretch.
    fn stretch(&self, Range { start, end }: Range<usize>) -> Stretch<'_> {
        let first = self.changes.partition_point(|c| *c <= start);
        let last = self.changes.partition_point(|c| *c < end).max(first);
        let clock = if start == 0 { 0.0 } else { self.times_min[start - 1] };
        Stretch {
            motions: &self.motions[start..end],
            times_min: self.times_min[start..end].iter().map(|t| t - clock).collect(),
            changes: self.changes[first..last].iter().map(|c| c - start).collect(),
            tools: &self.tools[first..=last],
            speeds_rpm: &self.speeds_rpm[first..=last],
        }
    }

    /// What holds the part during a stretch, each while its setup lasts.
    fn fixtures(
        &self,
        list: &Operations,
        part: &Part,
        stretch: &Range<usize>,
    ) -> Result<Vec<GoalFixture>, Failure> {
        let mut out = Vec::new();
        for (setup, motions) in list.setups().iter().zip(&self.setups) {
            let samples = stock::fixtures(&setup.job, part)?;
            let met = motions.start.max(stretch.start)..motions.end.min(stretch.end);
            if !samples.is_empty() && !met.is_empty() {
                let motions = met.start - stretch.start..met.end - stretch.start;
                out.push(GoalFixture { samples, motions });
            }
        }
        Ok(out)
    }

    /// The verdict on one operation, which is made by the motions of a stretch: on its own faces, in the raw material that was there when
    /// it began. A finishing is judged after everything before it too, a roughing by itself: what is finished already has no
    /// allowance any more.
    ///
    /// # Errors
    /// Where it cannot be judged.
    pub fn judge_step(
        &self,
        (list, job): (&Operations, &Job),
        part: &Part,
        (own, left): (Range<usize>, Option<(Arc<Stock>, String)>),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Judged, Failure> {
        let begin = if job.strategy().layers().is_some() { own.start } else { 0 };
        let range = begin..own.end;
        let stretch = self.stretch(range.clone());
        let mut aim = Aim::of_tools(job, part, stretch.tools, self.fixtures(list, part, &range)?)?.of_step();
        if let Some((stock, words)) = left {
            aim = aim.begun(Left { stock, from: own.start - begin, words });
        }
        let verified = verify::judge(&aim, stretch.reading(&self.control), progress)?;
        let found = match &verified.verdict.figures().stock {
            Some(found) => Some(found.clone()),
            // A program that is far off without raw material is not led through it to be told so, but the next begins there.
            None => {
                let Reading { program, control, speeds_rpm, .. } = stretch.reading(&self.control);
                carve(&aim.goal(control, &speeds_rpm), program, &|_| {})
                    .map_err(|e| Failure::file(job.path(), e))?
            }
        };
        let stock = found.as_ref().map(|f| stock::told(f, part).0);
        Ok(Judged { verified, stock, left: found.map(|f| f.stock) })
    }

    /// The verdict on the finished part: on all faces, from the raw material as declared.
    ///
    /// # Errors
    /// Where it cannot be judged.
    pub fn judge_whole(
        &self,
        list: &Operations,
        part: &Part,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Verified, Failure> {
        let all = 0..self.motions.len();
        let stretch = self.stretch(all.clone());
        let aim = Aim::of_tools(list.whole(), part, stretch.tools, self.fixtures(list, part, &all)?)?;
        verify::judge(&aim, stretch.reading(&self.control), progress)
    }
}

/// Some of the motions, counted from the first of them.
struct Stretch<'a> {
    motions: &'a [Swept],
    times_min: Vec<f64>,
    changes: Vec<usize>,
    tools: &'a [Job],
    speeds_rpm: &'a [Option<f64>],
}

impl Stretch<'_> {
    /// As a verdict takes it.
    fn reading(&self, control: &GoalControl) -> Reading<'_> {
        let program = Program { motions: self.motions, times_min: &self.times_min, changes: &self.changes };
        Reading { source: "nc", program, control: control.clone(), speeds_rpm: self.speeds_rpm.to_vec() }
    }
}
