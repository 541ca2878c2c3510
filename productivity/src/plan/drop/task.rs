//! What is asked of passes of a tool that keeps its axis.

use crate::plan::{Named, Tolerance};
use osculate_geom::{Unit3, Vec3};
use osculate_tools::Cutter;

/// What to plan with a fixed tool axis.
#[derive(Clone, Copy)]
pub struct DropTask<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// Faces that the tool must not cut.
    pub check: &'a [Named<'a>],
    /// The cutter.
    pub cutter: &'a Cutter,
    /// The tool axis, from the tip to the holder.
    pub axis: Unit3,
    /// The way of the passes, brought into the plane across the axis.
    pub feed: Vec3,
    /// What must hold.
    pub tolerance: Tolerance,
    /// Told how far the work is, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}
