//! `post`: CL data to NC code, tool by tool.

use crate::screen::args::PostArgs;
use crate::screen::output;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome};
use osculate::job::control::{Control, Words};
use osculate::job::words::nearest;
use osculate::words;
use osculate::words::{Table, number};
use osculate::work::nc;
use osculate_geom::{Diagnostic, Severity, Vec3};
use osculate_postproc::cldata::{ClPart, ClReadOptions, ClSection, ClStream, known_words};
use osculate_postproc::{
    Auxiliary, AuxiliaryWord, Orientation, PostOptions, PostReport, PostSummary, Section, Setup,
    SolveOptions, Spindle, WorkOffset, built_in_names, post_from, post_sections_to,
};
use osculate_tools::Cutter;
use serde::Serialize;
use std::io::{self, BufRead, BufReader, Seek, Write};
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    blocks: usize,
    time_min: f64,
    rewinds: usize,
    singular_mm: f64,
    inserted_points: usize,
    joined_points: usize,
    tip_error_mm: f64,
    axis_error_deg: f64,
    tools: Vec<ToolAnswer>,
    diagnostics: Vec<String>,
}

/// What one tool does.
#[derive(Serialize)]
struct ToolAnswer {
    number: u32,
    cutter: String,
    spindle_rpm: Option<f64>,
    line: usize,
    blocks: usize,
    time_min: f64,
}

/// Puts line and path length into findings that speak of a CL move.
fn located<R: BufRead + Seek, O: Fn() -> io::Result<R>>(
    part: &ClPart<'_, O>,
    mut notes: Vec<Diagnostic>,
) -> Vec<Diagnostic> {
    let mut moves: Vec<(usize, usize)> = notes
        .iter()
        .enumerate()
        .filter_map(|(k, d)| Some((d.place.strip_prefix("CL move ")?.parse().ok()?, k)))
        .collect();
    moves.sort_unstable();
    let indices: Vec<usize> = moves.iter().map(|(index, _)| *index).collect();
    if let (false, Ok(places)) = (indices.is_empty(), part.locate(&indices)) {
        for ((index, k), place) in moves.into_iter().zip(places) {
            notes[k].place =
                format!("CL line {} (move {index}, {:.3} mm on the way)", place.line, place.length_mm);
        }
    }
    notes
}

/// Losses that a refusal names.
const NAMED_LOSSES: usize = 4;

/// The word that a finding of an unknown one may mean.
fn near(found: &Diagnostic) -> String {
    let word = found.message.split([' ', '/']).next().unwrap_or_default();
    let known = || known_words().filter(|known| known.len() > 3);
    match nearest(word, known()) {
        Some(near) if !known().any(|known| known == word) => format!(" (is {near} meant?)"),
        _ => String::new(),
    }
}

/// Refuses what cannot be said in the program, with its lines.
fn refuse_losses(file: &Path, found: &[Diagnostic]) -> Result<(), Failure> {
    let lost: Vec<&Diagnostic> = found.iter().filter(|d| d.severity == Severity::Loss).collect();
    if lost.is_empty() {
        return Ok(());
    }
    let mut text: Vec<String> =
        lost.iter().take(NAMED_LOSSES).map(|d| format!("{}: {}{}", d.place, d.message, near(d))).collect();
    if lost.len() > NAMED_LOSSES {
        text.push(format!("{} more", lost.len() - NAMED_LOSSES));
    }
    if lost.iter().any(|d| d.message.starts_with("CUTCOM")) {
        text.push(
            "--cutcom centre says that points under CUTCOM are the cutter's centre, and posts them so"
                .to_owned(),
        );
    }
    text.push("--lenient leaves such statements out and lists them".to_owned());
    Err(Failure::file(file, text.join("\n  ")))
}

/// The gauge length of a section's tool, and what has to be assumed for it.
fn gauge(args: &PostArgs, section: &ClSection, notes: &mut Vec<Diagnostic>) -> Result<f64, Failure> {
    if let Some(length) = args.gauge_length_mm {
        return Ok(length);
    }
    let Some(spec) = section.tool.cutter else {
        let text = "the CL data has no cutter: a gauge length of 0 mm is assumed";
        notes.push(Diagnostic::note(format!("line {}", section.line), text));
        return Ok(0.0);
    };
    let here = |e| Failure::file(&args.clfile, format!("line {}: {e}", section.line));
    Ok(Cutter::try_from(spec).map_err(here)?.length_mm())
}

