//! Exact strips on torus parts against independently computed widths (`data/torus_exact.json`).
//!
//! Fed along a parallel the sweep is a surface of revolution, whose meridian is known exactly.

use osculate_geom::analytic::Torus;
use osculate_geom::{Axis, Flipped, Surface, uv};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
use serde_json::Value;

fn number(v: &Value, key: &str) -> f64 {
    v[key].as_f64().unwrap_or_else(|| panic!("{key} in {v}"))
}

/// The part of a case, with the material where the case says.
fn part(case: &Value) -> Box<dyn Surface> {
    let p = &case["part"];
    let torus = Torus::new(number(p, "major_radius_mm"), number(p, "minor_radius_mm")).unwrap();
    if p["material"] == "outside" { Box::new(Flipped(torus)) } else { Box::new(torus) }
}

fn cutter(case: &Value) -> Cutter {
    let t = &case["tool"];
    let diameter_mm = number(t, "diameter_mm");
    let length_mm = 100.0;
    let spec = match t["kind"].as_str().unwrap() {
        "ball" => CutterSpec::Ball { diameter_mm, length_mm },
        "flat" => CutterSpec::Flat { diameter_mm, length_mm },
        _ => CutterSpec::Toroidal { diameter_mm, corner_radius_mm: number(t, "corner_radius_mm"), length_mm },
    };
    Cutter::try_from(spec).unwrap()
}

#[test]
fn widths_agree_to_seven_digits() {
    let file: Value = serde_json::from_str(include_str!("data/torus_exact.json")).unwrap();
    let cases = file["cases"].as_array().unwrap();
    assert!(cases.len() >= 10);
    let mut worst: f64 = 0.0;
    for (k, case) in cases.iter().enumerate() {
        let (surface, cutter) = (part(case), cutter(case));
        let c = &case["contact"];
        let at = uv(c["at"][0].as_f64().unwrap(), c["at"][1].as_f64().unwrap());
        let lean = Lean {
            lead_rad: number(c, "lead_deg").to_radians(),
            tilt_rad: number(c, "tilt_deg").to_radians(),
        };
        let contact = Contact::new(&*surface, at, &cutter, FeedLine::Iso(Axis::U), lean)
            .unwrap()
            .lifted(number(c, "lift_mm"));
        let got = strip::exact(&contact, number(case, "scallop_mm")).unwrap();
        let want = &case["expect"];
        let plus_is_left = contact.frame.left.dot(&surface.jet2(at).dv) > 0.0;
        let (plus, minus) =
            if plus_is_left { (got.left_mm, got.right_mm) } else { (got.right_mm, got.left_mm) };
        let close = |name: &str, got: f64, want: f64| {
            let off = (got - want).abs() / want.abs().max(1e-300);
            assert!(off < 1e-7, "case {k}: {name} {got} against {want} (relative {off:.2e}): {case}");
            off
        };
        worst = worst.max(close("+v", plus, number(want, "toward_plus_v_mm")));
        worst = worst.max(close("-v", minus, number(want, "toward_minus_v_mm")));
        worst = worst.max(close("width", got.width_mm, number(want, "width_mm")));
        // Undercut is a height: within a millionth of the tolerance.
        let deep = number(want, "undercut_mm");
        assert!(
            (got.undercut_mm - deep).abs() < 1e-6 * number(case, "scallop_mm"),
            "case {k}: {got:?} {case}"
        );
        assert!(got.error_mm < 1e-7 * got.width_mm, "case {k}: {got:?}");
    }
    println!("worst relative difference {worst:.2e} over {} cases", cases.len());
}
