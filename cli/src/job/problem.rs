//! What is wrong in a job file: where, what was expected instead, and what is nearest to what was written.

use crate::failure::Failure;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A wrong key or value.
#[derive(Debug, Clone, Default, Serialize, PartialEq, Eq)]
pub struct Problem {
    /// The sentence.
    pub what: String,
    /// File, line and key.
    #[serde(rename = "where")]
    pub place: String,
    /// What may stand there.
    pub expected: String,
    /// The key or word that is nearest to what stands there.
    pub nearest: String,
    /// All of it, for a person.
    #[serde(skip)]
    pub message: String,
}

/// A job file by its lines: where each key stands.
#[derive(Debug, Clone, Default)]
pub struct Places {
    path: PathBuf,
    lines: BTreeMap<String, usize>,
    /// Tables that stand elsewhere in this file than their names say: by the name, where.
    moved: Vec<(String, String)>,
}

/// The name of a key with that of its table.
pub fn full(table: &str, key: &str) -> String {
    match (table, key) {
        ("", k) => k.to_owned(),
        (t, "") => t.to_owned(),
        (t, k) => format!("{t}.{k}"),
    }
}

/// A table as people write it.
pub fn shown(table: &str) -> String {
    let Some((list, (number, rest))) = table.split_once('[').and_then(|(l, t)| Some((l, t.split_once(']')?)))
    else {
        return if table.is_empty() { String::new() } else { format!("[{table}] ") };
    };
    let own = if list == "tools" { "tool" } else { list };
    let rest = rest.strip_prefix('.').map(|r| format!("[{own}.{r}] "));
    format!("[[{list}]] number {number}: {}", rest.unwrap_or_default())
}

impl Places {
    /// No places yet.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf(), lines: BTreeMap::new(), moved: Vec::new() }
    }

    /// The same file, with tables that are found elsewhere in it: by their names, where.
    #[must_use]
    pub fn with(&self, moved: Vec<(String, String)>) -> Self {
        Self { moved, ..self.clone() }
    }

    /// Where a table stands in the file.
    fn stands(&self, table: &str) -> String {
        let found = self.moved.iter().find_map(|(name, at)| {
            let rest = table.strip_prefix(name.as_str())?;
            (rest.is_empty() || rest.starts_with('.')).then(|| format!("{at}{rest}"))
        });
        found.unwrap_or_else(|| table.to_owned())
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps the line of a key or table.
    pub fn keep(&mut self, table: &str, key: &str, line: usize) {
        self.lines.entry(full(table, key)).or_insert(line);
    }

    /// Whether a key is given.
    pub fn has(&self, table: &str, key: &str) -> bool {
        self.lines.contains_key(&full(&self.stands(table), key))
    }

    /// A failure at a key, or at its table where the key is not given.
    pub fn refuse(&self, table: &str, key: &str, what: impl Display) -> Failure {
        self.full(table, key, what, String::new(), None)
    }

    /// A failure at a key, of something that has been found wrong already and says itself what is nearest.
    pub fn lacks(&self, table: &str, key: &str, found: Problem) -> Failure {
        match self.full(table, key, found.what, found.expected, None) {
            Failure::Input(mut p) => {
                p.nearest = found.nearest;
                Failure::Input(p)
            }
            other => other,
        }
    }

    /// A failure with what was expected and what is nearest.
    pub fn full(
        &self,
        table: &str,
        key: &str,
        what: impl Display,
        expected: String,
        nearest: Option<&str>,
    ) -> Failure {
        let stands = self.stands(table);
        let table = stands.as_str();
        let line = self.line(&full(table, key));
        self.at(line, &format!("{}{key}", shown(table)), format!("{}{what}", shown(table)), expected, nearest)
    }

    /// The line of a key, or else of the innermost table around it that is there.
    fn line(&self, key: &str) -> Option<usize> {
        let around = std::iter::successors(Some(key), |k| k.rsplit_once('.').map(|(table, _)| table));
        around.into_iter().find_map(|k| self.lines.get(k)).copied()
    }

    /// A failure at a line.
    pub fn at(
        &self,
        line: Option<usize>,
        place: &str,
        what: String,
        expected: String,
        nearest: Option<&str>,
    ) -> Failure {
        let path = self.path.display();
        let line_words = line.map(|n| format!("line {n}: ")).unwrap_or_default();
        let near = nearest.map(|n| format!(" (is {n} meant?)")).unwrap_or_default();
        let number = line.map(|n| format!(":{n}")).unwrap_or_default();
        Failure::Input(Box::new(Problem {
            message: format!("{path}: {line_words}{what}{near}"),
            what,
            place: format!("{path}{number} {}", place.trim_end()).trim_end().to_owned(),
            expected,
            nearest: nearest.unwrap_or_default().to_owned(),
        }))
    }
}
