//! Main programs and subprograms of a Sinumerik archive, read in the order in which the control runs them.
//!
//! An archive holds programs one after the other, each behind `%_N_NAME_MPF` or `%_N_NAME_SPF`. The main program comes
//! first. Where it calls a subprogram (a line with nothing but its name) the rest of it waits until that subprogram has
//! come and gone; it is short, as programs are written so that the long part is the subprogram's.

use super::Dialect;
use super::event::Sink;
use super::interpret::Interpreter;
use super::read_error::ReadError;

/// Lines that wait at most.
const MOST_WAITING: usize = 100_000;

/// The name in `%_N_NAME_MPF` or `%_N_NAME_SPF`, and whether it is a subprogram.
fn header(line: &str) -> Option<(String, bool)> {
    let line = line.trim().to_ascii_uppercase();
    let name = line.strip_prefix("%_N_")?;
    match (name.strip_suffix("_MPF"), name.strip_suffix("_SPF")) {
        (Some(name), _) => Some((name.to_string(), false)),
        (_, Some(name)) => Some((name.to_string(), true)),
        _ => None,
    }
}

/// A line with nothing but a name, after its number.
fn call(line: &str) -> Option<String> {
    let mut words = line.split(';').next().unwrap_or_default().split_whitespace().peekable();
    words.next_if(|w| w.strip_prefix(['N', 'n']).is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit())));
    let name = words.next().filter(|_| words.next().is_none())?.to_ascii_uppercase();
    // Two letters at the start, as names of programs have; names in use for something else are no calls.
    let letters = name.len() > 2 && name.bytes().take(2).all(|b| b.is_ascii_alphabetic() || b == b'_');
    let plain = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    const WORDS: [&str; 15] = [
        "TRAORI", "TRAFOOF", "TRANS", "ORIWKS", "ORIMKS", "ORIVECT", "ORIPLANE", "ORIAXES", "FNORM", "FFWON",
        "FFWOF", "SOFT", "BRISK", "COMPOF", "SUPA",
    ];
    (letters && plain && !WORDS.contains(&name.as_str())).then_some(name)
}

impl<S: Sink> Interpreter<'_, S> {
    /// One line of a text that may be an archive; true at the end of the program.
    pub fn text_line(&mut self, number: usize, line: &str) -> Result<bool, ReadError> {
        if self.dialect != Dialect::Sinumerik {
            return self.program_line(number, line);
        }
        if let Some((name, is_sub)) = line.starts_with('%').then(|| header(line)).flatten() {
            let s = &mut self.sections;
            s.archive = true;
            s.inside = is_sub && s.wanted.as_ref().is_some_and(|(_, wanted)| *wanted == name);
            s.skipped = is_sub && !s.inside;
            return Ok(false);
        }
        if !self.sections.archive {
            return self.program_line(number, line);
        }
        if self.sections.skipped {
            return Ok(false);
        }
        if self.sections.inside {
            if self.program_line(number, line)? {
                self.sections.inside = false;
                self.sections.skipped = true;
                self.sections.wanted = None;
                return self.go_on();
            }
            return Ok(false);
        }
        self.main_line(number, line)
    }

    fn main_line(&mut self, number: usize, line: &str) -> Result<bool, ReadError> {
        if self.sections.wanted.is_some() {
            if self.sections.waiting.len() >= MOST_WAITING {
                return Err(ReadError::Word {
                    line: number,
                    word: "a main program this long behind a call".into(),
                });
            }
            self.sections.waiting.push_back((number, line.to_string()));
            return Ok(false);
        }
        match call(line) {
            Some(name) => {
                self.sections.wanted = Some((number, name));
                Ok(false)
            }
            None => self.program_line(number, line),
        }
    }

    /// The caller's lines that have waited, up to its next call.
    fn go_on(&mut self) -> Result<bool, ReadError> {
        while let (None, Some((number, line))) = (&self.sections.wanted, self.sections.waiting.pop_front()) {
            if self.main_line(number, &line)? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The end of the text: a subprogram that never came is said, and what waited for it is run.
    pub(super) fn close_sections(&mut self) -> Result<(), ReadError> {
        while let Some((line, name)) = self.sections.wanted.take() {
            self.refuse(line, &format!("a call of {name}, which is not in the text,"))?;
            if self.go_on()? {
                return Ok(());
            }
        }
        Ok(())
    }
}
