//! Times and values of the global flank optimum on D98's surfaces, beside the values known from other solvers.
#![allow(clippy::print_stdout)]

use osculate_geom::{Interval, Surface};
use osculate_surfaces::gallery;
use osculate_tools::flank::axes::AxisSurface;
use osculate_tools::flank::cutter_side::CutterSide;
use osculate_tools::flank::deviation::{Patch, deviation};
use osculate_tools::flank::envelope::Envelope;
use osculate_tools::flank::global::{Options, Task, optimise, starts};
use osculate_tools::{Cutter, CutterSpec};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let spans: usize = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(16);
    let liu = gallery::d98_liu();
    let half = gallery::d98_hyperbolic(80.0, 30f64.to_radians())?;
    let full = gallery::d98_hyperbolic(80.0, 60f64.to_radians())?;
    let whole = Interval::new(0.0, 23.014);
    let unit = Interval::new(0.0, 1.0);
    let middle = Interval::new(0.25, 0.75);
    let cases: [(&str, &dyn Surface, Interval, Interval, f64); 4] = [
        ("liu", &liu, whole, whole, 0.0995),
        ("paraboloid, twist 30", &half, unit, middle, 0.013_319_7),
        ("paraboloid, twist 60", &full, unit, middle, 0.013_319_7),
        ("(18)", &gallery::d98_eq18(), Interval::new(0.06, 0.96), Interval::new(0.2, 0.8), 0.374),
    ];
    let cutter = Cutter::try_from(CutterSpec::Cylindrical { diameter_mm: 20.0, length_mm: 200.0 })?;
    let side = CutterSide::of(&cutter, 0.0);
    for (name, surface, positions, u, known) in cases {
        let v = unit;
        let judged = Patch { u, v, count: [181, 21] };
        let task = Task { surface, side, positions, judged };
        let evaluated = |axes: &AxisSurface| {
            let begin = Instant::now();
            let d = deviation(
                &Envelope::new(side, std::slice::from_ref(axes)),
                surface,
                Patch { u, v, count: [361, 41] },
            );
            (d, begin.elapsed())
        };
        for s in starts(&task, 180)? {
            let (d, t) = evaluated(&s.axes);
            println!("{name}: share {} [{:.6}, {:.6}] {t:?}", s.share, d.min.value_mm, d.max.value_mm);
        }
        let begin = Instant::now();
        let f = optimise(&task, &Options { spans, ..Options::default() }, &[])?;
        let took = begin.elapsed();
        let (d, _) = evaluated(&f.axes);
        println!(
            "{name}: {:.7} (bound {:?} refined {:?}) whole patch [{:.7} at {:?}, {:.7} at {:?}], known {known}, {} iterations, converged {}, {took:?}",
            f.value_mm,
            f.bound_mm,
            f.bound_refined_mm,
            d.min.value_mm,
            d.min.at,
            d.max.value_mm,
            d.max.at,
            f.iterations,
            f.converged
        );
    }
    Ok(())
}
