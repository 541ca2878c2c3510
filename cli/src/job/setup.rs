//! `[setup]`: where the part sits and how rapid moves go.

use crate::failure::Failure;
use crate::job::cutting::LAYER_OF_APPROACH;
use crate::job::problem::Places;
use crate::job::raw;
use crate::job::strategy::Strategy;
use crate::job::words::Turns;

/// Height from which the tool goes down at feed where nothing higher stands on the faces, mm.
const APPROACH_MM: f64 = 2.0;
/// The lift of the lowest hops, of `approach_mm`, where the job does not say it.
const HOP_SHARE: f64 = 0.125;
/// What the tool keeps from check faces in hops, of `approach_mm`: below the height of a hop, which passes over neighbours.
const CHECK_SHARE: f64 = 0.5;

/// Where the part sits and how rapid moves go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Where the part's origin sits from the table's reference point; chosen from the part's box where not given.
    pub part_zero_mm: Option<[f64; 3]>,
    /// The part's axes turned on the table, about x, then y, then z; chosen from the faces' normals where not given.
    pub rotate_deg: Option<[f64; 3]>,
    /// How the part may be turned where `rotate_deg` is not given.
    pub turns: Turns,
    /// Whether the file says so.
    pub asks_turns: bool,
    /// Clearance of rapid moves over the sphere around the part.
    pub clearance_mm: f64,
    /// Distance from the surface at which rapid moves end.
    pub approach_mm: f64,
    /// The least lift in hops from pass to pass.
    pub hop_mm: f64,
    /// What the tool keeps from check faces in hops from pass to pass.
    pub check_clearance_mm: f64,
}

impl Setup {
    /// `highest_mm` is what stands on the faces to machine at most.
    pub(super) fn of(
        places: &Places,
        t: &raw::Setup,
        strategy: &Strategy,
        highest_mm: f64,
    ) -> Result<Self, Failure> {
        // Rapid moves end above what stands on the faces.
        let approach_mm = t.approach_mm.unwrap_or_else(|| APPROACH_MM.max(highest_mm / LAYER_OF_APPROACH));
        let own = if strategy.layers().is_some() { approach_mm } else { HOP_SHARE * approach_mm };
        let hop_mm = t.hop_mm.unwrap_or(own);
        if hop_mm > approach_mm {
            let what = format!(
                "hop_mm = {hop_mm} is more than approach_mm = {approach_mm}: hops rise by no more than that"
            );
            return Err(places.refuse("setup", "hop_mm", what));
        }
        Ok(Self {
            part_zero_mm: t.part_zero_mm,
            rotate_deg: t.rotate_deg,
            turns: t.turns.unwrap_or_default(),
            asks_turns: t.turns.is_some(),
            clearance_mm: t.clearance_mm.unwrap_or(10.0),
            approach_mm,
            hop_mm,
            check_clearance_mm: t.check_clearance_mm.unwrap_or(CHECK_SHARE * approach_mm),
        })
    }
}
