//! Where the part of a job sits on the machine.

use crate::job::Control;
use crate::job::Job;
use crate::job::Turns;
use crate::part::{self, Part};
use crate::work::{budget, nc};
use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::{Diagnostic, Point3, Unit3, Vec3};
use osculate_postproc::nc::Dialect;
use osculate_postproc::{
    FeedMode, Machine, Orienting, Pace, Setup, axis_turns, clamped_turns, first_in_range, free_turns,
    into_travel, quicker_turns, suggest, tilts,
};
use osculate_tools::Pose;
use osculate_tools::cl::ClPath;

/// A path for which a setup is sought.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Along<'a> {
    /// All of it: its tool axes are to be in the range of the joints.
    pub path: &'a ClPath,
    /// Tool axes of its passes, which are to look up.
    pub axes: &'a [Unit3],
}

/// Where the part of a job sits on the machine, as the job says or as is found: turned so that the faces look up, or the tool axes of
/// a path, with all of which in the range of the joints where any turn does that.
pub fn of(job: &Job, faces: &Part, along: Option<Along<'_>>) -> (Setup, Vec<Diagnostic>) {
    let s = job.setup();
    let gauge = nc::gauge_mm(job);
    let (points, normals): (Vec<Point3>, Vec<Unit3>) = looks(faces).unzip();
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
            let turn = Turn::of(s.turns, &job.control().machine, &normals, along);
            let setup = standing(turn.rotation, &points, gauge);
            if turn.rotation != UnitQuaternion::identity() {
                notes.push(note_of_turn(turn.why, &setup));
            }
            setup
        }
    };
    if let Some(zero) = s.part_zero_mm {
        setup.part_zero.translation = Translation3::from(Vec3::from(zero));
    } else {
        let machine = &job.control().machine;
        // Axes that are sought yet lie where the machine leaves them little choice.
        let sought = || on_line(machine, &setup.part_zero.rotation, points.iter().zip(&normals));
        let poses = along.map_or_else(sought, |a| a.path.moves.iter().map(|m| m.pose).collect());
        let moved = into_travel(&poses, machine, &setup).unwrap_or_default();
        setup.part_zero.translation.vector += moved;
        notes.push(note_of_place(&setup, &moved));
    }
    (setup, notes)
}

/// The tool at places of the faces, its axis as near to the normal as a machine of three or four axes has one; nothing for others.
fn on_line<'a>(
    machine: &Machine,
    turned: &UnitQuaternion<f64>,
    looks: impl Iterator<Item = (&'a Point3, &'a Unit3)>,
) -> Vec<Pose> {
    if machine.rotary().len() > 1 {
        return Vec::new();
    }
    let joints = Orienting::new(machine, turned);
    looks.map(|(tip, normal)| Pose { tip: *tip, axis: joints.nearest(normal) }).collect()
}

/// How the part is turned.
struct Turn {
    rotation: UnitQuaternion<f64>,
    why: &'static str,
}

