//! What the programs of a list of operations do, one after the other.

use crate::failure::Failure;
use crate::job::{Job, Operations};
use crate::part::Part;
use crate::work::goal::Aim;
use crate::work::nc::{self, Call, Motions, OnControl};
use crate::work::operations::Judged;
use crate::work::operations::passages::Passages;
use crate::work::verify::{self, Reading, Verified};
use crate::work::{bodies, posted_setup, reading, stock};
use osculate_geom::Diagnostic;
use osculate_postproc::Setup;
use osculate_postproc::machine::JointValues;
use osculate_tools::removal::{GoalControl, GoalFixture, GoalStep, Program, Remark, Swept, prove_in_steps};
use std::collections::HashMap;
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
    /// The same by the control, with its accelerations and corners.
    pub on_control: OnControl,
    /// Where the joints stand at the end of each, as in [`Motions`](nc::Motions::at_nose).
    pub at_nose: Vec<Option<JointValues>>,
    /// Where the tools after the first take over.
    changes: Vec<usize>,
    /// The whole job with each tool in hand, in the order in which they are called.
    tools: Vec<Job>,
    speeds_rpm: Vec<Option<f64>>,
    control: GoalControl,
    /// The motions of each setup.
    pub setups: Vec<Range<usize>>,
    /// The operations as the programs name them, in order; none where a program names none.
    pub sections: Vec<Section>,
    /// Time of each setup's program, min.
    pub setup_min: Vec<f64>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// An operation as a program names it where it begins.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Its name, as the job has it where it has one that reads the same.
    pub name: String,
    /// The number of its tool.
    pub tool: Option<u32>,
    /// Its motions.
    pub motions: Range<usize>,
}

