//! A list of operations from the part to its programs: each planned on what those before it left, all of a setup in one program, every
//! operation and the finished part judged from the texts.

mod again;
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
use crate::job::{Job, Operation, Operations};
use crate::part::Part;
use crate::watch::{Stage, Watch};
use crate::work::nc::Motions;
use crate::work::plan::Plan;
use crate::work::program::WallS;
use crate::work::stock::RawMaterial;
use crate::work::verify::Verified;
use again::Again;
use course::StepOf;
pub use course::{Course, Section, Text};
use kept::Kept;
use osculate_geom::Diagnostic;
use osculate_tools::removal::stock::Stock;
use std::sync::Arc;
use std::time::Instant;
use step::{Planning, Step};

/// Reads the part of a list of operations, and derives the operations where it lists none.
///
/// # Errors
/// As [`Part::of`], and where faces are machined by nothing, raw material does not hold the part, or a fixture stands in it.
pub fn part(list: Operations, watch: &dyn Watch) -> Result<(Part, Operations), Failure> {
    let mut part = Part::watched(list.whole(), watch)?;
    let stage = Stage::begin(watch, "check");
    let list = derive::derived(list, &part)?;
    sense::check(&list, &part)?;
    part.import_s += stage.end();
    Ok((part, list))
}

/// The part as an operation sees it, with the faces of all its places to machine.
///
/// # Errors
/// Where it names a face that is not there, or the part is not the same in all places.
pub fn seen(operation: &Operation, job: &Job, part: &Part) -> Result<Part, Failure> {
    Ok(passages::Passages::of(operation, job, part)?.into_all())
}

/// Plans all operations of a list, posts a program for each setup, and judges each operation and the finished part from their texts.
/// Where the finished part is left a little too high, what left it so is laid out again for less.
///
/// # Errors
/// Where an operation cannot be planned or posted. A part that is not held is none: the verdict says so.
pub fn plan(part: &Part, list: &Operations, watch: &dyn Watch) -> Result<Plan, Failure> {
    part.part.to_plan(list.path())?;
    let mut wall_s = WallS { import: part.import_s, ..WallS::default() };
    let begin = Instant::now();
    let stage = Stage::begin(watch, "stock");
    let raw = RawMaterial::of(list.whole(), part)?;
    let key = kept::key(list)?;
    wall_s.between = stage.end();
    let mut again = Again::default();
    loop {
        let Laid { steps, mut notes } =
            laid(list, part, (raw.as_ref(), key), &mut again, &mut wall_s, watch)?;
        let stage = Stage::begin(watch, "post");
        let programs = posted::programs(list, part, &steps)?;
        let texts: Vec<Text<'_>> = programs.iter().map(posted::Program::text).collect();
        let course = Course::read(list, part, &texts, false)?;
        wall_s.post += stage.end();
        let stage = Stage::begin(watch, "verify");
        if course.sections.len() != steps.len() {
            let what = format!(
                "its programs name {} operations where {} are planned: a fault of the post",
                course.sections.len(),
                steps.len()
            );
            return Err(Failure::file(list.path(), what));
        }
        let own = |step: &Step<'_>| Ok(step.operation.judged()?.in_hand(step.job.tool().number()));
        let judging: Vec<StepOf<'_>> = steps
            .iter()
            .map(|s| Ok(StepOf { job: own(s)?, part: &s.part }))
            .collect::<Result<_, Failure>>()?;
        let (whole, judged) = course.judge((list, part), &judging, &|f| stage.at(f))?;
        drop(judging);
        wall_s.verify += stage.end();
        if again.asks(list.whole(), &steps, &course, &whole) {
            again.keep(steps);
            continue;
        }
        notes.extend(again.notes());
        let known = told::Known { list, part, steps, programs, course, judged, whole, notes, wall_s, begin };
        return told::told(known, watch);
    }
}

/// Operations laid out, before they are posted.
struct Laid<'a> {
    steps: Vec<Step<'a>>,
    notes: Vec<Diagnostic>,
}

/// Plans all operations one after the other, or takes what is there of them.
fn laid<'a>(
    list: &'a Operations,
    part: &Part,
    (raw, key): (Option<&RawMaterial<'_>>, u64),
    again: &mut Again<'a>,
    wall_s: &mut WallS,
    watch: &dyn Watch,
) -> Result<Laid<'a>, Failure> {
    let stage = Stage::begin(watch, "stock");
    let mut behind = behind::Behind::new(part, raw)?;
    let (mut steps, mut notes) = (Vec::new(), Vec::new());
    wall_s.between += stage.end();
    for (place, operation) in list.all().iter().enumerate() {
        let at_most_mm = again.at_most_mm(operation);
        let key = kept::key_of(key, at_most_mm);
        let before = || watch.kept(&kept::name(place)).and_then(|bytes| Kept::read(&bytes, key));
        let planning = if let Some(step) = again.ready(operation) {
            Planning::Path(Box::new(step))
        } else if let Some(kept) = before() {
            let step = Step::of_kept(operation, at_most_mm, part, kept)?;
            wall_s.plan += step.plan_s;
            Planning::Path(Box::new(step))
        } else {
            let planning = step::plan((operation, at_most_mm), part, (&behind, raw), watch)?;
            if let Planning::Path(step) = &planning {
                watch.keep(&kept::name(place), &step.kept(key).bytes());
                wall_s.plan += step.plan_s;
            }
            planning
        };
        match planning {
            Planning::Path(mut step) => {
                let stage = Stage::begin(watch, "stock");
                let tolerance = list.whole().tolerance();
                let limit_mm = tolerance.scallop_mm;
                let before = behind.stands(&step.part, limit_mm);
                let slowed = behind.take(&step.job, tolerance.gouge_mm, &mut step.planned.linked)?;
                step.on_faces = behind::on_faces(&step.part, before, behind.stands(&step.part, limit_mm));
                step.slowed += slowed;
                if step.slowed > 0 {
                    let text = format!(
                        "{}: {} rapid moves would go through material and are made at feed",
                        operation.name, step.slowed
                    );
                    notes.push(Diagnostic::note("links", text));
                }
                wall_s.between += stage.end();
                steps.push(*step);
            }
            Planning::Nothing(note) => notes.push(note),
        }
    }
    if steps.is_empty() {
        return Err(Failure::file(list.path(), "no operation has anything to do"));
    }
    Ok(Laid { steps, notes })
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
) -> Result<(Verified, Motions), Failure> {
    let course = Course::read(list, part, texts, lenient).map_err(|why| part.warned(why))?;
    let (mut verified, _) = course.judge((list, part), &[], progress)?;
    let of_stock = std::mem::take(&mut verified.diagnostics);
    verified.diagnostics =
        part.part.diagnostics.iter().chain(&course.diagnostics).cloned().chain(of_stock).collect();
    Ok((verified, course.into_motions()))
}

/// An operation judged.
#[non_exhaustive]
pub struct Judged {
    /// The verdict on it.
    pub verified: Verified,
    /// What is left of the raw material, where some is declared.
    pub left: Option<Arc<Stock>>,
}
