//! `plan` with places left out at which the tool would go into the part.

use crate::common;
use common::{Scratch, job, osculate};
use serde_json::Value;

/// A trough z = 0.06 x^2 along y, 12 mm long: its radius at the bottom is 1 / 0.12 = 8.33 mm, that of the ball 9 mm.
fn trough(strategy: &str) -> String {
    job(|t| {
        let t = t.replace("a_per_mm = 0.005, b_per_mm = -0.003", "a_per_mm = 0.06, b_per_mm = 0.0");
        t.replace("diameter_mm = 10", "diameter_mm = 18\nteeth = 4")
            .replace("lead_deg = 15", &format!("lead_deg = 0\nalong = \"v\"\n{strategy}"))
    })
}

fn plan(scratch: &Scratch, name: &str, text: &str) -> (i32, Value, String) {
    let job = scratch.write(&format!("{name}.toml"), text);
    let out = scratch.path(name);
    let run =
        osculate(&["plan", job.to_str().expect("UTF-8"), "--out", out.to_str().expect("UTF-8"), "--json"]);
    let page = std::fs::read_to_string(out.join("report.html")).expect("a report");
    (run.code, run.json(), page)
}

fn figure(v: &Value, key: &str) -> f64 {
    v["verification"][key].as_f64().expect("a number")
}

#[test]
fn a_ball_too_large_for_the_bottom_of_a_trough() {
    let scratch = Scratch::new();
    let (code, v, page) = plan(&scratch, "whole", &trough(""));
    assert!(code == 1 && v["left_out"].is_null() && figure(&v, "gouge_max_mm") > 0.03, "{v}");
    assert!(!page.contains("Left out"));
    let (code, v, page) = plan(&scratch, "rest", &trough("gouges = \"leave_out\""));
    // Nothing digs in now, and what stands is not within tolerance.
    assert!(code == 1 && v["verification"]["within_tolerance"] == false, "{v}");
    assert!(figure(&v, "gouge_max_mm") <= 0.005, "{v}");
    let left = &v["left_out"][0];
    let (area, uncut) = (left["area_mm2"].as_f64().unwrap(), figure(&v, "uncut_area_mm2"));
    assert!(left["face"] == "F1" && area > 1.0 && area <= 1.1 * uncut, "{left} {uncut}");
    // The bottom is what stands: beyond x = 4 the trough's radius is more than 11 mm.
    let worst = &v["worst"][0];
    assert!(worst["kind"] == "uncut" && worst["at_mm"][0].as_f64().unwrap().abs() < 4.0, "{worst}");
    assert!(v["diagnostics"].to_string().contains("counts as uncut"), "{v}");
    assert!(page.contains("Left out") && v["efficiency_percent"].is_null());
}

#[test]
fn nothing_is_left_out_where_everything_fits() {
    let scratch = Scratch::new();
    let small = |t: String| t.replace("half_size_mm = 6", "half_size_mm = 2.5");
    let (code, plain, _) = plan(&scratch, "plain", &job(small));
    let text = job(|t| {
        small(t).replace("lead_deg = 15", "lead_deg = 15\ngouges = \"leave_out\"\nkeep_off_mm = 0.5")
    });
    let (with_code, with, _) = plan(&scratch, "with", &text);
    assert!(code == 0 && with_code == 0 && with["left_out"].is_null(), "{with}");
    for key in ["passes", "cutting_length_mm"] {
        assert_eq!(plain[key], with[key]);
    }
}

#[test]
fn keys_that_say_nothing_are_refused() {
    let scratch = Scratch::new();
    let refused = |lines: &str, words: &[&str]| {
        let text = job(|t| t.replace("kind = \"isoparametric\"\n", lines));
        let job = scratch.write("job.toml", &text);
        let out = scratch.path("out");
        osculate(&["plan", job.to_str().expect("UTF-8"), "--out", out.to_str().expect("UTF-8")])
            .refused(words);
    };
    refused("kind = \"z_level\"\ngouges = \"leave_out\"\n", &["leave_out", "z_level"]);
    refused("kind = \"isoparametric\"\nkeep_off_mm = 1\n", &["keep_off_mm", "leave_out"]);
    refused("kind = \"isoparametric\"\ngouges = \"leave_out\"\nkeep_off_mm = -1\n", &["keep_off_mm", "-1"]);
    refused("kind = \"isoparametric\"\ngouges = \"avoid\"\n", &["gouges", "leave_out"]);
}
