//! Three-axis passes by dropping the cutter: one plan over all faces of a job together.

use crate::failure::Failure;
use crate::job::{Job, LeadKey};
use crate::part::{self, JobFaces, LoadedFace};
use crate::work::budget;
use osculate_geom::{Box3, Unit3, Vec3};
use osculate_productivity::plan::{DropTask, Named, Passes, drop_cutter, gradient_3c};

/// The keys of job files.
pub const KINDS: [&str; 2] = ["isoplanar_3c", "gradient_3c"];

/// Passes over all faces of the job, with its check faces kept clear.
pub fn passes(job: &Job, faces: &JobFaces, progress: &(dyn Fn(f64) + Sync)) -> Result<Passes, Failure> {
    let (axis, feed) = directions(job, faces)?;
    let task = DropTask {
        faces: &names(&faces.faces),
        check: &names(&faces.check),
        cutter: &job.cutter()?,
        axis,
        feed,
        tolerance: budget::upright(job, faces)?,
        progress,
    };
    let plan = if job.strategy.kind == "gradient_3c" { gradient_3c } else { drop_cutter };
    plan(&task).map_err(|e| Failure::file(&job.path, e))
}

/// The tool axis, and the way of the passes.
pub fn directions(job: &Job, faces: &JobFaces) -> Result<(Unit3, Vec3), Failure> {
    let table = &job.strategy;
    let kind = &table.kind;
    if table.lead_deg == LeadKey::Local
        || matches!(table.lead_deg, LeadKey::Given(l) if l != 0.0)
        || table.tilt_deg != 0.0
    {
        return Err(Failure::file(
            &job.path,
            format!("[strategy] {kind} keeps the tool axis on `axis`: leave out lead_deg and tilt_deg"),
        ));
    }
    let axis = job.contour_axis()?;
    let feed = match table.feed_direction {
        Some(d) => given(job, d, &axis)?,
        None => longest(&faces.faces, &axis),
    };
    Ok((axis, feed))
}

/// Faces with their names.
pub fn names(faces: &[LoadedFace]) -> Vec<Named<'_>> {
    faces.iter().map(|f| Named { face: &f.id, surface: &*f.surface }).collect()
}

/// The job's own direction, which must lie across the axis for a good part.
fn given(job: &Job, d: [f64; 3], axis: &Unit3) -> Result<Vec3, Failure> {
    let v = Vec3::from(d);
    let across = v - axis.into_inner() * v.dot(axis);
    // Less than a degree away from the axis a direction says nothing about the passes.
    if across.norm().is_finite() && across.norm() > 0.0175 * v.norm() {
        Ok(v)
    } else {
        Err(Failure::file(
            &job.path,
            format!("[strategy] feed_direction = {d:?} must point across the tool axis"),
        ))
    }
}

/// The longest side of the box around the faces that lies across the axis: fewest turns.
fn longest(faces: &[LoadedFace], axis: &Unit3) -> Vec3 {
    let bounds = faces.iter().map(part::bounds).fold(Box3::empty(), |a, b| a.union(&b));
    let size = bounds.max - bounds.min;
    [Vec3::x(), Vec3::y(), Vec3::z()]
        .into_iter()
        .enumerate()
        .map(|(k, e)| (e - axis.into_inner() * axis.dot(&e)) * size[k])
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .unwrap_or_else(Vec3::x)
}
