//! Fields of the tool's axis over the faces of a job.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{LoadedFace, Part};
use crate::work::setup;
use osculate_geom::{Axis, Diagnostic, Jet2, Unit3, Uv, Vec3};
use osculate_postproc::Orienting;
use osculate_productivity::axis::{self, Around, Feed, Found, Joints, Surroundings, Wish};
use osculate_productivity::plan::{Along, Named, Strategy, Tolerance};
use osculate_tools::Cutter;
use osculate_tools::reach::{Member, Tool};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// Axes of a machine with one rotary joint are tried so far apart, rad.
const LINE_RAD: f64 = 0.02;
/// Share of the gouge tolerance that axes may use: chords and words need the rest.
const ACCEPTED: f64 = 0.6;
/// Axes lean off the normal by a right angle less this at most, rad.
const UPRIGHT_RAD: f64 = 0.035;
/// A flat bottom leans so much at least, rad: else it rubs where it should cut.
const LEAST_RAD: f64 = 0.017_453_292_519_943_295;

/// The rotary joints of the job's machine.
struct Rotary<'a>(Orienting<'a>);

impl Joints for Rotary<'_> {
    fn reaches(&self, axis: &Unit3) -> bool {
        self.0.reaches(axis)
    }
    fn turn_s(&self, from: &Unit3, to: &Unit3) -> f64 {
        self.0.turn_s(from, to).unwrap_or(f64::INFINITY)
    }
    fn nearest(&self, axis: &Unit3) -> Unit3 {
        self.0.nearest(axis)
    }
    fn line(&self) -> Option<Vec<Unit3>> {
        self.0.line(LINE_RAD)
    }
}

/// All faces of a job as points that the tool keeps out of.
pub fn surroundings(job: &Job, faces: &Part, cutter: &Cutter) -> Result<Surroundings, Failure> {
    fn named(all: &[LoadedFace]) -> Vec<Named<'_>> {
        all.iter().map(|f| Named { face: &f.id, surface: &*f.surface }).collect()
    }
    let around = Around {
        faces: &named(&faces.faces),
        check: &named(&faces.check),
        cutter,
        gouge_mm: ACCEPTED * job.tolerance().gouge_mm,
    };
    Surroundings::of(&around).map_err(|(face, e)| Failure::file(job.path(), format!("face {face}: {e}")))
}

/// The direction in which passes of a strategy run, where it says one before they are laid out.
pub fn feed_of(strategy: &Strategy) -> impl Fn(Uv, &Jet2) -> Option<Vec3> + Sync + use<> {
    let along = match strategy {
        Strategy::Isoparametric { along: Along::Fixed(axis) }
        | Strategy::Regions { along: Along::Fixed(axis) } => Some(*axis),
        _ => None,
    };
    move |_: Uv, jet: &Jet2| along.map(|axis| if axis == Axis::U { jet.du } else { jet.dv })
}

/// The field of axes over a face for passes that run along `feed`, and what is to be said of it.
pub fn found(
    job: &Job,
    faces: &Part,
    (face, around): (&LoadedFace, &Surroundings),
    (tolerance, feed): (Tolerance, &Feed<'_>),
) -> Result<(Found, Vec<Diagnostic>), Failure> {
    let (cutter, holder) = (job.cutter(), job.holder());
    let (setup, _) = setup::of(job, faces, None);
    let control = job.control();
    let joints = Rotary(Orienting::new(&control.machine, &setup.part_zero.rotation));
    let wish = Wish {
        surface: &*face.surface,
        feed,
        scallop_mm: tolerance.scallop_mm,
        feed_mm_min: job.feed_mm_min(),
        joints: &joints,
        tool: &Tool::new(cutter, holder),
        around,
        lean_rad: [if cutter.is_ball() { 0.0 } else { LEAST_RAD }, FRAC_PI_2 - UPRIGHT_RAD],
    };
    let found = axis::find(&wish).map_err(|e| Failure::file(job.path(), format!("face {}: {e}", face.id)))?;
    let mut said = Vec::new();
    if !found.unreached.is_empty() {
        let mut by: BTreeMap<String, f64> = BTreeMap::new();
        for place in &found.unreached {
            let why = place.best.map_or_else(
                || "no axis of the machine".to_owned(),
                |best| {
                    let (body, owner) = best.gap.met.map_or(("nothing", None), |met| {
                        let body = if met.member == Member::Cutter { "the cutter" } else { "the holder" };
                        (body, Some(met.obstacle.owner as usize))
                    });
                    let all = || faces.faces.iter().chain(&faces.check);
                    let name = owner.and_then(|k| all().nth(k)).map_or("nothing", |f| f.id.as_str());
                    format!("{body} meets {name}")
                },
            );
            *by.entry(why).or_default() += place.area_mm2;
        }
        let all: f64 = by.values().sum();
        let why =
            by.iter().map(|(why, area)| format!("{why} ({area:.1} mm2)")).collect::<Vec<_>>().join(", ");
        said.push(Diagnostic::warning(
            &face.id,
            format!("no axis reaches {all:.1} of {:.1} mm2, at the best of all axes: {why}", found.area_mm2),
        ));
    }
    let [unsettled, asked] = found.unsettled;
    if unsettled > 0 {
        said.push(Diagnostic::note(
            &face.id,
            format!("the field of axes is not clear at {unsettled} of {asked} places"),
        ));
    }
    Ok((found, said))
}
