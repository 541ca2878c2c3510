//! STEP files (ISO 10303-21 with the geometry of ISO 10303-42): faces of boundary representations and shells.
//!
//! `lexer`, `parse`, `text`, `record` and `graph` know Part 21 only; `units` the contexts; `geometry`, `curves`,
//! `splines` and `surfaces` the geometry; `structure` and `walk` representations and assemblies; `faces` the topology;
//! `unused` what is left. Parameter curves count only where a file has no space curve: that one is the definition, and
//! writers disagree about the others.

mod bodies;
mod colour;
mod curves;
mod faces;
mod geometry;
mod graph;
mod lexer;
mod parse;
mod record;
mod rectangle;
mod splines;
mod structure;
mod surfaces;
mod text;
mod units;
mod unused;
mod walk;
mod write;

pub use write::{StepOptions, StepWriteError, write, write_to};

use crate::part::Part;

/// Why bytes are no STEP part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError {
    /// No exchange structure.
    #[error("no STEP file: ISO-10303-21 does not stand within its first {searched} bytes")]
    NotStep {
        /// Bytes searched.
        searched: usize,
    },
    /// An exchange structure without a single readable record.
    #[error("the STEP file has no readable record among its {bytes} bytes{detail}; export it again")]
    NoRecords {
        /// Length of the file.
        bytes: usize,
        /// The first finding, with a leading separator.
        detail: String,
    },
}

/// How far from the start the magic word may stand, behind blank lines and comments.
const MAGIC_WITHIN: usize = 4096;

const MAGIC: &[u8] = b"ISO-10303-21";

/// Whether the bytes begin as a STEP file does: the magic word behind blanks and comments only.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    start(bytes).is_some()
}

/// Offset behind the magic word.
fn start(bytes: &[u8]) -> Option<usize> {
    let head = &bytes[..bytes.len().min(MAGIC_WITHIN)];
    let at = lexer::find(head, MAGIC)?;
    let before = &head[..at];
    let clean = before.iter().all(|c| c.is_ascii_whitespace() || matches!(c, 0xef | 0xbb | 0xbf | 0));
    (clean || lexer::find(before, b"/*").is_some()).then_some(at + MAGIC.len())
}

/// Reads a STEP file. Damage is reported in [`Part::diagnostics`] and what cannot become a face in
/// [`Part::not_used`]; a part without faces is no error.
///
/// ```
/// use osculate_surfaces::step::{StepError, read};
/// // A file without shapes is a part without faces; anything else is no STEP file.
/// let text = b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=CARTESIAN_POINT('',(0.,0.,0.));\nENDSEC;\nEND-ISO-10303-21;\n";
/// assert!(read(text)?.faces.is_empty());
/// assert!(matches!(read(b"solid cube"), Err(StepError::NotStep { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StepError`] for bytes that are no STEP file or hold no readable record.
pub fn read(bytes: &[u8]) -> Result<Part, StepError> {
    let from = start(bytes).ok_or(StepError::NotStep { searched: bytes.len().min(MAGIC_WITHIN) })?;
    let graph = graph::Graph::read(bytes, from);
    if graph.len() == 0 {
        let detail = graph.diagnostics.first().map_or_else(String::new, |d| format!(" ({})", d.message));
        return Err(StepError::NoRecords { bytes: bytes.len(), detail });
    }
    Ok(faces::part(graph))
}
