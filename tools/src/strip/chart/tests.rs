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
            let off =
                [got.left_mm - want.left_mm, got.right_mm - want.right_mm, got.width_mm - want.width_mm];
            far += usize::from(off.iter().any(|mm| mm.abs() > 5e-3 * want.width_mm));
            jumps += usize::from(before.is_some_and(|b| (want.width_mm / b - 1.0).abs() > 0.1));
            before = Some(want.width_mm);
        }
    }
    // A crest that comes up to the tolerance to the chart's error may count or not.
    assert!(jumps > 5 && 40 * far <= count, "{far} of {count} are off, {jumps} jumps");
}

/// A face that is much smaller than the tool: it is too hollow for it everywhere, and charts say so wherever the exact strip does.
#[test]
fn faces_smaller_than_the_tool_are_as_hollow_as_the_exact_strip_says() {
    let half = 6.0;
    // z = 0.005 x^2 - 0.003 y^2 as a Bezier patch: x^2 over [-h, h] has the poles h^2, -h^2, h^2.
    let square = |k: usize| if k == 1 { -half * half } else { half * half };
    let poles = (0..9)
        .map(|k| {
            let (i, j) = (k / 3, k % 3);
            let z = 0.005 * square(i) - 0.003 * square(j);
            Point3::new(half * (i as f64 - 1.0), half * (j as f64 - 1.0), z)
        })
        .collect();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let net = Net { count: [3, 3], points: poles, weights: None };
    let part = NurbsSurface::new([2, 2], [knots.clone(), knots], net).unwrap();
    let ball = CutterSpec::Ball { diameter_mm: 300.0, length_mm: 400.0 };
    let cutter = Cutter::try_from(ball).unwrap();
    let (h, gouge_mm) = (0.02, 0.005);
    let lean = Lean { lead_rad: 15f64.to_radians(), tilt_rad: 0.0 };
    let (mut missed, mut count) = (0, 0);
    for at in (0..400).map(|k| uv(f64::from(2 * (k / 20) + 1) / 40.0, f64::from(2 * (k % 20) + 1) / 40.0)) {
        let chart = Chart::new(&part, at, 1.2 * cutter.radius_mm(), 0.05 * h).unwrap();
        for k in 0..12 {
            let angle = std::f64::consts::TAU * f64::from(k) / 12.0;
            let Ok(contact) = Contact::new(&part, at, &cutter, FeedLine::Angle(angle), lean) else {
                continue;
            };
            let undercut = exact(&contact, h).map_or(f64::INFINITY, |s| s.undercut_mm);
            let got = chart.strip(&cutter, angle, lean, Within { scallop_mm: h, gouge_mm });
            count += 1;
            if undercut > gouge_mm && got.as_ref().is_ok_and(|s| s.lift_mm == 0.0) {
                missed += 1;
                // Deepest between the places and instants looked at.
                assert!(undercut < 1.6 * gouge_mm, "{at:?} {angle}: {got:?}, {undercut} mm");
            }
        }
    }
    // At a corner the face ends at once, and the chart says no more than that the contact stands.
    let corner = Chart::new(&part, uv(0.0, 0.0), 1.2 * cutter.radius_mm(), 0.05 * h).unwrap();
    let small = Cutter::try_from(CutterSpec::Ball { diameter_mm: 4.0, length_mm: 20.0 }).unwrap();
    let got = corner.strip(&small, 0.25 * std::f64::consts::PI, lean, Within { scallop_mm: h, gouge_mm });
    assert!(got.as_ref().is_ok_and(|s| s.width_mm < 1e-6 && s.lift_mm == 0.0), "{got:?}");
    assert!(count > 4000 && 500 * missed <= count, "{missed} of {count}");
}
