//! `machines`, `dialects`, `tools`: what is built in.

use crate::cutter_keys;
use crate::failure::{Done, Failure, Outcome};
use crate::render::{self, Table};
use osculate_postproc::nc::Dialect;
use osculate_postproc::{Machine, built_in_names};
use serde::Serialize;

#[derive(Serialize)]
struct MachineRow {
    name: String,
    description: String,
    joints: Vec<String>,
}

/// Runs `machines`.
pub fn machines(json: bool) -> Outcome {
    let mut rows = Vec::new();
    for name in built_in_names() {
        let m = Machine::built_in(name).map_err(Failure::job)?;
        rows.push(MachineRow {
            name: m.name().to_owned(),
            description: m.description().to_owned(),
            joints: m.joints().iter().map(|j| j.letter.clone()).collect(),
        });
    }
    if json {
        render::json(&rows)?;
        return Ok(Done::Yes);
    }
    let mut t = Table::new(["machine", "joints, part to tool"]);
    for r in &rows {
        t.row([r.name.clone(), r.joints.join(" ")]);
    }
    render::text(&format!("\n{}\n", t.render()));
    for r in rows.iter().filter(|r| !r.description.is_empty()) {
        render::text(&format!("  {}: {}\n", r.name, r.description));
    }
    render::text("\n");
    Ok(Done::Yes)
}

/// Runs `dialects`.
pub fn dialects(json: bool) -> Outcome {
    let rows: Vec<[&str; 2]> = Dialect::ALL.iter().map(|d| [d.name(), d.extension()]).collect();
    if json {
        render::json(
            &rows
                .iter()
                .map(|[name, extension]| serde_json::json!({ "name": name, "extension": extension }))
                .collect::<Vec<_>>(),
        )?;
        return Ok(Done::Yes);
    }
    let mut t = Table::new(["dialect", "extension"]);
    for [name, extension] in rows {
        t.row([name.to_owned(), extension.to_owned()]);
    }
    render::text(&format!("\n{}\n", t.render()));
    Ok(Done::Yes)
}

/// Runs `tools`.
pub fn tools(json: bool) -> Outcome {
    let rows = cutter_keys::KINDS.map(|(kind, needs, may)| {
        let optional = may.iter().copied().chain(["length_mm"]).map(|k| format!("[{k}]"));
        let keys: Vec<String> = needs.iter().map(ToString::to_string).chain(optional).collect();
        (kind, keys.join(", "))
    });
    if json {
        render::json(&rows.map(|(kind, keys)| serde_json::json!({ "kind": kind, "keys": keys })))?;
        return Ok(Done::Yes);
    }
    let mut t = Table::new(["kind", "keys"]);
    for (kind, keys) in rows {
        t.row([kind.to_owned(), keys]);
    }
    render::text(&format!("\n{}\n", t.render()));
    Ok(Done::Yes)
}
