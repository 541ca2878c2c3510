//! Plans and verifications, and what their verdicts say.
#![allow(clippy::unwrap_used)]

use super::{Run, Scratch, osculate};
use serde_json::Value;
use std::path::{Path, PathBuf};

pub fn plan(job: &Path, out: &Path) -> Run {
    osculate(&["plan", job.to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"])
}

pub fn verify(program: &Path, job: &Path) -> Run {
    osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"])
}

pub fn why(v: &Value) -> String {
    v["verdict"]["why"].to_string()
}

pub fn answer(v: &Value) -> &str {
    v["verdict"]["answer"].as_str().unwrap()
}

/// The same verdict from the plan and from its program.
pub fn agree(planned: &Value, verified: &Value) {
    assert_eq!(planned["verdict"], verified["verdict"]);
    assert_eq!(planned["verification"]["gouge_max_mm"], verified["gouge_max_mm"]);
    assert_eq!(planned["verification"]["height_max_mm"], verified["height_max_mm"]);
}

/// Plans (or flank mills) a job, verifies the program that it wrote, and holds the two verdicts against each other, byte for byte.
pub fn planned_and_verified(scratch: &Scratch, name: &str, verb: &str, job: &Path) -> Value {
    let out = scratch.path(name);
    let run = osculate(&[verb, job.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(run.code == 0 || run.code == 1, "{name}: {}{}", run.out, run.err);
    let summary: Value = serde_json::from_str(
        &std::fs::read_to_string(out.join("summary.json"))
            .unwrap_or_else(|e| panic!("{name}: {e}: {}{}", run.out, run.err)),
    )
    .unwrap();
    let is_program = |p: &PathBuf| p.file_stem().is_some_and(|s| s == "program");
    let program = std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().path()).find(is_program).unwrap();
    let checked = osculate(&["verify", program.to_str().unwrap(), "--job", job.to_str().unwrap(), "--json"]);
    assert_eq!(checked.code, run.code, "{name}: {}", checked.err);
    let v = checked.json();
    assert_eq!(summary["verdict"].to_string(), v["verdict"].to_string(), "{name}");
    let own = summary["verification"].as_object().unwrap();
    for (key, value) in own {
        assert_eq!(value.to_string(), v[key].to_string(), "{name}: {key}");
    }
    // The answer, the exit status and the key of older scripts say one thing.
    let held = v["verdict"]["answer"] == "held";
    assert_eq!((v["within_tolerance"] == true, run.code == 0), (held, held), "{name}");
    v["verdict"].clone()
}