/// How closely the joints follow a section: where points are to be joined, the axis at the cutter's radius as closely as the tip.
fn joining(args: &PostArgs, section: &ClSection, usual: SolveOptions) -> Result<SolveOptions, Failure> {
    let Some(tip_tol_mm) = args.join_mm else { return Ok(usual) };
    let here = |e: &dyn std::fmt::Display| {
        Failure::file(&args.clfile, format!("line {}: --join-mm needs a cutter: {e}", section.line))
    };
    let spec = section.tool.cutter.ok_or_else(|| here(&"the CL data has none (CUTTER/ gives it)"))?;
    let axis_tol_rad = tip_tol_mm / Cutter::try_from(spec).map_err(|e| here(&e))?.radius_mm();
    let singular_cone_rad = usual.singular_cone_rad.min(0.5 * axis_tol_rad);
    Ok(SolveOptions { tip_tol_mm, axis_tol_rad, singular_cone_rad, join: true, ..usual })
}

/// What is done between the moves of a section, with the stop before it that is asked for.
fn stopping(args: &PostArgs, k: usize, section: &ClSection) -> Vec<Auxiliary> {
    let word = AuxiliaryWord::OptionalStop;
    let there = section.auxiliary.iter().any(|a| a.before == 0 && a.word == word);
    let stop = (args.stops && k > 0 && !there).then_some(Auxiliary { before: 0, word });
    stop.into_iter().chain(section.auxiliary.iter().copied()).collect()
}

/// Runs the verb.
pub fn run(args: &PostArgs, json: bool) -> Outcome {
    let here = |e: &dyn std::fmt::Display| Failure::file(&args.clfile, e);
    output::file(&args.out, &[&args.clfile, Path::new(&args.machine)])?;
    let open = || std::fs::File::open(&args.clfile).map(BufReader::new);
    open().map_err(|e| Failure::file(&args.clfile, format!("cannot be read: {e}")))?;
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
    let work_offset = args.work_offset.as_deref().map(str::parse::<WorkOffset>).transpose();
    let work_offset = work_offset.map_err(|e| Failure::job(format!("--work-offset: {e}")))?;
    let options = ClReadOptions { cutcom_is_centre: args.cutcom.is_some(), ..ClReadOptions::default() };
    let cl = ClStream::new(open, options);
    let outline = cl.outline().map_err(|e| here(&e))?;
    if !args.lenient {
        refuse_losses(&args.clfile, &outline.diagnostics)?;
    }
    let mut notes = outline.diagnostics.clone();
    let name = args.out.file_stem().map_or_else(|| "OSCULATE".into(), |s| s.to_string_lossy().into_owned());
    let orientation = match args.orientation.as_str() {
        "vectors" => Orientation::Vectors,
        "planes" => Orientation::Planes,
        _ => Orientation::Joints,
    };
    let usual = nc::post_options(&control, &name);
    let parts = cl.parts(&outline);
    let mut sections = Vec::with_capacity(parts.len());
    for (k, (part, section)) in parts.iter().zip(&outline.sections).enumerate() {
        if k > 0 && section.begins_at_feed {
            let text = "the first point after a tool change comes without RAPID: it is approached rapidly";
            notes.push(Diagnostic::warning(format!("line {}", section.line), text));
        }
        let tool = &section.tool;
        let options = PostOptions {
            spindle_rpm: tool.spindle.and_then(Spindle::rpm),
            counter_clockwise: matches!(tool.spindle, Some(Spindle::Counter { .. })),
            coolant: tool.coolant,
            tool_number: tool.number.unwrap_or(usual.tool_number),
            auxiliary: stopping(args, k, section),
            preselect: args.preselect,
            blend_mm: args.blend_mm.unwrap_or(usual.blend_mm),
            orientation,
            subprogram: args.subprogram,
            work_offset,
            solve: joining(args, section, usual.solve)?,
            blank_mm: args.blank_mm.map(|[a, b, c, d, e, f]| [[a, b, c], [d, e, f]]),
            program_number: args.program_number.unwrap_or(usual.program_number),
            ..usual.clone()
        };
        let gauge_length_mm = gauge(args, section, &mut notes)?;
        sections.push(Section { name: nc::cutter_words(tool.cutter), path: part, gauge_length_mm, options });
    }
    let first = &sections[0];
    let setup = Setup::at(Vec3::from(args.part_zero.unwrap_or_default()), first.gauge_length_mm);
    let reports: Vec<PostReport> = output::stream(&args.out, |out| {
        // Words of a dialect of its own are put in once the program is whole.
        let mut engine_text = Vec::new();
        let own = control.language.has_own_words();
        let file: &mut dyn Write = if own { &mut engine_text } else { &mut *out };
        let posted = if let [one] = &sections[..] {
            post_from(one.path, &control.machine, &setup, &one.options, file)
                .map(|r| vec![r])
                .map_err(|e| (0, e))
        } else {
            post_sections_to(&sections, &control.machine, &setup, file).map_err(|e| (e.section, e.error))
        };
        let reports = posted.map_err(|(k, e)| {
            let place = e.index().and_then(|i| parts[k].locate(&[i]).ok()?.pop());
            let tool = if sections.len() > 1 {
                format!(" with tool {}", sections[k].options.tool_number)
            } else {
                String::new()
            };
            match place {
                Some(p) => here(&format!("line {}, {:.3} mm on the way{tool}: {e}", p.line, p.length_mm)),
                None => here(&e),
            }
        })?;
        if own {
            let text = String::from_utf8(engine_text).expect("a program is text");
            let text = control.language.worded(text)?;
            out.write_all(text.as_bytes()).map_err(|e| Failure::file(&args.out, e))?;
        }
        Ok(reports)
    })?;
    let several = sections.len() > 1;
    for ((part, section), report) in parts.iter().zip(&sections).zip(&reports) {
        let mut own = located(part, report.diagnostics.clone());
        if several {
            own.iter_mut()
                .for_each(|d| d.message = format!("tool {}: {}", section.options.tool_number, d.message));
        }
        notes.extend(own);
    }
    let tools =
        sections.iter().zip(&outline.sections).zip(&reports).map(|((section, cl), report)| ToolAnswer {
            number: section.options.tool_number,
            cutter: section.name.clone(),
            spindle_rpm: section.options.spindle_rpm,
            line: cl.line,
            blocks: report.summary.blocks,
            time_min: report.summary.time_min,
        });
    let s = total(&reports);
    let answer = Answer {
        blocks: s.blocks,
        time_min: s.time_min,
        rewinds: s.rewinds,
        singular_mm: s.singular_mm,
        inserted_points: s.inserted_points,
        joined_points: s.joined_points,
        tip_error_mm: s.tip_error_mm,
        axis_error_deg: s.axis_error_deg,
        tools: tools.collect(),
        diagnostics: notes.iter().map(ToString::to_string).collect(),
    };
    if json {
        render::json(&answer)?;
    } else {
        show(&answer, &notes, &args.out)?;
    }
    Ok(Done::Yes)
}

