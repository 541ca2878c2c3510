//! Many jobs: two tools and three heights of scallops, planned beside each other, as one table.
//!
//!     cargo run -p osculate --example sweep
#![allow(clippy::print_stdout)]

use osculate::work::sweep::rows::{Rows, Shard, Writer};
use osculate::work::sweep::{Sweep, page, run, table};
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
"#;

const SWEEP: &str = r#"
format = 1
job = "job.toml"

[[vary]]
key = "tool.diameter_mm"
values = [4, 8]

[[vary]]
key = "tolerance.scallop_mm"
values = [0.02, 0.05, 0.1]
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("osculate-sweep-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let told = planned(&folder);
    std::fs::remove_dir_all(&folder)?;
    told
}

fn planned(folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::write(folder.join("job.toml"), JOB)?;
    let sweep = Sweep::from_toml(SWEEP, &folder.join("sweep.toml"))?;
    let numbers: Vec<usize> = Shard::WHOLE.numbers(sweep.cases()).collect();
    let writer = Writer::open(Shard::WHOLE, folder)?;
    run::run(&sweep, &numbers, (2, None), (&writer, &()))?;
    let rows = Rows::read(folder, &|n| sweep.case(n).ok().map(|c| c.key))?;
    println!("{}", table::csv(&sweep, rows.all()));
    let all: Vec<_> = rows.all().collect();
    let fastest = page::fastest(&all).ok_or("none holds")?;
    println!("the fastest: {}", sweep.words_of(fastest.case));
    // The larger ball at the widest tolerance.
    assert_eq!(fastest.case, 6);
    Ok(())
}