impl Turn {
    /// The best of the turns that the job wants with which all tool axes are in range, else of the others that it allows. Where there is none
    /// the best at all: the post then says what is out of range.
    fn of(turns: Turns, machine: &Machine, normals: &[Unit3], along: Option<Along<'_>>) -> Self {
        let looks = along.map(|a| a.axes).filter(|axes| !axes.is_empty()).unwrap_or(normals);
        let by_axes = || axis_turns(machine, looks);
        let free = || free_turns(machine, looks);
        let (wanted, others) = match turns {
            Turns::None => (by_axes(), Vec::new()),
            Turns::Axis => (by_axes(), free()),
            Turns::Free => (free(), by_axes()),
        };
        let up = match machine.rotary().len() {
            0 | 1 => "so that the faces look where the tool comes from",
            _ => "so that the tool's axes look up",
        };
        let in_range = |turns: &[UnitQuaternion<f64>]| match along {
            Some(a) => first_in_range(a.path, machine, turns),
            None => turns.first().copied(),
        };
        // Axes for three or four joints were found for a part that stands so.
        if along.is_some() && machine.rotary().len() < 2 {
            let found_for = Self::of(turns, machine, normals, None);
            if in_range(&[found_for.rotation]).is_some() {
                return found_for;
            }
        }
        if let Some(rotation) = in_range(&wanted) {
            return Self { rotation, why: up };
        }
        match in_range(&others) {
            Some(rotation) if turns == Turns::Axis => {
                let why = "freely, since no turn that brings one of its own axes up has all tool axes in the range of the joints";
                Self { rotation, why }
            }
            Some(rotation) => Self { rotation, why: up },
            None => Self { rotation: wanted.first().copied().unwrap_or_default(), why: up },
        }
    }
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
    // Without a minus at zero.
    let [x, y, z] = setup.turn_rad().map(|x| (1e3 * x.to_degrees()).round() / 1e3 + 0.0);
    let how = if [x, y, z] == [0.0; 3] { "stands as in its file" } else { "is turned" };
    Diagnostic::note("setup", format!("the part {how} {why}: rotate_deg = [{x:.3}, {y:.3}, {z:.3}]"))
}

fn note_of_place(setup: &Setup, moved: &Vec3) -> Diagnostic {
    let t = setup.part_zero.translation.vector;
    let far = moved.norm();
    let why = if far > 0.0 {
        format!(", moved by {far:.3} mm so that the linear joints can go along the path")
    } else {
        String::new()
    };
    let place =
        format!("part_zero_mm = [{:.4}, {:.4}, {:.4}], from the box of the faces{why}", t.x, t.y, t.z);
    Diagnostic::note("setup", place)
}

/// Turned parts that are posted beside the one that stands as suggested.
const MOST_TURNS: usize = 3;
/// Share of the time that a turn must seem to save to be posted, and save to be taken.
pub const WORTH_A_TURN: f64 = 0.03;

/// Setups with the part turned so that the joints seem to hold the path up less than in `setup`, in the range of the joints; none where the
/// job says where the part is, or wants no turns.
pub fn turned(job: &Job, faces: &Part, path: &ClPath, control: &Control, setup: &Setup) -> Vec<Setup> {
    if job.setup().rotate_deg.is_some() || job.setup().part_zero_mm.is_some() {
        return Vec::new();
    }
    let points: Vec<Point3> = looks(faces).map(|l| l.0).collect();
    let machine = &control.machine;
    let turns = match job.setup().turns {
        Turns::None => return Vec::new(),
        Turns::Axis => clamped_turns(machine),
        Turns::Free => tilts(&setup.part_zero.rotation),
    };
    let pace = match (control.dialect, control.feed) {
        (Dialect::LinuxCnc, FeedMode::Tcp) => Pace::ByBlocks { tip_tol_mm: None },
        (Dialect::LinuxCnc, _) => Pace::ByBlocks { tip_tol_mm: Some(budget::solve(job, 0.0).tip_tol_mm) },
        (Dialect::Sinumerik | Dialect::Heidenhain | Dialect::Fanuc, _) => Pace::Through,
    };
    quicker_turns(path, machine, setup, &turns, (WORTH_A_TURN, pace))
        .into_iter()
        .take(MOST_TURNS)
        .map(|rotation| standing(rotation, &points, setup.gauge_length_mm))
        .collect()
}

/// What is said of a part that is turned for this time; `before_min` is that of the program where it stands as found first, absent
/// where there is none.
pub fn notes_of_turned(setup: &Setup, before_min: Option<f64>, now_min: f64) -> Vec<Diagnostic> {
    let why = match before_min {
        Some(before_min) => {
            format!("so that the joints hold the path up less ({now_min:.2} min instead of {before_min:.2})")
        }
        None => "so that the joints can go along the path".to_owned(),
    };
    vec![note_of_turn(&why, setup), note_of_place(setup, &Vec3::zeros())]
}
