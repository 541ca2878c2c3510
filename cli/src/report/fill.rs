//! From the results of a plan to what its report shows.

use crate::job::Job;
use crate::part::{Part, area};
use crate::report::machine::Machine;
use crate::report::measured::{Measured, mesh_of};
use crate::report::sheet;
use crate::report::{
    self, Column, Histogram, Holder, Link, Outcome, Pace, PaceStep, Pass, PathPoints, Report, Stage, Table,
    Tool, ToolPose, Verdict, View, Worst,
};
use crate::words::number;
use crate::work::extras::Extras;
use crate::work::extras::FaceLeftOut;
use crate::work::nc::Motions;
use crate::work::productivity::{InTime, PRODUCTIVITY};
use crate::work::summary::Summary;
use crate::work::verify::Verified;
use osculate_geom::{Diagnostic, Point3, Unit3};
use osculate_postproc::machine::MAX_JOINTS;
use osculate_postproc::{Machine as Chain, Setup};
use osculate_productivity::plan::{Linked, Passes};
use osculate_tools::cl::Motion;
use osculate_tools::removal::{Answer, Swept};
use rayon::prelude::*;

/// Triangles over all faces, about.
const TRIANGLES: f64 = 120_000.0;
/// Poses in the animation.
const POSES: usize = 6000;
/// Points of passes drawn.
const PATH_POINTS: usize = 120_000;

/// Everything that a report tells.
#[non_exhaustive]
pub struct Story<'a> {
    /// The job's name.
    pub title: &'a str,
    /// The job.
    pub job: &'a Job,
    /// Its faces.
    pub faces: &'a Part,
    /// The passes.
    pub passes: &'a Passes,
    /// The linked path.
    pub linked: &'a Linked,
    /// What was measured.
    pub verified: &'a Verified,
    /// The figures.
    pub summary: &'a Summary,
    /// All findings.
    pub diagnostics: &'a [Diagnostic],
    /// The program read back.
    pub time_by_move: &'a Motions,
    /// The machine that the program runs on.
    pub chain: &'a Chain,
    /// Where the part sits, each with the first of those motions that is made so.
    pub setups: Vec<(usize, Setup)>,
    /// The tools in hand, each with the first of those motions that it makes.
    pub hands: Vec<(usize, Tool)>,
    /// What this report shows beside what every report shows.
    pub extras: &'a Extras<'a>,
    /// Productivity of the program in its time.
    pub in_time: &'a InTime,
}

/// The report's pages.
#[non_exhaustive]
pub struct Pages {
    /// `report.html`.
    pub html: String,
    /// `picture.svg`.
    pub svg: String,
    /// `path.svg`.
    pub path_svg: String,
    /// `productivity.svg`: area finished a minute by place; none of a roughing, or where no time is known.
    pub productivity_svg: Option<String>,
}

/// Builds both pages.
pub fn pages(story: &Story<'_>, progress: &dyn Fn(f64)) -> Pages {
    let report = report(story, progress);
    progress(0.8);
    let html = report::html(&report);
    let svg = report::svg(&report, &View { tool_at: Some(0.5), ..View::default() });
    let view = View {
        direction: Some(report::Direction { azimuth_deg: -52.0, elevation_deg: 58.0 }),
        part: report::PartColours::Plain,
        path: report::PathColours::StripWidth,
        tool_at: None,
        ..View::default()
    };
    let path_svg = report::svg(&report, &view);
    let by_place = report.scalars.iter().position(|s| s.name == PRODUCTIVITY).map(|k| {
        let part = report::PartColours::Quantity(k);
        report::svg(
            &report,
            &View { part, path: report::PathColours::Hidden, tool_at: None, ..View::default() },
        )
    });
    Pages { html, svg, path_svg, productivity_svg: by_place }
}

