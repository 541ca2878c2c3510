//! The candidates of a job: its tools times strategies times directions times leads.

use crate::failure::Failure;
use crate::job::strategy::Kind;
use crate::job::{Job, LeanKey};
use crate::part::{self, Part};
use crate::work::axes;
use crate::work::passes::{BALL_LEAD_DEG, each_direction, wall_edges};
use crate::work::{drop, setup};
use osculate_geom::{Axis, Unit3, Vec3, any_perpendicular};
use osculate_postproc::Orienting;
use osculate_productivity::compare::{Axes, Candidate};
use osculate_productivity::plan::{Along, Strategy, ThreeAxis, ThreeAxisLines};
use osculate_tools::{Cutter, Lean};

/// Leads tried, degrees: small ones for wide strips, great ones to keep heel and holder off.
const LEADS_DEG: [f64; 14] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 27.0, 35.0, 45.0];
/// Points a side of a face for its mean normal.
const GRID: usize = 8;

/// A strategy that is not one of those side by side.
fn not_compared(job: &Job) -> Failure {
    let what = format!(
        "{} is not compared with others: choose \"auto\" or passes along the faces",
        job.strategy().name()
    );
    job.refuse("strategy", "kind", what)
}

/// Refuses a job whose strategy is not one of those side by side.
pub fn check(job: &Job) -> Result<(), Failure> {
    match job.strategy().kind {
        Kind::Auto | Kind::Faces(_) => Ok(()),
        Kind::Drop(_) | Kind::Layers(_) | Kind::Flank => Err(not_compared(job)),
    }
}

pub(super) fn of_job(job: &Job, faces: &Part, cutters: &[Cutter]) -> Result<Vec<Candidate>, Failure> {
    let auto = job.strategy().is_open();
    let strategies = match &job.strategy().kind {
        Kind::Auto => every(job, faces),
        Kind::Faces(strategy) => vec![*strategy],
        Kind::Drop(_) | Kind::Layers(_) | Kind::Flank => return Err(not_compared(job)),
    };
    let strategies: Vec<Strategy> = strategies.into_iter().flat_map(each_direction).collect();
    let mut out = Vec::new();
    for (tool, cutter) in cutters.iter().enumerate() {
        for strategy in &strategies {
            let fits = match strategy {
                Strategy::Contour2cl { .. } => cutter.is_ball(),
                Strategy::Curvature5c => !cutter.is_ball(),
                // Wide tools have better reasons to go one way or the other.
                Strategy::AlongWalls => !auto || (cutter.is_ball() && beside_walls(job, faces, cutter)?),
                Strategy::ThreeAxis(way) => way.lines != ThreeAxisLines::Gradient || !cutter.is_ball(),
                _ => true,
            };
            if !fits {
                continue;
            }
            // Regions pay where leads, and with them strips, differ over the face; where they do not, there is one region of isoparametric
            // passes.
            let wanted = |axes: Axes| match strategy {
                Strategy::Regions { .. } => !auto || axes != Axes::Held,
                Strategy::Isoparametric { .. } => !auto || !axes.is_local(),
                _ => true,
            };
            let leans = leans(job, cutter, strategy);
            for (lean, axes) in leans.into_iter().filter(|(_, axes)| wanted(*axes)) {
                out.push(Candidate { tool, strategy: *strategy, lean, axes });
            }
        }
    }
    if out.is_empty() {
        let text = format!(
            "[strategy] {} is not for any of these tools: contour_2cl takes a ball, curvature_5c a flat or toroidal cutter",
            job.strategy().name()
        );
        return Err(Failure::file(job.path(), text));
    }
    Ok(out)
}

/// Leads of a tool and strategy, and whether each is held, the least of one that is found place by place, or none as axes are a field.
fn leans(job: &Job, cutter: &Cutter, strategy: &Strategy) -> Vec<(Lean, Axes)> {
    if strategy.fixed_axis().is_some() {
        return vec![(Lean::default(), Axes::Held)];
    }
    let of_field = || (job.lean(axes::LEAST_RAD), Axes::Field);
    // Three or four joints take no lead along every feed.
    if job.strategy().axis_field || (axes::is_line(job) && job.strategy().may_be_field()) {
        return vec![of_field()];
    }
    let held = |leads: &[f64]| -> Vec<(Lean, Axes)> {
        leads.iter().map(|deg| (job.lean(deg.to_radians()), Axes::Held)).collect()
    };
    // Before the tilt that is held, the one found.
    let tilts: &[Axes] = match job.strategy().tilt {
        LeanKey::Auto => &[Axes::Balanced, Axes::Local],
        LeanKey::Local => &[Axes::Balanced],
        LeanKey::Given(_) => &[Axes::Local],
    };
    let local = || tilts.iter().map(|axes| (job.lean(cutter.least_lean_rad()), *axes));
    // A field goes by the direction of passes, which other level lines have not yet.
    let lined = matches!(strategy, Strategy::Regions { .. } | Strategy::AlongWalls);
    // Next to the normal a sharp edge tells nothing of what lies between points: a flat end keeps to leads, unless the machine leaves it
    // no choice.
    let round = cutter.corner_mm() > 0.0 || axes::is_line(job);
    let field = (lined && round && job.strategy().may_be_field()).then(of_field);
    match job.strategy().lead {
        LeanKey::Given(deg) => held(&[deg]),
        // A ball is the same at any lead.
        LeanKey::Local if !cutter.is_ball() => local().collect(),
        _ if cutter.is_ball() => held(&[BALL_LEAD_DEG]).into_iter().chain(field).collect(),
        _ => held(&LEADS_DEG).into_iter().chain(local()).chain(field).collect(),
    }
}

