//! One operation planned: from what those before it left to its path.

use crate::failure::Failure;
use crate::job::{Circumstances, Job, Operation, OperationWord};
use crate::part::{LoadedFace, Part};
use crate::watch::{Stage, Watch};
use crate::words::number;
use crate::work::choice::{self, Choice, Row};
use crate::work::operations::behind::{Behind, OnFace};
use crate::work::operations::kept::Kept;
use crate::work::operations::passages::Passages;
use crate::work::plan::Laid;
use crate::work::program::{Planned, WallS};
use crate::work::rough;
use crate::work::setup;
use crate::work::stock::RawMaterial;
use osculate_geom::{Diagnostic, Unit3};
use osculate_productivity::plan::{Rest, rest_of};
use std::sync::OnceLock;

/// An operation that is planned.
pub struct Step<'a> {
    /// The operation.
    pub operation: &'a Operation,
    /// Its job with the tool in hand, as it was planned.
    pub job: Job,
    /// The part with its own faces to machine, those of all places where it is repeated.
    pub part: Part,
    /// The axis that its tool keeps, where it keeps one in all places.
    pub kept_axis: Option<Unit3>,
    /// Its passes and path.
    pub planned: Planned<'static>,
    /// What it was chosen from.
    pub compared: Vec<Row>,
    /// How high material stood on its faces, mm, where raw material is declared.
    pub standing_mm: Option<f64>,
    /// Of rest, the area that stood too high, mm2.
    pub too_high_mm2: Option<f64>,
    /// What stood on its faces before, and stands after.
    pub on_faces: Vec<OnFace>,
    /// Rapid moves that are made at feed, as they would go through material.
    pub slowed: usize,
    /// Wall time of planning, s.
    pub plan_s: f64,
}

impl<'a> Step<'a> {
    /// As it is kept for a run that goes on.
    pub fn kept(&self, key: u64) -> Kept {
        let mut kept = Kept::of(key, &self.job, &self.planned);
        (kept.standing_mm, kept.too_high_mm2) = (self.standing_mm, self.too_high_mm2);
        kept.plan_s = self.plan_s;
        kept.compared.clone_from(&self.compared);
        kept
    }

    /// Its job as the file has it, with what a search gave it: what the operation may leave.
    ///
    /// # Errors
    /// As [`Job::from_toml`].
    pub fn judged(&self) -> Result<Job, Failure> {
        let job = self.operation.judged()?.in_hand(self.job.tool().number());
        Ok(job.with(self.job.overrides()))
    }

    /// As it was kept.
    ///
    /// # Errors
    /// Where the operation is none of the part.
    pub fn of_kept(
        operation: &'a Operation,
        at_most_mm: Option<f64>,
        whole: &Part,
        kept: Kept,
    ) -> Result<Self, Failure> {
        let known = Circumstances { standing_mm: kept.standing_mm, at_most_mm, ..Circumstances::default() };
        let job = kept.job(operation.planned(&known)?);
        let places = Passages::of(operation, &operation.judged()?, whole)?;
        Ok(Self {
            operation,
            kept_axis: places.kept_axis(&job),
            job,
            part: places.into_all(),
            planned: kept.planned(),
            standing_mm: kept.standing_mm,
            too_high_mm2: kept.too_high_mm2,
            on_faces: Vec::new(),
            slowed: 0,
            plan_s: kept.plan_s,
            compared: kept.compared,
        })
    }
}

/// What became of an operation.
#[non_exhaustive]
pub enum Planning<'a> {
    /// It has a path.
    Path(Box<Step<'a>>),
    /// There is nothing for it to do.
    Nothing(Diagnostic),
}

