//! Text and JSON on stdout: the only place that prints results. What comes from files cannot steer a terminal: its control
//! characters are printed as escapes.
#![allow(clippy::print_stdout)]

use osculate::failure::Failure;
use osculate::words;
use serde::Serialize;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

/// Whether text is printed, and whether in colour: 0 as stdout is a terminal, 1 always, 2 never.
static SPEAKS: AtomicBool = AtomicBool::new(true);
static COLOUR: AtomicU8 = AtomicU8::new(0);

/// Sets whether results are printed as text, and when in colour: "auto", "always" or "never".
pub fn speak(text: bool, colour: &str) {
    SPEAKS.store(text, Ordering::Relaxed);
    let colour = match colour {
        "always" => 1,
        "never" => 2,
        _ => 0,
    };
    COLOUR.store(colour, Ordering::Relaxed);
}

/// Whether words are in colour. Who has set `NO_COLOR` wants none where nothing is said.
fn coloured() -> bool {
    match COLOUR.load(Ordering::Relaxed) {
        1 => true,
        2 => false,
        _ => std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty()),
    }
}

/// Prints lines to stdout; a closed pipe ends the output quietly.
///
/// # Errors
/// Where stdout does not take them, such as a file on a full disk.
pub fn text(s: &str) -> Result<(), Failure> {
    if !SPEAKS.load(Ordering::Relaxed) {
        return Ok(());
    }
    put(&words::visible(s))
}

/// As [`text`], with some words of it in red where a person looks.
///
/// # Errors
/// As [`text`].
pub fn warning(s: &str, red: Option<&str>) -> Result<(), Failure> {
    let Some(red) = red.filter(|_| coloured() && SPEAKS.load(Ordering::Relaxed)) else { return text(s) };
    let red = words::visible(red);
    put(&words::visible(s).replace(&*red, &format!("\u{1b}[1;31m{red}\u{1b}[0m")))
}

/// Says something on stderr.
#[allow(clippy::print_stderr)]
pub fn complaint(s: &str) {
    // Where nobody hears of it there is nobody to tell.
    let _ = writeln!(std::io::stderr().lock(), "osculate: {}", words::visible(s));
}

fn put(s: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(s.as_bytes()).and_then(|()| out.flush()) {
        // A reader that has gone away (`| head`) is no failure of the command.
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::job(format!("the answer cannot be written to stdout: {e}")))
        }
        _ => Ok(()),
    }
}

/// Prints one JSON object and nothing else.
///
/// # Errors
/// As [`text`], and where the value is no JSON.
pub fn json(value: &impl Serialize) -> Result<(), Failure> {
    put(&one_line(&serde_json::to_string(value).map_err(Failure::job)?))
}

/// JSON on a line of its own. Control characters that JSON leaves as they are stand in strings alone, where an escape means the same.
fn one_line(json: &str) -> String {
    let mut out = String::with_capacity(json.len() + 1);
    for c in json.chars() {
        match words::steers(c) {
            // All of them are below 65536.
            true => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            false => out.push(c),
        }
    }
    out.push('\n');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_is_the_same_with_escapes() {
        let name = "a\u{9b}31m\u{7f}\u{1b}[0m\u{202e}b\n";
        let line = one_line(&serde_json::to_string(name).unwrap());
        assert!(line.trim_end().chars().all(|c| !words::steers(c)), "{line:?}");
        assert_eq!(serde_json::from_str::<String>(&line).unwrap(), name);
    }
}
