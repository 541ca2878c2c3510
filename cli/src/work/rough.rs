//! Roughing in layers: from the raw material of a job down to an allowance on its faces.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::JobFaces;
use crate::work::drop;
use crate::work::extras::Extras;
use crate::work::passes;
use crate::work::program::Planned;
use crate::work::stock;
use osculate_geom::Offset;
use osculate_productivity::plan::{RoughTask, Sizes, z_level};
use osculate_surfaces::TrimmedSurface;
use osculate_tools::Lean;

/// The key of job files.
pub const KIND: &str = "z_level";

/// Steepest way down into material where the job gives none, degrees.
const RAMP_DEG: f64 = 3.0;

/// Whether a job roughs.
pub fn is(job: &Job) -> bool {
    job.strategy.kind == KIND
}

/// What a roughing leaves on the faces, mm.
pub fn allowance_mm(job: &Job) -> Result<f64, Failure> {
    let given = job.strategy.allowance_mm.unwrap_or(0.0);
    if given.is_finite() && given >= 0.0 {
        Ok(given)
    } else {
        Err(Failure::file(&job.path, format!("[strategy] allowance_mm = {given} must be zero or positive")))
    }
}

/// The faces that a roughing is measured against: those of the job, outside by the allowance. None for other jobs.
pub fn measured(job: &Job, faces: &JobFaces) -> Result<Vec<Offset<TrimmedSurface>>, Failure> {
    if !is(job) {
        return Ok(Vec::new());
    }
    let by = allowance_mm(job)?;
    faces.faces.iter().map(|f| Offset::new((*f.surface).clone(), by).map_err(Failure::job)).collect()
}

fn sizes(job: &Job) -> Result<Sizes, Failure> {
    let table = &job.strategy;
    let needed = |key: &str, value: Option<f64>| {
        let text = format!("[strategy] {KIND} needs {key}, a positive number");
        value.filter(|v| v.is_finite() && *v > 0.0).ok_or_else(|| Failure::file(&job.path, text))
    };
    let ramp_deg = needed("ramp_deg", Some(table.ramp_deg.unwrap_or(RAMP_DEG)))?;
    if ramp_deg > 45.0 {
        let text = format!("[strategy] ramp_deg = {ramp_deg} must be 45 or less");
        return Err(Failure::file(&job.path, text));
    }
    Ok(Sizes {
        stepdown_mm: needed("stepdown_mm", table.stepdown_mm)?,
        stepover_mm: needed("stepover_mm", table.stepover_mm)?,
        allowance_mm: allowance_mm(job)?,
        ramp_rad: ramp_deg.to_radians(),
        chord_mm: job.tolerance()?.chord_mm,
    })
}

/// The path of a roughing.
pub fn planned(
    job: &Job,
    faces: &JobFaces,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    let (axis, feed) = drop::directions(job, faces)?;
    let cutter = job.cutter()?;
    let links = passes::links(job, faces, &cutter)?;
    let Some(blank) = stock::bounds(job, faces)? else {
        let text = format!(
            "[strategy] {KIND} needs the raw material: add [stock] with box_mm, file or allowance_mm"
        );
        return Err(Failure::file(&job.path, text));
    };
    let (named, check) = (drop::names(&faces.faces), drop::names(&faces.check));
    let task = RoughTask {
        faces: &named,
        check: &check,
        cutter: &cutter,
        axis,
        feed,
        blank,
        sizes: sizes(job)?,
        links: &links,
        progress,
    };
    let rough = z_level(&task).map_err(|e| Failure::file(&job.path, e))?;
    Ok(Planned {
        passes: rough.passes,
        linked: rough.linked,
        strategy: KIND.to_owned(),
        lean: Lean::default(),
        local: false,
        extras: Extras::default(),
        with_strips: false,
    })
}
