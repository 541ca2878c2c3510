//! A path in joints: what a machine is told, before a dialect words it.

use osculate_geom::{Diagnostic, Point3};
use osculate_tools::cl::Motion;

use crate::machine::JointValues;

/// Why a block is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BlockKind {
    /// It ends at a CL point.
    Point,
    /// It was put between two CL points to keep the tool on its line.
    Inserted,
    /// Part of a rewind: away from the part, rotary joints into another turn or branch, back.
    Rewind,
}

/// One move, from where the block before ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointBlock {
    /// Where the joints end, mm and rad in chain order. Endless rotary joints count on through whole turns.
    pub joints: JointValues,
    /// Where the tip ends, in the part's frame, mm.
    pub tip: Point3,
    /// Rapid, or at a feed of the tip relative to the part.
    pub motion: Motion,
    /// Which CL move it belongs to.
    pub source: usize,
    /// Length of the tip's way relative to the part, mm.
    pub tip_length_mm: f64,
    /// Why it is there.
    pub kind: BlockKind,
}

/// What solving a path took.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct SolveSummary {
    /// Blocks of kind [`BlockKind::Inserted`].
    pub inserted_points: usize,
    /// CL points that blocks go on over (`SolveOptions::join`).
    pub joined_points: usize,
    /// Rewinds.
    pub rewinds: usize,
    /// Length of the tip's way during which the outer rotary joint was held near a pole, mm.
    pub singular_mm: f64,
    /// Greatest distance of the tip from the CL line in feed moves, mm: what of it counts (`SolveOptions::touch_rad`).
    pub tip_error_mm: f64,
    /// Greatest angle of the tool axis from the CL's in feed moves, rad.
    pub axis_error_rad: f64,
}

impl SolveSummary {
    /// Counts what a block of a feed move strays by.
    pub(crate) const fn add_stray(&mut self, tip_mm: f64, axis_rad: f64) {
        self.tip_error_mm = self.tip_error_mm.max(tip_mm);
        self.axis_error_rad = self.axis_error_rad.max(axis_rad);
    }
}

/// A whole path in joints. The first block leads from an unknown place.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct JointPath {
    /// The blocks.
    pub blocks: Vec<JointBlock>,
    /// What it took.
    pub summary: SolveSummary,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

impl JointPath {
    /// Adds what another piece of the same path took and what was found there; its blocks are left out.
    pub(crate) fn append_report(&mut self, mut piece: Self) {
        self.diagnostics.append(&mut piece.diagnostics);
        let (s, p) = (&mut self.summary, piece.summary);
        s.inserted_points += p.inserted_points;
        s.joined_points += p.joined_points;
        s.rewinds += p.rewinds;
        s.singular_mm += p.singular_mm;
        s.tip_error_mm = s.tip_error_mm.max(p.tip_error_mm);
        s.axis_error_rad = s.axis_error_rad.max(p.axis_error_rad);
    }
}