fn report(story: &Story<'_>, progress: &dyn Fn(f64)) -> Report {
    let s = story.summary;
    let total_area: f64 = story.faces.faces.iter().chain(&story.faces.check).map(area).sum();
    let edge = (2.0 * total_area / TRIANGLES).sqrt().max(1e-6);
    let verdict_of = &story.verified.verdict;
    let measured = Measured::new(verdict_of.samples(), verdict_of.cuts(), story.verified.summary.spacing_mm);
    let painted = story.in_time.maps(story.job, story.hands.len() == 1);
    let mut faces = Vec::new();
    let machined = story.faces.faces.iter().map(|f| (f, false));
    for (k, (face, check)) in machined.chain(story.faces.check.iter().map(|f| (f, true))).enumerate() {
        let mut m = mesh_of(face, if check { 3.0 * edge } else { edge });
        m.checked = check;
        let nearest = measured.nearest(&m, k as u32);
        m.deviation_mm = measured.deviation_mm(&nearest, check);
        let point = |p: &[f32; 3]| Point3::from(p.map(f64::from));
        for (_, field) in &story.extras.maps {
            let value = |p: &[f32; 3]| if check { f32::NAN } else { field(k, &point(p)) as f32 };
            m.scalars.push(m.positions.par_iter().map(value).collect());
        }
        for (_, values) in &painted {
            let value = |s: &Option<u32>| s.filter(|_| !check).map_or(f32::NAN, |s| values[s as usize]);
            m.scalars.push(nearest.iter().map(value).collect());
        }
        faces.push(m);
        progress(0.6 * (k + 1) as f64 / (story.faces.faces.len() + story.faces.check.len()) as f64);
    }
    let kept = kept_poses(story);
    Report {
        title: format!("{}: {}", story.title, s.strategy),
        subtitle: format!("{}, {}, feed {}", s.machine, s.dialect, s.feed),
        faces_only: false,
        verdict: verdict(story, &kept),
        faces,
        scalars: story
            .extras
            .maps
            .iter()
            .map(|m| &m.0)
            .chain(painted.iter().map(|m| &m.0))
            .cloned()
            .collect(),
        passes: passes(story.passes),
        path_points: PathPoints::Contact,
        links: links(story.linked),
        tools: story.hands.iter().map(|h| h.1.clone()).collect(),
        machine: (!story.time_by_move.at_nose.is_empty()).then(|| machine(story)),
        poses: poses(story, &kept),
        histogram: Histogram {
            edges_mm: histogram_edges(story),
            weights: story.verified.verdict.figures().tally.histogram.iter().map(|b| b.area_mm2).collect(),
            unit: "mm2".to_owned(),
        },
        pace: pace(story),
        tables: story.extras.tables.iter().cloned().chain(tables(story)).collect(),
        diagnostics: story.diagnostics.to_vec(),
        stages: [
            ("import", s.wall_s.import),
            ("plan", s.wall_s.plan),
            ("between operations", s.wall_s.between),
            ("post", s.wall_s.post),
            ("verify", s.wall_s.verify),
            ("ideal", s.wall_s.ideal),
        ]
        .map(|(name, wall_s)| Stage { name: name.to_owned(), wall_s })
        .to_vec(),
    }
}

/// Bin borders; the two open bins at the ends are drawn as wide as their neighbours.
fn histogram_edges(story: &Story<'_>) -> Vec<f64> {
    let bins = &story.verified.verdict.figures().tally.histogram;
    let inner: Vec<f64> = bins
        .iter()
        .map(|b| b.from_mm)
        .chain(bins.last().map(|b| b.to_mm))
        .filter(|x| x.is_finite())
        .collect();
    let (Some(first), Some(last)) = (inner.first(), inner.last()) else { return Vec::new() };
    let width = if inner.len() > 1 { inner[1] - inner[0] } else { 1.0 };
    let mut edges = Vec::with_capacity(inner.len() + 2);
    edges.push(first - width);
    edges.extend(&inner);
    edges.push(last + width);
    edges
}

