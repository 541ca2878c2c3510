//! A list of operations from the part to its programs: each planned on what those before it left, all of a setup in one program, every
//! operation and the finished part judged from the texts.

pub mod behind;
mod course;
mod derive;
pub mod kept;
mod passages;
mod posted;
mod sense;
pub mod standing;
mod step;
mod told;

use crate::failure::Failure;
use crate::job::Operations;
use crate::part::Part;
use crate::watch::{Stage, Watch};
use crate::work::plan::Plan;
use crate::work::program::WallS;
use crate::work::stock::{RawMaterial, StockSummary};
use crate::work::verify::Verified;
pub use course::{Course, Text};
use kept::Kept;
use osculate_geom::Diagnostic;
use osculate_tools::removal::stock::Stock;
use std::sync::Arc;
use step::{Planning, Step};

/// Reads the part of a list of operations, and derives the operations where it lists none.
///
/// # Errors
/// As [`Part::of`], and where faces are machined by nothing, raw material does not hold the part, or a fixture stands in it.
pub fn part(list: Operations, watch: &dyn Watch) -> Result<(Part, Operations), Failure> {
    let part = Part::watched(list.whole(), watch)?;
    let list = derive::derived(list, &part)?;
    sense::check(&list, &part)?;
    Ok((part, list))
}

/// Plans all operations of a list, posts a program for each setup, and judges each operation and the finished part from their texts.
///
/// # Errors
/// Where an operation cannot be planned or posted. A part that is not held is none: the verdict says so.
pub fn plan(part: &Part, list: &Operations, watch: &dyn Watch) -> Result<Plan, Failure> {
    let mut wall_s = WallS { import: part.import_s, ..WallS::default() };
    let raw = RawMaterial::of(list.whole(), part)?;
    let mut behind = behind::Behind::new(raw.as_ref())?;
    let mut steps: Vec<Step<'_>> = Vec::new();
    let mut notes: Vec<Diagnostic> = Vec::new();
    let key = kept::key(list)?;
    for (place, operation) in list.all().iter().enumerate() {
        let before = watch.kept(&kept::name(place)).and_then(|bytes| Kept::read(&bytes, key));
        let planning = match before {
            Some(kept) => Planning::Path(Box::new(Step::of_kept(operation, part, kept)?)),
            None => step::plan(operation, part, (&behind, raw.as_ref()), watch)?,
        };
        match planning {
            Planning::Path(mut step) => {
                watch.keep(&kept::name(place), &step.kept(key).bytes());
                let stands = |behind: &behind::Behind| {
                    let limit_mm = list.whole().tolerance().scallop_mm;
                    raw.as_ref().map_or(Ok(Vec::new()), |raw| behind.stands(&step.part, raw, limit_mm))
                };
                let before = stands(&behind)?;
                let slowed = behind.take(&step.job, &mut step.planned.linked)?;
                step.on_faces = behind::on_faces(&step.part, before, stands(&behind)?);
                if slowed > 0 {
                    let text = format!(
                        "{}: {slowed} rapid moves would go through material and are made at feed",
                        operation.name
                    );
                    notes.push(Diagnostic::note("links", text));
                }
                wall_s.plan += step.plan_s;
                steps.push(*step);
            }
            Planning::Nothing(note) => notes.push(note),
        }
    }
    if steps.is_empty() {
        return Err(Failure::file(list.path(), "no operation has anything to do"));
    }
    let stage = Stage::begin(watch, "post");
    let programs = posted::programs(list, part, &steps)?;
    let texts: Vec<Text<'_>> = programs.iter().map(posted::Program::text).collect();
    let course = Course::read(list, part, &texts, false)?;
    wall_s.post = stage.end();
    let stage = Stage::begin(watch, "verify");
    let ends = posted::ends(&course, &programs, &steps)?;
    let count = (steps.len() + 1) as f64;
    let mut judged = Vec::with_capacity(steps.len());
    let mut left: Option<(Arc<Stock>, String)> = None;
    let mut begin = 0;
    for (k, (step, end)) in steps.iter().zip(&ends).enumerate() {
        let own = step.operation.judged()?.in_hand(step.job.tool().number());
        let here = |f: f64| stage.at((k as f64 + f) / count);
        let found = course.judge_step((list, &own), &step.part, (begin..*end, left), &here)?;
        left = found.left.clone().map(|stock| (stock, format!("what {} left", step.operation.name)));
        begin = *end;
        judged.push(found);
    }
    let whole = course.judge_whole(list, part, &|f| stage.at((count - 1.0 + f) / count))?;
    wall_s.verify = stage.end();
    told::told(told::Known { list, part, steps, programs, course, ends, judged, whole, notes, wall_s }, watch)
}

/// Judges the programs of all setups of a list, in their order: on the finished part, from the texts alone. The programs of a
/// [`Plan`] get its verdict again, byte for byte.
///
/// # Errors
/// Where a program is missing, cannot be read, or calls a tool that the job has not.
pub fn verify(
    part: &Part,
    list: &Operations,
    texts: &[Text<'_>],
    lenient: bool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verified, Failure> {
    let course = Course::read(list, part, texts, lenient).map_err(|why| part.warned(why))?;
    let mut verified = course.judge_whole(list, part, progress)?;
    let of_stock = std::mem::take(&mut verified.diagnostics);
    verified.diagnostics =
        part.part.diagnostics.iter().chain(&course.diagnostics).cloned().chain(of_stock).collect();
    Ok(verified)
}

/// An operation judged.
pub struct Judged {
    /// The verdict on it.
    pub verified: Verified,
    /// What it took of the raw material, where some is declared.
    pub stock: Option<StockSummary>,
    /// What is left of it.
    pub left: Option<Arc<Stock>>,
}
