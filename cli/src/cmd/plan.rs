//! `plan`: the main job, from the part to a verified NC program with a report.

use crate::failure::{Done, Failure, Outcome};
use crate::job::{AutoOr, Job};
use crate::nc::{self, Control};
use crate::output;
use crate::part::{self, JobFaces};
use crate::progress::Stage;
use crate::render::{self, Table, number};
use crate::report_fill::{self, Extras, Story};
use crate::verify::{self, Verification, Verified};
use osculate_geom::{Box3, Diagnostic};
use osculate_productivity::levels::{Totals, levels};
use osculate_productivity::plan::{
    Linked, Links, Passes, Strategy, Task, link, predicted_length_mm, run as plan_face,
};
use osculate_tools::{Cutter, Lean};
use serde::Serialize;
use std::path::Path;

/// Leads tried where the job leaves the choice to the program, degrees.
const LEADS_DEG: [f64; 6] = [3.0, 6.0, 10.0, 15.0, 20.0, 30.0];
/// Lead of a ball where the job leaves the choice: enough to keep the tip, which does not cut, off the part.
const BALL_LEAD_DEG: f64 = 15.0;

/// Seconds of wall time by stage.
#[derive(Debug, Default, Serialize, Clone, Copy)]
pub struct WallS {
    pub import: f64,
    pub plan: f64,
    pub post: f64,
    pub verify: f64,
    pub report: f64,
}

/// Productivity at three levels, mm2/min.
#[derive(Debug, Serialize)]
pub struct Productivity {
    instantaneous_min: f64,
    instantaneous_max: f64,
    regional: Vec<f64>,
    pub global: f64,
}

impl Productivity {
    pub const fn instantaneous_min(&self) -> f64 {
        self.instantaneous_min
    }
    pub const fn instantaneous_max(&self) -> f64 {
        self.instantaneous_max
    }
}

/// `summary.json`.
#[derive(Debug, Serialize)]
pub struct Summary {
    format: u32,
    pub strategy: String,
    tool: serde_json::Value,
    pub lead_deg: f64,
    pub tilt_deg: f64,
    pub machine: String,
    pub dialect: String,
    pub feed: String,
    pub passes: usize,
    pub points: usize,
    pub cutting_length_mm: f64,
    pub air_length_mm: f64,
    pub time_min: f64,
    pub cutting_time_min: f64,
    pub area_mm2: f64,
    pub productivity_mm2_min: Productivity,
    pub verification: Verification,
    worst: Vec<verify::WorstPlace>,
    pub wall_s: WallS,
    diagnostics: Vec<String>,
}

/// A plan before it is posted.
pub struct Planned<'a> {
    /// The passes.
    pub passes: Passes,
    /// The passes joined.
    pub linked: Linked,
    /// Its name.
    pub strategy: String,
    /// Lead and tilt.
    pub lean: Lean,
    /// What the report shows beside what every report shows.
    pub extras: Extras<'a>,
}

