//! `readback`: what an NC program makes the tool do, as CL data, read and written as a stream.

use crate::cmd::time::names_and_setup;
use crate::screen::args::ReadbackArgs;
use crate::screen::output;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome, each_line};
use osculate::words;
use osculate::words::{Table, number};
use osculate::work::nc;
use osculate_geom::Point3;
use osculate_postproc::cldata::{ClWriteOptions, ClWriter};
use osculate_postproc::readback::{ReadOptions, Reader};
use osculate_tools::cl::{ClMove, Motion};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

#[derive(Default, Serialize)]
struct Answer {
    blocks: usize,
    points: usize,
    cutting_length_mm: f64,
    air_length_mm: f64,
    diagnostics: Vec<String>,
}

/// Text is written when there is this much of it.
const PIECE_BYTES: usize = 1 << 16;

/// Runs the verb.
pub fn run(args: &ReadbackArgs, json: bool) -> Outcome {
    let file = &args.nc.file;
    output::file(&args.out, &[file, Path::new(&args.nc.machine)])?;
    let machine = nc::machine(&args.nc.machine)?;
    let language = nc::dialect_of(args.nc.dialect.as_deref(), file)?;
    let given = (args.nc.part_zero, args.nc.gauge_length_mm);
    let (names, setup) = names_and_setup(file, &language, &machine, given)?;
    let here = |e| Failure::file(file, e);
    let options = ReadOptions { strict: args.nc.strict, ..ReadOptions::default() };
    let mut reader = Reader::new(&names, &machine, &setup, &options).map_err(here)?;
    let name = args.out.file_stem().map_or_else(|| "OSCULATE".into(), |s| s.to_string_lossy().into_owned());
    let options = ClWriteOptions { part_name: name, ..ClWriteOptions::default() };
    let mut answer = Answer::default();
    output::stream(&args.out, |out| {
        let mut text = String::new();
        let mut writer: Option<ClWriter> = None;
        let mut at: Option<Point3> = None;
        let unwritten = |e| Failure::file(&args.out, e);
        each_line(file, |line| {
            reader.line(&language.engine_line(line)).map_err(here)?;
            answer.blocks += reader.take_blocks().count();
            let rpm = reader.spindle_rpm();
            for m in reader.take_moves() {
                let writer = writer.get_or_insert_with(|| ClWriter::new(&options, None, rpm, &mut text));
                let length_mm = at.replace(m.pose.tip).map_or(0.0, |p| (m.pose.tip - p).norm());
                match m.motion {
                    Motion::Rapid => answer.air_length_mm += length_mm,
                    Motion::Feed(_) => answer.cutting_length_mm += length_mm,
                }
                answer.points += 1;
                writer
                    .take(&ClMove { pose: m.pose, motion: m.motion, aloft: false }, &mut text)
                    .map_err(unwritten)?;
            }
            if text.len() >= PIECE_BYTES {
                out.write_all(text.as_bytes()).map_err(|e| Failure::file(&args.out, e))?;
                text.clear();
            }
            Ok(())
        })?;
        reader.end().map_err(here)?;
        if let Some(writer) = writer {
            writer.end(&mut text);
        }
        out.write_all(text.as_bytes()).map_err(|e| Failure::file(&args.out, e))
    })?;
    answer.diagnostics = reader.diagnostics().iter().map(ToString::to_string).collect();
    if json {
        render::json(&answer)?;
        return Ok(Done::with(reader.diagnostics()));
    }
    let mut t = Table::new(["tool's way", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("blocks", answer.blocks.to_string(), "");
    row("points", answer.points.to_string(), "");
    row("at feed", number(answer.cutting_length_mm, 4), "mm");
    row("rapid", number(answer.air_length_mm, 4), "mm");
    render::text(&format!("\n{}\n  {}\n", t.render(), args.out.display()))?;
    if !reader.diagnostics().is_empty() {
        render::text(&format!("\n{}", words::findings(reader.diagnostics())))?;
    }
    render::text("\n")?;
    Ok(Done::with(reader.diagnostics()))
}
