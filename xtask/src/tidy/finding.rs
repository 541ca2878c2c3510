//! What a rule finds: a place and what is wrong there, in the words of a compiler.

use std::fmt;

/// A broken rule.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// File, relative to the root, or what else is concerned.
    pub place: String,
    /// Line, counted from 1; 0 where the whole is concerned.
    pub line: usize,
    /// What is wrong and what to do.
    pub what: String,
}

impl Finding {
    /// A finding about a whole file.
    pub fn whole(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self { place: place.into(), line: 0, what: what.into() }
    }

    /// A finding about the line with the given index, counted from 0.
    pub fn at(place: &str, index: usize, what: impl Into<String>) -> Self {
        Self { place: place.to_owned(), line: index + 1, what: what.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.place, self.what),
            line => write!(f, "{}:{line}: {}", self.place, self.what),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_read_like_compiler_messages() {
        assert_eq!(Finding::at("a.rs", 2, "b").to_string(), "a.rs:3: b");
        assert_eq!(Finding::whole("a.rs", "b").to_string(), "a.rs: b");
    }
}
