//! A plan, its program, and what verification of the program measured.

use crate::failure::Failure;
use crate::job::{Control, Job};
use crate::part::Part;
use crate::watch::{Stage, Watch};
use crate::work::budget;
use crate::work::by_tip;
use crate::work::extras::Extras;
use crate::work::nc::{self, Motions};
use crate::work::passes;
use crate::work::reading;
use crate::work::setup::{self, Along};
use crate::work::stock;
use crate::work::verify::{self, Verified};
use osculate_geom::{Diagnostic, Unit3};
use osculate_postproc::{self as post, Setup};
use osculate_productivity::compare::Axes;
use osculate_productivity::plan::{CcPoint, Linked, Passes};
use osculate_tools::Lean;
use osculate_tools::cl::Motion;
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Seconds of wall time by stage.
#[derive(Debug, Default, Serialize, Clone, Copy)]
#[non_exhaustive]
pub struct WallS {
    /// Reading the part, and telling what of the job cannot be meant for it.
    pub import: f64,
    /// Planning.
    pub plan: f64,
    /// Of a list of operations, what each leaves to the next: raw material, and what stands on the faces.
    pub between: f64,
    /// Posting.
    pub post: f64,
    /// Verification.
    pub verify: f64,
    /// The estimate of the ideal time.
    pub ideal: f64,
    /// Pages and pictures.
    pub report: f64,
    /// All of it, but for writing the files.
    pub total: f64,
}

/// A plan before it is posted.
pub struct Planned<'a> {
    /// The passes.
    pub passes: Passes,
    /// After each what was taken out of the pass that it is of, up to the next: ways may follow it.
    pub skipped: Vec<Vec<CcPoint>>,
    /// The passes joined.
    pub linked: Linked,
    /// Its name.
    pub strategy: String,
    /// Lead and tilt; of a local lead the least that was allowed.
    pub lean: Lean,
    /// Whence the axis.
    pub axes: Axes,
    /// What the report shows beside what every report shows.
    pub extras: Extras<'a>,
    /// Whether the points of passes know the width of their strips, for samples that resolve them.
    pub with_strips: bool,
}

/// A plan posted and read back.
#[non_exhaustive]
pub struct Posted {
    /// CL data.
    pub cl_text: String,
    /// The control it is posted for.
    pub control: Control,
    /// The program.
    pub program: post::Posted,
    /// Where the part sits.
    pub setup: Setup,
    /// What the program does.
    pub read: Motions,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

impl Posted {
    /// Posts a plan. From here on a run that is stopped can save the path.
    pub fn of(
        job: &Job,
        faces: &Part,
        planned: &Planned<'_>,
        wall_s: &mut WallS,
        watch: &dyn Watch,
    ) -> Result<Self, Failure> {
        let control = job.control().clone();
        let control_notes = job.control_notes();
        let cl = passes::cl_path(job, &planned.linked);
        let title = passes::title(job);
        let cl_text = nc::cl_text(&cl, job.tool().number(), &title).map_err(Failure::job)?;
        // Before the stage is named, so that a run stopped in it has a path to save.
        if watch.wants_partial() {
            let text = cl_text.clone();
            watch.partial(Box::new(move || Ok(text)), "the whole path".to_owned());
        }
        let stage = Stage::begin(watch, "post");
        let along = Along { path: &cl, axes: &axes_of(planned) };
        let (base, mut setup_notes) = setup::of(job, faces, Some(along));
        let options = options(job, faces, &control, planned)?;
        let written = |setup: &Setup| -> Result<(post::Posted, Motions), Failure> {
            let mut program = post::post(&cl, &control.machine, setup, &options).map_err(Failure::job)?;
            program.text = control.language.worded(program.text)?;
            let read = nc::read_back(&program.text, job, &control, setup, false)
                .map_err(|e| Failure::job(format!("the program just written cannot be read back: {e}")))?;
            Ok((program, read))
        };
        let mut best = written(&base);
        let mut place = base;
        stage.at(0.6);
        let first_min = best.as_ref().ok().map(|(_, read)| read.ranked_min());
        let worth_min = first_min.map_or(f64::INFINITY, |min| (1.0 - setup::WORTH_A_TURN) * min);
        for turned in setup::turned(job, faces, &cl, &control, &base) {
            // A turn that no program can be written for is none.
            let Ok(other) = written(&turned) else { continue };
            let now_min = other.1.ranked_min();
            let least_min = best.as_ref().map_or(f64::INFINITY, |(_, read)| read.ranked_min());
            if now_min < least_min.min(worth_min) {
                setup_notes = setup::notes_of_turned(&turned, first_min, now_min);
                best = Ok(other);
                place = turned;
            }
        }
        let (program, _) = best?;
        // The verdict is on what its text does, read as everybody reads it: from the place that its head says, beside the job of the file.
        let told = job.in_hand(job.tool().number());
        let (mut read, _) = reading::program(&program.text, &control, &told, faces, false)?;
        if job.is_beside_kept() {
            read.control.blend_mm = read.control.blend_mm.max(budget::blend_mm(job, turns(planned)));
        }
        wall_s.post += stage.end();
        let notes = [&control_notes, &setup_notes, &program.diagnostics, &read.diagnostics];
        let diagnostics = notes.into_iter().flatten().cloned().collect();
        Ok(Self { cl_text, control, program, setup: place, read, diagnostics })
    }

