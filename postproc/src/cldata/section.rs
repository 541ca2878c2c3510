//! The tools of a CL text one after the other: which moves each makes, and what is said between them.
//!
//! A section begins at the first point after a `LOADTL` (`LOAD/TOOL`) of another tool, with the cutter, speed and coolant that the text has
//! said until then. Points before the first tool is loaded, with which nothing can be cut, belong to that tool. What changes within a
//! section is an auxiliary word before its move.

use osculate_tools::CutterSpec;

use crate::auxiliary::{Auxiliary, AuxiliaryWord, Spindle};
use crate::nc::Coolant;

/// A tool as the text has it when its first move begins.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct ClTool {
    /// Number behind `LOADTL/`.
    pub number: Option<u32>,
    /// The cutter.
    pub cutter: Option<CutterSpec>,
    /// The spindle; absent: the text does not say it.
    pub spindle: Option<Spindle>,
    /// Coolant.
    pub coolant: Option<Coolant>,
}

/// What one tool does, from its call to the next one.
#[derive(Clone, Debug, PartialEq)]
pub struct ClSection {
    /// The line in which the tool is loaded; where none is, that of the first point.
    pub line: usize,
    /// The tool.
    pub tool: ClTool,
    /// Its moves so far.
    pub moves: usize,
    /// Its first point, to which it comes from where tools are changed, is without `RAPID`.
    pub begins_at_feed: bool,
    /// What is done between them, in order.
    pub auxiliary: Vec<Auxiliary>,
    /// Lines of the auxiliary words.
    pub(super) lines: Vec<usize>,
}

/// What has been said and waits for the next point.
#[derive(Clone, Debug, Default)]
pub(super) struct Said {
    /// As the text has it now.
    pub tool: ClTool,
    /// The last speed, also where the spindle is off.
    pub speed_rpm: Option<f64>,
    /// As the moves have it.
    pub in_force: ClTool,
    /// Something has changed since the last point.
    pub changed: bool,
    /// The line of a tool call since then.
    pub loaded: Option<usize>,
    /// Lines of the speed, the coolant and the cutter.
    pub lines: [usize; 3],
    /// The cutter has been said since the last tool was called.
    pub cutter: bool,
    /// Dwells and stops, with their lines.
    pub waiting: Vec<(usize, AuxiliaryWord)>,
}
