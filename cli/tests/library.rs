//! The library as another program uses it: what it hands on, and what it refuses.

use crate::common;

use common::Scratch;
use osculate::{Answer, Job, Part};
use std::error::Error;
use std::path::Path;

const ONE_TOOL: &str = "tool = { kind = \"ball\", diameter_mm = 6, length_mm = 40, teeth = 2 }";
const TWO_TOOLS: &str = r#"
tools = [
    { number = 1, kind = "ball", diameter_mm = 4, length_mm = 40, teeth = 2 },
    { number = 2, kind = "ball", diameter_mm = 8, length_mm = 40, teeth = 2 },
]"#;

fn job(tools: &str) -> Job {
    let text = format!(
        r#"format = 1
        part = {{ builtin = {{ kind = "plane", half_size_mm = 5 }} }}
        {tools}
        tolerance = {{ scallop_mm = 0.1 }}
        strategy = {{ kind = "isoparametric", lead_deg = 10 }}
        cutting = {{ spindle_rpm = 8000 }}
        machine = {{ name = "trunnion-ac", dialect = "linuxcnc", feed = "tcp" }}"#
    );
    Job::from_toml(&text, Path::new("plane.toml")).unwrap()
}

#[test]
fn a_program_is_judged_with_the_tool_that_the_plan_chose() {
    let job = job(TWO_TOOLS);
    let part = Part::of(&job).unwrap();
    let plan = osculate::plan(&part, &job, &()).unwrap();
    assert_eq!(plan.verdict().answer(), Answer::Held);
    // A wider ball leaves wider strips, and so a shorter path.
    assert_eq!(plan.job.tool().number(), 2);
    let again = osculate::verify(&part, &plan.job, plan.program()).unwrap();
    assert_eq!(again.verdict.to_string(), plan.verdict().to_string());
    // Where none is in hand the program says which is meant, by its T.
    let called = osculate::verify(&part, &job, plan.program()).unwrap();
    assert_eq!(called.verdict.to_string(), plan.verdict().to_string());
    let refused = osculate::verify(&part, &job, &plan.program().replace("T2 M6", "T9 M6")).err().unwrap();
    assert!(refused.to_string().contains("none of the job's tools"), "{refused}");
}

#[test]
fn all_files_are_written_and_nothing_else_stays() {
    let job = job(ONE_TOOL);
    let part = Part::of(&job).unwrap();
    let plan = osculate::plan(&part, &job, &()).unwrap();
    let folder = Scratch::new();
    plan.write(&folder.path("out/deep")).unwrap();
    for file in plan.files() {
        let text = std::fs::read(folder.path("out/deep").join(&file.name)).unwrap();
        assert_eq!(text, file.bytes, "{}", file.name);
    }
    assert_eq!(std::fs::read_dir(folder.path("out/deep")).unwrap().count(), plan.files().len());
    assert!(plan.report().contains("</html>"));
    // A file where the folder should be stays what it is.
    let taken = folder.write("taken", "mine");
    let refused = plan.write(&taken).unwrap_err();
    assert!(refused.to_string().contains("folder cannot be made"), "{refused}");
    assert_eq!(std::fs::read_to_string(taken).unwrap(), "mine");
    assert_eq!(folder.files(), ["out", "taken"]);
}

#[test]
fn failures_are_errors_with_their_message() {
    let run = || -> Result<(), Box<dyn Error>> {
        Job::load(Path::new("nowhere/job.toml"))?;
        Ok(())
    };
    let said = run().unwrap_err().to_string();
    assert!(said.starts_with("nowhere/job.toml: cannot be read"), "{said}");
    let job = job(ONE_TOOL);
    let part = Part::of(&job).unwrap();
    let said = osculate::verify(&part, &job, "no program at all").err().unwrap().to_string();
    assert!(said.starts_with("the program: "), "{said}");
}
