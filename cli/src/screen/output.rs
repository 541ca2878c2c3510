//! Files of the program: whole or not at all, also where a signal ends it.

use crate::screen::progress::SCREEN;
use osculate::failure::Failure;
use osculate::files;
use std::path::Path;

/// Refuses a folder of results that is something else: before the work, not after it.
pub fn folder(path: &Path) -> Result<(), Failure> {
    if path.exists() && !path.is_dir() {
        return Err(Failure::file(path, "is a file: --out names a folder for the results"));
    }
    Ok(())
}

/// Writes a file under a temporary name beside its place and renames it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::write(path, bytes, &SCREEN)
}

/// As [`write()`], with the bytes coming piece by piece; where `fill` fails nothing appears.
pub fn stream<T>(
    path: &Path,
    fill: impl FnOnce(&mut std::fs::File) -> Result<T, Failure>,
) -> Result<T, Failure> {
    files::stream(path, &SCREEN, fill)
}