/// Runs the verb.
pub fn run(path: &Path, out: &Path, json: bool) -> Outcome {
    let job = Job::load(path)?;
    let mut wall_s = WallS::default();
    let stage = Stage::begin("import");
    let faces = part::of_job(&job)?;
    wall_s.import = stage.end();

    let stage = Stage::begin("plan");
    let planned = planned(&job, &faces, &|f| stage.at(f))?;
    wall_s.plan = stage.end();

    let (summary, text, _) = execute(&job, &faces, &planned, wall_s, out)?;
    if json {
        render::json(&summary)?;
    } else {
        render::text(&text);
    }
    Ok(if summary.verification.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}

/// Posts a plan, verifies the program and writes everything; the summary comes back with its text and what was measured.
pub fn execute(
    job: &Job,
    faces: &JobFaces,
    planned: &Planned<'_>,
    mut wall_s: WallS,
    out: &Path,
) -> Result<(Summary, String, Verified), Failure> {
    let path = job.path.as_path();
    let (control, control_notes) = nc::control(job)?;
    let stage = Stage::begin("post");
    let (setup, setup_notes) = nc::setup(job, faces, &planned.extras.axes)?;
    let mut cl = planned.linked.path.clone();
    cl.cutter = Some(job.cutter_spec()?);
    cl.holder = job.tool.holder;
    cl.spindle_rpm = job.spindle_rpm()?;
    let title = path.parent().and_then(Path::file_name).or_else(|| path.file_stem());
    let title = title.map_or_else(|| "osculate".to_owned(), |t| t.to_string_lossy().into_owned());
    let cl_text = nc::cl_text(&cl, &title).map_err(Failure::job)?;
    let posted = nc::post(&cl, &control, &setup, &title)?;
    stage.at(0.6);
    let read = nc::read_back(&posted.text, &control, &setup, false)
        .map_err(|e| Failure::job(format!("the program just written cannot be read back: {e}")))?;
    wall_s.post = stage.end();

    let stage = Stage::begin("verify");
    let strip = if planned.extras.is_empty() { narrow_strip(&planned.passes) } else { None };
    let verified = verify::run(job, faces, &read.motions, "nc", strip, &|f| stage.at(f))?;
    wall_s.verify = stage.end();

    let stage = Stage::begin("report");
    let diagnostics: Vec<Diagnostic> = [
        &faces.part.diagnostics,
        &planned.passes.diagnostics,
        &planned.extras.diagnostics,
        &control_notes,
        &setup_notes,
        &posted.diagnostics,
        &read.diagnostics,
        &verified.diagnostics,
    ]
    .into_iter()
    .flatten()
    .cloned()
    .collect();
    let area_mm2: f64 = faces.faces.iter().map(part::area).sum();
    let feed = job.feed_mm_min()?;
    let totals = Totals { area_mm2, time_min: read.time_min };
    let l = levels(&planned.passes.passes, feed, totals);
    let mut summary = Summary {
        format: 1,
        strategy: planned.strategy.clone(),
        tool: serde_json::to_value(job.cutter_spec()?).map_err(Failure::job)?,
        lead_deg: planned.lean.lead_rad.to_degrees(),
        tilt_deg: planned.lean.tilt_rad.to_degrees(),
        machine: control.machine.name().to_owned(),
        dialect: control.dialect_name.clone(),
        feed: control.feed_name.clone(),
        passes: planned.passes.passes.len(),
        points: planned.linked.path.moves.len(),
        cutting_length_mm: planned.linked.cutting_length_mm,
        air_length_mm: planned.linked.air_length_mm,
        time_min: read.time_min,
        cutting_time_min: read.cutting_time_min,
        area_mm2,
        productivity_mm2_min: Productivity {
            instantaneous_min: l.instantaneous_min,
            instantaneous_max: l.instantaneous_max,
            regional: l.regional,
            global: l.global,
        },
        verification: verified.summary.clone(),
        worst: verified.worst.clone(),
        wall_s,
        diagnostics: diagnostics.iter().map(ToString::to_string).collect(),
    };
    let story = Story {
        title: &title,
        job,
        faces,
        passes: &planned.passes,
        linked: &planned.linked,
        verified: &verified,
        summary: &summary,
        diagnostics: &diagnostics,
        time_by_move: &read,
        extras: &planned.extras,
    };
    let pages = report_fill::pages(&story, &|f| stage.at(f));
    output::write(&out.join("path.cl"), cl_text.as_bytes())?;
    output::write(&out.join(format!("program.{}", control.extension)), posted.text.as_bytes())?;
    output::write(&out.join("report.html"), pages.html.as_bytes())?;
    output::write(&out.join("picture.svg"), pages.svg.as_bytes())?;
    summary.wall_s.report = stage.end();
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::job)? + "\n";
    output::write(&out.join("summary.json"), text.as_bytes())?;

    let text = describe(&summary, &verified, &diagnostics, out, &control);
    Ok((summary, text, verified))
}

