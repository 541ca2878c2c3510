//! `lines` and `gallery`: files, JSON, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;
use common::{Scratch, osculate};

#[test]
fn figures_and_json_of_a_gallery_surface() {
    let scratch = Scratch::new();
    let run = |name: &str| {
        let out = scratch.path(name);
        let out = out.to_str().unwrap().to_owned();
        osculate(&["lines", "--builtin", "kind = \"m86-3\"", "--out", &out, "--json"]).json()
    };
    let answer = run("a");
    assert_eq!(answer["umbilics"]["points"].as_array().unwrap().len(), 1);
    assert_eq!(answer["umbilics"]["points"][0]["kind"], "lemon");
    assert_eq!(answer["umbilics"]["confirmed"], true);
    assert_eq!(answer["umbilics"]["index_sum"], 0.5);
    let minima = answer["contours"]["minima"].as_array().unwrap();
    assert_eq!(minima.len(), 1);
    // Contours carry their level, and close around the minimum.
    let lowest = &answer["contours"]["lines"][0];
    assert_eq!(lowest["closed"], true);
    for p in lowest["points_mm"].as_array().unwrap() {
        assert!((p[2].as_f64().unwrap() - lowest["level"].as_f64().unwrap()).abs() < 1e-6);
    }
    assert!(!answer["curvature_lines"][0]["lines"].as_array().unwrap().is_empty());
    // Every file is there and is SVG; the same input gives the same bytes.
    let again = run("b");
    assert_eq!(answer, again);
    let files = answer["files"].as_array().unwrap();
    assert_eq!(files.len(), 9);
    for file in files {
        let read = |folder: &str| {
            std::fs::read_to_string(scratch.path(folder).join(file.as_str().unwrap())).unwrap()
        };
        let text = read("a");
        assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n") || text.starts_with("{\"format\":1"));
        assert_eq!(text, read("b"), "{file}");
    }
}

/// A ball leaves the same strip anywhere on a plane: 2 sqrt(2 R h - h^2), h less the least share for the marks of teeth.
#[test]
fn postures_of_a_ball_on_a_plane() {
    let scratch = Scratch::new();
    let out = scratch.path("plane");
    let out = out.to_str().unwrap();
    let plane = "kind = \"plane\", u_range = [0, 20], v_range = [0, 30]";
    let ball = "kind = \"ball\", diameter_mm = 12, length_mm = 60";
    let asked = ["--tool", ball, "--scallop-mm", "0.02", "--feed-mm-min", "500", "--nodes", "3", "--json"];
    let answer = osculate(&[&["lines", "--builtin", plane, "--out", out][..], &asked[..]].concat()).json();
    let all = &answer["postures"];
    assert_eq!(all["count"], serde_json::json!([3, 3]));
    let h = 0.02f64 * (1.0 - 1e-4);
    let width = 2.0 * (2.0 * 6.0 * h - h * h).sqrt();
    for (key, want) in [("width_mm", width), ("area_mm2_min", 500.0 * width)] {
        let values = all[key].as_array().unwrap();
        assert_eq!(values.len(), 9);
        for v in values {
            let got = v.as_f64().unwrap();
            assert!((got - want).abs() < 1e-6 * want, "{key}: {got} for {want}");
        }
    }
    let picture = std::fs::read_to_string(scratch.path("plane").join("h-postures.svg")).unwrap();
    assert!(picture.starts_with("<svg ") && picture.contains("strip width, with the direction of feed"));
}

/// M86, 5.2: a flat end does not get around the minimum of the third surface, and gets everywhere on the one that has none.
#[test]
fn undercut_regions_and_the_axis_without_minima() {
    let scratch = Scratch::new();
    let flat = "kind = \"flat\", diameter_mm = 16, length_mm = 60";
    let run = |kind: &str| {
        let (out, builtin) = (scratch.path(kind), format!("kind = \"{kind}\""));
        let out = out.to_str().unwrap();
        let args = ["lines", "--builtin", &builtin, "--tool", flat, "--nodes", "4", "--out", out, "--json"];
        osculate(&args).json()
    };
    let (plain, hollow) = (run("m86-1"), run("m86-3"));
    assert!(plain["fewest_minima"].is_null());
    let shares = |way: &serde_json::Value| -> Vec<f64> {
        let each = way["shares_percent"].as_array().unwrap().iter();
        each.map(|s| s["percent"].as_f64().unwrap()).collect()
    };
    assert_eq!(shares(&plain["fixed_axis"][0])[0], 100.0);
    assert_eq!(hollow["fewest_minima"]["minima"], 0);
    let ways = hollow["fixed_axis"].as_array().unwrap();
    assert_eq!(ways.len(), 2);
    for (way, minima) in ways.iter().zip([1, 0]) {
        assert_eq!(way["minima"], minima);
        assert!((shares(way).iter().sum::<f64>() - 100.0).abs() < 1e-9);
        let states = way["state"].as_array().unwrap();
        let tight = states.iter().filter(|s| **s == "tight_contour").count();
        assert!(states.len() == 256 && tight > 0 && tight < 20, "{tight}");
        let least = way["relative_min_per_mm"].as_array().unwrap();
        assert!(least.iter().zip(states).all(|(q, s)| q.is_null() == (s != "clear")));
    }
    assert!(shares(&ways[1])[0] > shares(&ways[0])[0]);
    let picture = std::fs::read_to_string(scratch.path("m86-3").join("i-fixed-axis.svg")).unwrap();
    assert!(
        picture.contains("contour line too tight") && picture.contains("held along 0 0 1.000: 1 minimum")
    );
}

#[test]
fn the_gallery_is_listed() {
    let all = osculate(&["gallery", "--json"]).json();
    let names: Vec<&str> = all.as_array().unwrap().iter().map(|e| e["name"].as_str().unwrap()).collect();
    for name in
        ["m86-1", "m86-2", "m86-3", "m86-4", "d98-eq18", "d98-liu", "d98-hyperbolic", "ellipsoid", "enneper"]
    {
        assert!(names.contains(&name), "{name}");
    }
}

#[test]
fn mistakes_are_refused() {
    let scratch = Scratch::new();
    let out = scratch.path("x");
    let out = out.to_str().unwrap();
    for (extra, code, word) in [
        (["--axis", "0,0,0"], 2, "--axis"),
        (["--spacing-mm", "0"], 2, "--spacing-mm"),
        (["--levels", "0"], 2, "--levels"),
        (["--tool", "kind = \"ball\""], 2, "--tool"),
        (["--face", "F9"], 1, "F9"),
    ] {
        let args = ["lines", "--builtin", "kind = \"m86-1\"", "--out", out, extra[0], extra[1]];
        let run = osculate(&args);
        assert_eq!(run.code, code, "{}", run.err);
        assert!(run.err.contains(word), "{}", run.err);
    }
    assert!(!std::path::Path::new(out).exists());
}
