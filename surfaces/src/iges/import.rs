//! From a file's cards to the part: every face in every place, and every entity that became none, with the reason.

use super::cards::Cards;
use super::directory::Entity;
use super::faces::{Made, face};
use super::geometry::Geometry;
use super::links::{own_parameters, parts};
use super::loops::surface_pointer;
use super::names::kind_name;
use super::tree::{Model, Placed, model};
use crate::leftovers::{Leftovers, MAX_COPIES, too_many_copies};
use crate::part::{Colour, Face, Format, Part};
use crate::structure::{Layer, Structure};
use osculate_geom::Diagnostic;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Directory numbers that a reason names before it counts the rest.
const NAMED: usize = 4;

/// What became of one face in one place.
enum Outcome {
    Face(Box<Face>, Vec<Diagnostic>),
    Lost(Vec<Diagnostic>, Lost),
}

struct Lost {
    kind: String,
    why: &'static str,
    de: i64,
}

/// Builds the part of a file's cards.
pub(crate) fn part(mut cards: Cards) -> Part {
    let mut diagnostics = std::mem::take(&mut cards.diagnostics);
    if cards.global.scale != 1.0 {
        diagnostics.push(Diagnostic::note(
            "",
            format!("the model scale is {}; lengths were divided by it", cards.global.scale),
        ));
    }
    let tree = model(&Geometry::new(&cards));
    tell(&cards, &tree, &mut diagnostics);
    let jobs: Vec<(usize, i64, &Placed)> = tree
        .faces
        .iter()
        .flat_map(|(de, places)| places.iter().map(move |p| (*de, p)))
        .enumerate()
        .map(|(k, (de, p))| (k + 1, de, p))
        .collect();
    let outcomes = outcomes(&cards, &jobs);
    let left_out = jobs.len() - outcomes.len();
    if left_out > 0 {
        diagnostics.push(too_many_copies(left_out));
    }
    let mut faces = Vec::with_capacity(outcomes.len());
    let mut left = Left::default();
    for outcome in outcomes {
        match outcome {
            Outcome::Face(face, said) => {
                faces.push(*face);
                diagnostics.extend(said);
            }
            Outcome::Lost(said, lost) => {
                diagnostics.extend(said);
                left.add(lost.kind, lost.why, lost.de);
            }
        }
    }
    left.unused(&cards, &tree);
    Part {
        structure: structure(&cards, &faces),
        format: Format::Iges,
        uncertainty_mm: None,
        unit: cards.global.unit_name.clone(),
        schema: cards.global.version.clone(),
        faces,
        not_used: left.entries(&cards).into_entries(),
        truncated: cards.truncated || left_out > 0 || tree.overflow,
        diagnostics,
    }
}

/// The levels that faces are on, as layers; level 0 is none. A number below zero is that of a property that lists levels.
fn structure(cards: &Cards, faces: &[Face]) -> Structure {
    let mut layers: BTreeMap<i64, Vec<String>> = BTreeMap::new();
    for f in faces {
        let level = i64::try_from(f.entity).ok().and_then(|de| Some(cards.entities.get(&de)?.level));
        let listed = level
            .filter(|l| *l < 0)
            .and_then(|l| cards.entities.get(&-l))
            .filter(|p| p.kind == 406 && p.form == 1);
        let levels = match (level, listed) {
            (_, Some(list)) => {
                // How many, then they.
                let count = list.params.number(0).unwrap_or(0.0) as usize;
                (1..list.params.len())
                    .take(count)
                    .filter_map(|k| list.params.number(k))
                    .map(|n| n as i64)
                    .collect()
            }
            (Some(one), None) if one > 0 => vec![one],
            _ => Vec::new(),
        };
        for level in levels {
            layers.entry(level).or_default().push(f.id.clone());
        }
    }
    let layers = layers.into_iter().map(|(level, faces)| Layer { name: level.to_string(), faces }).collect();
    Structure { bodies: Vec::new(), layers }
}

