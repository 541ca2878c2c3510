//! Directory entries and their parameter data.
//!
//! A directory entry is two cards of ten 8-column fields and names the first card of its parameter data, which are
//! free text in columns 1 to 64; columns 66 to 72 name the directory entry in turn. Where the numbers of the cards
//! are wrong, places count instead: entry k then has the number 2 k - 1.

use super::columns::{Line, append, field, integer};
use super::params::{Params, Parsed, Separators, parse};
use osculate_geom::Diagnostic;
use rayon::prelude::*;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A directory entry with its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Entity {
    pub(crate) kind: u32,
    pub(crate) form: i32,
    /// Directory number of its transformation, 0 for none.
    pub(crate) transform: i64,
    /// Colour number, or minus the directory number of its colour.
    pub(crate) color: i64,
    /// Level that it is on, or minus the directory number of a list of levels; 0 for none.
    pub(crate) level: i64,
    pub(crate) label: String,
    pub(crate) status: Status,
    /// Line of the file that the entry begins in.
    pub(crate) line: u32,
    /// Parameters behind the entity number.
    pub(crate) params: Params,
}

/// The status number of a directory entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Status {
    /// Not to be shown.
    pub(crate) blanked: bool,
    /// 0 independent, 1 physically dependent, 2 logically dependent, 3 both.
    pub(crate) subordinate: u8,
    /// 0 geometry, 1 annotation, 2 definition, 3 other, 4 logical, 5 of two parameters, 6 construction.
    pub(crate) usage: u8,
}

impl Status {
    /// From its eight digits.
    pub(crate) fn new(digits: i64) -> Self {
        let pair = |shift: i64| u8::try_from(digits / shift % 100).unwrap_or(0);
        Self { blanked: pair(1_000_000) == 1, subordinate: pair(10_000), usage: pair(100) }
    }
}

/// What the sections D and P hold.
pub(crate) struct Directory {
    pub(crate) entities: BTreeMap<i64, Entity>,
    pub(crate) findings: Vec<Diagnostic>,
}

/// Findings of the same sort are counted, and the first is named.
#[derive(Default)]
pub(crate) struct Tally {
    count: usize,
    first: String,
}

impl Tally {
    pub(crate) fn add(&mut self, place: impl FnOnce() -> String) {
        if self.count == 0 {
            self.first = place();
        }
        self.count += 1;
    }
}

/// What was wrong, in the order it is told.
#[derive(Default)]
pub(crate) struct Faults {
    pub(crate) broken: Tally,
    pub(crate) mismatched: Tally,
    pub(crate) shared: Tally,
    pub(crate) cut: Tally,
    pub(crate) lying: Tally,
    pub(crate) doubled: Tally,
}

impl Faults {
    pub(crate) fn findings(self, out: &mut Vec<Diagnostic>) {
        for (tally, what) in [
            (self.broken, "directory entries are no numbers where numbers are due and were passed over"),
            (self.mismatched, "directory entries have no parameter data of their kind and were passed over"),
            (self.shared, "directory entries name the parameter data of another one and were passed over"),
            (self.cut, "entities have parameter data without a record delimiter; what is there is read"),
            (self.lying, "entities have strings of a wrong character count, ended at the next delimiter"),
            (self.doubled, "directory entries have the number of an earlier one, which counts"),
        ] {
            if tally.count > 0 {
                let message = format!("{} {what}; the first is {}", tally.count, tally.first);
                out.push(Diagnostic::loss("", message));
            }
        }
    }
}

/// The fields of a directory entry's two cards.
struct Fields {
    kind: i64,
    start: i64,
    form: i64,
    transform: i64,
    color: i64,
    level: i64,
    status: i64,
    label: String,
    sequence: Option<i64>,
    line: u32,
}

fn fields(first: &Line<'_>, second: &[u8]) -> Option<Fields> {
    let (line, first) = first;
    let at = |card: &[u8], k: usize| integer(field(card, 8 * k, 8 * k + 8));
    // Blanks in the status are zeros.
    let status = first.get(64..first.len().min(72)).unwrap_or(&[]);
    let status =
        status.iter().fold(0_i64, |n, c| 10 * n + if c.is_ascii_digit() { i64::from(c - b'0') } else { 0 });
    let label = String::from_utf8_lossy(field(second, 56, 64)).into_owned();
    let subscript = integer(field(second, 64, 72)).unwrap_or(0);
    let label = if label.is_empty() || subscript == 0 { label } else { format!("{label}({subscript})") };
    Some(Fields {
        kind: at(first, 0)?,
        start: at(first, 1)?,
        form: at(second, 4).unwrap_or(0),
        transform: at(first, 6).unwrap_or(0),
        color: at(second, 2).unwrap_or(0),
        level: at(first, 4).unwrap_or(0),
        status,
        label,
        sequence: integer(field(first, 73, 80)).filter(|n| *n > 0),
        line: *line,
    })
}

