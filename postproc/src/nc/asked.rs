//! What one line of a program asks of the control, once all its words are seen.

use super::control::{Corner, Spindle};
use super::token::Manner;
use super::work_offset::WorkOffset;

/// A word that says how the control goes from block to block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PathWord {
    /// G61, G60.
    ExactPath,
    /// G61.1, G9.
    ExactStop,
    /// G64 and its like.
    Blend,
}

/// A word about the tool's length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LengthWord {
    /// G43, G43.4, G43.5.
    On,
    /// G43.1.
    Measured,
    /// G49.
    Off,
}

/// What one line asks for.
#[derive(Default)]
pub(super) struct Asked {
    /// Axis words.
    pub axes: Vec<(String, f64, Manner)>,
    /// Positions are the machine's own.
    pub machine_frame: bool,
    /// G28, G30: by way of the positions to the machine's home.
    pub home: bool,
    /// M92: to a place that only the machine knows.
    pub builders_place: bool,
    /// G4.
    pub dwell: bool,
    /// A word that makes the axis words of the line something other than a move.
    pub other_use: bool,
    pub klartext_move: bool,
    pub rapid_once: bool,
    /// I, J, K and R (or CR), mm.
    pub centre: [Option<f64>; 3],
    pub radius: Option<f64>,
    /// G68.2, G53.1.
    pub plane: bool,
    pub turn_to_plane: bool,
    /// A3, B3, C3, or what else gives the tool's direction.
    pub vector: [Option<f64>; 3],
    /// F, P, Q, L, S in the program's units.
    pub f: Option<f64>,
    pub p: Option<f64>,
    pub q: Option<f64>,
    pub l: Option<f64>,
    /// A path control word of this line.
    pub path: Option<PathWord>,
    /// What it says of corners, where P and Q do not say it.
    pub corner: Option<Corner>,
    /// G5.1.
    pub contour: bool,
    /// T, and M6.
    pub tool: Option<u32>,
    pub change: bool,
    /// H, and D.
    pub h: Option<u32>,
    pub d: Option<u32>,
    pub length: Option<LengthWord>,
    pub work_offset: Option<WorkOffset>,
    pub spindle: Option<Spindle>,
    /// Programmed frames are deleted, which takes no axis words.
    pub frames_deleted: bool,
    /// A slash stands before it.
    pub skipped: bool,
    /// It has words that do something.
    pub acts: bool,
    pub end: bool,
}
