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

/// A job of one contact on a builtin part.
fn contact(scratch: &Scratch, part: &str, tool: &str, rest: &str) -> serde_json::Value {
    let text = format!(
        "format = 1\n[part]\nbuiltin = {{ {part} }}\n[tool]\n{tool}\n[tolerance]\nscallop_mm = 0.01\n{rest}"
    );
    let path = scratch.write("job.toml", &text);
    osculate(&["strip", "--json", path.to_str().unwrap()]).json()
}

fn at(answer: &serde_json::Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(answer, |a, k| &a[*k]);
    found.as_f64().unwrap_or_else(|| panic!("{keys:?}: {answer}"))
}

/// Along a shaft a ball finishes its strip times the feed, and of a layer S the part that is longer outside: S + S^2 / (2 R). On a plane
/// its ball takes the segment of its circle, half of its teeth at a time.
#[test]
fn the_instant_has_closed_forms() {
    let scratch = Scratch::new();
    let ball = "kind = \"ball\"\ndiameter_mm = 10\nteeth = 4";
    let layer = "[cutting]\nfeed_mm_min = 600\n[stock]\nallowance_mm = 2\n";
    let shaft = "kind = \"cylinder\", radius_mm = 20, height_mm = 60";
    let along = format!("{layer}[contact]\nat = [1, 30]\nalong = \"v\"\n");
    let answer = contact(&scratch, shaft, ball, &along);
    let (instant, width) = (&answer["instant"], at(&answer, &["exact", "width_mm"]));
    assert!((at(instant, &["area_mm2_min"]) / (600.0 * width) - 1.0).abs() < 1e-7, "{answer}");
    let tube = 2.0 + 2.0 * 2.0 / 40.0;
    assert!((at(instant, &["layer_mm3_min"]) / (600.0 * width * tube) - 1.0).abs() < 1e-7, "{answer}");
    // Across the feed the shaft is round, along it straight: the indicatrix is two lines.
    assert_eq!(answer["dupin_part"], "parallel_lines");
    assert!((at(&answer, &["across_feed", "part_per_mm"]) - 0.05).abs() < 1e-12);
    assert!(at(&answer, &["along_feed", "part_per_mm"]).abs() < 1e-12);

    let plane = "kind = \"plane\", half_size_mm = 30";
    let answer = contact(&scratch, plane, ball, &format!("{layer}[contact]\nat = [0, 0]\nalong = \"u\"\n"));
    let engaged = &answer["instant"]["engagement"];
    let section = 25.0 * (3.0f64 / 5.0).acos() - 3.0 * 4.0;
    assert!((at(engaged, &["mm3_min"]) / (600.0 * section) - 1.0).abs() < 2e-3, "{answer}");
    assert!((at(engaged, &["arc_deg"]) - 180.0).abs() < 2.5, "{answer}");
    let teeth = &engaged["teeth"];
    assert_eq!(teeth["in_cut"], serde_json::json!([2, 2]), "{answer}");
    // Two of four edges, a right angle apart, over their mean of 2 / pi each: pi / 4 to pi sqrt 2 / 4 of the whole.
    let of_mean = |k: usize| teeth["mm3_min"][k].as_f64().unwrap() / at(engaged, &["mm3_min"]);
    let quarter = std::f64::consts::FRAC_PI_4;
    assert!(
        (of_mean(0) - quarter).abs() < 0.02 && (of_mean(1) - quarter * 2f64.sqrt()).abs() < 0.01,
        "{answer}"
    );
    assert!(
        (at(teeth, &["one_most_mm3_min"]) / at(engaged, &["mm3_min"]) - quarter).abs() < 0.01,
        "{answer}"
    );
}

