//! IGES files (5.3 and its forerunners, both ASCII forms): trimmed, bounded and free surfaces, and faces of solids, in
//! every place that groups and instances put them.
//!
//! The text: `cards` takes the sections apart, `params` reads free text, `global` the global section, `directory` and
//! `compressed` the entities of the two forms. The model: `links` says what an entity is made of, `tree` goes from the
//! roots to placed faces. The geometry: `geometry` follows pointers and transforms; `curves`, `conic`, `parametric` and
//! `join` make curves, `carriers` surfaces, `pcurves` and `loops` boundaries, `faces` faces. `import` puts the part
//! together and says what was left out.
//!
//! IGES trims say nothing about the material side: such faces have [`crate::Face::oriented`] false; only faces of
//! solids know it.

mod cards;
mod carriers;
mod columns;
mod compressed;
mod conic;
mod curves;
mod directory;
mod faces;
mod geometry;
mod global;
mod import;
mod join;
mod links;
mod loops;
mod names;
mod parametric;
mod params;
mod pcurves;
mod tree;
mod write;

pub use write::{IgesOptions, IgesWriteError, write, write_to};

use crate::part::Part;
use cards::{CardFault, Cards};

/// Why bytes are no IGES part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum IgesError {
    /// No cards.
    #[error(
        "no IGES file in an ASCII form: none of the first {searched} lines has a section letter in column 73"
    )]
    NotIges {
        /// Lines searched.
        searched: usize,
    },
    /// The binary form.
    #[error("the binary form of IGES is not read; export the part in the ASCII form, or as STEP")]
    Binary,
    /// Truncated before the directory.
    #[error(
        "the IGES file has no directory entry section among its {lines} lines: it is truncated; export it again"
    )]
    NoDirectory {
        /// Lines in the file.
        lines: usize,
    },
    /// Truncated before the parameters.
    #[error(
        "the IGES file has no parameter data section among its {lines} lines: it is truncated; export it again"
    )]
    NoParameters {
        /// Lines in the file.
        lines: usize,
    },
}

/// Lines looked at to recognise the format.
const LOOK_AT: usize = 200;

/// Whether the bytes have the cards of an IGES file near their start.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(LOOK_AT * 82)];
    let found: Vec<u8> = columns::cards(head).filter_map(|c| columns::section(&c.1)).collect();
    matches!(found.first(), Some(b'S' | b'G' | b'B' | b'C')) || found.contains(&b'G')
}

/// Reads an IGES file. Damage is reported in [`Part::diagnostics`] and what cannot become a face in
/// [`Part::not_used`]; a part without faces is no error.
///
/// # Errors
/// [`IgesError`] for bytes that are no IGES file or lack a section.
pub fn read(bytes: &[u8]) -> Result<Part, IgesError> {
    let lines = columns::cards(bytes).count();
    if !looks_like(bytes) {
        return Err(IgesError::NotIges { searched: lines.min(LOOK_AT) });
    }
    // The flag section of the binary form.
    if columns::cards(bytes).next().is_some_and(|c| columns::section(&c.1) == Some(b'B')) {
        return Err(IgesError::Binary);
    }
    match Cards::read(bytes) {
        Ok(cards) => Ok(import::part(cards)),
        Err(CardFault::NoDirectory) => Err(IgesError::NoDirectory { lines }),
        Err(CardFault::NoParameters) => Err(IgesError::NoParameters { lines }),
    }
}
