//! Operations that are planned in one place and repeated in others by turning: what comes of them, and what cannot be repeated.

use crate::common;
use common::{Run, Scratch, osculate};
use serde_json::{Value, json};

/// Shallow dishes that are not alike along and across, 14 mm off the axis z, each turned by a part of a full circle.
fn dishes(count: usize) -> String {
    let half = 4.0;
    let poles = |turn: f64| -> Vec<Vec<[f64; 3]>> {
        let (along, square) = ([-half, 0.0, half], [half * half, -half * half, half * half]);
        let at = |i: usize, j: usize| {
            let (x, y) = (14.0 + along[i], along[j]);
            let (s, c) = turn.sin_cos();
            [c * x - s * y, s * x + c * y, 0.01 * square[i] + 0.02 * square[j]]
        };
        (0..3).map(|i| (0..3).map(|j| at(i, j)).collect()).collect()
    };
    let knots = [0, 0, 0, 1, 1, 1];
    let face = |k: usize| {
        let nurbs = json!({ "degree": [2, 2], "knots": [knots, knots], "side": "along",
            "poles_mm": poles(std::f64::consts::TAU * k as f64 / count as f64) });
        json!({ "id": format!("F{}", k + 1), "kind": "bspline", "oriented": true, "side": "along", "surface": { "nurbs": nurbs } })
    };
    json!({ "format": 1, "faces": (0..count).map(face).collect::<Vec<_>>() }).to_string()
}

const LIST: &str = r#"format = 2
[part]
file = "dishes.json"
[stock]
box_mm = [-19, -19, -3, 19, 19, 1.5]
cell_mm = 0.5
[tolerance]
scallop_mm = 0.04
gouge_mm = 0.02
[verification]
spacing_mm = 0.15
accept = "samples"
[machine]
name = "trunnion-ac"
dialect = "linuxcnc"
[[tool]]
number = 4
kind = "flat"
diameter_mm = 4
length_mm = 30
teeth = 2
cutting = { spindle_rpm = 6000, feed_mm_min = 900 }
[[tool]]
number = 7
kind = "ball"
diameter_mm = 6
length_mm = 40
teeth = 2
cutting = { spindle_rpm = 9000, feed_mm_min = 1500 }
[[operation]]
name = "rough"
kind = "rough"
tools = [4]
allowance_mm = 0.3
[[operation]]
name = "finish"
kind = "finish"
tools = [7]
faces = ["F1"]
repeat = 4
strategy = { kind = "isoplanar_3c", feed_direction = [1, 0, 0] }
"#;

