//! Why a dialect file is none, or why its dialect cannot say a program.

/// The format number that this version reads.
pub(super) const FORMAT: u32 = 1;

/// Why a dialect file is none, or why its dialect cannot say a program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
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
