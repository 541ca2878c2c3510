//! What a verdict says of programs that were spoilt: without its spindle start, and with one coordinate half a millimetre off.
//!
//! The job is a plane of 10 mm, so that the program is short. Whoever wrote a program, its text alone is judged.
//!
//!     cargo run -p osculate --example judge_a_program
#![allow(clippy::print_stdout)]

use osculate::{Answer, Job, Part};
use std::error::Error;
use std::path::Path;

const JOB: &str = r#"
format = 1
part = { builtin = { kind = "plane", half_size_mm = 5 } }
tool = { kind = "ball", diameter_mm = 6, length_mm = 40, teeth = 2 }
tolerance = { scallop_mm = 0.1 }
strategy = { kind = "isoparametric", lead_deg = 10 }
cutting = { spindle_rpm = 8000 }
machine = { name = "trunnion-ac", dialect = "linuxcnc", feed = "tcp" }
setup = { turns = "none" }
"#;

/// The program with one line changed, the first that `is_meant`.
fn with_line(program: &str, is_meant: impl Fn(&str) -> bool, change: impl Fn(&str) -> String) -> String {
    let meant = program.lines().position(is_meant);
    let lines = program.lines().enumerate();
    lines.map(|(k, line)| if Some(k) == meant { change(line) } else { line.to_owned() } + "\n").collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let job = Job::from_toml(JOB, Path::new("plane.toml"))?;
    let part = Part::of(&job)?;
    let plan = osculate::plan(&part, &job, &())?;
    assert_eq!(plan.verdict().answer(), Answer::Held);
    println!("as posted: {}", plan.verdict().words());

    // The spindle stands still.
    let silent = with_line(plan.program(), |line| line.ends_with("M3"), |_| String::new());
    // The tool goes in half a millimetre deeper where it first feeds.
    let first_feed = |line: &str| line.starts_with("G1 ") && line.contains(" Z");
    let deep = with_line(plan.program(), first_feed, |line| {
        let lowered = |word: &str| match word.strip_prefix('Z').and_then(|z| z.parse::<f64>().ok()) {
            Some(z_mm) => format!("Z{:.4}", z_mm - 0.5),
            None => word.to_owned(),
        };
        line.split(' ').map(lowered).collect::<Vec<_>>().join(" ")
    });
    for (what, program, reason) in [("without M3", silent, "spindle"), ("0.5 mm deeper", deep, "gouge")] {
        assert_ne!(program, plan.program(), "{what}: nothing was changed");
        let judged = osculate::verify(&part, &job, &program)?;
        println!("{what}: {}", judged.verdict.words());
        assert_eq!(judged.verdict.answer(), Answer::NotHeld);
        assert!(judged.verdict.why().iter().any(|why| why.contains(reason)), "{what}: another reason");
    }
    Ok(())
}
