//! The tool's axis as a field or leaning to one side: machines of three and four axes, the sense of passes, and keys that do not go together.

use crate::common;
use common::{Run, Scratch, osculate};
use osculate_geom::Vec3;
use serde_json::Value;
use std::path::Path;

fn text(tool: &str, strategy: &str, machine: &str) -> String {
    format!(
        "format = 1\n[part]\n\
         builtin = {{ kind = \"ellipsoid\", semi_axes_mm = [30, 25, 20], u_range = [-0.4, 0.4], v_range = [0.5, 0.9] }}\n\
         [tool]\n{tool}\nlength_mm = 40\nteeth = 2\n[tolerance]\nscallop_mm = 0.05\ngouge_mm = 0.02\nchord_mm = 0.01\n\
         [strategy]\nkind = \"isoparametric\"\n{strategy}\n[cutting]\nspindle_rpm = 8000\nfeed_mm_min = 1000\n\
         [setup]\npart_zero_mm = [0, 0, 0]\n[machine]\nname = \"{machine}\"\ndialect = \"linuxcnc\"\nfeed = \"inverse_time\"\n"
    )
}

const BALL: &str = "kind = \"ball\"\ndiameter_mm = 8";
const FLAT: &str = "kind = \"flat\"\ndiameter_mm = 8";
const TOROIDAL: &str = "kind = \"toroidal\"\ndiameter_mm = 8\ncorner_radius_mm = 2";

fn plan(job: &Path, out: &Path) -> Run {
    osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"])
}

fn answer(v: &Value) -> &str {
    v["verdict"]["answer"].as_str().unwrap()
}

#[test]
fn machines_of_three_and_four_axes_are_no_strategies_of_their_own() {
    let s = Scratch::new();
    for (k, (tool, machine)) in
        [(BALL, "3-axis"), (TOROIDAL, "3-axis"), (BALL, "mill-turn-xyzc")].into_iter().enumerate()
    {
        let job = s.write(&format!("{k}.toml"), &text(tool, "axis = \"field\"", machine));
        let run = plan(&job, &s.path(&format!("out{k}")));
        let v = run.json();
        assert_eq!((run.code, answer(&v)), (0, "held"), "{tool} {machine}: {v}");
        // One rotary joint at most, and it has nothing to turn for.
        for (_, step) in v["joints"]["largest_step_deg"].as_object().unwrap() {
            assert!(step.as_f64().unwrap() < 1e-3, "{v}");
        }
    }
    // Without a field the axis leans against the feed, where none of these joints can take it.
    let job = s.write("feed.toml", &text(BALL, "", "3-axis"));
    let run = plan(&job, &s.path("feed"));
    assert_eq!(run.code, 1, "{}", run.out);
    assert!(run.err.contains("rotary joints"), "{}", run.err);
}

/// The edge of a flat end leaves marks of first order in the feed, for which passes leave room; a part whose normals are a belt is laid along the
/// spindle of a turning centre.
#[test]
fn flat_ends_and_turned_parts_hold_by_auto() {
    let s = Scratch::new();
    let auto = |tool: &str, machine: &str| {
        let by = text(tool, "", machine).replace("isoparametric", "auto");
        by.replace("[setup]\npart_zero_mm = [0, 0, 0]\n", "")
    };
    for (k, (tool, machine)) in [(FLAT, "3-axis"), (BALL, "mill-turn-xyzc")].into_iter().enumerate() {
        let job = s.write(&format!("auto{k}.toml"), &auto(tool, machine));
        let run = plan(&job, &s.path(&format!("auto-out{k}")));
        let v = run.json();
        assert_eq!((run.code, answer(&v)), (0, "held"), "{tool} {machine}: {v}");
        let mark = v["verification"]["tooth_mark_max_mm"].as_f64().unwrap();
        assert_eq!(mark > 0.005, tool == FLAT, "{v}");
    }
}

/// The ends of the cutting moves of a path, pass by pass, from its CL text.
fn feeds(v: &Value, out: &Path) -> Vec<[f64; 3]> {
    assert_eq!(answer(v), "held", "{v}");
    let cl = std::fs::read_to_string(out.join("path.cl")).unwrap();
    let of = |line: &str| -> Option<[f64; 3]> {
        let numbers = line.strip_prefix("GOTO/")?.split(',').take(3).map(|x| x.parse().ok());
        numbers.collect::<Option<Vec<f64>>>()?.try_into().ok()
    };
    cl.lines().filter_map(of).collect()
}

