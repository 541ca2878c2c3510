//! Text as a job and as a library of tools: a value or an error with its line. Files that a job names are not opened.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    use osculate::job::{Job, library::Library};
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    // A job would read what it names.
    if !text.contains("file") {
        let _ = Job::from_toml(text, std::path::Path::new("job.toml"));
    }
    let _ = Library::from_toml(text, std::path::Path::new("tools.toml"));
}
