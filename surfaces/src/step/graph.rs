//! The record graph of a Part 21 file: instances by number, read as far as the text is sound.
//!
//! Damage is reported and skipped; a truncated file gives what was complete. The graph remembers which instances were
//! asked for, so that what nobody used can be told.

use super::lexer::find;
use super::parse::{Chunk, Event, chunks};
pub(crate) use super::record::{Args, Record, Value, arg};
use super::text::decode;
use osculate_geom::Diagnostic;
use std::collections::{BTreeMap, HashMap};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Findings of one kind that are listed one by one; the rest is counted.
const MAX_LISTED: usize = 8;

/// From instance number to position.
#[derive(Debug)]
enum Index {
    /// Position by number, `u32::MAX` where there is none.
    Dense(Vec<u32>),
    /// For files with few records and huge numbers.
    Sparse(HashMap<u64, u32>),
}

/// All instances of a file.
#[derive(Debug)]
pub(crate) struct Graph<'t> {
    text: &'t [u8],
    chunks: Vec<Chunk>,
    /// Chunk and entry of each record, in file order.
    order: Vec<(u32, u32)>,
    index: Index,
    used: Vec<AtomicBool>,
    lines: OnceLock<Vec<u32>>,
    /// Schema names of the header.
    pub(crate) schemas: Vec<String>,
    /// What was found on the way.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Whether the file ends inside a record or a section; one that lacks only its last line does not count.
    pub(crate) truncated: bool,
}

