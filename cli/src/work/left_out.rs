//! What a job leaves out of its passes where the tool would go into the part: the keys, the figures and their tables.

use crate::failure::Failure;
use crate::job::{Gouges, Job};
use crate::part::Part;
use crate::report::{Column, Table};
use crate::words::number;
use crate::work::budget;
use crate::work::drop::names;
use crate::work::extras::{Extras, FaceLeftOut};
use crate::work::passes;
use osculate_geom::{Box3, Diagnostic};
use osculate_productivity::plan::{CcPoint, Guard, LeftOut, Linked, Passes, Stretches, leave_out};

/// Rims of check faces are looked at up to so many radii of the tool around its contacts, at places so many of them apart.
const NEAR: f64 = 3.0;
const RIM: f64 = 0.1;

/// Whether the job wants places left out at which the tool would go into the part.
pub fn is_wanted(job: &Job) -> bool {
    job.strategy().gouges == Gouges::LeaveOut
}

/// What remains of passes with the tool of the job, whatever its keys say.
pub fn of(job: &Job, faces: &Part, passes: &Passes) -> Result<LeftOut, Failure> {
    let holder = job.holder();
    let radius_mm = job.cutter().radius_mm();
    let contacts = passes.passes.iter().flat_map(|p| &p.points);
    let near = Box3::around(contacts.map(|p| &p.point)).grown(NEAR * radius_mm);
    let mut rims = passes::rims(&faces.check, RIM * radius_mm);
    rims.retain(|s| (0..3).all(|k| (near.min[k]..=near.max[k]).contains(&s.point[k])));
    let guard = Guard {
        faces: &names(&faces.faces),
        check: &names(&faces.check),
        rims: &rims,
        cutter: &job.cutter(),
        holder,
        tolerance: budget::left_in(job),
        keep_off_mm: job.strategy().keep_off_mm,
        left: faces.left(),
    };
    leave_out(passes, &guard).map_err(|e| Failure::file(job.path(), e))
}

/// Passes in their order, joined.
#[non_exhaustive]
pub struct Joined {
    /// The passes.
    pub passes: Passes,
    /// After each what was taken out of the pass that it is of, up to the next.
    pub skipped: Vec<Vec<CcPoint>>,
    /// The path.
    pub linked: Linked,
    /// What the report says of what was left out.
    pub extras: Extras<'static>,
}

/// Passes with what the job wants left out of them, put in order and joined. After each pass is what was taken out of it already, if
/// anything was.
///
/// # Errors
/// Where nothing remains, or faces cannot be looked at.
pub fn linked(
    job: &Job,
    faces: &Part,
    (passes, skipped): (Passes, Vec<Vec<CcPoint>>),
) -> Result<Joined, Failure> {
    let joined = |passes: Passes, skipped: Vec<Vec<CcPoint>>, extras: Extras<'static>| {
        let Passes { passes, diagnostics } = passes;
        let all = if skipped.is_empty() { passes.into() } else { Stretches { passes, skipped } };
        let ordered = passes::in_order(job, faces, all)?;
        let linked = passes::linked(job, faces, &ordered)?;
        let passes = Passes { passes: ordered.passes, diagnostics };
        Ok(Joined { passes, skipped: ordered.skipped, linked, extras })
    };
    let mut extras = Extras::default();
    if !is_wanted(job) {
        return joined(passes, skipped, extras);
    }
    let LeftOut { passes: rest, skipped: cut, touched, area_mm2 } = of(job, faces, &passes)?;
    let skipped = if touched > 0 { cut } else { skipped };
    if rest.passes.is_empty() {
        let text = "[strategy] gouges = \"leave_out\": nothing remains: the tool goes into the part or a check face all along \
                    the passes";
        return Err(Failure::file(job.path(), text));
    }
    if touched > 0 {
        let found = faces.faces.iter().zip(area_mm2).filter(|(_, a)| *a > 0.0);
        extras.left_out = found.map(|(f, area_mm2)| FaceLeftOut { face: f.id.clone(), area_mm2 }).collect();
        let text = format!(
            "stretches of {touched} of {} passes, where the tool would go into the part or a check face, are not cut: {}",
            passes.passes.len(),
            words(&extras.left_out)
        );
        extras.diagnostics.push(Diagnostic::warning("left out", text));
        extras.tables.push(Table {
            caption: "Left out: the tool would go into the part or a check face".to_owned(),
            columns: ["face", "area mm2"]
                .map(|n| Column { name: n.to_owned(), ..Column::default() })
                .to_vec(),
            rows: extras
                .left_out
                .iter()
                .map(|f| vec![f.face.clone(), format!("{:.3}", f.area_mm2)])
                .collect(),
        });
    }
    joined(rest, skipped, extras)
}

/// Faces and areas in words.
pub fn words(left: &[FaceLeftOut]) -> String {
    if left.is_empty() {
        return "other passes cut all of the faces".to_owned();
    }
    let each: Vec<String> =
        left.iter().map(|f| format!("{} {} mm2", f.face, number(f.area_mm2, 4))).collect();
    format!("{}, which counts as uncut", each.join(", "))
}