#[test]
fn a_wish_for_one_way_or_climb_is_kept_and_what_is_left_stays_the_same() {
    let s = Scratch::new();
    let mut found = Vec::new();
    for (name, wish) in [("any", ""), ("one", "one_way = true"), ("climb", "climb = \"climb\"")] {
        let strategy = format!("along = \"u\"\naxis = \"field\"\n{wish}");
        let job = s.write(&format!("{name}.toml"), &text(BALL, &strategy, "trunnion-ac"));
        let out = s.path(name);
        let v = plan(&job, &out).json();
        assert!(!feeds(&v, &out).is_empty());
        found.push(v);
    }
    let height = |v: &Value| v["verification"]["scallop_max_mm"].as_f64().unwrap();
    for v in &found[1..] {
        assert_eq!(v["passes"], found[0]["passes"]);
        // Poses are those of the same passes; NC words round them otherwise.
        assert!((height(v) - height(&found[0])).abs() < 1e-3, "{} {}", height(v), height(&found[0]));
        assert!(v["air_length_mm"].as_f64() > found[0]["air_length_mm"].as_f64());
    }
}

/// The place on the ellipsoid of [`text`] under the centre of a ball that touches it, and the axis as how far it leans along growing u and
/// to the left of that, as tangents; None for a ball that does not touch.
fn leans(line: &str, radius_mm: f64) -> Option<(f64, [f64; 2])> {
    let numbers = line.strip_prefix("GOTO/")?.split(',').map(|x| x.parse().ok());
    let [x, y, z, i, j, k] = <[f64; 6]>::try_from(numbers.collect::<Option<Vec<f64>>>()?).ok()?;
    let (squares, axis) = (Vec3::new(900.0, 625.0, 400.0), Vec3::new(i, j, k));
    let centre = Vec3::new(x, y, z) + axis * radius_mm;
    let normal = |p: &Vec3| p.component_div(&squares).normalize();
    let at = (0..100).fold(centre, |p, _| centre - normal(&p) * radius_mm);
    if (at.dot(&at.component_div(&squares)) - 1.0).abs() > 1e-5 {
        return None;
    }
    let (n, d) = (normal(&at), Vec3::new(-at.y * 1.2, at.x / 1.2, 0.0).normalize());
    Some((at.y.atan2(at.x), [d, n.cross(&d)].map(|e| axis.dot(&e) / axis.dot(&n))))
}

#[test]
fn passes_to_and_fro_lean_to_one_side() {
    let s = Scratch::new();
    for (name, lead, side) in [("left", 0.0, 20.0), ("right", 10.0, -15.0)] {
        let strategy = match lead {
            0.0 => format!("along = \"u\"\nside_tilt_deg = {side}"),
            _ => format!("along = \"u\"\nlead_deg = {lead}\nside_tilt_deg = {side}"),
        };
        let job = s.write(&format!("{name}.toml"), &text(BALL, &strategy, "trunnion-ac"));
        let out = s.path(name);
        let v = plan(&job, &out).json();
        assert_eq!(answer(&v), "held", "{v}");
        assert_eq!(
            [&v["lead_deg"], &v["tilt_deg"], &v["side_tilt_deg"]].map(|x| x.as_f64().unwrap().round()),
            [lead, 0.0, side]
        );
        let cl = std::fs::read_to_string(out.join("path.cl")).unwrap();
        let found: Vec<(f64, [f64; 2])> = cl.lines().filter_map(|line| leans(line, 4.0)).collect();
        let [ahead, left] = [lead, side].map(|deg: f64| deg.to_radians().tan());
        let mut senses = [0; 2];
        for w in found.windows(2).filter(|w| (w[1].0 - w[0].0).abs() > 0.01) {
            let grows = w[1].0 > w[0].0;
            let lead = if grows { ahead } else { -ahead };
            senses[usize::from(grows)] += 1;
            for (_, [along, across]) in w {
                assert!((across - left).abs() < 2e-3 && (along - lead).abs() < 2e-3, "{name}: {w:?}");
            }
        }
        assert!(senses.iter().all(|n| *n > 20), "{name}: {senses:?}");
    }
}

#[test]
fn keys_of_a_field_need_one() {
    let s = Scratch::new();
    for (strategy, key) in [
        ("one_way = true", "one_way"),
        ("climb = \"climb\"", "climb"),
        ("axis = [0, 0, 1]", "axis"),
        ("axis = \"feild\"", "axis"),
        ("axis = \"field\"\nlead_deg = 5", "lead_deg"),
    ] {
        let job = s.write("job.toml", &text(BALL, strategy, "trunnion-ac"));
        let run = plan(&job, &s.path("out"));
        assert_eq!(run.code, 1, "{}", run.out);
        assert!(run.err.contains(key) && run.err.contains("line "), "{}", run.err);
        assert!(!s.path("out").exists());
    }
}
