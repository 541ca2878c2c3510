//! Verdicts on the example parts.

use crate::common;
use common::verdict::{agree, answer, plan, verify, why};
use common::{Scratch, job, osculate};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// The hub of a propeller alone: the ball goes into the blades beside it, which no key of the job names.
#[test]
fn faces_that_the_job_does_not_name_are_checked() {
    let s = Scratch::new();
    let part = repository("examples/propeller/propeller.step");
    let text = |more: &str| {
        job(|t| {
            t.replace(
                "builtin = { kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 6 }",
                &format!("file = '{}'\nfaces = [\"F8\"]\n{more}", part.display()),
            )
            .replace("scallop_mm = 0.02", "scallop_mm = 0.1")
        })
    };
    let path = s.write("job.toml", &text(""));
    let run = plan(&path, &s.path("out"));
    let v = run.json();
    assert_eq!((run.code, answer(&v)), (1, "not_held"), "{v}");
    assert!(why(&v).contains("gouge"), "{}", why(&v));
    assert!(v["verdict"]["scope"]["other_faces"].as_str().unwrap().contains("checked"), "{v}");

    // The job may say that they may be hit: then the answer is for the one face only, and says so.
    let path = s.write("hit.toml", &text("may_hit = \"all\""));
    let out = s.path("hit");
    let run = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    assert!(run.out.contains("held for F8 only"), "{}", run.out);
    assert!(run.out.contains("NOT looked at, as they may be hit"), "{}", run.out);
}

/// A roughing that stops after a third of its program leaves most of the part uncut; the whole one holds its own limit.
#[test]
fn a_roughing_that_stops_early_does_not_hold() {
    let s = Scratch::new();
    let job = repository("examples/m86-rough/job.toml");
    let run = plan(&job, &s.path("out"));
    let planned = run.json();
    assert_eq!((run.code, answer(&planned)), (0, "held"), "{planned}");
    let text = std::fs::read_to_string(s.path("out").join("program.nc")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let cut = lines[..lines.len() * 3 / 10].join("\n") + "\nM30\n%\n";
    let run = verify(&s.write("cut.nc", &cut), &job);
    let v = run.json();
    assert_eq!((run.code, answer(&v)), (1, "not_held"));
    assert!(why(&v).contains("uncut"), "{}", why(&v));
    assert!(v["uncut_area_mm2"].as_f64().unwrap() > 5000.0, "{v}");
}

/// Flank milling is judged on the face itself and not on the ruled one that stands for it while it is planned.
#[test]
fn flank_milling_is_judged_on_the_real_face() {
    let s = Scratch::new();
    let job = repository("examples/centrifugal-blade/job.toml");
    let out = s.path("out");
    let run = osculate(&["flank", job.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    let planned: Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(answer(&planned), "not_held");
    assert!(planned["verification"]["uncut_area_mm2"].as_f64().unwrap() > 100.0);
    let run = verify(&out.join("program.mpf"), &job);
    assert_eq!(run.code, 1);
    agree(&planned, &run.json());
}

/// Roughing from below beside the curved blades of a propeller, whose lines along walls run out into the air and come back: they go around the blades,
/// not straight from where they leave to where they come back.
#[test]
fn roughing_goes_around_what_it_leaves() {
    let s = Scratch::new();
    let list = std::fs::read_to_string(repository("examples/propeller-whole/job.toml")).unwrap();
    let part = repository("examples/propeller/propeller.step");
    let mut parts = list.split("[[operation]]");
    let head = parts.next().unwrap().replace("../propeller/propeller.step", part.to_str().unwrap());
    let rough: Vec<&str> = parts.filter(|p| p.contains("kind = \"rough\"")).collect();
    assert_eq!(rough.len(), 2);
    let text = format!("{head}[[operation]]{}", rough.join("[[operation]]"));
    let run = plan(&s.write("job.toml", &text), &s.path("out"));
    let v = run.json();
    assert_eq!((run.code, answer(&v)), (1, "not_held"), "nothing is finished");
    assert!(!why(&v).contains("gouge"), "{}", why(&v));
    assert_eq!(v["verification"]["gouge_max_mm"], 0.0, "{}", why(&v));
}
