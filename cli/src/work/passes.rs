//! Passes over the faces of a job by one strategy, joined to a path.

use crate::failure::Failure;
use crate::job::strategy::Kind;
use crate::job::{Control, Job, LeanKey};
use crate::part::{self, LoadedFace, Part};
use crate::watch::Watch;
use crate::work::axes::Fields;
use crate::work::budget::{self, Shares};
use crate::work::drop::names;
use crate::work::left_out;
use crate::work::look::Look;
use crate::work::nc;
use crate::work::stock::{self, RawMaterial};
use osculate_geom::{Axis, Box3, Diagnostic, Domain, Surface, Uv};
use osculate_postproc::machine::{Drive, JointKind};
use osculate_productivity::compare::{Around, Axes};
use osculate_productivity::plan::{
    Along, Freedom, Keeping, Leaning, Linked, Links, LocalLead, Milling, Named, Passes, Rates, Senses,
    Strategy, Stretches, Task, ThreeAxisLines, WallEdges, Walls, link, link_stretches, ordered,
    predicted_length_mm, run as plan_face, run_in, wall_edges as plan_wall_edges,
};
use osculate_tools::cl::ClPath;
use osculate_tools::removal::{Sample, sample_boundary};
use osculate_tools::{Cutter, Lean};
use std::path::Path;
use std::sync::Arc;

/// Leads tried where the job leaves the choice to the program, degrees.
pub const LEADS_DEG: [f64; 6] = [3.0, 6.0, 10.0, 15.0, 20.0, 30.0];
/// Lead of a ball where the job leaves the choice: enough to keep the tip, which does not cut, off the part.
pub const BALL_LEAD_DEG: f64 = 15.0;

/// Pieces of a side of a face without trims.
const SIDE: u32 = 64;

/// Share of the gouge tolerance by which ways between passes may go into faces that are not machined.
const INTO_WALLS: f64 = 0.2;

/// How the passes of a job are joined.
pub fn links(job: &Job, faces: &Part, cutter: &Cutter) -> Links {
    let mut obstacles = Box3::empty();
    for f in faces.faces.iter().chain(&faces.check) {
        obstacles = obstacles.union(&part::bounds(f));
    }
    let (setup, kind) = (job.setup(), &job.strategy().kind);
    let mut links = Links::new(obstacles, *cutter, job.feed_mm_min());
    links.air_mm_min = job.air_mm_min();
    links.clearance_mm = setup.clearance_mm;
    links.approach_mm = setup.approach_mm;
    links.hop_mm = setup.hop_mm;
    links.contacts = !matches!(kind, Kind::Drop(ThreeAxisLines::Waterlines));
    links.dropped = matches!(kind, Kind::Drop(_));
    links.dip_mm = INTO_WALLS * job.tolerance().gouge_mm;
    links.layer_mm = job.layer_mm();
    links.holder = job.holder().cloned();
    links.rates = rates(job.control());
    links
}

/// How fast the joints of a machine go between passes: the slowest of each kind.
fn rates(control: &Control) -> Rates {
    let usual = Rates::default();
    let slowest = |kind: JointKind, of: fn(&Drive) -> f64, usual: f64| {
        let joints = control.machine.joints().iter().filter(|j| j.kind == kind);
        let least = joints.map(|j| of(&j.drive)).filter(|x| *x > 0.0).fold(f64::INFINITY, f64::min);
        if least.is_finite() { least } else { usual }
    };
    let velocity = |d: &Drive| 60.0 * d.velocity_per_s;
    let acceleration = |d: &Drive| 3600.0 * d.acceleration_per_s2;
    Rates {
        rapid_mm_min: slowest(JointKind::Linear, velocity, usual.rapid_mm_min),
        rapid_mm_min2: slowest(JointKind::Linear, acceleration, usual.rapid_mm_min2),
        turn_rad_min: slowest(JointKind::Rotary, velocity, usual.turn_rad_min),
        turn_rad_min2: slowest(JointKind::Rotary, acceleration, usual.turn_rad_min2),
    }
}

/// How finely the rims of faces are followed where no accuracy says it, of the clearance.
const RIM_OF_CLEARANCE: f64 = 0.25;

