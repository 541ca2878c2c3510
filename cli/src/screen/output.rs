//! Files of the program: whole or not at all, also where a signal ends it.

use crate::screen::progress::SCREEN;
use crate::screen::render;
use osculate::failure::Failure;
use osculate::files::{self, Claim};
use std::path::{Path, PathBuf};

/// Refuses a folder of results that is something else: before the work, not after it.
pub fn folder(path: &Path) -> Result<(), Failure> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::file(path, "is a file: --out names a folder for the results"));
    }
    Ok(())
}

/// Has a folder of results for this run alone until the claim is dropped.
pub fn claim(path: &Path) -> Result<Claim, Failure> {
    folder(path)?;
    let claim = files::claim(path)?;
    if !claim.is_locked() {
        render::complaint(&format!(
            "{}: no lock can be had there; keep other runs out of it",
            path.display()
        ));
    }
    Ok(claim)
}

/// Refuses a file to write that is no regular one, or that is one of those `read`: before the work, not after it.
pub fn file(path: &Path, read: &[&Path]) -> Result<(), Failure> {
    let place = files::replaceable(path)?;
    let same = |other: &Path| match (place.canonicalize(), other.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    if read.iter().any(|other| same(other)) {
        return Err(Failure::file(path, "is what is read here: --out must name another file"));
    }
    Ok(())
}

/// Writes a file under a temporary name beside its place and renames it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::write(path, bytes, &SCREEN)
}

/// Writes files that belong together, by their names in a folder: all of them or none.
pub fn set(folder: &Path, all: &[(&str, &[u8])]) -> Result<(), Failure> {
    let placed: Vec<(PathBuf, &[u8])> = all.iter().map(|(name, bytes)| (folder.join(name), *bytes)).collect();
    files::write_set(&placed, &SCREEN)
}

/// As [`write()`], with the bytes coming piece by piece; where `fill` fails nothing appears.
pub fn stream<T>(
    path: &Path,
    fill: impl FnOnce(&mut std::fs::File) -> Result<T, Failure>,
) -> Result<T, Failure> {
    files::stream(path, &SCREEN, fill)
}
