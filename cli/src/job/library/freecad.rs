//! Tool bits of FreeCAD: a bit is a file of JSON (`.fctb`) with `shape` and `parameter`, a library (`.fctl`) names bits by their files.
//!
//! A parameter is a text with its unit ("6.0000 mm", "0.25 in") or a bare number in mm. FreeCAD has the whole length of a bit and not what
//! stands out of the holder, and no holders: what is written here says both in `attribute`, which FreeCAD keeps and does not use.

use super::found::{Found, bare};
use crate::job::Tool;
use crate::job::raw::{self, Holder};
use crate::job::words::ToolKind;
use osculate_geom::Diagnostic;
use osculate_tools::HolderSpec;
use serde_json::{Value, json};

/// What a bit has in `attribute` of what FreeCAD does not know.
const OUT: &str = "OutOfHolder";
const HOLDER: &str = "Holder";

/// The bits that a library names: number and file.
///
/// # Errors
/// Where the text is no library.
pub(super) fn listed(text: &str) -> Result<Vec<(u32, String)>, String> {
    let all: Value = serde_json::from_str(text).map_err(|e| format!("is no JSON: {e}"))?;
    let tools = all["tools"].as_array().ok_or("has no list `tools`: it is no tool library of FreeCAD")?;
    tools
        .iter()
        .zip(1..)
        .map(|(t, place): (_, u32)| {
            let path = t["path"].as_str().ok_or(format!("tool {place} of the list names no file (path)"))?;
            let number = t["nr"].as_u64().and_then(|n| u32::try_from(n).ok()).unwrap_or(place);
            Ok((number, path.to_owned()))
        })
        .collect()
}

/// Reads a bit into what was found; `number` is that of the library.
pub(super) fn read(text: &str, place: &str, number: Option<u32>, found: &mut Found) {
    match one(text, number) {
        Ok((tool, told)) => {
            found.tools.push((place.to_owned(), tool));
            found.diagnostics.extend(told.map(|what| Diagnostic::warning(place, what)));
        }
        Err(why) => found.diagnostics.push(Diagnostic::warning(place, format!("left out: {why}"))),
    }
}

fn one(text: &str, number: Option<u32>) -> Result<(raw::Tool, Option<String>), String> {
    let bit: Value = serde_json::from_str(text).map_err(|e| format!("is no JSON: {e}"))?;
    let shape = bit["shape"].as_str().ok_or("has no `shape`: it is no tool bit of FreeCAD")?;
    let parameter = &bit["parameter"];
    let length = |key: &str| mm(&parameter[key]).map_err(|why| format!("{key}: {why}"));
    let stem = shape.rsplit('/').next().unwrap_or(shape).trim_end_matches(".fcstd").to_lowercase();
    let kind = match stem.as_str() {
        "endmill" => ToolKind::Flat,
        "ballend" => ToolKind::Ball,
        "bullnose" | "torus" => ToolKind::Toroidal,
        other => {
            return Err(format!(
                "the shape {other} is no cutter of a job: there are endmill, ballend and bullnose"
            ));
        }
    };
    if parameter.get("TaperAngle").is_some() {
        return Err(format!("it has a TaperAngle, which the shape {stem} does not show"));
    }
    let diameter_mm = length("Diameter")?.ok_or("it has no Diameter")?;
    let whole = length("Length")?;
    let out = mm(&bit["attribute"][OUT])?;
    let length_mm = out.or(whole);
    let flute = length("CuttingEdgeHeight")?.filter(|f| length_mm.is_some_and(|l| *f < l));
    let teeth = &parameter["Flutes"];
    let teeth = teeth.as_u64().or_else(|| teeth.as_str()?.trim().parse().ok());
    let mut tool = raw::Tool {
        name: bit["name"].as_str().map(str::to_owned),
        number,
        length_mm,
        flute_length_mm: flute,
        teeth: teeth.and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0),
        holder: holder(&bit["attribute"][HOLDER])?,
        ..bare(kind, diameter_mm)
    };
    if kind == ToolKind::Toroidal {
        let corner = match (length("CornerRadius")?.or(length("TorusRadius")?), length("FlatRadius")?) {
            (Some(corner), _) => corner,
            (None, Some(flat)) => 0.5 * diameter_mm - flat,
            (None, None) => {
                return Err("a bull nose without CornerRadius, TorusRadius or FlatRadius".to_owned());
            }
        };
        tool.corner_radius_mm = Some(corner);
    }
    let told = (out.is_none() && whole.is_some())
        .then(|| "FreeCAD has its whole length and not what stands out of the holder: length_mm is the whole length".to_owned());
    Ok((tool, told))
}