/// Makes the faces: each once, then its copies at other places as far as they may take memory.
fn outcomes(cards: &Cards, jobs: &[(usize, i64, &Placed)]) -> Vec<Outcome> {
    let make = |(number, de, placed): &(usize, i64, &Placed)| made(cards, *number, *de, placed);
    // The places of a face follow each other.
    let is_first = |k: usize| k == 0 || jobs[k - 1].1 != jobs[k].1;
    let mut all: Vec<Option<Outcome>> =
        (0..jobs.len()).into_par_iter().map(|k| is_first(k).then(|| make(&jobs[k]))).collect();
    let (mut each, mut copied) = (0, 0_usize);
    let copies: Vec<bool> = all
        .iter()
        .map(|outcome| match outcome {
            Some(Outcome::Face(face, _)) => {
                each = face.copy_bytes();
                false
            }
            Some(Outcome::Lost(..)) => {
                each = 0;
                false
            }
            None => {
                copied += each;
                copied <= MAX_COPIES
            }
        })
        .collect();
    all.par_iter_mut().zip(&copies).zip(jobs).filter(|((_, wanted), _)| **wanted).for_each(
        |((outcome, _), job)| {
            *outcome = Some(make(job));
        },
    );
    all.into_iter().flatten().collect()
}

fn made(cards: &Cards, number: usize, de: i64, placed: &Placed) -> Outcome {
    let geometry = Geometry::new(cards);
    let label = format!("F{number}");
    let entity = cards.entities.get(&de);
    let place = format!("{label} (DE {de}, line {})", entity.map_or(0, |e| e.line));
    let result = face(&geometry, de, placed);
    let mut said: Vec<Diagnostic> =
        geometry.findings.take().into_iter().map(|f| Diagnostic::warning(&place, f)).collect();
    match result {
        Ok(Made { built, kind }) => {
            said.extend(built.findings.into_iter().map(|f| Diagnostic::warning(&place, f)));
            let face = Face {
                id: label,
                name: entity.map_or_else(String::new, |e| name(cards, e)),
                product: String::new(),
                colour: entity.and_then(|e| colour(cards, e)),
                entity: de as u64,
                kind,
                oriented: placed.side.is_some(),
                carrier: built.assembled.carrier,
                surface: Arc::new(built.assembled.surface),
            };
            Outcome::Face(Box::new(face), said)
        }
        Err(why) => {
            let kind = entity.map_or_else(String::new, |e| {
                let under = surface_pointer(e).and_then(|s| cards.entities.get(&s)).unwrap_or(e);
                kind_name(under.kind, under.form)
            });
            said.push(Diagnostic::loss(&place, format!("{kind}: {why}")));
            Outcome::Lost(said, Lost { kind, why: why.reason(), de })
        }
    }
}

/// The colours that have numbers, from one.
const COLOURS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];

/// The colour of an entity, or of the surface under it: by number, or a colour definition (314) in percent.
fn colour(cards: &Cards, e: &Entity) -> Option<Colour> {
    let own = |e: &Entity| -> Option<[f64; 3]> {
        if e.color >= 0 {
            return COLOURS.get(usize::try_from(e.color).ok()?.checked_sub(1)?).copied();
        }
        let named = cards.entities.get(&e.color.checked_neg()?).filter(|c| c.kind == 314)?;
        let part = |k: usize| named.params.number(k).filter(|x| (0.0..=100.0).contains(x)).map(|x| x / 100.0);
        Some([part(0)?, part(1)?, part(2)?])
    };
    let under = || surface_pointer(e).and_then(|s| own(cards.entities.get(&s)?));
    own(e).or_else(under).map(|[red, green, blue]| Colour { red, green, blue })
}

/// The name of an entity: of a name property behind its parameters, else its label.
fn name(cards: &Cards, e: &Entity) -> String {
    let property = name_property(cards, e).and_then(|de| cards.entities.get(&de)?.params.text(1));
    property.map_or_else(|| e.label.clone(), |t| t.trim().to_owned())
}

