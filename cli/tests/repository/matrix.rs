//! On every example of one operation `plan` and `verify` give the same verdict.

use crate::common;
use common::{Scratch, verdict};
use std::path::Path;

/// Whole parts take minutes with the build of tests: `cargo xtask parts` plans and verifies those, small ones are in `operations.rs`.
fn is_whole_part(job: &str) -> bool {
    job.lines().any(|line| line == "format = 2")
}

#[test]
fn every_other_example_of_one_operation() {
    let s = Scratch::new();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut names: Vec<String> = std::fs::read_dir(&examples)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let mut run = 0;
    for name in names {
        let job = examples.join(&name).join("job.toml");
        let text = std::fs::read_to_string(&job).unwrap();
        // The main job of the README is planned and verified by `.ci/run`.
        if is_whole_part(&text) || name == "eee-hpt-rotor2" {
            continue;
        }
        run += 1;
        let verb = if text.contains("[flank]") { "flank" } else { "plan" };
        let verdict = verdict::planned_and_verified(&s, &name, verb, &job);
        // A face that is bent 2.3 mm across cannot be flank milled, and the example shows how that is told.
        let want = if name == "centrifugal-blade" { "not_held" } else { "held" };
        assert_eq!(verdict["answer"], want, "{name}: {verdict}");
    }
    assert!(run >= 7, "{run}");
}
