//! Libraries of tools: a file of ours, or a table of another system, as tools of a job.
//!
//! A library of ours is TOML with `format = 1` and the `[[tool]]` tables of a list of operations. Lengths are mm, angles deg, feeds mm/min,
//! whatever unit a foreign file has. What a foreign file says of a tool and a job cannot hold is told, tool by tool; nothing is
//! guessed where a measure is missing.

mod ours;

pub use ours::toml;

use crate::failure::{Failure, read_text};
use crate::job::problem::Places;
use crate::job::{Tool, check, keys, raw, schema};
use osculate_geom::Diagnostic;
use serde::Deserialize;
use std::path::Path;

/// The library that comes with the program.
const SHIPPED: &str = include_str!("../../../data/tools.toml");

/// Tools with what was found on reading them.
#[derive(Debug, Clone)]
pub struct Library {
    /// As tables name it.
    pub format: &'static str,
    /// The tools, in the order of the file.
    pub tools: Vec<Tool>,
    /// Tools that are left out, and what of the others is.
    pub diagnostics: Vec<Diagnostic>,
}

#[derive(Deserialize)]
struct RawLibrary {
    #[allow(dead_code)]
    format: u32,
    #[serde(default)]
    tool: Vec<raw::Tool>,
}

impl Library {
    /// The tools that come with the program.
    ///
    /// # Errors
    /// None: they are checked by a test.
    pub fn shipped() -> Result<Self, Failure> {
        Self::from_toml(SHIPPED, Path::new("the tools of the program"))
    }

    /// The text of the library that comes with the program.
    #[must_use]
    pub const fn shipped_text() -> &'static str {
        SHIPPED
    }

    /// All tables and keys of libraries.
    #[must_use]
    pub fn schema() -> &'static schema::Schema {
        &keys::LIBRARY
    }

    /// The library of a file.
    ///
    /// # Errors
    /// Names the line or the tool, what was expected, and what to change.
    pub fn load(path: &Path) -> Result<Self, Failure> {
        Self::from_toml(&read_text(path)?, path)
    }

    /// The library of a text of ours.
    ///
    /// # Errors
    /// As [`Library::load`].
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, Failure> {
        let places = check::places(text, path, &keys::LIBRARY)?;
        let raw: RawLibrary =
            ::toml::from_str(text).map_err(|e| Failure::file(path, e.to_string().trim_end()))?;
        if raw.tool.is_empty() {
            return Err(Failure::file(path, "holds no tools: give at least one [[tool]]"));
        }
        let tools = made(&places, &raw.tool)?;
        Ok(Self { format: "osculate", tools, diagnostics: Vec::new() })
    }
}

/// The tools of tables; each has a number of its own.
fn made(places: &Places, all: &[raw::Tool]) -> Result<Vec<Tool>, Failure> {
    let mut out: Vec<Tool> = Vec::with_capacity(all.len());
    for (t, place) in all.iter().zip(1..) {
        let table = format!("tool[{place}]");
        let tool = Tool::of(places, &table, (t, place), &raw::Cutting::default())?;
        if out.iter().any(|o| o.number() == tool.number()) {
            let what = format!("number = {} is that of a tool before it", tool.number());
            return Err(places.refuse(&table, "number", what));
        }
        out.push(tool);
    }
    Ok(out)
}