fn verdict(story: &Story<'_>, kept: &[usize]) -> Verdict {
    let v = &story.summary.verification;
    let t = story.job.tolerance();
    let answer = story.verified.verdict.answer();
    let mut words = story.verified.verdict.words();
    if let Some(w) = story.verified.worst.first().filter(|_| answer == Answer::NotHeld) {
        words += &format!(
            ". Worst: {} of {} mm on {} at ({:.3}, {:.3}, {:.3}), {}.",
            w.kind,
            number(w.value_mm, 4),
            w.face,
            w.at_mm[0],
            w.at_mm[1],
            w.at_mm[2],
            w.made_by()
        );
    }
    Verdict {
        outcome: match answer {
            Answer::Held => Outcome::Within,
            Answer::NotHeld => Outcome::Outside,
            Answer::NotShown => Outcome::NotShown,
        },
        words,
        source: "the NC program, read back through the machine".to_owned(),
        samples: v.samples,
        scallop_max_mm: v.scallop_max_mm,
        scallop_p99_mm: v.scallop_p99_mm,
        gouge_max_mm: v.gouge_max_mm,
        uncut_area_mm2: v.uncut_area_mm2,
        uncut_accepted_mm2: story.job.unreached_mm2(),
        area_mm2: story.summary.area_mm2,
        scallop_tolerance_mm: t.scallop_mm,
        gouge_tolerance_mm: t.gouge_mm,
        worst: story
            .verified
            .worst
            .iter()
            .map(|w| Worst {
                deviation_mm: if w.kind == "gouge" { -w.value_mm } else { w.value_mm },
                at_mm: w.at_mm,
                place: format!(
                    "{}: {}, u {} v {}, {}",
                    w.kind,
                    w.face,
                    number(w.uv[0], 5),
                    number(w.uv[1], 5),
                    w.made_by()
                ),
                pose: w.motion.and_then(|m| kept.binary_search(&(m as usize)).ok()),
            })
            .collect(),
    }
}

fn f32s(p: &Point3) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

fn passes(all: &Passes) -> Vec<Pass> {
    let points: usize = all.passes.iter().map(|p| p.points.len()).sum();
    let stride = points.div_ceil(PATH_POINTS).max(1);
    all.passes
        .iter()
        .map(|p| {
            let last = p.points.len().saturating_sub(1);
            let kept = || p.points.iter().enumerate().filter(move |(k, _)| k % stride == 0 || *k == last);
            Pass {
                points_mm: kept().map(|(_, c)| f32s(&c.point)).collect(),
                widths_mm: kept().map(|(_, c)| c.width_mm as f32).collect(),
            }
        })
        .collect()
}

/// Runs of moves that are not passes, each with the point that it leaves from.
fn links(linked: &Linked) -> Vec<Link> {
    let mut out: Vec<Link> = Vec::new();
    let mut open: Option<Link> = None;
    for (k, m) in linked.path.moves.iter().enumerate().skip(1) {
        let rapid = matches!(m.motion, Motion::Rapid);
        if linked.pass_of_move[k].is_some() {
            out.extend(open.take());
            continue;
        }
        let from = f32s(&linked.path.moves[k - 1].pose.tip);
        match &mut open {
            Some(l) if l.rapid == rapid => l.points_mm.push(f32s(&m.pose.tip)),
            other => {
                out.extend(other.take());
                open = Some(Link { points_mm: vec![from, f32s(&m.pose.tip)], rapid });
            }
        }
    }
    out.extend(open);
    out
}

/// Turn of a drawn tool's outline from point to point, rad: a hundredth of a millimetre on the large arc of a barrel.
const OUTLINE_TURN_RAD: f64 = 0.03;

