//! Exact strips a second, for each kind of cutter, on one thread: `cargo run --release -p osculate-tools --example strip_bench`.
#![allow(clippy::print_stdout)]

use osculate_geom::analytic::Torus;
use osculate_geom::{Axis, Flipped, uv};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
use std::time::Instant;

/// Contacts timed for each cutter.
const CONTACTS: u32 = 2000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let groove = Flipped(Torus::new(200.0, 90.0)?);
    let length_mm = 60.0;
    let cutters = [
        ("ball D12", CutterSpec::Ball { diameter_mm: 12.0, length_mm }),
        ("flat D20", CutterSpec::Flat { diameter_mm: 20.0, length_mm }),
        ("toroidal D20 r2", CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm }),
    ];
    println!("{:>16}  {:>10}  {:>12}", "cutter", "strips/s", "mean width mm");
    for (name, spec) in cutters {
        let cutter = Cutter::try_from(spec)?;
        let start = Instant::now();
        let mut sum = 0.0;
        for k in 0..CONTACTS {
            let at = uv(0.0, 2.6 + 1.0 * f64::from(k) / f64::from(CONTACTS));
            let lean = Lean { lead_rad: 0.2, tilt_rad: 0.1 };
            let contact = Contact::new(&groove, at, &cutter, FeedLine::Iso(Axis::U), lean)?;
            sum += strip::exact(&contact, 0.01)?.width_mm;
        }
        let rate = f64::from(CONTACTS) / start.elapsed().as_secs_f64();
        println!("{name:>16}  {rate:>10.0}  {:>12.6}", sum / f64::from(CONTACTS));
    }
    Ok(())
}
