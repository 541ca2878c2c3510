//! The golden programs of `docs/dialects.md`, and dialect files from a job to its verdict.

use crate::common;
use common::{Scratch, job, osculate};

const PAGE: &str = include_str!("../../../docs/dialects.md");

/// What stands between the first of these marks and the next end.
fn between<'t>(text: &'t str, start: &str, end: &str) -> &'t str {
    let after = text.split_once(start).unwrap_or_else(|| panic!("{start} is not on the page")).1;
    after.split(end).next().unwrap_or(after)
}

/// Every line of a golden program is what `post` writes, and is explained.
#[test]
fn golden_programs_are_what_post_writes() {
    let scratch = Scratch::new();
    let cl = scratch.write("bracket.cl", between(PAGE, "```apt\n", "```"));
    for dialect in ["sinumerik", "heidenhain", "fanuc", "linuxcnc"] {
        let out = scratch.path("bracket.nc");
        let run = osculate(&[
            "post",
            cl.to_str().unwrap(),
            "--machine",
            "trunnion-ac",
            "--dialect",
            dialect,
            "--out",
            out.to_str().unwrap(),
        ]);
        assert_eq!(run.code, 0, "{}", run.err);
        let rows = between(PAGE, &format!("### {dialect}\n"), "\n#");
        let rows: Vec<(&str, &str)> = rows
            .lines()
            .filter_map(|row| row.strip_prefix("| `")?.strip_suffix(" |")?.split_once("` | "))
            .collect();
        assert!(rows.iter().all(|r| !r.1.trim().is_empty()), "{dialect}: a line is not explained");
        let want: String = rows.iter().map(|r| format!("{}\n", r.0)).collect();
        assert_eq!(std::fs::read_to_string(&out).unwrap(), want, "{dialect}");
    }
}

/// A dialect file in a job: planned, written in its own words, verified from them with the same verdict, and timed.
#[test]
fn a_dialect_file_goes_from_the_job_to_the_verdict() {
    let scratch = Scratch::new();
    scratch.write("osp.toml", between(PAGE, "```toml\n", "```"));
    let text = job(|j| j.replace("dialect = \"linuxcnc\"", "dialect_file = \"osp.toml\""));
    let path = scratch.write("job.toml", &text);
    let out = scratch.path("out");
    let (job_path, folder) = (path.to_str().unwrap(), out.to_str().unwrap());
    let plan = osculate(&["plan", job_path, "--out", folder, "--json"]);
    let program = out.join("program.min");
    let written =
        std::fs::read_to_string(&program).unwrap_or_else(|e| panic!("{e}: {}{}", plan.out, plan.err));
    assert!(
        written.contains("G169 HA=") && written.contains("G15 H1") && !written.contains("G43.4"),
        "{written:.2000}"
    );
    let file = program.to_str().unwrap();
    let verify = osculate(&["verify", file, "--job", job_path, "--json"]);
    assert_eq!((plan.code, verify.code), (0, 0), "{}{}", plan.err, verify.err);
    let scallop = |text: &str| {
        let value: serde_json::Value = serde_json::from_str(text).expect("JSON");
        value.pointer("/verification/scallop_max_mm").or(value.pointer("/scallop_max_mm")).cloned()
    };
    assert!(scallop(&plan.out).is_some());
    assert_eq!(scallop(&plan.out), scallop(&verify.out));
    let dialect = scratch.path("osp.toml");
    let time = osculate(&[
        "time",
        file,
        "--machine",
        "trunnion-ac",
        "--dialect",
        dialect.to_str().unwrap(),
        "--strict",
    ]);
    assert_eq!(time.code, 0, "{}", time.err);
    let both = text.replace("dialect_file", "dialect = \"haas\"\ndialect_file");
    let bad = scratch.write("both.toml", &both);
    osculate(&["plan", bad.to_str().unwrap(), "--out", folder])
        .refused(&["dialect_file", "both dialect and dialect_file"]);
    osculate(&["time", file, "--machine", "trunnion-ac", "--dialect", "okuma"])
        .refused(&["okuma", "haas, mazak, sinumerik-one"]);
}

/// What a machine file leaves open.
#[test]
fn machines_are_checked() {
    let run = osculate(&["machines", "--check", "trunnion-ac"]);
    assert_eq!(run.code, 0, "{}", run.err);
    for words in ["home_mm of X", "machine_zero_mm of Z", "the top of its travel", "turns without end"] {
        assert!(run.out.contains(words), "{words}: {}", run.out);
    }
    osculate(&["machines", "--check", "nothing.toml"]).refused(&["nothing.toml", "cannot be read"]);
}
