//! Tool libraries of Fusion (`.json`): `data` is a list of tools with `geometry` by the letters of ISO 13399, `holder`, and presets.
//!
//! DC is the diameter, RE the corner radius, LB what stands out of the holder, LCF the length of the
//! flutes, NOF the number of teeth. Segments of a holder go from its nose upwards. Every tool has its own unit, and so has its holder.

use super::found::{Found, bare};
use crate::job::raw;
use crate::job::words::{CoolantWord, ToolKind};
use crate::job::{Tool, raw::Holder};
use osculate_geom::Diagnostic;
use osculate_tools::HolderSpec;
use serde_json::{Value, json};

/// Millimetres of an inch.
const INCH_MM: f64 = 25.4;

/// Reads a library.
///
/// # Errors
/// Where the text is none.
pub(super) fn read(text: &str) -> Result<Found, String> {
    let all: Value = serde_json::from_str(text).map_err(|e| format!("is no JSON: {e}"))?;
    let data = all["data"].as_array().ok_or("has no list `data`: it is no tool library of Fusion")?;
    let mut found = Found::default();
    for (entry, place) in data.iter().zip(1..) {
        let kind = entry["type"].as_str().unwrap_or_default();
        let said = entry["description"].as_str().unwrap_or_default().trim();
        let place = format!("tool {place} of data ({})", if said.is_empty() { kind } else { said });
        match one(entry, kind, said) {
            Ok(tool) => {
                if entry["unit"].is_null() {
                    let text = "it has no unit: millimeters are taken";
                    found.diagnostics.push(Diagnostic::warning(place.clone(), text));
                }
                found.tools.push((place, tool));
            }
            Err(why) => found.diagnostics.push(Diagnostic::warning(place, format!("left out: {why}"))),
        }
    }
    Ok(found)
}

fn unit_mm(of: &Value) -> Result<f64, String> {
    match of["unit"].as_str() {
        None | Some("millimeters") => Ok(1.0),
        Some("inches") => Ok(INCH_MM),
        Some(other) => Err(format!("unit {other:?}: there are millimeters and inches")),
    }
}

fn one(entry: &Value, kind: &str, said: &str) -> Result<raw::Tool, String> {
    let unit = unit_mm(entry)?;
    let geometry = &entry["geometry"];
    let length = |key: &str| geometry[key].as_f64().filter(|x| *x > 0.0).map(|x| x * unit);
    let kind = match kind {
        "ball end mill" => ToolKind::Ball,
        "flat end mill" => ToolKind::Flat,
        "bull nose end mill" => ToolKind::Toroidal,
        // DC is there the diameter at the tip, and what the cutter measures above the taper is not said.
        "tapered mill" => {
            return Err("the library does not say how wide a tapered mill is above its taper".to_owned());
        }
        other => {
            return Err(format!(
                "{other:?} is no cutter of a job: there are flat, ball and bull nose end mills"
            ));
        }
    };
    let diameter_mm = length("DC").ok_or("it has no diameter DC")?;
    let post = &entry["post-process"];
    let number = post["number"].as_u64().and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0);
    let mut tool = raw::Tool {
        name: (!said.is_empty()).then(|| said.to_owned()),
        number,
        length_mm: length("LB"),
        flute_length_mm: length("LCF"),
        teeth: geometry["NOF"].as_u64().and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0),
        cutting: cutting(entry, unit),
        holder: holder(&entry["holder"], unit)?,
        ..bare(kind, diameter_mm)
    };
    if kind == ToolKind::Toroidal {
        tool.corner_radius_mm = Some(length("RE").ok_or("a bull nose without its corner radius RE")?);
    }
    // Flutes cannot be longer than what stands out.
    if let (Some(flutes), Some(out)) = (tool.flute_length_mm, tool.length_mm) {
        tool.flute_length_mm = (flutes < out).then_some(flutes);
    }
    Ok(tool)
}

