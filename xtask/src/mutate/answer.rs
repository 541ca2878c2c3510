//! What of an answer is wrong.

use serde_json::Value;
use std::process::ExitStatus;

/// Keys of answers whose values are numbers, or lists of such, by how they end, and beyond what they mean nothing: places are within 1e9 mm,
/// a text has a million moves, and no program runs for ten years.
const MEASURED: [(&str, f64); 6] =
    [("_mm", 1e15), ("_mm2", 1e22), ("_mm3", 1e30), ("_min", 5.3e6), ("_per_mm", 1e100), ("_mm_min", 1e10)];

/// Those of them that are absent where nothing is known: the ends of a histogram, what nothing bounds, radii of what is flat, marks of tools
/// whose speed nobody says, what only one way to set the side of a cutter has.
const OPEN: [&str; 10] = [
    "from_mm",
    "to_mm",
    "hidden_scallop_mm",
    "hidden_gouge_mm",
    "smallest_radius_mm",
    "hollow_radius_mm",
    "tooth_mark_max_mm",
    "h0_mm",
    "lower_bound_mm",
    "lower_bound_refined_mm",
];

/// The exit code of a run; 128 and the signal where one ended it.
pub fn code(status: ExitStatus) -> i32 {
    #[cfg(unix)]
    let signal = std::os::unix::process::ExitStatusExt::signal(&status);
    #[cfg(not(unix))]
    let signal: Option<i32> = None;
    status.code().or(signal.map(|s| 128 + s)).unwrap_or(-1)
}

/// What is wrong with a run, in words.
pub fn wrong(code: i32, stdout: &[u8], stderr: &str) -> Option<String> {
    if let Some(place) = stderr.lines().find(|l| l.contains("panicked at")) {
        return Some(format!("panic, {place}"));
    }
    match code {
        0 => serde_json::from_slice::<Value>(stdout).ok().and_then(|v| nonsense(&v, "")),
        1 | 2 => None,
        // SIGXCPU and SIGKILL.
        152 | 137 => Some("out of time or memory".to_owned()),
        134 => Some(format!("aborted: {}", stderr.lines().next().unwrap_or_default())),
        other => Some(format!("ended with {other}: {}", stderr.lines().next().unwrap_or_default())),
    }
}

/// A measured value that is no number, or beyond all measure.
fn nonsense(value: &Value, key: &str) -> Option<String> {
    // The longest ending that fits: mm/min are no minutes.
    let measured = MEASURED.iter().filter(|(end, _)| key.ends_with(end)).max_by_key(|(end, _)| end.len());
    match value {
        Value::Null if measured.is_some() && !OPEN.contains(&key) => {
            Some(format!("success with {key} = null"))
        }
        Value::Number(n) if measured.is_some_and(|(_, most)| n.as_f64().is_none_or(|x| x.abs() > *most)) => {
            Some(format!("success with {key} = {n}"))
        }
        Value::Array(all) => all.iter().find_map(|v| nonsense(v, key)),
        Value::Object(all) => all.iter().find_map(|(k, v)| nonsense(v, k)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_is_told_and_refusals_are_right() {
        let wrong = |code: i32, out: &str, err: &str| wrong(code, out.as_bytes(), err);
        assert_eq!(wrong(1, "", "osculate: no"), None);
        assert_eq!(wrong(0, r#"{"area_mm2": 3.0, "name": null}"#, ""), None);
        assert!(wrong(0, r#"{"faces": [{"area_mm2": null}]}"#, "").is_some_and(|w| w.contains("area_mm2")));
        assert!(wrong(0, r#"{"bbox_mm": [0, null]}"#, "").is_some());
        assert!(wrong(0, r#"{"from_mm": null}"#, "").is_none());
        assert!(
            wrong(0, r#"{"time_min": 1e300}"#, "").is_some()
                && wrong(0, r#"{"time_min": 1e7}"#, "").is_some()
        );
        assert!(wrong(0, r#"{"feed_mm_min": 1e8}"#, "").is_none());
        assert!(wrong(101, "", "thread 'main' panicked at a.rs:1:2:").is_some_and(|w| w.contains("a.rs")));
        assert!(wrong(152, "", "").is_some() && wrong(139, "", "").is_some());
    }
}
