//! `plan`: the main job, from the part to a verified NC program with a report.

use crate::cmd::verify::figures;
use crate::screen::progress::SCREEN;
use crate::screen::{cancel, output, render};
use osculate::failure::{Done, Failure, Outcome, read_text};
use osculate::job::{Job, Operations};
use osculate::words::{self, Table, findings, number};
use osculate::work::choice;
use osculate::work::operations::{self, standing};
use osculate::work::plan::check;
use osculate::work::summary::Summary;
use osculate::work::verify::WorstPlace;
use osculate::{Part, Plan, Verified, plan};
use std::path::Path;

/// Operations that an earlier run of another list may have kept here.
const MOST_KEPT: usize = 100;

/// Runs the verb.
pub fn run(path: &Path, out: &Path, json: bool) -> Outcome {
    output::folder(out)?;
    let text = read_text(path)?;
    let claimed;
    let plan = if Operations::are_in(&text) {
        let list = Operations::from_toml(&text, path)?;
        claimed = output::claim(out)?;
        let (part, list) = operations::part(list, &SCREEN)?;
        SCREEN.saves_into(out);
        operations::plan(&part, &list, &SCREEN)?
    } else {
        let job = Job::from_toml(&text, path)?;
        check(&job)?;
        claimed = output::claim(out)?;
        let part = Part::watched(&job, &SCREEN)?;
        SCREEN.saves_into(out);
        plan(&part, &job, &SCREEN)?
    };
    write(&plan, out, &[])?;
    drop(claimed);
    if json {
        render::json(&plan.summary)?;
    } else {
        render::warning(&describe(&plan, out), red(&plan.verified).as_deref())?;
    }
    Ok(if plan.summary.verification.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}

/// Writes the files of a plan, and more that belong to them. A stop waits until all of them are there.
pub fn write(plan: &Plan, out: &Path, more: &[(&str, &[u8])]) -> Result<(), Failure> {
    let whole = cancel::whole();
    let own = plan.files().iter().map(|f| (f.name.as_str(), &*f.bytes));
    output::set(out, &own.chain(more.iter().copied()).collect::<Vec<_>>())?;
    // What an earlier run saved when it was stopped is out of date.
    let _ = std::fs::remove_file(out.join(cancel::PARTIAL));
    for place in 0..plan.summary.operations.len().max(MOST_KEPT) {
        let _ = std::fs::remove_file(out.join(operations::kept::name(place)));
    }
    drop(whole);
    Ok(())
}

/// A plan as its screen shows it.
pub fn describe(plan: &Plan, out: &Path) -> String {
    let (s, v) = (&plan.summary, &plan.verified);
    let mut t = Table::new(["plan", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    let of_one = s.operations.is_empty();
    if of_one {
        row("tool", s.tool_words.clone(), "");
        row("strategy", s.strategy.clone(), "");
        row("lead, tilt", s.lean_words(), "deg");
    }
    row("passes", s.passes.to_string(), "");
    row("CL points", s.points.to_string(), "");
    row("cutting length", format!("{:.1}", s.cutting_length_mm), "mm");
    row("air length", format!("{:.1}", s.air_length_mm), "mm");
    row("time", format!("{:.2}", s.time_min), "min");
    row("of it cutting", format!("{:.2}", s.cutting_time_min), "min");
    if let Some(min) = s.control_time_min {
        row("time on the control", format!("{min:.2}"), "min");
    }
    row("area", format!("{:.1}", s.area_mm2), "mm2");
    for left in &s.left_out {
        row(&format!("left out of {}", left.face), format!("{:.3}", left.area_mm2), "mm2");
    }
    let removes = s.productivity.removal.is_some() && s.productivity.finished_mm2.is_none();
    if !removes {
        row("global productivity", format!("{:.1}", s.productivity_mm2_min.global), "mm2/min");
    }
    for (what, value, unit) in s.productivity.rows() {
        row(what, value, unit);
    }
    if let Some(i) = &s.ideal {
        row("ideal time, estimated", i.ideal.words(), "min");
        if let Some(t) = i.ideal.isoparametric_min {
            row("of isoparametric passes", number(t, 3), "min");
        }
        row("efficiency", format!("{:.0}", i.efficiency_percent), "%");
    }
    let mut text = String::from("\n");
    if !s.compared.is_empty() {
        text.push_str(&format!("{}\n", choice::text_table(&s.compared)));
    }
    text.push_str(&operations_table(s));
    text.push_str(&format!("{}\n", t.render()));
    if let Some(words) = s.joints.as_ref().and_then(|j| j.words()) {
        text.push_str(&format!("  {words}\n\n"));
    }
    text.push_str(&format!("{}\n{}", figures(&s.verification), v.verdict));
    if !v.verdict.is_held() {
        for w in shown(&v.worst) {
            let [x, y, z] = w.at_mm;
            let value = number(w.value_mm, 4);
            let made = w.made_by();
            text.push_str(&format!(
                "  {} {value} mm at ({x:.3}, {y:.3}, {z:.3}) on {}, {made}\n",
                w.kind, w.face
            ));
        }
    }
    let w = &s.wall_s;
    let stages = [
        ("import", w.import),
        ("plan", w.plan),
        ("between operations", w.between),
        ("post", w.post),
        ("verify", w.verify),
        ("ideal", w.ideal),
        ("report", w.report),
    ];
    let stages: Vec<String> =
        stages.iter().filter(|s| s.1 > 0.0).map(|(name, s)| format!("{name} {s:.2}")).collect();
    text.push_str(&format!("\n  wall s: {}; in all {:.2}\n", stages.join(", "), w.total));
    if !plan.diagnostics.is_empty() {
        text.push_str(&format!("\n{}", findings(&plan.diagnostics)));
    }
    let files: Vec<String> = plan.files.iter().map(|f| out.join(&f.name).display().to_string()).collect();
    text.push_str(&format!("\n  {}\n\n", files.join(", ")));
    text
}

/// The operations of a list, and what they leave too high; nothing for a job of one.
fn operations_table(s: &Summary) -> String {
    if s.operations.is_empty() {
        return String::new();
    }
    let mut t = Table::new([
        "operation",
        "setup",
        "tool",
        "passes",
        "min",
        "cut mm",
        "air mm",
        "stood mm",
        "took mm3",
        "uncut mm2",
        "step",
    ]);
    let or_none = |x: Option<f64>, digits: usize| x.map_or_else(|| "-".to_owned(), |x| number(x, digits));
    for o in &s.operations {
        let f = &o.figures;
        t.row([
            o.name.clone(),
            o.setup.clone(),
            format!("T{} {}", o.tool_number, f.tool_words),
            f.passes.to_string(),
            format!("{:.2}", f.time_min),
            format!("{:.0}", f.cutting_length_mm),
            format!("{:.0}", f.air_length_mm),
            or_none(o.standing_mm, 3),
            or_none(o.removed_mm3, 5),
            number(f.verification.uncut_area_mm2, 4),
            o.step.to_owned(),
        ]);
    }
    let mut out = format!("{}\n", t.render());
    if !s.left_standing.is_empty() {
        let mut t = Table::left(["too high on", "mm2", "highest mm", "why, and what would do"]);
        for a in standing::alike(&s.left_standing) {
            let faces = words::listed(&a.faces, standing::LISTED);
            t.row([faces, number(a.area_mm2, 4), a.highest_words(), a.highest.why.clone()]);
        }
        out += &format!("{}\n", t.render());
    }
    out
}

/// What stands in red on a screen: the words of a verdict that is not held.
pub fn red(v: &Verified) -> Option<String> {
    (!v.verdict.is_held()).then(|| v.verdict.words())
}

/// Places that are told at most, and one of each kind.
const TOLD: usize = 5;

/// The worst places, of each kind one at least.
fn shown(worst: &[WorstPlace]) -> Vec<&WorstPlace> {
    let is_first = |k: usize| worst[..k].iter().all(|w| w.kind != worst[k].kind);
    let (first, others): (Vec<usize>, Vec<usize>) = (0..worst.len()).partition(|k| is_first(*k));
    let room = TOLD.saturating_sub(first.len());
    let mut places: Vec<usize> = first.into_iter().chain(others.into_iter().take(room)).collect();
    places.sort_unstable();
    places.into_iter().map(|k| &worst[k]).collect()
}
