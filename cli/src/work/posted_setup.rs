//! Where the part of a program sits: as its head says it was posted for, unless the job says another place.

use crate::job::Job;
use crate::part::Part;
use crate::work::setup;
use nalgebra::Isometry3;
use osculate_geom::Diagnostic;
use osculate_postproc::Setup;
use osculate_postproc::nc::Dialect;

/// Places this far apart are two, mm: below it is the resolution of programs.
const APART_MM: f64 = 1e-3;
/// Turns this far apart are two, rad: it moves a point one metre off by as much.
const TURNED_RAD: f64 = 1e-6;

/// The setup for reading a program back. What `[setup]` gives of place and turn counts, the rest is what the head of the
/// program says; where that says nothing it is found from the faces. What contradicts is warned of.
pub fn of_program(job: &Job, faces: &Part, text: &str, dialect: Dialect) -> (Setup, Vec<Diagnostic>) {
    let (own, mut own_notes) = setup::of(job, faces, None);
    let posted = match Setup::of_program(text, dialect) {
        Ok(Some(posted)) => posted,
        Ok(None) => return (own, own_notes),
        Err(e) => {
            let text = format!("the program's head: {e}; taken from the job");
            own_notes.push(Diagnostic::warning("setup", text));
            return (own, own_notes);
        }
    };
    let mut notes = Vec::new();
    let (place, turn) = (posted.part_zero.translation, posted.part_zero.rotation);
    if (own.gauge_length_mm - posted.gauge_length_mm).abs() > APART_MM {
        notes.push(Diagnostic::warning(
            "tool",
            format!(
                "the program is posted for a gauge length of {:.4} mm, cutter and holder of the job have {:.4} mm, which is \
                 taken: is it another tool?",
                posted.gauge_length_mm, own.gauge_length_mm
            ),
        ));
    }
    let contradicts = |key: &str, is: String, said: String| {
        let text = format!("[setup] {key} = {is} is taken, but the program is posted for {key} = {said}");
        Diagnostic::warning("setup", text)
    };
    let [own_deg, posted_deg] = [own, posted].map(|s| triple(angles_deg(&s)));
    if job.setup().rotate_deg.is_some() && own.part_zero.rotation.angle_to(&turn) > TURNED_RAD {
        // A place found for another turn says nothing: where the job gives none it is found anew.
        notes.push(contradicts("rotate_deg", own_deg, posted_deg));
        notes.extend(own_notes);
        return (own, notes);
    }
    let own_place = own.part_zero.translation;
    let mut taken = posted;
    if job.setup().part_zero_mm.is_some() {
        taken.part_zero.translation = own_place;
        if (own_place.vector - place.vector).norm() > APART_MM {
            let [is, said] = [own_place, place].map(|t| triple([t.x, t.y, t.z]));
            notes.push(contradicts("part_zero_mm", is, said));
        }
    }
    if job.setup().rotate_deg.is_some() {
        taken.part_zero = Isometry3::from_parts(taken.part_zero.translation, own.part_zero.rotation);
    }
    taken.gauge_length_mm = own.gauge_length_mm;
    let said: Vec<String> = [
        job.setup()
            .part_zero_mm
            .is_none()
            .then(|| format!("part_zero_mm = {}", triple([place.x, place.y, place.z]))),
        job.setup().rotate_deg.is_none().then(|| format!("rotate_deg = {posted_deg}")),
    ]
    .into_iter()
    .flatten()
    .collect();
    if !said.is_empty() {
        let text = format!("{}, as the program's head says it is posted for", said.join(", "));
        notes.push(Diagnostic::note("setup", text));
    }
    (taken, notes)
}

/// The turn as `rotate_deg` has it: about x, then y, then z.
fn angles_deg(setup: &Setup) -> [f64; 3] {
    setup.turn_rad().map(f64::to_degrees)
}

/// Three numbers for a message, without a minus at zero.
fn triple(v: [f64; 3]) -> String {
    let [x, y, z] = v.map(|x| (1e4 * x).round() / 1e4 + 0.0);
    format!("[{x:.4}, {y:.4}, {z:.4}]")
}