/// The figures of all sections together.
fn total(reports: &[PostReport]) -> PostSummary {
    reports.iter().map(|r| r.summary).fold(PostSummary::default(), |a, b| PostSummary {
        blocks: a.blocks + b.blocks,
        time_min: a.time_min + b.time_min,
        rewinds: a.rewinds + b.rewinds,
        singular_mm: a.singular_mm + b.singular_mm,
        inserted_points: a.inserted_points + b.inserted_points,
        joined_points: a.joined_points + b.joined_points,
        tip_error_mm: a.tip_error_mm.max(b.tip_error_mm),
        axis_error_deg: a.axis_error_deg.max(b.axis_error_deg),
    })
}

fn show(answer: &Answer, notes: &[Diagnostic], out: &Path) -> Result<(), Failure> {
    let mut t = Table::new(["program", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("blocks", answer.blocks.to_string(), "");
    row("time", format!("{:.3}", answer.time_min), "min");
    row("rewinds", answer.rewinds.to_string(), "");
    row("near a pole", number(answer.singular_mm, 4), "mm");
    row("points put in", answer.inserted_points.to_string(), "");
    row("points joined", answer.joined_points.to_string(), "");
    row("tip error", number(answer.tip_error_mm, 3), "mm");
    row("axis error", number(answer.axis_error_deg, 3), "deg");
    render::text(&format!("\n{}\n  {}\n", t.render(), out.display()))?;
    if answer.tools.len() > 1 {
        let mut t = Table::new(["tool", "cutter", "rpm", "CL line", "blocks", "min"]);
        for one in &answer.tools {
            let rpm = one.spindle_rpm.map_or_else(String::new, |rpm| number(rpm, 6));
            let (line, blocks) = (one.line.to_string(), one.blocks.to_string());
            t.row([
                format!("T{}", one.number),
                one.cutter.clone(),
                rpm,
                line,
                blocks,
                format!("{:.3}", one.time_min),
            ]);
        }
        render::text(&format!("\n{}", t.render()))?;
    }
    if !notes.is_empty() {
        render::text(&format!("\n{}", words::findings(notes)))?;
    }
    render::text("\n")
}
