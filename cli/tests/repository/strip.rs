//! `strip --json` against independently computed exact widths on tori.

use crate::common;
use common::{Scratch, osculate};
use serde_json::Value;

#[test]
fn torus_cases_agree_to_six_digits_and_more() {
    let file: Value =
        serde_json::from_str(include_str!("../../../tools/tests/data/torus_exact.json")).unwrap();
    let scratch = Scratch::new();
    let cases = file["cases"].as_array().unwrap();
    assert!(cases.len() >= 20);
    for (k, case) in cases.iter().enumerate() {
        let (part, tool, contact, want) = (&case["part"], &case["tool"], &case["contact"], &case["expect"]);
        let text = format!(
            "format = 1\n[part]\nbuiltin = {{ kind = {}, major_radius_mm = {}, minor_radius_mm = {}, material = {} }}\n\
             [tool]\nkind = {}\ndiameter_mm = {}\ncorner_radius_mm = {}\n[tolerance]\nscallop_mm = {}\n\
             [strategy]\nlead_deg = {}\ntilt_deg = {}\n[contact]\nat = {}\nalong = \"u\"\nlift_mm = {}\n",
            part["kind"],
            part["major_radius_mm"],
            part["minor_radius_mm"],
            part["material"],
            tool["kind"],
            tool["diameter_mm"],
            tool["corner_radius_mm"],
            case["scallop_mm"],
            contact["lead_deg"],
            contact["tilt_deg"],
            contact["at"],
            contact["lift_mm"]
        );
        let path = scratch.write(&format!("case{k}.toml"), &text);
        let run = osculate(&["strip", "--json", path.to_str().unwrap()]);
        assert_eq!(run.code, 0, "{}\n{text}", run.err);
        let got = run.json();
        let exact = &got["exact"];
        let number = |v: &Value| v.as_f64().unwrap();
        let width = number(&want["width_mm"]);
        assert!((number(&exact["width_mm"]) / width - 1.0).abs() < 1e-9, "case {k}: {exact}");
        // Fed along u on a torus with the material inside, +v is on the left; outside, on the right.
        let (plus, minus) =
            if part["material"] == "inside" { ("left_mm", "right_mm") } else { ("right_mm", "left_mm") };
        assert!(
            (number(&exact[plus]) / number(&want["toward_plus_v_mm"]) - 1.0).abs() < 1e-9,
            "case {k}: {exact}"
        );
        assert!(
            (number(&exact[minus]) / number(&want["toward_minus_v_mm"]) - 1.0).abs() < 1e-9,
            "case {k}: {exact}"
        );
        let deep = number(&want["undercut_mm"]);
        assert!(
            (number(&exact["undercut_mm"]) - deep).abs() < 1e-6 * number(&case["scallop_mm"]),
            "case {k}"
        );
        assert!(
            got["closed_forms"]["r97_37"].is_object() && got["relative_curvature_per_mm"]["min"].is_number()
        );
    }
}
