//! `inspect` on the example parts, against independent figures.

use crate::common;
use common::{close, osculate};
use serde_json::Value;

fn inspect(path: &str) -> Value {
    let full = format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"));
    let run = osculate(&["inspect", &full, "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    run.json()
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
