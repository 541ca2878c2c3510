//! What an import leaves out: entities by kind and reason, and copies beyond the memory allowed.

use crate::part::NotUsed;
use osculate_geom::Diagnostic;
use std::collections::HashMap;

/// Memory that copies of faces at other places may take in all, bytes ([`Face::copy_bytes`](crate::part::Face)): a file of a few kilobytes
/// can ask for any number of copies of a large face.
pub(crate) const MAX_COPIES: usize = 1 << 30;

/// What is said where [`MAX_COPIES`] ends the placing.
pub(crate) fn too_many_copies(left_out: usize) -> Diagnostic {
    Diagnostic::loss(
        "",
        format!(
            "{left_out} instances of faces are left out: the copies would take more than {} MiB. Export the parts of the \
             assembly one by one",
            MAX_COPIES >> 20
        ),
    )
}

/// Counts of entities left out, by kind and reason, in order of first appearance.
#[derive(Debug, Default)]
pub(crate) struct Leftovers {
    entries: Vec<NotUsed>,
    /// Places of kind and reason in the list.
    index: HashMap<(String, String), usize>,
}

impl Leftovers {
    /// Lines that are kept of each kind.
    pub(crate) const LINES: usize = 8;

    /// Counts one more, on a line.
    pub(crate) fn add_at(&mut self, kind: &str, why: &str, line: usize) {
        self.add_lines(kind, 1, why, &[line]);
    }

    /// Counts several, the first ones on these lines.
    pub(crate) fn add_lines(&mut self, kind: &str, count: usize, why: &str, lines: &[usize]) {
        let at = *self.index.entry((kind.to_owned(), why.to_owned())).or_insert(self.entries.len());
        if at == self.entries.len() {
            let (kind, why) = (kind.to_owned(), why.to_owned());
            self.entries.push(NotUsed { kind, count: 0, why, lines: Vec::new() });
        }
        let entry = &mut self.entries[at];
        entry.count += count;
        entry.lines.extend(lines.iter().take(Self::LINES.saturating_sub(entry.lines.len())));
    }

    pub(crate) fn into_entries(self) -> Vec<NotUsed> {
        self.entries
    }
}
