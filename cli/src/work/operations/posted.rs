//! The programs of a list of operations: one for each setup, with its tool changes.

use crate::failure::Failure;
use crate::job::{Control, Job, Operations};
use crate::part::Part;
use crate::work::operations::course::Text;
use crate::work::operations::step::Step;
use crate::work::program::{axes_of, touch_rad, turns};
use crate::work::setup::{self, Along};
use crate::work::{budget, by_tip, nc, passes, stock};
use osculate_geom::Diagnostic;
use osculate_postproc::{Section, Setup, post_sections};
use osculate_tools::cl::ClPath;
use std::path::PathBuf;

/// The program of a setup.
pub struct Program {
    /// Its file.
    pub file: String,
    /// What stands in it.
    pub text: String,
    /// Where the part sits.
    pub setup: Setup,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
    path: PathBuf,
}

impl Program {
    /// The program as it is read.
    pub fn text(&self) -> Text<'_> {
        Text { file: &self.path, text: &self.text }
    }
}

/// The steps of a setup, by their places.
fn of_setup(steps: &[Step<'_>], setup: usize) -> Vec<usize> {
    (0..steps.len()).filter(|k| steps[*k].operation.setup == setup).collect()
}

/// Posts the steps of every setup.
///
/// # Errors
/// Where nothing is done in a setup, or its paths cannot be posted.
pub fn programs(list: &Operations, part: &Part, steps: &[Step<'_>]) -> Result<Vec<Program>, Failure> {
    let setups = list.setups();
    let mut out = Vec::with_capacity(setups.len());
    for (k, held) in setups.iter().enumerate() {
        let own = of_setup(steps, k);
        if own.is_empty() {
            let what = format!("setup {}: no operation has anything to do in it: leave it out", held.name);
            return Err(Failure::file(list.path(), what));
        }
        let paths: Vec<ClPath> =
            own.iter().map(|s| passes::cl_path(&steps[*s].job, &steps[*s].planned.linked)).collect();
        let whole = whole(&paths);
        let longest = longest(&held.job);
        let (place, notes) = placed(&longest, part, (steps, &own), &whole);
        let control = held.job.control();
        let title = passes::title(&held.job);
        // What a control may round off at corners counts for the whole program.
        let blend_mm = own.iter().map(|s| budget::asked_mm(&steps[*s].job)).fold(f64::INFINITY, f64::min);
        let blank_mm = stock::corners_of(&held.job, part)?;
        let by = |control: &Control, place: &Setup| -> Result<(String, Vec<Diagnostic>), Failure> {
            let sections: Vec<Section<'_>> = own
                .iter()
                .zip(&paths)
                .map(|(s, path)| {
                    let Step { job, operation, planned, .. } = &steps[*s];
                    let mut options = nc::job_options(job, control, &title, touch_rad(planned));
                    options.program_number += k as u32;
                    options.blend_mm = blend_mm;
                    options.blank_mm = blank_mm;
                    options.joins = !turns(planned);
                    Section {
                        name: operation.name.clone(),
                        path,
                        gauge_length_mm: nc::gauge_mm(job),
                        options,
                    }
                })
                .collect();
            let posted = post_sections(&sections, &control.machine, place)
                .map_err(|e| Failure::file(list.path(), format!("setup {}: {e}", held.name)))?;
            Ok((control.language.worded(posted.text)?, posted.diagnostics))
        };
        let name = if setups.len() > 1 { format!("program-{}", held.name) } else { "program".to_owned() };
        let file = format!("{name}.{}", control.extension);
        let written = |place: Setup, notes: Vec<Diagnostic>| -> Result<Written, Failure> {
            let (text, found) = by(control, &place)?;
            Ok(Written { place, text, notes: [notes, found].concat() })
        };
        let mut best = written(place, notes);
        // How a block is clamped is for a shop to say.
        let asks = held.job.setup().asks_turns;
        let others = if asks { setup::turned(&longest, part, &whole, control, &place) } else { Vec::new() };
        let first_min = best.as_ref().ok().filter(|_| !others.is_empty()).and_then(|w| w.time_min(&held.job));
        let mut least_min = first_min.map_or(f64::INFINITY, |min| (1.0 - setup::WORTH_A_TURN) * min);
        for turned in others {
            // A turn that no program can be written for is none.
            let Ok(other) = written(turned, Vec::new()) else { continue };
            let Some(now_min) = other.time_min(&held.job) else { continue };
            if now_min < least_min {
                let notes = setup::notes_of_turned(&turned, first_min, now_min);
                (least_min, best) = (now_min, Ok(Written { notes: [notes, other.notes].concat(), ..other }));
            }
        }
        let Written { place, text, notes } = best?;
        let mut diagnostics = held.job.control_notes();
        diagnostics.extend(notes);
        diagnostics.extend(by_tip::note(control, &place, &text, |tip| Some(by(tip, &place).ok()?.0)));
        out.push(Program { path: PathBuf::from(&file), file, text, setup: place, diagnostics });
    }
    Ok(out)
}

/// A program, and what is said of where its part sits.
struct Written {
    place: Setup,
    text: String,
    notes: Vec<Diagnostic>,
}

impl Written {
    /// Its time on the control, min; none where it cannot be read.
    fn time_min(&self, job: &Job) -> Option<f64> {
        let tools = job.each_tool();
        let read = nc::read_back_tools(&self.text, (job, &tools), job.control(), &self.place, false).ok()?;
        Some(read.ranked_min())
    }
}

/// All paths of a setup as one.
fn whole(paths: &[ClPath]) -> ClPath {
    let moves = paths.iter().flat_map(|p| p.moves.iter().copied()).collect();
    ClPath { moves, ..paths[0].clone() }
}

/// The job with the longest tool, which needs the most of the travel.
fn longest(held: &Job) -> Job {
    let jobs = held.each_tool();
    jobs.into_iter()
        .max_by(|a, b| nc::gauge_mm(a).total_cmp(&nc::gauge_mm(b)))
        .unwrap_or_else(|| held.clone())
}

/// Where the part sits for all paths of a setup.
fn placed(
    longest: &Job,
    part: &Part,
    (steps, own): (&[Step<'_>], &[usize]),
    path: &ClPath,
) -> (Setup, Vec<Diagnostic>) {
    let axes: Vec<_> = own.iter().flat_map(|s| axes_of(&steps[*s].planned)).collect();
    setup::of(longest, part, Some(Along { path, axes: &axes }))
}
