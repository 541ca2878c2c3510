//! A part of two bodies that overlap, from its file to a plan that holds: what lies within the other body is not missed.

#[path = "../../../surfaces/tests/bodies/mod.rs"]
mod bodies;
use crate::common;

use bodies::{ball, block, frame};
use common::{Scratch, job, osculate};
use osculate_surfaces::step;
use serde_json::Value;
use std::f64::consts::TAU;

/// Half of the block's sides, mm.
const HALF: f64 = 14.0;
/// Radius of the ball, and how far it comes out of the block, mm.
const BALL: [f64; 2] = [12.0, 0.06];

/// A ball that stands a little out of a block of 28 x 28 x 26: F6 is the block's top at z = 0, F7 the ball.
fn part() -> String {
    let own = |z: f64| frame([-HALF, -HALF, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let centre = frame([0.0, 0.0, BALL[1] - BALL[0]], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let faces = [block(&own(-26.0), [2.0 * HALF, 2.0 * HALF, 26.0]), ball(&centre, BALL[0])].concat();
    step::write(&faces, &step::StepOptions::default()).unwrap()
}

/// Areas of the disk that the ball takes out of the top, and of the ball within the block.
fn areas() -> [f64; 2] {
    let [radius, out] = BALL;
    [0.5 * TAU * (2.0 * radius * out - out * out), TAU * radius * (2.0 * radius - out)]
}

fn close(got: &Value, want: f64) {
    let got = got.as_f64().unwrap();
    assert!((got - want).abs() <= 1e-3 * want, "{got} against {want}");
}

#[test]
fn inspect_says_what_is_hidden_and_where() {
    let folder = Scratch::new();
    let file = folder.write("part.step", &part());
    let run = osculate(&["inspect", file.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let answer = run.json();
    let [top, within] = areas();
    let faces = answer["faces"].as_array().unwrap();
    assert_eq!(faces.len(), 7);
    close(&faces[5]["hidden_mm2"], top);
    close(&faces[5]["area_mm2"], 4.0 * HALF * HALF);
    assert_eq!(faces[5]["hidden_in"], serde_json::json!(["F7"]));
    close(&faces[6]["hidden_mm2"], within);
    assert_eq!(faces[6]["hidden_in"], serde_json::json!(["F1 to F6"]));
    assert_eq!(faces[0]["hidden_mm2"], 0.0);
    assert!(answer["diagnostics"].to_string().contains("in the material of other bodies"), "{answer}");
    let run = osculate(&["inspect", file.to_str().unwrap()]);
    assert!(run.out.contains("hidden mm2") && run.out.contains("F1 to F6"), "{}", run.out);
}

/// The block's top and the ball are planned together. Nothing is uncut, though a part of the top lies beneath the ball, and
/// nearly all of the ball within the block; the verdict says so.
#[test]
fn a_plan_misses_nothing_of_what_is_hidden() {
    let folder = Scratch::new();
    folder.write("part.step", &part());
    let with = |scallop_mm: &str, gouge_mm: &str| {
        job(|j| {
            j.replace(
                "builtin = { kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6 }",
                "file = \"part.step\"\nfaces = [\"F6\", \"F7\"]",
            )
            .replace("diameter_mm = 10", "diameter_mm = 4\nteeth = 2")
            .replace("scallop_mm = 0.02", &format!("scallop_mm = {scallop_mm}"))
            .replace("gouge_mm = 0.005", &format!("gouge_mm = {gouge_mm}"))
            .replace("kind = \"isoparametric\"\nlead_deg = 15", "kind = \"isoplanar_3c\"")
            .replace("max_samples = 20000", "max_samples = 400000")
        })
    };
    // Passes across the crease between the bodies leave a ridge in it: they lie closer than what is asked for in the end.
    let close_by = folder.write("close.toml", &with("0.03", "0.005"));
    let out = folder.path("out");
    let run = osculate(&["plan", close_by.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    let summary = run.json();
    assert_eq!(summary["verification"]["uncut_area_mm2"].as_f64().unwrap(), 0.0, "{summary}");
    let [top, within] = areas();
    close(&summary["area_mm2"], 4.0 * HALF * HALF - top + 2.0 * TAU * BALL[0] * BALL[0] - within);
    assert!(
        summary["diagnostics"].to_string().contains("neither machined nor counted as uncut"),
        "{summary}"
    );

    let asked = folder.write("job.toml", &with("0.06", "0.02"));
    let program = out.join("program.ngc");
    let run = osculate(&["verify", program.to_str().unwrap(), "--job", asked.to_str().unwrap(), "--json"]);
    let verified = run.json();
    assert_eq!(run.code, 0, "{verified}");
    assert_eq!(verified["verdict"]["answer"], "held", "{verified}");
    assert_eq!(verified["uncut_area_mm2"].as_f64().unwrap(), 0.0, "{verified}");
    let scope = verified["verdict"]["scope"]["hidden"].as_str().unwrap();
    assert!(scope.contains("of F6 in F7") && scope.contains("of F7 in F1 to F6"), "{scope}");
}

/// A face that lies wholly in another body is left out of the faces to machine; where there is no other the job is refused.
#[test]
fn a_face_that_is_wholly_hidden_is_left_out_by_name() {
    let folder = Scratch::new();
    let own = frame([-6.0, -6.0, -8.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let peg = frame([-2.0, -2.0, -3.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let faces = [block(&own, [12.0, 12.0, 8.0]), block(&peg, [4.0, 4.0, 6.0])].concat();
    folder.write("part.step", &step::write(&faces, &step::StepOptions::default()).unwrap());
    let text = job(|j| {
        j.replace(
            "builtin = { kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6 }",
            "file = \"part.step\"\nfaces = [\"F11\"]",
        )
    });
    let job = folder.write("job.toml", &text);
    let out = folder.path("out");
    osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap()])
        .refused(&["all of F11 in F1 to F6", "no tool has to reach it"]);
}
