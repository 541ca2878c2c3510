//! Fields of the tool's axis over the faces of a job.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{self, LoadedFace, Part};
use crate::work::passes::wall_edges;
use crate::work::setup;
use osculate_geom::{Axis, Diagnostic, Jet2, Unit3, Uv, Vec3};
use osculate_postproc::{Machine, Orienting, Setup, in_travel};
use osculate_productivity::axis::{
    Around, Found, Joints, Left, NoField, Possibilities, Surroundings, Unreached, Wish,
};
use osculate_productivity::plan::{Along, Named, Strategy, Tolerance, WallEdges};
use osculate_tools::reach::{Member, Met, Tool};
use osculate_tools::{Cutter, Pose};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Axes of a machine with one rotary joint are tried so far apart, rad.
const LINE_RAD: f64 = 0.02;
/// Share of the gouge tolerance that axes may use: chords and words need the rest, and they need more next to the least lean, which a
/// ball does not keep to.
const ACCEPTED: f64 = 0.3;
const ACCEPTED_OF_BALLS: f64 = 0.6;
/// Axes lean off the normal by a right angle less this at most, rad.
const UPRIGHT_RAD: f64 = 0.035;
/// In a field a flat bottom leans so much at least, rad: between nodes axes lean a little less than at them, and more than its heel
/// needs ([`Cutter::least_lean_rad`]) must be left there.
pub const LEAST_RAD: f64 = 0.017_453_292_519_943_295;

/// Whether the job's machine leaves axes no more than a line: three or four joints.
pub fn is_line(job: &Job) -> bool {
    job.control().machine.rotary().len() < 2
}

/// The axes of the job's machine in the part's frame where they are no more than a line.
pub fn line(job: &Job, faces: &Part) -> Option<Vec<Unit3>> {
    let (setup, _) = setup::of(job, faces, None);
    Orienting::new(&job.control().machine, &setup.part_zero.rotation).line(LINE_RAD)
}

/// Points a side of a face for its least leans.
const GRID: usize = 24;

/// How far axes of the job's machine must lean off the normals of its faces at least, rad, at points of them; no more than a right angle.
pub fn least_leans_rad(job: &Job, faces: &Part) -> Vec<f64> {
    let (setup, _) = setup::of(job, faces, None);
    let joints = Orienting::new(&job.control().machine, &setup.part_zero.rotation);
    let all = faces.faces.iter().flat_map(|f| part::grid(&*f.surface, GRID));
    all.map(|(_, _, normal)| joints.nearest(&normal).angle(&normal).min(FRAC_PI_2)).collect()
}

/// The joints of the job's machine, with the part as it stands.
struct Standing<'a> {
    rotary: Orienting<'a>,
    machine: &'a Machine,
    setup: Setup,
}

impl<'a> Standing<'a> {
    fn new(machine: &'a Machine, setup: Setup) -> Self {
        Self { rotary: Orienting::new(machine, &setup.part_zero.rotation), machine, setup }
    }
}

impl Joints for Standing<'_> {
    fn reaches(&self, axis: &Unit3) -> bool {
        self.rotary.reaches(axis)
    }
    fn turn_s(&self, from: &Unit3, to: &Unit3) -> f64 {
        self.rotary.turn_s(from, to).unwrap_or(f64::INFINITY)
    }
    fn nearest(&self, axis: &Unit3) -> Unit3 {
        self.rotary.nearest(axis)
    }
    fn line(&self) -> Option<Vec<Unit3>> {
        self.rotary.line(LINE_RAD)
    }
    fn travels(&self, pose: &Pose) -> bool {
        in_travel(pose, self.machine, &self.setup)
    }
}

/// The direction in which passes of a strategy run, where it says one before they are laid out.
fn feed_of<'a>(
    strategy: &'a Strategy,
    walls: Option<&'a WallEdges>,
) -> impl Fn(Uv, &Jet2) -> Option<Vec3> + Sync + use<'a> {
    let along = match strategy {
        Strategy::Isoparametric { along: Along::Fixed(axis) }
        | Strategy::Regions { along: Along::Fixed(axis) } => Some(*axis),
        _ => None,
    };
    move |_: Uv, jet: &Jet2| {
        let parameter = along.map(|axis| if axis == Axis::U { jet.du } else { jet.dv });
        parameter.or_else(|| walls?.along(jet))
    }
}

/// A field, and what is to be said of it.
pub type Told = (Found, Vec<Diagnostic>);

/// What was found, by the place of the face and what else tells one from another.
type Known<K, V> = Mutex<BTreeMap<K, Arc<V>>>;

/// Fields of axes over the faces of a job with one tool, each found once.
#[derive(Default)]
pub struct Fields {
    around: OnceLock<Surroundings>,
    possible: Known<usize, Possibilities>,
    walls: Known<usize, WallEdges>,
    /// By the direction of passes too.
    found: Known<(usize, &'static str), Told>,
}

/// What is known, or else what is made of it now.
fn known<K: Ord, V>(
    all: &Known<K, V>,
    key: K,
    make: impl FnOnce() -> Result<V, Failure>,
) -> Result<Arc<V>, Failure> {
    let lock = || all.lock().unwrap_or_else(PoisonError::into_inner);
    let before = lock().get(&key).cloned();
    if let Some(before) = before {
        return Ok(before);
    }
    let made = Arc::new(make()?);
    lock().insert(key, Arc::clone(&made));
    Ok(made)
}

impl Fields {
    /// The field over a face for passes of a strategy.
    pub fn of(
        &self,
        job: &Job,
        faces: &Part,
        (place, face): (usize, &LoadedFace),
        (tolerance, strategy): (Tolerance, &Strategy),
    ) -> Result<Arc<Told>, Failure> {
        let walls = self.walls(job, faces, place, strategy)?;
        known(&self.found, (place, direction(strategy)), || {
            let found = self.asked(job, faces, (place, face), tolerance, |possible, wish| {
                possible.field(wish, &feed_of(strategy, walls.as_deref()))
            })?;
            Ok(told(faces, face, found))
        })
    }

