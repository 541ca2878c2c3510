//! Files that appear whole or not at all: written under a temporary name beside their place, then renamed.
//!
//! Only regular files are replaced. A link stays, and the file that it leads to is replaced; devices, pipes, sockets and
//! folders are refused.

use crate::failure::Failure;
use crate::watch::Watch;
use std::fs::TryLockError;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Writes a file with these bytes. Folders on the way to it are made.
///
/// ```
/// use osculate::files;
///
/// let folder = std::env::temp_dir().join(format!("osculate-files-{}", std::process::id()));
/// let file = folder.join("new").join("program.nc");
/// files::write(&file, b"M30\n", &())?;
/// assert_eq!(std::fs::read(&file)?, b"M30\n");
/// // A folder is not replaced by a file.
/// assert!(files::write(&folder, b"M30\n", &()).is_err());
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where the folder cannot be made or the file not be written. Then nothing appears, and a file that was there before stays.
pub fn write(path: &Path, bytes: &[u8], watch: &dyn Watch) -> Result<(), Failure> {
    write_set(&[(path.to_path_buf(), bytes)], watch)
}

/// Writes files that belong together. All of them are on the disk under temporary names before the first one gets its own, so that
/// a disk that is full leaves none of them.
///
/// # Errors
/// As [`write()`]; where the system refuses a name after it has granted others, the message lists the files that are new.
pub fn write_set(files: &[(PathBuf, &[u8])], watch: &dyn Watch) -> Result<(), Failure> {
    let mut drafts = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        let mut draft = Draft::begin(path, watch)?;
        draft.file.write_all(bytes).map_err(|e| unwritten(path, &e))?;
        draft.sync()?;
        drafts.push(draft);
    }
    let mut placed: Vec<String> = Vec::new();
    for draft in drafts {
        let name = draft.path.display().to_string();
        draft.place().map_err(|e| match placed.is_empty() {
            true => e,
            false => Failure::job(format!("{}; written before it: {}", e.message(), placed.join(", "))),
        })?;
        placed.push(name);
    }
    Ok(())
}

/// As [`write()`], with the bytes coming piece by piece; where `fill` fails nothing appears.
///
/// # Errors
/// As [`write()`], and those of `fill`.
pub fn stream<T>(
    path: &Path,
    watch: &dyn Watch,
    fill: impl FnOnce(&mut std::fs::File) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut draft = Draft::begin(path, watch)?;
    let answer = fill(draft.file.as_file_mut())?;
    draft.sync()?;
    draft.place()?;
    Ok(answer)
}

/// The regular file that a path names, behind links; it need not be there yet.
///
/// # Errors
/// Where the path names something else: a folder, a device, a pipe, a link that leads nowhere.
pub fn replaceable(path: &Path) -> Result<PathBuf, Failure> {
    if path.file_name().is_none() {
        return Err(Failure::file(path, "names no file to write"));
    }
    let is_link = path.symlink_metadata().is_ok_and(|m| m.is_symlink());
    let place = match is_link {
        true => path
            .canonicalize()
            .map_err(|e| Failure::file(path, format!("is a link to a file that is not there: {e}")))?,
        false => path.to_path_buf(),
    };
    match place.metadata() {
        Ok(found) if found.is_file() => Ok(place),
        Ok(found) if found.is_dir() => {
            Err(Failure::file(path, "is a folder: give the name of a file to write"))
        }
        Ok(_) => Err(Failure::file(
            path,
            "is a device, a pipe or a socket: only regular files are replaced, give another name",
        )),
        // Whether its folder can be made is found when it is.
        Err(e) if [ErrorKind::NotFound, ErrorKind::NotADirectory].contains(&e.kind()) => Ok(place),
        Err(e) => Err(unwritten(path, &e)),
    }
}

fn unwritten(path: &Path, e: &std::io::Error) -> Failure {
    Failure::file(path, format!("cannot be written: {e}"))
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// A file under its temporary name, which goes away with it.
struct Draft<'a> {
    file: NamedTempFile,
    /// The name as it was given.
    path: &'a Path,
    /// The file to replace.
    place: PathBuf,
    _told: Told<'a>,
}

/// Tells when a temporary name is gone.
struct Told<'a> {
    temporary: PathBuf,
    watch: &'a dyn Watch,
}

impl Drop for Told<'_> {
    fn drop(&mut self) {
        self.watch.settled(&self.temporary);
    }
}

impl<'a> Draft<'a> {
    fn begin(path: &'a Path, watch: &'a dyn Watch) -> Result<Self, Failure> {
        let place = replaceable(path)?;
        let folder = folder_of(&place);
        std::fs::create_dir_all(folder)
            .map_err(|e| Failure::file(path, format!("its folder cannot be made: {e}")))?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".osculate-").suffix(".part");
        // Results are for others too, as far as the user's mask lets them.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder).map_err(|e| unwritten(path, &e))?;
        watch.temporary(file.path());
        let told = Told { temporary: file.path().to_path_buf(), watch };
        Ok(Self { file, path, place, _told: told })
    }

    /// Waits until the disk has all of it: what does not fit is known only then.
    fn sync(&mut self) -> Result<(), Failure> {
        self.file.as_file().sync_all().map_err(|e| unwritten(self.path, &e))
    }

    fn place(self) -> Result<(), Failure> {
        self.file.persist(&self.place).map(drop).map_err(|e| unwritten(self.path, &e.error))
    }
}

/// A folder of results that one run has for itself.
pub struct Claim {
    folder: PathBuf,
    made: bool,
    /// Locked until it is closed.
    lock: Option<std::fs::File>,
}

/// Claims a folder of results, which is made where it is not there, until the claim is dropped.
///
/// # Errors
/// Where it cannot be made, or another run has claimed it.
pub fn claim(folder: &Path) -> Result<Claim, Failure> {
    let made = !folder.exists();
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::file(folder, format!("the folder cannot be made: {e}")))?;
    let mut claim = Claim { folder: folder.to_path_buf(), made, lock: None };
    let file =
        lock_file(folder).map_err(|e| Failure::file(folder, format!("the folder cannot be locked: {e}")))?;
    match file.try_lock() {
        Ok(()) => claim.lock = Some(file),
        Err(TryLockError::WouldBlock) => {
            claim.made = false;
            let what =
                "another run writes its results into this folder: wait for its end or give another --out";
            return Err(Failure::file(folder, what));
        }
        // Some network drives have no locks.
        Err(TryLockError::Error(_)) => {}
    }
    Ok(claim)
}

/// The folder itself, where it can be locked.
#[cfg(unix)]
fn lock_file(folder: &Path) -> std::io::Result<std::fs::File> {
    std::fs::File::open(folder)
}

/// A file in the folder, which stays there.
#[cfg(not(unix))]
fn lock_file(folder: &Path) -> std::io::Result<std::fs::File> {
    std::fs::File::create(folder.join(".osculate.lock"))
}

impl Claim {
    /// Whether the file system can keep other runs out.
    #[must_use]
    pub const fn is_locked(&self) -> bool {
        self.lock.is_some()
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if self.made {
            // A folder with results is not empty, and stays.
            let _ = std::fs::remove_dir(&self.folder);
        }
    }
}