/// A length with its unit, mm; `None` where there is none. FreeCAD writes numbers as the user's language does, with a comma as well.
fn mm(value: &Value) -> Result<Option<f64>, String> {
    if let Some(bare) = value.as_f64() {
        return Ok(Some(bare));
    }
    let Some(text) = value.as_str() else { return Ok(None) };
    let text = text.trim();
    let split = text.find(|c: char| !(c.is_ascii_digit() || "+-.,eE".contains(c))).unwrap_or(text.len());
    let (number, unit) = (text[..split].trim(), text[split..].trim());
    // With both of them nobody knows which is the decimal point: that is no number.
    let number: f64 = number.replace(',', ".").parse().map_err(|_| format!("{text:?} is no length"))?;
    let unit_mm = match unit {
        "" | "mm" => 1.0,
        "cm" => 10.0,
        "m" => 1000.0,
        "\u{b5}m" | "um" => 1e-3,
        "in" | "\"" => 25.4,
        other => return Err(format!("{other:?} is no unit of length: there are mm, cm, m, um, in")),
    };
    Ok(Some(number * unit_mm))
}

/// The sections that [`write`] says.
fn holder(value: &Value) -> Result<Option<Holder>, String> {
    let Some(text) = value.as_str() else { return Ok(None) };
    let section = |s: &str| -> Option<HolderSpec> {
        let mut numbers = s.split(['/', 'x']).map(|n| n.trim().parse::<f64>().ok());
        let (lower, upper, length) = (numbers.next()??, numbers.next()??, numbers.next()??);
        Some(HolderSpec {
            diameter_mm: lower,
            length_mm: length,
            upper_diameter_mm: (upper != lower).then_some(upper),
        })
    };
    let all: Option<Vec<HolderSpec>> = text.split(',').map(section).collect();
    all.map(|all| Some(Holder::Several(all)))
        .ok_or(format!("{HOLDER}: {text:?} is no list of diameter/diameter x length"))
}

/// The tools as a library and its bits: the file of each with its text; what they cannot hold is told.
pub(super) fn write(tools: &[Tool], label: &str) -> (String, Vec<(String, String)>, Vec<Diagnostic>) {
    let mut told = Vec::new();
    let mut bits = Vec::new();
    let mut list = Vec::new();
    for tool in tools {
        let shape = match tool.kind() {
            ToolKind::Flat => ("endmill.fcstd", "Endmill"),
            ToolKind::Ball => ("ballend.fcstd", "Ballend"),
            ToolKind::Toroidal => ("bullnose.fcstd", "Bullnose"),
            other => {
                let what = format!("left out: FreeCAD has no shape for the kind {}", other.word());
                told.push(Diagnostic::warning(tool.words(), what));
                continue;
            }
        };
        if tool.feeding().spindle_rpm.is_some() || tool.feeding().feed_mm_min.is_some() {
            let what =
                "spindle and feed are not kept: FreeCAD has them in a tool controller and not in a bit";
            told.push(Diagnostic::note(tool.words(), what));
        }
        let cutter = tool.cutter();
        let text = |x: f64| format!("{:.4} mm", x);
        let diameter = 2.0 * cutter.radius_mm();
        let mut parameter = json!({
            "Diameter": text(diameter), "Length": text(cutter.length_mm()), "ShankDiameter": text(diameter),
            "CuttingEdgeHeight": text(tool.flutes().0.length_mm()),
        });
        if tool.kind() == ToolKind::Toroidal {
            parameter["CornerRadius"] = json!(text(cutter.corner_mm()));
            parameter["FlatRadius"] = json!(text(cutter.radius_mm() - cutter.corner_mm()));
        }
        if let Some(teeth) = tool.teeth() {
            parameter["Flutes"] = json!(teeth);
        }
        let mut attribute = json!({ OUT: text(cutter.length_mm()) });
        let section = |s: &HolderSpec| {
            format!("{}/{} x {}", s.diameter_mm, s.upper_diameter_mm.unwrap_or(s.diameter_mm), s.length_mm)
        };
        let sections: Vec<String> = tool.holder_sections().iter().map(section).collect();
        if !sections.is_empty() {
            attribute[HOLDER] = json!(sections.join(", "));
        }
        let bit = json!({
            "version": 2, "name": tool.words(), "shape": shape.0, "shape-type": shape.1, "parameter": parameter, "attribute": attribute,
        });
        let file = format!("{}-T{}.fctb", label, tool.number());
        list.push(json!({"nr": tool.number(), "path": file}));
        bits.push((file, serde_json::to_string_pretty(&bit).unwrap_or_default() + "\n"));
    }
    let library = json!({"label": label, "tools": list, "version": 1});
    (serde_json::to_string_pretty(&library).unwrap_or_default() + "\n", bits, told)
}
