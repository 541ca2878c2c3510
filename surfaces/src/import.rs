//! Reading a file of any format: which one it is, and the part that it gives.

use crate::part::{Format, Part};
use crate::{iges, json, patches, sections, step};

/// Why bytes are no part.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImportError {
    /// Nothing to read.
    #[error("the file is empty")]
    Empty,
    /// Two bytes a character.
    #[error(
        "the file is UTF-16 text; STEP, IGES and point files are one byte a character: save it as UTF-8 or ASCII"
    )]
    Wide,
    /// None of the formats.
    #[error(
        "no format that is read: it begins with {begin:?}; STEP begins with ISO-10303-21, IGES has S, G, D and P \
         in column 73 of its lines, a set of Bezier patches begins with their number and a line of vertex numbers, \
         sections are rows of x y z, and faces that were exported as JSON begin with a brace"
    )]
    Unknown {
        /// The first characters.
        begin: String,
    },
    /// A STEP file that cannot be read.
    #[error(transparent)]
    Step(#[from] step::StepError),
    /// An IGES file that cannot be read.
    #[error(transparent)]
    Iges(#[from] iges::IgesError),
    /// Bezier patches that cannot be read.
    #[error("Bezier patches: {0}")]
    Patches(#[from] patches::PatchesError),
    /// Sections that no surface goes through.
    #[error("point sections: {0}")]
    Sections(#[from] sections::SectionsError),
    /// Faces as JSON that cannot be read.
    #[error(transparent)]
    Json(#[from] json::JsonError),
}

/// The format of a file, by its first lines.
#[must_use]
pub fn detect(bytes: &[u8]) -> Option<Format> {
    if step::looks_like(bytes) {
        Some(Format::Step)
    } else if iges::looks_like(bytes) {
        Some(Format::Iges)
    } else if patches::looks_like(bytes) {
        Some(Format::Patches)
    } else if sections::looks_like(bytes) {
        Some(Format::Sections)
    } else if json::looks_like(bytes) {
        Some(Format::Json)
    } else {
        None
    }
}

/// Whether text begins as UTF-16 does: with its mark, or with every other byte zero.
fn is_wide(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(64)];
    let every_other = |odd: usize| head.len() >= 16 && head.iter().skip(odd).step_by(2).all(|b| *b == 0);
    head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) || (every_other(0) != every_other(1))
}

/// Reads a file of any format that [`detect`] knows.
///
/// # Errors
/// [`ImportError`] where the bytes are neither, or nothing of them can be read.
pub fn read(bytes: &[u8]) -> Result<Part, ImportError> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(ImportError::Empty);
    }
    match detect(bytes) {
        Some(Format::Step) => Ok(step::read(bytes)?),
        Some(Format::Iges) => Ok(iges::read(bytes)?),
        Some(Format::Patches) => Ok(patches::read(bytes)?),
        Some(Format::Sections) => Ok(sections::read(bytes)?),
        Some(Format::Json) => Ok(json::read_part(bytes)?),
        None if is_wide(bytes) => Err(ImportError::Wide),
        None => {
            let begin = String::from_utf8_lossy(&bytes[..bytes.len().min(40)]).into_owned();
            Err(ImportError::Unknown { begin })
        }
    }
}
