//! Files that appear whole or not at all: written under a temporary name beside their place, then renamed.

use crate::failure::Failure;
use crate::watch::Watch;
use std::io::Write;
use std::path::Path;

/// Writes a file with these bytes. Folders on the way to it are made.
///
/// # Errors
/// Where the folder cannot be made or the file not be written. Then nothing appears, and a file that was there before stays.
pub fn write(path: &Path, bytes: &[u8], watch: &dyn Watch) -> Result<(), Failure> {
    stream(path, watch, |file| file.write_all(bytes).map_err(|e| unwritten(path, &e)))
}

fn unwritten(path: &Path, e: &std::io::Error) -> Failure {
    Failure::file(path, format!("cannot be written: {e}"))
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
    let fail = |what: &str, e: std::io::Error| Failure::file(path, format!("{what}: {e}"));
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
        _ => ".".into(),
    };
    std::fs::create_dir_all(&folder).map_err(|e| fail("its folder cannot be made", e))?;
    let name = path.file_name().map_or_else(|| "out".into(), |n| n.to_string_lossy().into_owned());
    let temporary = folder.join(format!(".{name}.{}.part", std::process::id()));
    watch.temporary(&temporary);
    let written = std::fs::File::create(&temporary).map_err(|e| unwritten(path, &e)).and_then(|mut f| {
        let answer = fill(&mut f)?;
        f.sync_all().map_err(|e| unwritten(path, &e))?;
        Ok(answer)
    });
    let done = written.and_then(|answer| {
        std::fs::rename(&temporary, path).map_err(|e| unwritten(path, &e))?;
        Ok(answer)
    });
    watch.settled(&temporary);
    if done.is_err() {
        // The temporary file is of no use to anybody; that it could not be removed adds nothing to the message.
        let _ = std::fs::remove_file(&temporary);
    }
    done
}
