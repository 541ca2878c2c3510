//! Passes of a tool that keeps its axis, by the lines that they follow.

use super::{DropTask, drop_cutter, gradient_3c, waterline_3c};
use crate::plan::{Passes, PlanError};
use osculate_geom::{Unit3, Vec3};

/// The lines of passes for which the cutter is dropped onto the faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThreeAxisLines {
    /// In parallel planes along the axis.
    Planes,
    /// Up and down the slope.
    Gradient,
    /// At constant heights along the axis.
    Waterlines,
}

impl ThreeAxisLines {
    /// The key of job files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Planes => "isoplanar_3c",
            Self::Gradient => "gradient_3c",
            Self::Waterlines => "waterline_3c",
        }
    }

    /// Passes along such lines.
    ///
    /// # Errors
    /// As [`drop_cutter`], [`gradient_3c`] and [`waterline_3c`] have them.
    pub fn passes(self, task: &DropTask<'_>) -> Result<Passes, PlanError> {
        match self {
            Self::Planes => drop_cutter(task),
            Self::Gradient => gradient_3c(task),
            Self::Waterlines => waterline_3c(task),
        }
    }
}

/// How a tool that keeps its axis is led over faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThreeAxis {
    /// The lines of its passes.
    pub lines: ThreeAxisLines,
    /// Its axis, from the tip to the holder.
    pub axis: Unit3,
    /// The way of passes in planes, brought into the plane across the axis; of the others where they have a choice.
    pub feed: Vec3,
}
