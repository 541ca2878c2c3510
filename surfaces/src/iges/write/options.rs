//! What a writer is told, and why it writes nothing.

/// What a file says about itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgesOptions {
    /// Name of the product.
    pub name: String,
    /// Date and time as `YYYYMMDD.HHMMSS`, empty for none: the same faces then give the same bytes.
    pub timestamp: String,
}

impl Default for IgesOptions {
    fn default() -> Self {
        Self { name: "part".to_owned(), timestamp: String::new() }
    }
}

/// Why faces cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum IgesWriteError {
    /// Nothing to write.
    #[error("there is no face to write")]
    NoFaces,
    /// A surface that has no exact spline form over its rectangle.
    #[error("{face}: its surface has no spline form over its parameter rectangle")]
    Surface {
        /// The face's id.
        face: String,
    },
    /// An edge curve that is no spline.
    #[error("edge {edge} has no spline form: its points do not follow each other")]
    Curve {
        /// Its number among the edges.
        edge: usize,
    },
    /// More cards than a sequence number of seven digits can count.
    #[error("the file would have {cards} cards; a sequence number has seven digits")]
    TooLong {
        /// Cards of the longest section.
        cards: usize,
    },
    /// The output takes no more.
    #[error("{why}")]
    Output {
        /// What the system says.
        why: String,
    },
}
