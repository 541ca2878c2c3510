//! Which faces of a file are ruled, within a tolerance, and along what: `ruling FILE [TOLERANCE_MM]`.
//!
//! A face is looked at over the rectangle that its trims fill.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use osculate_geom::{Domain, Interval, Patch, Side, Surface};
use osculate_surfaces::{Face, Ruling, RulingOptions, read, ruled_bands, ruling};
use std::error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match run(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("ruling: {why}");
            ExitCode::FAILURE
        }
    }
}

/// The rectangle around the trims.
fn filled(face: &Face) -> Option<Domain> {
    let turns = face.surface.turns();
    let range = |f: &dyn Fn(usize) -> f64| {
        let (lo, hi) = (0..turns.len())
            .map(f)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
        (hi > lo).then(|| Interval::new(lo, hi))
    };
    Some(Domain { u: range(&|k| turns[k].u)?, v: range(&|k| turns[k].v)? })
}

fn run(words: &[String]) -> Result<(), Box<dyn Error>> {
    let path = words.first().ok_or("usage: ruling FILE [TOLERANCE_MM]")?;
    let tolerance_mm = words.get(1).map_or(Ok(0.01), |w| w.parse())?;
    let part = read(&std::fs::read(path)?)?;
    let how = RulingOptions { tolerance_mm, ..RulingOptions::default() };
    let mut counts = [0usize; 3];
    for face in &part.faces {
        let Some(domain) = filled(face) else {
            println!("{:<6} {:?}: no rectangle around its trims", face.id, face.kind);
            continue;
        };
        let patch = Patch { surface: face.surface.clone(), domain, side: Side::Along };
        let (kind, what) = match ruling(&patch, &how) {
            Ok(Ruling::Straight { along, error_mm }) => {
                (0, format!("ruled, directrices along {along:?}, to {error_mm:.1e} mm"))
            }
            Ok(Ruling::Found(band)) => {
                (1, format!("ruled within {:.4} mm, directrices along {:?}", band.error_mm, band.band.along))
            }
            Ok(Ruling::NotRuled(band)) => {
                let bands = ruled_bands(&patch, band.band.along, &how);
                let words = match bands {
                    Ok(all) => format!("{} bands within the tolerance", all.len()),
                    Err(why) => why.to_string(),
                };
                (
                    2,
                    format!(
                        "not ruled: {:.4} mm at best, directrices along {:?}; {words}",
                        band.error_mm, band.band.along
                    ),
                )
            }
            Err(why) => (2, why.to_string()),
        };
        counts[kind] += 1;
        println!("{:<6} {:?}: {what}", face.id, face.kind);
    }
    let [straight, found, not] = counts;
    println!("{straight} with straight parameter lines, {found} ruled within {tolerance_mm} mm, {not} not");
    Ok(())
}
