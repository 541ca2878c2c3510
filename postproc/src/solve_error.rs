//! Why a machine cannot run a path: where, what value, what to change.

use osculate_geom::Point3;
use osculate_tools::Pose;

use crate::machine::{AxisUnreachable, Machine};
use crate::setup::SetupError;

/// Why a path cannot be run on a machine. `index` counts CL moves from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// Nothing to do.
    #[error("the path has no moves")]
    Empty,
    /// The setup is none.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// An option that makes no sense.
    #[error("solve option {what} is {value}: it must be a finite number {wanted}")]
    Option {
        /// The option.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        wanted: &'static str,
    },
    /// A pose or feed is not finite, or a feed is not positive.
    #[error("CL move {index}: a coordinate or feed is not a finite number, or the feed is not above zero")]
    NotFinite {
        /// The move.
        index: usize,
    },
    /// The rotary joints cannot point the tool so.
    #[error(
        "CL move {index}: the tool axis ({:.6}, {:.6}, {:.6}) at ({:.3}, {:.3}, {:.3}) is {off_deg:.4} deg outside of \
         what the machine's rotary joints reach: turn the part in its setup or change lead and tilt",
        axis[0], axis[1], axis[2], tip.x, tip.y, tip.z
    )]
    Unreachable {
        /// The move.
        index: usize,
        /// The tip, part frame.
        tip: Point3,
        /// The axis, part frame.
        axis: [f64; 3],
        /// Angle to what can be reached.
        off_deg: f64,
    },
    /// Every way to reach a pose leaves a joint's range.
    #[error(
        "CL move {index}: at ({:.3}, {:.3}, {:.3}) joint {joint} would be at {value:.4} {unit}{}, its range is {min:.4} to \
         {max:.4} {unit}: move or turn the part in its setup, or change lead and tilt",
        tip.x, tip.y, tip.z, if *unit == "mm" { " at the spindle nose" } else { "" }
    )]
    Limit {
        /// The move.
        index: usize,
        /// The tip, part frame.
        tip: Point3,
        /// The joint that is out by least.
        joint: String,
        /// Where it would be; a slide at the spindle nose.
        value: f64,
        /// mm or deg.
        unit: &'static str,
        /// Smallest value; `-inf` without limit.
        min: f64,
        /// Largest value; `inf` without limit.
        max: f64,
    },
    /// The linear joints cannot move the tip in all directions.
    #[error("CL move {index}: the linear joints lie in one plane here, the tip at ({:.3}, {:.3}, {:.3}) cannot be held", tip.x, tip.y, tip.z)]
    Flat {
        /// The move.
        index: usize,
        /// The tip, part frame.
        tip: Point3,
    },
    /// The joints would have to jump.
    #[error(
        "CL move {index}: the rotary joints would jump by {rotary_deg:.3} deg (tip off by {tip_mm:.4} mm, axis by \
         {axis_deg:.4} deg): widen the tolerances or the singular cone, or turn the part in its setup"
    )]
    Jump {
        /// The move.
        index: usize,
        /// Tip deviation left.
        tip_mm: f64,
        /// Axis deviation left.
        axis_deg: f64,
        /// Rotary step.
        rotary_deg: f64,
    },
    /// The way is too long for the tolerance.
    #[error(
        "CL move {index}: it takes more than {most} blocks to keep the tool on its line: is a length in another unit, or the tolerance \
         too fine?"
    )]
    Pieces {
        /// The move.
        index: usize,
        /// Blocks of a move at most.
        most: usize,
    },
    /// A rewind is needed and no point of the move allows both turns.
    #[error(
        "CL move {index}: the rotary joints must be rewound, and nowhere on this move both turns are inside the \
         limits: turn the part in its setup, or choose a machine with a wider range"
    )]
    NoRewind {
        /// The move.
        index: usize,
    },
}

impl From<std::convert::Infallible> for SolveError {
    fn from(never: std::convert::Infallible) -> Self {
        match never {}
    }
}

impl SolveError {
    /// The CL move that it speaks of, from 0.
    #[must_use]
    pub const fn index(&self) -> Option<usize> {
        match self {
            Self::NotFinite { index }
            | Self::Unreachable { index, .. }
            | Self::Limit { index, .. }
            | Self::Flat { index, .. }
            | Self::Jump { index, .. }
            | Self::Pieces { index, .. }
            | Self::NoRewind { index } => Some(*index),
            Self::Empty | Self::Setup(_) | Self::Option { .. } => None,
        }
    }

    pub(crate) fn unreachable(index: usize, pose: &Pose, e: AxisUnreachable) -> Self {
        let axis = [pose.axis.x, pose.axis.y, pose.axis.z];
        Self::Unreachable { index, tip: pose.tip, axis, off_deg: e.off_rad.to_degrees() }
    }

    pub(crate) fn limit(machine: &Machine, index: usize, pose: &Pose, out: (usize, f64)) -> Self {
        let (place, value) = out;
        let joint = machine.joint_at(place);
        Self::Limit {
            index,
            tip: pose.tip,
            joint: joint.letter.clone(),
            value: joint.shown(value),
            unit: joint.unit(),
            min: joint.min.map_or(f64::NEG_INFINITY, |m| joint.shown(m)),
            max: joint.max.map_or(f64::INFINITY, |m| joint.shown(m)),
        }
    }

    pub(crate) const fn flat(index: usize, pose: &Pose) -> Self {
        Self::Flat { index, tip: pose.tip }
    }
}
