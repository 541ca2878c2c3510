//! Random faults in good NC programs: what verification finds, against a slow reference.
//!
//! Verification reads a program's text back through the machine and judges it, as `osculate verify` does: strictly, words
//! that are not understood refuse it. The reference judges the same motions (read leniently) by brute force, see
//! [`reference`](reference::reference). Where its worst place comes within [`BAND`] of a limit the fault is counted apart:
//! verification sees the part at samples, and a place between them may stand that much higher.

pub mod faults;
pub mod programs;
pub mod reference;

use faults::{Dice, Fault, KINDS, fault};
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, Setup};
use osculate_tools::Cutter;
use osculate_tools::cl::Motion;
use osculate_tools::removal::{Job, Limits, Swept, cut, sample_surface, tally};
use programs::{Good, RECIPES, good};
use rayon::prelude::*;
use reference::{Shape, reference};
use std::collections::BTreeMap;

pub const LIMITS: Limits =
    Limits { scallop_mm: 0.03, gouge_mm: 0.01, uncut_mm: 0.15, collision_mm: 0.01, worst: 3 };
/// Material on the part before the program.
pub const STOCK_MM: f64 = 0.6;
/// Gouges are followed down to here.
pub const DEPTH_MM: f64 = 1.5;
/// Distance of verification's samples, mm.
const SPACING_MM: f64 = 0.05;
/// Share of a limit within which the two may differ: at samples 0.05 mm apart a gouge of relative curvature 0.4 looks up to
/// `0.4 * 0.035^2 / 2` = 0.00025 mm shallower, a fortieth of the limit; a cusp of slope 0.15 up to `0.025 * 0.15`, an
/// eighth of its limit, had it one point and no line.
pub const BAND: f64 = 0.05;

/// What verification says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Says {
    Refused,
    NotWithin,
    Within,
}

/// One fault and what became of it.
#[derive(Clone, Debug)]
pub struct Row {
    pub dialect: Dialect,
    pub machine: &'static str,
    pub part: &'static str,
    pub kind: &'static str,
    pub note: String,
    pub says: Says,
    /// Why strict reading refused the text.
    pub refused: Option<String>,
    /// The largest share of a limit, None where not even lenient reading can follow.
    pub truth: Option<f64>,
}

impl Row {
    /// Whether the fault has an effect above the limits, None where it comes too close to tell.
    pub fn harmful(&self) -> Option<bool> {
        match self.truth {
            None => Some(true),
            Some(share) if share > 1.0 + BAND => Some(true),
            Some(share) if share < 1.0 - BAND => Some(false),
            Some(_) => None,
        }
    }
    /// Whether the text was refused after a change that may make it no program: a letter among digits, a G93 block without F.
    /// Which it was is printed; after the other changes a refusal is a false alarm.
    pub fn garbled(&self) -> bool {
        let intact = ["comment", "slower feed", "line twice", "gauge length", "part zero", "tool radius"];
        self.refused.is_some() && !intact.contains(&self.kind)
    }
    pub fn right(&self) -> Option<bool> {
        if self.garbled() {
            return Some(true);
        }
        self.harmful().map(|bad| bad == (self.says != Says::Within))
    }
}

/// Motions of a text, or why it is refused.
fn motions(g: &Good, text: &str, setup: &Setup, strict: bool) -> Result<Vec<Swept>, String> {
    let options = ReadOptions { strict, ..ReadOptions::default() };
    let found = read(text, g.recipe.dialect, &g.machine, setup, &options).map_err(|e| e.to_string())?;
    let pairs = found.moves.windows(2);
    Ok(pairs
        .map(|w| Swept {
            from: w[0].pose,
            to: w[1].pose,
            rapid: matches!(w[1].motion, Motion::Rapid),
            block: w[1].line as u32,
        })
        .collect())
}

fn verify(g: &Good, motions: &[Swept], cutter: &Cutter) -> Says {
    let surface = g.recipe.part.surface(1.0);
    let sampling = sample_surface(&*surface, 0, SPACING_MM, 100_000).expect("a good patch");
    let samples = &sampling.samples;
    let job =
        Job { cutter, holder: None, changes: &[], motions, samples, stock_mm: STOCK_MM, depth_mm: DEPTH_MM };
    let Ok(cuts) = cut(&job, &|_| ()) else { return Says::Refused };
    let v = tally(samples, &cuts, &LIMITS, &sampling.density, cutter.radius_mm()).expect("good limits");
    if v.within { Says::Within } else { Says::NotWithin }
}

/// All good programs.
pub fn programs() -> Vec<Good> {
    RECIPES.map(good).into()
}

/// What the two say of a good program: they must both find it good.
pub fn check_good(g: &Good, side: u32) -> f64 {
    let m = motions(g, &g.text, &g.setup, true).expect("its own dialect");
    let share = reference(&m, Shape::of(g, 0.0), g.recipe.part, side);
    let says = verify(g, &m, &g.cutter);
    assert!(says == Says::Within && share < 1.0 - BAND, "{:?}: {says:?} {share}", g.recipe);
    share
}

/// What becomes of one fault.
fn outcome(g: &Good, f: Fault, side: u32) -> Row {
    let strict = motions(g, &f.text, &f.setup, true);
    let says = strict.as_ref().map_or(Says::Refused, |m| verify(g, m, &f.cutter));
    let refused = strict.err();
    let truth = motions(g, &f.text, &f.setup, false)
        .ok()
        .map(|m| reference(&m, Shape::of(g, f.larger_mm), g.recipe.part, side));
    let (dialect, machine, part) = (g.recipe.dialect, g.recipe.machine, g.recipe.part.name());
    Row { dialect, machine, part, kind: f.kind, note: f.note, says, refused, truth }
}

/// `count` faults of all kinds over the programs in turn.
pub fn study(programs: &[Good], count: usize, seed: u64, side: u32) -> Vec<Row> {
    let mut dice = Dice::new(seed);
    let mut chosen = Vec::with_capacity(count);
    while chosen.len() < count {
        let g = &programs[chosen.len() % programs.len()];
        let kind = KINDS[dice.below(KINDS.len())];
        // Not every line has something to change.
        let tried = (0..200).find_map(|_| fault(g, kind, &mut dice));
        chosen.extend(tried.map(|f| (g, f)));
    }
    chosen.into_par_iter().map(|(g, f)| outcome(g, f, side)).collect()
}

/// Counts of faults.
#[derive(Clone, Copy, Debug, Default)]
pub struct Count {
    pub faults: usize,
    pub harmful: usize,
    /// Of the harmful ones.
    pub found: usize,
    pub harmless: usize,
    /// Harmless ones called a fault.
    pub alarms: usize,
    /// Texts that are no programs, refused.
    pub garbled: usize,
    /// Within the band.
    pub close: usize,
}

impl Count {
    pub fn add(&mut self, row: &Row) {
        self.faults += 1;
        let noticed = usize::from(row.says != Says::Within);
        match row.harmful() {
            _ if row.garbled() => self.garbled += 1,
            Some(true) => {
                self.harmful += 1;
                self.found += noticed;
            }
            Some(false) => {
                self.harmless += 1;
                self.alarms += noticed;
            }
            None => self.close += 1,
        }
    }
}

/// Counts by kind.
pub fn table(rows: &[Row]) -> BTreeMap<&'static str, Count> {
    let mut out: BTreeMap<&'static str, Count> = BTreeMap::new();
    for row in rows {
        out.entry(row.kind).or_default().add(row);
    }
    out
}
