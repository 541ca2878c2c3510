//! The reference of all job keys, and a commented job file, both made of the schema.

use crate::job::schema::{Key, Kind, Table};
use crate::words;
use std::fmt::Write;

/// The keys that stand in the template without a comment sign: a job that can be run.
const ON: [&str; 11] = [
    "format",
    "part.builtin",
    "tool.kind",
    "tool.diameter_mm",
    "tool.length_mm",
    "tolerance.scallop_mm",
    "tolerance.gouge_mm",
    "tolerance.chord_mm",
    "strategy.kind",
    "machine.name",
    "machine.dialect",
];

/// A key as data.
#[derive(Debug, serde::Serialize)]
pub struct Row {
    /// Table.
    pub table: &'static str,
    /// Key.
    pub key: &'static str,
    /// What it takes.
    pub takes: String,
    /// Unit.
    pub unit: &'static str,
    /// Least and greatest number, where there are any.
    pub range: [Option<f64>; 2],
    /// Words.
    pub words: Vec<&'static str>,
    /// Whether it must be given where its table is.
    pub needed: bool,
    /// What holds where it is not given.
    pub default: &'static str,
    /// A value, as TOML.
    pub example: &'static str,
    /// What it is.
    pub meaning: &'static str,
}

impl Row {
    fn of(table: &Table, key: &Key) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        let (range, unit) = match key.kind {
            Kind::Number(r, unit)
            | Kind::NumberOr(r, unit, _)
            | Kind::Numbers(_, r, unit)
            | Kind::Between(r, unit) => ([finite(r.least), finite(r.most)], unit),
            Kind::Whole(a, b) | Kind::WholeOrTable(a, b) | Kind::WholeOr(a, b, _) => {
                ([Some(a as f64), Some(b as f64)], "")
            }
            Kind::Corners(unit) => ([None; 2], unit),
            _ => ([None; 2], ""),
        };
        Self {
            table: table.name,
            key: key.name,
            takes: key.kind.expects(),
            unit,
            range,
            words: key.kind.words(),
            needed: key.default.is_none(),
            default: key.default.unwrap_or_default(),
            example: key.example,
            meaning: key.meaning,
        }
    }
}

/// All keys as data.
#[must_use]
pub fn rows(tables: &[Table]) -> Vec<Row> {
    tables.iter().flat_map(|t| t.keys.iter().map(move |k| Row::of(t, k))).collect()
}

/// All keys as tables for a screen.
#[must_use]
pub fn text(tables: &[Table]) -> String {
    let mut out = String::new();
    for table in tables {
        if table.keys.is_empty() {
            continue;
        }
        let name = if table.name.is_empty() { String::new() } else { format!("[{}] ", table.name) };
        let mut t = words::Table::left(["key", "takes", "default", "meaning"]);
        for row in table.keys.iter().map(|k| Row::of(table, k)) {
            let default = if row.needed { "must be given" } else { row.default };
            t.row([row.key.to_owned(), row.takes, default.to_owned(), row.meaning.to_owned()]);
        }
        let _ = write!(out, "\n{name}{}\n{}", table.meaning, t.render());
    }
    out + "\n"
}

/// A job file with all keys, those that it does not need as comments.
#[must_use]
pub fn template(tables: &[Table]) -> String {
    let mut out = String::from(
        "# A job of osculate. Keys after # are left out: take the sign away and change the value.\n\
         # Lengths mm, angles deg, feeds mm/min. `osculate plan JOB --out DIR` runs it.\n",
    );
    for table in tables {
        let full = |key: &str| crate::job::problem::full(table.name, key);
        let on = |key: &str| ON.contains(&full(key).as_str());
        if !table.name.is_empty() {
            let sign = if table.keys.iter().any(|k| on(k.name)) { "" } else { "# " };
            let _ = write!(out, "\n# {}\n{sign}[{}]\n", table.meaning, table.name);
        }
        for key in table.keys {
            let sign = if on(key.name) { "" } else { "# " };
            let default = match key.default {
                None | Some("") => String::new(),
                Some(d) => format!(" (left out: {d})"),
            };
            let about = format!("{}: {}{default}", key.meaning, key.kind.expects());
            let _ = writeln!(out, "# {about}\n{sign}{} = {}", key.name, key.example);
        }
    }
    out
}
