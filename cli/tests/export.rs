//! `export` as a user runs it: files that read back, messages that say what is wrong.

use crate::common;
use common::{Scratch, osculate};

const HULL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/hull.step");

#[test]
fn every_format_is_written_and_read_back() {
    let scratch = Scratch::new();
    let mut areas = Vec::new();
    for name in ["a.step", "b.igs", "c.json"] {
        let path = scratch.path(name);
        let run = osculate(&["export", HULL, "--out", path.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 0, "{}", run.err);
        assert_eq!(run.json()["faces"], 1);
        // What was written is a PART again, the JSON too.
        let run = osculate(&["inspect", path.to_str().unwrap(), "--json"]);
        assert_eq!(run.code, 0, "{}", run.err);
        areas.push(run.json()["area_mm2"].as_f64().unwrap());
    }
    // The figure of another kernel; loops are followed to 2e-6 of the size.
    assert!(areas.iter().all(|a| (a / 858_197.884 - 1.0).abs() < 1e-5), "{areas:?}");
    let stl = scratch.path("d.stl");
    let run = osculate(&[
        "export",
        HULL,
        "--faces",
        "F1",
        "--out",
        stl.to_str().unwrap(),
        "--chord-mm",
        "1",
        "--json",
    ]);
    assert_eq!(run.code, 0, "{}", run.err);
    let triangles = &run.json()["triangles"];
    assert!(triangles["chord_error_mm"].as_f64().unwrap() <= 1.0);
    assert_eq!(triangles["watertight"], false);
    let count = triangles["count"].as_u64().unwrap();
    assert_eq!(std::fs::metadata(&stl).unwrap().len(), 84 + 50 * count);
    // Nothing else is left behind.
    assert_eq!(scratch.files(), ["a.step", "b.igs", "c.json", "d.stl"]);
}

#[test]
fn what_cannot_be_done_is_said() {
    let scratch = Scratch::new();
    let out = scratch.path("x.stl");
    let out = out.to_str().unwrap();
    let run = osculate(&["export", HULL, "--out", "x.dwg"]);
    assert!(run.code == 2 && run.err.contains(".step") && run.err.contains("x.dwg"), "{}", run.err);
    let run = osculate(&["export", HULL, "--faces", "F9", "--out", out]);
    assert!(run.code == 1 && run.err.contains("F9"), "{}", run.err);
    let run = osculate(&["export", HULL, "--out", out, "--chord-mm", "0"]);
    assert!(run.code == 1 && run.err.contains("chord tolerance"), "{}", run.err);
    let bad = scratch.write("bad.json", "{\"format\": 1, \"faces\": [], \"colour\": 2}");
    let run = osculate(&["export", bad.to_str().unwrap(), "--out", out]);
    assert!(run.code == 1 && run.err.contains("colour") && run.err.contains("line 1"), "{}", run.err);
    assert_eq!(scratch.files(), ["bad.json"]);
}