    /// What stands up beside a face, for a strategy that goes by it.
    pub fn walls(
        &self,
        job: &Job,
        faces: &Part,
        place: usize,
        strategy: &Strategy,
    ) -> Result<Option<Arc<WallEdges>>, Failure> {
        match strategy {
            Strategy::AlongWalls => {
                known(&self.walls, place, || wall_edges(job, faces, place, &job.cutter())).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Asks what is possible over a face, whatever the direction of passes.
    pub fn asked<T>(
        &self,
        job: &Job,
        faces: &Part,
        (place, face): (usize, &LoadedFace),
        tolerance: Tolerance,
        ask: impl FnOnce(&Possibilities, &Wish<'_>) -> Result<T, NoField>,
    ) -> Result<T, Failure> {
        if self.around.get().is_none() {
            let _ = self.around.set(surroundings(job, faces, &job.cutter())?);
        }
        let (cutter, holder) = (job.cutter(), job.holder());
        let (setup, _) = setup::of(job, faces, None);
        let control = job.control();
        let wish = Wish {
            surface: &*face.surface,
            scallop_mm: tolerance.scallop_mm,
            feed_mm_min: job.feed_mm_min(),
            joints: &Standing::new(&control.machine, setup),
            tool: &Tool::new(cutter, holder),
            around: self.around.get_or_init(Surroundings::default),
            lean_rad: leans_rad(&cutter),
        };
        let failed = |e| Failure::file(job.path(), format!("face {}: {e}", face.id));
        let possible = known(&self.possible, place, || Possibilities::of(&wish).map_err(failed))?;
        ask(&possible, &wish).map_err(failed)
    }
}

/// The least and the greatest lean off the normal that a cutter is asked for, rad.
pub fn leans_rad(cutter: &Cutter) -> [f64; 2] {
    [if cutter.is_ball() { 0.0 } else { LEAST_RAD }, FRAC_PI_2 - UPRIGHT_RAD]
}

/// The direction of a strategy's passes where it is one of the parameters' or that of walls; else empty.
pub const fn direction(strategy: &Strategy) -> &'static str {
    match strategy {
        Strategy::Isoparametric { along: Along::Fixed(axis) }
        | Strategy::Regions { along: Along::Fixed(axis) } => match axis {
            Axis::U => "u",
            Axis::V => "v",
        },
        Strategy::AlongWalls => "walls",
        _ => "",
    }
}

/// All faces of a job as points that the tool keeps out of.
fn surroundings(job: &Job, faces: &Part, cutter: &Cutter) -> Result<Surroundings, Failure> {
    fn named(all: &[LoadedFace]) -> Vec<Named<'_>> {
        all.iter().map(|f| Named { face: &f.id, surface: &*f.surface }).collect()
    }
    let accepted = if cutter.is_ball() { ACCEPTED_OF_BALLS } else { ACCEPTED };
    let around = Around {
        faces: &named(&faces.faces),
        check: &named(&faces.check),
        cutter,
        gouge_mm: accepted * job.tolerance().gouge_mm,
        left: faces.left(),
    };
    Surroundings::of(&around).map_err(|(face, e)| Failure::file(job.path(), format!("face {face}: {e}")))
}

/// Which body of the tool meets what, in words.
pub fn met(faces: &Part, met: &Met) -> [String; 2] {
    let body = if met.member == Member::Cutter { "cutter" } else { "holder" };
    let mut all = faces.faces.iter().chain(&faces.check);
    let name = match met.obstacle.owner {
        Left::OWNER => "raw material that is left",
        k => all.nth(k as usize).map_or("nothing", |f| f.id.as_str()),
    };
    [body, name].map(str::to_owned)
}

/// The area that no axis reaches by what stands in the way of the best of all, mm2.
pub fn unreached_mm2(faces: &Part, unreached: &[Unreached]) -> BTreeMap<String, f64> {
    let mut by: BTreeMap<String, f64> = BTreeMap::new();
    for place in unreached {
        let why = place.best.map_or_else(
            || "no axis of the machine".to_owned(),
            |best| {
                let [body, name] = best.gap.met.map_or_else(
                    || ["nothing".to_owned(), "nothing".to_owned()],
                    |met| {
                        let [body, name] = self::met(faces, &met);
                        [format!("the {body}"), name]
                    },
                );
                format!("{body} meets {name}")
            },
        );
        *by.entry(why).or_default() += place.area_mm2;
    }
    by
}

/// A field with what is to be said of it.
fn told(faces: &Part, face: &LoadedFace, found: Found) -> Told {
    let mut said = Vec::new();
    if !found.unreached.is_empty() {
        let by = unreached_mm2(faces, &found.unreached);
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
    (found, said)
}
