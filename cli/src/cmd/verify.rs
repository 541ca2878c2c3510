//! `verify`: material removal of a CL file or an NC program against the part.

use crate::screen::progress::SCREEN;
use crate::screen::{output, render};
use osculate::Part;
use osculate::failure::{Done, Failure, Outcome, read_text};
use osculate::job::{Job, Operations};
use osculate::watch::Stage;
use osculate::words::{self, Table, number};
use osculate::work::check::{Checked, Source, check};
use osculate::work::joints::JointFigures;
use osculate::work::measured_data;
use osculate::work::nc::Motions;
use osculate::work::operations::{self, Text};
use osculate::work::opinion::{self, SecondOpinion};
use osculate::work::ply;
use osculate::work::stock::StockSummary;
use osculate::work::verify::{HistogramBin, VerdictKeys, Verification, Verified, WorstPlace};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    verification: Verification,
    verdict: VerdictKeys,
    #[serde(skip_serializing_if = "Option::is_none")]
    second_opinion: Option<SecondOpinion>,
    worst: Vec<WorstPlace>,
    confidence: String,
    histogram: Vec<HistogramBin>,
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<JointFigures>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stock: Option<StockSummary>,
    diagnostics: Vec<String>,
}

/// What the command line adds.
pub struct Options<'a> {
    /// Skip words that are not understood.
    pub lenient: bool,
    /// Ask for a second opinion.
    pub second_opinion: bool,
    /// Where the surface as cut goes.
    pub ply: Option<&'a Path>,
    /// Where the blocks' engagement goes.
    pub blocks: Option<&'a Path>,
    /// The folder for what was measured and the tool's way.
    pub data: Option<&'a Path>,
}

/// Runs the verb.
pub fn run(files: &[PathBuf], job_path: &Path, options: &Options<'_>, json: bool) -> Outcome {
    for path in [options.ply, options.blocks].into_iter().flatten() {
        let read: Vec<&Path> = files.iter().map(PathBuf::as_path).chain([job_path]).collect();
        output::file(path, &read)?;
    }
    options.data.map_or(Ok(()), output::folder)?;
    let job_text = read_text(job_path)?;
    if Operations::are_in(&job_text) {
        return of_list(files, Operations::from_toml(&job_text, job_path)?, options, json);
    }
    let [file] = files else {
        let text = format!("{} programs are given where the job has one operation: give one", files.len());
        return Err(Failure::file(job_path, text));
    };
    let job = Job::from_toml(&job_text, job_path)?;
    if options.blocks.is_some() && job.stock().is_none() {
        let text = "--blocks tells what blocks take from raw material: give a [stock]";
        return Err(Failure::file(job_path, text));
    }
    let text = read_text(file)?;
    let part = Part::of(&job)?;
    let source = Source { file, text: &text, lenient: options.lenient };
    let Checked { verified: v, job, read, wall_s } = check(&part, &job, &source, &SCREEN)?;
    let (v, second) = match options.second_opinion {
        true if read.source == "cl" => {
            return Err(Failure::file(file, "--second-opinion is on NC programs; this is CL data"));
        }
        true => {
            let stage = Stage::begin(&SCREEN, "opinion");
            let (v, second) = opinion::ask(&job, &part, &text, v);
            stage.end();
            (v, Some(second))
        }
        false => (v, None),
    };
    if let Some(path) = options.ply {
        output::write(path, &ply::bytes(&job, &part, &read.motions.motions, v.summary.spacing_mm)?)?;
    }
    if let (Some(path), Some(stock)) = (options.blocks, &v.stock) {
        output::write(path, stock.csv().as_bytes())?;
    }
    data(options, (&v, &part), &read.motions)?;
    let joints = read.motions.joints.as_ref().map(JointFigures::of);
    answered((&v, wall_s), second, joints, json)
}

