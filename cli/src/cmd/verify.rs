//! `verify`: material removal of a CL file or an NC program against the part.

use crate::screen::output;
use crate::screen::progress::SCREEN;
use crate::screen::render;
use osculate::failure::{Done, Failure, Outcome, read_text};
use osculate::job::Job;
use osculate::part;
use osculate::watch::Stage;
use osculate::words;
use osculate::words::{Table, number};
use osculate::work::nc;
use osculate::work::ply;
use osculate::work::posted_setup;
use osculate::work::stock::{self, StockSummary};
use osculate::work::verify::{self, HistogramBin, Verification, WorstPlace};
use osculate_geom::{Box3, Diagnostic};
use osculate_postproc::cldata;
use osculate_tools::Cutter;
use osculate_tools::removal::Swept;
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    verification: Verification,
    worst: Vec<WorstPlace>,
    confidence: String,
    histogram: Vec<HistogramBin>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stock: Option<StockSummary>,
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

/// What the command line adds.
pub struct Options<'a> {
    /// Skip words that are not understood.
    pub lenient: bool,
    /// Where the surface as cut goes.
    pub ply: Option<&'a Path>,
    /// Where the blocks' engagement goes.
    pub blocks: Option<&'a Path>,
}

/// A feed above the job's by more than this is reported: rounding of F and of the path stays far below.
const FEED_EXCESS: f64 = 1.05;

/// Reports feed moves whose tip goes faster than the job says: the fastest, with its line.
fn feeds(job: &Job, read: &nc::Motions) -> Option<Diagnostic> {
    let wanted = job.feed_mm_min();
    let (mut fastest, mut line, mut fast) = (0.0, 0, 0usize);
    let mut before = 0.0;
    for (m, clock) in read.motions.iter().zip(&read.times_min) {
        let length = (m.to.tip - m.from.tip).norm();
        let time = clock - before;
        before = *clock;
        // Shorter moves say more about rounding than about feed.
        if m.rapid || time <= 0.0 || length < SHORT_MM {
            continue;
        }
        let feed = length / time;
        if feed > FEED_EXCESS * wanted {
            fast += 1;
        }
        if feed > fastest {
            (fastest, line) = (feed, m.block);
        }
    }
    (fast > 0).then(|| {
        let text = format!(
            "the tip moves faster than feed_mm_min = {wanted:.0} in {fast} moves, most in line {line}: {fastest:.0} mm/min"
        );
        Diagnostic::warning("feed", text)
    })
}

/// Moves that are too short to tell their feed, mm.
const SHORT_MM: f64 = 0.05;