/// Whether the part stands up beside every face of a job, for one of its tools.
fn beside_walls(job: &Job, faces: &Part, cutter: &Cutter) -> Result<bool, Failure> {
    for k in 0..faces.faces.len() {
        if wall_edges(job, faces, k, cutter)?.is_empty() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Every strategy that can be chosen.
fn every(job: &Job, faces: &Part) -> Vec<Strategy> {
    let [first, second] = plane_normals(faces);
    let axis = kept_axis(job, faces);
    vec![
        Strategy::Isoparametric { along: Along::Auto },
        Strategy::Regions { along: Along::Auto },
        Strategy::Isoplanar { normal: first },
        Strategy::Isoplanar { normal: second },
        Strategy::Isoscallop,
        Strategy::Streamline,
        Strategy::Curvature5c,
        Strategy::AlongWalls,
        Strategy::Contour2cl { axis },
    ]
    .into_iter()
    .chain(three_axis(job, faces, axis).into_iter().map(Strategy::ThreeAxis))
    .collect()
}

/// Ways over the faces of a tool that keeps its axis, where the job asks for nothing else: in planes along and across the longest side
/// of the faces, up and down the slope, and at constant heights.
fn three_axis(job: &Job, faces: &Part, axis: Unit3) -> Vec<ThreeAxis> {
    if !job.strategy().may_keep_axis() {
        return Vec::new();
    }
    let along = drop::longest(&faces.faces, &axis);
    let way = |lines: ThreeAxisLines, feed: Vec3| ThreeAxis { lines, axis, feed };
    vec![
        way(ThreeAxisLines::Planes, along),
        way(ThreeAxisLines::Planes, axis.cross(&along)),
        way(ThreeAxisLines::Gradient, along),
        way(ThreeAxisLines::Waterlines, along),
    ]
}

/// The axis of tools that keep one: that of the job, or else of those that the machine has the nearest to the mean normal.
fn kept_axis(job: &Job, faces: &Part) -> Unit3 {
    if job.strategy().gives_axis {
        return job.strategy().axis;
    }
    let (stands, _) = setup::of(job, faces, None);
    Orienting::new(&job.control().machine, &stands.part_zero.rotation).nearest(&mean_normal(faces))
}

/// The mean normal of the faces; z where they have none.
fn mean_normal(faces: &Part) -> Unit3 {
    let all = faces.faces.iter().flat_map(|f| part::grid(&*f.surface, GRID));
    let sum = all.fold(Vec3::zeros(), |s, (_, _, n)| s + n.into_inner());
    Unit3::try_new(sum, 1e-9).unwrap_or_else(Vec3::z_axis)
}

/// Two normals of planes across the faces, at right angles to their mean normal and to each other.
fn plane_normals(faces: &Part) -> [Unit3; 2] {
    let up = mean_normal(faces);
    let first = any_perpendicular(&up);
    [first, Unit3::new_unchecked(up.cross(&first))]
}

/// A strategy in words, with its direction.
pub(super) fn words(strategy: &Strategy) -> String {
    match strategy {
        Strategy::Isoparametric { along: Along::Fixed(a) } | Strategy::Regions { along: Along::Fixed(a) } => {
            format!("{} {}", strategy.name(), if *a == Axis::U { "u" } else { "v" })
        }
        Strategy::Isoplanar { normal: n } => format!("isoplanar ({:.2}, {:.2}, {:.2})", n.x, n.y, n.z),
        Strategy::ThreeAxis(ThreeAxis { lines: ThreeAxisLines::Planes, axis, feed }) => {
            let normal = axis.cross(feed);
            let n = normal / normal.norm().max(f64::MIN_POSITIVE);
            format!("{} ({:.2}, {:.2}, {:.2})", strategy.name(), n.x, n.y, n.z)
        }
        other => other.name().to_owned(),
    }
}
