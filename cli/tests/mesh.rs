//! Parts that are meshes: held against paths of any origin, as text and binary, in other units, moved, and where they are refused.

use crate::common;
use common::{Run, Scratch, osculate};
use std::fmt::Write as _;

const TABLES: &str = r#"[tool]
kind = "ball"
diameter_mm = 8
length_mm = 30
teeth = 2
[tolerance]
scallop_mm = 0.02
gouge_mm = 0.01
[cutting]
feed_mm_min = 1000
[verification]
spacing_mm = 0.15
"#;

/// What a ball of radius 4 leaves of the paraboloid between passes 0.5 mm apart, mm.
const CREST: f64 = 0.00787;

type Triangle = [[f64; 3]; 3];

/// A raster of the paraboloid z = (x^2 + y^2) / 1000 with a ball of radius 4, upright; of the plane z = 0 where `flat`.
fn raster(flat: bool) -> String {
    let mut text =
        "UNITS/MM\nCUTTER/8, 4, 0, 0, 0, 0, 30\nRAPID\nGOTO/0,0,40,0,0,1\nFEDRAT/1000,MMPM\n".to_owned();
    for i in 0..=28usize {
        for k in 0..=40usize {
            let (x, y) =
                (0.35 * (if i % 2 == 0 { k as f64 } else { 40.0 - k as f64 }) - 7.0, 0.5 * i as f64 - 7.0);
            let n = if flat { [0.0, 0.0, 1.0] } else { [-0.002 * x, -0.002 * y, 1.0] };
            let length = (n[0] * n[0] + n[1] * n[1] + 1.0).sqrt();
            let z = if flat { 0.0 } else { 0.001 * (x * x + y * y) };
            let c = [0, 1, 2].map(|j| [x, y, z][j] + 4.0 * n[j] / length);
            writeln!(text, "GOTO/{:.6},{:.6},{:.6},0,0,1", c[0], c[1], c[2] - 4.0)
                .expect("a string takes all");
        }
    }
    text + "FINI\n"
}

/// The paraboloid over 12 x 12 mm as triangles, so much higher.
fn paraboloid(up: f64) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let [x, y] = [i, j].map(|k| 0.5 * k as f64 - 6.0);
        [x, y, 0.001 * (x * x + y * y) + up]
    };
    let cells = (0..24).flat_map(|i| (0..24).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect()
}

