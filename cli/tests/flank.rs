//! `flank`: the table of methods against D98's values, the program against the envelope, and jobs that cannot be.

use crate::common;
use common::{Scratch, osculate};
use osculate_tools::flank::closed::MiddleRule;
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
    assert_eq!(v["methods"].as_array().unwrap().len(), 8);
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
    near(&m["fraction"], 0.25, 0.0);
    // Balanced, on the rule's own points: the paper's 0.585; beside the rule the surface is cut deeper.
    let m = method(&v, "double_point_balanced");
    near(&m["on_rule_mm"]["min"], -0.586_034_1, 1e-7);
    near(&m["on_rule_mm"]["max"], 0.586_034_1, 1e-7);
    near(&m["static_mm"]["min"], -0.6239, 5e-5);
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
        // Every method that stands at the rule is drawn; a cone has no ratio over the radius, and the picture says why.
        let picture = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
        let (profile, ratio) = (picture("profile.svg"), picture("ratio.svg"));
        let drawn = v["profiles"]["methods"].as_array().unwrap();
        assert!(drawn.len() >= if tool == CYLINDER { 8 } else { 3 }, "{part}: {} methods", drawn.len());
        for m in drawn {
            let name = m["name"].as_str().unwrap();
            assert!(profile.contains(&format!("data-curve=\"{name}\"")), "{part}: {name}");
            assert_eq!(
                m["error_mm"].as_array().unwrap().len(),
                v["profiles"]["along_mm"].as_array().unwrap().len()
            );
        }
        assert!(
            profile.contains("along the rule, from the directrix at v = 0, mm")
                && profile.contains("error, mm")
        );
        assert!(profile.contains("tolerance \u{2212}0.1 to 0.1 mm"));
        if tool == CYLINDER {
            // Five lengths and five twists, at most one of which is too large, each panel with the exact curve.
            assert!(
                ratio.matches("data-curve=").count() >= 11 && ratio.contains("radius of the cylinder, mm")
            );
            assert_eq!(ratio.matches("data-curve=\"exact, on this face\"").count(), 2);
        } else {
            assert!(
                v["ratio"].is_null()
                    && ratio.contains("cylinders only")
                    && profile.contains("envelope_minimax:")
            );
        }
    }
}

/// A paraboloid's errors along its middle rule and their ratio over the radius are the closed forms.
#[test]
fn profiles_and_ratios_are_the_closed_forms() {
    let scratch = Scratch::new();
    let run = |h: f64, alpha: f64| {
        let part = format!("builtin = {{ kind = \"d98-hyperbolic\", h_mm = {h}, alpha_deg = {alpha} }}");
        let path = scratch.write("job.toml", &job(&part, CYLINDER, "positions = 11\nspans = 4"));
        osculate(&["flank", path.to_str().unwrap(), "--json"]).json()
    };
    let numbers = |v: &Value| v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
    let v = run(80.0, 30.0);
    let model = |height_mm: f64, half_twist_rad: f64, radius_mm: f64| MiddleRule {
        height_mm,
        half_twist_rad,
        radius_mm,
    };
    let m = model(80.0, 30f64.to_radians(), 10.0);
    let three = m.three_tangent().unwrap();
    let along = numbers(&v["profiles"]["along_mm"]);
    let of = |name: &str| {
        let all = v["profiles"]["methods"].as_array().unwrap();
        numbers(&all.iter().find(|m| m["name"] == name).unwrap()["error_mm"])
    };
    assert!(along[0] == 0.0 && (along[along.len() - 1] - 80.0).abs() < 1e-12);
    for (name, turn_rad) in [("standard_b", 0.0), ("optimum", three.turn_rad)] {
        for (x, error) in along.iter().zip(of(name)) {
            // Rounding of distances of some hundred millimetres.
            let want = m.deviation_mm(turn_rad, (x / 40.0 - 1.0).abs());
            assert!((error - want).abs() < 1e-12, "{name} at {x} mm: {error} {want}");
        }
    }
    // 45 degrees at R/h = 1/4, with three tangencies up to R = h / sqrt(2).
    let v = run(40.0, 45.0);
    let ratio = &v["ratio"];
    near(&ratio["own"]["closed"], 18.524, 5e-4);
    near(&ratio["own"]["exact"], 18.524, 5e-4);
    near(&ratio["own"]["difference_percent"], 0.0, 1e-6);
    for kind in ["closed", "exact"] {
        // Both roots meet there, where Newton's method gives up a little before.
        near(&ratio[kind]["ends_at_mm"], 40.0 / 2f64.sqrt(), 1e-3);
        assert!(ratio[kind]["ends_by"].as_str().unwrap().contains("three tangencies"), "{ratio}");
    }
    for (key, count) in [("lengths", 5), ("twists", 4)] {
        let curves = ratio[key].as_array().unwrap();
        assert_eq!(curves.len(), count, "{key}: twice 45 degrees is left out");
        for c in curves {
            let (h, half) =
                (c["rule_mm"].as_f64().unwrap(), c["half_twist_deg"].as_f64().unwrap().to_radians());
            for (r, got) in numbers(&c["radius_mm"]).iter().zip(numbers(&c["ratio"])) {
                let m = model(h, half, *r);
                let want = m.standard_depth_mm() / m.three_tangent().unwrap().depth_mm;
                assert!((got - want).abs() < 1e-9 * want, "{key}: {h} {half} {r}: {got} {want}");
            }
        }
    }
}

