//! Reads every STEP and IGES file of a reference collection and compares the parts with another kernel's answers.
//!
//! `cargo run --release -p osculate-surfaces --example truth -- --data FOLDER [--only TEXT] [--json] [--all]`
//!
//! FOLDER holds `manifest.json`, `files/` and `truth/` (schema `cam-truth/1`: faces with kind, area and box, and 25
//! samples on spline faces). A file agrees where everything that the reference states is met; the tolerances stand
//! in `compare.rs`. Files that differ for a reason found out stand in `explained.rs` and are counted apart. `--only` keeps
//! the files whose name has the text, `--all` prints every difference instead of the first three, `--malformed` adds the
//! damaged files, of which `malformed.rs` says what has to be said.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod compare;
mod explained;
mod malformed;
mod reference;

use compare::Difference;
use explained::explained;
use osculate_surfaces::{ImportError, Part};
use rayon::prelude::*;
use reference::{Entry, Reference};
use serde_json::json;
use std::collections::BTreeMap;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// What is asked for on the command line.
struct Asked {
    data: PathBuf,
    only: Option<String>,
    json: bool,
    all: bool,
    malformed: bool,
}

/// What came of one file.
struct Outcome {
    file: String,
    read_s: f64,
    compare_s: f64,
    faces: usize,
    reference: String,
    differences: Vec<Difference>,
}

/// Reading a damaged file longer than this is a hang.
const LIMIT_S: f64 = 2.0;

/// Where the damaged files are.
const DAMAGED: &str = "malformed/";

fn main() -> ExitCode {
    let asked = match arguments() {
        Ok(asked) => asked,
        Err(why) => {
            eprintln!("truth: {why}");
            return ExitCode::from(2);
        }
    };
    let entries = match reference::entries(&asked.data, asked.malformed) {
        Ok(entries) => entries,
        Err(why) => {
            eprintln!("truth: {why}");
            return ExitCode::FAILURE;
        }
    };
    let kept: Vec<Entry> =
        entries.into_iter().filter(|e| asked.only.as_ref().is_none_or(|t| e.file.contains(t))).collect();
    // A panic is counted like any other difference.
    std::panic::set_hook(Box::new(|_| {}));
    let outcomes: Vec<Outcome> = kept.par_iter().map(|e| examine(&asked.data, e)).collect();
    if asked.json {
        println!("{:#}", summary(&outcomes));
    } else {
        print(&outcomes, asked.all);
    }
    ExitCode::SUCCESS
}

fn arguments() -> Result<Asked, String> {
    let mut asked = Asked { data: PathBuf::new(), only: None, json: false, all: false, malformed: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--data" => asked.data = words.next().ok_or("--data needs a folder")?.into(),
            "--only" => asked.only = Some(words.next().ok_or("--only needs a text")?),
            "--json" => asked.json = true,
            "--all" => asked.all = true,
            "--malformed" => asked.malformed = true,
            other => return Err(format!("unknown argument {other}")),
        }
    }
    if asked.data.as_os_str().is_empty() {
        return Err("say where the reference collection is: --data FOLDER".into());
    }
    Ok(asked)
}

/// Reads a file and compares it.
fn examine(data: &Path, entry: &Entry) -> Outcome {
    let start = Instant::now();
    let bytes = std::fs::read(data.join("files").join(&entry.file)).unwrap_or_default();
    let mut read_s = 0.0;
    let mut faces = 0;
    let result = catch_unwind(|| {
        let begin = Instant::now();
        let part: Result<Part, ImportError> = osculate_surfaces::read(&bytes);
        let read_s = begin.elapsed().as_secs_f64();
        let faces = part.as_ref().map_or(0, |p| p.faces.len());
        let mut differences = compare::differences(&entry.reference, &part);
        let message = entry.file.strip_prefix(DAMAGED).and_then(|name| malformed::missing(name, &part));
        differences.extend(message.map(|wanted| Difference::Message { wanted }));
        (read_s, faces, differences)
    });
    let mut differences = match result {
        Ok((s, n, d)) => {
            (read_s, faces) = (s, n);
            d
        }
        Err(panic) => {
            let said = panic.downcast_ref::<String>().cloned();
            let said = said.or_else(|| panic.downcast_ref::<&str>().map(|s| (*s).to_owned()));
            vec![Difference::Panic { said: said.unwrap_or_default() }]
        }
    };
    if entry.file.starts_with(DAMAGED) && read_s > LIMIT_S {
        differences.push(Difference::Slow { wall_s: read_s });
    }
    let compare_s = start.elapsed().as_secs_f64() - read_s;
    let reference = match &entry.reference {
        Reference::Shape(s) => format!("{} faces", s.faces.len()),
        Reference::Without(status) => status.clone(),
    };
    Outcome { file: entry.file.clone(), read_s, compare_s, faces, reference, differences }
}