fn planned(scratch: &Scratch, text: &str) -> Run {
    scratch.write("dishes.json", &dishes(4));
    let job = scratch.write("job.toml", text);
    osculate(&["plan", job.to_str().unwrap(), "--out", scratch.path("out").to_str().unwrap(), "--json"])
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

/// Points and axes of the feed moves of a CL file.
fn goto(text: &str) -> Vec<[f64; 3]> {
    let line = |l: &str| {
        let x: Vec<f64> = l.strip_prefix("GOTO/")?.split(',').map(|x| x.trim().parse().unwrap()).collect();
        Some([x[0], x[1], x[2]])
    };
    text.lines().filter_map(line).collect()
}

#[test]
fn one_place_is_planned_and_all_are_held() {
    let scratch = Scratch::new();
    let run = planned(&scratch, LIST);
    let v = run.json();
    assert_eq!((run.code, &v["verdict"]["answer"]), (0, &"held".into()), "{}", v["verdict"]);
    let finish = &v["operations"][1];
    let passes = finish["passes"].as_u64().unwrap();
    assert!(passes >= 8 && passes.is_multiple_of(4), "{passes}");
    // It is judged on all places, of which each has a quarter of the area.
    assert!((number(&finish["area_mm2"]) - number(&v["area_mm2"])).abs() < 1e-6, "{}", finish["area_mm2"]);
    assert!(v["diagnostics"].to_string().contains("finish: planned on F1 and repeated in 4 places"));
    // Every point near the first dish lies near each of the others again.
    let points = goto(&std::fs::read_to_string(scratch.path("out/path-2.cl")).unwrap());
    let low: Vec<_> = points.iter().filter(|p| p[2] < 0.5).collect();
    let first: Vec<_> = low.iter().filter(|p| p[0] > p[1].abs()).collect();
    assert!(first.len() > 20 && 4 * first.len() == low.len(), "{} {}", first.len(), low.len());
    for p in &first {
        for turned in [[-p[1], p[0]], [-p[0], -p[1]], [p[1], -p[0]]] {
            let near = low.iter().any(|q| (q[0] - turned[0]).hypot(q[1] - turned[1]) < 1e-3);
            assert!(near, "{p:?} {turned:?}");
        }
    }
    let verify = |program: &str| {
        let (file, job) = (scratch.path(program), scratch.path("job.toml"));
        osculate(&["verify", file.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"]).json()
    };
    assert_eq!(verify("out/program.ngc")["verdict"], v["verdict"]);
    // With its axis said it is the same plan.
    let said = LIST.replace("repeat = 4", "repeat = { axis = [0, 0, 2], at_mm = [0, 0, 9], count = 4 }");
    let again = planned(&scratch, &said).json();
    assert_eq!(again["verdict"], v["verdict"]);
    assert_eq!(again["cutting_length_mm"], v["cutting_length_mm"]);
}

#[test]
fn rest_is_looked_for_in_all_places() {
    let scratch = Scratch::new();
    // A finishing that leaves high cusps in the second place only, and a rest that is planned in the first.
    let coarse = LIST.replace("faces = [\"F1\"]\nrepeat = 4", "faces = [\"F1\", \"F3\", \"F4\"]")
        + "[[operation]]\nname = \"coarse\"\nkind = \"finish\"\ntools = [7]\nfaces = [\"F2\"]\nscallop_mm = 0.3\nstrategy = { kind = \
           \"isoplanar_3c\", feed_direction = [1, 0, 0] }\n[[operation]]\nname = \"rest\"\nkind = \"rest\"\ntools = [7]\nfaces = \
           [\"F1\"]\nrepeat = 4\n";
    let v = planned(&scratch, &coarse).json();
    assert_eq!(v["verdict"]["answer"], "held", "{}", v["verdict"]);
    let rest = &v["operations"][3];
    assert_eq!(rest["name"], "rest");
    let high = number(&rest["too_high_mm2"]);
    assert!(high > 1.0 && high < 70.0, "{high}");
}

#[test]
fn what_cannot_be_repeated_is_refused_before_planning() {
    let scratch = Scratch::new();
    let refused = |text: &str, words: &[&str]| {
        planned(&scratch, text).refused(words);
        assert!(!scratch.path("out").join("summary.json").exists());
    };
    let repeat = |with: &str| LIST.replace("repeat = 4", with);
    let here = "[[operation]] number 2: ";
    refused(&repeat("repeat = 1"), &["line ", here, "repeat = 1 must be a whole number from 2"]);
    refused(&repeat("repeat = \"4\""), &[here, "or a table with the number as count"]);
    refused(&repeat("repeat = { axis = [0, 0, 1] }"), &["[operation.repeat]", "needs count"]);
    refused(&repeat("repeat = { cuont = 4 }"), &["cuont is no key here", "(is count meant?)"]);
    refused(
        &repeat("repeat = 5"),
        &["line ", here, "F1 turned by 72.0000 deg is not on the part", "nearest face", "count = 4 serves"],
    );
    refused(
        &repeat("repeat = { at_mm = [1, 0, 0], count = 4 }"),
        &[
            here,
            "F1 turned by 90.0000 deg is not on the part",
            "no number of places serves: change axis or at_mm",
        ],
    );
    refused(
        &repeat("repeat = { axis = [1, 0, 0], count = 4 }"),
        &["F1 turned by 90.0000 deg", "change axis"],
    );
    refused(&repeat("repeat = 2"), &["F2, F4 are machined by nothing"]);
    refused(
        &LIST.replace("faces = [\"F1\"]", "faces = [\"F1\", \"F3\"]"),
        &["F1 turned by 180.0000 deg lies on F3", "which is turned itself"],
    );
}
