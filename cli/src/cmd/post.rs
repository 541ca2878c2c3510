//! `post`: CL data to NC code.

use crate::args::PostArgs;
use crate::failure::{Done, Failure, Outcome, read_text};
use crate::nc::{self, Control, Words};
use crate::output;
use crate::render::{self, Table, number};
use osculate_geom::{Diagnostic, Vec3};
use osculate_postproc::{Setup, built_in_names, cldata};
use osculate_tools::Cutter;
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    blocks: usize,
    time_min: f64,
    rewinds: usize,
    singular_mm: f64,
    inserted_points: usize,
    tip_error_mm: f64,
    axis_error_deg: f64,
    diagnostics: Vec<String>,
}

/// Runs the verb.
pub fn run(args: &PostArgs, json: bool) -> Outcome {
    let text = read_text(&args.clfile)?;
    let cl = cldata::read(&text).map_err(|e| Failure::file(&args.clfile, e))?;
    // A name without a separator or ending is a built-in machine, anything else a file.
    let built_in = built_in_names().contains(&args.machine.as_str());
    let looks_like_file = args.machine.ends_with(".toml") || Path::new(&args.machine).exists();
    let file = (!built_in && looks_like_file).then(|| Path::new(&args.machine));
    let control = Control::from_words(&Words {
        name: Some(&args.machine),
        file,
        dialect: &args.dialect,
        feed: &args.feed,
        kz_step: args.kz_step,
    })?;
    let cutter =
        cl.path.cutter.map(Cutter::try_from).transpose().map_err(|e| Failure::file(&args.clfile, e))?;
    let mut notes = cl.diagnostics.clone();
    let gauge = match (args.gauge_length_mm, cutter) {
        (Some(g), _) => g,
        (None, Some(c)) => c.length_mm() + cl.path.holder.map_or(0.0, |h| h.length_mm),
        (None, None) => {
            notes.push(Diagnostic::note(
                "setup",
                "the CL data has no cutter: a gauge length of 0 mm is assumed",
            ));
            0.0
        }
    };
    let setup = Setup::at(Vec3::from(args.part_zero.unwrap_or_default()), gauge);
    let name = args.out.file_stem().map_or_else(|| "OSCULATE".into(), |s| s.to_string_lossy().into_owned());
    drop(text);
    let posted = output::stream(&args.out, |file| {
        nc::post_to(&cl.path, &control, &setup, &name, file)
            .map_err(|f| Failure::file(&args.clfile, f.message()))
    })?;
    notes.extend(posted.diagnostics);
    let s = &posted.summary;
    let answer = Answer {
        blocks: s.blocks,
        time_min: s.time_min,
        rewinds: s.rewinds,
        singular_mm: s.singular_mm,
        inserted_points: s.inserted_points,
        tip_error_mm: s.tip_error_mm,
        axis_error_deg: s.axis_error_deg,
        diagnostics: notes.iter().map(ToString::to_string).collect(),
    };
    if json {
        render::json(&answer)?;
        return Ok(Done::Yes);
    }
    let mut t = Table::new(["program", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("blocks", answer.blocks.to_string(), "");
    row("time", format!("{:.3}", answer.time_min), "min");
    row("rewinds", answer.rewinds.to_string(), "");
    row("near a pole", number(answer.singular_mm, 4), "mm");
    row("points put in", answer.inserted_points.to_string(), "");
    row("tip error", number(answer.tip_error_mm, 3), "mm");
    row("axis error", number(answer.axis_error_deg, 3), "deg");
    render::text(&format!("\n{}\n  {}\n", t.render(), args.out.display()));
    if !notes.is_empty() {
        render::text(&format!("\n{}", render::findings(&notes)));
    }
    render::text("\n");
    Ok(Done::Yes)
}
