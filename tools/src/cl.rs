//! Cutter location paths: what crosses the border between planning, posting and verification.

use crate::pose::Pose;
use crate::spec::{CutterSpec, HolderSpec};

/// How the tool gets to a pose from the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// As fast as the machine goes; not meant to touch material.
    Rapid,
    /// At a feed of the tool tip relative to the part, mm/min.
    Feed(f64),
}

/// One CL point with the motion that leads to it. Between two points tip and axis move linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClMove {
    /// Where the tool ends.
    pub pose: Pose,
    /// How it gets there.
    pub motion: Motion,
}

/// A whole tool path in the part's frame.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ClPath {
    /// The cutter, where known.
    pub cutter: Option<CutterSpec>,
    /// The sections of the holder from the nose upwards, where known.
    pub holder: Vec<HolderSpec>,
    /// Spindle speed, where known.
    pub spindle_rpm: Option<f64>,
    /// The moves. The first one's motion leads from an unknown place and must be [`Motion::Rapid`].
    pub moves: Vec<ClMove>,
}
