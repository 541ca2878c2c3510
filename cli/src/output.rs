//! Files that appear whole or not at all.

use crate::failure::Failure;
use std::io::Write;
use std::path::Path;

/// Writes a file under a temporary name beside its place and renames it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let fail = |what: &str, e: std::io::Error| Failure::file(path, format!("{what}: {e}"));
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.to_path_buf(),
        _ => ".".into(),
    };
    std::fs::create_dir_all(&folder).map_err(|e| fail("its folder cannot be made", e))?;
    let name = path.file_name().map_or_else(|| "out".into(), |n| n.to_string_lossy().into_owned());
    let temporary = folder.join(format!(".{name}.{}.part", std::process::id()));
    let written = std::fs::File::create(&temporary).and_then(|mut f| {
        f.write_all(bytes)?;
        f.sync_all()
    });
    let done = written.and_then(|()| std::fs::rename(&temporary, path));
    done.map_err(|e| {
        // The temporary file is of no use to anybody; that it could not be removed adds nothing to the message.
        let _ = std::fs::remove_file(&temporary);
        fail("cannot be written", e)
    })
}