    /// What to say of the job's feed mode.
    pub fn note_of_feed(&self, job: &Job, faces: &Part, planned: &Planned<'_>) -> Option<Diagnostic> {
        by_tip::note(&self.control, &self.setup, &self.program.text, |tip| {
            let cl = passes::cl_path(job, &planned.linked);
            let options = options(job, faces, tip, planned).ok()?;
            let program = post::post(&cl, &tip.machine, &self.setup, &options).ok()?;
            tip.language.worded(program.text).ok()
        })
    }

    /// Time of the program on its control, min.
    pub fn time_min(&self) -> f64 {
        self.read.ranked_min()
    }

    /// Measures what the program leaves.
    pub fn verify(
        &self,
        job: &Job,
        faces: &Part,
        wall_s: &mut WallS,
        watch: &dyn Watch,
    ) -> Result<Verified, Failure> {
        let stage = Stage::begin(watch, "verify");
        let verified = verify::run(job, faces, self.read.reading("nc"), &|f| stage.at(f))?;
        wall_s.verify += stage.end();
        Ok(verified)
    }
}

/// How far from its axis the tool touches the part at most, rad; a right angle where that is not known.
pub fn touch_rad(planned: &Planned<'_>) -> f64 {
    planned.passes.inclination_rad().map_or(FRAC_PI_2, |[.., most]| most.min(FRAC_PI_2))
}

/// Whether the tool's axis turns while it feeds.
pub fn turns(planned: &Planned<'_>) -> bool {
    let moves = &planned.linked.path.moves;
    let turned = |a: &Unit3, b: &Unit3| (a.into_inner() - b.into_inner()).norm() > 1e-9;
    moves.windows(2).any(|m| m[1].motion != Motion::Rapid && turned(&m[0].pose.axis, &m[1].pose.axis))
}

/// How a job's program is written for a control.
fn options(
    job: &Job,
    faces: &Part,
    control: &Control,
    planned: &Planned<'_>,
) -> Result<post::PostOptions, Failure> {
    let usual = nc::job_options(job, control, &passes::title(job), touch_rad(planned));
    Ok(post::PostOptions { blank_mm: stock::corners_of(job, faces)?, joins: !turns(planned), ..usual })
}

/// Tool axes that are looked at for a setup.
const AXES: usize = 4000;

/// Axes of the tool along the path, for a setup in which they look up.
pub fn axes_of(planned: &Planned<'_>) -> Vec<Unit3> {
    if !planned.extras.axes.is_empty() {
        return planned.extras.axes.clone();
    }
    let linked = &planned.linked;
    let cutting: Vec<Unit3> = linked
        .path
        .moves
        .iter()
        .zip(&linked.pass_of_move)
        .filter(|(_, pass)| pass.is_some())
        .map(|(m, _)| m.pose.axis)
        .collect();
    cutting.iter().step_by(cutting.len().div_ceil(AXES).max(1)).copied().collect()
}
