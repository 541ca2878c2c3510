//! `verify` with raw material, fixtures, a picture of the cut surface, and paths that do not belong to the job.

use crate::common;
use common::{Scratch, osculate};
use std::fmt::Write as _;

const JOB: &str = r#"format = 1
[part]
builtin = { kind = "paraboloid", a_per_mm = 0.001, b_per_mm = 0.001, half_size_mm = 6 }
[tool]
kind = "ball"
diameter_mm = 8
length_mm = 30
flute_length_mm = 12
[tolerance]
scallop_mm = 0.02
gouge_mm = 0.01
[cutting]
feed_mm_min = 1000
[verification]
spacing_mm = 0.08
"#;

/// A raster of the paraboloid z = (x^2 + y^2) / 1000 with a ball of radius 4, upright; `at` may move a tip.
fn raster(scale: f64, at: impl Fn(usize, usize, [f64; 3]) -> [f64; 3]) -> String {
    let mut text = format!(
        "PARTNO/RASTER\nUNITS/MM\nCUTTER/{}, {}, 0, 0, 0, 0, 30\nRAPID\nGOTO/0,0,40,0,0,1\nFEDRAT/1000,MMPM\n",
        8.0, 4.0
    );
    for i in 0..=28usize {
        for k in 0..=40usize {
            let (x, y) =
                (0.35 * (if i % 2 == 0 { k as f64 } else { 40.0 - k as f64 }) - 7.0, 0.5 * i as f64 - 7.0);
            let n = [-0.002 * x, -0.002 * y, 1.0];
            let length = (n[0] * n[0] + n[1] * n[1] + 1.0).sqrt();
            let c = [0, 1, 2].map(|j| [x, y, 0.001 * (x * x + y * y)][j] + 4.0 * n[j] / length);
            let p = at(i, k, [c[0], c[1], c[2] - 4.0]).map(|v| v * scale);
            writeln!(text, "GOTO/{:.6},{:.6},{:.6},0,0,1", p[0], p[1], p[2]).expect("a string takes all");
        }
    }
    text + "FINI\n"
}

