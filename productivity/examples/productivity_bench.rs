//! Closed forms, exact strips and optimum searches a second:
//! `cargo run --release -p osculate-productivity --example productivity_bench` from the repository's root.
#![allow(clippy::print_stdout)]

use osculate_geom::{Surface, Uv};
use osculate_productivity::closed_form::{Section, Sections, width_37};
use osculate_productivity::optimum::{self, Limits, Range};
use osculate_productivity::rate::Caps;
use osculate_surfaces::read;
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
use rayon::prelude::*;
use std::time::Instant;

/// Closed forms timed.
const SECTIONS: usize = 4_000_000;
/// Places for strips and searches.
const PLACES: usize = 300;
/// Turns; the best counts.
const TURNS: usize = 5;

/// Processor time of this process, s; zero where the system does not say.
fn cpu_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit(") ").next().unwrap_or_default();
    let ticks: f64 = after.split(' ').skip(11).take(2).filter_map(|t| t.parse::<f64>().ok()).sum();
    ticks / 100.0
}

/// Best of several turns: calls a second by the clock, and by processor time.
fn timed(count: usize, mut f: impl FnMut()) -> [f64; 2] {
    let mut best = [f64::INFINITY; 2];
    for _ in 0..TURNS {
        let (start, used) = (Instant::now(), cpu_s());
        f();
        best[0] = best[0].min(start.elapsed().as_secs_f64());
        best[1] = best[1].min((cpu_s() - used).max(0.005));
    }
    best.map(|s| count as f64 / s)
}

fn line(what: &str, [wall, cpu]: [f64; 2]) {
    println!("{what:<58} {wall:>14.0} {cpu:>18.0}");
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{:<58} {:>14} {:>18}", "", "a second", "a processor second");
    let spread = |k: usize, step: f64| (0.5 + k as f64 * step).fract();
    let kp: Vec<f64> = (0..SECTIONS).map(|k| -0.04 + 0.1 * spread(k, 0.754_877_666_246_693)).collect();
    let kt: Vec<f64> = (0..SECTIONS).map(|k| 0.05 + 0.4 * spread(k, 0.569_840_290_998_053)).collect();
    let h: Vec<f64> = (0..SECTIONS).map(|k| 1e-3 + 0.05 * spread(k, 0.618_033_988_749_894)).collect();
    let all = Sections { part_per_mm: &kp, tool_per_mm: &kt, scallop_mm: &h };
    let mut out = vec![0.0; SECTIONS];
    let single = timed(SECTIONS, || {
        for (k, o) in out.iter_mut().enumerate() {
            let s = Section { part_per_mm: kp[k], tool_per_mm: kt[k], scallop_mm: h[k] };
            *o = width_37(s).unwrap_or(f64::NAN);
        }
    });
    line("closed form (37), single calls, one thread", single);
    let mut wrong = 0;
    line(
        "closed form (37), batch, one thread",
        timed(SECTIONS, || wrong += usize::from(all.widths_37(&mut out).is_err())),
    );
    line(
        "closed form (37), batch, all threads",
        timed(SECTIONS, || wrong += usize::from(all.widths_37_parallel(&mut out).is_err())),
    );
    assert!(wrong == 0 && out.iter().all(|x| x.is_finite()));
    let caps = Caps { spindle_rpm: 12_000.0, teeth: 2, feed_mm_min: 3000.0, feed_per_tooth_mm: 0.1 };
    let limits = Limits {
        scallop_mm: 0.01,
        gouge_mm: 0.002,
        lead: Range { least_rad: 3f64.to_radians(), most_rad: 40f64.to_radians() },
        tilt: Range { least_rad: -0.4, most_rad: 0.4 },
        axis: None,
        caps,
    };
    for (file, face, diameter_mm, corner_radius_mm) in [
        ("examples/eee-hpt-rotor2/blade.igs", "F1", 3.0, 0.5),
        ("examples/propeller/propeller.step", "F7", 6.0, 1.0),
        ("examples/wigley-hull/hull.step", "F1", 40.0, 6.0),
    ] {
        let part = read(&std::fs::read(file)?)?;
        let face = part.face(face).ok_or("no such face")?;
        let cutter =
            [Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 80.0 })?];
        let at: Vec<Uv> = (0..100 * PLACES)
            .map(|k| {
                let part = |step: f64| 0.01 + 0.98 * spread(k, step);
                face.domain().at(part(0.754_877_666_246_693), part(0.569_840_290_998_053))
            })
            .filter(|p| face.contains(*p))
            .take(PLACES)
            .collect();
        let lean = Lean { lead_rad: 0.35, tilt_rad: 0.1 };
        let short = file.rsplit('/').next().unwrap_or(file);
        let strips = timed(8 * at.len(), || {
            let widths: f64 = (0..8 * at.len())
                .into_par_iter()
                .map(|k| {
                    let feed = FeedLine::Angle(k as f64);
                    let contact = Contact::new(face, at[k / 8], &cutter[0], feed, lean);
                    contact
                        .map_err(Into::into)
                        .and_then(|c| strip::exact(&c, 0.01))
                        .map_or(0.0, |s| s.width_mm)
                })
                .sum();
            wrong += usize::from(widths.is_nan() || widths <= 0.0);
        });
        line(&format!("exact strips, {short}, all threads"), strips);
        let searches = timed(at.len(), || {
            let found = at.par_iter().filter(|p| optimum::at(face, **p, &cutter, &limits).is_ok()).count();
            wrong += usize::from(found == 0);
        });
        line(&format!("optimum searches, {short}, all threads"), searches);
    }
    assert_eq!(wrong, 0);
    Ok(())
}