/// Directory number of the name property (406, form 15) that stands behind an entity's own parameters.
fn name_property(cards: &Cards, e: &Entity) -> Option<i64> {
    let own = own_parameters(e)?;
    let groups = e.params.number(own).unwrap_or(0.0).max(0.0) as usize;
    let at = own.checked_add(groups)?.checked_add(1)?;
    let count = e.params.number(at)?.max(0.0) as usize;
    (at + 1..e.params.len()).take(count).find_map(|k| {
        let de = e.params.number(k)?.abs() as i64;
        cards.entities.get(&de).is_some_and(|p| p.kind == 406 && p.form == 15).then_some(de)
    })
}

/// Says how the model was put together.
fn tell(cards: &Cards, tree: &Model, diagnostics: &mut Vec<Diagnostic>) {
    for (de, why) in &tree.refused {
        let e = cards.entities.get(de);
        let place = format!("DE {de}, line {}", e.map_or(0, |e| e.line));
        let kind = e.map_or_else(String::new, |e| kind_name(e.kind, e.form));
        diagnostics.push(Diagnostic::loss(place, format!("{kind}: {why}")));
    }
    let mut note = |what: String| diagnostics.push(Diagnostic::note("", what));
    if tree.instances > 0 {
        note(format!("{} instances of subfigures or solids were put in their places", tree.instances));
    }
    let listed = |all: &[i64]| {
        let names: Vec<String> = all.iter().take(NAMED).map(ToString::to_string).collect();
        let more = if all.len() > NAMED { format!(" and {} more", all.len() - NAMED) } else { String::new() };
        format!("DE {}{more}", names.join(", "))
    };
    let faces_that = |f: &dyn Fn(&Entity) -> bool| -> Vec<i64> {
        tree.faces.keys().copied().filter(|de| cards.entities.get(de).is_some_and(f)).collect()
    };
    let blanked = faces_that(&|e| e.status.blanked);
    if !blanked.is_empty() {
        note(format!(
            "{} faces are marked as not to be shown and were read all the same: {}",
            blanked.len(),
            listed(&blanked)
        ));
    }
    let other = faces_that(&|e| !matches!(e.status.usage, 0 | 5));
    if !other.is_empty() {
        note(format!(
            "{} faces are marked as annotation, definition or construction and were read all the same: {}",
            other.len(),
            listed(&other)
        ));
    }
    // Physically dependent, but nothing in the file holds them: their parent is lost.
    let orphans = faces_that(&|e| {
        e.status.subordinate & 1 == 1 && matches!(e.kind, 143 | 144 | 114 | 118 | 120 | 122 | 128)
    });
    let held: BTreeSet<i64> = cards.entities.values().flat_map(parts).collect();
    let orphans: Vec<i64> = orphans.into_iter().filter(|de| !held.contains(de)).collect();
    let mut warn = |what: String| diagnostics.push(Diagnostic::warning("", what));
    if !orphans.is_empty() {
        warn(format!(
            "{} faces are marked as parts of other entities, and none holds them; they are given as faces of their \
             own: {}",
            orphans.len(),
            listed(&orphans)
        ));
    }
    if !tree.unplaced.is_empty() {
        warn(format!(
            "{} subfigures are defined and placed nowhere; their faces are given as they stand: {}",
            tree.unplaced.len(),
            listed(&tree.unplaced)
        ));
    }
    if !tree.trees.is_empty() {
        let all: Vec<i64> = tree.trees.iter().copied().collect();
        diagnostics.push(Diagnostic::loss(
            "",
            format!(
                "{} boolean trees are not evaluated, and their operands are no part of the model by themselves: {}; \
                 export the result as a solid or as surfaces",
                all.len(),
                listed(&all)
            ),
        ));
    }
    if tree.overflow {
        diagnostics.push(Diagnostic::loss(
            "",
            format!(
                "instances place more than {} faces; the rest was not read",
                jobs_in(tree).saturating_sub(1)
            ),
        ));
    }
}