/// Positions from end to end of Liu's surface leave its end untouched; the span that is proposed does not.
#[test]
fn a_span_is_proposed_that_leaves_less() {
    let scratch = Scratch::new();
    let run = |span: &str| {
        let flank = format!("at_u = 21.892\npositions = 61\nspans = 6\n{span}");
        let path = scratch.write("job.toml", &job(LIU, CYLINDER, &flank));
        osculate(&["flank", path.to_str().unwrap(), "--json"]).json()
    };
    let v = run("");
    near(&method(&v, "optimum")["envelope_mm"]["max"], 0.3468, 1e-3);
    let span = &v["proposed_span_u"];
    assert!(
        v["diagnostics"].to_string().contains(&format!("span_u = [0, {}]", span[1])),
        "{}",
        v["diagnostics"]
    );
    let again = run(&format!("span_u = {span}"));
    let m = &method(&again, "optimum")["envelope_mm"];
    near(&m["max"], 0.1432, 1e-3);
    assert!(m["min"].as_f64().unwrap() > -0.2854 && again["proposed_span_u"].is_null(), "{again}");
}

/// Surface (18) begins with a directrix in the root of u: no setting stands at that rule, the motions pass it.
#[test]
fn a_rule_without_derivatives_is_passed() {
    let scratch = Scratch::new();
    let flank = "at_u = 0\nspan_u = [0, 0.1]\njudge_u = [0, 0.1]\npositions = 21\nspans = 4";
    let tool = "kind = \"cylindrical\"\ndiameter_mm = 6\nlength_mm = 200";
    let path = scratch.write("job.toml", &job("builtin = { kind = \"d98-eq18\" }", tool, flank));
    let run = osculate(&["flank", path.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let v = run.json();
    assert!(v["normals_angle_deg"].is_null() && v["rule_length_mm"].as_f64().unwrap() > 100.0);
    for name in ["standard_a", "standard_b", "double_point_balanced", "optimum", "static_minimax"] {
        let m = method(&v, name);
        assert!(m["why"].as_str().unwrap().contains("no finite derivatives at u = 0"), "{m}");
        assert!(m["envelope_mm"]["min"].is_f64(), "{m}");
    }
    for name in ["envelope_rms", "envelope_minimax"] {
        let m = method(&v, name);
        assert!(m["valid"] == true && m["envelope_mm"]["max"].is_f64(), "{m}");
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
    assert!(v["ratio"].is_null() && v["diagnostics"].to_string().contains("no setting deviates"));
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
    // The ratio ends there, and the closed form of straight directrices goes on.
    let (own, exact) = (&v["ratio"]["own"], &v["ratio"]["exact"]);
    near(&exact["ends_at_mm"], 29.8999, 1e-3);
    assert!(exact["ends_by"].as_str().unwrap().contains("29.8999 mm fits into the hollow"), "{exact}");
    assert!(own["exact"].is_null() && own["difference_percent"].is_null() && own["closed"].is_f64(), "{own}");
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
