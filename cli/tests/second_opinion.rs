//! `verify --second-opinion`: frozen poses beside the verification, where they agree, where they do not, and where there are none.
#![allow(clippy::unwrap_used)]

mod common;
use common::{Scratch, job, osculate};
use osculate::work::opinion::ask;
use osculate::{Answer, Job, Part};
use std::path::Path;

#[test]
fn two_judges_agree_on_a_plan() {
    let s = Scratch::new();
    for (dialect, ending) in [("linuxcnc", "ngc"), ("heidenhain", "h")] {
        let text = job(|t| t.replace("dialect = \"linuxcnc\"", &format!("dialect = \"{dialect}\"")));
        let path = s.write("job.toml", &text);
        let out = s.path(dialect);
        let planned = osculate(&["plan", path.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert_eq!(planned.code, 0, "{}", planned.out);
        let program = out.join(format!("program.{ending}"));
        let args = ["verify", program.to_str().unwrap(), "--job", path.to_str().unwrap(), "--json"];
        let run = osculate(&[&args[..], &["--second-opinion"]].concat());
        let v = run.json();
        assert_eq!(run.code, 0, "{v}");
        let second = &v["second_opinion"];
        assert_eq!(second["agrees"], true, "{v}");
        let (theirs, ours) =
            (v["scallop_max_mm"].as_f64().unwrap(), second["figures"]["left_max_mm"].as_f64().unwrap());
        // A tenth of the tolerance is what its poses may be off by, and its points are 0.04 mm apart.
        assert!((theirs - ours).abs() < 0.003, "{theirs} {ours}");
        // Words that it does not know it does not guess.
        let text = std::fs::read_to_string(&program).unwrap();
        if dialect == "linuxcnc" {
            let dwell = s.write("dwell.ngc", &text.replace("G54\n", "G54\nG4 P0.1\n"));
            let args = ["verify", dwell.to_str().unwrap(), "--job", path.to_str().unwrap(), "--json"];
            let run = osculate(&[&args[..], &["--second-opinion"]].concat());
            let v = run.json();
            assert_eq!((run.code, v["verdict"]["answer"].as_str()), (0, Some("held")), "{v}");
            let why = v["second_opinion"]["why"].as_str().unwrap();
            assert!(v["second_opinion"]["agrees"].is_null() && why.contains("line"), "{why}");
        }
    }
}

/// What was held of one program is not shown where the other judge has seen one that digs in.
#[test]
fn a_disagreement_takes_the_verdict_back() {
    // The face looks up, so that lower is into it.
    let text = job(|t| t + "[setup]\nrotate_deg = [0, 0, 0]\n");
    let job = Job::from_toml(&text, Path::new("job.toml")).unwrap();
    let part = Part::of(&job).unwrap();
    let plan = osculate::plan(&part, &job, &()).unwrap();
    let verified = osculate::verify(&part, &job, plan.program()).unwrap();
    assert_eq!(verified.verdict.answer(), Answer::Held);
    // The whole program half a millimetre lower.
    let lower = |word: &str| match word.strip_prefix('Z').map(str::parse::<f64>) {
        Some(Ok(z)) => format!("Z{:.4}", z - 0.5),
        _ => word.to_owned(),
    };
    let line = |l: &str| match l.starts_with('(') || l.contains("G53") {
        true => l.to_owned(),
        false => l.split(' ').map(lower).collect::<Vec<_>>().join(" "),
    };
    let deep: String = plan.program().lines().map(|l| line(l) + "\n").collect();
    let (doubted, second) = ask(&job, &part, &deep, verified);
    assert_eq!(second.agrees, Some(false), "{second:?}");
    assert_eq!(doubted.verdict.answer(), Answer::NotShown);
    assert!(!doubted.summary.within_tolerance);
    let ours = second.figures.unwrap().gouge_max_mm;
    // The verification of that program sees the same; along the normal a point is at least as deep as it is in the tool.
    let seen = osculate::verify(&part, &job, &deep).unwrap().summary.gouge_max_mm;
    assert!(ours > 0.1 && ours < 1.01 * seen && ours > 0.9 * seen, "{ours} {seen}");
    assert!(doubted.verdict.words().contains(&format!("{ours:.5}")), "{}", doubted.verdict.words());
}
