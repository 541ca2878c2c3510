//! `post`: CL data to NC code.

use crate::screen::args::PostArgs;
use crate::screen::output;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::control::{Control, Words};
use osculate::words;
use osculate::words::{Table, number};
use osculate::work::nc;
use osculate_geom::{Diagnostic, Vec3};
use osculate_postproc::cldata::{ClReadOptions, ClStream};
use osculate_postproc::{Orientation, PostOptions, Setup, built_in_names, post_from};
use osculate_tools::Cutter;
use serde::Serialize;
use std::io::{self, BufRead, BufReader};
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

/// Puts line and path length into findings that speak of a CL move.
fn located<R: BufRead, O: Fn() -> io::Result<R>>(
    cl: &ClStream<O>,
    mut notes: Vec<Diagnostic>,
) -> Vec<Diagnostic> {
    let mut moves: Vec<(usize, usize)> = notes
        .iter()
        .enumerate()
        .filter_map(|(k, d)| Some((d.place.strip_prefix("CL move ")?.parse().ok()?, k)))
        .collect();
    moves.sort_unstable();
    let indices: Vec<usize> = moves.iter().map(|(index, _)| *index).collect();
    if let (false, Ok(places)) = (indices.is_empty(), cl.locate(&indices)) {
        for ((index, k), place) in moves.into_iter().zip(places) {
            notes[k].place =
                format!("CL line {} (move {index}, {:.3} mm on the way)", place.line, place.length_mm);
        }
    }
    notes
}

/// Runs the verb.
pub fn run(args: &PostArgs, json: bool) -> Outcome {
    let here = |e: &dyn std::fmt::Display| Failure::file(&args.clfile, e);
    let open = || std::fs::File::open(&args.clfile).map(BufReader::new);
    open().map_err(|e| Failure::file(&args.clfile, format!("cannot be read: {e}")))?;
    let cl = ClStream::new(open, ClReadOptions::default());
    let head = cl.head().map_err(|e| here(&e))?;
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
    let cutter = head.cutter().map(Cutter::try_from).transpose().map_err(|e| here(&e))?;
    let mut notes = Vec::new();
    let gauge = match (args.gauge_length_mm, cutter) {
        (Some(g), _) => g,
        (None, Some(c)) => c.length_mm(),
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
    let orientation = match args.orientation.as_str() {
        "vectors" => Orientation::Vectors,
        "planes" => Orientation::Planes,
        _ => Orientation::Joints,
    };
    let options = PostOptions {
        spindle_rpm: head.spindle_rpm(),
        coolant: head.coolant(),
        orientation,
        subprogram: args.subprogram,
        ..nc::post_options(&control, &name)
    };
    let posted = output::stream(&args.out, |file| {
        post_from(&cl, &control.machine, &setup, &options, file).map_err(|e| {
            let place = e.index().and_then(|i| cl.locate(&[i]).ok()?.pop());
            match place {
                Some(p) => here(&format!("line {}, {:.3} mm on the way: {e}", p.line, p.length_mm)),
                None => here(&e),
            }
        })
    })?;
    let mut all = cl.diagnostics();
    all.append(&mut notes);
    all.extend(located(&cl, posted.diagnostics));
    let notes = all;
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
        render::text(&format!("\n{}", words::findings(&notes)));
    }
    render::text("\n");
    Ok(Done::Yes)
}
