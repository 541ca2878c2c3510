//! What ends a command early, and with which exit code.

use crate::job::problem::Problem;
use crate::job::words::nearest;
use osculate_geom::{Diagnostic, Severity};
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Ids of faces that a message lists at most.
const SHOWN_IDS: usize = 12;

/// A command that cannot be done, with the message for the user.
///
/// ```
/// use osculate::Failure;
///
/// let wrong = Failure::unknown("machine.name", "machine", "trunion-ac", &["3-axis", "trunnion-ac"]);
/// assert_eq!(wrong.problem().nearest, "trunnion-ac");
/// assert!(wrong.message().starts_with("machine.name: there is no machine"));
/// // Programs end with this code, and with 2 where they are called wrongly.
/// assert_eq!((wrong.code(), Failure::Usage("--faces is missing".into()).code()), (1, 2));
/// ```
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Exit code 1: the job cannot be done as asked.
    #[error("{0}")]
    Job(String),
    /// Exit code 1: a key or value of a job cannot be meant.
    #[error("{}", .0.message)]
    Input(Box<Problem>),
    /// Exit code 1: as [`Job`](Self::Job), with the file or the option that it is about.
    #[error("{}", .0.message)]
    At(Box<Problem>),
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
        Self::at(path.display(), message)
    }

    /// Something about a file, or an option of the command line.
    pub fn at(place: impl std::fmt::Display, message: impl std::fmt::Display) -> Self {
        let (place, what) = (place.to_string(), message.to_string());
        Self::At(Box::new(Problem { message: format!("{place}: {what}"), what, place, ..Problem::default() }))
    }

    /// A word that is none of those there are; `what` names its kind: "machine".
    pub fn unknown(place: &str, what: &str, word: &str, known: &[&str]) -> Self {
        let near = nearest(word, known.iter().copied()).unwrap_or_default().to_owned();
        let meant = if near.is_empty() { String::new() } else { format!(" (is {near} meant?)") };
        let expected = known.join(", ");
        let what = format!("there is no {what} {word:?}{meant}; there are {expected}");
        let message = if place.is_empty() { what.clone() } else { format!("{place}: {what}") };
        Self::At(Box::new(Problem { what, place: place.to_owned(), expected, nearest: near, message }))
    }

    /// A face that a part does not have.
    pub fn no_face(id: &str, known: &[&str]) -> Self {
        let near = nearest(id, known.iter().copied()).unwrap_or_default().to_owned();
        let more = if known.len() > SHOWN_IDS { ", ..." } else { "" };
        let expected = known.iter().take(SHOWN_IDS).copied().collect::<Vec<_>>().join(", ") + more;
        let meant = if near.is_empty() { String::new() } else { format!(" (is {near} meant?)") };
        let what = format!("there is no face {id}{meant}; the part has {expected} (see inspect)");
        Self::At(Box::new(Problem {
            message: what.clone(),
            what,
            place: id.to_owned(),
            expected,
            nearest: near,
        }))
    }

    /// The failure with what was warned of before: it may be why.
    pub fn warned(self, diagnostics: &[Diagnostic]) -> Self {
        let heavy = diagnostics.iter().filter(|d| d.severity > Severity::Note);
        let warnings: String = heavy.map(|d| format!("\n{d}")).collect();
        match self {
            Self::Job(text) => Self::Job(text + &warnings),
            Self::At(mut p) => {
                p.message += &warnings;
                p.what += &warnings;
                Self::At(p)
            }
            other => other,
        }
    }

    /// The failure of one operation of a list.
    #[must_use]
    pub fn in_operation(self, name: &str) -> Self {
        match self {
            Self::Job(text) => Self::Job(format!("operation {name}: {text}")),
            Self::At(mut p) => {
                p.message = format!("operation {name}: {}", p.message);
                p.what = format!("operation {name}: {}", p.what);
                Self::At(p)
            }
            other => other,
        }
    }

    /// The exit code.
    pub const fn code(&self) -> u8 {
        match self {
            Self::Job(_) | Self::Input(_) | Self::At(_) => 1,
            Self::Usage(_) => 2,
        }
    }

    /// The message.
    pub fn message(&self) -> &str {
        match self {
            Self::Job(m) | Self::Usage(m) => m,
            Self::Input(p) | Self::At(p) => &p.message,
        }
    }

    /// What is wrong, in parts.
    #[must_use]
    pub fn problem(&self) -> Problem {
        match self {
            Self::Input(p) | Self::At(p) => (**p).clone(),
            Self::Job(m) | Self::Usage(m) => {
                // An option of the command line that leads the sentence is where it is.
                let place = m.split([' ', ':']).next().filter(|w| w.starts_with("--")).unwrap_or_default();
                Problem { what: m.clone(), place: place.to_owned(), message: m.clone(), ..Problem::default() }
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

/// A file that cannot be read, with the name that is nearest in its folder where it is not there.
fn unreadable(path: &Path, e: &std::io::Error) -> Failure {
    let what = format!("cannot be read: {e}");
    let folder = path.parent().filter(|_| e.kind() == ErrorKind::NotFound);
    let folder = folder.map(|f| if f.as_os_str().is_empty() { Path::new(".") } else { f });
    let there = folder.and_then(|f| std::fs::read_dir(f).ok());
    let mut names: Vec<String> =
        there.into_iter().flatten().flatten().map(|f| f.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    // Endings are alike everywhere: the names before them decide.
    let stem = |name: &str| {
        Path::new(name).file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
    };
    let stems: Vec<String> = names.iter().map(|n| stem(n)).collect();
    let wanted = stem(&path.display().to_string());
    let near = nearest(&wanted, stems.iter().map(String::as_str));
    let near = near.and_then(|near| names.iter().find(|n| stem(n) == near));
    let Some(near) = near else { return Failure::file(path, what) };
    let what = format!("{what} (is {near} meant?)");
    let place = path.display().to_string();
    let message = format!("{place}: {what}");
    Failure::At(Box::new(Problem { what, place, nearest: near.to_owned(), message, ..Problem::default() }))
}

/// The bytes of a file.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let unread = |e: std::io::Error| unreadable(path, &e);
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
    let unread = |e: std::io::Error| unreadable(path, &e);
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
