//! Dialects as data: what a control words otherwise than the engine that it is nearest to.
//!
//! A dialect file names one of the four [`Dialect`]s as its engine and says line by line where its words differ. A [`DialectFile`] rewrites
//! an engine's program as it leaves ([`DialectFile::out`]) and a program of the dialect into the engine's as it is read
//! ([`DialectFile::back`]), so that kinematics, feed, read-back and verdict know the engines alone:
//!
//! ```text
//! format = 1
//! name = "haas"
//! engine = "fanuc"                  # sinumerik, heidenhain, fanuc, linuxcnc
//! extension = "nc"
//!
//! [blocks]                          # numbers of blocks, for engines that have none
//! letter = "N"
//! first = 10
//! step = 10
//!
//! [numbers]
//! trailing_zeros = false            # X10. and X0.5 instead of X10.0000 and X0.5000
//!
//! [modal]
//! motion = false                    # G0 and G1 in every block that moves
//! feed = false                      # F in every block that feeds
//!
//! [[rule]]
//! engine = "G43.4 H{tool}"          # a line of the engine; {name} is one word or a part of one, {name*} the rest of the line
//! words = ["G234 H{tool}"]          # what the dialect says for it, the first line standing for it when the program is read
//!
//! [[rule]]
//! engine = "G43.5 H{tool}"
//! refused = "there are no directions of the tool"
//! ```
//!
//! The first rule that fits a line is taken; a line that none fits stays as it is. Rules see lines without the number of the block.

mod line;
mod pattern;

use serde::Deserialize;

use self::line::{Numbering, State};
use self::pattern::Pattern;
use super::Dialect;

const FORMAT: u32 = 1;

/// Rules of a file at most.
const MOST_RULES: usize = 500;

/// Files that come with the library, by name.
const SHIPPED: [(&str, &str); 3] = [
    ("haas", include_str!("../../../dialects/haas.toml")),
    ("mazak", include_str!("../../../dialects/mazak.toml")),
    ("sinumerik-one", include_str!("../../../dialects/sinumerik-one.toml")),
];

/// The names of the dialects that come as files.
pub fn shipped_dialects() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|s| s.0)
}

/// The text of a dialect that comes as a file.
#[must_use]
pub fn shipped_dialect_text(name: &str) -> Option<&'static str> {
    SHIPPED.iter().find(|s| s.0 == name).map(|s| s.1)
}

/// Why a dialect file is none, or why its dialect cannot say a program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DialectFileError {
    /// Not TOML, an unknown key or a missing one.
    #[error("the dialect file cannot be read: {0}")]
    Toml(String),
    /// Another version of the format.
    #[error("the dialect file has format = {got}, this version reads format = {FORMAT}")]
    Format {
        /// What stands there.
        got: u32,
    },
    /// A key with a value that makes no sense.
    #[error("{key} = {value}: {wanted}")]
    Value {
        /// The key.
        key: &'static str,
        /// What stands there.
        value: String,
        /// What would do.
        wanted: &'static str,
    },
    /// A rule that makes no sense.
    #[error("rule {rule}, engine = \"{engine}\": {what}")]
    Rule {
        /// Which, from 1.
        rule: usize,
        /// Its engine's line.
        engine: String,
        /// What is the matter.
        what: String,
    },
    /// The dialect has no words for it.
    #[error("{dialect} cannot say '{line}': {why}")]
    Refused {
        /// The dialect.
        dialect: String,
        /// The engine's line.
        line: String,
        /// As the file says.
        why: String,
    },
}

/// A dialect file as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Spec {
    format: u32,
    name: String,
    #[serde(default)]
    description: String,
    engine: String,
    extension: Option<String>,
    blocks: Option<Blocks>,
    #[serde(default)]
    numbers: Numbers,
    #[serde(default)]
    modal: ModalRules,
    #[serde(default, rename = "rule")]
    rules: Vec<RuleSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Blocks {
    letter: String,
    first: u64,
    step: u64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    trailing_zeros: bool,
}

