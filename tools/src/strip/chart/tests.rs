//! Charts of a part with waves against exact strips.

use super::{Chart, Within};
use crate::contact::{Contact, FeedLine, Lean};
use crate::cutter::Cutter;
use crate::spec::CutterSpec;
use crate::strip::exact;
use osculate_geom::{Point3, Surface, Uv, uv};
use osculate_surfaces::{Net, NurbsSurface};

const POLES: usize = 60;
const SIZE_MM: f64 = 24.0;

/// A shallow bowl with waves of two hundredths, a knot every 0.4 mm.
fn wavy() -> NurbsSurface {
    let at = |k: usize| SIZE_MM * k as f64 / (POLES - 1) as f64;
    let height =
        |x: f64, y: f64| -0.004 * (x * x + 0.5 * y * y) + 0.02 * (2.1 * x).sin() * (1.7 * y + 0.3).cos();
    let poles = (0..POLES * POLES)
        .map(|k| {
            let (x, y) = (at(k / POLES), at(k % POLES));
            Point3::new(x, y, height(x, y))
        })
        .collect();
    let inner = POLES - 4;
    let knots: Vec<f64> =
        (0..POLES + 4).map(|k| k.saturating_sub(3).min(inner + 1) as f64 / (inner + 1) as f64).collect();
    let net = Net { count: [POLES, POLES], points: poles, weights: None };
    NurbsSurface::new([3, 3], [knots.clone(), knots], net).unwrap()
}

/// Strips that end at one wave in one direction and at another in the next are the exact ones', at the edge of the part too.
#[test]
fn strips_over_waves_are_the_exact_ones() {
    let part = wavy();
    let cutter = CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 40.0 };
    let cutter = Cutter::try_from(cutter).unwrap();
    let h = 0.008;
    let places: [Uv; 3] = [uv(0.31, 0.52), uv(0.63, 0.44), uv(0.03, 0.5)];
    let (mut far, mut count, mut jumps) = (0, 0, 0);
    for at in places {
        assert!(part.domain().contains(at));
        let chart = Chart::new(&part, at, 3.6, 1e-2 * h).unwrap();
        assert!(chart.error_mm() <= 1e-2 * h, "{} mm", chart.error_mm());
        let mut before: Option<f64> = None;
        for k in 0..72 {
            let angle = std::f64::consts::TAU * f64::from(k) / 72.0;
            let lean = Lean { lead_rad: 0.06, tilt_rad: 0.2 };
            let contact = Contact::new(&part, at, &cutter, FeedLine::Angle(angle), lean).unwrap();
            let want = exact(&contact, h).unwrap();
            // No lift: any undercut is accepted.
            let got = chart.strip(&cutter, angle, lean, Within { scallop_mm: h, gouge_mm: 1.0 }).unwrap();
            count += 1;
            far += usize::from((got.width_mm / want.width_mm - 1.0).abs() > 5e-3);
            jumps += usize::from(before.is_some_and(|b| (want.width_mm / b - 1.0).abs() > 0.1));
            before = Some(want.width_mm);
        }
    }
    // A crest that comes up to the tolerance to the chart's error may count or not.
    assert!(jumps > 5 && 40 * far <= count, "{far} of {count} are off, {jumps} jumps");
}
