//! The names that a text has, which must be known before its first move.

use std::collections::BTreeSet;

use super::Dialect;
use super::token::{Word, words};
use crate::machine::Machine;

/// The names of the axes in a text: an axis that is never named rests at zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    dialect: Dialect,
    all: BTreeSet<String>,
    /// Axes of the machine that no line has named yet.
    missing: Vec<String>,
}

impl Names {
    /// Before the first line.
    #[must_use]
    pub fn new(dialect: Dialect, machine: &Machine) -> Self {
        let missing = machine.joints().iter().map(|j| j.letter.clone()).collect();
        Self { dialect, all: BTreeSet::new(), missing }
    }

    pub(super) const fn dialect(&self) -> Dialect {
        self.dialect
    }

    pub(super) const fn all(&self) -> &BTreeSet<String> {
        &self.all
    }

    /// One line.
    pub fn line(&mut self, line: &str) {
        if !self.missing.is_empty() {
            note_names(line, self.dialect, &mut self.all);
            self.missing.retain(|letter| !self.all.contains(letter));
        }
    }
}

/// Adds the names of the axes in a line.
fn note_names(line: &str, dialect: Dialect, named: &mut BTreeSet<String>) {
    for word in words(line, dialect).unwrap_or_default() {
        match word {
            Word::Address { name, .. } if !named.contains(&name) => {
                named.insert(name);
            }
            _ => {}
        }
    }
}