#[test]
fn stock_collisions_and_the_cut_surface() {
    let scratch = Scratch::new();
    let cl = scratch.write("good.cl", &raster(1.0, |_, _, p| p));
    let run = |extra: &str, more: &[&str]| {
        let job = scratch.write("job.toml", &format!("{JOB}{extra}"));
        let mut args = vec!["verify", cl.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"];
        args.extend(more);
        osculate(&args)
    };
    let ply = scratch.path("cut.ply");
    let plain = run("", &["--ply", ply.to_str().unwrap()]);
    let v = plain.json();
    assert!(plain.code == 0 && v["within_tolerance"] == true && v["stock"].is_null(), "{v}");
    assert!(v["smallest_radius_mm"].as_f64().unwrap() > 490.0);
    // The ball's raster of 0.5 mm leaves 0.25^2 / 2 (1/4 + 1/500): what may hide is of the order of a tenth of it.
    let (seen, more) = (v["scallop_max_mm"].as_f64().unwrap(), v["hidden_scallop_mm"].as_f64().unwrap());
    assert!((seen - 0.00787).abs() < 5e-4 && more < 2e-3, "{seen} {more}");
    assert!(v["certain"] == true);
    let bytes = std::fs::read(&ply).unwrap();
    let header = String::from_utf8_lossy(&bytes[..300]).into_owned();
    let count = |what: &str| -> usize {
        let rest = header.split(&format!("element {what} ")).nth(1).unwrap();
        rest.split('\n').next().unwrap().parse().unwrap()
    };
    let body = bytes.len() - header.find("end_header\n").unwrap() - "end_header\n".len();
    assert_eq!(body, 19 * count("vertex") + 13 * count("face"));
    assert!(count("face") > 100);
    // A block of 12 x 12 and 3 mm above the middle of the part: about 12 * 12 * 3 less the part's own rise are taken.
    let stock = run("[stock]\nbox_mm = [-6, -6, -5, 6, 6, 3]\ncell_mm = 0.15\n", &[]).json();
    let s = &stock["stock"];
    let taken = s["removed_mm3"].as_f64().unwrap();
    // The integral of the paraboloid is 12 * 12 * 6^2 * 2 / 3 / 1000 = 3.456; the mean standoff adds 0.4.
    assert!((taken - (432.0 - 3.456 - 0.4)).abs() < 1.0, "{s}");
    assert!(
        s["collisions"].as_array().unwrap().is_empty() && s["most"][0]["volume_mm3"].as_f64().unwrap() > 1.0
    );
    assert!(stock["within_tolerance"] == true);
    // Every block with what it took.
    let csv = scratch.path("blocks.csv");
    let with =
        run("[stock]\nbox_mm = [-6, -6, -5, 6, 6, 3]\ncell_mm = 0.3\n", &["--blocks", csv.to_str().unwrap()]);
    let v = with.json();
    let lines = std::fs::read_to_string(&csv).unwrap();
    let volume: f64 =
        lines.lines().skip(1).map(|l| l.split(',').nth(1).unwrap().parse::<f64>().unwrap()).sum();
    let whole = v["stock"]["removed_mm3"].as_f64().unwrap();
    assert!((volume - whole).abs() < 1e-3 && lines.lines().count() > 100, "{volume} {whole}");
    let area: f64 = v["histogram"].as_array().unwrap().iter().map(|b| b["area_mm2"].as_f64().unwrap()).sum();
    assert!((area - 144.0).abs() < 0.05 && v["confidence"].as_str().unwrap().contains("may be"), "{v}");
    run("", &["--blocks", csv.to_str().unwrap()]).refused(&["--blocks", "[stock]"]);
    // Taller than the flutes: the shank runs into it, and that is not within tolerance.
    let tall = run("[stock]\nbox_mm = [-20, -20, -5, 20, 20, 14]\ncell_mm = 0.5\n", &[]);
    let v = tall.json();
    assert!(tall.code == 1 && v["within_tolerance"] == false);
    assert!(v["stock"]["collisions"].as_array().unwrap().iter().any(|c| c["body"] == "shank"), "{v}");
    // Little memory makes it coarser, which is said.
    let coarse = run("[stock]\nallowance_mm = 1\ncell_mm = 0.001\nmemory_mb = 2\n", &[]).json();
    let notes = coarse["diagnostics"].to_string();
    assert!(notes.contains("memory_mb") && coarse["stock"]["cell_mm"].as_f64().unwrap() > 0.05, "{notes}");
    // Raw material that is too small, as a mesh in inches would be.
    let small = run("[stock]\nbox_mm = [-0.25, -0.25, -0.2, 0.25, 0.25, 0.1]\n", &[]).json();
    let notes = small["diagnostics"].to_string();
    assert!(notes.contains("does not hold the part") && notes.contains("inches"), "{notes}");
    // A clamp in the way of the passes, and what a job may get wrong.
    let clamp = "solid c\nfacet normal 0 0 1\nouter loop\nvertex -9 -1 0.5\nvertex -6 -1 0.5\nvertex -6 2 0.5\nendloop\nendfacet\nendsolid\n";
    scratch.write("clamp.stl", clamp);
    let hit = run("[fixture]\nfiles = [\"clamp.stl\"]\n", &[]);
    let v = hit.json();
    assert!(hit.code == 1 && v["worst"].as_array().unwrap().iter().any(|w| w["face"] == "fixture"), "{v}");
    run("[fixture]\nfiles = [\"none.stl\"]\n", &[]).refused(&["none.stl"]);
    run("[stock]\n", &[]).refused(&["[stock]", "box_mm"]);
    run("[stock]\nbox_mm = [0, 0, 0, 1, 1, 0]\n", &[]).refused(&["[stock]", "no volume"]);
    run("[stock]\nfile = \"clamp.stl\"\n", &[]).refused(&["[stock]"]);
}

#[test]
fn paths_of_another_unit_or_tool() {
    let scratch = Scratch::new();
    let job = scratch.write("job.toml", JOB);
    let verify = |text: &str| {
        let cl = scratch.write("p.cl", text);
        osculate(&["verify", cl.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"])
    };
    // A part and a path that meet only after scaling: the path is far off to make that so.
    let far = |_: usize, _: usize, p: [f64; 3]| [p[0] + 10.0, p[1], p[2]];
    let text = raster(25.4, far).replace("GOTO/0,0,40,", "GOTO/254,0,400,");
    verify(&text).refused(&["do not meet", "25.4"]);
    // One around the part that is much larger is verified, and told.
    let around = verify(&raster(25.4, |_, _, p| p)).json();
    assert!(around["diagnostics"].to_string().contains("times the size of the part"), "{around}");
    // Another cutter in the CL data is said.
    let other = raster(1.0, |_, _, p| p).replace("CUTTER/8, 4", "CUTTER/6, 3");
    assert!(verify(&other).json()["diagnostics"].to_string().contains("another cutter"));
    // A gouge is found at its move: point (14, 20), the 14 * 41 + 20 + 1st after the rapid.
    let bad = raster(1.0, |i, k, p| if (i, k) == (14, 20) { [p[0], p[1], p[2] - 0.05] } else { p });
    let run = verify(&bad);
    let v = run.json();
    let worst = &v["worst"][0];
    assert!(run.code == 1 && worst["kind"] == "gouge", "{v}");
    assert!((worst["value_mm"].as_f64().unwrap() - 0.05).abs() < 0.0025, "{worst}");
    let block = worst["block"].as_u64().unwrap();
    assert!((594..=597).contains(&block), "{worst}");
}
