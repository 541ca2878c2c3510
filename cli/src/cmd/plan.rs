//! `plan`: the main job, from the part to a verified NC program with a report.

use crate::cancel;
use crate::drop;
use crate::failure::{Done, Failure, Outcome};
use crate::job::Job;
use crate::nc::{self, Control};
use crate::output;
use crate::part::{self, JobFaces};
use crate::passes::{self, Way};
use crate::progress::Stage;
use crate::render::{self, Table, number};
use crate::report_fill::{self, Extras, Story};
use crate::verify::{self, Verification, Verified};
use osculate_geom::Diagnostic;
use osculate_postproc::Posted;
use osculate_productivity::levels::{Totals, levels};
use osculate_productivity::plan::{Linked, Passes};
use osculate_tools::Lean;
use serde::Serialize;
use std::path::Path;

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
    /// Whether the points of passes know the width of their strips, for samples that resolve them.
    pub with_strips: bool,
}

/// A plan posted and measured.
pub struct Proved {
    cl_text: String,
    control: Control,
    posted: Posted,
    read: nc::Motions,
    /// What was measured.
    pub verified: Verified,
    /// Findings of posting and measuring.
    diagnostics: Vec<Diagnostic>,
}

/// Runs the verb.
pub fn run(path: &Path, out: &Path, json: bool) -> Outcome {
    let job = Job::load_with_one_tool(path)?;
    let mut wall_s = WallS::default();
    let stage = Stage::begin("import");
    let faces = part::of_job(&job)?;
    wall_s.import = stage.end();

    let stage = Stage::begin("plan");
    let planned = planned(&job, &faces, out, &|f| stage.at(f))?;
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
    let proved = prove(job, faces, planned, &mut wall_s, out)?;
    write(job, faces, planned, proved, wall_s, out)
}

/// Posts a plan and verifies the program. From here on a stopped run leaves the path as a partial result.
pub fn prove(
    job: &Job,
    faces: &JobFaces,
    planned: &Planned<'_>,
    wall_s: &mut WallS,
    out: &Path,
) -> Result<Proved, Failure> {
    let (control, control_notes) = nc::control(job)?;
    let stage = Stage::begin("post");
    let (setup, setup_notes) = nc::setup(job, faces, &planned.extras.axes)?;
    let cl = passes::cl_path(job, &planned.linked)?;
    let title = passes::title(job);
    let cl_text = nc::cl_text(&cl, &title).map_err(Failure::job)?;
    let text = cl_text.clone();
    passes::keep_partial(out, move || Ok(text), "the whole path".to_owned());
    let posted = nc::post(&cl, &control, &setup, &title)?;
    stage.at(0.6);
    let read = nc::read_back(&posted.text, &control, &setup, false)
        .map_err(|e| Failure::job(format!("the program just written cannot be read back: {e}")))?;
    wall_s.post += stage.end();

    let stage = Stage::begin("verify");
    let strip = planned.with_strips.then(|| narrow_strip(&planned.passes)).flatten();
    let verified = verify::run(job, faces, &read.motions, "nc", strip, &|f| stage.at(f))?;
    wall_s.verify += stage.end();
    let diagnostics =
        [&control_notes, &setup_notes, &posted.diagnostics, &read.diagnostics, &verified.diagnostics];
    let diagnostics = diagnostics.into_iter().flatten().cloned().collect();
    Ok(Proved { cl_text, control, posted, read, verified, diagnostics })
}

/// Writes a plan with its program, verification and report.
pub fn write(
    job: &Job,
    faces: &JobFaces,
    planned: &Planned<'_>,
    proved: Proved,
    wall_s: WallS,
    out: &Path,
) -> Result<(Summary, String, Verified), Failure> {
    let stage = Stage::begin("report");
    let Proved { cl_text, control, posted, read, verified, diagnostics } = proved;
    let title = passes::title(job);
    let before = [&faces.part.diagnostics, &planned.passes.diagnostics, &planned.extras.diagnostics];
    let diagnostics: Vec<Diagnostic> = before.into_iter().flatten().cloned().chain(diagnostics).collect();
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
    // A stop waits until all of them are there.
    let whole = cancel::whole();
    output::write(&out.join("path.cl"), cl_text.as_bytes())?;
    output::write(&out.join(format!("program.{}", control.extension)), posted.text.as_bytes())?;
    output::write(&out.join("report.html"), pages.html.as_bytes())?;
    output::write(&out.join("picture.svg"), pages.svg.as_bytes())?;
    summary.wall_s.report = stage.end();
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::job)? + "\n";
    output::write(&out.join("summary.json"), text.as_bytes())?;
    // What an earlier run saved when it was stopped is out of date.
    let _ = std::fs::remove_file(out.join(passes::PARTIAL));
    drop(whole);

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
    out: &Path,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    if job.strategy.kind == drop::KIND {
        let passes = drop::passes(job, faces, progress)?;
        let linked = passes::linked(job, faces, &passes, &job.cutter()?)?;
        let (strategy, extras) = (drop::KIND.to_owned(), Extras::default());
        return Ok(Planned { passes, linked, strategy, lean: Lean::default(), extras, with_strips: true });
    }
    let strategy = &crate::strategy::of_job(job)?;
    let (passes, lean) = match strategy.fixed_axis() {
        Some(_) => {
            let way = Way { strategy, lean: Lean::default(), out: Some(out) };
            (passes::each_face(job, faces, &way, progress)?, Lean::default())
        }
        None => passes::with_best_lead(job, faces, strategy, out, progress)?,
    };
    let linked = passes::linked(job, faces, &passes, &job.cutter()?)?;
    let (strategy, extras) = (strategy.name().to_owned(), Extras::default());
    Ok(Planned { passes, linked, strategy, lean, extras, with_strips: true })
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