/// Counts of reasons: in how many files each occurs, and how often.
fn by_reason(outcomes: &[Outcome]) -> BTreeMap<&'static str, (usize, usize)> {
    let mut reasons: BTreeMap<&'static str, (usize, usize)> = BTreeMap::new();
    for o in outcomes {
        let mut seen = Vec::new();
        for d in &o.differences {
            let entry = reasons.entry(d.reason()).or_default();
            entry.1 += 1;
            if !seen.contains(&d.reason()) {
                seen.push(d.reason());
                entry.0 += 1;
            }
        }
    }
    reasons
}

fn print(outcomes: &[Outcome], all: bool) {
    for o in outcomes {
        let why = explained(&o.file, &o.differences);
        let verdict = match (o.differences.is_empty(), why) {
            (true, _) => "agrees ",
            (false, Some(_)) => "differs",
            (false, None) => "DIFFERS",
        };
        println!(
            "{verdict} {:<58} {:>5} faces, reference {:<12} read {:.3} s, compared {:.2} s",
            o.file, o.faces, o.reference, o.read_s, o.compare_s
        );
        if let Some(why) = why {
            println!("          explained: {why}");
        }
        let shown = if all { o.differences.len() } else { 3 };
        for d in o.differences.iter().take(shown) {
            println!("          {d}");
        }
        if o.differences.len() > shown {
            println!("          and {} more", o.differences.len() - shown);
        }
    }
    println!("\nreason                           files  times");
    for (reason, (files, times)) in by_reason(outcomes) {
        println!("{reason:<32} {files:>5} {times:>6}");
    }
    let [agree, named, loose] = counts(outcomes);
    let read_s: f64 = outcomes.iter().map(|o| o.read_s).sum();
    println!(
        "\n{agree} of {} files agree: {:.1} %; {read_s:.2} s of reading in all",
        outcomes.len(),
        100.0 * agree as f64 / outcomes.len().max(1) as f64
    );
    println!(
        "{named} more differ for a reason that is named and where ours was found right; {} differ without; {loose} \
         agree where areas may differ by the 1e-4 that the collection's notes recommend",
        outcomes.len() - agree - named
    );
}

/// Files that agree; that differ with an explanation; that agree to the looser areas.
fn counts(outcomes: &[Outcome]) -> [usize; 3] {
    let count = |test: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|o| test(o)).count();
    [
        count(&|o| o.differences.is_empty()),
        count(&|o| explained(&o.file, &o.differences).is_some()),
        count(&|o| o.differences.iter().all(Difference::is_small_area)),
    ]
}

fn summary(outcomes: &[Outcome]) -> serde_json::Value {
    let files: Vec<_> = outcomes
        .iter()
        .map(|o| {
            json!({
                "file": o.file, "faces": o.faces, "reference": o.reference, "read_s": o.read_s,
                "agrees": o.differences.is_empty(), "explained": explained(&o.file, &o.differences),
                "differences": o.differences.iter().map(ToString::to_string).collect::<Vec<_>>(),
            })
        })
        .collect();
    let reasons: BTreeMap<_, _> = by_reason(outcomes)
        .into_iter()
        .map(|(reason, (files, times))| (reason, json!({"files": files, "times": times})))
        .collect();
    let [agree, named, loose] = counts(outcomes);
    json!({
        "files": files, "reasons": reasons, "agree": agree, "explained": named, "agree_areas_1e-4": loose,
        "of": outcomes.len(),
    })
}
