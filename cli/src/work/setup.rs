//! Where the part of a job sits on the machine.

use crate::job::Control;
use crate::job::Job;
use crate::part::{self, Part};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::{Diagnostic, Point3, Unit3, Vec3};
use osculate_postproc::{Setup, quicker_turns, suggest};
use osculate_tools::cl::ClPath;

/// Where the part of a job sits on the machine, as the job says or as [`suggest`] has it: turned so that the faces look up, or
/// the tool axes where there are any.
pub fn of(job: &Job, faces: &Part, axes: &[Unit3]) -> (Setup, Vec<Diagnostic>) {
    let s = job.setup();
    let gauge = job.cutter().length_mm() + job.holder().map_or(0.0, |h| h.length_mm());
    let (points, mut normals): (Vec<Point3>, Vec<Unit3>) = looks(faces).unzip();
    if !axes.is_empty() {
        normals = axes.to_vec();
    }
    // A given turn leaves only the place to be found.
    let given = s.rotate_deg.map(|deg| {
        let [a, b, c] = deg.map(f64::to_radians);
        let turn = |axis: Vec3, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
        turn(Vec3::z(), c) * turn(Vec3::y(), b) * turn(Vec3::x(), a)
    });
    let mut notes = Vec::new();
    let mut setup = match given {
        Some(rotation) => standing(rotation, &points, gauge),
        None => {
            let found = suggest(&normals, &points, gauge);
            if found.turned {
                notes.push(note_of_turn("so that the tool's axes look up", &found.setup));
            }
            found.setup
        }
    };
    if let Some(zero) = s.part_zero_mm {
        setup.part_zero.translation = Translation3::from(Vec3::from(zero));
    } else {
        notes.push(note_of_place(&setup));
    }
    (setup, notes)
}

/// Points of the faces to machine, with their normals.
fn looks(faces: &Part) -> impl Iterator<Item = (Point3, Unit3)> {
    faces.faces.iter().flat_map(|f| part::grid(&*f.surface, 24)).map(|(_, p, n)| (p, n))
}

/// The place of a part with these points that stands turned by a rotation.
fn standing(rotation: UnitQuaternion<f64>, points: &[Point3], gauge_length_mm: f64) -> Setup {
    let there: Vec<_> = points.iter().map(|p| rotation * p).collect();
    let place = suggest(&[], &there, gauge_length_mm).setup.part_zero.translation;
    Setup { part_zero: Isometry3::from_parts(place, rotation), gauge_length_mm }
}

fn note_of_turn(why: &str, setup: &Setup) -> Diagnostic {
    let (x, y, z) = setup.part_zero.rotation.euler_angles();
    let [x, y, z] = [x, y, z].map(f64::to_degrees);
    Diagnostic::note("setup", format!("the part is turned {why}: rotate_deg = [{x:.3}, {y:.3}, {z:.3}]"))
}

fn note_of_place(setup: &Setup) -> Diagnostic {
    let t = setup.part_zero.translation.vector;
    let place = format!("part_zero_mm = [{:.4}, {:.4}, {:.4}], from the box of the faces", t.x, t.y, t.z);
    Diagnostic::note("setup", place)
}

/// Turned parts that are posted beside the one that stands as suggested.
const MOST_TURNS: usize = 2;
/// Share of the time that a turn must seem to save to be posted, and save to be taken.
pub const WORTH_A_TURN: f64 = 0.03;

/// Setups with the part turned so that the joints seem to hold the path up less than in `setup`; none where the job says where
/// the part is.
pub fn turned(job: &Job, faces: &Part, path: &ClPath, control: &Control, setup: &Setup) -> Vec<Setup> {
    if job.setup().rotate_deg.is_some() || job.setup().part_zero_mm.is_some() {
        return Vec::new();
    }
    let points: Vec<Point3> = looks(faces).map(|l| l.0).collect();
    let turns = quicker_turns(path, &control.machine, setup, WORTH_A_TURN);
    turns
        .into_iter()
        .take(MOST_TURNS)
        .map(|rotation| standing(rotation, &points, setup.gauge_length_mm))
        .collect()
}

/// What is said of a turned part.
pub fn notes_of_turned(setup: &Setup, [before_min, now_min]: [f64; 2]) -> Vec<Diagnostic> {
    let why =
        format!("so that the joints hold the path up less ({now_min:.2} min instead of {before_min:.2})");
    vec![note_of_turn(&why, setup), note_of_place(setup)]
}