fn jobs_in(tree: &Model) -> usize {
    tree.faces.values().map(Vec::len).sum()
}

/// Entities that were left out, by kind and reason.
#[derive(Default)]
struct Left {
    all: BTreeMap<(String, &'static str), Vec<i64>>,
    order: Vec<(String, &'static str)>,
}

impl Left {
    fn add(&mut self, kind: String, why: &'static str, de: i64) {
        let key = (kind, why);
        match self.all.get_mut(&key) {
            Some(list) => list.push(de),
            None => {
                self.order.push(key.clone());
                self.all.insert(key, vec![de]);
            }
        }
    }

    /// Everything that no face is made of.
    fn unused(&mut self, cards: &Cards, tree: &Model) {
        let mut used: BTreeSet<i64> = tree.faces.keys().chain(&tree.used).copied().collect();
        let mut pending: Vec<i64> = used.iter().copied().collect();
        let operands: BTreeSet<i64> = reach(cards, tree.trees.iter().copied().collect());
        pending.retain(|de| !tree.trees.contains(de));
        while let Some(de) = pending.pop() {
            let Some(e) = cards.entities.get(&de) else { continue };
            let mut next = if matches!(e.kind, 402 | 408 | 430 | 184 | 308) { Vec::new() } else { parts(e) };
            if e.transform > 0 {
                next.push(e.transform);
            }
            // Colours and names.
            next.push(-e.color);
            next.extend(name_property(cards, e));
            pending.extend(next.into_iter().filter(|p| *p > 0 && used.insert(*p)));
        }
        for (de, e) in &cards.entities {
            if used.contains(de) && !tree.trees.contains(de) {
                continue;
            }
            let why =
                if operands.contains(de) { "part of a boolean tree, which is not evaluated" } else { why(e) };
            self.add(kind_name(e.kind, if e.kind == 402 || e.kind == 406 { e.form } else { 0 }), why, *de);
        }
    }

    fn entries(self, cards: &Cards) -> Leftovers {
        let mut out = Leftovers::default();
        for key in self.order {
            let Some(list) = self.all.get(&key) else { continue };
            let names: Vec<String> = list.iter().take(NAMED).map(ToString::to_string).collect();
            let more = if list.len() > NAMED { ", ..." } else { "" };
            let line = |de: &i64| cards.entities.get(de).map(|e| e.line as usize);
            let lines: Vec<usize> = list.iter().take(Leftovers::LINES).filter_map(line).collect();
            let why = format!("{} (DE {}{more})", key.1, names.join(", "));
            out.add_lines(&key.0, list.len(), &why, &lines);
        }
        out
    }
}

/// The entities below some, those included.
fn reach(cards: &Cards, mut pending: Vec<i64>) -> BTreeSet<i64> {
    let mut found: BTreeSet<i64> = pending.iter().copied().collect();
    while let Some(de) = pending.pop() {
        if let Some(e) = cards.entities.get(&de) {
            pending.extend(parts(e).into_iter().filter(|p| found.insert(*p)));
        }
    }
    found
}

/// Why an entity that no face is made of is left out.
const fn why(e: &Entity) -> &'static str {
    match e.kind {
        0 => "null entity",
        100 | 102 | 104 | 106 | 110 | 112 | 126 | 130 | 141 | 142 => "a curve, and no face uses it",
        116 | 123 | 124 | 132 | 502 | 504 | 508 => "no face uses it",
        150..=168 => "solids by construction are not read",
        180 => "boolean trees are not evaluated",
        184 | 186 | 308 | 408 | 430 | 514 => "it leads to no face",
        402 => "a group that leads to no face",
        412 | 414 => "arrays of instances are not read",
        134 | 136 | 138 | 146 | 148 => "finite elements",
        200..=230 => "annotation",
        302..=322 => "a definition of how things are shown or named",
        404 | 410 => "a drawing or view",
        406 => "a property",
        416 => "it refers to another file",
        418 | 420 => "networks have no shape",
        _ => "it has no shape that is read",
    }
}
