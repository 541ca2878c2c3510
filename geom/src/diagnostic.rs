//! Findings that do not stop the work: what was noticed, where, and what it means for the result.

use std::fmt;

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing, the result is as asked.
    Note,
    /// The result differs from what was asked in the way that the message says.
    Warning,
    /// Something was lost: an entity, a face, a pass.
    Loss,
}

/// One finding, returned beside a value.
///
/// ```
/// use osculate_geom::{Diagnostic, Severity};
/// let lost = Diagnostic::loss("#42", "a face without edges is left out");
/// assert_eq!(lost.severity, Severity::Loss);
/// // Findings are shown one a line, with the place.
/// assert!(lost.to_string().contains("#42") && lost.to_string().contains("left out"));
/// // The worst of many.
/// let all = [Diagnostic::note("", "2 faces"), lost];
/// assert_eq!(all.iter().map(|d| d.severity).max(), Some(Severity::Loss));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How much it matters.
    pub severity: Severity,
    /// Where: a line, an entity, a face, a block. Empty where it concerns the whole.
    pub place: String,
    /// What was found and what it means.
    pub message: String,
}

impl Diagnostic {
    /// A note.
    pub fn note(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, place: place.into(), message: message.into() }
    }
    /// A warning.
    pub fn warning(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, place: place.into(), message: message.into() }
    }
    /// A loss.
    pub fn loss(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { severity: Severity::Loss, place: place.into(), message: message.into() }
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.severity {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Loss => "lost",
        };
        if self.place.is_empty() {
            write!(f, "{kind}: {}", self.message)
        } else {
            write!(f, "{kind}: {}: {}", self.place, self.message)
        }
    }
}
