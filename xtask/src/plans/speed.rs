//! `cargo xtask plans --speed`: how long planning takes, and how much memory.
//!
//! A plane of 100 x 100 mm by every strategy that has lines there, `auto` over five tools on it, and a dish by a path of a
//! million points beside half and a quarter of it: what a point costs is to stay the same.

use crate::cmd::{Failure, write};
use crate::measured;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

const PLANE: &str = "builtin = { kind = \"plane\", half_size_mm = 50 }";
const DISH: &str =
    "builtin = { kind = \"paraboloid\", a_per_mm = -0.001, b_per_mm = -0.001, half_size_mm = 100 }";
const BALL: &str = "{ kind = \"ball\", diameter_mm = 10, length_mm = 80 }";
const FIVE: &str = "{ kind = \"ball\", diameter_mm = 10, length_mm = 80 },\n  { kind = \"ball\", diameter_mm = 16, length_mm = 80 },\n  \
    { kind = \"flat\", diameter_mm = 12, length_mm = 80 },\n  { kind = \"toroidal\", diameter_mm = 16, corner_radius_mm = 2, length_mm = 80 },\n  \
    { kind = \"toroidal\", diameter_mm = 20, corner_radius_mm = 3, length_mm = 80 }";

/// A job of this section of a part.
fn job(part: &str, tools: &str, strategy: &str, tolerance: &str) -> String {
    format!(
        "format = 1\ntools = [\n  {tools}\n]\n[part]\n{part}\n[tolerance]\n{tolerance}\n[strategy]\nkind = \"{strategy}\"\n\
         [cutting]\nspindle_rpm = 12000\nfeed_mm_min = 2000\n[machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n\
         feed = \"inverse_time\"\n[verification]\nmax_samples = 20000\n"
    )
}

/// Runs a job and prints a row: points, length, the seconds of the stages, all of it, and the greatest memory.
fn one(name: &str, text: &str, program: &Path, place: &Path) -> Result<(), Failure> {
    let folder = place.join(name.replace([' ', ','], "-"));
    let file = folder.join("job.toml");
    write(&file, text)?;
    let mut plan = Command::new(program);
    plan.arg("plan").arg(&file).arg("--out").arg(&folder);
    let ran = measured::run(plan)?;
    let (wall_s, memory) = (ran.wall_s, ran.memory_mb.map_or("-".to_owned(), |mb| format!("{mb:.0} MB")));
    let text = std::fs::read_to_string(folder.join("summary.json")).unwrap_or_default();
    let s: Value = serde_json::from_str(&text).unwrap_or_default();
    let n = |v: &Value, digits: usize| v.as_f64().map_or("-".to_owned(), |x| format!("{x:.digits$}"));
    let w = &s["wall_s"];
    println!(
        "| {name} | {} | {} | {} | {} | {} | {} | {wall_s:.2} | {memory} | {} |",
        n(&s["points"], 0),
        n(&s["cutting_length_mm"], 0),
        n(&w["plan"], 2),
        n(&w["post"], 2),
        n(&w["verify"], 2),
        n(&w["ideal"], 2),
        s["verification"]["within_tolerance"]
    );
    Ok(())
}

/// Runs those whose names have the text in them.
pub fn run(only: &str, program: &Path, root: &Path) -> Result<(), Failure> {
    let place = root.join("target/plans/speed");
    println!(
        "| job | CL points | length mm | plan s | post s | verify s | ideal s | all s | memory | within |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut jobs: Vec<(String, String)> = Vec::new();
    for strategy in ["isoparametric", "isoplanar", "isoscallop", "streamline", "isoplanar_3c"] {
        jobs.push((format!("plane, {strategy}"), job(PLANE, BALL, strategy, "scallop_mm = 0.005")));
    }
    let five = job(PLANE, FIVE, "auto", "scallop_mm = 0.005");
    jobs.push(("plane, auto over five tools".to_owned(), five));
    // Passes half as far apart for a quarter of the scallop.
    for (part, scallop_mm) in [("a quarter", 0.032), ("half", 0.008), ("a million points", 0.002)] {
        let tolerance = format!("scallop_mm = {scallop_mm}\ngouge_mm = 0.001\nchord_mm = 0.000005");
        jobs.push((format!("dish, {part}"), job(DISH, BALL, "isoparametric", &tolerance)));
    }
    for (name, text) in jobs.iter().filter(|j| j.0.contains(only)) {
        one(name, text, program, &place)?;
    }
    Ok(())
}
