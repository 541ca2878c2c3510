//! Bodies of the machine along a program: its head against table, part and what holds it, the tools against the table.

use crate::failure::Failure;
use crate::job::{Control, Job};
use crate::part::Part;
use crate::triangles::triangles;
use crate::words::number;
use crate::work::nc;
use crate::work::stock::RawMaterial;
use osculate_geom::Point3;
use osculate_geom::convex::{Convex, Crowd};
use osculate_postproc::Setup;
use osculate_postproc::meetings::{self, CLEARANCE_MM, InSpindle, Meeting, Standing};
use osculate_surfaces::tessellate;
use osculate_tools::Cutter;
use osculate_tools::removal::{GoalControl, Gravity, Remark};

/// Triangles of the part lie off it by this share of what bodies keep clear.
const CHORD_SHARE: f64 = 0.1;
/// Arcs of a cutter's outline are cut into pieces that turn by this, rad.
const OUTLINE_RAD: f64 = 0.2;
/// What raw material is called: some of it may be gone by then.
const RAW: &str = "raw material";

/// Adds what the bodies of the machine do in a program to the state of the control. Nothing where the machine has none.
///
/// # Errors
/// Where files of the job cannot be read, or the program cannot be.
pub fn look(
    to: &mut GoalControl,
    text: &str,
    (job, tools): (&Job, &[Job]),
    control: &Control,
    setup: &Setup,
    (faces, lenient): (&Part, bool),
) -> Result<(), Failure> {
    let bodies = control.machine.bodies();
    if bodies.is_empty() {
        return Ok(());
    }
    let standing = standing(job, faces)?;
    let held: Vec<InSpindle> = tools.iter().map(in_spindle).collect::<Result<_, _>>()?;
    let lengths = nc::lengths(tools);
    let text = control.language.engine_text(text);
    let (found, _) = meetings::meetings(
        &text,
        control.dialect,
        &control.machine,
        (setup, &lengths),
        (&standing, &held),
        !lenient,
    )
    .map_err(Failure::job)?;
    to.remarks.extend(found.found.iter().map(remark));
    let names = |of_head: bool| -> Vec<String> {
        bodies.iter().filter(|b| b.of_head == of_head).map(|b| b.name.clone()).collect()
    };
    let or_none = |names: Vec<String>| if names.is_empty() { "no body".to_owned() } else { names.join(", ") };
    let things: Vec<String> = standing.iter().map(|s| s.name.clone()).collect();
    to.bodies = format!(
        "of the head {}, of table and bed {}: {} mm apart all along every block, the head from {} too, the tools from table and bed",
        or_none(names(true)),
        or_none(names(false)),
        number(CLEARANCE_MM, 1),
        things.join(", ")
    );
    Ok(())
}

fn remark(m: &Meeting) -> Remark {
    let gone = m.other == RAW;
    let near = if m.least_mm > 0.0 {
        format!("comes within {} mm of", number(CLEARANCE_MM, 1))
    } else {
        "meets".to_owned()
    };
    let blocks = if m.blocks == 1 { String::new() } else { format!(" ({} blocks)", m.blocks) };
    let what =
        if gone { " as it was before the first cut: what is gone by then is not looked at" } else { "" };
    let text = format!("line {}: {} {near} {}{what}{blocks}", m.line, m.mover, m.other);
    Remark { gravity: if gone { Gravity::Open } else { Gravity::Breaks }, text }
}

/// What stands on the table of a job.
fn standing(job: &Job, faces: &Part) -> Result<Vec<Standing>, Failure> {
    let mut out = Vec::new();
    let mut add = |name: &str, members: Vec<Convex>| {
        // What has no triangles is in nobody's way.
        if let Ok(shape) = Crowd::new(members) {
            out.push(Standing { name: name.to_owned(), shape });
        }
    };
    let chord_mm = CHORD_SHARE * CLEARANCE_MM;
    let mut part = Vec::new();
    for face in faces.faces.iter().chain(&faces.check) {
        let mesh = tessellate(&face.surface, chord_mm, None);
        let at = |k: u32| Point3::from(mesh.positions[k as usize]);
        part.extend(mesh.triangles.iter().map(|t| Convex::Triangle(t.map(at))));
    }
    add("the part", part);
    for file in job.fixture().map_or(&[][..], |table| &table.files) {
        add("a fixture", triangles(file)?.into_iter().map(Convex::Triangle).collect());
    }
    if let Some(raw) = RawMaterial::of(job, faces)? {
        add(RAW, raw.members());
    }
    Ok(out)
}

/// A tool as the spindle holds it.
fn in_spindle(job: &Job) -> Result<InSpindle, Failure> {
    let cutter = job.cutter();
    let mut members = turned(&cutter, 0.0);
    for section in job.holder().map_or(&[][..], |h| h.sections()) {
        members.extend(turned(&section.body, cutter.length_mm() + section.above_mm));
    }
    let shape = Crowd::new(members).map_err(Failure::job)?;
    Ok(InSpindle { number: Some(job.tool().number()), shape })
}

/// A round body as cones, one on the other.
fn turned(body: &Cutter, above_mm: f64) -> Vec<Convex> {
    let outline = body.outline_mm(OUTLINE_RAD);
    let at = |z: f64| Point3::new(0.0, 0.0, above_mm + z);
    outline
        .windows(2)
        .map(|w| Convex::Frustum { ends: [at(w[0][1]), at(w[1][1])], radii_mm: [w[0][0], w[1][0]] })
        .collect()
}
