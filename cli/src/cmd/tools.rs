//! `tools LIBRARY`: what stands in a library of tools, and the same as another kind of library.

use crate::screen::args::ToolsArgs;
use crate::screen::{output, render};
use osculate::failure::{Done, Outcome};
use osculate::job::Tool;
use osculate::job::library::{Library, Unit};
use osculate::words::{Table, findings, number};
use std::path::Path;

/// Runs the verb.
pub fn run(args: &ToolsArgs, json: bool) -> Outcome {
    let unit = if args.inch { Unit::Inch } else { Unit::Millimetre };
    let library = match args.library.as_deref() {
        Some(path) if path != Path::new("shipped") => Library::load_in(path, unit)?,
        _ => Library::shipped()?,
    };
    let mut found = library.diagnostics.clone();
    let mut written = Vec::new();
    if let Some(out) = &args.out {
        let read: Vec<&Path> = args.library.iter().map(|p| p.as_path()).collect();
        output::file(out, &read)?;
        let (files, told) = library.files(out)?;
        found.extend(told);
        for (path, text) in &files {
            output::write(path, text.as_bytes())?;
            written.push(path.display().to_string());
        }
    }
    if json {
        let rows: Vec<_> = library.tools.iter().map(row).collect();
        let told: Vec<String> = found.iter().map(ToString::to_string).collect();
        render::json(&serde_json::json!({
            "format": library.format, "tools": rows, "written": written, "diagnostics": told,
        }))?;
        return Ok(Done::Yes);
    }
    let mut t =
        Table::left(["tool", "name", "kind", "D mm", "corner mm", "out mm", "flutes mm", "teeth", "holder"]);
    for tool in &library.tools {
        let cutter = tool.cutter();
        t.row([
            format!("T{}", tool.number()),
            tool.words().to_owned(),
            tool.kind().word().to_owned(),
            number(2.0 * cutter.radius_mm(), 5),
            number(cutter.corner_mm(), 5),
            number(cutter.length_mm(), 5),
            number(tool.flutes().0.length_mm(), 5),
            tool.teeth().map_or_else(|| "-".to_owned(), |n| n.to_string()),
            match tool.holder_sections().len() {
                0 => "none".to_owned(),
                1 => "1 section".to_owned(),
                n => format!("{n} sections"),
            },
        ]);
    }
    let mut text = format!("\n  {}: {} tools\n\n{}", library.format, library.tools.len(), t.render());
    if !found.is_empty() {
        text.push_str(&format!("\n{}", findings(&found)));
    }
    if !written.is_empty() {
        text.push_str(&format!("\n  {}\n", written.join(", ")));
    }
    render::text(&(text + "\n"))?;
    Ok(Done::Yes)
}

fn row(tool: &Tool) -> serde_json::Value {
    let cutter = tool.cutter();
    serde_json::json!({
        "number": tool.number(),
        "name": tool.words(),
        "kind": tool.kind().word(),
        "diameter_mm": 2.0 * cutter.radius_mm(),
        "corner_radius_mm": cutter.corner_mm(),
        "length_mm": cutter.length_mm(),
        "flute_length_mm": tool.flutes().0.length_mm(),
        "teeth": tool.teeth(),
        "holder": tool.holder_sections(),
    })
}
