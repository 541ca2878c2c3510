//! Exact strips a second on a bicubic NURBS face of 10 x 10 poles, for each kind of cutter, on one thread and on all:
//! `cargo run --release -p osculate-tools --example strip_bench`.
#![allow(clippy::print_stdout)]

use osculate_geom::{Point3, uv};
use osculate_surfaces::{Net, NurbsSurface};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
use rayon::prelude::*;
use std::time::Instant;

/// Contacts timed for each cutter and kind of feed line.
const CONTACTS: usize = 4000;
/// Tolerance of the strips, mm.
const SCALLOP_MM: f64 = 0.01;
/// Poles each way.
const POLES: usize = 10;

/// A face of 100 x 100 mm with hills and hollows of 60 mm radius and more.
fn face() -> Result<NurbsSurface, Box<dyn std::error::Error>> {
    let at = |k: usize| 100.0 * k as f64 / (POLES - 1) as f64;
    let height = |x: f64, y: f64| 4.0 * (x / 22.0).sin() * (y / 19.0).cos() + 0.002 * (x - 50.0) * (y - 50.0);
    let poles = (0..POLES * POLES)
        .map(|k| {
            let (x, y) = (at(k / POLES), at(k % POLES));
            Point3::new(x, y, height(x, y))
        })
        .collect();
    let inner = POLES - 4;
    let knots: Vec<f64> =
        (0..POLES + 4).map(|k| k.saturating_sub(3).min(inner + 1) as f64 / (inner + 1) as f64).collect();
    Ok(NurbsSurface::new(
        [3, 3],
        [knots.clone(), knots],
        Net { count: [POLES, POLES], points: poles, weights: None },
    )?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let face = face()?;
    let length_mm = 60.0;
    let cutters = [
        ("ball D12", CutterSpec::Ball { diameter_mm: 12.0, length_mm }),
        ("flat D12", CutterSpec::Flat { diameter_mm: 12.0, length_mm }),
        ("toroidal D12 r2", CutterSpec::Toroidal { diameter_mm: 12.0, corner_radius_mm: 2.0, length_mm }),
    ];
    println!(
        "{:>16}  {:>9}  {:>12}  {:>12}  {:>13}  {:>10}",
        "cutter", "feed", "strips/s, 1", "strips/s all", "mean width mm", "max error"
    );
    for (name, spec) in cutters {
        let cutter = Cutter::try_from(spec)?;
        for (line, iso) in [("iso", true), ("geodesic", false)] {
            let strip = |k: usize| -> Result<strip::Strip, strip::StripError> {
                let part = |step: f64| 0.02 + 0.96 * (0.5 + k as f64 * step).fract();
                let at = uv(part(0.754_877_666_246_693), part(0.569_840_290_998_053));
                let lean = Lean { lead_rad: 0.35, tilt_rad: 0.1 };
                let feed =
                    if iso { FeedLine::Iso(osculate_geom::Axis::U) } else { FeedLine::Angle(k as f64) };
                strip::exact(&Contact::new(&face, at, &cutter, feed, lean)?, SCALLOP_MM)
            };
            let start = Instant::now();
            let one: Vec<strip::Strip> = (0..CONTACTS).map(strip).collect::<Result<_, _>>()?;
            let single = CONTACTS as f64 / start.elapsed().as_secs_f64();
            let start = Instant::now();
            let all: Vec<strip::Strip> =
                (0..CONTACTS).into_par_iter().map(strip).collect::<Result<_, _>>()?;
            let both = CONTACTS as f64 / start.elapsed().as_secs_f64();
            assert_eq!(one, all, "the same strips for any number of threads");
            let mean = one.iter().map(|s| s.width_mm).sum::<f64>() / CONTACTS as f64;
            let error = one.iter().map(|s| s.error_mm).fold(0.0, f64::max);
            println!("{name:>16}  {line:>9}  {single:>12.0}  {both:>12.0}  {mean:>13.6}  {error:>10.1e}");
        }
    }
    Ok(())
}
