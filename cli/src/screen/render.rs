//! Text and JSON on stdout: the only place that prints results.
#![allow(clippy::print_stdout)]

use osculate::failure::Failure;
use serde::Serialize;
use std::io::Write;

/// Prints lines to stdout; a closed pipe ends the output quietly.
pub fn text(s: &str) {
    // A reader that has gone away (`| head`) is no failure of the command.
    let _ = std::io::stdout().lock().write_all(s.as_bytes());
}

/// Prints one JSON object and nothing else.
pub fn json(value: &impl Serialize) -> Result<(), Failure> {
    let mut s = serde_json::to_string(value).map_err(Failure::job)?;
    s.push('\n');
    text(&s);
    Ok(())
}