/// What of a name a program can say: controls know few characters, and one case.
fn readable(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// The operations that a program names, each with the line, from 1, in which it does so.
fn named(text: &str) -> Vec<(usize, String, Option<u32>)> {
    let mut out: Vec<(usize, String, Option<u32>)> = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let words = format!("operation {}: ", out.len() + 1);
        let Some(at) = line.to_ascii_lowercase().find(&words) else { continue };
        let rest = line[at + words.len()..].trim_end_matches([')', ' ']);
        let (name, tool) = rest.rsplit_once(", T").or_else(|| rest.rsplit_once(", t")).unwrap_or((rest, ""));
        out.push((k + 1, name.to_owned(), tool.parse().ok()));
    }
    out
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
            let engine_text = job.control().language.engine_text(text.text);
            let (place, notes) = place(job, part, &engine_text);
            let tools = job.each_tool();
            let mut read = nc::read_back_tools(text.text, (job, &tools), job.control(), &place, lenient)
                .map_err(|why| Failure::file(text.file, why))?;
            bodies::look(&mut read.control, text.text, (job, &tools), job.control(), &place, (part, lenient))
                .map_err(|why| Failure::file(text.file, why.message()))?;
            if read.motions.is_empty() {
                return Err(Failure::file(text.file, "has no motion: at least two positions are needed"));
            }
            out.diagnostics.extend(notes);
            out.diagnostics.extend(reading::meet(text.file, &read.motions, part)?);
            out.diagnostics.extend(read.diagnostics);
            let (begin, clock) = (out.motions.len(), out.times_min.last().copied().unwrap_or(0.0));
            out.take_calls(text.file, begin, &read.calls, &tools)?;
            let names = named(&engine_text);
            for (k, (line, name, tool)) in names.iter().enumerate() {
                let first = |line: usize| read.motions.partition_point(|m| (m.block as usize) < line);
                let from = if k == 0 { 0 } else { first(*line) };
                let to = names.get(k + 1).map_or(read.motions.len(), |next| first(next.0));
                let own = list.all().iter().find(|o| readable(&o.name) == readable(name));
                let name = own.map_or_else(|| name.clone(), |o| o.name.clone());
                out.sections.push(Section { name, tool: *tool, motions: begin + from..begin + to });
            }
            out.motions.extend(read.motions);
            out.at_nose.extend(read.at_nose);
            out.times_min.extend(read.times_min.iter().map(|t| t + clock));
            let on_control = read.on_control.unwrap_or_default();
            let clock = out.on_control.times_min.last().copied().unwrap_or(0.0);
            out.on_control.times_min.extend(on_control.times_min.iter().map(|t| t + clock));
            out.on_control.time_min += on_control.time_min;
            out.on_control.cutting_min += on_control.cutting_min;
            out.setups.push(begin..out.motions.len());
            out.setup_min.push(read.time_min);
            let prefix = if setups.len() > 1 { format!("{}: ", setup.name) } else { String::new() };
            let named = |r: Remark| Remark { text: format!("{prefix}{}", r.text), ..r };
            out.control.remarks.extend(read.control.remarks.into_iter().map(named));
            out.control.blend_mm = out.control.blend_mm.max(read.control.blend_mm);
            if out.control.words.is_empty() {
                out.control.words = read.control.words;
                out.control.bodies = read.control.bodies;
            }
        }
        Ok(out)
    }

    /// The motions alone, as reports take them.
    pub fn into_motions(self) -> Motions {
        let time_min = self.setup_min.iter().sum();
        let Self { motions, times_min, at_nose, .. } = self;
        Motions { motions, times_min, at_nose, time_min, ..Motions::default() }
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

    /// The verdict on the finished part, on all faces from the raw material as declared, and on each of its steps, on its own faces when its
    /// last motion is made: by what is measured for the part. A roughing is judged with those just before it that leave no less,
    /// and by nothing else, since what is finished has no allowance any more.
    ///
    /// # Errors
    /// Where they cannot be judged.
    pub fn judge(
        &self,
        (list, part): (&Operations, &Part),
        steps: &[StepOf<'_>],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Verified, Vec<Judged>), Failure> {
        let all = 0..self.motions.len();
        let stretch = self.stretch(all.clone());
        let aim = Aim::of_tools(list.whole(), part, stretch.tools, self.fixtures(list, part, &all)?)?;
        let mut aims = Vec::with_capacity(steps.len());
        for (k, (step, section)) in steps.iter().zip(&self.sections).enumerate() {
            let range = self.begin_of(steps, k)..section.motions.end;
            let begun = k.checked_sub(1).map(|before| format!("what {} left", self.sections[before].name));
            let own = self.stretch(range.clone());
            let fixtures = self.fixtures(list, part, &range)?;
            aims.push((Aim::of_tools(&step.job, step.part, own.tools, fixtures)?.of_step(begun), own));
        }
        let goals = aims.iter().zip(&self.sections).enumerate().map(|(k, ((aim, own), section))| {
            let Reading { control, speeds_rpm, .. } = own.reading(&self.control);
            let from = self.begin_of(steps, k);
            GoalStep { goal: aim.goal(control, &speeds_rpm), motions: section.motions.clone(), from }
        });
        let goals: Vec<GoalStep<'_>> = goals.collect();
        let stops: Vec<usize> = self.sections.iter().map(|s| s.motions.end).collect();
        let Reading { control, speeds_rpm, program, source } = stretch.reading(&self.control);
        let goal = aim.goal(control, &speeds_rpm);
        let proved = prove_in_steps(&goal, program, (&stops, &goals), progress)
            .map_err(|why| verify::refused(list.whole(), why))?;
        let finishers = finishers(list, part)?;
        let named = |verified: Verified, from: usize| self.named(verified, from, &finishers);
        let whole = named(Verified::of(&aim, proved.whole, source), 0);
        let judged = proved.steps.into_iter().zip(&aims).enumerate();
        let judged = judged.map(|(k, (verdict, (aim, _)))| {
            let from = self.begin_of(steps, k);
            let left = verdict.figures().stock.as_ref().map(|f| Arc::clone(&f.stock));
            let verified = named(Verified::of(aim, verdict, source), from);
            Judged { verified, left }
        });
        Ok((whole, judged.collect()))
    }

    /// The first motion by which a step is judged: of a roughing that of the first of those just before it that leave no less.
    fn begin_of(&self, steps: &[StepOf<'_>], k: usize) -> usize {
        let leaves = |s: &StepOf<'_>| s.job.strategy().layers().map(|l| l.allowance_mm);
        let Some(own) = leaves(&steps[k]) else { return 0 };
        let first = (0..k).rev().take_while(|j| leaves(&steps[*j]).is_some_and(|left| left >= own)).last();
        self.sections[first.unwrap_or(k)].motions.start
    }

    /// By how much controls may blend corners, mm.
    pub const fn blend_mm(&self) -> f64 {
        self.control.blend_mm
    }

    /// The place of the operation that makes a motion.
    pub fn section_at(&self, motion: usize) -> Option<usize> {
        let k = self.sections.partition_point(|s| s.motions.end <= motion);
        self.sections.get(k).is_some_and(|s| s.motions.contains(&motion)).then_some(k)
    }

    /// Which operation makes a motion.
    fn section_of(&self, motion: usize) -> Option<&Section> {
        Some(&self.sections[self.section_at(motion)?])
    }

    /// The operations that made the worst places and the collisions so, by the motions that did it, counted from one of them.
    fn named(&self, mut verified: Verified, from: usize, finishers: &HashMap<String, String>) -> Verified {
        for w in &mut verified.worst {
            let by = w.motion.and_then(|m| self.section_of(from + m as usize));
            w.operation = by.map(|s| s.name.clone()).or_else(|| finishers.get(&w.face).cloned());
            w.tool_number = by.and_then(|s| s.tool);
        }
        for c in verified.stock.iter_mut().flat_map(|s| &mut s.collisions) {
            let by = self.section_of(c.motion);
            c.operation = by.map(|s| s.name.clone());
            c.tool_number = by.and_then(|s| s.tool);
        }
        verified
    }
}

/// The last operation that is to machine each face.
fn finishers(list: &Operations, part: &Part) -> Result<HashMap<String, String>, Failure> {
    let mut out = HashMap::new();
    for operation in list.all() {
        let own = Passages::of(operation, &operation.judged()?, part)?.into_all();
        out.extend(own.faces.into_iter().map(|f| (f.id, operation.name.clone())));
    }
    Ok(out)
}

/// A step on the way to the part.
#[non_exhaustive]
pub struct StepOf<'a> {
    /// Its job as it is judged, with its tool in hand.
    pub job: Job,
    /// The part with its own faces to machine.
    pub part: &'a Part,
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