/// Whether the cards' own numbers are to be believed: at least as many parameter data point back to them as to
/// the places of the entries, and most of the numbers occur once.
fn numbers_hold(entries: &[Option<Fields>], backs: &[Option<i64>], by_number: &HashMap<i64, usize>) -> bool {
    let sequences: BTreeSet<i64> = entries.iter().flatten().filter_map(|e| e.sequence).collect();
    if 2 * sequences.len() <= entries.len() && entries.len() > 1 {
        return false;
    }
    let (mut named, mut placed) = (0_usize, 0_usize);
    for (k, entry) in entries.iter().enumerate() {
        let Some(e) = entry else { continue };
        let Some(sequence) = e.sequence else { return false };
        let back = by_number.get(&e.start).and_then(|c| backs[*c]);
        named += usize::from(back == Some(sequence));
        placed += usize::from(back == Some(2 * k as i64 + 1));
    }
    named >= placed
}

/// Entities of the fixed form.
pub(crate) fn fixed(directory: &[Line<'_>], parameters: &[Line<'_>], separators: Separators) -> Directory {
    let mut findings = Vec::new();
    let mut faults = Faults::default();
    let backs: Vec<Option<i64>> =
        parameters.iter().map(|(_, c)| integer(field(c, 64, 72)).filter(|n| *n > 0)).collect();
    let mut by_number: HashMap<i64, usize> = HashMap::with_capacity(parameters.len());
    for (k, (_, card)) in parameters.iter().enumerate() {
        if let Some(n) = integer(field(card, 73, 80)) {
            by_number.entry(n).or_insert(k);
        }
    }
    let entries: Vec<Option<Fields>> =
        directory.chunks(2).map(|pair| fields(&pair[0], &pair.get(1)?.1)).collect();
    let held = numbers_hold(&entries, &backs, &by_number);
    if !held {
        findings.push(Diagnostic::warning(
            "",
            "the numbers of the directory cards are wrong: the entries are counted by their places",
        ));
    }
    // Where each entity's data begin: by number where that leads to its kind, else by place.
    let first_is = |card: usize, kind: i64| {
        let text = parameters.get(card).map_or(&[][..], |(_, c)| field(c, 0, 64));
        let digits = text.iter().take_while(|c| c.is_ascii_digit()).count();
        integer(&text[..digits]) == Some(kind)
    };
    let mut starts: BTreeMap<usize, usize> = BTreeMap::new();
    let mut moved = Tally::default();
    for (k, entry) in entries.iter().enumerate() {
        let Some(e) = entry else {
            faults.broken.add(|| format!("line {}", directory[2 * k].0));
            continue;
        };
        let numbered = by_number.get(&e.start).copied();
        let placed = usize::try_from(e.start - 1).ok().filter(|c| *c < parameters.len());
        let start = match numbered {
            Some(c) if first_is(c, e.kind) => c,
            _ => match placed.filter(|c| first_is(*c, e.kind)) {
                Some(c) => {
                    moved.add(|| format!("line {}", e.line));
                    c
                }
                None => {
                    faults.mismatched.add(|| format!("line {}", e.line));
                    continue;
                }
            },
        };
        match starts.entry(start) {
            Entry::Vacant(slot) => {
                slot.insert(k);
            }
            Entry::Occupied(mut slot) => {
                faults.shared.add(|| format!("line {}", e.line));
                // The one that the data point back to has them.
                if backs[start] == e.sequence {
                    slot.insert(k);
                }
            }
        }
    }
    if moved.count > 0 {
        findings.push(Diagnostic::warning(
            "",
            format!(
                "{} directory entries name parameter cards whose numbers are wrong; the cards were counted by \
                 place; the first is {}",
                moved.count, moved.first
            ),
        ));
    }
    let order: Vec<(usize, usize)> = starts.into_iter().collect();
    let ends = order.iter().skip(1).map(|s| s.0).chain([parameters.len()]);
    let jobs: Vec<(usize, usize, usize)> =
        order.iter().zip(ends).map(|((s, k), end)| (*s, end, *k)).collect();
    let read: Vec<(usize, Parsed)> = jobs
        .par_iter()
        .map_init(Vec::new, |text, (start, end, k)| {
            text.clear();
            for card in *start..*end {
                // Data of none that has an entry follow; the count of cards is not needed.
                if backs[*start].is_some() && backs[card].is_some() && backs[card] != backs[*start] {
                    break;
                }
                append(text, &parameters[card].1, 64);
            }
            (*k, parse(text, separators))
        })
        .collect();
    let mut entities = BTreeMap::new();
    for (k, Parsed { params, ended, lies }) in read {
        let Some(e) = &entries[k] else { continue };
        let place = 2 * k as i64 + 1;
        let number = if held { e.sequence.unwrap_or(place) } else { place };
        let named = || format!("{} at DE {number}, line {}", e.kind, e.line);
        if lies > 0 {
            faults.lying.add(named);
        }
        if !ended {
            faults.cut.add(named);
        }
        let entity = Entity {
            kind: u32::try_from(e.kind).unwrap_or(0),
            form: i32::try_from(e.form).unwrap_or(0),
            transform: e.transform,
            color: e.color,
            level: e.level,
            label: e.label.clone(),
            status: Status::new(e.status),
            line: e.line,
            params: params.behind_first(),
        };
        match entities.entry(number) {
            Entry::Occupied(_) => faults.doubled.add(named),
            Entry::Vacant(slot) => {
                slot.insert(entity);
            }
        }
    }
    faults.findings(&mut findings);
    Directory { entities, findings }
}