/// Plans an operation, of which a finishing is laid out for no more than a scallop.
///
/// # Errors
/// Where it has no passes.
pub fn plan<'a>(
    (operation, at_most_mm): (&'a Operation, Option<f64>),
    whole: &Part,
    (behind, raw): (&Behind, Option<&RawMaterial<'_>>),
    watch: &dyn Watch,
) -> Result<Planning<'a>, Failure> {
    let here = |why: Failure| why.in_operation(&operation.name);
    let stage = Stage::begin(watch, "plan");
    let job = operation.judged()?;
    let places = Passages::of(operation, &job, whole)?.in_stock(behind.left());
    let (part, whole_place) = (places.first(), places.all());
    let standing_mm = raw.map(|raw| places.standing_mm(behind, &job, raw)).transpose()?;
    let known = Circumstances { standing_mm, at_most_mm, ..Circumstances::default() };
    let job = operation.planned(&known)?;
    let (mut job, mut too_high_mm2, mut compared) = (job, None, Vec::new());
    let progress = |f: f64| stage.at(f);
    let planned = match operation.kind {
        OperationWord::Rough => {
            let (Some(layers), Some(stock)) = (job.strategy().layers(), behind.stock()) else {
                return Err(here(operation.refuse("kind", "a roughing needs the raw material: add [stock]")));
            };
            // All places are planned as one: what a direction takes in one of them is not taken again from the next.
            let places = places.circle();
            rough::planned(&job, whole_place, (layers, stock, places), &progress).map_err(here)?
        }
        OperationWord::Rest => {
            let high = places.too_high(behind, &operation.judged()?, operation.overlap_mm)?;
            if high.places.is_empty() {
                let text =
                    format!("{}: nothing stands above its tolerance: it has nothing to do", operation.name);
                return Ok(Planning::Nothing(Diagnostic::note("rest", text)));
            }
            too_high_mm2 = Some(high.area_mm2);
            let mut laid = laid(&job, part, watch, &progress).map_err(here)?;
            let rest =
                Rest { places: &high.places, overlap_mm: operation.overlap_mm, hop_mm: job.setup().hop_mm };
            let remaining = rest_of(&laid.passes.passes, &rest).map_err(Failure::job).map_err(here)?;
            (laid.passes.passes, laid.skipped) = (remaining.passes, remaining.skipped);
            if laid.passes.passes.is_empty() {
                let text = format!(
                    "{}: {} mm2 stand above the tolerance, and no pass of {} goes there",
                    operation.name,
                    number(high.area_mm2, 4),
                    job.tool_words()
                );
                return Ok(Planning::Nothing(Diagnostic::warning("rest", text)));
            }
            laid.linked(&job, part).map_err(here)?
        }
        OperationWord::Finish if job.is_open() => {
            // The part stands as it does for all operations.
            let rotate_deg = setup::of(&job, whole, None).0.turn_rad().map(f64::to_degrees);
            let known = Circumstances { rotate_deg: Some(rotate_deg), is_chosen: true, ..known };
            let job_here = operation.planned(&known)?;
            let mut choice = Choice::screen(&job_here, part).map_err(here)?;
            let settled =
                choice::settle(&mut choice, 1, watch, &mut WallS::default(), &progress).map_err(here)?;
            compared = choice.rows();
            let mut planned = settled.planned;
            planned.extras.diagnostics.push(Diagnostic::note("auto", choice.story()));
            let own = settled.job.overrides();
            job =
                if job.tools().len() > 1 { job.in_hand(settled.job.tool().number()) } else { job }.with(own);
            planned
        }
        OperationWord::Finish => {
            laid(&job, part, watch, &progress).map_err(here)?.linked(&job, part).map_err(here)?
        }
    };
    let planned = match operation.kind {
        OperationWord::Rough => planned,
        OperationWord::Finish | OperationWord::Rest => places.repeat(&job, planned).map_err(here)?,
    };
    let plan_s = stage.end();
    Ok(Planning::Path(Box::new(Step {
        operation,
        kept_axis: places.kept_axis(&job),
        job,
        part: places.into_all(),
        planned,
        compared,
        standing_mm,
        too_high_mm2,
        on_faces: Vec::new(),
        slowed: 0,
        plan_s,
    })))
}

/// Passes over all faces of an operation; where they cannot be laid over all, over each on which they can.
fn laid(job: &Job, part: &Part, watch: &dyn Watch, progress: &(dyn Fn(f64) + Sync)) -> Result<Laid, Failure> {
    let all = match Laid::of(job, part, watch, progress) {
        Err(why) if part.faces.len() > 1 => why,
        other => return other,
    };
    let mut out: Option<Laid> = None;
    let mut without = Vec::new();
    for (k, face) in part.faces.iter().enumerate() {
        match Laid::of(job, &alone(part, k), watch, &|_| {}) {
            Ok(one) => match &mut out {
                Some(all) => {
                    all.passes.passes.extend(one.passes.passes);
                    all.passes.diagnostics.extend(one.passes.diagnostics);
                }
                None => out = Some(one),
            },
            Err(why) => without.push((face.id.clone(), why)),
        }
        progress(k as f64 / part.faces.len() as f64);
    }
    let Some(mut out) = out else { return Err(all) };
    for (id, why) in without {
        let text = format!(
            "no passes of {} on it, which is left to other operations: {}",
            job.tool_words(),
            why.message()
        );
        out.passes.diagnostics.push(Diagnostic::warning(id, text));
    }
    Ok(out)
}

/// The part with one of its faces to machine and the others to be kept.
fn alone(part: &Part, k: usize) -> Part {
    let others = part.faces.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, f)| f);
    let check: Vec<LoadedFace> = others.chain(&part.check).cloned().collect();
    Part {
        part: part.part.clone(),
        faces: vec![part.faces[k].clone()],
        check,
        unseen: part.unseen.clone(),
        open: part.open.clone(),
        rims: part.rims.clone(),
        walls: OnceLock::new(),
        left: part.left.clone(),
        import_s: 0.0,
    }
}
