//! `verify`: material removal of a CL file or an NC program against the part.

use crate::failure::{Done, Failure, Outcome, read_text};
use crate::job::Job;
use crate::nc;
use crate::part;
use crate::progress::Stage;
use crate::render::{self, Table, number};
use crate::verify::{self, Verification, WorstPlace};
use osculate_geom::{Box3, Diagnostic};
use osculate_postproc::cldata;
use osculate_tools::removal::Swept;
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    verification: Verification,
    worst: Vec<WorstPlace>,
    diagnostics: Vec<String>,
}

/// Whether a text is CL data: a statement of APT stands in its first lines.
fn is_cl(path: &Path, text: &str) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if matches!(ending.as_deref(), Some("cl" | "apt" | "cls" | "aptsource")) {
        return true;
    }
    text.lines().take(200).any(|l| {
        let l = l.trim_start().to_uppercase();
        l.starts_with("GOTO/") || l.starts_with("PARTNO") || l.starts_with("LOADTL/")
    })
}

/// Runs the verb.
pub fn run(file: &Path, job_path: &Path, lenient: bool, json: bool) -> Outcome {
    let job = Job::load(job_path)?;
    let faces = part::of_job(&job)?;
    let text = read_text(file)?;
    let mut diagnostics: Vec<Diagnostic> = faces.part.diagnostics.clone();
    let (motions, source) = if is_cl(file, &text) {
        let cl = cldata::read(&text).map_err(|e| Failure::file(file, e))?;
        diagnostics.extend(cl.diagnostics);
        (Swept::along(&cl.path), "cl")
    } else {
        let (control, notes) = nc::control(&job)?;
        diagnostics.extend(notes);
        let (setup, notes) = nc::setup(&job, &faces)?;
        diagnostics.extend(notes);
        let read = nc::read_back(&text, &control, &setup, lenient).map_err(|e| Failure::file(file, e))?;
        diagnostics.extend(read.diagnostics);
        (read.motions, "nc")
    };
    if motions.is_empty() {
        return Err(Failure::file(file, "has no motion: at least two positions are needed"));
    }
    meet(file, &motions, &faces)?;
    let stage = Stage::begin("verify");
    let v = verify::run(&job, &faces, &motions, source, None, &|f| stage.at(f))?;
    let wall = stage.end();
    diagnostics.extend(v.diagnostics.iter().cloned());
    if json {
        render::json(&Answer {
            verification: v.summary.clone(),
            worst: v.worst.clone(),
            diagnostics: diagnostics.iter().map(ToString::to_string).collect(),
        })?;
    } else {
        let s = &v.summary;
        let mut t = Table::new(["verified", "", "unit"]);
        let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
        row("samples", s.samples.to_string(), "");
        row("spacing", number(s.spacing_mm, 4), "mm");
        row("scallop max", format!("{:.5}", s.scallop_max_mm), "mm");
        row("scallop p99", format!("{:.5}", s.scallop_p99_mm), "mm");
        row("gouge max", format!("{:.5}", s.gouge_max_mm), "mm");
        row("uncut area", format!("{:.3}", s.uncut_area_mm2), "mm2");
        row("wall time", format!("{wall:.2}"), "s");
        let word = if s.within_tolerance { "within tolerance" } else { "NOT within tolerance" };
        render::text(&format!("\n{}\n  {word}\n", t.render()));
        if !v.worst.is_empty() {
            let mut t = Table::new(["worst", "mm", "x", "y", "z", "face", "block"]);
            for w in &v.worst {
                let c = |k: usize| format!("{:.3}", w.at_mm[k]);
                t.row([
                    w.kind.clone(),
                    number(w.value_mm, 4),
                    c(0),
                    c(1),
                    c(2),
                    w.face.clone(),
                    w.block.to_string(),
                ]);
            }
            render::text(&format!("\n{}", t.render()));
        }
        if !diagnostics.is_empty() {
            render::text(&format!("\n{}", render::findings(&diagnostics)));
        }
        render::text("\n");
    }
    Ok(if v.summary.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}

/// Refuses a path that never comes near the part: a wrong unit or a wrong part zero.
fn meet(file: &Path, motions: &[Swept], faces: &part::JobFaces) -> Result<(), Failure> {
    let mut path = Box3::empty();
    for m in motions.iter().filter(|m| !m.rapid) {
        path.add(&m.from.tip);
        path.add(&m.to.tip);
    }
    let mut whole = Box3::empty();
    for f in &faces.faces {
        whole = whole.union(&part::bounds(f));
    }
    let reach = whole.grown(0.5 * whole.diagonal_mm());
    let apart = path.is_empty() || (0..3).any(|k| path.min[k] > reach.max[k] || path.max[k] < reach.min[k]);
    if apart {
        let show = |b: &Box3| {
            format!(
                "({:.1}, {:.1}, {:.1}) to ({:.1}, {:.1}, {:.1})",
                b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z
            )
        };
        return Err(Failure::file(
            file,
            format!(
                "the feed moves lie in {} mm, the part in {} mm: they do not meet; is the unit right (inch against \
                 mm), or [setup] part_zero_mm?",
                if path.is_empty() { "nothing".to_owned() } else { show(&path) },
                show(&whole)
            ),
        ));
    }
    Ok(())
}
