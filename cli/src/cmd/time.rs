//! `time`: how long a machine takes over an NC program, from its text, read as a stream.

use crate::screen::args::TimeArgs;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome, each_line};
use osculate::job::language::Language;
use osculate::words;
use osculate::words::Table;
use osculate::work::joints::JointFigures;
use osculate::work::nc;
use osculate_geom::Vec3;
use osculate_postproc::nc::timing::{Clock, Names};
use osculate_postproc::{Machine, Setup};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    time_min: f64,
    cutting_min: f64,
    rapid_min: f64,
    dwell_min: f64,
    limited_by: BTreeMap<String, usize>,
    joints: JointFigures,
    diagnostics: Vec<String>,
}

/// Runs the verb.
pub fn run(args: &TimeArgs, json: bool) -> Outcome {
    let machine = nc::machine(&args.machine)?;
    let language = nc::dialect_of(args.dialect.as_deref(), &args.file)?;
    let file = &args.file;
    let (names, setup) = names_and_setup(file, &language, &machine, (args.part_zero, args.gauge_length_mm))?;
    let here = |e| Failure::file(file, e);
    let mut clock = Clock::new(&names, &machine, &setup, args.strict).map_err(here)?;
    each_line(file, |line| clock.line(&language.engine_line(line)).map_err(here))?;
    let timed = clock.finish().map_err(here)?;
    let t = &timed.time;
    let answer = Answer {
        time_min: t.time_min(),
        cutting_min: t.cutting_min,
        rapid_min: t.rapid_min,
        dwell_min: t.dwell_min,
        limited_by: t.limited_by.clone(),
        joints: JointFigures::of(&timed.joints),
        diagnostics: timed.diagnostics.iter().map(ToString::to_string).collect(),
    };
    if json {
        render::json(&answer)?;
        return Ok(Done::with(&timed.diagnostics));
    }
    let mut table = Table::new(["time", "min", "s"]);
    for (name, min) in [
        ("feed moves", t.cutting_min),
        ("rapid moves", t.rapid_min),
        ("dwells", t.dwell_min),
        ("all", t.time_min()),
    ] {
        table.row([name.into(), format!("{min:.4}"), format!("{:.2}", 60.0 * min)]);
    }
    render::text(&format!("\n{}\n", table.render()))?;
    for (joint, count) in &t.limited_by {
        render::text(&format!("  {joint} makes {count} moves slower than F asks\n"))?;
    }
    if let Some(words) = answer.joints.words() {
        render::text(&format!("  {words}\n"))?;
    }
    if !timed.diagnostics.is_empty() {
        render::text(&format!("\n{}", words::findings(&timed.diagnostics)))?;
    }
    render::text("\n")?;
    Ok(Done::with(&timed.diagnostics))
}

/// Lines at the head of a program that may say its setup.
const HEAD_LINES: usize = 100;

/// What a program calls its axes, read from the whole of it, and where the part sits: as given, or else as the program's head says it was
/// posted for.
pub fn names_and_setup(
    file: &Path,
    language: &Language,
    machine: &Machine,
    (part_zero, gauge_length_mm): (Option<[f64; 3]>, Option<f64>),
) -> Result<(Names, Setup), Failure> {
    let mut names = Names::new(language.engine, machine);
    let (mut head, mut lines) = (String::new(), 0);
    each_line(file, |line| {
        let line = language.engine_line(line);
        names.line(&line);
        if lines < HEAD_LINES {
            head.push_str(&line);
            head.push('\n');
            lines += 1;
        }
        Ok(())
    })?;
    let posted = Setup::of_program(&head, language.engine).map_err(|e| Failure::file(file, e))?;
    let mut setup = posted.unwrap_or_default();
    if let Some(zero) = part_zero {
        setup.part_zero.translation.vector = Vec3::from(zero);
    }
    if let Some(length_mm) = gauge_length_mm {
        setup.gauge_length_mm = length_mm;
    }
    Ok((names, setup))
}
