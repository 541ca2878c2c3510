//! Where the time of a plan goes: the steps from the ideal to the program on its control.

use crate::cmd::Failure;
use serde_json::Value;
use std::path::Path;

/// Lists of operations in `examples`.
pub const PARTS: [&str; 4] = ["blade-platform", "impeller-whole", "mould", "propeller-whole"];

/// The greatest feed of a CL path, mm/min.
fn feed_mm_min(folder: &Path) -> Option<f64> {
    let cl = std::fs::read_to_string(folder.join("path.cl")).ok()?;
    let feeds =
        cl.lines().filter_map(|line| line.strip_prefix("FEDRAT/")?.split(',').next()?.trim().parse().ok());
    feeds.fold(None, |most: Option<f64>, f: f64| Some(most.map_or(f, |m| m.max(f))))
}

/// Numbers of this key over the operations that finish, and cut rest.
fn of_finishing(summary: &Value, key: &str) -> Option<f64> {
    let all = summary["operations"].as_array()?;
    all.iter().filter(|o| o["kind"] == "finish" || o["kind"] == "rest").map(|o| o[key].as_f64()).sum()
}

/// The row of a face or part by its summary in a folder.
pub fn row(name: &str, folder: &Path) -> Result<String, Failure> {
    let file = folder.join("summary.json");
    let text = std::fs::read_to_string(&file).map_err(|why| Failure::Read { path: file, why })?;
    let s: Value = serde_json::from_str(&text).unwrap_or_default();
    let whole = s["operations"].is_array();
    let number = |key: &str| if whole { of_finishing(&s, key) } else { s[key].as_f64() };
    let chosen = s["compared"].as_array().into_iter().flatten().find(|r| r["outcome"] == "holds");
    let path_min = s["cutting_length_mm"].as_f64().zip(feed_mm_min(folder)).map(|(mm, feed)| mm / feed);
    let minutes = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.3}"));
    let cells = [
        s["ideal"]["time_min"].as_f64(),
        chosen.and_then(|r| r["pointwise_min"].as_f64()),
        s["ideal"]["isoparametric_min"].as_f64(),
        path_min.filter(|_| !whole),
        number("cutting_time_min"),
        number("control_cutting_time_min"),
        s["control_time_min"].as_f64(),
    ];
    Ok(format!(
        "| {name} | {} | {} | {} | {} |\n",
        if whole { "several" } else { s["tool_words"].as_str().unwrap_or("-") },
        cells.map(minutes).join(" | "),
        s["efficiency_percent"].as_f64().map_or_else(|| "-".to_owned(), |p| format!("{p:.0}")),
        answer(&s)
    ))
}

/// Whether a plan is within tolerance.
pub fn answer(summary: &Value) -> &'static str {
    match summary["verdict"]["answer"].as_str() {
        Some("held") => "yes",
        Some("not_shown") => "not shown",
        _ => "**no**",
    }
}
