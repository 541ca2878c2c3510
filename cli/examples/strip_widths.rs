//! How wide a strip a toroidal cutter leaves in a groove over its lead, exact and by the curvatures alone, as CSV.
//!
//!     cargo run -p osculate --example strip_widths > widths.csv
#![allow(clippy::print_stdout)]

use osculate_geom::{Axis, Domain, Interval, Patch, Side, analytic::Torus, uv};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // The inner side of a ring is hollow across the groove and round along it.
    let domain = Domain { u: Interval::new(0.0, 0.35), v: Interval::new(2.6, 3.7) };
    let groove = Patch { surface: Torus::new(200.0, 60.0)?, domain, side: Side::Against };
    let tool =
        Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 })?;
    let scallop_mm = 0.01_f64;
    println!("lead_deg,exact_mm,by_curvature_mm");
    let mut widths = Vec::new();
    for lead_deg in (12..=40).step_by(2) {
        let lean = Lean { lead_rad: f64::from(lead_deg).to_radians(), tilt_rad: 0.0 };
        let contact = Contact::new(&groove, uv(0.17, 3.1), &tool, FeedLine::Iso(Axis::U), lean)?;
        let exact_mm = strip::exact(&contact, scallop_mm)?.width_mm;
        // To leading order the height above the part grows with the square of the way across the feed.
        let across = contact.relative().along(&contact.frame.left);
        let by_curvature_mm = 2.0 * (2.0 * scallop_mm / across).sqrt();
        println!("{lead_deg},{exact_mm:.6},{by_curvature_mm:.6}");
        widths.push((exact_mm, by_curvature_mm));
    }
    assert!(widths.windows(2).all(|w| w[1].0 < w[0].0), "the flatter the tool lies the wider the strip");
    assert!(widths.iter().skip(3).all(|(a, b)| (a / b - 1.0).abs() < 0.05), "near where the tool leans");
    Ok(())
}