/// Everything that links keep off.
fn walls_of(job: &Job, faces: &Part) -> Result<Walls, Failure> {
    let setup = job.setup();
    let radius_mm = job.each_tool().iter().map(|j| j.cutter().radius_mm()).fold(f64::INFINITY, f64::min);
    let keeping = Keeping {
        clearance_mm: setup.check_clearance_mm,
        accepted_mm: INTO_WALLS * job.tolerance().gouge_mm,
        radius_mm,
    };
    let fail = |e| Failure::file(job.path(), format!("faces that links keep off: {e}"));
    let walls = Walls::of(&names(&faces.check), &names(&faces.faces), &keeping).map_err(fail)?;
    let apart_mm = RIM_OF_CLEARANCE * setup.check_clearance_mm;
    let fixtures = stock::fixtures(job, faces)?;
    let walls = walls
        .with(&rims(&faces.check, apart_mm), apart_mm, setup.check_clearance_mm)
        .with_own(&rims(&faces.faces, apart_mm))
        .with(&fixtures, job.fixture().map_or(0.0, |f| f.spacing_mm), setup.check_clearance_mm);
    let left = match (&faces.left, RawMaterial::of(job, faces)?) {
        (Some(left), _) => left.points.to_vec(),
        (None, Some(raw)) => raw.filled()?.ends(),
        (None, None) => Vec::new(),
    };
    Ok(walls.with_stock(left))
}

/// Places along the outlines of trimmed faces, which name these by their place among them.
pub fn rims(faces: &[LoadedFace], apart_mm: f64) -> Vec<Sample> {
    let trimmed = faces.iter().zip(0u32..).filter(|(f, _)| f.surface.is_trimmed());
    trimmed
        .flat_map(|(f, k)| {
            f.surface.loops().iter().flat_map(move |l| sample_boundary(&*f.surface, &l.points, k, apart_mm))
        })
        .collect()
}

/// What links keep off, made once for all plans of a job.
fn walls(job: &Job, faces: &Part) -> Result<Arc<Walls>, Failure> {
    if let Some(made) = faces.walls.get() {
        return Ok(Arc::clone(made));
    }
    let walls = walls_of(job, faces)?;
    Ok(Arc::clone(faces.walls.get_or_init(|| Arc::new(walls))))
}

/// What an order may do with the passes of a job.
fn freedom(job: &Job) -> Freedom {
    let strategy = job.strategy();
    let wishes = strategy.senses != Senses::default();
    let same = strategy.is_same_either_way();
    let from_above = matches!(strategy.kind, Kind::Drop(ThreeAxisLines::Waterlines));
    Freedom { turned: same && !wishes, in_turn: strategy.senses.milling != Milling::Any || from_above }
}

/// Passes in the order in which they are cut soonest.
pub fn in_order(job: &Job, faces: &Part, passes: Stretches) -> Result<Stretches, Failure> {
    let walls = &*walls(job, faces)?;
    Ok(ordered(&passes, &links_by(job, faces, walls), walls, freedom(job)))
}

/// How passes are joined where what stands on the faces is known as raw material, or else is a layer.
fn links_by(job: &Job, faces: &Part, walls: &Walls) -> Links {
    let mut links = links(job, faces, &job.cutter());
    if walls.knows_stock() {
        links.layer_mm = 0.0;
    }
    links
}

/// Passes joined to a path.
pub fn linked(job: &Job, faces: &Part, all: &Stretches) -> Result<Linked, Failure> {
    let walls = &*walls(job, faces)?;
    Ok(link_stretches(&all.passes, &all.skipped, &links_by(job, faces, walls), walls))
}

/// A linked path with the tool and spindle of the job.
pub fn cl_path(job: &Job, linked: &Linked) -> ClPath {
    let mut cl = linked.path.clone();
    cl.cutter = Some(job.cutter_spec());
    cl.holder = job.tool().holder_sections().to_vec();
    cl.spindle_rpm = job.spindle_rpm();
    cl
}

/// The name of a job in programs and reports: that of its folder, or else of the file.
pub fn title(job: &Job) -> String {
    let path = job.path();
    // A file that is called no more than a job is told apart by its folder.
    let own = path.file_stem().filter(|stem| !stem.to_string_lossy().starts_with("job"));
    let name = own.or_else(|| path.parent().and_then(Path::file_name)).or_else(|| path.file_stem());
    name.map_or_else(|| "osculate".to_owned(), |t| t.to_string_lossy().into_owned())
}

/// A strategy whose direction is open, with both directions.
pub fn each_direction(strategy: Strategy) -> Vec<Strategy> {
    let both = [Axis::U, Axis::V].map(Along::Fixed);
    match strategy {
        Strategy::Isoparametric { along: Along::Auto } => {
            both.map(|along| Strategy::Isoparametric { along }).to_vec()
        }
        Strategy::Regions { along: Along::Auto } => both.map(|along| Strategy::Regions { along }).to_vec(),
        other => vec![other],
    }
}

