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

mod error;
mod line;
mod pattern;
mod rule;
mod spec;

pub use self::error::DialectFileError;
use self::error::FORMAT;
use self::line::{Numbering, Words};
use self::rule::rules;
use self::spec::{Blocks, Spec};
use super::Dialect;

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

/// A dialect made of an engine and a file of its own words.
///
/// ```
/// use osculate_postproc::{Dialect, DialectFile};
///
/// let text = r#"
///     format = 1
///     name = "shop"
///     description = "Coolant through the tool instead of over it"
///     engine = "fanuc"
///     [[rule]]
///     engine = "M8"
///     words = ["M88"]
/// "#;
/// let shop = DialectFile::from_toml(text)?;
/// assert_eq!((shop.engine(), shop.extension()), (Dialect::Fanuc, "nc"));
/// let out = shop.out("S5000 M3\nM8\n")?;
/// assert_eq!(out, "S5000 M3\nM88\n");
/// // What went out comes back, line by line.
/// assert_eq!(shop.back_text(&out), "S5000 M3\nM8\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct DialectFile {
    description: String,
    extension: String,
    words: Words,
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
        let rules = rules(&spec.rules)?;
        let words = Words {
            name: spec.name,
            engine,
            numbering,
            trailing_zeros: spec.numbers.trailing_zeros,
            every_motion: !spec.modal.motion,
            every_feed: !spec.modal.feed,
            rules,
        };
        Ok(Self { description: spec.description, extension, words })
    }

    /// A dialect that comes with the library.
    ///
    /// ```
    /// use osculate_postproc::{DialectFile, shipped_dialects};
    ///
    /// for name in shipped_dialects() {
    ///     assert_eq!(DialectFile::shipped(name).as_ref().map(DialectFile::name), Some(name));
    /// }
    /// ```
    #[must_use]
    pub fn shipped(name: &str) -> Option<Self> {
        let text = shipped_dialect_text(name)?;
        Some(Self::from_toml(text).expect("a shipped file is tested"))
    }

    /// The name in job files.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.words.name
    }

    /// One line for people.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The dialect that makes and reads its programs.
    #[must_use]
    pub const fn engine(&self) -> Dialect {
        self.words.engine
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
        self.words.out(text)
    }

    /// A line of a program of the dialect in the engine's words; the lines of a program stay where they are.
    #[must_use]
    pub fn back(&self, line: &str) -> String {
        self.words.back(line)
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
