//! `plan`: the main job, from the part to a verified NC program with a report.

use crate::cancel;
use crate::choice::{self, Choice, Row};
use crate::drop;
use crate::failure::{Done, Failure, Outcome};
use crate::ideal::{self, IdealTime};
use crate::job::{Job, LeadKey};
use crate::left_out::{self, FaceLeftOut};
use crate::nc::Control;
use crate::output;
use crate::part::{self, JobFaces};
use crate::passes::{self, Way};
use crate::program::{Planned, Posted, WallS};
use crate::progress::Stage;
use crate::render::{self, Table, number};
use crate::report_fill::{self, Story};
use crate::rough;
use crate::verify::{self, Verification, Verified};
use osculate_geom::Diagnostic;
use osculate_productivity::levels::{Totals, levels};
use osculate_tools::Lean;
use serde::Serialize;
use std::path::Path;

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
    pub tool_words: String,
    pub lead_deg: f64,
    /// Least and greatest of a local lead; `lead_deg` is then their mean by length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead_range_deg: Option<[f64; 2]>,
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
    #[serde(flatten)]
    pub ideal: Option<IdealTime>,
    pub verification: Verification,
    /// Of faces, what passes leave out so that the tool does not go into the part; it is uncut too.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<FaceLeftOut>,
    worst: Vec<verify::WorstPlace>,
    pub wall_s: WallS,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub compared: Vec<Row>,
    diagnostics: Vec<String>,
}

impl Summary {
    /// Lead and tilt in words, degrees.
    pub fn lean_words(&self) -> String {
        let tilt = number(self.tilt_deg, 4);
        match self.lead_range_deg {
            Some([least, most]) => {
                let [least, mean, most] = [least, self.lead_deg, most].map(|x| number(x, 3));
                format!("{least} to {most} (mean {mean}), {tilt}")
            }
            None => format!("{}, {tilt}", number(self.lead_deg, 4)),
        }
    }
}

/// A plan with its program and what was measured, and what it was chosen from.
struct Proved {
    job: Job,
    planned: Planned<'static>,
    posted: Posted,
    verified: Verified,
    compared: Vec<Row>,
}

/// Runs the verb.
pub fn run(path: &Path, out: &Path, json: bool) -> Outcome {
    let job = Job::load(path)?;
    let mut wall_s = WallS::default();
    let stage = Stage::begin("import");
    left_out::check(&job)?;
    let faces = part::of_job(&job)?;
    wall_s.import = stage.end();

    let open = job.strategy.kind == "auto" || job.each_tool().len() > 1;
    let proved = if open {
        chosen(&job, &faces, out, &mut wall_s).map_err(|why| faces.warned(why))?
    } else {
        let stage = Stage::begin("plan");
        let planned = planned(&job, &faces, out, &|f| stage.at(f)).map_err(|why| faces.warned(why))?;
        wall_s.plan = stage.end();
        let posted = Posted::of(&job, &faces, &planned, &mut wall_s, Some(out))?;
        let verified = posted.verify(&job, &faces, &planned, &mut wall_s)?;
        Proved { job, planned, posted, verified, compared: Vec::new() }
    };
    let Proved { job, planned, posted, verified, compared } = proved;
    let whole = Whole { job: &job, faces: &faces, planned: &planned, posted, verified, compared };
    let (summary, text, _) = write(whole, wall_s, out)?;
    if json {
        render::json(&summary)?;
    } else {
        render::text(&text);
    }
    Ok(if summary.verification.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}

/// The fastest of all candidates whose program holds.
fn chosen(job: &Job, faces: &JobFaces, out: &Path, wall_s: &mut WallS) -> Result<Proved, Failure> {
    let stage = Stage::begin("choose");
    let mut choice = Choice::screen(job, faces)?;
    let settled = choice::settle(&mut choice, 1, Some(out), wall_s, &|f| stage.at(f))?;
    let mut planned = settled.planned;
    let compared = choice.rows();
    planned.extras.diagnostics.push(Diagnostic::note("auto", choice.story()));
    planned
        .extras
        .tables
        .push(choice::page_table(&compared, "Tools, strategies and leads compared".to_owned()));
    // Programs and verifications on the way have times of their own.
    wall_s.plan = stage.end() - wall_s.post - wall_s.verify;
    Ok(Proved { job: settled.job, planned, posted: settled.posted, verified: settled.verified, compared })
}

/// Posts a plan, verifies the program and writes everything; the summary comes back with its text and what was measured.
pub fn execute(
    job: &Job,
    faces: &JobFaces,
    planned: &Planned<'_>,
    mut wall_s: WallS,
    out: &Path,
) -> Result<(Summary, String, Verified), Failure> {
    let posted = Posted::of(job, faces, planned, &mut wall_s, Some(out))?;
    let verified = posted.verify(job, faces, planned, &mut wall_s)?;
    write(Whole { job, faces, planned, posted, verified, compared: Vec::new() }, wall_s, out)
}

/// Everything that is written.
struct Whole<'a> {
    job: &'a Job,
    faces: &'a JobFaces,
    planned: &'a Planned<'a>,
    posted: Posted,
    verified: Verified,
    compared: Vec<Row>,
}

