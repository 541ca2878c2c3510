//! `axes`: the field of the tool's axis over the faces of a job, and the directions at places, against what is known of them.

use crate::common;
use common::{Run, Scratch, osculate};
use serde_json::Value;
use std::path::Path;

/// A built-in face with a tool, a strategy and a machine.
fn text(part: &str, tool: &str, strategy: &str, machine: &str) -> String {
    format!(
        "format = 1\n[part]\nbuiltin = {{ {part} }}\n[tool]\n{tool}\nlength_mm = 40\nteeth = 2\n\
         holder = {{ diameter_mm = 30, length_mm = 40 }}\n[tolerance]\nscallop_mm = 0.05\ngouge_mm = 0.02\nchord_mm = 0.01\n\
         [strategy]\n{strategy}\n[cutting]\nspindle_rpm = 8000\nfeed_mm_min = 1000\n\
         [setup]\npart_zero_mm = [0, 0, 0]\n[machine]\nname = \"{machine}\"\ndialect = \"linuxcnc\"\nfeed = \"inverse_time\"\n"
    )
}

const PLANE: &str = "kind = \"plane\", u_range = [0, 24], v_range = [0, 16]";
const BALL: &str = "kind = \"ball\"\ndiameter_mm = 8";
const FIELD: &str = "kind = \"isoparametric\"\naxis = \"field\"";

fn axes(job: &Path, more: &[&str]) -> Run {
    osculate(&[&["axes", job.to_str().unwrap()], more].concat())
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

/// Over a plane only the holder has the plane in its way: it begins 12 mm above the tip of a ball of 4 mm and has a radius of 15 mm, so that
/// its lower edge meets the plane where `4 + 8 cos L - 15 sin L = 0`, at a lean L of 41.68 degrees: `1 - cos L` of the half sphere
/// is free.
#[test]
fn over_a_plane_what_is_free_is_known() {
    let s = Scratch::new();
    let plane = "kind = \"plane\", u_range = [0, 80], v_range = [0, 80]";
    let short =
        text(plane, BALL, FIELD, "trunnion-ac").replace("length_mm = 40\nteeth", "length_mm = 12\nteeth");
    let job = s.write("job.toml", &short);
    let out = s.path("out");
    let run = axes(&job, &["--at", "40,40", "--out", out.to_str().unwrap(), "--json"]);
    let v = run.json();
    assert_eq!(run.code, 0, "{v}");
    let face = &v["faces"][0];
    assert_eq!((&face["face"], &face["picture"]), (&"F1".into(), &"field-F1.svg".into()));
    assert!((number(&face["area_mm2"]) / 6400.0 - 1.0).abs() < 0.05 && number(&face["unreached_mm2"]) == 0.0);
    let fields = face["fields"].as_array().unwrap();
    assert_eq!(fields.iter().map(|f| f["along"].as_str().unwrap()).collect::<Vec<_>>(), ["u", "v"]);
    for field in fields {
        assert_eq!(number(&field["places_not_clear"]), 0.0);
        let turns = field["largest_turns"].as_array().unwrap();
        assert_eq!(turns.iter().map(|t| t["joint"].as_str().unwrap()).collect::<Vec<_>>(), ["C", "A"]);
    }
    assert_eq!(face["places"].as_array().unwrap().len(), 1);
    let place = &face["places"][0];
    assert_eq!(place["normal"], serde_json::json!([0.0, 0.0, 1.0]));
    // Half of the 2,562 directions, and those of the rim once.
    let all = number(&place["directions"]);
    assert!((1281.0..1330.0).contains(&all) && number(&place["lift_mm"]) == 0.0, "{place}");
    let barred = place["barred"].as_array().unwrap();
    let names: Vec<&str> = barred.iter().map(|b| b["what"].as_str().unwrap()).collect();
    assert_eq!(names, ["holder: F1", "lean not within 0\u{b0} to 88\u{b0}"]);
    let percent: Vec<f64> = barred.iter().map(|b| number(&b["percent"])).collect();
    let free = number(&place["free_percent"]);
    assert!((free + percent[0] + percent[1] - 100.0).abs() < 1e-9 && percent[1] < 6.0, "{place}");
    assert!((100.0 * number(&place["free"]) / all - free).abs() < 1e-9);
    assert!((free - 100.0 * (1.0 - 41.68_f64.to_radians().cos())).abs() < 1.5, "{free}");
    for axis in place["axes"].as_array().unwrap() {
        assert!(axis["clear"] == true && number(&axis["lean_deg"]) < 41.68, "{axis}");
    }
    let field = std::fs::read_to_string(out.join("field-F1.svg")).unwrap();
    for words in ["passes along u", "passes along v", "lean of the tool axis", "from the face to the spindle"]
    {
        assert!(field.contains(words), "{words}");
    }
    assert!(!field.contains("no axis reaches"));
    let map = std::fs::read_to_string(out.join("reach-F1-1.svg")).unwrap();
    for words in ["free", "holder: F1", "axis of the field", "75\u{b0}", "seen along the normal", "+Z"] {
        assert!(map.contains(words), "{words}");
    }
    assert!(!map.contains("cutter: F1"));
}

#[test]
fn a_machine_of_three_axes_has_one_direction_or_no_field() {
    let s = Scratch::new();
    let job = s.write("three.toml", &text(PLANE, BALL, FIELD, "3-axis"));
    let run = axes(&job, &["--json"]);
    let v = run.json();
    let place = &v["faces"][0]["places"][0];
    assert_eq!((run.code, &place["directions"], &place["free"]), (0, &1.into(), &1.into()), "{v}");
    assert!(v["faces"][0]["fields"][0]["largest_turns"].as_array().unwrap().is_empty());
    assert!(v["faces"][0].get("picture").is_none());
    // A plane that lies on its side shows a machine of three axes nothing but its edge: no field, and why.
    let side = text(PLANE, BALL, FIELD, "3-axis");
    let side = side.replace("part_zero_mm = [0, 0, 0]", "rotate_deg = [90, 0, 0]");
    let job = s.write("side.toml", &side);
    let out = s.path("out");
    let run = axes(&job, &["--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    assert!(run.out.contains("no field") && run.out.contains("no axis is possible"), "{}", run.out);
    assert!(std::fs::read_to_string(out.join("field-F1.svg")).unwrap().contains("no axis reaches"));
}

#[test]
fn pictures_are_the_same_for_any_number_of_threads() {
    let s = Scratch::new();
    let dome =
        "kind = \"ellipsoid\", semi_axes_mm = [30, 25, 20], u_range = [-0.4, 0.4], v_range = [0.5, 0.9]";
    let tool = "kind = \"toroidal\"\ndiameter_mm = 8\ncorner_radius_mm = 2";
    let job = s.write("job.toml", &text(dome, tool, "kind = \"auto\"", "trunnion-ac"));
    let mut seen = Vec::new();
    for threads in ["1", "3"] {
        let out = s.path(threads);
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_osculate"))
            .args(["axes", job.to_str().unwrap(), "--out", out.to_str().unwrap()])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let text = String::from_utf8(run.stdout).unwrap();
        // A toroidal end leans by a degree at least, and the job asks for no field by name.
        assert!(text.contains("leaning 1.0 to 88 deg") && text.contains("does not ask for axis"), "{text}");
        let files = ["field-F1.svg", "reach-F1-1.svg", "reach-F1-2.svg"];
        let files = files.map(|name| std::fs::read_to_string(out.join(name)).unwrap());
        assert!(files[1].contains("least lean that is clear"));
        seen.push((text.replace(out.to_str().unwrap(), ""), files));
    }
    assert!(seen[0] == seen[1]);
}
