//! What a writer is told, and why it writes nothing.

/// What a file says about itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepOptions {
    /// Name of the product.
    pub name: String,
    /// Date and time as ISO 8601 writes them, empty for none: the same faces then give the same bytes.
    pub timestamp: String,
}

impl Default for StepOptions {
    fn default() -> Self {
        Self { name: "part".to_owned(), timestamp: String::new() }
    }
}

/// Why faces cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StepWriteError {
    /// Nothing to write.
    #[error("there is no face to write")]
    NoFaces,
    /// A face with a boundary that is not made of edges.
    #[error("{face} has no boundary that could be written: its loops have no edge of any length")]
    NoBoundary {
        /// The face's id.
        face: String,
    },
    /// The output takes no more.
    #[error("{why}")]
    Output {
        /// What the system says.
        why: String,
    },
}