impl<'t> Graph<'t> {
    fn at(&self, position: usize) -> Record<'_> {
        let (chunk, entry) = self.order[position];
        let chunk = &self.chunks[chunk as usize];
        Record::new(self.text, chunk, chunk.entries[entry as usize])
    }

    fn position(&self, id: u64) -> Option<usize> {
        let found = match &self.index {
            Index::Dense(v) => usize::try_from(id).ok().and_then(|k| v.get(k)).copied(),
            Index::Sparse(m) => m.get(&id).copied(),
        };
        found.filter(|k| *k != u32::MAX).map(|k| k as usize)
    }

    /// The record with this number; it counts as used from now on.
    pub(crate) fn get(&self, id: u64) -> Option<Record<'_>> {
        let k = self.position(id)?;
        self.used[k].store(true, Ordering::Relaxed);
        Some(self.at(k))
    }

    /// The record with this number, without counting as use.
    pub(crate) fn peek(&self, id: u64) -> Option<Record<'_>> {
        self.position(id).map(|k| self.at(k))
    }

    /// The place of a record in the file's order.
    pub(crate) fn rank(&self, id: u64) -> usize {
        self.position(id).unwrap_or(usize::MAX)
    }

    /// The records that are looked for by keyword, in file order: all but points, edges and the like.
    pub(crate) fn structure(&self) -> impl Iterator<Item = Record<'_>> {
        self.order.iter().filter_map(|(chunk, entry)| {
            let chunk = &self.chunks[*chunk as usize];
            let entry = chunk.entries[*entry as usize];
            (!entry.bulk).then(|| Record::new(self.text, chunk, entry))
        })
    }

    /// Number of records.
    pub(crate) const fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether a record exists that nobody asked for.
    pub(crate) fn is_unused(&self, id: u64) -> bool {
        self.position(id).is_some_and(|k| !self.used[k].load(Ordering::Relaxed))
    }

    /// Records that nobody asked for.
    pub(crate) fn unused(&self) -> impl Iterator<Item = Record<'_>> {
        (0..self.order.len()).filter(|k| !self.used[*k].load(Ordering::Relaxed)).map(|k| self.at(k))
    }

    /// The line, from 1, of an offset.
    pub(crate) fn line(&self, at: usize) -> usize {
        let lines = self.lines.get_or_init(|| {
            let ends = self.text.iter().enumerate().filter(|(_, c)| **c == b'\n');
            ends.map(|(k, _)| k as u32).collect()
        });
        1 + lines.partition_point(|end| (*end as usize) < at)
    }

    /// Where a record is, for people.
    pub(crate) fn place(&self, id: u64) -> String {
        match self.position(id) {
            Some(k) => format!("#{id}, line {}", self.line(self.at(k).at())),
            None => format!("#{id}"),
        }
    }

    /// Reads every record of the header and the data sections. `start` is the offset behind `ISO-10303-21`.
    pub(crate) fn read(text: &'t [u8], start: usize) -> Self {
        let mut chunks = chunks(text, start);
        let mut graph = Self {
            text,
            chunks: Vec::new(),
            order: Vec::new(),
            index: Index::Dense(Vec::new()),
            used: Vec::new(),
            lines: OnceLock::new(),
            schemas: Vec::new(),
            diagnostics: Vec::new(),
            truncated: false,
        };
        let state = graph.sections(&mut chunks);
        graph.chunks = chunks;
        graph.number();
        graph.report_end(&state);
        // What a truncated file lacks needs no list.
        if !graph.truncated {
            graph.report_missing();
        }
        graph
    }

    /// Follows the sections' keywords through the chunks: drops what stands behind the end, tells what was skipped.
    fn sections(&mut self, chunks: &mut Vec<Chunk>) -> Sections {
        let mut state = Sections { in_section: true, ..Sections::default() };
        let mut bad = Tally::default();
        let mut behind = 0;
        'chunks: for (k, chunk) in chunks.iter_mut().enumerate() {
            for (event, at, before) in std::mem::take(&mut chunk.events) {
                match event {
                    Event::Word(span) => {
                        let word = span.of(self.text).to_ascii_uppercase();
                        if word.starts_with(b"END-ISO") {
                            state.ended = Some(span.at as usize);
                            chunk.entries.truncate(before);
                            behind = k + 1;
                            break 'chunks;
                        }
                        state.in_section = word != b"ENDSEC";
                        state.opaque = word == b"SIGNATURE";
                        if word == b"FILE_SCHEMA" {
                            self.schemas = schema_names(&self.text[span.at as usize..]);
                        }
                        if let Some(name) = HEADER.iter().find(|h| word == h.as_bytes()) {
                            state.header.push(name);
                        }
                    }
                    Event::Bad(..) if state.opaque => {}
                    Event::Bad(id, fault) => {
                        let line = self.line(at);
                        bad.add(match id {
                            Some(id) => format!("line {line}: #{id}: {fault}"),
                            None => format!("line {line}: {fault}"),
                        });
                    }
                    Event::End => state.open = !state.opaque,
                }
            }
        }
        if behind > 0 {
            chunks.truncate(behind);
        }
        bad.report("unreadable record skipped", &mut self.diagnostics);
        state
    }

    /// Numbers the records; of several with one number the first counts.
    fn number(&mut self) {
        let total: usize = self.chunks.iter().map(|c| c.entries.len()).sum();
        let all = self.chunks.iter().flat_map(|c| &c.entries);
        let highest = all.map(|e| e.id).max().unwrap_or(0);
        let mut duplicates: BTreeMap<u64, usize> = BTreeMap::new();
        let dense = highest <= 4 * total as u64 + 1024;
        let (mut table, mut map) =
            (vec![u32::MAX; if dense { highest as usize + 1 } else { 0 }], HashMap::new());
        self.order.reserve(total);
        for (c, chunk) in self.chunks.iter().enumerate() {
            for (k, entry) in chunk.entries.iter().enumerate() {
                let slot = if dense {
                    &mut table[entry.id as usize]
                } else {
                    map.entry(entry.id).or_insert(u32::MAX)
                };
                if *slot == u32::MAX {
                    *slot = self.order.len() as u32;
                    self.order.push((c as u32, k as u32));
                } else {
                    *duplicates.entry(entry.id).or_default() += 1;
                }
            }
        }
        self.index = if dense { Index::Dense(table) } else { Index::Sparse(map) };
        self.used = (0..self.order.len()).map(|_| AtomicBool::new(false)).collect();
        for (id, count) in duplicates.iter().take(MAX_LISTED) {
            let place = self.place(*id);
            let said = format!("defined {} times; the first definition is used", count + 1);
            self.diagnostics.push(Diagnostic::warning(place, said));
        }
        if duplicates.len() > MAX_LISTED {
            let rest = duplicates.len() - MAX_LISTED;
            self.diagnostics.push(Diagnostic::warning("", format!("{rest} more numbers defined twice")));
        }
    }

    /// Says which references lead to no record.
    fn report_missing(&mut self) {
        let mut missing: BTreeMap<u64, (u64, usize)> = BTreeMap::new();
        for record in (0..self.order.len()).map(|k| self.at(k)) {
            for id in record.references().filter(|id| self.position(*id).is_none()) {
                missing.entry(id).or_insert((record.id(), 0)).1 += 1;
            }
        }
        for (id, (by, count)) in missing.iter().take(MAX_LISTED) {
            let times = if *count > 1 { format!(" ({count} times)") } else { String::new() };
            let said = format!("it refers to #{id}, which is not in the file{times}");
            self.diagnostics.push(Diagnostic::warning(self.place(*by), said));
        }
        if missing.len() > MAX_LISTED {
            let said = format!("{} more numbers that are not in the file", missing.len() - MAX_LISTED);
            self.diagnostics.push(Diagnostic::warning("", said));
        }
    }

    /// Says how the file ends, and what its header lacks.
    fn report_end(&mut self, state: &Sections) {
        self.truncated = state.ended.is_none() && (state.open || state.in_section);
        if let Some(end) = state.ended {
            let rest = &self.text[end..];
            let rest = &rest[find(rest, b";").map_or(rest.len(), |k| k + 1)..];
            let said = rest.iter().filter(|c| !matches!(c, 0..=b' ' | 0x7f)).count();
            if find(rest, b"ISO-10303-21").is_some() {
                let said =
                    "another exchange structure follows behind END-ISO-10303-21; only the first is read";
                self.diagnostics.push(Diagnostic::loss(format!("line {}", self.line(end)), said));
            } else if said > 0 {
                let said = format!("{said} characters behind END-ISO-10303-21 are not read");
                self.diagnostics.push(Diagnostic::note(format!("line {}", self.line(end)), said));
            }
        } else {
            let last =
                self.order.len().checked_sub(1).map_or_else(String::new, |k| self.place(self.at(k).id()));
            let found = format!("{} complete records were read", self.order.len());
            let bytes = self.text.len();
            self.diagnostics.push(if self.truncated {
                Diagnostic::loss(
                    last,
                    format!(
                        "the file ends at byte {bytes} without END-ISO-10303-21: it is truncated; {found}"
                    ),
                )
            } else {
                let said = format!("the file ends at byte {bytes} without END-ISO-10303-21; {found}");
                Diagnostic::warning(last, said)
            });
        }
        for name in HEADER {
            match state.header.iter().filter(|h| **h == name).count() {
                0 if !self.order.is_empty() => {
                    self.diagnostics.push(Diagnostic::note("", format!("the header has no {name}")));
                }
                0 | 1 => {}
                n => {
                    let said = format!("the header has {name} {n} times; the last one is used");
                    self.diagnostics.push(Diagnostic::warning("", said));
                }
            }
        }
    }
}

