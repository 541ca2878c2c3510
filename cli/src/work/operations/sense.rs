//! What of a list of operations cannot be meant, told before anything is planned: faces that nothing finishes, raw material that does not
//! hold the part, fixtures that stand in it.

use crate::failure::Failure;
use crate::job::{Blank, Job, OperationWord, Operations};
use crate::part::{self, Part};
use crate::words::number;
use crate::work::operations::passages::Passages;
use crate::work::stock;
use osculate_geom::{Point3, Unit3};

/// Points of a face along each of its sides that a fixture is held against.
const GRID: usize = 16;
/// A fixture touches the part, but stands no deeper in it than this, mm.
const TOUCH_MM: f64 = 0.1;

/// Refuses a list that cannot be meant for its part.
///
/// # Errors
/// With what to change.
pub fn check(list: &Operations, part: &Part) -> Result<(), Failure> {
    finished(list, part)?;
    held(list, part)?;
    list.setups().iter().try_for_each(|setup| clear(&setup.name, &setup.job, part))
}

/// Every face is brought to its tolerance by something.
fn finished(list: &Operations, part: &Part) -> Result<(), Failure> {
    let mut finished: Vec<String> = Vec::new();
    for operation in list.all() {
        let own = Passages::of(operation, &operation.judged()?, part)?.into_all();
        if operation.kind != OperationWord::Rough {
            finished.extend(own.faces.into_iter().map(|f| f.id));
        }
    }
    // A list that only roughs leaves all finishing to another job.
    if list.all().iter().all(|o| o.kind == OperationWord::Rough) {
        return Ok(());
    }
    let ids = part.faces.iter().map(|f| f.id.as_str());
    let nothing: Vec<&str> = ids.filter(|id| !finished.iter().any(|f| f == id)).collect();
    if nothing.is_empty() {
        return Ok(());
    }
    let (are, them) = if nothing.len() == 1 { ("is", "it") } else { ("are", "them") };
    Err(Failure::file(
        list.path(),
        format!(
            "{} {are} machined by nothing: name {them} in an operation that finishes, or leave {them} out of [part] faces",
            nothing.join(", ")
        ),
    ))
}

/// The raw material holds the faces to machine.
fn held(list: &Operations, part: &Part) -> Result<(), Failure> {
    let job = list.whole();
    let (Some(bounds), Some(given)) = (stock::bounds(job, part)?, job.stock()) else { return Ok(()) };
    // What was left by another program is good to its cells.
    let cells = if matches!(given.blank, Blank::File { .. }) {
        (bounds.max - bounds.min).amax() / 100.0
    } else {
        0.0
    };
    match stock::holds(&bounds.grown(cells), &stock::around(part)) {
        Some(said) => Err(job.refuse("stock", "", said.message)),
        None => Ok(()),
    }
}

/// No fixture stands in the part.
fn clear(name: &str, job: &Job, part: &Part) -> Result<(), Failure> {
    let samples = stock::fixtures(job, part)?;
    if samples.is_empty() {
        return Ok(());
    }
    let faces = part.faces.iter().chain(&part.check);
    let points: Vec<(Point3, Unit3)> =
        faces.flat_map(|f| part::grid(&*f.surface, GRID)).map(|(_, p, n)| (p, n)).collect();
    let closed = part.part.faces.len() > 1;
    let mut worst: Option<(f64, Point3)> = None;
    for s in samples.iter().filter(|_| closed) {
        let away = |p: &Point3| (p - s.point).norm_squared();
        let Some((p, n)) = points.iter().min_by(|a, b| away(&a.0).total_cmp(&away(&b.0))) else { break };
        let depth = -(s.point - p).dot(n);
        if depth > TOUCH_MM && worst.is_none_or(|w| depth > w.0) && is_within(job, part, &s.point)? {
            worst = Some((depth, s.point));
        }
    }
    match worst {
        Some((depth, p)) => {
            let what = format!(
                "fixtures: in setup {name} one of them stands {} mm deep in the part at ({:.2}, {:.2}, {:.2}): move it, or the part's \
                 frame is not that of its mesh",
                number(depth, 3),
                p.x,
                p.y,
                p.z
            );
            Err(job.refuse("setup", "fixtures", what))
        }
        None => Ok(()),
    }
}

/// Whether a point lies in the raw material: what stands outside of it stands in no part.
fn is_within(job: &Job, part: &Part, p: &Point3) -> Result<bool, Failure> {
    let Some(bounds) = stock::bounds(job, part)? else { return Ok(true) };
    Ok((0..3).all(|k| p[k] > bounds.min[k] && p[k] < bounds.max[k]))
}
