//! The ASCII forms of IGES 5.3: 80-column cards in the sections S, G, D, P and T, or with the flag section C the
//! compressed form of [`super::compressed`].
//!
//! Column 73 holds the section letter, columns 74 to 80 the number within the section.

use super::columns::{Line, append, cards, section};
use super::compressed;
use super::directory::{Directory, Entity, fixed};
use super::global::{Global, global};
use osculate_geom::Diagnostic;
use std::collections::BTreeMap;

/// A file's cards, taken apart.
#[derive(Debug)]
pub(crate) struct Cards {
    pub(crate) global: Global,
    /// Entities by directory number.
    pub(crate) entities: BTreeMap<i64, Entity>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Whether the terminate section is missing.
    pub(crate) truncated: bool,
}

/// Why the cards make no model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CardFault {
    NoDirectory,
    NoParameters,
}

impl Cards {
    /// Takes a file apart.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, CardFault> {
        let mut diagnostics = Vec::new();
        let mut global_text = Vec::new();
        let (mut directory, mut parameters): (Vec<Line<'_>>, Vec<Line<'_>>) = (Vec::new(), Vec::new());
        let mut data: Vec<Line<'_>> = Vec::new();
        let (mut strays, mut first_stray, mut late) = (0_usize, 0, 0_usize);
        let (mut terminated, mut compressed) = (false, false);
        for (number, card) in cards(bytes) {
            match section(&card) {
                Some(_) if terminated => late += 1,
                Some(b'C') => compressed = true,
                Some(b'G') => append(&mut global_text, &card, 72),
                Some(b'D') => directory.push((number, card)),
                Some(b'P') => parameters.push((number, card)),
                Some(b'T') => terminated = true,
                Some(_) => {}
                None if card.iter().all(|c| c.is_ascii_whitespace() || *c == 0) => {}
                None if compressed => data.push((number, card)),
                None => {
                    strays += 1;
                    if strays == 1 {
                        first_stray = number;
                    }
                }
            }
        }
        let mut warn = |what: String| diagnostics.push(Diagnostic::warning("", what));
        if strays > 0 {
            warn(format!(
                "{strays} lines have no section letter in column 73 and were passed over, the first is line \
                 {first_stray}"
            ));
        }
        if late > 0 {
            warn(format!("{late} cards stand behind the terminate section and were passed over"));
        }
        if if compressed { data.is_empty() } else { directory.is_empty() } {
            return Err(CardFault::NoDirectory);
        }
        if !compressed && parameters.is_empty() {
            return Err(CardFault::NoParameters);
        }
        if !terminated {
            diagnostics.push(Diagnostic::loss(
                "",
                "the file has no terminate section: it is truncated; entities whose data are complete were read",
            ));
        }
        let (separators, global) = global(&global_text, &mut diagnostics);
        let Directory { entities, findings } = if compressed {
            compressed::read(&data, separators)
        } else {
            fixed(&directory, &parameters, separators)
        };
        diagnostics.extend(findings);
        Ok(Self { global, entities, diagnostics, truncated: !terminated })
    }
}