/// The strip that samples must resolve: the width that nine tenths of the path exceed.
fn narrow_strip(passes: &Passes) -> Option<f64> {
    let mut widths: Vec<f64> =
        passes.passes.iter().flat_map(|p| &p.points).map(|p| p.width_mm).filter(|w| w.is_finite()).collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 10).copied()
}

/// Passes and links by the job's strategy.
fn planned(
    job: &Job,
    faces: &JobFaces,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    let cutter = job.cutter()?;
    let strategy = crate::strategy::of_job(job)?;
    let (passes, lean) = match strategy.fixed_axis() {
        Some(_) => (each_face(job, faces, &cutter, Lean::default(), &strategy, progress)?, Lean::default()),
        None => leaning_passes(job, faces, &cutter, &strategy, progress)?,
    };
    let linked = linked(job, faces, &passes, &cutter)?;
    Ok(Planned { passes, linked, strategy: strategy.name().to_owned(), lean, extras: Extras::default() })
}

/// Passes joined to a path.
pub fn linked(job: &Job, faces: &JobFaces, passes: &Passes, cutter: &Cutter) -> Result<Linked, Failure> {
    let mut obstacles = Box3::empty();
    for f in faces.faces.iter().chain(&faces.check) {
        obstacles = obstacles.union(&part::bounds(f));
    }
    let feed_mm_min = job.feed_mm_min()?;
    let length = |key: &str, given: Option<f64>, default: f64| match given {
        Some(v) if v.is_finite() && v > 0.0 => Ok(v),
        Some(v) => Err(Failure::file(&job.path, format!("[setup] {key} = {v} must be a positive number"))),
        None => Ok(default),
    };
    let links = Links {
        obstacles,
        clearance_mm: length("clearance_mm", job.setup.clearance_mm, 10.0)?,
        approach_mm: length("approach_mm", job.setup.approach_mm, 2.0)?,
        cutter_radius_mm: cutter.radius_mm(),
        feed_mm_min,
        plunge_mm_min: 0.5 * feed_mm_min,
    };
    Ok(link(&passes.passes, &links))
}