/// A block of 12 x 12 x 5 mm below z = 0.
fn block() -> Vec<Triangle> {
    let p = |k: usize| {
        [
            if k & 1 == 0 { -6.0 } else { 6.0 },
            if k & 2 == 0 { -6.0 } else { 6.0 },
            if k & 4 == 0 { -5.0 } else { 0.0 },
        ]
    };
    let sides = [[4, 5, 7, 6], [0, 2, 3, 1], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    sides.iter().flat_map(|s| [[p(s[0]), p(s[1]), p(s[2])], [p(s[0]), p(s[2]), p(s[3])]]).collect()
}

fn stl(triangles: &[Triangle]) -> String {
    let mut text = "solid part\n".to_owned();
    for t in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in t {
            writeln!(text, "vertex {x:e} {y:e} {z:e}").expect("a string takes all");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid part\n"
}

fn binary(triangles: &[Triangle]) -> Vec<u8> {
    let mut out = vec![b' '; 80];
    out.extend((triangles.len() as u32).to_le_bytes());
    for t in triangles {
        out.extend([0; 12]);
        t.iter().flatten().for_each(|x| out.extend((*x as f32).to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

fn ply(triangles: &[Triangle], scale: f64) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        3 * triangles.len(),
        triangles.len()
    );
    for [x, y, z] in triangles.iter().flatten().map(|p| p.map(|x| x * scale)) {
        writeln!(text, "{x:e} {y:e} {z:e}").expect("a string takes all");
    }
    for k in (0..triangles.len()).map(|k| 3 * k) {
        writeln!(text, "3 {k} {} {}", k + 1, k + 2).expect("a string takes all");
    }
    text
}

/// Holds a path against a part.
fn verify(scratch: &Scratch, part: &str, more: &str, flat: bool) -> Run {
    let cl = scratch.write("path.cl", &raster(flat));
    let job = scratch.write("job.toml", &format!("format = 1\n[part]\n{part}\n{TABLES}{more}"));
    osculate(&[
        "verify",
        cl.to_str().expect("a path in Unicode"),
        "--job",
        job.to_str().expect("a path in Unicode"),
        "--json",
    ])
}

#[test]
fn a_mesh_is_judged_as_the_surface_that_it_stands_for() {
    let scratch = Scratch::new();
    scratch.write("text.stl", &stl(&paraboloid(0.0)));
    std::fs::write(scratch.path("binary.stl"), binary(&paraboloid(0.0))).unwrap();
    scratch.write("inch.ply", &ply(&paraboloid(0.0), 1.0 / 25.4));
    let figure = |v: &serde_json::Value, key: &str| v[key].as_f64().unwrap();
    // Triangles of half a millimetre stand off the paraboloid by .002 / 8 (.5^2 + .5^2) at most, along the diagonal.
    let chord = 0.002 / 8.0 * 0.5;
    for part in ["file = \"text.stl\"", "file = \"binary.stl\"", "file = \"inch.ply\"\nunit_mm = 25.4"] {
        let run = verify(&scratch, part, "", false);
        let v = run.json();
        assert!(run.code == 0 && v["verdict"]["answer"] == "held", "{v}");
        // 0.25^2 / 2 (1/4 + 1/500) on the crest; samples 0.15 mm apart are 0.05 mm off it, or less, which is a third of that.
        let seen = figure(&v, "scallop_max_mm");
        assert!(seen < CREST + chord + 1e-4 && seen > 0.6 * CREST, "{seen}");
        assert!(figure(&v, "gouge_max_mm") < chord + 1e-6 && figure(&v, "uncut_area_mm2") == 0.0);
        let mesh = v["verdict"]["scope"]["mesh"].as_str().unwrap();
        assert!(mesh.contains("1152 triangles") && mesh.contains("NOT known"), "{mesh}");
    }
    // A tenth of a millimetre up or down is seen as that.
    scratch.write("up.stl", &stl(&paraboloid(0.1)));
    let up = verify(&scratch, "file = \"up.stl\"", "", false);
    assert!(up.code == 1 && up.json()["verdict"]["answer"] == "not_held");
    assert!((figure(&up.json(), "gouge_max_mm") - 0.1).abs() < chord + 1e-4);
    scratch.write("down.stl", &stl(&paraboloid(-0.05)));
    let down = verify(&scratch, "file = \"down.stl\"", "", false).json();
    let seen = figure(&down, "scallop_max_mm") - 0.05;
    assert!(seen < CREST + chord + 1e-4 && seen > 0.6 * CREST, "{seen}");
}

#[test]
fn other_faces_of_a_mesh_are_checked_and_its_file_serves_as_fixture() {
    let scratch = Scratch::new();
    scratch.write("block.stl", &stl(&block()));
    let one = verify(&scratch, "file = \"block.stl\"\nfaces = [\"F1\"]", "", true);
    let v = one.json();
    // A ball of radius 4 at 0.5 mm: 0.25^2 / 8.
    assert!(one.code == 0 && (v["scallop_max_mm"].as_f64().unwrap() - 0.00782).abs() < 1e-4, "{v}");
    assert!(v["verdict"]["scope"]["other_faces"].as_str().unwrap().starts_with("F2"));
    // Its sides and its bottom are not cut by this path.
    let all = verify(&scratch, "file = \"block.stl\"", "", true);
    assert!(all.code == 1 && all.json()["uncut_area_mm2"].as_f64().unwrap() > 300.0);
    // The ball comes down to z = 0: a fixture at 1 mm beside the top is met, one below it is not.
    for (up, code) in [(1.0, 1), (-0.5, 0)] {
        let place = |p: [f64; 3]| [p[0] * 0.1, p[1] * 0.1 + 6.7, p[2] * 0.1 + up];
        scratch.write("clamp.ply", &ply(&block().iter().map(|t| t.map(place)).collect::<Vec<_>>(), 1.0));
        let part = "file = \"block.stl\"\nfaces = [\"F1\"]";
        let run = verify(&scratch, part, "[fixture]\nfiles = [\"clamp.ply\"]\n", true);
        assert_eq!(run.code, code, "{}", run.out);
    }
    // As raw material: 4 mm higher than the part.
    let higher = |p: [f64; 3]| [p[0], p[1], if p[2] < -1.0 { p[2] } else { 4.0 }];
    scratch.write("raw.ply", &ply(&block().iter().map(|t| t.map(higher)).collect::<Vec<_>>(), 1.0));
    let part = "file = \"block.stl\"\nfaces = [\"F1\"]";
    let cut = verify(&scratch, part, "[stock]\nfile = \"raw.ply\"\ncell_mm = 0.3\n", true).json();
    let removed = cut["stock"]["removed_mm3"].as_f64().unwrap();
    assert!((removed - 12.0 * 12.0 * 4.0).abs() < 5.0, "{removed}");
}

#[test]
fn what_a_mesh_does_not_allow_is_said() {
    let scratch = Scratch::new();
    let part = scratch.write("block.stl", &stl(&block()));
    let part = part.to_str().unwrap();
    let run = osculate(&["inspect", part, "--json"]);
    let v = run.json();
    assert!(run.code == 0 && v["format"] == "stl" && v["faces"].as_array().unwrap().len() == 6, "{v}");
    assert!((v["area_mm2"].as_f64().unwrap() - 528.0).abs() < 1e-9);
    assert_eq!(v["bbox_mm"], serde_json::json!([-6.0, -6.0, -5.0, 6.0, 6.0, 0.0]));
    assert!(v["diagnostics"][0].as_str().unwrap().contains("held against programs"));
    let job = scratch.write("job.toml", &format!("format = 1\n[part]\nfile = \"block.stl\"\n{TABLES}"));
    let job = job.to_str().unwrap();
    let out = scratch.path("out");
    let out = out.to_str().unwrap();
    for args in [
        &["plan", job, "--out", out][..],
        &["compare", job],
        &["axes", job],
        &["check", job],
        &["init", part, "--out", out],
        &["lines", part, "--face", "F1", "--out", out],
        &["export", part, "--out", "x.step"],
    ] {
        osculate(args).refused(&["mesh", "STEP or IGES"]);
    }
    // Damage is told as what it is.
    let text = stl(&block());
    scratch.write("block.stl", &text[..text.len() / 2]);
    osculate(&["inspect", part]).refused(&["STL"]);
    scratch.write("block.stl", "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n");
    osculate(&["inspect", part]).refused(&["PLY", "no vertex"]);
}

/// A block of which a damage has put a corner far away: it is shown, and refused for work.
#[test]
fn what_lies_farther_than_any_part_is_refused() {
    let scratch = Scratch::new();
    let near = stl(&block());
    let far = near.replacen("6e0", "6e9", 1);
    assert_ne!(near, far);
    let part = scratch.write("far.stl", &far);
    let run = osculate(&["inspect", part.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 1);
    assert!(run.json()["error"]["what"].as_str().unwrap().contains("no part is"), "{}", run.out);
    verify(&scratch, "file = \"far.stl\"", "", true).refused(&["F1", "numbers of the file are damaged"]);
}
