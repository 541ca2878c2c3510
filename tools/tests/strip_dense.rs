//! Exact strips of every kind of cutter on spline faces, smooth and wavy, against brute force ([`dense`]).

use crate::dense;

use dense::{Steps, dense};
use osculate_geom::{Point3, uv};
use osculate_surfaces::{Net, NurbsSurface};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};

const SCALLOP_MM: f64 = 0.01;

/// A bicubic face of 60 x 60 mm over a net of `poles` each way: hills and hollows of about 60 mm radius, and waves of 3 mm length.
fn face(poles: usize, wave_mm: f64) -> NurbsSurface {
    let at = |k: usize| 60.0 * k as f64 / (poles - 1) as f64;
    let height = |x: f64, y: f64| {
        let hills = 4.0 * (x / 22.0).sin() * (y / 19.0).cos() + 0.002 * (x - 30.0) * (y - 30.0);
        hills + wave_mm * (2.1 * x + 0.3).sin() * (1.9 * y).cos()
    };
    let points = (0..poles * poles)
        .map(|k| {
            let (x, y) = (at(k / poles), at(k % poles));
            Point3::new(x, y, height(x, y))
        })
        .collect();
    let inner = poles - 4;
    let knots: Vec<f64> =
        (0..poles + 4).map(|k| k.saturating_sub(3).min(inner + 1) as f64 / (inner + 1) as f64).collect();
    let net = Net { count: [poles, poles], points, weights: None };
    NurbsSurface::new([3, 3], [knots.clone(), knots], net).unwrap()
}

/// Cutters with a lead at which the part of the meridian that is meant touches.
fn cutters() -> Vec<(&'static str, CutterSpec, f64)> {
    let (diameter_mm, length_mm) = (12.0, 40.0);
    let barrel = CutterSpec::Barrel { diameter_mm, barrel_radius_mm: 40.0, corner_radius_mm: 2.0, length_mm };
    let cone = |tip_diameter_mm| CutterSpec::Cone {
        diameter_mm,
        taper_deg: 20.0,
        corner_radius_mm: 1.5,
        tip_diameter_mm,
        length_mm,
    };
    let apt = CutterSpec::Apt {
        diameter_mm: 8.0,
        corner_radius_mm: 1.5,
        bottom_angle_deg: 5.0,
        side_angle_deg: 8.0,
        length_mm,
    };
    vec![
        ("ball", CutterSpec::Ball { diameter_mm, length_mm }, 0.2),
        ("flat", CutterSpec::Flat { diameter_mm, length_mm }, 0.3),
        ("toroidal", CutterSpec::Toroidal { diameter_mm, corner_radius_mm: 2.0, length_mm }, 0.25),
        ("cylindrical", CutterSpec::Cylindrical { diameter_mm, length_mm }, 0.4),
        ("cone, ball end", cone(None), 0.35),
        ("cone, flat end", cone(Some(6.0)), 0.35),
        ("barrel, tip", barrel, 0.4),
        // The large arc touches from asin((40 - 6) / (40 - 2)), 63.5 degrees, on.
        ("barrel, flank", barrel, 1.3),
        ("general, corner", apt, 0.3),
    ]
}

/// Widths to a millionth, undercut to a hundredth of the tolerance (brute force has no places between places).
fn compare(face: &NurbsSurface, flatter: f64, relative: f64) -> usize {
    let places = 3;
    let part = |k: usize, step: f64| 0.3 + 0.4 * (0.5 + k as f64 * step).fract();
    let mut others = 0;
    for (n, (name, spec, lead_rad)) in cutters().into_iter().enumerate() {
        let cutter = Cutter::try_from(spec).unwrap();
        let mut compared = 0;
        for k in 0..places {
            let seed = places * n + k;
            let at = uv(part(seed, 0.754_877_666_246_693), part(seed, 0.569_840_290_998_053));
            // The barrel's flank keeps its lead.
            let lead_rad = if lead_rad < 1.0 { flatter * lead_rad } else { lead_rad };
            let lean = Lean { lead_rad, tilt_rad: 0.3 * (seed as f64).sin() };
            let contact = Contact::new(face, at, &cutter, FeedLine::Angle(seed as f64), lean).unwrap();
            let got = strip::exact(&contact, SCALLOP_MM).unwrap();
            let most = got.left_mm.max(got.right_mm);
            let steps = Steps { along_mm: 0.015 * cutter.radius_mm(), across_mm: 0.04 * most };
            let want = dense(&contact, spec, SCALLOP_MM, &steps, 1.2 * most);
            if want.lowest_mm < -0.1 * cutter.radius_mm() {
                // The tool does not fit at all.
                continue;
            }
            compared += 1;
            others += want.other_passages;
            for (side, a, b) in [("left", got.left_mm, want.left_mm), ("right", got.right_mm, want.right_mm)]
            {
                assert!((a - b).abs() < relative * got.width_mm, "{name} {k}, {side}: {got:?} {want:?}");
            }
            let deeper = got.undercut_mm - (-want.lowest_mm).max(0.0);
            assert!(deeper.abs() < 1e-2 * SCALLOP_MM, "{name} {k}: {got:?} {want:?}");
        }
        assert!(compared > 0, "{name}: {compared} of {places} places fit");
    }
    others
}

#[test]
fn every_cutter_on_a_smooth_face() {
    compare(&face(10, 0.0), 1.0, 1e-6);
}

/// Knots every 1.6 mm, a quarter of the radius, and waves that turn the normal by two degrees: tools rock over them and
/// come over places twice.
#[test]
fn every_cutter_on_a_wavy_face() {
    let others = compare(&face(40, 0.1), 0.3, 1e-5);
    println!("{others} places were cut at another instant");
    assert!(others > 0, "no place was cut at another instant");
}
