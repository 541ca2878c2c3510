//! IGES files (5.3 and its forerunners, fixed ASCII form): trimmed, bounded and free surfaces, and faces of solids.
//!
//! `cards` takes the sections apart, `geometry` makes curves and surfaces, `faces` the faces. IGES trims say
//! nothing about the material side: such faces have [`crate::Face::oriented`] false.

mod cards;
mod carriers;
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

pub use write::{IgesOptions, IgesWriteError, write};

use crate::part::Part;
use cards::{CardFault, Cards};

/// Why bytes are no IGES part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IgesError {
    /// No cards.
    #[error(
        "no IGES file in fixed ASCII form: none of the first {searched} lines has a section letter in column 73; \
         compressed and binary forms are not read"
    )]
    NotIges {
        /// Lines searched.
        searched: usize,
    },
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
    let found: Vec<u8> = cards::cards(head).filter_map(|c| cards::section(&c.1)).collect();
    matches!(found.first(), Some(b'S' | b'G')) || found.contains(&b'G')
}

/// Reads an IGES file. Damage is reported in [`Part::diagnostics`] and what cannot become a face in
/// [`Part::not_used`]; a part without faces is no error.
///
/// # Errors
/// [`IgesError`] for bytes that are no IGES file or lack a section.
pub fn read(bytes: &[u8]) -> Result<Part, IgesError> {
    let lines = cards::cards(bytes).count();
    if !looks_like(bytes) {
        return Err(IgesError::NotIges { searched: lines.min(LOOK_AT) });
    }
    match Cards::read(bytes) {
        Ok(cards) => Ok(import::part(cards)),
        Err(CardFault::NoDirectory) => Err(IgesError::NoDirectory { lines }),
        Err(CardFault::NoParameters) => Err(IgesError::NoParameters { lines }),
    }
}
