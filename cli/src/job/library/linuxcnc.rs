//! Tool tables of LinuxCNC (`.tbl`): a line a tool, `T` number, `P` pocket, `Z` length offset, `D` diameter, and a remark after `;`.
//!
//! Such a table says neither what kind of cutter it is nor what stands out of the holder. What is written here says it in the remark,
//! as keys of ours in brackets, which the control does not read; of a table of others the kind is taken from the words of its
//! remark, and a tool whose remark names none is left out. Lengths are in the machine's unit, which the table does not name.

use super::found::{Found, bare};
use super::ours::toml;
use crate::job::words::ToolKind;
use crate::job::{Tool, raw};
use osculate_geom::Diagnostic;
use std::fmt::Write;

/// What a remark has before the keys of ours.
const MARK: &str = " [[tool]] ";

/// Reads a table whose lengths count so many millimetres each.
pub(super) fn read(text: &str, unit_mm: f64) -> Found {
    let mut found = Found::default();
    let mut assumed = Vec::new();
    for (line, number) in text.lines().zip(1..) {
        let (words, remark) = line.split_once(';').unwrap_or((line, ""));
        if words.trim().is_empty() {
            continue;
        }
        let place = format!("line {number}");
        match one(words, remark.trim(), unit_mm) {
            Ok((tool, whole)) => {
                if !whole {
                    assumed.push(format!("T{}", tool.number.unwrap_or_default()));
                }
                found.tools.push((place, tool));
            }
            Err(why) => found.diagnostics.push(Diagnostic::warning(place, format!("left out: {why}"))),
        }
    }
    if !assumed.is_empty() {
        let what = format!(
            "a LinuxCNC table does not say what stands out of the holder: five diameters are taken for {}; kinds are from the remarks",
            assumed.join(", ")
        );
        found.diagnostics.push(Diagnostic::warning("tools", what));
    }
    found
}

/// A line as a tool, and whether it says everything.
fn one(words: &str, remark: &str, unit_mm: f64) -> Result<(raw::Tool, bool), String> {
    let word = |letter: char| {
        let found =
            words.split_whitespace().find_map(|w| w.strip_prefix([letter, letter.to_ascii_lowercase()]));
        found.filter(|v| !v.is_empty())
    };
    let value = |letter: char| -> Result<Option<f64>, String> {
        word(letter)
            .map_or(Ok(None), |v| v.parse().map(Some).map_err(|_| format!("{letter}{v}: {v} is no number")))
    };
    let number = word('T').ok_or("it has no T word")?;
    let number: u32 = number.parse().map_err(|_| format!("T{number}: {number} is no whole number"))?;
    if let Some((name, keys)) = remark.split_once(MARK) {
        let mut tool: raw::Tool = ::toml::from_str(&keys.replace(" | ", "\n"))
            .map_err(|e| format!("T{number}: {}", e.message()))?;
        tool.number = Some(number);
        tool.name = Some(name.to_owned());
        return Ok((tool, true));
    }
    let diameter = value('D')?.filter(|d| *d > 0.0).ok_or(format!("T{number} has no diameter"))?;
    let kind = kind_of(remark).ok_or(format!(
        "T{number}: the remark {remark:?} names none of ball, flat, square, slot, end mill, which says what cutter it is"
    ))?;
    let tool =
        raw::Tool { name: Some(remark.to_owned()), number: Some(number), ..bare(kind, diameter * unit_mm) };
    Ok((tool, false))
}

/// The kind that a remark names.
fn kind_of(remark: &str) -> Option<ToolKind> {
    let lower = remark.to_lowercase();
    let has = |words: &[&str]| words.iter().any(|w| lower.contains(w));
    let other = [
        "drill",
        "tap",
        "chamfer",
        "face mill",
        "facemill",
        "reamer",
        "bull",
        "radius",
        "v-bit",
        "probe",
        "thread",
        "index",
    ];
    let slot = lower.contains("slot drill");
    match () {
        () if has(&other) && !slot => None,
        () if has(&["ball"]) => Some(ToolKind::Ball),
        () if slot || has(&["flat", "square", "slot", "end mill", "endmill", "shank cutter"]) => {
            Some(ToolKind::Flat)
        }
        () => None,
    }
}

/// The tools as a table in mm, with our keys in the remarks.
pub(super) fn write(tools: &[Tool]) -> String {
    let mut out = String::new();
    for tool in tools {
        let n = tool.number();
        let table = toml(tool, n);
        let own = |line: &&str| {
            let key = line.split(" = ").next().unwrap_or_default();
            !line.starts_with('[') && !["number", "name"].contains(&key)
        };
        let keys: Vec<&str> = table.lines().filter(own).collect();
        let above: f64 = tool.holder_sections().iter().map(|s| s.length_mm).sum();
        let name = tool.words().replace(['\n', '\r', ';'], " ");
        let _ = writeln!(
            out,
            "T{n} P{n} Z{:.4} D{:.4} ;{name}{MARK}{}",
            tool.cutter().length_mm() + above,
            2.0 * tool.cutter().radius_mm(),
            keys.join(" | ")
        );
    }
    out
}