/// How passes are to be placed, and who hears of those that are finished.
#[non_exhaustive]
pub struct Way<'a> {
    /// The strategy.
    pub strategy: &'a Strategy,
    /// Lead and tilt, but where the job tilts to one side.
    pub lean: Lean,
    /// How axes are found; the lead of `lean` is the least where it is found place by place.
    pub axes: Axes,
    /// The fields of the job's faces with its tool, as far as they are known.
    pub fields: &'a Fields,
    /// The shares of the tolerances that passes are laid out for.
    pub shares: Shares,
    /// Who hears what is finished.
    pub watch: &'a dyn Watch,
}

/// Passes over every face of the job with its tool.
pub fn each_face(
    job: &Job,
    faces: &Part,
    way: &Way<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Passes, Failure> {
    let tolerance = budget::leaning(job, faces, way.shares);
    let cutter = &job.cutter();
    let holder = job.holder();
    let all = faces.faces.iter().chain(&faces.check);
    let around =
        way.axes.is_local().then(|| Around::of(all.map(|f| (&*f.surface as &dyn Surface, f.id.as_str()))));
    let local = LocalLead {
        tilt_rad: (way.axes != Axes::Balanced).then_some(way.lean.tilt_rad),
        least_rad: way.lean.lead_rad,
        most_rad: LocalLead::MOST_RAD,
        rate_rad_per_mm: job.lead_rate_rad_per_mm(),
        holder,
        around: around.as_ref(),
    };
    let n = faces.faces.len();
    let mut out = Passes::default();
    for (k, face) in faces.faces.iter().enumerate() {
        let here = move |f: f64| progress((k as f64 + f) / n as f64);
        let edges = way.fields.walls(job, faces, k, way.strategy)?;
        let plan = |strategy: &Strategy, lean: Leaning<'_>| {
            let (surface, face) = (&*face.surface, face.id.as_str());
            let task = Task::new(face, surface, cutter, lean, tolerance).watched(&here);
            let task = if let Some(edges) = &edges { task.beside(edges) } else { task };
            plan_face(&task, strategy).map_err(|e| Failure::file(job.path(), e))
        };
        let mut p = match way.axes {
            Axes::Held => {
                plan(way.strategy, job.strategy().side_tilt().map_or(way.lean.into(), Leaning::Sided))?
            }
            Axes::Local | Axes::Balanced => plan(way.strategy, Leaning::Local(&local))?,
            Axes::Field => {
                let mut best: Option<Result<Passes, Failure>> = None;
                // Each direction has a field of its own; one along which the tool does not fit leaves the other.
                for strategy in each_direction(*way.strategy) {
                    let (found, said) = &*way.fields.of(job, faces, (k, face), (tolerance, &strategy))?;
                    let mut made = plan(&strategy, Leaning::Axes(&found.field));
                    if let Ok(p) = &mut made {
                        p.diagnostics.extend(said.iter().cloned());
                    }
                    best = Some(match (best, made) {
                        (Some(Ok(a)), Ok(b)) => Ok(if b.length_mm() < a.length_mm() { b } else { a }),
                        (Some(Ok(a)), Err(_)) => Ok(a),
                        (Some(Err(_)) | None, made) => made,
                    });
                }
                best.transpose()?.unwrap_or_default()
            }
        };
        run_in(&mut p.passes, job.strategy().senses);
        out.passes.extend(p.passes);
        out.diagnostics.extend(p.diagnostics);
        if way.watch.wants_partial() && k + 1 < n {
            let empty = cl_path(job, &Linked::default());
            let (done, links, name) = (out.passes.clone(), links(job, faces, cutter), title(job));
            let tool = job.tool().number();
            let walls = walls(job, faces)?;
            let text = move || {
                nc::cl_text(&ClPath { moves: link(&done, &links, &walls).path.moves, ..empty }, tool, &name)
            };
            way.watch.partial(Box::new(text), format!("the passes of {} of {n} faces", k + 1));
        }
    }
    Ok(out)
}

/// The rectangle of a face that has no trims.
fn around(domain: &Domain) -> Vec<Uv> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let side = |k: usize| {
        let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % 4]);
        (0..SIDE).map(move |i| {
            let f = f64::from(i) / f64::from(SIDE);
            domain.at(a + f * (c - a), b + f * (d - b))
        })
    };
    (0..4).flat_map(side).collect()
}