/// The tool of a job as it is drawn.
pub fn tool(job: &Job) -> Tool {
    let c = job.cutter();
    let kind = if !c.is_end_mill() {
        job.tool().kind().word().to_owned()
    } else if c.is_ball() {
        "ball".to_owned()
    } else if c.corner_mm() == 0.0 {
        "flat".to_owned()
    } else {
        format!("toroidal r{}", c.corner_mm())
    };
    Tool {
        label: format!("{kind} D{}", 2.0 * c.radius_mm()),
        diameter_mm: 2.0 * c.radius_mm(),
        corner_radius_mm: c.corner_mm(),
        length_mm: c.length_mm(),
        flute_mm: None,
        holder: job
            .tool()
            .holder_sections()
            .iter()
            .map(|h| Holder {
                diameters_mm: [h.diameter_mm, h.upper_diameter_mm.unwrap_or(h.diameter_mm)],
                length_mm: h.length_mm,
            })
            .collect(),
        meridian_mm: if c.is_end_mill() { Vec::new() } else { c.outline_mm(OUTLINE_TURN_RAD) },
    }
}

/// The motions whose ends the animation shows: evenly spread, and those that made the worst places.
fn kept_poses(story: &Story<'_>) -> Vec<usize> {
    let n = story.time_by_move.motions.len();
    let stride = n.div_ceil(POSES).max(1);
    let worst = story.verified.worst.iter().filter_map(|w| w.motion).map(|m| m as usize);
    let mut kept: Vec<usize> = (0..n).step_by(stride).chain(n.checked_sub(1)).chain(worst).collect();
    kept.retain(|k| *k < n);
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// The machine as the view shows it.
fn machine(story: &Story<'_>) -> Machine {
    let place = |setup: &Setup| {
        let mut columns = [0.0; 16];
        columns.copy_from_slice(setup.part_zero.to_homogeneous().as_slice());
        columns
    };
    Machine::new(story.chain, story.setups.iter().map(|s| place(&s.1)).collect())
}

/// The last of those that begin at a motion or before it.
fn begun<T>(all: &[(usize, T)], motion: usize) -> u32 {
    all.partition_point(|one| one.0 <= motion).saturating_sub(1) as u32
}

/// Poses of the program as read back, with their time; the pass is found by the CL path's own poses only where the
/// motion is at feed.
fn poses(story: &Story<'_>, kept: &[usize]) -> Vec<ToolPose> {
    let read = story.time_by_move;
    kept.iter()
        .map(|&k| {
            let m = &read.motions[k];
            ToolPose {
                tip_mm: f32s(&m.to.tip),
                axis: [m.to.axis.x as f32, m.to.axis.y as f32, m.to.axis.z as f32],
                time_min: read.times_min[k] as f32,
                pass: None,
                tool: begun(&story.hands, k),
                line: m.block,
                setup: begun(&story.setups, k),
                at_nose: read
                    .at_nose
                    .get(k)
                    .copied()
                    .flatten()
                    .map_or([f32::NAN; MAX_JOINTS], |joints| joints.map(|j| j as f32)),
            }
        })
        .collect()
}

/// The way and the time of every motion; one feed that is asked for where there is one tool.
fn pace(story: &Story<'_>) -> Pace {
    let read = story.time_by_move;
    let step = |(m, end_min): (&Swept, &f64)| PaceStep {
        end_min: *end_min,
        length_mm: (m.to.tip - m.from.tip).norm(),
        rapid: m.rapid,
    };
    Pace {
        steps: read.motions.iter().zip(&read.times_min).map(step).collect(),
        asked_mm_min: (story.hands.len() == 1).then(|| story.job.feed_mm_min()),
    }
}

fn tables(story: &Story<'_>) -> Vec<Table> {
    let s = story.summary;
    let v = &s.verification;
    let pairs = |caption: &str, rows: Vec<(&str, String)>| Table {
        caption: caption.to_owned(),
        columns: Vec::new(),
        rows: rows.into_iter().map(|(k, v)| vec![k.to_owned(), v]).collect(),
    };
    let ideal = s.ideal.as_ref().map_or_else(Vec::new, |i| {
        vec![
            ("ideal time, estimated", format!("{} min", i.ideal.words())),
            ("efficiency", format!("{:.0} %", i.efficiency_percent)),
            ("the estimate took", format!("{:.1} s at {} places", s.wall_s.ideal, i.ideal.places)),
        ]
    });
    let real = s.productivity.rows().into_iter().map(|(what, value, unit)| (what, format!("{value} {unit}")));
    let scope = story.verified.verdict.scope();
    let mut out = sheet::setups(story.job, s, scope);
    out.push(sheet::tools(story.job));
    out.extend([
        pairs(
            "Plan",
            vec![
                ("strategy", s.strategy.clone()),
                ("lead, tilt", format!("{} deg", s.lean_words())),
                ("passes", s.passes.to_string()),
                ("CL points", s.points.to_string()),
                ("cutting length", format!("{:.1} mm", s.cutting_length_mm)),
                ("air length", format!("{:.1} mm", s.air_length_mm)),
            ]
            .into_iter()
            .chain(s.control_time_min.map(|min| ("time on the control", format!("{min:.2} min"))))
            .chain([
                ("time by F", format!("{:.2} min", s.time_min)),
                ("of it at feed", format!("{:.2} min", s.cutting_time_min)),
            ])
            .collect(),
        ),
        pairs(
            "Productivity",
            vec![
                ("area", format!("{:.1} mm2", s.area_mm2)),
                (
                    "passes at the feed asked for",
                    format!(
                        "{} to {} mm2/min",
                        number(s.productivity_mm2_min.instantaneous_min, 4),
                        number(s.productivity_mm2_min.instantaneous_max, 4)
                    ),
                ),
                ("global", format!("{} mm2/min", number(s.productivity_mm2_min.global, 4))),
            ]
            .into_iter()
            .chain(real)
            .chain(ideal)
            .collect(),
        ),
        pairs(
            "Verification",
            vec![
                ("samples", format!("{}, {} of them where limits were near", v.samples, v.added_samples)),
                ("spacing", format!("{} mm", number(v.spacing_mm, 3))),
                (
                    "may hide between samples",
                    match (v.hidden_scallop_mm, v.hidden_gouge_mm) {
                        (Some(scallop), Some(gouge)) => {
                            format!("{} mm of scallop, {} mm of gouge", number(scallop, 2), number(gouge, 2))
                        }
                        _ => "not bounded".to_owned(),
                    },
                ),
                ("within tolerance there too", if v.certain { "yes" } else { "not shown" }.to_owned()),
                ("scallop max", format!("{:.5} mm", v.scallop_max_mm)),
                ("scallop p99", format!("{:.5} mm", v.scallop_p99_mm)),
                ("scallop median", format!("{:.5} mm", v.scallop_median_mm)),
                ("median of its crests", format!("{:.5} mm", v.crest_median_mm)),
                ("gouge max", format!("{:.5} mm", v.gouge_max_mm)),
                ("uncut area", format!("{:.3} mm2", v.uncut_area_mm2)),
            ],
        ),
    ]);
    if let Some(joints) = s.joints.as_ref().filter(|j| j.words().is_some()) {
        let steps = joints.steps().into_iter();
        let rows = steps.map(|(letter, step)| vec![format!("largest step of {letter}"), step]);
        out.push(Table {
            caption: "Joints".to_owned(),
            columns: Vec::new(),
            rows: rows.chain([vec!["slower than asked".to_owned(), joints.slowed()]]).collect(),
        });
    }
    out.push(Table {
        caption: "Scope of the verdict".to_owned(),
        columns: ["part of it", "covers"]
            .map(|n| Column { name: n.to_owned(), ..Column::default() })
            .to_vec(),
        rows: scope.iter().map(|row| vec![row.what.to_owned(), row.covers.clone()]).collect(),
    });
    let column = |name: &str, unit: &str| Column { name: name.to_owned(), unit: unit.to_owned() };
    out.push(Table {
        caption: "Faces".to_owned(),
        columns: vec![column("face", ""), column("kind", ""), column("area", "mm2"), column("role", "")],
        rows: story
            .faces
            .faces
            .iter()
            .map(|f| (f, "machined"))
            .chain(story.faces.check.iter().map(|f| (f, "checked")))
            .map(|(f, role)| vec![f.id.clone(), f.kind.clone(), format!("{:.2}", area(f)), role.to_owned()])
            .collect(),
    });
    out
}