/// Without a cap marks and strips share the tolerance evenly, and the printed leading order is right; a cap leaves marks no more than it
/// needs. The mark beside its closed forms.
#[test]
fn the_tolerance_is_shared() {
    let scratch = Scratch::new();
    let ball = "kind = \"ball\"\ndiameter_mm = 10\nteeth = 2";
    let plane = "kind = \"plane\", half_size_mm = 30";
    let place = "[contact]\nat = [0, 0]\nalong = \"u\"\n";
    let free = contact(&scratch, plane, ball, place);
    let best = &free["sharing"]["best"];
    assert!((at(best, &["chi"]) - 0.5).abs() < 1e-3 && best["capped"] == false, "{free}");
    assert!(best["area_mm2_min"].is_null() && free["sharing"]["cap"].is_null(), "{free}");
    // 8 sqrt(h_L h_C) / q, the ball's q being 1/5.
    assert!((at(best, &["leading_area_per_tooth_mm2"]) - 8.0 * 0.005 * 5.0).abs() < 1e-6, "{free}");
    assert!((at(best, &["area_per_tooth_mm2"]) / 0.2 - 1.0).abs() < 1e-3, "{free}");
    let exact = 2.0 * (0.01f64 * (10.0 - 0.01)).sqrt();
    assert!((at(&free, &["feed_per_tooth", "exact_mm"]) - exact).abs() < 1e-8, "{free}");
    for (form, within) in [("r97_41", 1e-8), ("r97_42", 1e-8), ("r97_44", 1e-3), ("leading_order", 1e-3)] {
        let width = at(&free, &["feed_per_tooth", "closed_forms", form, "width_mm"]);
        assert!((width / exact - 1.0).abs() < within, "{form}: {width} {exact}");
    }
    let (chi, area) = (&free["sharing"]["chi"], &free["sharing"]["area_per_tooth_mm2"]);
    assert!(
        chi.as_array().unwrap().len() == area.as_array().unwrap().len()
            && !chi.as_array().unwrap().is_empty()
    );
    for a in area.as_array().unwrap() {
        assert!(a.as_f64().unwrap() <= at(best, &["area_per_tooth_mm2"]) * (1.0 + 1e-9));
    }
    // 0.1 mm a tooth is the mark of 0.00025 mm: a fortieth of the tolerance.
    let caps = "[cutting]\nspindle_rpm = 10000\nfeed_mm_min = 9000\nfeed_per_tooth_mm = 0.1\n";
    let capped = contact(&scratch, plane, ball, &format!("{caps}{place}"));
    let best = &capped["sharing"]["best"];
    assert_eq!((&best["capped"], &capped["sharing"]["cap"]["by"]), (&true.into(), &"feed_per_tooth".into()));
    assert!((at(best, &["chi"]) - 0.025).abs() < 1e-4, "{capped}");
    assert!((at(best, &["area_mm2_min"]) - 2e4 * 0.1 * at(best, &["strip_mm"])).abs() < 1e-6, "{capped}");
}

/// Radii in directions are Euler's, Dupin's indicatrices have the shapes of the book, and the picture shows what there is.
#[test]
fn indicatrices_are_drawn() {
    let scratch = Scratch::new();
    let torus = |v: f64| {
        let tool = "kind = \"toroidal\"\ndiameter_mm = 10\ncorner_radius_mm = 2";
        let part = "kind = \"torus\", major_radius_mm = 200, minor_radius_mm = 60";
        let rest = format!("[strategy]\nlead_deg = 30\n[contact]\nat = [0.5, {v}]\nangle_deg = 30\n");
        contact(&scratch, part, tool, &rest)
    };
    let (outside, inside) = (torus(0.0), torus(std::f64::consts::PI));
    assert_eq!((&outside["dupin_part"], &inside["dupin_part"]), (&"ellipse".into(), &"hyperbolas".into()));
    assert_eq!(outside["dupin_tool"], "ellipse");
    // On the outer equator 1/260 along u and 1/60 along v; 30 degrees from u, and 30 degrees from v.
    let euler = |a: f64, b: f64| 0.75 * a + 0.25 * b;
    let (u, v) = (1.0 / 260.0, 1.0 / 60.0);
    assert!((at(&outside, &["along_feed", "part_per_mm"]) - euler(u, v)).abs() < 1e-12, "{outside}");
    assert!((at(&outside, &["across_feed", "part_per_mm"]) - euler(v, u)).abs() < 1e-12, "{outside}");
    // The tool: 1/2 along the feed, sin 30 / (3 + 2 sin 30) across it.
    assert!((at(&outside, &["along_feed", "tool_per_mm"]) - 0.5).abs() < 1e-12, "{outside}");
    assert!((at(&outside, &["across_feed", "tool_per_mm"]) - 0.125).abs() < 1e-12, "{outside}");
    let root = |answer: &serde_json::Value, key: &str, deg: usize| {
        let k = answer["angle_deg"].as_array().unwrap().iter().position(|a| a.as_f64() == Some(deg as f64));
        answer[key][k.unwrap()].as_f64()
    };
    assert!((root(&outside, "dupin_part_root_mm", 90).unwrap() - 60f64.sqrt()).abs() < 1e-9);
    assert!((root(&outside, "dupin_tool_root_mm", 30).unwrap() - 2f64.sqrt()).abs() < 1e-9);
    let both = root(&outside, "conformity_root_mm", 30).unwrap();
    assert!((both - 2f64.sqrt() - 1.0 / euler(u, v).sqrt()).abs() < 1e-9);
    assert!(root(&inside, "dupin_part_root_mm", 0).unwrap() < 0.0, "hollow along u: {inside}");

    let text = "format = 1\n[part]\nbuiltin = { kind = \"plane\", half_size_mm = 9 }\n[tool]\nkind = \"flat\"\n\
                diameter_mm = 6\n[tolerance]\nscallop_mm = 0.01\n[strategy]\nlead_deg = 5\n[contact]\n\
                at = [0, 0]\nalong = \"u\"\n";
    let (job, out) = (scratch.write("job.toml", text), scratch.path("out"));
    let run = osculate(&["strip", job.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.err);
    let svg = std::fs::read_to_string(out.join("strip.svg")).unwrap();
    for word in ["part flat: none", "tool edge: none", "indicatrix of conformity", "share of the tolerance"] {
        assert!(svg.contains(word), "{word}");
    }
    let told: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("strip.json")).unwrap()).unwrap();
    assert!(told["claimed_direction_deg"].is_null() && told["along_feed"]["tool_per_mm"].is_null(), "{told}");
}
