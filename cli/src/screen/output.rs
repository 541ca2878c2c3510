//! Files that appear whole or not at all.

use crate::screen::cancel;
use osculate::failure::Failure;
use std::io::Write;
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
    stream(path, |file| file.write_all(bytes).map_err(|e| unwritten(path, &e)))
}

fn unwritten(path: &Path, e: &std::io::Error) -> Failure {
    Failure::file(path, format!("cannot be written: {e}"))
}

/// As [`write()`], with the bytes coming piece by piece; where `fill` fails nothing appears.
pub fn stream<T>(
    path: &Path,
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
    cancel::temporary(&temporary);
    let written = std::fs::File::create(&temporary).map_err(|e| unwritten(path, &e)).and_then(|mut f| {
        let answer = fill(&mut f)?;
        f.sync_all().map_err(|e| unwritten(path, &e))?;
        Ok(answer)
    });
    let done = written.and_then(|answer| {
        std::fs::rename(&temporary, path).map_err(|e| unwritten(path, &e))?;
        Ok(answer)
    });
    cancel::settled(&temporary);
    if done.is_err() {
        // The temporary file is of no use to anybody; that it could not be removed adds nothing to the message.
        let _ = std::fs::remove_file(&temporary);
    }
    done
}
