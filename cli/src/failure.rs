//! What ends a command early, and with which exit code.

use crate::job::problem::Problem;
use osculate_geom::{Diagnostic, Severity};
use std::io::{BufRead, BufReader, Read};
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
    /// Exit code 1 after everything was said: words were left out that may change the tool's way.
    Incomplete,
}

/// Bytes of a file at most.
const LARGEST_FILE: u64 = 4 << 30;
/// Bytes of what is no plain file at most: a device may have no end.
const LARGEST_STREAM: u64 = 256 << 20;

impl Done {
    /// Of a text that was read with these findings.
    #[must_use]
    pub fn with(found: &[Diagnostic]) -> Self {
        if found.iter().any(|d| d.severity == Severity::Loss) { Self::Incomplete } else { Self::Yes }
    }
}

/// The bytes of a file.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let unread = |e: std::io::Error| Failure::file(path, format!("cannot be read: {e}"));
    let file = std::fs::File::open(path).map_err(unread)?;
    let plain = file.metadata().map_err(unread)?.is_file();
    let most = if plain { LARGEST_FILE } else { LARGEST_STREAM };
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes).map_err(unread)?;
    if bytes.len() as u64 > most {
        let what = if plain { "" } else { "is no plain file and " };
        return Err(Failure::file(path, format!("{what}has more than {} MiB", most >> 20)));
    }
    Ok(bytes)
}

/// Bytes of a line of a program at most.
const LONGEST_LINE: u64 = 1 << 16;

/// Reads a file line by line; bytes that are no UTF-8 come as replacement characters, as in comments of old programs.
///
/// # Errors
/// Where it cannot be read or a line has no end, and those of `line`.
pub fn each_line(path: &Path, mut line: impl FnMut(&str) -> Result<(), Failure>) -> Result<(), Failure> {
    let unread = |e: std::io::Error| Failure::file(path, format!("cannot be read: {e}"));
    let mut reader = BufReader::new(std::fs::File::open(path).map_err(unread)?);
    let mut bytes = Vec::new();
    let mut number = 0;
    loop {
        bytes.clear();
        number += 1;
        let count = reader.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut bytes).map_err(unread)?;
        if count == 0 {
            return Ok(());
        }
        if count as u64 > LONGEST_LINE {
            let text = format!("line {number}: longer than {LONGEST_LINE} bytes: this is no program");
            return Err(Failure::file(path, text));
        }
        line(String::from_utf8_lossy(&bytes).trim_end_matches(['\r', '\n']))?;
    }
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
