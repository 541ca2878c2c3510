//! Three-axis passes by dropping the cutter: one plan over all faces of a job together.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{self, LoadedFace, Part};
use crate::words::{self, number};
use crate::work::budget::{self, Shares};
use osculate_geom::{Box3, Diagnostic, Unit3, Vec3};
use osculate_productivity::plan::{DropTask, Milling, Named, Passes, ThreeAxisLines};
use osculate_surfaces::lines::{Chart, LineTolerance, turned};

/// Passes over all faces of the job, with its check faces kept clear.
pub fn passes(
    job: &Job,
    faces: &Part,
    lines: ThreeAxisLines,
    shares: Shares,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Passes, Failure> {
    let (axis, feed) = directions(job, faces);
    let task = DropTask {
        faces: &names(&faces.faces),
        check: &names(&faces.check),
        cutter: &job.cutter(),
        axis,
        feed,
        tolerance: budget::upright(job, faces, shares),
        progress,
    };
    let mut found = lines.passes(&task).map_err(|e| Failure::file(job.path(), e))?;
    if lines != ThreeAxisLines::Waterlines && !job.cutter().is_ball() {
        found.diagnostics.extend(faces.faces.iter().filter_map(|face| minima(face, axis)));
    }
    // Waterlines have material on the right.
    if lines == ThreeAxisLines::Waterlines && job.strategy().senses.milling == Milling::Conventional {
        found.passes.iter_mut().for_each(|p| p.points.reverse());
    }
    Ok(found)
}

/// What is to be said of a face whose height along the axis has minima: no flat bottom gets around them [M86, 5.2].
fn minima(face: &LoadedFace, axis: Unit3) -> Option<Diagnostic> {
    let size_mm = (part::bounds(face).max - part::bounds(face).min).norm();
    let chart = Chart::new(&*face.surface, LineTolerance::for_size(size_mm)).ok()?;
    let turn = turned(&chart, axis);
    let asked = words::minima(turn.asked.minima);
    let text = match turn.fewest.minima {
        _ if turn.asked.minima == 0 => return None,
        fewest if fewest < turn.asked.minima => {
            let [x, y, z] =
                [turn.fewest.axis.x, turn.fewest.axis.y, turn.fewest.axis.z].map(|x| number(x, 4));
            let deg = number(turn.fewest.turn_rad.to_degrees(), 3);
            format!(
                "{asked} of height along the axis, which a flat bottom does not get around; along [{x}, {y}, {z}], {deg} deg off, {}",
                words::minima(fewest)
            )
        }
        _ => format!(
            "{asked} of height along the axis, which a flat bottom does not get around; along no other are there fewer"
        ),
    };
    Some(Diagnostic::note(face.id.clone(), text))
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
pub fn longest(faces: &[LoadedFace], axis: &Unit3) -> Vec3 {
    let bounds = faces.iter().map(part::bounds).fold(Box3::empty(), |a, b| a.union(&b));
    let size = bounds.max - bounds.min;
    [Vec3::x(), Vec3::y(), Vec3::z()]
        .into_iter()
        .enumerate()
        .map(|(k, e)| (e - axis.into_inner() * axis.dot(&e)) * size[k])
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .unwrap_or_else(Vec3::x)
}
