//! `flank`: the side of a cutter on a ruled face, every positioning side by side, the chosen one as path and program.

mod pictures;

use crate::cmd::plan;
use crate::screen::output;
use crate::screen::progress::SCREEN;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::flank::least_mm;
use osculate::job::words::FlankShape;
use osculate::job::{Job, Source};
use osculate::part;
use osculate::report::{self, Column};
use osculate::watch::Stage;
use osculate::words::{Table, number};
use osculate::work::extras::{Extras, Field};
use osculate::work::flank::face::{FlankFace, judged};
use osculate::work::flank::largest::{Largest, Radius};
use osculate::work::flank::methods::{Answer, Method, Motion, NAMES, Study};
use osculate::work::flank::path::{self, Work};
use osculate::work::flank::ratio::Ratios;
use osculate::work::flank::span::BetterSpan;
use osculate::work::passes;
use osculate::work::plan::prove;
use osculate::work::program::{Planned, WallS};
use osculate_geom::{Axis, Diagnostic, Interval, Point3, Surface, uv};
use osculate_productivity::compare::Axes;
use osculate_tools::flank::envelope::{Envelope, Scratch};
use osculate_tools::flank::global::Options;
use osculate_tools::flank::{Rule, RuleError, RuledStrip};
use osculate_tools::{CutterSpec, Lean};
use serde::Serialize;
use std::path::Path;

/// A motion that leaves no more than this part of the tolerance is good enough: well below what a control resolves.
const ENOUGH: f64 = 1e-4;

/// What `--json` prints and `flank.json` holds.
#[derive(Debug, Serialize)]
struct Comparison {
    rule_length_mm: f64,
    /// None where the rule has no normals at its ends.
    normals_angle_deg: Option<f64>,
    at_u: f64,
    span_u: [f64; 2],
    judge_u: [f64; 2],
    along: &'static str,
    /// How far the lines across the face stray from straight ones.
    ruled_error_mm: f64,
    methods: Vec<Method>,
    chosen: String,
    /// The error along the rule.
    profiles: pictures::Profiles,
    /// The ratio of the errors over the radius, where there is one.
    ratio: Option<Ratios>,
    /// A span of positions with which the chosen setting, or three tangencies, would leave less.
    proposed_span_u: Option<[f64; 2]>,
    /// The program's heights as verified against those of the envelope.
    program: Option<path::Agreement>,
    diagnostics: Vec<String>,
}

