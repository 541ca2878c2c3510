//! From a STEP file to a verified program and its report, in the five steps of the library.
//!
//! One blade of a propeller is finished with a ball cutter, quickly and to a tenth of a millimetre. The program is then judged
//! once more from its text alone: both verdicts are the same, byte for byte. The files land in a temporary folder, or in the one
//! that the first argument names.
//!
//!     cargo run -p osculate --example plan_a_part [FOLDER]
#![allow(clippy::print_stdout)]

use osculate::{Job, Part};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Hub, edge and root of the blade are milled another time, and the verdict says that it holds without them. The other faces of
/// the part are checked.
const JOB: &str = r#"
format = 1
[part]
file = "propeller.step"
faces = "F7"
may_hit = ["F1", "F2", "F3", "F4", "F5", "F8", "F9", "F10", "F18", "F19", "F20"]
[tool]
kind = "ball"
diameter_mm = 6
length_mm = 40
teeth = 2
[tolerance]
scallop_mm = 0.1
[strategy]
kind = "isoparametric"
lead_deg = 15
[cutting]
spindle_rpm = 12000
feed_mm_min = 1500
[machine]
name = "trunnion-ac"
dialect = "linuxcnc"
feed = "tcp"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    // The part lies beside the job, wherever the job's text is from.
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/propeller/job.toml");
    let job = Job::from_toml(JOB, &beside)?;
    let part = Part::of(&job)?;
    let plan = osculate::plan(&part, &job, &())?;
    println!("{}", plan.verdict());
    assert!(plan.verdict().is_held(), "the plan does not hold");

    let again = osculate::verify(&part, &job, plan.program())?;
    assert_eq!(again.verdict.to_string(), plan.verdict().to_string());

    let own = std::env::temp_dir().join("osculate-plan_a_part");
    let folder = std::env::args_os().nth(1).map_or(own, PathBuf::from);
    plan.write(&folder)?;
    assert_eq!(std::fs::read_to_string(folder.join("report.html"))?, plan.report());
    println!("  {} files in {}", plan.files().len(), folder.display());
    Ok(())
}