/// The entities that every header has.
const HEADER: [&str; 3] = ["FILE_DESCRIPTION", "FILE_NAME", "FILE_SCHEMA"];

/// What the keywords between the records say.
#[derive(Default)]
struct Sections {
    header: Vec<&'static str>,
    /// Offset of END-ISO-10303-21.
    ended: Option<usize>,
    in_section: bool,
    /// The text ends inside a statement.
    open: bool,
    /// In a SIGNATURE section, whose text is no Part 21.
    opaque: bool,
}

/// The names in `FILE_SCHEMA(('A','B'))`.
fn schema_names(text: &[u8]) -> Vec<String> {
    let end = find(text, b";").unwrap_or(text.len());
    let pieces: Vec<&[u8]> = text[..end].split(|c| *c == b'\'').collect();
    pieces.iter().skip(1).step_by(2).map(|p| decode(p)).filter(|p| !p.trim().is_empty()).collect()
}

/// Messages, the first few kept.
#[derive(Default)]
struct Tally {
    listed: Vec<String>,
    count: usize,
}

impl Tally {
    fn add(&mut self, message: String) {
        if self.listed.len() < MAX_LISTED {
            self.listed.push(message);
        }
        self.count += 1;
    }
    fn report(&self, what: &str, out: &mut Vec<Diagnostic>) {
        for m in &self.listed {
            out.push(Diagnostic::loss("", format!("{what}: {m}")));
        }
        if self.count > self.listed.len() {
            out.push(Diagnostic::loss("", format!("{what}: {} more", self.count - self.listed.len())));
        }
    }
}

#[cfg(test)]
mod tests;
