//! `verify --second-opinion`: frozen poses beside the verification, where they agree, where they do not, and where there are none.

use crate::common;
use common::{Scratch, job, osculate};
use osculate::work::opinion::ask;
use osculate::{Answer, Job, Part};
use serde_json::json;
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

/// A holder of two cylinders over a floor, and a step beside it: the first, which is narrow, passes it, the second reaches over it.
#[test]
fn a_wider_section_of_a_holder_is_found_by_both() {
    let s = Scratch::new();
    let square = |id: &str, x: [f64; 2], z: f64| {
        let poles = x.map(|x| json!([[x, -3.0, z], [x, 3.0, z]]));
        let knots = json!([[0.0, 0.0, 1.0, 1.0], [0.0, 0.0, 1.0, 1.0]]);
        let weights = json!([[1.0, 1.0], [1.0, 1.0]]);
        json!({ "id": id, "kind": "bspline", "oriented": true, "side": "along", "surface": { "nurbs": {
            "degree": [1, 1], "knots": knots, "poles_mm": poles, "weights": weights, "side": "along" } } })
    };
    let tool = "kind = \"flat\"\ndiameter_mm = 8\nlength_mm = 8\n";
    let narrow = "{ diameter_mm = 10, length_mm = 10 }";
    let text = format!(
        "format = 1\n[part]\nfile = \"step.json\"\nfaces = [\"floor\"]\n[tool]\n{tool}\
         holder = [{narrow}, {{ diameter_mm = 20, upper_diameter_mm = 30, length_mm = 10 }}]\n\
         [tolerance]\nscallop_mm = 0.02\ngouge_mm = 0.01\n[verification]\nspacing_mm = 0.1\n\
         [machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\nfeed = \"none\"\n"
    );
    let job = s.write("job.toml", &text);
    let mut cl = "UNITS/MM\nCUTTER/8,0,0,0,0,0,8\nRAPID\nGOTO/-6,-4,40,0,0,1\nFEDRAT/1000,MMPM\n".to_owned();
    for (x, y) in [(-6, -4), (6, -4), (6, 0), (-6, 0), (-6, 4), (6, 4), (-6, 4)] {
        cl += &format!("GOTO/{x},{y},0,0,0,1\n");
    }
    let (cl, program) = (s.write("rows.cl", &(cl + "FINI\n")), s.path("rows.ngc"));
    let zero = ["--part-zero=0,0,0", "--out", program.to_str().unwrap()];
    let machine = ["--machine", "trunnion-ac", "--dialect", "linuxcnc", "--feed", "none"];
    let posted = osculate(&[&["post", cl.to_str().unwrap()][..], &machine, &zero].concat());
    assert_eq!(posted.code, 0, "{}", posted.err);
    // The tool comes to x = 6 mm: the step begins 6 mm beside its axis there, and 13 mm beside it the flank of the cone is 24 mm up.
    for (step, [from, to], depth) in
        [(18.5, [12.0, 15.0], 0.5), (17.5, [12.0, 15.0], 0.0), (23.5, [19.0, 20.0], 0.0)]
    {
        let faces = [square("floor", [-3.0, 3.0], 0.0), square("step", [from, to], step)];
        s.write("step.json", &json!({ "format": 1, "faces": faces }).to_string());
        let args = [
            "verify",
            program.to_str().unwrap(),
            "--job",
            job.to_str().unwrap(),
            "--second-opinion",
            "--json",
        ];
        let run = osculate(&args);
        let v = run.json();
        let answer = if depth > 0.0 { "not_held" } else { "held" };
        assert_eq!(v["verdict"]["answer"], answer, "{step}: {v}");
        let found = v["worst"].as_array().unwrap().iter().find(|w| w["kind"] == "holder");
        let theirs = found.map_or(0.0, |w| w["value_mm"].as_f64().unwrap());
        let ours = v["second_opinion"]["figures"]["holder_max_mm"].as_f64().unwrap();
        assert!((theirs - depth).abs() < 1e-3 && (ours - depth).abs() < 3e-3, "{step}: {theirs} {ours} {v}");
        if depth > 0.0 {
            // With the first cylinder alone nothing is hit, by either.
            let alone = text
                .lines()
                .map(|l| if l.starts_with("holder") { format!("holder = {narrow}") } else { l.to_owned() });
            let alone = s.write("alone.toml", &alone.collect::<Vec<_>>().join("\n"));
            let args = [
                "verify",
                program.to_str().unwrap(),
                "--job",
                alone.to_str().unwrap(),
                "--second-opinion",
                "--json",
            ];
            let v = osculate(&args).json();
            assert_eq!(v["verdict"]["answer"], "held", "{v}");
            assert_eq!(v["second_opinion"]["figures"]["holder_max_mm"], 0.0, "{v}");
        }
    }
}
