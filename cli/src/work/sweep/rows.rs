//! Rows of finished cases: a line of JSON each, in a file for each shard. A run that was ended leaves whole lines, and half of one at most.

use super::case::Row;
use crate::failure::{Failure, read};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

const BEGINS: &str = "rows-";
const ENDS: &str = ".jsonl";

/// Which of the cases a run has: the `which`-th of so many shards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1 on.
    pub which: usize,
    /// How many there are.
    pub of: usize,
}

impl Shard {
    /// All cases.
    pub const WHOLE: Self = Self { which: 1, of: 1 };

    /// Its cases, of so many.
    pub fn numbers(self, cases: usize) -> impl Iterator<Item = usize> {
        (self.which..=cases).step_by(self.of)
    }

    /// The file of its rows.
    #[must_use]
    pub fn file(self, folder: &Path) -> PathBuf {
        folder.join(format!("{BEGINS}{}-of-{}{ENDS}", self.which, self.of))
    }

    /// That of a file of rows; None where it is named otherwise.
    fn of_file(file: &Path) -> Option<Self> {
        let name = file.file_name()?.to_str()?;
        let (which, of) = name.strip_prefix(BEGINS)?.strip_suffix(ENDS)?.split_once("-of-")?;
        Some(Self { which: which.parse().ok()?, of: of.parse().ok()? })
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.which, self.of)
    }
}

/// Rows of all files in a folder, by the numbers of their cases.
#[derive(Debug, Default)]
pub struct Rows {
    rows: BTreeMap<usize, Row>,
    /// Rows of other jobs, files or versions of the program.
    stale: usize,
    /// Cases that have such rows, with the shard of the last.
    of_another: BTreeMap<usize, Shard>,
}

impl Rows {
    /// Those in a folder whose key is that of their case; `key` is asked for it, and says None where there is no such case.
    ///
    /// # Errors
    /// Where a file cannot be read, or a line of it that is not its last is no row.
    pub fn read(folder: &Path, key: &dyn Fn(usize) -> Option<String>) -> Result<Self, Failure> {
        let mut out = Self::default();
        for file in files(folder)? {
            let bytes = read(&file)?;
            let text = String::from_utf8_lossy(&bytes);
            for (k, line) in text.split_inclusive('\n').enumerate() {
                // Half a line is what a run that was ended left.
                let Some(line) = line.strip_suffix('\n') else { continue };
                let row: Row = serde_json::from_str(line).map_err(|e| {
                    Failure::file(
                        &file,
                        format!("line {}: is no row of a sweep ({e}): take the line out", k + 1),
                    )
                })?;
                if key(row.case).is_some_and(|key| key == row.key) {
                    out.rows.entry(row.case).or_insert(row);
                } else {
                    out.stale += 1;
                    out.of_another.insert(row.case, Shard::of_file(&file).unwrap_or(Shard::WHOLE));
                }
            }
        }
        Ok(out)
    }

    /// Whether a case has a row.
    #[must_use]
    pub fn has(&self, case: usize) -> bool {
        self.rows.contains_key(&case)
    }

    /// The rows, by the numbers of their cases.
    pub fn all(&self) -> impl Iterator<Item = &Row> {
        self.rows.values()
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// How many rows were not taken: of other jobs, files or versions of the program.
    #[must_use]
    pub const fn stale(&self) -> usize {
        self.stale
    }

    /// The shard that made a row of a case that was not taken: of another job, other files or another version of the program.
    #[must_use]
    pub fn of_another(&self, case: usize) -> Option<Shard> {
        self.of_another.get(&case).copied()
    }
}

/// The files of rows in a folder, by name.
fn files(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let unread = |e: std::io::Error| Failure::file(folder, format!("cannot be read: {e}"));
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with(BEGINS) && name.ends_with(ENDS) {
            out.push(path);
        }
    }
    out.sort();
    Ok(out)
}

/// The rows of a shard as they come. No other run can have the same one until it is dropped.
pub struct Writer {
    path: PathBuf,
    file: Mutex<File>,
}

impl Writer {
    /// Opens the file of a shard, behind its last whole line.
    ///
    /// # Errors
    /// Where it cannot be written, or another run has it.
    pub fn open(shard: Shard, folder: &Path) -> Result<Self, Failure> {
        let path = shard.file(folder);
        let unwritten = |e: std::io::Error| Failure::file(&path, format!("cannot be written: {e}"));
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(unwritten)?;
        match file.try_lock() {
            // Some network drives have no locks: there whoever starts two runs of a shard gets rows twice, of which one counts.
            Ok(()) | Err(TryLockError::Error(_)) => {}
            Err(TryLockError::WouldBlock) => {
                let what = "another run makes these rows: wait for its end, or give other shards";
                return Err(Failure::file(&path, what));
            }
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(unwritten)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |at| at as u64 + 1);
        file.set_len(whole).map_err(unwritten)?;
        file.seek(SeekFrom::Start(whole)).map_err(unwritten)?;
        Ok(Self { path, file: Mutex::new(file) })
    }

    /// Adds a row; it is on the disk when this returns.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn add(&self, row: &Row) -> Result<(), Failure> {
        let unwritten = |e: std::io::Error| Failure::file(&self.path, format!("cannot be written: {e}"));
        let line = serde_json::to_string(row).map_err(Failure::job)? + "\n";
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(line.as_bytes()).map_err(unwritten)?;
        file.sync_data().map_err(unwritten)
    }
}
