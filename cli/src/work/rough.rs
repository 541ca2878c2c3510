//! Roughing in layers: from the raw material of a job down to an allowance on its faces.

use crate::failure::Failure;
use crate::job::Job;
use crate::job::strategy::Layers;
use crate::part::{LoadedFace, Part};
use crate::work::drop;
use crate::work::extras::Extras;
use crate::work::passes;
use crate::work::program::Planned;
use crate::work::stock;
use osculate_geom::Offset;
use osculate_productivity::plan::{RoughTask, Sizes, z_level};
use osculate_surfaces::TrimmedSurface;
use osculate_tools::Lean;

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
    }
}

/// The path of a roughing.
pub fn planned(
    job: &Job,
    faces: &Part,
    layers: &Layers,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    let (axis, feed) = drop::directions(job, faces);
    let cutter = job.cutter();
    let links = passes::links(job, faces, &cutter);
    let Some(blank) = stock::bounds(job, faces)? else {
        return Err(job.refuse("strategy", "kind", "a roughing needs the raw material: add [stock]"));
    };
    let (named, check) = (drop::names(&faces.faces), drop::names(&faces.check));
    let task = RoughTask {
        faces: &named,
        check: &check,
        cutter: &cutter,
        axis,
        feed,
        blank,
        sizes: sizes(job, layers),
        links: &links,
        progress,
    };
    let rough = z_level(&task).map_err(|e| Failure::file(job.path(), e))?;
    Ok(Planned {
        passes: rough.passes,
        skipped: Vec::new(),
        linked: rough.linked,
        strategy: job.strategy().name().to_owned(),
        lean: Lean::default(),
        local: false,
        extras: Extras::default(),
        with_strips: false,
    })
}