/// Runs the verb.
pub fn run(file: &Path, job_path: &Path, options: &Options<'_>, json: bool) -> Outcome {
    let job = Job::load_with_one_tool(job_path)?;
    let faces = part::of_job(&job)?;
    let text = read_text(file)?;
    if options.blocks.is_some() && job.stock().is_none() {
        return Err(Failure::file(
            job_path,
            "--blocks tells what blocks take from raw material: give a [stock]",
        ));
    }
    let mut diagnostics: Vec<Diagnostic> = faces.part.diagnostics.clone();
    let (motions, source) = if is_cl(file, &text) {
        let cl = cldata::read(&text).map_err(|e| Failure::file(file, e))?;
        diagnostics.extend(cl.diagnostics);
        let own = job.cutter_spec();
        if let Some(other) = cl.path.cutter.filter(|c| Cutter::try_from(*c) != Cutter::try_from(own)) {
            let text =
                format!("the CL data is for another cutter: {other:?}; verified with the job's, {own:?}");
            diagnostics.push(Diagnostic::warning("tool", text));
        }
        (Swept::along(&cl.path), "cl")
    } else {
        let control = job.control();
        if !job.names_machine() {
            diagnostics.push(Diagnostic::warning(
                "machine",
                format!(
                    "the job has no [machine]: the program is read as {} for {}; give [machine] name or file, and dialect",
                    control.dialect_name,
                    control.machine.name()
                ),
            ));
        }
        let (setup, notes) = posted_setup::of_program(&job, &faces, &text, control.dialect);
        diagnostics.extend(notes);
        let read =
            nc::read_back(&text, control, &setup, options.lenient).map_err(|e| Failure::file(file, e))?;
        diagnostics.extend(feeds(&job, &read));
        diagnostics.extend(read.diagnostics);
        (read.motions, "nc")
    };
    if motions.is_empty() {
        return Err(Failure::file(file, "has no motion: at least two positions are needed"));
    }
    let strange = meet(file, &motions, &faces).map_err(|why| why.warned(&diagnostics))?;
    diagnostics.extend(strange);
    let stage = Stage::begin(&SCREEN, "verify");
    let v = verify::run(&job, &faces, &motions, source, None, &|f| stage.at(f))?;
    let wall = stage.end();
    diagnostics.extend(v.diagnostics.iter().cloned());
    let stage = Stage::begin(&SCREEN, "stock");
    let stock = stock::run(&job, &faces, &motions, &|f| stage.at(f))?;
    stage.end();
    let stock = stock.map(|(summary, notes)| {
        diagnostics.extend(notes);
        summary
    });
    if let Some(path) = options.ply {
        output::write(path, &ply::bytes(&job, &faces, &motions, v.summary.spacing_mm)?)?;
    }
    if let (Some(path), Some(stock)) = (options.blocks, &stock) {
        output::write(path, stock.csv().as_bytes())?;
    }
    let mut summary = v.summary.clone();
    if stock.as_ref().is_some_and(|s| !s.collisions.is_empty()) {
        summary.within_tolerance = false;
        summary.certain = false;
    }
    if json {
        render::json(&Answer {
            verification: summary.clone(),
            worst: v.worst.clone(),
            confidence: summary.confidence(),
            histogram: v.histogram.clone(),
            stock,
            diagnostics: diagnostics.iter().map(ToString::to_string).collect(),
        })?;
    } else {
        let s = &summary;
        let mut t = Table::new(["verified", "", "unit"]);
        let mut row = |k: &str, v: String, u: &str| t.row([k.into(), v, u.into()]);
        row("samples", s.samples.to_string(), "");
        row("of them where limits were near", s.added_samples.to_string(), "");
        row("spacing", number(s.spacing_mm, 4), "mm");
        row("scallop max", format!("{:.5}", s.scallop_max_mm), "mm");
        row("scallop p99", format!("{:.5}", s.scallop_p99_mm), "mm");
        row("gouge max", format!("{:.5}", s.gouge_max_mm), "mm");
        row("scallop that may hide", format!("{:.5}", s.hidden_scallop_mm), "mm");
        row("gouge that may hide", format!("{:.5}", s.hidden_gouge_mm), "mm");
        row(
            "smallest radius",
            s.smallest_radius_mm.map_or_else(|| "flat".to_owned(), |r| number(r, 4)),
            "mm",
        );
        row("uncut area", format!("{:.3}", s.uncut_area_mm2), "mm2");
        row("wall time", format!("{wall:.2}"), "s");
        render::text(&format!("\n{}\n  {}\n  {}\n", t.render(), s.words(), s.confidence()));
        render::text(&format!("\n{}", histogram_text(&v.histogram)));
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
        if let Some(s) = &stock {
            render::text(&format!("\n{}", stock_text(s)));
        }
        if !diagnostics.is_empty() {
            render::text(&format!("\n{}", words::findings(&diagnostics)));
        }
        render::text("\n");
    }
    Ok(if summary.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
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
        let mut t = Table::new(["collision", "block", "mm deep", "x", "y", "z"]);
        for c in s.collisions.iter().take(10) {
            let body = if c.rapid { format!("{} in rapid", c.body) } else { c.body.to_owned() };
            let at = c.at_mm.map(|x| format!("{x:.3}"));
            t.row([
                body,
                c.block.to_string(),
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

/// What unit a path may be in that meets the part only when scaled: a hint for the message.
fn unit_hint(path: &Box3, reach: &Box3) -> &'static str {
    const INCH: f64 = 25.4;
    let meets = |scale: f64| {
        (0..3).all(|k| path.min[k] * scale <= reach.max[k] && path.max[k] * scale >= reach.min[k])
    };
    if path.is_empty() {
        ""
    } else if meets(INCH) {
        "; taken as inches they would meet: does the program need G20 or UNITS/INCHES?"
    } else if meets(1.0 / INCH) {
        "; divided by 25.4 they would meet: is the part in inches, or the program in mm under G20?"
    } else {
        ""
    }
}

/// Feed moves that span more than this many times the part, or less than its share, are told.
const SPAN: f64 = 8.0;

/// Refuses a path that never comes near the part, a wrong unit or a wrong part zero, and tells one of another size.
fn meet(file: &Path, motions: &[Swept], faces: &part::JobFaces) -> Result<Option<Diagnostic>, Failure> {
    let mut path = Box3::empty();
    for m in motions.iter().filter(|m| !m.rapid) {
        path.add(&m.from.tip);
        path.add(&m.to.tip);
    }
    let whole = stock::around(faces);
    let reach = whole.grown(0.5 * whole.diagonal_mm());
    let apart = path.is_empty() || (0..3).any(|k| path.min[k] > reach.max[k] || path.max[k] < reach.min[k]);
    let part = stock::corners(&whole);
    if apart {
        let path_text = if path.is_empty() { "nothing".to_owned() } else { stock::corners(&path) };
        return Err(Failure::file(
            file,
            format!(
                "the feed moves lie in {path_text} mm, the part in {part} mm: they do not meet; is the unit right (inch \
                 against mm), or [setup] part_zero_mm?{}",
                unit_hint(&path, &reach)
            ),
        ));
    }
    let times = path.diagonal_mm() / whole.diagonal_mm();
    let strange = !(1.0 / SPAN..=SPAN).contains(&times);
    Ok(strange.then(|| {
        let text = format!(
            "the feed moves lie in {} mm, {times:.3} times the size of the part in {part} mm: is the unit right (inch against \
             mm)?",
            stock::corners(&path)
        );
        Diagnostic::warning("units", text)
    }))
}
