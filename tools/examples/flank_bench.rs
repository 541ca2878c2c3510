//! Times of flank positions: three tangencies, static deviation and static minimax, on formulas and on a NURBS patch.

// An example of developers talks to its terminal; the ban on printing is for the libraries.
#![allow(clippy::print_stdout)]

use osculate_geom::{Axis, Side};
use osculate_surfaces::gallery::{LiuSize, d98_liu, eq18_directrices, liu_directrices};
use osculate_tools::flank::{RuledStrip, Setting, SideTool, Stations, place, three_tangent};
use std::error::Error;
use std::time::Instant;

/// Best of several runs over all the rules, microseconds a rule.
fn best(rules: &[f64], mut f: impl FnMut(f64) -> bool) -> (f64, usize) {
    let mut best = (f64::INFINITY, 0);
    for _ in 0..9 {
        let start = Instant::now();
        let done = rules.iter().filter(|u| f(**u)).count();
        let each = start.elapsed().as_secs_f64() * 1e6 / rules.len() as f64;
        if each < best.0 {
            best = (each, done);
        }
    }
    best
}

fn main() -> Result<(), Box<dyn Error>> {
    let tool = SideTool::cylinder(10.0)?;
    let [a, b] = liu_directrices(LiuSize::default());
    let liu = RuledStrip::new(a, b, Side::Along, 1e-6)?;
    let patch = d98_liu();
    let nurbs = RuledStrip::between_borders(&patch, Axis::U, 1e-6)?;
    let [a, b] = eq18_directrices();
    let eq18 = RuledStrip::new(a, b, Side::Along, 1e-6)?;
    println!("{:<24} {:>14} {:>18} {:>14}", "us a rule", "three tangent", "deviation (33 v)", "minimax");
    for (name, strip, lo, hi) in [
        ("Liu, formula", &liu, 2.0, 21.0),
        ("Liu, NURBS patch", &nurbs, 2.0, 21.0),
        ("(18)", &eq18, 0.1, 0.9),
    ] {
        let rules: Vec<f64> = (0..200).map(|k| lo + (hi - lo) * f64::from(k) / 199.0).collect();
        let stations = Stations::new(strip, 48);
        let three = best(&rules, |u| three_tangent(strip, u, tool).is_ok());
        let placed: Vec<_> = rules
            .iter()
            .filter_map(|u| place(strip, &stations, *u, tool, Setting::ThreeTangent).ok())
            .collect();
        let mut next = 0;
        let deviation = best(&rules, |_| {
            let p = &placed[next % placed.len()];
            next += 1;
            p.profile(strip, &stations, &tool, 33).max_abs_mm().is_finite()
        });
        let few: Vec<f64> = rules.iter().step_by(20).copied().collect();
        let minimax = best(&few, |u| place(strip, &stations, u, tool, Setting::Minimax).is_ok());
        println!(
            "{name:<24} {:>8.2} ({:>3}) {:>18.1} {:>8.0} ({:>2}/{})",
            three.0,
            three.1,
            deviation.0,
            minimax.0,
            minimax.1,
            few.len()
        );
    }
    Ok(())
}