/// Where the part stands up beside one of the job's faces.
pub fn wall_edges(job: &Job, faces: &Part, of: usize, cutter: &Cutter) -> Result<WallEdges, Failure> {
    let surface = &*faces.faces[of].surface;
    let outlines: Vec<Vec<Uv>> = if surface.is_trimmed() {
        surface.loops().iter().map(|l| l.points.to_vec()).collect()
    } else {
        vec![around(&surface.domain())]
    };
    let all = faces.faces.iter().enumerate().filter(|(k, _)| *k != of).map(|(_, f)| f).chain(&faces.check);
    let others: Vec<Named<'_>> = all.map(|f| Named { face: &f.id, surface: &*f.surface }).collect();
    plan_wall_edges((surface, &outlines), &others, cutter)
        .map_err(|(face, e)| Failure::file(job.path(), format!("face {face}: {e}")))
}

/// Whence a job has its axis.
pub fn axes(job: &Job) -> Axes {
    let strategy = job.strategy();
    match (strategy.lead, strategy.tilt) {
        _ if strategy.axis_field => Axes::Field,
        (LeanKey::Local, LeanKey::Local) => Axes::Balanced,
        (LeanKey::Local, _) => Axes::Local,
        _ => Axes::Held,
    }
}

/// Passes of a tool that leans along them: the lead is the job's, or the best of a few.
pub fn with_best_lead(
    job: &Job,
    faces: &Part,
    strategy: &Strategy,
    watch: &dyn Watch,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<(Passes, Lean), Failure> {
    let cutter = &job.cutter();
    let fields = &Fields::default();
    let way = |lean: Lean, axes: Axes| Way { strategy, lean, axes, fields, shares: Shares::WHOLE, watch };
    let axes = axes(job);
    if axes != Axes::Held {
        let lean = if axes.is_local() { job.lean(cutter.least_lean_rad()) } else { Lean::default() };
        return Ok((each_face(job, faces, &way(lean, axes), progress)?, lean));
    }
    let mut leads: Vec<f64> = match job.strategy().lead {
        LeanKey::Given(deg) => vec![deg],
        _ if cutter.is_ball() => vec![BALL_LEAD_DEG],
        _ => LEADS_DEG.to_vec(),
    };
    let choice = leads.len() > 1;
    if choice {
        leads = ranked(job, faces, cutter, &leads);
    }
    let mut best: Option<(f64, Passes, Lean)> = None;
    let mut refused: Option<Failure> = None;
    for deg in leads {
        let lean = job.lean(deg.to_radians());
        match each_face(job, faces, &way(lean, Axes::Held), progress) {
            Ok(mut p) if choice => {
                // The shortest path is of no use where the heel of the tool digs in: a coarse look at the CL path tells.
                let gouge = Look::at(job, faces, &linked(job, faces, &p.passes.clone().into())?)?.gouge_mm;
                // Where such places are left out, the lead that leaves out the least is the best.
                let (off, what, fine) = if left_out::is_wanted(job) {
                    let left = left_out::of(job, faces, &p)?;
                    let area: f64 = left.area_mm2.iter().sum();
                    (area, format!("area left out ({area:.3} mm2)"), left.touched == 0)
                } else {
                    (gouge, format!("gouge ({gouge:.4} mm)"), gouge <= job.tolerance().gouge_mm)
                };
                p.diagnostics.push(Diagnostic::note(
                    "lead",
                    format!("{deg:.0} deg chosen of {LEADS_DEG:?} by predicted length and {what}"),
                ));
                if fine {
                    return Ok((p, lean));
                }
                if best.as_ref().is_none_or(|b| off < b.0) {
                    best = Some((off, p, lean));
                }
            }
            Ok(p) => return Ok((p, lean)),
            Err(e) => refused = Some(e),
        }
    }
    match (best, refused) {
        // None is good: the least bad one goes on to verification, which says so.
        (Some((_, passes, lean)), _) => Ok((passes, lean)),
        (None, Some(e)) => Err(e),
        (None, None) => Err(Failure::job("no lead was tried")),
    }
}

/// Leads by the length of path that they promise, shortest first.
fn ranked(job: &Job, faces: &Part, cutter: &Cutter, leads: &[f64]) -> Vec<f64> {
    let tolerance = job.tolerance();
    let mut out = Vec::with_capacity(leads.len());
    for deg in leads {
        let lean = job.lean(deg.to_radians());
        let length: f64 = faces
            .faces
            .iter()
            .map(|face| {
                let (surface, face) = (&*face.surface, face.id.as_str());
                predicted_length_mm(&Task::new(face, surface, cutter, lean, tolerance))
            })
            .sum();
        out.push((length, *deg));
    }
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    out.into_iter().map(|o| o.1).collect()
}