/// The verdict on the programs of a list of operations.
fn of_list(files: &[PathBuf], list: Operations, options: &Options<'_>, json: bool) -> Outcome {
    let refused = [("--second-opinion", options.second_opinion), ("--ply", options.ply.is_some())];
    if let Some((name, _)) = refused.iter().find(|r| r.1) {
        let text = format!("{name} is for programs of one tool; this job is a list of operations");
        return Err(Failure::file(list.path(), text));
    }
    if options.blocks.is_some() && list.whole().stock().is_none() {
        let text = "--blocks tells what blocks take from raw material: give a [stock]";
        return Err(Failure::file(list.path(), text));
    }
    let texts = files.iter().map(|f| read_text(f)).collect::<Result<Vec<_>, _>>()?;
    let (part, list) = operations::part(list, &SCREEN)?;
    let given: Vec<Text<'_>> = files.iter().zip(&texts).map(|(file, text)| Text { file, text }).collect();
    let stage = Stage::begin(&SCREEN, "verify");
    let (v, motions) = operations::verify(&part, &list, &given, options.lenient, &|f| stage.at(f))?;
    let wall_s = stage.end();
    if let (Some(path), Some(stock)) = (options.blocks, &v.stock) {
        output::write(path, stock.csv().as_bytes())?;
    }
    data(options, (&v, &part), &motions)?;
    answered((&v, wall_s), None, None, json)
}

/// Writes what was measured and the tool's way, where that is asked for.
fn data(options: &Options<'_>, of: (&Verified, &Part), motions: &Motions) -> Result<(), Failure> {
    let Some(folder) = options.data else { return Ok(()) };
    let files = measured_data::files(of, (&motions.motions, &motions.times_min));
    let all: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    output::set(folder, &all)
}

/// What was found, as data or for a person.
fn answered(
    (v, wall_s): (&Verified, f64),
    second: Option<SecondOpinion>,
    joints: Option<JointFigures>,
    json: bool,
) -> Outcome {
    if json {
        render::json(&Answer {
            verification: v.summary.clone(),
            verdict: VerdictKeys::of(&v.verdict),
            second_opinion: second,
            worst: v.worst.clone(),
            confidence: v.summary.confidence(),
            histogram: v.histogram.clone(),
            joints,
            stock: v.stock.clone(),
            diagnostics: v.diagnostics.iter().map(ToString::to_string).collect(),
        })?;
    } else {
        render::text(&told(v, wall_s))?;
        render::text(&second.as_ref().map_or_else(String::new, opinion_text))?;
    }
    Ok(if v.verdict.is_held() { Done::Yes } else { Done::NotWithinTolerance })
}