/// Writes a plan with its program, verification and report.
fn write(whole: Whole<'_>, mut wall_s: WallS, out: &Path) -> Result<(Summary, String, Verified), Failure> {
    let Whole { job, faces, planned, posted, verified, compared } = whole;
    let stage = Stage::begin("ideal");
    // The least time for whole faces says nothing of a plan that leaves some of them out.
    let whole = planned.extras.left_out.is_empty();
    let ideal =
        if planned.with_strips && whole { Some(ideal::of_plan(job, faces, planned, &posted)?) } else { None };
    wall_s.ideal = stage.end();
    let stage = Stage::begin("report");
    let Posted { cl_text, control, program, read, diagnostics } = posted;
    let title = passes::title(job);
    let before = [&faces.part.diagnostics, &planned.passes.diagnostics, &planned.extras.diagnostics];
    let diagnostics: Vec<Diagnostic> = before
        .into_iter()
        .flatten()
        .cloned()
        .chain(diagnostics)
        .chain(verified.diagnostics.iter().cloned())
        .collect();
    let area_mm2: f64 = faces.faces.iter().map(part::area).sum();
    let feed = job.feed_mm_min()?;
    let left_mm2: f64 = planned.extras.left_out.iter().map(|f| f.area_mm2).sum();
    let totals = Totals { area_mm2: area_mm2 - left_mm2, time_min: read.time_min };
    let l = levels(&planned.passes.passes, feed, totals);
    let found = if planned.local { planned.passes.inclination_rad() } else { None };
    let mut summary = Summary {
        format: 1,
        strategy: planned.strategy.clone(),
        tool: serde_json::to_value(job.cutter_spec()?).map_err(Failure::job)?,
        tool_words: job.tool_words(),
        lead_deg: found.map_or(planned.lean.lead_rad, |[_, mean, _]| mean).to_degrees(),
        lead_range_deg: found.map(|[least, _, most]| [least, most].map(f64::to_degrees)),
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
        ideal,
        verification: verified.summary.clone(),
        left_out: planned.extras.left_out.clone(),
        worst: verified.worst.clone(),
        wall_s,
        compared,
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
    output::write(&out.join(format!("program.{}", control.extension)), program.text.as_bytes())?;
    output::write(&out.join("report.html"), pages.html.as_bytes())?;
    output::write(&out.join("picture.svg"), pages.svg.as_bytes())?;
    output::write(&out.join("path.svg"), pages.path_svg.as_bytes())?;
    summary.wall_s.report = stage.end();
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::job)? + "\n";
    output::write(&out.join("summary.json"), text.as_bytes())?;
    // What an earlier run saved when it was stopped is out of date.
    let _ = std::fs::remove_file(out.join(passes::PARTIAL));
    drop(whole);

    let text = describe(&summary, &verified, &diagnostics, out, &control);
    Ok((summary, text, verified))
}