impl Default for Numbers {
    fn default() -> Self {
        Self { trailing_zeros: true }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct ModalRules {
    motion: bool,
    feed: bool,
}

impl Default for ModalRules {
    fn default() -> Self {
        Self { motion: true, feed: true }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleSpec {
    engine: String,
    words: Option<Vec<String>>,
    refused: Option<String>,
}

/// What becomes of a line.
#[derive(Clone, Debug)]
enum Then {
    Words(Vec<Pattern>),
    Refused(String),
}

#[derive(Clone, Debug)]
struct Rule {
    engine: Pattern,
    then: Then,
}

/// A dialect made of an engine and a file of its own words.
#[derive(Clone, Debug)]
pub struct DialectFile {
    name: String,
    description: String,
    engine: Dialect,
    extension: String,
    numbering: Option<Numbering>,
    trailing_zeros: bool,
    modal: ModalRules,
    rules: Vec<Rule>,
}

impl DialectFile {
    /// A dialect from the text of a TOML file.
    ///
    /// # Errors
    /// Where the file is malformed, or what it writes could not be read back.
    pub fn from_toml(text: &str) -> Result<Self, DialectFileError> {
        let spec: Spec =
            toml::from_str(text).map_err(|e| DialectFileError::Toml(e.to_string().trim_end().to_owned()))?;
        if spec.format != FORMAT {
            return Err(DialectFileError::Format { got: spec.format });
        }
        let refuse =
            |key, value: &str, wanted| DialectFileError::Value { key, value: format!("\"{value}\""), wanted };
        let engine: Dialect = spec.engine.parse().map_err(|_| {
            refuse("engine", &spec.engine, "there are sinumerik, heidenhain, fanuc, linuxcnc")
        })?;
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let own_name = spec.name.parse::<Dialect>().is_err();
        if spec.name.is_empty() || !spec.name.chars().all(plain) || !own_name {
            return Err(refuse("name", &spec.name, "small letters, digits and '-', and no engine's name"));
        }
        let extension = spec.extension.unwrap_or_else(|| engine.extension().to_owned());
        if extension.is_empty() || !extension.chars().all(|c| c.is_ascii_alphanumeric()) {
            return Err(refuse("extension", &extension, "letters and digits"));
        }
        let numbering = spec.blocks.as_ref().map(|b| numbering(b, engine)).transpose()?;
        if spec.rules.len() > MOST_RULES {
            let value = spec.rules.len().to_string();
            return Err(refuse("rule", &value, "at most 500 rules"));
        }
        let rules: Vec<Rule> =
            spec.rules.iter().enumerate().map(|(k, r)| rule(k + 1, r)).collect::<Result<_, _>>()?;
        for (k, one) in rules.iter().enumerate() {
            let Then::Words(words) = &one.then else { continue };
            let Some(said) = words.first() else { continue };
            let clash = rules[..k].iter().position(
                |other| matches!(&other.then, Then::Words(w) if w.first().is_some_and(|w| w.same(said))),
            );
            if let Some(other) = clash {
                let what = format!("rule {} says the same: a program could not be read back", other + 1);
                return Err(DialectFileError::Rule {
                    rule: k + 1,
                    engine: spec.rules[k].engine.clone(),
                    what,
                });
            }
        }
        Ok(Self {
            name: spec.name,
            description: spec.description,
            engine,
            extension,
            numbering,
            trailing_zeros: spec.numbers.trailing_zeros,
            modal: spec.modal,
            rules,
        })
    }

    /// A dialect that comes with the library.
    #[must_use]
    pub fn shipped(name: &str) -> Option<Self> {
        let text = shipped_dialect_text(name)?;
        Some(Self::from_toml(text).expect("a shipped file is tested"))
    }

    /// The name in job files.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// One line for people.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The dialect that makes and reads its programs.
    #[must_use]
    pub const fn engine(&self) -> Dialect {
        self.engine
    }

    /// The extension of a program file.
    #[must_use]
    pub fn extension(&self) -> &str {
        &self.extension
    }

    /// The engine's program in the dialect's words.
    ///
    /// # Errors
    /// Where a rule refuses a line.
    pub fn out(&self, text: &str) -> Result<String, DialectFileError> {
        let mut state = State::new(self);
        let mut out = String::with_capacity(text.len());
        for line in text.lines() {
            state.out(line, &mut out)?;
        }
        Ok(out)
    }

    /// A line of a program of the dialect in the engine's words; the lines of a program stay where they are.
    #[must_use]
    pub fn back(&self, line: &str) -> String {
        let (number, body) = line::split(self.engine, line);
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

    /// As [`DialectFile::back`], of a whole text.
    #[must_use]
    pub fn back_text(&self, text: &str) -> String {
        text.lines().map(|line| self.back(line) + "\n").collect()
    }
}

fn numbering(blocks: &Blocks, engine: Dialect) -> Result<Numbering, DialectFileError> {
    let bad = |key, value: String, wanted| DialectFileError::Value { key, value, wanted };
    if matches!(engine, Dialect::Sinumerik | Dialect::Heidenhain) {
        let wanted = "this engine numbers its blocks itself: leave [blocks] out";
        return Err(bad("blocks", engine.name().to_owned(), wanted));
    }
    if blocks.letter != "N" {
        return Err(bad("blocks.letter", format!("\"{}\"", blocks.letter), "N"));
    }
    if !(1..=1000).contains(&blocks.step) || blocks.first > 1_000_000 {
        let value = format!("{} and {}", blocks.first, blocks.step);
        return Err(bad("blocks.first and step", value, "from 0 to 1000000, and from 1 to 1000"));
    }
    Ok(Numbering { next: blocks.first, step: blocks.step })
}

fn rule(number: usize, spec: &RuleSpec) -> Result<Rule, DialectFileError> {
    let bad = |what: String| DialectFileError::Rule { rule: number, engine: spec.engine.clone(), what };
    let engine = Pattern::new(&spec.engine).map_err(bad)?;
    let then = match (&spec.words, &spec.refused) {
        (Some(_), Some(_)) | (None, None) => return Err(bad("give words or refused, one of them".into())),
        (None, Some(why)) => Then::Refused(why.clone()),
        (Some(words), None) => {
            let words: Vec<Pattern> =
                words.iter().map(|w| Pattern::new(w)).collect::<Result<_, _>>().map_err(bad)?;
            if let Some(first) = words.first()
                && first.names() != engine.names()
            {
                let what = format!(
                    "the first line of words has {{{}}}, the engine's has {{{}}}: with other names it could not be read back",
                    first.names().join("}, {"),
                    engine.names().join("}, {")
                );
                return Err(bad(what));
            }
            let known = |w: &Pattern| w.names().iter().all(|n| engine.names().contains(n));
            if !words.iter().all(known) {
                return Err(bad("words has a name that the engine's line has not".into()));
            }
            Then::Words(words)
        }
    };
    Ok(Rule { engine, then })
}
