//! The optimum at random places of three real faces against a brute-force scan of direction, lead and tilt, and the searches
//! a second: `cargo run --release -p osculate-productivity --example optimum_bench -- [PLACES [speed|scan [FILE]]]` from the repository's root;
//! `speed` leaves the scan out, FILE is a part of the only file wanted.
#![allow(clippy::print_stdout)]

use osculate_geom::{Surface, Uv};
use osculate_productivity::optimum::{self, Limits, Optimum, OptimumError, Posture, Range};
use osculate_productivity::rate::Caps;
use osculate_surfaces::{Part, read};
use osculate_tools::{Cutter, CutterSpec, Lean};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::time::Instant;

/// Scan of directions, leads and tilts.
const SCAN: [usize; 3] = [24, 7, 3];
/// Misses that are shown.
const SHOWN: f64 = 0.003;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let places: usize = std::env::args().nth(1).map_or(Ok(1000), |a| a.parse())?;
    let length_mm = 40.0;
    let caps = Caps { spindle_rpm: 12_000.0, teeth: 2, feed_mm_min: 3000.0, feed_per_tooth_mm: 0.1 };
    let lead = Range { least_rad: 3f64.to_radians(), most_rad: 40f64.to_radians() };
    let tilt = Range { least_rad: -0.4, most_rad: 0.4 };
    println!(
        "{:>24}  {:>16}  {:>6}  {:>9}  {:>11}  {:>11}  {:>9}  {:>13}",
        "face", "tool", "places", "none", "worst miss %", "mean gain %", "per s", "per CPU second"
    );
    for (file, face, diameter_mm, corner_radius_mm) in [
        ("examples/eee-hpt-rotor2/blade.igs", "F1", 3.0, 0.5),
        ("examples/propeller/propeller.step", "F7", 6.0, 1.0),
        ("examples/wigley-hull/hull.step", "F1", 40.0, 6.0),
    ] {
        if std::env::args().nth(3).is_some_and(|wanted| !file.contains(&wanted)) {
            continue;
        }
        let part: Part = read(&std::fs::read(file)?)?;
        let face = part.face(face).ok_or("no such face")?;
        let cutter = [Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm })?];
        let limits = Limits { scallop_mm: 0.01, gouge_mm: 0.002, lead, tilt, axis: None, caps };
        let at = inside(face, places);
        let (start, used) = (Instant::now(), cpu_s());
        let best: Vec<Result<Optimum, OptimumError>> =
            at.par_iter().map(|p| optimum::at(face, *p, &cutter, &limits)).collect();
        let rate = at.len() as f64 / start.elapsed().as_secs_f64();
        let by_cpu = at.len() as f64 / (cpu_s() - used).max(1e-9);
        let exact = best.iter().flatten().map(|b| b.exact).sum::<u32>() / at.len() as u32;
        let scanning = std::env::args().nth(2).as_deref() != Some("speed");
        let results: Vec<Option<([f64; 2], Posture)>> = at
            .par_iter()
            .zip(&best)
            .map(|(p, b)| {
                let own = b.as_ref().ok()?.rate.area_mm2_min;
                if !scanning {
                    return Some(([f64::NAN; 2], plain()));
                }
                let (scanned, posture, first) = scan(face, *p, &cutter[0], &limits);
                Some(([scanned / own - 1.0, own / first - 1.0], posture))
            })
            .collect();
        let none = results.iter().filter(|r| r.is_none()).count();
        let worst = results.iter().flatten().map(|r| r.0[0]).fold(f64::NEG_INFINITY, f64::max);
        let mut misses: Vec<f64> = results.iter().flatten().map(|r| r.0[0]).collect();
        misses.sort_by(f64::total_cmp);
        let over = misses.iter().filter(|m| **m > 0.005).count();
        let gain: Vec<f64> = results.iter().flatten().map(|r| r.0[1]).filter(|g| g.is_finite()).collect();
        println!(
            "{:>24}  {:>16}  {:>6}  {none:>9}  {:>11.3}  {:>11.1}  {rate:>9.0}  {by_cpu:>13.0}   over 0.5 %: {over}, evaluations {} ({exact} exact)",
            file.rsplit('/').next().unwrap_or(file),
            format!("D{diameter_mm} r{corner_radius_mm}"),
            at.len(),
            100.0 * worst,
            100.0 * gain.iter().sum::<f64>() / gain.len().max(1) as f64,
            best.iter().flatten().map(|b| b.evaluations).sum::<u32>() / at.len() as u32,
        );
        // The worst ones, where the scan is better.
        let mut missed: Vec<(f64, usize)> = results
            .iter()
            .enumerate()
            .filter_map(|(k, r)| r.map(|r| (r.0[0], k)))
            .filter(|(miss, _)| *miss > SHOWN)
            .collect();
        missed.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (miss, k) in missed.into_iter().take(6) {
            let posture = results[k].map(|r| r.1);
            println!("    {:?} {:.4} %: {posture:?} beats {:?}", at[k], 100.0 * miss, best[k]);
        }
    }
    Ok(())
}

/// Processor time of this process, s: under load more telling than the clock. Zero where the system does not say.
fn cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(") ").next().unwrap_or_default();
    let ticks: f64 = after.split(' ').skip(11).take(2).filter_map(|t| t.parse::<f64>().ok()).sum();
    ticks / 100.0
}

/// Places inside a face, evenly strewn.
fn inside(face: &dyn Surface, count: usize) -> Vec<Uv> {
    let part = |k: usize, step: f64| 0.01 + 0.98 * (0.5 + k as f64 * step).fract();
    (0..100 * count)
        .map(|k| face.domain().at(part(k, 0.754_877_666_246_693), part(k, 0.569_840_290_998_053)))
        .filter(|p| face.contains(*p))
        .take(count)
        .collect()
}

/// Feed along u with 20 degrees of lead.
fn plain() -> Posture {
    Posture { direction_rad: 0.0, lean: Lean { lead_rad: 20f64.to_radians(), tilt_rad: 0.0 } }
}

/// The greatest productivity of the scan, with its posture, and that of the plain posture.
fn scan(face: &dyn Surface, at: Uv, cutter: &Cutter, limits: &Limits) -> (f64, Posture, f64) {
    let step =
        |r: Range, k: usize, n: usize| r.least_rad + (r.most_rad - r.least_rad) * k as f64 / (n - 1) as f64;
    let value = |posture: Posture| {
        optimum::measure(face, at, cutter, posture, limits).map_or(0.0, |m| m.rate.area_mm2_min)
    };
    let mut best = (0.0, plain());
    for i in 0..SCAN[0] {
        for j in 0..SCAN[1] {
            for k in 0..SCAN[2] {
                let lean =
                    Lean { lead_rad: step(limits.lead, j, SCAN[1]), tilt_rad: step(limits.tilt, k, SCAN[2]) };
                let posture = Posture { direction_rad: TAU * i as f64 / SCAN[0] as f64, lean };
                let own = value(posture);
                if own > best.0 {
                    best = (own, posture);
                }
            }
        }
    }
    (best.0, best.1, value(plain()))
}
