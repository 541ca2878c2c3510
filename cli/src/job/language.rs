//! The language of a control: one of the engines, or one with words of its own from a dialect file.

use crate::failure::{Failure, read_text};
use osculate_postproc::nc::Dialect;
use osculate_postproc::{DialectFile, shipped_dialects};
use std::borrow::Cow;
use std::path::Path;

/// What programs are written in.
#[derive(Debug, Clone)]
pub struct Language {
    /// The dialect that makes and reads them.
    pub engine: Dialect,
    own: Option<DialectFile>,
}

impl From<Dialect> for Language {
    fn from(engine: Dialect) -> Self {
        Self { engine, own: None }
    }
}

impl Language {
    /// All names.
    pub fn names() -> Vec<&'static str> {
        Dialect::ALL.iter().map(|d| d.name()).chain(shipped_dialects()).collect()
    }

    /// The language of this name.
    ///
    /// ```
    /// use osculate::job::language::Language;
    /// use osculate_postproc::Dialect;
    ///
    /// // Haas is Fanuc in words of its own.
    /// assert_eq!(Language::named("haas")?.engine, Dialect::Fanuc);
    /// let message = Language::named("hass").expect_err("a slip").to_string();
    /// assert!(message.contains("is haas meant?"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// With the names there are.
    pub fn named(name: &str) -> Result<Self, Failure> {
        if let Ok(engine) = name.parse::<Dialect>() {
            return Ok(engine.into());
        }
        let own = DialectFile::shipped(name)
            .ok_or_else(|| Failure::unknown("dialect", "dialect", name, &Self::names()))?;
        Ok(Self { engine: own.engine(), own: Some(own) })
    }

    /// The language of a dialect file.
    ///
    /// # Errors
    /// Where it is none.
    pub fn of_file(path: &Path) -> Result<Self, Failure> {
        let own = DialectFile::from_toml(&read_text(path)?).map_err(|e| Failure::file(path, e))?;
        Ok(Self { engine: own.engine(), own: Some(own) })
    }

    /// As a command line says it: a name, or the path of a dialect file.
    ///
    /// # Errors
    /// Where there is none.
    pub fn of_word(word: &str) -> Result<Self, Failure> {
        if word.ends_with(".toml") { Self::of_file(Path::new(word)) } else { Self::named(word) }
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.own.as_ref().map_or(self.engine.name(), DialectFile::name)
    }

    /// The extension of program files.
    #[must_use]
    pub fn extension(&self) -> &str {
        self.own.as_ref().map_or(self.engine.extension(), DialectFile::extension)
    }

    /// It has words of its own.
    #[must_use]
    pub const fn has_own_words(&self) -> bool {
        self.own.is_some()
    }

    /// The engine's program in this language.
    ///
    /// # Errors
    /// Where the language cannot say a line of it.
    pub fn worded(&self, text: String) -> Result<String, Failure> {
        match &self.own {
            None => Ok(text),
            Some(own) => own.out(&text).map_err(Failure::job),
        }
    }

    /// A program of this language in the engine's words, line by line.
    #[must_use]
    pub fn engine_text<'t>(&self, text: &'t str) -> Cow<'t, str> {
        self.own.as_ref().map_or(Cow::Borrowed(text), |own| Cow::Owned(own.back_text(text)))
    }

    /// A line of a program of this language in the engine's words.
    #[must_use]
    pub fn engine_line<'t>(&self, line: &'t str) -> Cow<'t, str> {
        self.own.as_ref().map_or(Cow::Borrowed(line), |own| Cow::Owned(own.back(line)))
    }
}
