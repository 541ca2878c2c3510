//! Three-axis passes by dropping the cutter: one plan over all faces of a job together.

use crate::failure::Failure;
use crate::job::Job;
use crate::job::strategy::Drop;
use crate::part::{self, LoadedFace, Part};
use crate::work::budget;
use osculate_geom::{Box3, Unit3, Vec3};
use osculate_productivity::plan::{DropTask, Milling, Named, Passes, drop_cutter, gradient_3c, waterline_3c};

/// Passes over all faces of the job, with its check faces kept clear.
pub fn passes(
    job: &Job,
    faces: &Part,
    kind: Drop,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Passes, Failure> {
    let (axis, feed) = directions(job, faces);
    let task = DropTask {
        faces: &names(&faces.faces),
        check: &names(&faces.check),
        cutter: &job.cutter(),
        axis,
        feed,
        tolerance: budget::upright(job, faces),
        progress,
    };
    let plan = match kind {
        Drop::Planes => drop_cutter,
        Drop::Gradient => gradient_3c,
        Drop::Waterlines => waterline_3c,
    };
    let mut found = plan(&task).map_err(|e| Failure::file(job.path(), e))?;
    // Waterlines have material on the right.
    if kind == Drop::Waterlines && job.strategy().senses.milling == Milling::Conventional {
        found.passes.iter_mut().for_each(|p| p.points.reverse());
    }
    Ok(found)
}

/// The tool axis, and the way of the passes.
pub fn directions(job: &Job, faces: &Part) -> (Unit3, Vec3) {
    let strategy = job.strategy();
    let feed = strategy.feed_direction.unwrap_or_else(|| longest(&faces.faces, &strategy.axis));
    (strategy.axis, feed)
}

/// Faces with their names.
pub fn names(faces: &[LoadedFace]) -> Vec<Named<'_>> {
    faces.iter().map(|f| Named { face: &f.id, surface: &*f.surface }).collect()
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
