//! Raw material that one job has left and another goes on with: the same as in one list, with fixtures of its own, and what is refused.

use crate::common;
use common::{Run, Scratch, osculate};
use serde_json::{Value, json};

const HALF_MM: f64 = 6.0;
/// A plate between two faces; the raw material goes beyond both.
const THICK_MM: f64 = 5.0;

/// Both faces of the plate as the JSON of faces, the lower one turned.
fn plate(thick_mm: f64) -> String {
    let face = |id: &str, z: f64, out: f64| {
        let pole = |x: f64, y: f64| json!([x * out, y, z]);
        json!({ "id": id, "kind": "bspline", "oriented": true, "side": "along", "surface": { "nurbs": {
            "degree": [1, 1], "knots": [[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0]],
            "poles_mm": [[pole(-HALF_MM, -HALF_MM), pole(-HALF_MM, HALF_MM)], [pole(HALF_MM, -HALF_MM), pole(HALF_MM, HALF_MM)]],
            "weights": [[1.0, 1.0], [1.0, 1.0]], "side": "along" } } })
    };
    json!({ "format": 1, "faces": [face("top", 0.0, 1.0), face("bottom", -thick_mm, -1.0)] }).to_string()
}

const BLOCK: &str = "[stock]\nbox_mm = [-6, -6, -6, 6, 6, 1.5]\ncell_mm = 0.25\n";
const ROUGH: &str =
    "[[operation]]\nname = \"rough\"\nkind = \"rough\"\ntools = [4]\nallowance_mm = 0.4\nfaces = [\"top\"]\n";
const FINISH: &str = "[[operation]]\nname = \"finish\"\nkind = \"finish\"\ntools = [7]\nfaces = [\"top\"]\nstrategy = { kind = \"isoplanar_3c\" }\n";
const OTHER_SIDE: &str = "[[setup]]\nname = \"op20\"\nrotate_deg = [180, 0, 0]\n";
const BENEATH: &str = "[[operation]]\nname = \"beneath\"\nkind = \"finish\"\ntools = [7]\nsetup = \"op20\"\nfaces = [\"bottom\"]\n\
    strategy = { kind = \"isoplanar_3c\", axis = [0, 0, -1] }\n";

/// A list of operations on faces of the plate, from raw material.
fn list(faces: &str, stock: &str, more: &str) -> String {
    format!(
        "format = 2\n[part]\nfile = \"plate.json\"\nfaces = {faces}\n{stock}\
         [tolerance]\nscallop_mm = 0.04\ngouge_mm = 0.02\n[verification]\nspacing_mm = 0.15\naccept = \"samples\"\n\
         [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n\
         [[tool]]\nnumber = 4\nkind = \"flat\"\ndiameter_mm = 6\nlength_mm = 30\nteeth = 2\n\
         cutting = {{ spindle_rpm = 6000, feed_mm_min = 900 }}\n\
         [[tool]]\nnumber = 7\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\nteeth = 2\n\
         cutting = {{ spindle_rpm = 9000, feed_mm_min = 1500 }}\n{more}"
    )
}

fn planned(scratch: &Scratch, name: &str, text: &str) -> Run {
    let job = scratch.write(&format!("{name}.toml"), text);
    osculate(&["plan", job.to_str().unwrap(), "--out", scratch.path(name).to_str().unwrap(), "--json"])
}

