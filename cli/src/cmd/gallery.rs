//! `gallery`: the surfaces with a name.

use crate::screen::render;
use osculate::failure::{Done, Outcome};
use osculate_surfaces::gallery::ENTRIES;

/// Runs the verb.
pub fn run(json: bool) -> Outcome {
    if json {
        let rows = ENTRIES.map(|e| {
            serde_json::json!({ "name": e.name, "source": e.source, "properties": e.properties, "keys": e.keys })
        });
        render::json(&rows)?;
        return Ok(Done::Yes);
    }
    let width = ENTRIES.iter().map(|e| e.name.len()).max().unwrap_or(0);
    let mut out = String::from("\n");
    for e in &ENTRIES {
        out.push_str(&format!("  {:width$}  {}\n", e.name, e.properties));
        out.push_str(&format!("  {:width$}  {}\n", "", e.source));
        let keys = if e.keys.is_empty() { String::new() } else { format!(", {}", e.keys) };
        out.push_str(&format!("  {:width$}  --builtin 'kind = \"{}\"{keys}'\n\n", "", e.name));
    }
    out.push_str("  Every one takes material = \"inside\" or \"outside\", u_range and v_range too.\n\n");
    render::text(&out)?;
    Ok(Done::Yes)
}
