//! What a sweep costs beside its plans: cases expanded and checked, rows of eight shards written and read, table and page made.
//!
//! `cargo run --release -p osculate --example sweep_scale -- 10000`
#![allow(clippy::print_stdout)]

use osculate::work::sweep::case::{Figures, NAMES, Row};
use osculate::work::sweep::rows::{Rows, Shard};
use osculate::work::sweep::{Sweep, page, run, table};
use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

const JOB: &str = r#"
format = 1
[part]
builtin = { kind = "plane", half_size_mm = 5 }
[tool]
kind = "ball"
diameter_mm = 6
length_mm = 40
teeth = 2
[tolerance]
scallop_mm = 0.1
[strategy]
kind = "isoparametric"
lead_deg = 10
[cutting]
spindle_rpm = 8000
[machine]
name = "trunnion-ac"
dialect = "linuxcnc"
feed = "tcp"
"#;
const SHARDS: usize = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let wanted: usize = std::env::args().nth(1).map_or(Ok(10_000), |n| n.parse())?;
    let folder = std::env::temp_dir().join(format!("osculate-sweep-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let told = scale(wanted, &folder);
    std::fs::remove_dir_all(&folder)?;
    told
}

fn scale(wanted: usize, folder: &Path) -> Result<(), Box<dyn Error>> {
    std::fs::write(folder.join("job.toml"), JOB)?;
    let leads = wanted.div_ceil(100);
    let list = |n: usize, of: fn(usize) -> f64| {
        (0..n).map(|k| format!("{:?}", of(k))).collect::<Vec<_>>().join(", ")
    };
    let text = format!(
        "format = 1\njob = \"job.toml\"\n[[vary]]\nkey = \"tool.diameter_mm\"\nvalues = [{}]\n\
         [[vary]]\nkey = \"tolerance.scallop_mm\"\nvalues = [{}]\n[[vary]]\nkey = \"cutting.feed_mm_min\"\nvalues = [{}]\n",
        list(10, |k| 4.0 + k as f64),
        list(10, |k| 0.01 * (k + 1) as f64),
        list(leads, |k| 500.0 + k as f64),
    );
    std::fs::write(folder.join("sweep.toml"), text)?;
    let mut begin = Instant::now();
    let mut took = |what: &str| {
        println!("{what:<44} {:>8.2} s", begin.elapsed().as_secs_f64());
        begin = Instant::now();
    };
    let sweep = Sweep::load(&folder.join("sweep.toml"))?;
    let numbers: Vec<usize> = (1..=sweep.cases()).collect();
    let refused = run::checked(&sweep, &numbers)?;
    took(&format!("{} cases expanded and checked, {} refused", numbers.len(), refused.count));
    for which in 1..=SHARDS {
        let shard = Shard { which, of: SHARDS };
        let mut file = std::io::BufWriter::new(std::fs::File::create(shard.file(folder))?);
        for number in shard.numbers(sweep.cases()) {
            let case = sweep.case(number)?;
            let (strategy, tool) = ("isoparametric".to_owned(), "ball".to_owned());
            let numbers = [Some(1.0 / number as f64); NAMES.len()];
            let figures = Some(Figures { strategy, tool, passes: number, points: number, numbers });
            let (answer, why) = ("held".to_owned(), String::new());
            let row = Row { case: number, key: case.key, answer, why, figures, wall_s: 0.0 };
            writeln!(file, "{}", serde_json::to_string(&row)?)?;
        }
        file.flush()?;
    }
    took(&format!("rows of {SHARDS} shards written"));
    let rows = Rows::read(folder, &|n| sweep.case(n).ok().map(|c| c.key))?;
    let all: Vec<&Row> = rows.all().collect();
    assert_eq!(all.len(), sweep.cases());
    took("rows read, each held against its case");
    let csv = table::csv(&sweep, all.iter().copied());
    took(&format!("table, {} lines", csv.lines().count()));
    let html = page::of(&sweep, &all);
    took(&format!("page, {:.1} MB", html.len() as f64 / 1e6));
    Ok(())
}