/// A second opinion as its screen shows it.
fn opinion_text(s: &SecondOpinion) -> String {
    let Some(f) = &s.figures else { return format!("  {}\n\n", s.why) };
    let mut t = Table::new(["second opinion", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("left max", format!("{:.5}", f.left_max_mm), "mm");
    row("gouge max", format!("{:.5}", f.gouge_max_mm), "mm");
    row("rapid max", format!("{:.5}", f.rapid_max_mm), "mm");
    row("holder max", format!("{:.5}", f.holder_max_mm), "mm");
    row("off by at most", format!("{:.5}", f.slack_mm), "mm");
    row("frozen poses", f.poses.to_string(), "");
    row("points", f.points.to_string(), "");
    row("points apart", number(f.points_apart_mm, 3), "mm");
    row("wall time", format!("{:.2}", f.wall_s), "s");
    let words = if s.why.is_empty() { "it agrees with the verification" } else { s.why.as_str() };
    format!("{}\n  {words}\n\n", t.render())
}

/// A verification as its screen shows it.
fn told(v: &Verified, wall_s: f64) -> String {
    let mut text = format!(
        "\n{}\n{}\n  {}\n  wall time {wall_s:.2} s\n\n{}",
        figures(&v.summary),
        v.verdict,
        v.summary.confidence(),
        histogram_text(&v.histogram)
    );
    if !v.worst.is_empty() {
        let mut t = Table::new(["worst", "mm", "x", "y", "z", "face", "made by"]);
        for w in &v.worst {
            let [x, y, z] = w.at_mm.map(|c| format!("{c:.3}"));
            t.row([w.kind.clone(), number(w.value_mm, 4), x, y, z, w.face.clone(), w.made_by()]);
        }
        text += &format!("\n{}", t.render());
    }
    if let Some(s) = &v.stock {
        text += &format!("\n{}", stock_text(s));
    }
    if !v.diagnostics.is_empty() {
        text += &format!("\n{}", words::findings(&v.diagnostics));
    }
    text + "\n"
}

/// The figures of a verification as a table, the same for all verbs.
pub fn figures(s: &Verification) -> String {
    let mut t = Table::new([
        if s.source == "nc" { "verified from the NC text" } else { "verified from CL data" },
        "",
        "unit",
    ]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("samples", s.samples.to_string(), "");
    row("of them where limits were near", s.added_samples.to_string(), "");
    row("spacing", number(s.spacing_mm, 4), "mm");
    row("scallop max", format!("{:.5}", s.scallop_max_mm), "mm");
    row("scallop p99", format!("{:.5}", s.scallop_p99_mm), "mm");
    row("scallop median", format!("{:.5}", s.scallop_median_mm), "mm");
    row("median of its crests", format!("{:.5}", s.crest_median_mm), "mm");
    if let Some(mark) = s.tooth_mark_max_mm {
        row("tooth mark max", format!("{mark:.5}"), "mm");
        row("scallop and mark max", format!("{:.5}", s.height_max_mm), "mm");
    }
    row("gouge max", format!("{:.5}", s.gouge_max_mm), "mm");
    let hidden = |x: Option<f64>| x.map_or_else(|| "not bounded".to_owned(), |x| format!("{x:.5}"));
    row("scallop that may hide", hidden(s.hidden_scallop_mm), "mm");
    row("gouge that may hide", hidden(s.hidden_gouge_mm), "mm");
    row("uncut area", format!("{:.3}", s.uncut_area_mm2), "mm2");
    t.render()
}

/// Bins put together for a table.
const TOGETHER: usize = 4;

/// The histogram, bins without area left out.
fn histogram_text(bins: &[HistogramBin]) -> String {
    let whole: f64 = bins.iter().map(|b| b.area_mm2).sum();
    let mut t = Table::new(["standoff from mm", "to mm", "mm2", "%"]);
    let (Some((first, rest)), true) = (bins.split_first(), whole > 0.0) else { return String::new() };
    // The two at the ends have no end and stay alone.
    let inner = rest.len().saturating_sub(1);
    let groups = std::iter::once(std::slice::from_ref(first))
        .chain(rest[..inner].chunks(TOGETHER))
        .chain(rest.chunks(1).skip(inner));
    for g in groups {
        let area: f64 = g.iter().map(|b| b.area_mm2).sum();
        let end = |x: Option<f64>, word: &str| x.map_or_else(|| word.to_owned(), |x| format!("{x:.4}"));
        if let (true, Some(a), Some(b)) = (area > 0.0, g.first(), g.last()) {
            t.row([
                end(a.from_mm, "below"),
                end(b.to_mm, "above"),
                format!("{area:.2}"),
                format!("{:.2}", 100.0 * area / whole),
            ]);
        }
    }
    t.render()
}

fn stock_text(s: &StockSummary) -> String {
    let mut t = Table::new(["stock", "", "unit"]);
    let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
    row("cell", number(s.cell_mm, 4), "mm");
    row("volume", format!("{:.1}", s.volume_mm3), "mm3");
    row("removed", format!("{:.1}", s.removed_mm3), "mm3");
    row("left", format!("{:.1} (spread {:.1})", s.left_mm3, s.spread_mm3), "mm3");
    row("collisions", s.collisions.len().to_string(), "");
    let mut out = t.render();
    if !s.most.is_empty() {
        let mut t = Table::new(["block", "mm3", "chip mm2", "engaged deg", "up to mm"]);
        for b in &s.most {
            t.row([
                b.block.to_string(),
                format!("{:.2}", b.volume_mm3),
                number(b.section_mm2, 3),
                format!("{:.0}", b.engaged_deg),
                number(b.height_mm, 3),
            ]);
        }
        out += &format!("\n{}", t.render());
    }
    if !s.collisions.is_empty() {
        let mut t = Table::new(["collision", "block", "operation", "mm deep", "x", "y", "z"]);
        for c in s.collisions.iter().take(10) {
            let body = if c.rapid { format!("{} in rapid", c.body) } else { c.body.to_owned() };
            let at = c.at_mm.map(|x| format!("{x:.3}"));
            t.row([
                body,
                c.block.to_string(),
                c.made_by(),
                number(c.deepest_mm, 3),
                at[0].clone(),
                at[1].clone(),
                at[2].clone(),
            ]);
        }
        out += &format!("\n{}", t.render());
    }
    out
}
