//! Roughing in layers: from the raw material of a job down to an allowance on its faces.

use crate::failure::Failure;
use crate::job::Job;
use crate::job::roughing::Layers;
use crate::job::words::EntryWord;
use crate::part::{LoadedFace, Part};
use crate::work::drop;
use crate::work::extras::Extras;
use crate::work::program::Planned;
use crate::work::setup;
use crate::work::stock::RawMaterial;
use crate::work::{passes, plunges};
use osculate_geom::{Diagnostic, Offset, Unit3};
use osculate_postproc::Orienting;
use osculate_productivity::compare::Axes;
use osculate_productivity::plan::{self, Headings, Places, RoughTask, Rows, Search, Sizes};
use osculate_surfaces::TrimmedSurface;
use osculate_tools::Lean;
use osculate_tools::reach::Directions;
use osculate_tools::removal::stock::Stock;

/// Axes of a machine with one rotary joint are tried so far apart, rad.
const LINE_RAD: f64 = 0.05;
/// The level of the even set of axes that are tried on a machine with two rotary joints: 4.3 degrees apart.
const LEVEL: u32 = 4;

/// Whether a job roughs.
pub fn is(job: &Job) -> bool {
    job.strategy().layers().is_some()
}

/// The faces that a roughing is measured against: those of the job, outside by the allowance. None for other jobs.
pub fn measured(job: &Job, faces: &Part) -> Result<Vec<Offset<TrimmedSurface>>, Failure> {
    let Some(layers) = job.strategy().layers() else { return Ok(Vec::new()) };
    let offset =
        |f: &LoadedFace| Offset::new((*f.surface).clone(), layers.allowance_mm).map_err(Failure::job);
    faces.faces.iter().map(offset).collect()
}

fn sizes(job: &Job, layers: &Layers) -> Sizes {
    Sizes {
        stepdown_mm: layers.stepdown_mm,
        stepover_mm: layers.stepover_mm,
        allowance_mm: layers.allowance_mm,
        ramp_rad: layers.ramp_rad,
        chord_mm: job.tolerance().chord_mm,
        stands_mm: job.tolerance().scallop_mm,
    }
}

/// The axes that the job's machine reaches, with the part as it stands before a path is known.
fn candidates(job: &Job, faces: &Part) -> Result<Vec<Unit3>, Failure> {
    let (setup, _) = setup::of(job, faces, None);
    let joints = Orienting::new(&job.control().machine, &setup.part_zero.rotation);
    if let Some(line) = joints.line(LINE_RAD) {
        return Ok(line);
    }
    let all = Directions::icosphere(LEVEL).map_err(Failure::job)?;
    Ok(all.all().iter().filter(|axis| joints.reaches(axis)).copied().collect())
}

/// The path of a roughing, out of what operations before have left.
pub fn planned(
    job: &Job,
    faces: &Part,
    (layers, stock, repeat): (&Layers, &Stock, Option<Places>),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    let (axis, longest) = drop::directions(job, faces);
    let cutter = job.cutter();
    let links = passes::links(job, faces, &cutter);
    let (named, check) = (drop::names(&faces.faces), drop::names(&faces.check));
    let found: Vec<Unit3> = if layers.directions.is_some() { candidates(job, faces)? } else { Vec::new() };
    let from = match layers.directions {
        Some(most) => Headings::Found(Search { candidates: &found, most, least_share: layers.least_share }),
        None => Headings::Along(axis),
    };
    let task = RoughTask {
        faces: &named,
        check: &check,
        cutter: &cutter,
        from,
        rows: match job.strategy().feed_direction {
            Some(asked) => Rows::Along(asked),
            None => Rows::Quickest(longest),
        },
        stock,
        repeat,
        sizes: sizes(job, layers),
        entry: match layers.entry {
            EntryWord::Auto => plan::Entry::Auto,
            EntryWord::Helix => plan::Entry::Helix,
            EntryWord::Ramp => plan::Entry::Ramp,
            EntryWord::Outside => plan::Entry::Outside,
        },
        plunges: job.tool().plunges(),
        volume_rate_mm3_min: layers.volume_rate_mm3_min.unwrap_or(f64::INFINITY),
        links: &links,
        progress,
    };
    let rough = plan::rough(&task).map_err(|e| Failure::file(job.path(), e))?;
    Ok(Planned {
        passes: rough.passes,
        skipped: Vec::new(),
        linked: rough.linked,
        strategy: job.strategy().name().to_owned(),
        lean: Lean::default(),
        axes: Axes::Held,
        extras: Extras::default(),
        with_strips: false,
    })
}

/// The path of a roughing out of the raw material of a job of one operation.
pub fn of_raw(
    job: &Job,
    faces: &Part,
    layers: &Layers,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    let Some(raw) = RawMaterial::of(job, faces)? else {
        return Err(job.refuse("strategy", "kind", "a roughing needs the raw material: add [stock]"));
    };
    let mut stock = raw.filled()?;
    let mut out = planned(job, faces, (layers, &stock, None), progress)?;
    let slowed = plunges::slow(&mut stock, job, job.tolerance().gouge_mm, &mut out.linked)?;
    if slowed > 0 {
        let text = format!("{slowed} rapid moves would go through material and are made at feed");
        out.extras.diagnostics.push(Diagnostic::note("links", text));
    }
    Ok(out)
}