fn each_face(
    job: &Job,
    faces: &JobFaces,
    cutter: &Cutter,
    lean: Lean,
    strategy: &Strategy,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Passes, Failure> {
    let tolerance = job.tolerance()?;
    let n = faces.faces.len() as f64;
    let mut out = Passes::default();
    for (k, face) in faces.faces.iter().enumerate() {
        let here = move |f: f64| progress((k as f64 + f) / n);
        let task = Task { surface: &*face.surface, face: &face.id, cutter, lean, tolerance, progress: &here };
        let p = plan_face(&task, strategy).map_err(|e| Failure::file(&job.path, e))?;
        out.passes.extend(p.passes);
        out.diagnostics.extend(p.diagnostics);
    }
    Ok(out)
}

/// Passes of a tool that leans along them: the lead is the job's, or the best of a few.
fn leaning_passes(
    job: &Job,
    faces: &JobFaces,
    cutter: &Cutter,
    strategy: &Strategy,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<(Passes, Lean), Failure> {
    let mut leads: Vec<f64> = match job.strategy.lead_deg {
        AutoOr::Given(deg) => vec![deg],
        AutoOr::Auto if cutter.is_ball() => vec![BALL_LEAD_DEG],
        AutoOr::Auto => LEADS_DEG.to_vec(),
    };
    let choice = leads.len() > 1;
    if choice {
        leads = ranked(job, faces, cutter, &leads)?;
    }
    let mut best: Option<(f64, Passes, Lean)> = None;
    let mut refused: Option<Failure> = None;
    for deg in leads {
        let lean = job.lean(deg.to_radians())?;
        match each_face(job, faces, cutter, lean, strategy, progress) {
            Ok(mut p) if choice => {
                // The shortest path is of no use where the heel of the tool digs in: a coarse look at the CL path tells.
                let gouge = verify::coarse_gouge_mm(job, faces, &linked(job, faces, &p, cutter)?)?;
                p.diagnostics.push(Diagnostic::note(
                    "lead",
                    format!(
                        "{deg:.0} deg chosen of {LEADS_DEG:?} by predicted length and gouge ({gouge:.4} mm)"
                    ),
                ));
                if gouge <= job.tolerance()?.gouge_mm {
                    return Ok((p, lean));
                }
                if best.as_ref().is_none_or(|b| gouge < b.0) {
                    best = Some((gouge, p, lean));
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
fn ranked(job: &Job, faces: &JobFaces, cutter: &Cutter, leads: &[f64]) -> Result<Vec<f64>, Failure> {
    let tolerance = job.tolerance()?;
    let mut out = Vec::with_capacity(leads.len());
    for deg in leads {
        let lean = job.lean(deg.to_radians())?;
        let length: f64 = faces
            .faces
            .iter()
            .map(|face| {
                let (surface, face) = (&*face.surface, face.id.as_str());
                predicted_length_mm(&Task { surface, face, cutter, lean, tolerance, progress: &|_| {} })
            })
            .sum();
        out.push((length, *deg));
    }
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(out.into_iter().map(|o| o.1).collect())
}

fn describe(s: &Summary, v: &Verified, diagnostics: &[Diagnostic], out: &Path, control: &Control) -> String {
    let mut t = Table::new(["plan", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("strategy", s.strategy.clone(), "");
    row("lead, tilt", format!("{}, {}", number(s.lead_deg, 4), number(s.tilt_deg, 4)), "deg");
    row("passes", s.passes.to_string(), "");
    row("CL points", s.points.to_string(), "");
    row("cutting length", format!("{:.1}", s.cutting_length_mm), "mm");
    row("air length", format!("{:.1}", s.air_length_mm), "mm");
    row("time", format!("{:.2}", s.time_min), "min");
    row("of it cutting", format!("{:.2}", s.cutting_time_min), "min");
    row("area", format!("{:.1}", s.area_mm2), "mm2");
    row("global productivity", format!("{:.1}", s.productivity_mm2_min.global), "mm2/min");
    let mut text = format!("\n{}\n", t.render());
    let f = &s.verification;
    let mut t = Table::new(["verified from the NC text", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("samples", f.samples.to_string(), "");
    row("scallop max", format!("{:.5}", f.scallop_max_mm), "mm");
    row("scallop p99", format!("{:.5}", f.scallop_p99_mm), "mm");
    row("scallop median", format!("{:.5}", f.scallop_median_mm), "mm");
    row("gouge max", format!("{:.5}", f.gouge_max_mm), "mm");
    row("uncut area", format!("{:.3}", f.uncut_area_mm2), "mm2");
    text.push_str(&t.render());
    if f.within_tolerance {
        text.push_str("\n  within tolerance\n");
    } else {
        let red = std::io::IsTerminal::is_terminal(&std::io::stdout());
        let (on, off) = if red { ("\u{1b}[1;31m", "\u{1b}[0m") } else { ("", "") };
        text.push_str(&format!("\n  {on}NOT within tolerance{off}\n"));
        for w in v.worst.iter().take(5) {
            text.push_str(&format!(
                "  {} {} mm at ({:.3}, {:.3}, {:.3}) on {}, block {}\n",
                w.kind,
                number(w.value_mm, 4),
                w.at_mm[0],
                w.at_mm[1],
                w.at_mm[2],
                w.face,
                w.block
            ));
        }
    }
    let w = &s.wall_s;
    text.push_str(&format!(
        "\n  wall s: import {:.2}, plan {:.2}, post {:.2}, verify {:.2}, report {:.2}\n",
        w.import, w.plan, w.post, w.verify, w.report
    ));
    if !diagnostics.is_empty() {
        text.push_str(&format!("\n{}", render::findings(diagnostics)));
    }
    text.push_str(&format!(
        "\n  {0}/path.cl, {0}/program.{1}, {0}/report.html, {0}/picture.svg, {0}/summary.json\n\n",
        out.display(),
        control.extension
    ));
    text
}