/// Runs the verb.
pub fn run(path: &Path, (out, largest): (Option<&Path>, bool), json: bool) -> Outcome {
    if let Some(out) = out {
        output::folder(out)?;
    }
    let job = Job::load_with_one_tool(path)?;
    let _claimed = out.map(output::claim).transpose()?;
    let table = job.flank();
    let wrong = |text: String| Failure::file(job.path(), format!("[flank] {text}"));
    let chosen = table.method as usize;
    let mut wall_s = WallS::default();
    let stage = Stage::begin(&SCREEN, "import");
    let faces = part::of_job(&job)?;
    faces.part.to_plan(job.path())?;
    let FlankFace { face, along, straying_mm, .. } = FlankFace::of(&job, &faces)?;
    let faces = judged(&job, faces)?;
    wall_s.import = stage.end();

    let stage = Stage::begin(&SCREEN, "plan");
    let whole = face.domain().u;
    let span = table.span_u.unwrap_or(whole);
    let judge = table.judge_u.unwrap_or(whole);
    let at_u = table.at_u.unwrap_or_else(|| whole.at(0.5));
    if !(at_u >= whole.lo && at_u <= whole.hi) {
        return Err(wrong(format!(
            "at_u = {at_u} is off the face, whose u runs from {} to {}",
            whole.lo, whole.hi
        )));
    }
    let length = |u: f64| (face.point(uv(u, 1.0)) - face.point(uv(u, 0.0))).norm();
    let longest = [0.0, 0.5, 1.0].map(|t| length(whole.at(t))).into_iter().fold(0.0, f64::max);
    let strip = RuledStrip::between_borders(&*face, Axis::U, least_mm(longest)).map_err(|e| {
        Failure::file(job.path(), format!("[part] {e}: choose another range, or along = \"u\" or \"v\""))
    })?;
    // Where a directrix begins with an infinite derivative no setting stands at that rule, but motions pass it.
    let rule = match strip.rule(at_u) {
        Err(RuleError::NotFinite { .. }) => None,
        found => Some(found.map_err(|e| wrong(e.to_string()))?),
    };
    let cutter = job.cutter();
    let tolerance = job.tolerance();
    let bulge_per_mm = match job.cutter_spec() {
        CutterSpec::Barrel { barrel_radius_mm, .. } => 1.0 / barrel_radius_mm,
        _ => 0.0,
    };
    let options = Options {
        gouge_weight: table.gouge_weight,
        smoothness_per_mm: table.smoothness_per_mm,
        enough_mm: ENOUGH * tolerance.scallop_mm.min(tolerance.gouge_mm),
        ..Options::default()
    };
    let study = Study {
        face: &*face,
        strip: &strip,
        cutter,
        bulge_per_mm,
        below_mm: table.below_mm,
        at_u,
        span,
        longer: longer(table.span_u.is_some(), span, &*face, cutter.radius_mm()),
        judge,
        // A formula goes on as it is written; what stands in a file ends where it ends.
        beyond: if matches!(job.part().source(), Source::Builtin(_)) { 0.25 } else { 0.0 },
        positions: table.positions,
        spans: table.spans,
        options,
        tolerance: [tolerance.scallop_mm, tolerance.gouge_mm],
    };
    if largest {
        let found = study.largest().map_err(|e| wrong(e.to_string()))?;
        stage.end();
        return show_largest(&LargestTools::of(&study, found), json).map(|()| Done::Yes);
    }
    let answers: Vec<Answer> = NAMES
        .iter()
        .enumerate()
        .map(|(k, name)| {
            stage.at(k as f64 / NAMES.len() as f64);
            study.run(name)
        })
        .collect();
    let mut diagnostics = notes(&job, straying_mm, rule.as_ref());
    diagnostics.extend(outside(&answers[chosen].row));
    let better = [NAMES[chosen], "optimum"]
        .iter()
        .find_map(|name| study.better_span(&answers.iter().find(|a| a.row.name == *name)?.row));
    diagnostics.extend(better.as_ref().map(|b| span_words(b, &study, &answers)));
    let ratio = study.ratios();
    diagnostics
        .push(Diagnostic::note("flank", ratio.as_ref().map_or_else(ToString::to_string, pictures::sentence)));
    let rule_length_mm = length(at_u);
    let profiles = pictures::Profiles::of(&answers, rule_length_mm);
    let drawn = [pictures::profile(&profiles, &answers, &study), pictures::ratio(&ratio)];
    let mut comparison = Comparison {
        rule_length_mm,
        normals_angle_deg: rule.map(|r| r.twist_rad().abs().to_degrees()),
        at_u,
        span_u: [span.lo, span.hi],
        judge_u: [judge.lo, judge.hi],
        along: if along == Axis::U { "u" } else { "v" },
        ruled_error_mm: straying_mm,
        methods: answers.iter().map(|a| a.row.clone()).collect(),
        chosen: table.method.word().to_owned(),
        profiles,
        ratio: ratio.ok(),
        proposed_span_u: better.map(|b| [b.span.lo, b.span.hi]),
        program: None,
        diagnostics: diagnostics.iter().map(ToString::to_string).collect(),
    };
    let answer = &answers[chosen];
    let Some(out) = out else {
        stage.end();
        show(&comparison, json, "", None)?;
        return Ok(Done::Yes);
    };
    let Some(motion) = &answer.motion else {
        return Err(wrong(format!("method = \"{}\": {}", table.method.word(), answer.row.why)));
    };
    let motion = path::oriented(&job, motion)?;
    let work = Work {
        job: &job,
        face: &*face,
        judge,
        cutter: &cutter,
        motion: &motion,
        check: &faces.check,
        chord_mm: tolerance.chord_mm,
    };
    let passes = path::pass(&work)?;
    let linked = passes::linked(&job, &faces, &passes.passes.clone().into())?;
    wall_s.plan = stage.end();
    let axes = passes.passes.iter().flat_map(|p| &p.points).map(|p| p.pose.axis).collect();
    let tables = vec![page_table(&comparison)];
    let extras = Extras { axes, maps: maps(&answers), tables, left_out: Vec::new(), diagnostics };
    let strategy = format!("flank, {}", table.method.word());
    let planned = Planned {
        passes,
        skipped: Vec::new(),
        linked,
        strategy,
        lean: Lean::default(),
        axes: Axes::Held,
        extras,
        with_strips: false,
    };
    SCREEN.saves_into(out);
    let plan = prove(&job, &faces, planned, wall_s, &SCREEN)?;
    comparison.program = Some(path::agreement(&motion, path::lead_mm(&job, &cutter), &plan.verified));
    let text_json = serde_json::to_string_pretty(&comparison).map_err(Failure::job)? + "\n";
    let [profile, ratio] = drawn;
    let own = [("flank.json", text_json), ("profile.svg", profile), ("ratio.svg", ratio)];
    plan::write(&plan, out, &own.each_ref().map(|(name, text)| (*name, text.as_bytes())))?;
    let names: Vec<String> = own.iter().map(|(name, _)| out.join(name).display().to_string()).collect();
    let more = format!("{}  {}\n", plan::describe(&plan, out), names.join(", "));
    show(&comparison, json, &more, plan::red(&plan.verified).as_deref())?;
    Ok(if plan.summary.verification.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}

/// Way in radii that a motion of least deviation goes on beyond the span's ends: the ends of a face are cut from there.
const BEYOND: f64 = 0.5;

/// The span, longer at both ends where the job leaves it to the program.
fn longer(given: bool, span: Interval, face: &dyn Surface, radius_mm: f64) -> Interval {
    if given {
        return span;
    }
    let beyond = |u: f64| {
        let rate = face.jet2(uv(u, 0.5)).du.norm();
        let way = BEYOND * radius_mm / rate;
        if way.is_finite() { way.min(0.5 * span.length()) } else { 0.0 }
    };
    Interval::new(span.lo - beyond(span.lo), span.hi + beyond(span.hi))
}

/// The share of the face that a method cannot hold, as a finding.
fn outside(row: &Method) -> Option<Diagnostic> {
    let (share, range) = (row.share_within?, row.envelope_mm?);
    (share < 1.0).then(|| {
        let (outside, name) = (100.0 * (1.0 - share), row.name);
        let (min, max) = (range.min, range.max);
        Diagnostic::warning(
            "flank",
            format!("{name}: {outside:.1} % of the judged face is out of tolerance, from {min:.4} to {max:.4} mm; the map shows where"),
        )
    })
}

/// A better span of positions, as a finding.
fn span_words(b: &BetterSpan, study: &Study<'_>, answers: &[Answer]) -> Diagnostic {
    let now = answers.iter().find(|a| a.row.name == b.name).and_then(|a| a.row.envelope_mm);
    let leaves = match b.off_face {
        [Some(a), Some(z)] => format!("its contacts leave the face below u = {a:.4} and above {z:.4}; "),
        [Some(a), None] => format!("its contacts leave the face below u = {a:.4}; "),
        [None, Some(z)] => format!("its contacts leave the face above u = {z:.4}; "),
        [None, None] => String::new(),
    };
    let is = now.map_or_else(String::new, |r| {
        format!(" in place of {:+.4} to {:+.4} mm with [{}, {}]", r.min, r.max, study.span.lo, study.span.hi)
    });
    let (min, max) = (b.envelope_mm.min, b.envelope_mm.max);
    Diagnostic::note(
        "flank",
        format!(
            "{}: {leaves}with [flank] span_u = [{}, {}] its envelope leaves {min:+.4} to {max:+.4} mm{is}",
            b.name, b.span.lo, b.span.hi
        ),
    )
}

/// What is to be known about the face.
fn notes(job: &Job, straying_mm: f64, rule: Option<&Rule>) -> Vec<Diagnostic> {
    let mut out = Vec::new();
    if job.flank().face == FlankShape::Borders {
        out.push(Diagnostic::warning(
            "flank",
            format!("milled as the straight lines between the face's borders; the face itself strays from them by up to {straying_mm:.4} mm"),
        ));
    } else if straying_mm > job.flank().ruled_tolerance_mm {
        out.push(Diagnostic::warning(
            "flank",
            format!(
                "the face is not ruled: lines across it stray by up to {straying_mm:.4} mm from straight ones; the settings at a \
                 rule see the strip between its borders, every envelope is held against the face itself"
            ),
        ));
    }
    if rule.is_some_and(|r| r.twist_rad().abs() < 1e-9) {
        out.push(Diagnostic::note(
            "flank",
            "the end normals of the rule are parallel: developable there, all settings agree",
        ));
    }
    out
}

/// A map of the deviation of each method, for the report.
fn maps(answers: &[Answer]) -> Vec<(report::Scalar, Field<'_>)> {
    answers
        .iter()
        .filter_map(|a| {
            let Motion { pieces, side, .. } = a.motion.as_ref()?;
            let envelope = Envelope::new(*side, pieces);
            let field = move |_: usize, p: &Point3| envelope.distance_mm(p, &mut Scratch::default());
            let name = format!("{} envelope", a.row.name.replace('_', " "));
            Some((report::Scalar { name, unit: "mm".to_owned() }, Box::new(field) as Field<'_>))
        })
        .collect()
}

fn cells(m: &Method) -> [String; 8] {
    let one = |x: Option<f64>, d: usize| x.map_or_else(|| "-".to_owned(), |x| number(x, d));
    let two = |r: Option<osculate::work::flank::methods::Range>| {
        r.map_or_else(|| "-".to_owned(), |r| format!("{:+.6} {:+.6}", r.min, r.max))
    };
    [
        m.name.to_owned(),
        if m.valid { "yes" } else { "no" }.to_owned(),
        one(m.gamma_deg, 7),
        two(m.static_mm),
        two(m.envelope_mm),
        one(m.lower_bound_mm, 6),
        m.share_within.map_or_else(|| "-".to_owned(), |s| format!("{:.1}", 100.0 * s)),
        m.why.clone(),
    ]
}

const HEADINGS: [&str; 8] =
    ["method", "valid", "gamma deg", "static mm", "envelope mm", "bound mm", "within %", "verdict"];

/// The table as it stands in the report.
fn page_table(c: &Comparison) -> report::Table {
    report::Table {
        caption: format!("Positionings, rule of {:.4} mm at u = {}", c.rule_length_mm, c.at_u),
        columns: HEADINGS.iter().map(|h| Column { name: (*h).to_owned(), unit: String::new() }).collect(),
        rows: c.methods.iter().map(|m| cells(m).to_vec()).collect(),
    }
}

/// What `--largest-tool --json` prints.
#[derive(Debug, Serialize)]
struct LargestTools {
    at_u: f64,
    span_u: [f64; 2],
    /// Of the static deviation, above and below the face.
    tolerance_mm: f64,
    largest: Vec<Largest>,
}

impl LargestTools {
    fn of(study: &Study<'_>, largest: Vec<Largest>) -> Self {
        let tolerance_mm = study.tolerance[0].min(study.tolerance[1]);
        Self { at_u: study.at_u, span_u: [study.span.lo, study.span.hi], tolerance_mm, largest }
    }
}

fn show_largest(all: &LargestTools, json: bool) -> Result<(), Failure> {
    if json {
        return render::json(all);
    }
    let mut t = Table::new(["setting", "at rule mm", "limited by", "over span mm", "limited by"]);
    let radius = |r: &Radius| r.radius_mm.map_or_else(|| "none".to_owned(), |mm| number(mm, 6));
    for l in &all.largest {
        let [at, over] = [&l.at_rule, &l.over_span];
        t.row([l.name.to_owned(), radius(at), at.limited_by.clone(), radius(over), over.limited_by.clone()]);
    }
    render::text(&format!(
        "\n  largest radius of a cylinder that deviates by no more than {} mm, at the rule of u = {} and at all rules of u = {} to {}\n\n{}\n",
        all.tolerance_mm,
        all.at_u,
        all.span_u[0],
        all.span_u[1],
        t.render()
    ))
}

fn show(c: &Comparison, json: bool, more: &str, red: Option<&str>) -> Result<(), Failure> {
    if json {
        return render::json(c);
    }
    let mut t = Table::new(HEADINGS);
    for m in &c.methods {
        t.row(cells(m));
    }
    let normals = c.normals_angle_deg.map_or_else(
        || "without normals at its ends".to_owned(),
        |deg| format!("its end normals enclose {} deg", number(deg, 9)),
    );
    let mut text = format!(
        "\n  rule at u = {}: {} mm long, {normals}; judged over u = {} to {}\n\n{}",
        c.at_u,
        number(c.rule_length_mm, 9),
        c.judge_u[0],
        c.judge_u[1],
        t.render()
    );
    if let Some(p) = &c.program {
        text.push_str(&format!(
            "\n  the program as verified and the envelope differ by at most {:.6} mm at {} samples ({:.6} mm at 99 %)\n",
            p.max_mm, p.samples, p.p99_mm
        ));
    }
    // Those of a plan stand among its own.
    for d in c.diagnostics.iter().filter(|_| more.is_empty()) {
        text.push_str(&format!("  {d}\n"));
    }
    text.push_str(more);
    text.push('\n');
    render::warning(&text, red)
}
