//! What ends a command early, and with which exit code.

use crate::job::problem::Problem;
use osculate_geom::{Diagnostic, Severity};
use std::path::{Path, PathBuf};

/// A command that cannot be done, with the message for the user.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Exit code 1: the job cannot be done as asked.
    #[error("{0}")]
    Job(String),
    /// Exit code 1: a key or value of a job cannot be meant.
    #[error("{}", .0.message)]
    Input(Box<Problem>),
    /// Exit code 2: wrong usage.
    #[error("{0}")]
    Usage(String),
}

impl Failure {
    /// The job cannot be done; the message says what, where and what to change.
    pub fn job(message: impl std::fmt::Display) -> Self {
        Self::Job(message.to_string())
    }

    /// Something in a file.
    pub fn file(path: &Path, message: impl std::fmt::Display) -> Self {
        Self::Job(format!("{}: {message}", path.display()))
    }

    /// The failure with what was warned of before: it may be why.
    pub fn warned(self, diagnostics: &[Diagnostic]) -> Self {
        let heavy = diagnostics.iter().filter(|d| d.severity > Severity::Note);
        let warnings: String = heavy.map(|d| format!("\n{d}")).collect();
        match self {
            Self::Job(text) => Self::Job(text + &warnings),
            other => other,
        }
    }

    /// The failure of one operation of a list.
    #[must_use]
    pub fn in_operation(self, name: &str) -> Self {
        match self {
            Self::Job(text) => Self::Job(format!("operation {name}: {text}")),
            other => other,
        }
    }

    /// The exit code.
    pub const fn code(&self) -> u8 {
        match self {
            Self::Job(_) | Self::Input(_) => 1,
            Self::Usage(_) => 2,
        }
    }

    /// The message.
    pub fn message(&self) -> &str {
        match self {
            Self::Job(m) | Self::Usage(m) => m,
            Self::Input(p) => &p.message,
        }
    }

    /// What is wrong, in parts.
    #[must_use]
    pub fn problem(&self) -> Problem {
        match self {
            Self::Input(p) => (**p).clone(),
            Self::Job(m) | Self::Usage(m) => {
                Problem { what: m.clone(), message: m.clone(), ..Problem::default() }
            }
        }
    }
}

/// What commands return: the exit code of a finished command is 0 unless the result itself says no.
pub type Outcome = Result<Done, Failure>;

/// A finished command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// Exit code 0.
    Yes,
    /// Exit code 1 after everything was written: the tolerance is not met.
    NotWithinTolerance,
}

/// The bytes of a file.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|e| Failure::file(path, format!("cannot be read: {e}")))
}

/// The text of a file.
pub fn read_text(path: &Path) -> Result<String, Failure> {
    String::from_utf8(read(path)?).map_err(|e| {
        Failure::file(path, format!("is not UTF-8 text (byte {})", e.utf8_error().valid_up_to()))
    })
}

/// A path in a file, relative to the folder of that file.
pub fn beside(file: &Path, relative: &str) -> PathBuf {
    file.parent().unwrap_or_else(|| Path::new("")).join(relative)
}
