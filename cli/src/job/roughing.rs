//! How a job roughs: the keys of `z_level`, and those of an operation that stand for them.

use crate::failure::Failure;
use crate::job::SHARES;
use crate::job::problem::Places;
use crate::job::raw::{self, Raw};
use crate::job::words::{AxisKey, DirectionsKey, EntryWord, StrategyWord};

/// Steepest way down into material where the job gives none, degrees.
const RAMP_DEG: f64 = 3.0;
/// No more directions are taken by themselves.
const MOST_DIRECTIONS: usize = 12;
/// A direction that takes less than this share of all is not worth it.
const LEAST_SHARE: f64 = 0.02;
/// What a roughing leaves where nothing says it, mm.
const ALLOWANCE_MM: f64 = 0.5;
/// Its deepest cut and the distance of its rows, of the tool's diameter.
const STEPDOWN: f64 = 0.25;
const STEPOVER: f64 = 0.4;
/// How far it may go into its allowance, and how far straight moves may be off, of the allowance.
const INTO_ALLOWANCE: f64 = 0.2;
const CHORD_OF_ALLOWANCE: f64 = 0.1;

/// The table of the keys.
const TABLE: &str = "strategy";

/// The sizes of a roughing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Layers {
    /// Deepest cut along the axis.
    pub stepdown_mm: f64,
    /// Distance of rows.
    pub stepover_mm: f64,
    /// What it leaves on the faces.
    pub allowance_mm: f64,
    /// Steepest way down into material.
    pub ramp_rad: f64,
    /// How it comes into material.
    pub entry: EntryWord,
    /// Greatest volume rate; none without it.
    pub volume_rate_mm3_min: Option<f64>,
    /// Most directions, where they are to be found.
    pub directions: Option<usize>,
    /// A direction that takes less than this share is not taken.
    pub least_share: f64,
}

/// The sizes of a table.
pub(super) fn layers(places: &Places, t: &raw::Strategy) -> Result<Layers, Failure> {
    let refuse = |key: &str, what: &str| Err(places.refuse(TABLE, key, what));
    let needed = |key: &str, value: Option<f64>| {
        let what = format!("{} needs {key}, a positive number", t.kind.word());
        value.ok_or_else(|| places.refuse(TABLE, "kind", what))
    };
    if t.directions.is_some() && matches!(t.axis, Some(AxisKey::Given(_))) {
        return refuse(
            "directions",
            "directions finds the axes, and axis gives one: leave out one of the two",
        );
    }
    if t.directions.is_none() && t.least_share.is_some() {
        return refuse("least_share", "least_share is for found axes: add directions = \"auto\"");
    }
    Ok(Layers {
        stepdown_mm: needed("stepdown_mm", t.stepdown_mm)?,
        stepover_mm: needed("stepover_mm", t.stepover_mm)?,
        allowance_mm: t.allowance_mm.unwrap_or(0.0),
        ramp_rad: t.ramp_deg.unwrap_or(RAMP_DEG).to_radians(),
        entry: t.entry.unwrap_or_default(),
        volume_rate_mm3_min: t.volume_rate_mm3_min,
        directions: t.directions.map(|d| match d {
            DirectionsKey::Auto => MOST_DIRECTIONS,
            DirectionsKey::Most(n) => n,
        }),
        least_share: t.least_share.unwrap_or(LEAST_SHARE),
    })
}

/// Whether an operation has keys that are for roughing alone, and the first of them.
pub(super) fn own_key(own: &raw::Operation) -> Option<&'static str> {
    let all = [
        ("stepdown_mm", own.stepdown_mm.is_some()),
        ("stepover_mm", own.stepover_mm.is_some()),
        ("axis", own.axis.is_some()),
        ("directions", own.directions.is_some()),
        ("least_share", own.least_share.is_some()),
        ("entry", own.entry.is_some()),
        ("ramp_deg", own.ramp_deg.is_some()),
        ("volume_rate_mm3_min", own.volume_rate_mm3_min.is_some()),
    ];
    all.into_iter().find(|(_, is)| *is).map(|(key, _)| key)
}

/// A roughing of a list: sizes from the tool where nothing says them.
pub(super) fn rough(
    raw: &mut Raw,
    own: &raw::Operation,
    diameter_mm: f64,
) -> Result<(), (&'static str, String)> {
    let s = &mut raw.strategy;
    if !matches!(s.kind, StrategyWord::Auto | StrategyWord::ZLevel) {
        return Err(("kind", format!("kind = \"rough\" goes in layers (z_level), not by {}", s.kind.word())));
    }
    s.kind = StrategyWord::ZLevel;
    let stepdown = own.stepdown_mm.or(s.stepdown_mm).unwrap_or(STEPDOWN * diameter_mm);
    let allowance = own.allowance_mm.or(s.allowance_mm).unwrap_or(ALLOWANCE_MM);
    s.stepdown_mm = Some(stepdown);
    s.stepover_mm = own.stepover_mm.or(s.stepover_mm).or(Some(STEPOVER * diameter_mm));
    s.allowance_mm = Some(allowance);
    s.axis = own.axis.map(AxisKey::Given).or(s.axis);
    s.directions = own.directions.or(s.directions);
    s.least_share = own.least_share.or(s.least_share);
    s.entry = own.entry.or(s.entry);
    s.ramp_deg = own.ramp_deg.or(s.ramp_deg);
    s.volume_rate_mm3_min = own.volume_rate_mm3_min.or(s.volume_rate_mm3_min);
    let t = &mut raw.tolerance;
    let gouge = t.gouge_mm.unwrap_or(SHARES[0] * t.scallop_mm);
    t.chord_mm = Some(t.chord_mm.unwrap_or(SHARES[1] * t.scallop_mm).max(CHORD_OF_ALLOWANCE * allowance));
    t.gouge_mm = Some(own.gouge_mm.unwrap_or_else(|| gouge.max(INTO_ALLOWANCE * allowance)));
    t.scallop_mm = own.scallop_mm.unwrap_or(stepdown);
    Ok(())
}