fn bytes(scratch: &Scratch, name: &str) -> Vec<u8> {
    std::fs::read(scratch.path(name)).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

#[test]
fn a_job_goes_on_with_what_another_has_left() {
    let scratch = Scratch::new();
    scratch.write("plate.json", &plate(THICK_MM));
    let whole = planned(&scratch, "whole", &list("[\"top\"]", BLOCK, &format!("{ROUGH}{FINISH}")));
    let whole = whole.json();
    assert_eq!(whole["verdict"]["answer"], "held", "{}", whole["verdict"]);
    let left = "[stock]\nfile = \"whole/stock-1.stock\"\n";
    let text = list("[\"top\"]", left, FINISH);
    let next = planned(&scratch, "next", &text).json();
    assert_eq!(next["verdict"]["answer"], "held", "{}", next["verdict"]);
    // The same passes through the same material leave the same, to the bit.
    let [a, b] = [&whole["operations"][1], &next["operations"][0]];
    for key in ["passes", "cutting_length_mm", "removed_mm3", "left_mm3"] {
        assert_eq!(a[key], b[key], "{key}");
    }
    assert!(number(&a["removed_mm3"]) > 10.0);
    assert!(bytes(&scratch, "whole/stock-2.stock") == bytes(&scratch, "next/stock-1.stock"));
    for key in ["scallop_max_mm", "gouge_max_mm", "uncut_area_mm2"] {
        assert_eq!(whole["verification"][key], next["verification"][key], "{key}");
    }
    // Its program is judged in that material too, and words say what it is.
    let [program, job] = ["next/program.ngc", "next.toml"].map(|name| scratch.path(name));
    let verify = ["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"];
    let again = osculate(&verify).json();
    assert_eq!(again["verdict"], next["verdict"]);
    assert!(
        next["verdict"].to_string().contains("what was left as stock-1.stock has it"),
        "{}",
        next["verdict"]
    );
    // What is written of the job finds the material from anywhere.
    let resolved = scratch.path("next/job.resolved.toml");
    let third = scratch.path("third");
    let args = ["plan", resolved.to_str().unwrap(), "--out", third.to_str().unwrap(), "--json"];
    assert_eq!(osculate(&args).json()["verdict"], next["verdict"]);
}

#[test]
fn a_part_is_turned_and_held_otherwise() {
    let scratch = Scratch::new();
    scratch.write("plate.json", &plate(THICK_MM));
    let first = planned(&scratch, "first", &list("[\"top\"]", BLOCK, &format!("{ROUGH}{FINISH}"))).json();
    assert_eq!(first["verdict"]["answer"], "held", "{}", first["verdict"]);
    // The other side, clamped by a jaw beside it that ends below what is machined, seen from there.
    let jaw = |lowest: f64| bar([6.2, -2.0, lowest], [8.0, 2.0, -1.0]);
    scratch.write("jaw.stl", &jaw(-THICK_MM + 1.0));
    scratch.write("high.stl", &jaw(-THICK_MM - 0.3));
    let second = |fixture: &str| {
        let setup = format!("{OTHER_SIDE}fixtures = [\"{fixture}\"]\n");
        let left = "[stock]\nfile = \"first/stock-2.stock\"\n";
        planned(&scratch, "second", &list("[\"bottom\"]", left, &format!("{setup}{BENEATH}"))).json()
    };
    let clear = second("jaw.stl");
    assert_eq!(clear["verdict"]["answer"], "held", "{clear}");
    // From the first job's material: without the layer above the top, and all beneath the bottom goes.
    let begins = number(&clear["operations"][0]["removed_mm3"]) + number(&clear["operations"][0]["left_mm3"]);
    assert!((begins - number(&first["operations"][1]["left_mm3"])).abs() < 1e-6 * begins);
    assert!((number(&clear["operations"][0]["removed_mm3"]) - 144.0).abs() < 3.0, "{clear}");
    // A jaw that stands higher than the finished face is hit.
    let hit = second("high.stl");
    assert_eq!(hit["verdict"]["answer"], "not_held", "{}", hit["verdict"]);
    assert!(hit["worst"].as_array().unwrap().iter().any(|w| w["face"] == "fixture"), "{}", hit["worst"]);
    // In one list of both setups both answers are the same.
    for (fixture, one) in [("jaw.stl", &clear), ("high.stl", &hit)] {
        let setups = format!("[[setup]]\nname = \"op10\"\n{OTHER_SIDE}fixtures = [\"{fixture}\"]\n");
        let v =
            planned(&scratch, "both", &list("\"all\"", BLOCK, &format!("{setups}{ROUGH}{FINISH}{BENEATH}")))
                .json();
        assert_eq!(v["verdict"]["answer"], one["verdict"]["answer"], "{fixture}: {}", v["verdict"]);
        assert!(
            (number(&v["operations"][2]["left_mm3"]) - number(&one["operations"][0]["left_mm3"])).abs()
                < 1e-6
        );
    }
}

/// A box as a mesh.
fn bar(lo: [f64; 3], hi: [f64; 3]) -> String {
    let p = |k: usize| [0, 1, 2].map(|j| if k >> j & 1 == 0 { lo[j] } else { hi[j] });
    let mut text = String::from("solid jaw\n");
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        for t in [[a, b, c], [a, c, d]] {
            let corners: String = t.map(p).iter().map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).collect();
            text += &format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n");
        }
    }
    text + "endsolid\n"
}

#[test]
fn material_of_another_part_and_half_a_file_are_refused() {
    let scratch = Scratch::new();
    scratch.write("plate.json", &plate(THICK_MM));
    let run = planned(&scratch, "first", &list("[\"top\"]", BLOCK, &format!("{ROUGH}{FINISH}")));
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let whole = bytes(&scratch, "first/stock-1.stock");
    let next = |stock: &str, words: &[&str]| {
        planned(&scratch, "next", &list("[\"top\"]", stock, FINISH)).refused(words);
        assert!(!scratch.path("next/summary.json").exists());
    };
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    for broken in [&whole[..whole.len() / 2], &flipped, &whole[..9]] {
        std::fs::write(scratch.path("broken.stock"), broken).unwrap();
        next("[stock]\nfile = \"broken.stock\"\n", &["broken.stock", "plan that job again"]);
    }
    std::fs::write(scratch.path("named.stl"), &whole).unwrap();
    let file = "[stock]\nfile = \"named.stl\"\n";
    for key in ["cell_mm", "allowance_mm", "memory_mb"] {
        next(&format!("{file}{key} = 1\n"), &["[stock]", key, "leave it out"]);
    }
    next("[stock]\nfile = \"none.stock\"\n", &["none.stock"]);
    // A plate that is a hair thinner is another part; the mesh of the same material is taken for it.
    scratch.write("plate.json", &plate(THICK_MM - 0.01));
    next(file, &["[stock]", "file = ", "another part (plate.json", ".stl beside it"]);
    let run =
        planned(&scratch, "next", &list("[\"top\"]", "[stock]\nfile = \"first/stock-1.stl\"\n", FINISH));
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
}