/// Passes and links by the job's strategy.
fn planned(
    job: &Job,
    faces: &JobFaces,
    out: &Path,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Planned<'static>, Failure> {
    if drop::KINDS.contains(&job.strategy.kind.as_str()) {
        let passes = drop::passes(job, faces, progress)?;
        let (passes, linked, extras) = left_out::linked(job, faces, passes)?;
        let strategy = job.strategy.kind.clone();
        let lean = Lean::default();
        return Ok(Planned { passes, linked, strategy, lean, local: false, extras, with_strips: true });
    }
    if rough::is(job) {
        return rough::planned(job, faces, progress);
    }
    let strategy = &crate::strategy::of_job(job)?;
    let (passes, lean) = match strategy.fixed_axis() {
        Some(_) => {
            let way = Way { strategy, lean: Lean::default(), local: false, share: 1.0, out: Some(out) };
            (passes::each_face(job, faces, &way, progress)?, Lean::default())
        }
        None => passes::with_best_lead(job, faces, strategy, out, progress)?,
    };
    let (passes, linked, extras) = left_out::linked(job, faces, passes)?;
    let strategy = strategy.name().to_owned();
    let local = job.strategy.lead_deg == LeadKey::Local;
    Ok(Planned { passes, linked, strategy, lean, local, extras, with_strips: true })
}

fn describe(s: &Summary, v: &Verified, diagnostics: &[Diagnostic], out: &Path, control: &Control) -> String {
    let mut t = Table::new(["plan", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("tool", s.tool_words.clone(), "");
    row("strategy", s.strategy.clone(), "");
    row("lead, tilt", s.lean_words(), "deg");
    row("passes", s.passes.to_string(), "");
    row("CL points", s.points.to_string(), "");
    row("cutting length", format!("{:.1}", s.cutting_length_mm), "mm");
    row("air length", format!("{:.1}", s.air_length_mm), "mm");
    row("time", format!("{:.2}", s.time_min), "min");
    row("of it cutting", format!("{:.2}", s.cutting_time_min), "min");
    row("area", format!("{:.1}", s.area_mm2), "mm2");
    for left in &s.left_out {
        row(&format!("left out of {}", left.face), format!("{:.3}", left.area_mm2), "mm2");
    }
    row("global productivity", format!("{:.1}", s.productivity_mm2_min.global), "mm2/min");
    if let Some(i) = &s.ideal {
        row("ideal time, estimated", i.ideal.words(), "min");
        row("efficiency", format!("{:.0}", i.efficiency_percent), "%");
    }
    let mut text = String::from("\n");
    if !s.compared.is_empty() {
        text.push_str(&format!("{}\n", choice::text_table(&s.compared)));
    }
    text.push_str(&format!("{}\n", t.render()));
    let f = &s.verification;
    let mut t = Table::new(["verified from the NC text", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("samples", f.samples.to_string(), "");
    row("scallop max", format!("{:.5}", f.scallop_max_mm), "mm");
    row("scallop p99", format!("{:.5}", f.scallop_p99_mm), "mm");
    row("scallop median", format!("{:.5}", f.scallop_median_mm), "mm");
    row("median of its crests", format!("{:.5}", f.crest_median_mm), "mm");
    row("gouge max", format!("{:.5}", f.gouge_max_mm), "mm");
    row("uncut area", format!("{:.3}", f.uncut_area_mm2), "mm2");
    text.push_str(&t.render());
    if f.within_tolerance {
        text.push_str(&format!("\n  {}\n", f.words()));
    } else {
        let red = std::io::IsTerminal::is_terminal(&std::io::stdout());
        let (on, off) = if red { ("\u{1b}[1;31m", "\u{1b}[0m") } else { ("", "") };
        text.push_str(&format!("\n  {on}{}{off}\n", f.words()));
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
        "\n  wall s: import {:.2}, plan {:.2}, post {:.2}, verify {:.2}, ideal {:.2}, report {:.2}\n",
        w.import, w.plan, w.post, w.verify, w.ideal, w.report
    ));
    if !diagnostics.is_empty() {
        text.push_str(&format!("\n{}", render::findings(diagnostics)));
    }
    text.push_str(&format!(
        "\n  {0}/path.cl, {0}/program.{1}, {0}/report.html, {0}/picture.svg, {0}/path.svg, {0}/summary.json\n\n",
        out.display(),
        control.extension
    ));
    text
}
