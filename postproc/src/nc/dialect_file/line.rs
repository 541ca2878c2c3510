//! Lines of a program on their way out and back: rules, formats, modal words, numbers of blocks.

use super::error::DialectFileError;
use super::rule::{Rule, Then};
use crate::nc::Dialect;

/// Numbers of blocks that are still to come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbering {
    pub next: u64,
    pub step: u64,
}

/// What a dialect says otherwise than its engine.
#[derive(Clone, Debug)]
pub(super) struct Words {
    pub name: String,
    pub engine: Dialect,
    pub numbering: Option<Numbering>,
    pub trailing_zeros: bool,
    /// G0 or G1 stands in every block that moves.
    pub every_motion: bool,
    /// F stands in every block that feeds.
    pub every_feed: bool,
    pub rules: Vec<Rule>,
}

impl Words {
    /// The engine's program in these words.
    pub fn out(&self, text: &str) -> Result<String, DialectFileError> {
        let mut state = State::new(self);
        let mut out = String::with_capacity(text.len());
        for line in text.lines() {
            state.out(line, &mut out)?;
        }
        Ok(out)
    }

    /// A line in these words as the engine says it.
    pub fn back(&self, line: &str) -> String {
        let (number, body) = split(self.engine, line);
        for rule in &self.rules {
            let Then::Words(words) = &rule.then else { continue };
            let Some((first, more)) = words.split_first() else { continue };
            if let Some(found) = first.matches(body) {
                return format!("{number}{}", rule.engine.filled(&found));
            }
            if more.iter().any(|w| w.matches(body).is_some()) {
                return String::new();
            }
        }
        line.to_owned()
    }
}

/// The number of a block with the blank behind it, and what follows.
fn split(engine: Dialect, line: &str) -> (&str, &str) {
    let body = match engine {
        Dialect::Heidenhain => Some(line),
        Dialect::Sinumerik | Dialect::Fanuc | Dialect::LinuxCnc => line.strip_prefix('N'),
    };
    let Some(body) = body else { return ("", line) };
    let rest = body.trim_start_matches(|c: char| c.is_ascii_digit());
    match rest.strip_prefix(' ') {
        Some(after) if rest.len() < body.len() => line.split_at(line.len() - after.len()),
        _ => ("", line),
    }
}

/// What has been said so far.
struct State<'a> {
    file: &'a Words,
    numbering: Option<Numbering>,
    motion: String,
    feed: String,
}

impl<'a> State<'a> {
    fn new(file: &'a Words) -> Self {
        Self { file, numbering: file.numbering, motion: String::new(), feed: String::new() }
    }

    /// Adds what the dialect says for a line of the engine.
    fn out(&mut self, line: &str, text: &mut String) -> Result<(), DialectFileError> {
        let (number, body) = split(self.file.engine, line);
        for rule in &self.file.rules {
            let Some(found) = rule.engine.matches(body) else { continue };
            match &rule.then {
                Then::Refused(why) => {
                    return Err(DialectFileError::Refused {
                        dialect: self.file.name.clone(),
                        line: body.to_owned(),
                        why: why.clone(),
                    });
                }
                Then::Words(words) => {
                    words.iter().for_each(|w| self.push(number, &w.filled(&found), text));
                    return Ok(());
                }
            }
        }
        let moved = self.moved(body);
        self.push(number, moved.as_deref().unwrap_or(body), text);
        Ok(())
    }

    /// A line that moves, in the dialect's formats; `None` where it is to stay as it is.
    fn moved(&mut self, body: &str) -> Option<String> {
        let Words { every_motion, every_feed, trailing_zeros, .. } = *self.file;
        if trailing_zeros && !(every_motion || every_feed) {
            return None;
        }
        let words: Vec<&str> = body.split(' ').collect();
        let klartext = self.file.engine == Dialect::Heidenhain;
        let motion = words.iter().find(|w| ["G0", "G1", "L", "LN"].contains(*w));
        // Comments, cycles and calls are no words of letters and numbers.
        let plain = |w: &&str| numbered(w).is_some() || ["L", "LN", "R0", "FMAX"].contains(w);
        if !words.iter().all(plain) {
            return None;
        }
        let position = |w: &&str| w.starts_with(|c: char| "XYZABCUVW".contains(c)) && w.contains('.');
        let moves = words.iter().any(position) && !words.iter().any(|w| w.starts_with("G53"));
        if let Some(word) = motion {
            (*word).clone_into(&mut self.motion);
        }
        let feed = words.iter().find(|w| w.starts_with('F') && numbered(w).is_some());
        if let Some(feed) = feed {
            (*feed).clone_into(&mut self.feed);
        }
        let mut out: Vec<String> = Vec::with_capacity(words.len() + 2);
        if moves && motion.is_none() && every_motion && !self.motion.is_empty() {
            out.push(self.motion.clone());
        }
        out.extend(words.iter().map(|w| self.number(w)));
        let feeds = if klartext { !words.contains(&"FMAX") && motion.is_some() } else { self.motion == "G1" };
        if moves && feed.is_none() && feeds && every_feed && !self.feed.is_empty() {
            out.push(self.number(&self.feed));
        }
        Some(out.join(" "))
    }

    /// A word in the dialect's format: without trailing zeros the point stays.
    fn number(&self, word: &str) -> String {
        if self.file.trailing_zeros || !word.contains('.') || word.starts_with('G') {
            return word.to_owned();
        }
        word.trim_end_matches('0').to_owned()
    }

    fn push(&mut self, number: &str, body: &str, text: &mut String) {
        text.push_str(number);
        let bare = body.is_empty() || body.starts_with(['%', 'O', '(', ';', '/']);
        if let Some(numbering) = self.numbering.as_mut().filter(|_| !bare) {
            text.push('N');
            text.push_str(&numbering.next.to_string());
            text.push(' ');
            numbering.next += numbering.step;
        }
        text.push_str(body);
        text.push('\n');
    }
}

/// The number of a word of one letter and a number, as `X-1.5`, `G43.4`, `X+0.5`.
fn numbered(word: &str) -> Option<f64> {
    let mut chars = word.chars();
    chars.next().filter(char::is_ascii_uppercase)?;
    let rest = chars.as_str();
    rest.bytes().all(|b| b.is_ascii_digit() || b"+-.".contains(&b)).then(|| rest.parse().ok())?
}
