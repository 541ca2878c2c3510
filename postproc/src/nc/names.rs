//! The names that a text has, which must be known before its first move.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Dialect;
use super::flow::Kept;
use super::token::{Word, words};
use crate::machine::Machine;

/// The names of the axes in a text: an axis that is never named rests at zero. And its subprograms and loops, from the first one on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    dialect: Dialect,
    all: BTreeSet<String>,
    /// Axes of the machine that no line has named yet.
    missing: Vec<String>,
    kept: Arc<Kept>,
}

impl Names {
    /// Before the first line.
    #[must_use]
    pub fn new(dialect: Dialect, machine: &Machine) -> Self {
        let missing = machine.joints().iter().map(|j| j.letter.clone()).collect();
        Self { dialect, all: BTreeSet::new(), missing, kept: Arc::default() }
    }

    pub(super) const fn dialect(&self) -> Dialect {
        self.dialect
    }

    pub(super) const fn all(&self) -> &BTreeSet<String> {
        &self.all
    }

    pub(super) fn kept(&self) -> Arc<Kept> {
        Arc::clone(&self.kept)
    }

    /// One line.
    pub fn line(&mut self, line: &str) {
        Arc::make_mut(&mut self.kept).line(line, self.dialect);
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
