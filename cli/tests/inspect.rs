//! `inspect` and `probe` on the example parts and on built-in surfaces, against independent figures.
#![allow(clippy::unwrap_used)]

mod common;
use common::osculate;
use serde_json::Value;

fn inspect(path: &str) -> Value {
    let full = format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"));
    let run = osculate(&["inspect", &full, "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    run.json()
}

fn close(got: &Value, want: f64, relative: f64) {
    let got = got.as_f64().unwrap();
    assert!((got - want).abs() <= relative * want.abs(), "{got} against {want}");
}

/// Figures of another kernel for the same files.
#[test]
fn example_parts() {
    let blade = inspect("examples/eee-hpt-rotor2/blade.igs");
    assert_eq!(blade["format"], "iges");
    let faces = blade["faces"].as_array().unwrap();
    assert_eq!(faces.len(), 1);
    assert_eq!(
        (&faces[0]["kind"], &faces[0]["degree"], &faces[0]["poles"]),
        (&"bspline".into(), &serde_json::json!([3, 3]), &serde_json::json!([419, 5]))
    );
    // The other kernel's area is good to 0.25 mm2.
    close(&blade["area_mm2"], 10_828.078, 4e-5);
    close(&blade["bbox_mm"][0], 6401.0556, 1e-5);
    close(&blade["bbox_mm"][5], 380.4920, 1e-5);

    let hull = inspect("examples/wigley-hull/hull.step");
    assert_eq!(hull["faces"].as_array().unwrap().len(), 1);
    close(&hull["area_mm2"], 858_197.884, 1e-5);

    let propeller = inspect("examples/propeller/propeller.step");
    let faces = propeller["faces"].as_array().unwrap();
    let count = |kind: &str| faces.iter().filter(|f| f["kind"] == kind).count();
    assert_eq!(
        [faces.len(), count("bspline"), count("plane"), count("cylinder"), count("torus")],
        [20, 12, 4, 2, 2]
    );
    close(&propeller["area_mm2"], 11_819.797, 1e-5);
}

#[test]
fn built_in_surfaces() {
    let keys = "kind = \"torus\", major_radius_mm = 200, minor_radius_mm = 60, material = \"outside\"";
    let run = osculate(&["inspect", "--builtin", keys, "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    close(&run.json()["area_mm2"], 4.0 * std::f64::consts::PI.powi(2) * 12_000.0, 1e-9);
    let run =
        osculate(&["probe", "--builtin", keys, "--at", "0.3,3.141592653589793", "--at", "0,0", "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let points = run.json();
    let k = &points["points"][0]["principal_per_mm"];
    // Inside of the tube: hollow across, convex along.
    close(&k[0], 1.0 / 140.0, 1e-12);
    close(&k[1], -1.0 / 60.0, 1e-12);
    assert_eq!(points["points"].as_array().unwrap().len(), 2);
    let run = osculate(&["probe", "--builtin", keys, "--at", "0.3,3.14"]);
    assert!(run.out.contains("first form") && run.out.contains("convex"), "{}", run.out);
}

#[test]
fn lists_of_what_is_built_in() {
    for (verb, word) in [("machines", "trunnion-ac"), ("dialects", "sinumerik"), ("tools", "toroidal")] {
        assert!(osculate(&[verb]).out.contains(word));
        assert!(osculate(&[verb, "--json"]).json().to_string().contains(word));
    }
}
