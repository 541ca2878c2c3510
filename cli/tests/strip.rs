//! `strip` as a user runs it: its table, leads that are turned, contacts that cannot be.

use crate::common;
use common::{Scratch, osculate};

#[test]
fn the_table_is_for_people() {
    let scratch = Scratch::new();
    let text = common::job(|j| j + "[contact]\nat = [1, 2]\nangle_deg = 30\n");
    let path = scratch.write("job.toml", &text);
    let run = osculate(&["strip", path.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.err);
    for word in ["exact", "r97_37", "m86_2cl", "relative curvature", "mm"] {
        assert!(run.out.contains(word), "{word}: {}", run.out);
    }
}

#[test]
fn contacts_that_cannot_be_are_refused() {
    let scratch = Scratch::new();
    let run = |contact: &str| {
        let path = scratch.write("job.toml", &common::job(|j| j + contact));
        osculate(&["strip", path.to_str().unwrap()])
    };
    run("").refused(&["[contact]"]);
    run("[contact]\nat = [99, 0]\nalong = \"u\"\n").refused(&["outside the parameters", "[-6, 6]"]);
    run("[contact]\nat = [0, 0]\nalong = \"w\"\n").refused(&["along"]);
    run("[contact]\nat = [0, 0]\n").refused(&["angle_deg"]);
    run("[contact]\nat = [0, 0]\nalong = \"u\"\nlift_mm = 0.5\n").refused(&["lift_mm"]);
    run("[contact]\nat = [nan, 0]\nalong = \"u\"\n").refused(&["at"]);
}

/// At one contact a tilt to one side is a lead turned to the left of the growing parameter, here where lines of parameter are no lines of
/// curvature, so that the two sides differ; along another way it has no side.
#[test]
fn a_side_tilt_is_a_turned_lead() {
    let scratch = Scratch::new();
    let run = |lean: &str, along: &str| {
        let text = format!(
            "format = 1\n[part]\nbuiltin = {{ kind = \"ellipsoid\", semi_axes_mm = [30, 15, 20] }}\n\
             [tool]\nkind = \"toroidal\"\ndiameter_mm = 10\ncorner_radius_mm = 2\n[tolerance]\nscallop_mm = 0.02\n\
             [strategy]\nkind = \"isoparametric\"\n{lean}\n[contact]\nat = [0.6, 0.5]\n{along}\n"
        );
        osculate(&["strip", "--json", scratch.write("job.toml", &text).to_str().unwrap()])
    };
    let width = |lean: &str| run(lean, "along = \"u\"").json()["exact"]["left_mm"].as_f64().unwrap();
    let sided = "along = \"u\"\nlead_deg = 10\nside_tilt_deg = 15";
    let [ahead, left] = [10.0, 15.0].map(|deg: f64| deg.to_radians().tan());
    let (lead, turn) = (ahead.hypot(left).atan().to_degrees(), left.atan2(ahead).to_degrees());
    let turned = |deg: f64| width(&format!("lead_deg = {lead}\ntilt_deg = {deg}"));
    assert!((width(sided) / turned(turn) - 1.0).abs() < 1e-9);
    assert!((width(sided) / turned(-turn) - 1.0).abs() > 0.1);
    for along in ["along = \"v\"", "angle_deg = 30"] {
        run(sided, along).refused(&["side_tilt_deg", "[contact]"]);
    }
}

/// What a contact cannot do is told with the quantities that matter; what it does all the same is measured.
#[test]
fn impossible_contacts_say_what_would_do() {
    let scratch = Scratch::new();
    let run = |part: &str, tool: &str, lead_deg: f64, scallop_mm: f64, json: bool| {
        let text = format!(
            "format = 1\n[part]\nbuiltin = {{ {part} }}\n[tool]\n{tool}\n[tolerance]\nscallop_mm = {scallop_mm}\n\
             [strategy]\nlead_deg = {lead_deg}\n[contact]\nat = [0.5, 0.1]\nalong = \"u\"\n"
        );
        let path = scratch.write("job.toml", &text);
        let path = path.to_str().unwrap();
        if json { osculate(&["strip", "--json", path]) } else { osculate(&["strip", path]) }
    };
    let groove = "kind = \"torus\", major_radius_mm = 200, minor_radius_mm = 60, material = \"outside\"";
    let flat = "kind = \"flat\"\ndiameter_mm = 20";
    // Less lead than the groove is hollow: both curvatures, and the radius that fits, R = 60 sin(2 deg).
    let digs = run(groove, flat, 2.0, 0.01, false);
    assert_eq!(digs.code, 0, "{}", digs.err);
    for word in ["does not fit", "-0.016667 1/mm", "0.003490 1/mm", "radius 2.094 mm"] {
        assert!(digs.out.contains(word), "{word}: {}", digs.out);
    }
    let digs = run(groove, flat, 2.0, 0.01, true).json();
    assert!(digs["does_not_fit"].is_string() && digs["exact"]["undercut_mm"].as_f64().unwrap() > 0.01);
    run(groove, flat, 95.0, 0.01, true).refused(&["lead", "-90 and 90", "95"]);
    // Higher than two arcs of the part and a ball can meet.
    let ball = "kind = \"ball\"\ndiameter_mm = 4";
    let tall = run("kind = \"sphere\", radius_mm = 50", ball, 0.0, 5.0, true);
    let why = tall.json()["closed_forms"]["r97_37"]["why_not"].to_string();
    assert!(why.contains("5 mm") && why.contains("beyond the arcs") && why.contains("0.50000"), "{why}");
    // Without a lead a flat end stands on its whole bottom: on a ball a plane, 2 R acos(R / (R + h)).
    let flat_on_top = run("kind = \"sphere\", radius_mm = 50", flat, 0.0, 0.01, true);
    assert_eq!(flat_on_top.code, 0, "{}", flat_on_top.err);
    let answer = flat_on_top.json();
    let (exact, plane) = (&answer["exact"], 2.0 * 50.0 * (50.0f64 / 50.01).acos());
    assert!((exact["width_mm"].as_f64().unwrap() / plane - 1.0).abs() < 1e-2, "{answer} against {plane}");
    assert!(exact["undercut_mm"].as_f64().unwrap() < 1e-9, "{answer}");
}