/// Spindle and feed of the first preset, or of what older libraries have in its place.
fn cutting(entry: &Value, unit: f64) -> Option<raw::Cutting> {
    let start = &entry["start-values"];
    let preset = start["presets"].get(0).or_else(|| start.get("*"))?;
    let number = |key: &str| preset[key].as_f64().filter(|x| *x > 0.0);
    let coolant = preset["tool-coolant"].as_str().or_else(|| entry["post-process"]["tool-coolant"].as_str());
    let coolant = match coolant {
        Some("flood") => Some(CoolantWord::Flood),
        Some("mist") => Some(CoolantWord::Mist),
        Some("disabled") => Some(CoolantWord::Off),
        _ => None,
    };
    let feed_mm_min = number("v_f").map(|v| v * unit);
    Some(raw::Cutting { spindle_rpm: number("n"), feed_mm_min, coolant, ..raw::Cutting::default() })
}

fn holder(of: &Value, tool_unit: f64) -> Result<Option<Holder>, String> {
    let Some(segments) = of["segments"].as_array().filter(|s| !s.is_empty()) else { return Ok(None) };
    let unit = if of["unit"].is_string() { unit_mm(of)? } else { tool_unit };
    let section = |s: &Value| -> Result<HolderSpec, String> {
        let number = |key: &str| {
            s[key].as_f64().map(|x| x * unit).ok_or(format!("a segment of its holder has no {key}"))
        };
        let (lower, upper) = (number("lower-diameter")?, number("upper-diameter")?);
        Ok(HolderSpec {
            diameter_mm: lower,
            length_mm: number("height")?,
            upper_diameter_mm: (upper != lower).then_some(upper),
        })
    };
    segments.iter().map(section).collect::<Result<Vec<_>, _>>().map(|all| Some(Holder::Several(all)))
}

/// The tools as a library in millimetres; what it cannot hold is told.
pub(super) fn write(tools: &[Tool]) -> (String, Vec<Diagnostic>) {
    let mut told = Vec::new();
    let mut data = Vec::new();
    for tool in tools {
        let kind = match tool.kind() {
            ToolKind::Ball => "ball end mill",
            ToolKind::Flat => "flat end mill",
            ToolKind::Toroidal => "bull nose end mill",
            other => {
                let what = format!("left out: Fusion's libraries have no cutter of kind {}", other.word());
                told.push(Diagnostic::warning(tool.words(), what));
                continue;
            }
        };
        if tool.plunges() {
            told.push(Diagnostic::note(tool.words(), "plunges is not kept: Fusion has no key for it"));
        }
        let cutter = tool.cutter();
        let diameter = 2.0 * cutter.radius_mm();
        let flutes = tool.flutes().0.length_mm();
        let mut geometry = json!({
            "CSP": false, "HAND": true, "DC": diameter, "SFDM": diameter, "LB": cutter.length_mm(), "OAL": cutter.length_mm(),
            "LCF": flutes, "shoulder-length": flutes, "RE": cutter.corner_mm(),
        });
        if let Some(teeth) = tool.teeth() {
            geometry["NOF"] = json!(teeth);
        }
        let feeding = tool.feeding();
        let mut preset = json!({"name": "Default preset"});
        if let Some(n) = feeding.spindle_rpm {
            preset["n"] = json!(n);
        }
        if let Some(v) = feeding.feed_mm_min {
            preset["v_f"] = json!(v);
        }
        if let Some(word) = feeding.coolant {
            preset["tool-coolant"] = json!(if word == CoolantWord::Off { "disabled" } else { word.word() });
        }
        let mut entry = json!({
            "type": kind, "unit": "millimeters", "description": tool.words(), "vendor": "", "product-id": "", "geometry": geometry,
            "post-process": {
                "number": tool.number(), "diameter-offset": tool.number(), "length-offset": tool.number(), "turret": 0, "comment": "",
            },
            "start-values": {"presets": [preset]},
        });
        let segment = |s: &HolderSpec| json!({"height": s.length_mm, "lower-diameter": s.diameter_mm, "upper-diameter": s.upper_diameter_mm.unwrap_or(s.diameter_mm)});
        let segments: Vec<Value> = tool.holder_sections().iter().map(segment).collect();
        if !segments.is_empty() {
            entry["holder"] = json!({"type": "holder", "unit": "millimeters", "description": "holder", "segments": segments});
        }
        data.push(entry);
    }
    let text = serde_json::to_string_pretty(&json!({"data": data, "version": 1})).unwrap_or_default();
    (text + "\n", told)
}
