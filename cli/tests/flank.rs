//! `flank`: the table of methods against D98's values, the program against the envelope, and jobs that cannot be.

use crate::common;
use common::{Scratch, osculate};
use serde_json::Value;

fn job(part: &str, tool: &str, flank: &str) -> String {
    format!(
        "format = 1\n[part]\n{part}\n[tool]\n{tool}\n[tolerance]\nscallop_mm = 0.1\ngouge_mm = 0.1\nchord_mm = 0.001\n\
         [flank]\n{flank}\n[verification]\nspacing_mm = 0.7\n"
    )
}

const CYLINDER: &str = "kind = \"cylindrical\"\ndiameter_mm = 20\nlength_mm = 200";
const LIU: &str = "builtin = { kind = \"d98-liu\" }";

fn method<'a>(v: &'a Value, name: &str) -> &'a Value {
    v["methods"].as_array().unwrap().iter().find(|m| m["name"] == name).unwrap()
}

fn near(v: &Value, want: f64, within: f64) {
    let got = v.as_f64().unwrap_or_else(|| panic!("{v} is no number"));
    assert!((got - want).abs() <= within, "{got} {want}");
}

/// Liu's surface at its last rule and over the whole patch: theory's values; the optimum's first contact is off the patch.
#[test]
fn table_of_lius_surface() {
    let scratch = Scratch::new();
    let flank = "at_u = 23.014\nspan_u = [-5, 28]\npositions = 61\nspans = 14";
    let path = scratch.write("job.toml", &job(LIU, CYLINDER, flank));
    let run = osculate(&["flank", path.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let v = run.json();
    assert_eq!(v["methods"].as_array().unwrap().len(), 7);
    let m = method(&v, "optimum");
    near(&m["gamma_deg"], 9.110_703_848_63, 1e-9);
    near(&m["h0_mm"], 17.219_361_231_9, 1e-8);
    near(&m["u0"], 25.766_461_227_9, 1e-8);
    near(&m["u1"], 21.724_627_045_4, 1e-8);
    near(&m["static_mm"]["min"], -0.247_425_598_8, 1e-8);
    near(&m["static_mm"]["max"], 0.151_860_213_2, 1e-8);
    near(&m["envelope_mm"]["min"], -0.2854, 1e-4);
    assert!(m["valid"] == false && m["why"].as_str().unwrap().contains("off the face"), "{m}");
    let m = method(&v, "double_point_offset");
    near(&m["envelope_mm"]["min"], -0.336, 5e-4);
    near(&m["envelope_mm"]["max"], 0.789, 1e-3);
    let m = method(&v, "envelope_minimax");
    let worst = m["envelope_mm"]["max"].as_f64().unwrap().max(-m["envelope_mm"]["min"].as_f64().unwrap());
    let bound = m["lower_bound_mm"].as_f64().unwrap();
    assert!(worst < 0.0998 && bound <= worst && bound > 0.98 * worst, "{m}");
}

/// The program, read back and verified by material removal, leaves what the envelope says: to a micrometre.
#[test]
fn programs_leave_what_the_envelope_says() {
    let hyperbolic = "builtin = { kind = \"d98-hyperbolic\", h_mm = 40, alpha_deg = 20 }";
    let points = "[part.ruled]\nc0 = { points = [[0, 0, 0], [15, 3, 0], [30, 4, 0], [45, 1, 0]] }\n\
                  c1 = { degree = 2, knots = [0, 0, 0, 1, 1, 1], poles = [[0, 4, 25], [22, 8, 27], [46, -2, 25]] }";
    let cone = "kind = \"cone\"\ndiameter_mm = 16\ntaper_deg = 3\ntip_diameter_mm = 8\ncorner_radius_mm = 1\nlength_mm = 90";
    for (part, tool, flank) in [
        (LIU, CYLINDER, "spans = 8\npositions = 41"),
        (hyperbolic, CYLINDER, "spans = 8\npositions = 41\nmethod = \"double_point_offset\""),
        (points, cone, "spans = 8\npositions = 41\nside = -1"),
    ] {
        let scratch = Scratch::new();
        let path = scratch.write("job.toml", &job(part, tool, flank));
        let out = scratch.path("out");
        let run = osculate(&["flank", path.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
        let v = run.json();
        let program = &v["program"];
        assert!(program["samples"].as_u64().unwrap() > 500, "{part}: {program} {}", run.err);
        assert!(program["max_mm"].as_f64().unwrap() < 1e-3, "{part}: {program}");
        for file in ["path.cl", "program.mpf", "report.html", "summary.json", "flank.json"] {
            assert!(out.join(file).is_file(), "{file}");
        }
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        assert!(page.contains("envelope minimax envelope") && page.contains("Positionings"));
    }
}

#[test]
fn developable_faces_leave_nothing_by_any_method() {
    let scratch = Scratch::new();
    let cylinder = "builtin = { kind = \"cylinder\", radius_mm = 40, height_mm = 30, u_range = [0, 1.2] }";
    let path = scratch.write("job.toml", &job(cylinder, CYLINDER, "spans = 4\npositions = 21"));
    let v = osculate(&["flank", path.to_str().unwrap(), "--json"]).json();
    for m in v["methods"].as_array().unwrap() {
        for key in ["min", "max"] {
            near(&m["envelope_mm"][key], 0.0, 2e-4);
        }
    }
    assert!(v["diagnostics"].to_string().contains("developable"));
}

#[test]
fn jobs_that_cannot_be_flank_milled() {
    let scratch = Scratch::new();
    let refused = |part: &str, tool: &str, flank: &str, words: &[&str]| {
        let path = scratch.write("job.toml", &job(part, tool, flank));
        osculate(&["flank", path.to_str().unwrap()]).refused(words);
    };
    let ruled =
        |c0: &str, c1: &str| format!("[part.ruled]\nc0 = {{ points = {c0} }}\nc1 = {{ points = {c1} }}");
    let crossing = ruled("[[0, 0, 0], [10, 0, 0]]", "[[0, -5, 0], [10, 5, 0]]");
    refused(&crossing, CYLINDER, "", &["job.toml", "come within", "u = 0.5"]);
    let point = ruled("[[0, 0, 0], [10, 0, 0]]", "[[0, 0, 0], [10, 0, 20]]");
    refused(&point, CYLINDER, "", &["come within", "u = 0"]);
    refused(LIU, CYLINDER, "at_u = 99", &["at_u = 99", "23.014"]);
    refused(LIU, CYLINDER, "method = \"best\"", &["best", "envelope_minimax"]);
    refused(LIU, CYLINDER, "side = 2", &["side = 2", "1 or -1"]);
    refused(LIU, CYLINDER, "judge_u = [3, 2]", &["judge_u", "lower one first"]);
    refused(LIU, CYLINDER, "judge_u = [-3, 2]", &["judge_u", "leaves the face"]);
    refused("", CYLINDER, "", &["[part] needs"]);
    // A cusp: the first directrix turns back on itself, its poles on one line.
    let cusp = "[part.ruled]\nc0 = { degree = 2, knots = [0, 0, 0, 1, 1, 1], poles = [[0, 0, 0], [9, 0, 0], [0, 0, 0]] }\n\
                c1 = { points = [[0, 5, 30], [9, 5, 30]] }";
    refused(cusp, CYLINDER, "at_u = 0.5", &["u = 0.5", "stands still"]);
}

/// What a method cannot do is said in its line, with what would.
#[test]
fn reasons_stand_in_the_table() {
    let scratch = Scratch::new();
    let of = |part: &str, tool: &str, flank: &str| {
        let path = scratch.write("job.toml", &job(part, tool, flank));
        osculate(&["flank", path.to_str().unwrap(), "--json"]).json()
    };
    // Surface (18) with R = 40 at u = 0.4: no such cylinder fits into the hollow.
    let large = "kind = \"cylindrical\"\ndiameter_mm = 80\nlength_mm = 200";
    let short = "at_u = 0.4\nspan_u = [0.3, 0.5]\njudge_u = [0.35, 0.45]\npositions = 21\nspans = 4";
    let v = of("builtin = { kind = \"d98-eq18\" }", large, short);
    let m = method(&v, "standard_b");
    assert!(m["valid"] == false && m["why"].as_str().unwrap().contains("mm"), "{m}");
    for name in ["optimum", "static_minimax"] {
        let m = method(&v, name);
        assert!(m["valid"] == false && m["why"].as_str().unwrap().contains("at most 29.8999 mm does"), "{m}");
    }
    // R = h and alpha = 45 deg: no root.
    let v = of(
        "builtin = { kind = \"d98-hyperbolic\", h_mm = 10, alpha_deg = 45 }",
        CYLINDER,
        "positions = 21\nspans = 4",
    );
    let m = method(&v, "optimum");
    assert!(m["valid"] == false && m["why"].as_str().unwrap().contains("three tangencies"), "{m}");
}

/// `--largest-tool` gives the radius of the closed form, and a cutter of it holds what a larger one does not.
#[test]
fn the_largest_tool_is_that_of_the_closed_form() {
    let scratch = Scratch::new();
    let hyperbolic = "builtin = { kind = \"d98-hyperbolic\", h_mm = 40, alpha_deg = 20 }";
    let path = scratch.write("job.toml", &job(hyperbolic, CYLINDER, ""));
    let run = osculate(&["flank", path.to_str().unwrap(), "--largest-tool", "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let v = run.json();
    let of =
        |name: &str| v["largest"].as_array().unwrap().iter().find(|l| l["name"] == name).unwrap().clone();
    // The end normals of the middle rule enclose twice the 20 degrees: halved between them, or all at one end.
    let radius = of("standard_b")["at_rule"]["radius_mm"].as_f64().unwrap();
    near(&of("standard_b")["at_rule"]["radius_mm"], 0.1 / (1.0 - 20f64.to_radians().cos()), 1e-6);
    near(&of("standard_a")["at_rule"]["radius_mm"], 0.1 / (1.0 - 40f64.to_radians().cos()), 1e-6);
    for (share, valid) in [(0.999, true), (1.001, false)] {
        let tool = format!("kind = \"cylindrical\"\ndiameter_mm = {}\nlength_mm = 200", 2.0 * radius * share);
        let path = scratch.write("job.toml", &job(hyperbolic, &tool, ""));
        let run = osculate(&["flank", path.to_str().unwrap(), "--json"]).json();
        let range = &method(&run, "standard_b")["static_mm"];
        let worst = range["max"].as_f64().unwrap().max(-range["min"].as_f64().unwrap());
        assert_eq!(worst <= 0.1, valid, "{worst} with {share} of {radius}");
    }
    let over = of("static_minimax")["over_span"]["radius_mm"].as_f64().unwrap();
    assert!(over <= of("static_minimax")["at_rule"]["radius_mm"].as_f64().unwrap());
    let both = osculate(&["flank", path.to_str().unwrap(), "--largest-tool", "--out", "x"]);
    assert_eq!(both.code, 2, "a search makes no program");
}
