//! In what state a control makes its moves: tool, offsets, spindle, coolant, how corners are rounded; and a record of
//! the states in which a program has moved.
//!
//! The record counts moves by state and keeps the first line of each, not the moves: it grows with the number of times
//! that a program comes to a state it has long not had.

use super::Dialect;
use super::work_offset::WorkOffset;
use crate::machine::{Beyond, Joint, JointKind};

/// The tool in the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) enum Tool {
    /// No tool has been called.
    #[default]
    Unsaid,
    /// Called by a name.
    Named,
    Number(u32),
}

/// The tool's length in X Y Z.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(super) enum Length {
    #[default]
    Unsaid,
    /// G49, D0.
    Off,
    /// G43, G43.4 with H, or D; without a number where none is said.
    On(Option<u32>),
    /// The length itself, mm (G43.1).
    Measured(f64),
}

/// The spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) enum Spindle {
    #[default]
    Unsaid,
    /// M5, or a change of the tool.
    Stopped,
    /// M3.
    Clockwise,
    /// M4.
    Counter,
}

/// What happens at corners.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(super) enum Corner {
    #[default]
    Unsaid,
    /// They are kept.
    Exact,
    /// They are left by this at most, mm.
    Within(f64),
    /// They are left by what the machine's data say.
    Machine,
    /// They are left by any amount.
    Unlimited,
}

/// The state of a control, as far as it is not the way itself.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(super) struct Control {
    pub tool: Tool,
    /// What a tool call adds to the tool's length or radius, mm.
    pub tool_delta_mm: f64,
    pub length: Length,
    pub work_offset: Option<WorkOffset>,
    pub spindle: Spindle,
    pub speed_rpm: Option<f64>,
    pub flood: bool,
    pub mist: bool,
    pub corner: Corner,
    /// The tolerance of smoothing: CYCLE832, CTOL, cycle 32, mm.
    pub smoothing_mm: Option<f64>,
}

impl Control {
    /// The number of the tool in the spindle.
    pub const fn tool_number(&self) -> Option<u32> {
        match self.tool {
            Tool::Number(n) => Some(n),
            Tool::Unsaid | Tool::Named => None,
        }
    }

    /// Another tool is put into the spindle, which stands still for it.
    pub fn change(&mut self, tool: Tool) {
        if self.tool == tool && tool != Tool::Named {
            return;
        }
        self.tool = tool;
        if self.spindle != Spindle::Unsaid {
            self.spindle = Spindle::Stopped;
        }
    }
}

/// How often something was seen, and in which line first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) struct Seen {
    /// From 1; 0 where it was not seen.
    pub line: usize,
    pub count: usize,
}

impl Seen {
    /// Once more.
    pub const fn again(&mut self, line: usize) {
        if self.count == 0 {
            self.line = line;
        }
        self.count += 1;
    }

    /// Both; the lines of the earlier one.
    pub fn with(self, other: Self) -> Self {
        let line = match (self.count, other.count) {
            (_, 0) => self.line,
            (0, _) => other.line,
            _ => self.line.min(other.line),
        };
        Self { line, count: self.count + other.count }
    }
}

/// The moves made in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Use {
    pub control: Control,
    /// Feed moves.
    pub feed: Seen,
    /// Rapid moves along Z of the program's coordinates.
    pub plunge: Seen,
}

/// What a move is to the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Feed,
    /// A rapid move along Z of the program's coordinates.
    Plunge,
    Rapid,
}

impl Kind {
    pub const fn of(rapid: bool, plunges: bool) -> Self {
        match (rapid, plunges) {
            (false, _) => Self::Feed,
            (true, true) => Self::Plunge,
            (true, false) => Self::Rapid,
        }
    }
}

/// The states in which a program has moved.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Record {
    /// The dialect of the program; absent: nothing has been read.
    pub(super) dialect: Option<Dialect>,
    pub(super) uses: Vec<Use>,
    /// Tools that have been selected, with the first line of each.
    pub(super) selected: Vec<(u32, usize)>,
    /// Line of the first move; 0: none.
    pub(super) first_move: usize,
    /// M3 or M4 has been said.
    pub(super) spindle_started: bool,
    /// Blocks behind a slash.
    pub(super) skipped: Seen,
    /// Feed moves of which neither start nor end is known.
    pub(super) nowhere: Seen,
    /// Feed moves from an unknown place to a known one.
    pub(super) from_nowhere: Seen,
    /// Axes sent to a place of the machine that is not known.
    pub(super) sent: Seen,
    /// The same before the first place that is known.
    pub(super) sent_first: Seen,
    /// Machine coordinates of joints whose zero the machine file does not say.
    pub(super) guessed: Seen,
    /// Joints that would have to leave their range, one entry each.
    pub(super) beyond: Vec<Outside>,
}

/// A joint that a program sends out of its range.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outside {
    pub letter: String,
    /// Moves that bring it there.
    pub seen: Seen,
    /// Farthest out, in the unit of the joint; a slide at the spindle nose.
    pub at: f64,
    /// By so much, in the unit of the joint.
    pub by: f64,
    /// The range in words.
    pub range: String,
    /// A slide, read at the spindle nose.
    pub slides: bool,
}

/// Joints may be out of their range by this, mm or degrees: positions in programs are rounded.
const NOT_OUT: f64 = 1e-3;

/// States that are looked through for the one in force.
const LOOKED_BACK: usize = 16;

impl Record {
    /// A move.
    pub(super) fn moved(&mut self, line: usize, kind: Kind, control: &Control) {
        if self.first_move == 0 {
            self.first_move = line;
        }
        let near = self.uses.len().saturating_sub(LOOKED_BACK);
        let place = match self.uses[near..].iter().rposition(|u| u.control == *control) {
            Some(k) => near + k,
            None => {
                self.uses.push(Use { control: *control, feed: Seen::default(), plunge: Seen::default() });
                self.uses.len() - 1
            }
        };
        match kind {
            Kind::Feed => self.uses[place].feed.again(line),
            Kind::Plunge => self.uses[place].plunge.again(line),
            Kind::Rapid => {}
        }
    }

    /// A move brings a joint out of its range.
    pub(super) fn outside(&mut self, line: usize, joint: &Joint, out: &Beyond) {
        let (at, by) = (joint.shown(out.at), joint.shown(out.by));
        if by <= NOT_OUT {
            return;
        }
        let k = self.beyond.iter().position(|b| b.letter == joint.letter).unwrap_or_else(|| {
            let end = |v: Option<f64>| v.map_or("no limit".into(), |v| joint.shown(v).to_string());
            self.beyond.push(Outside {
                letter: joint.letter.clone(),
                seen: Seen::default(),
                at,
                by,
                range: format!("{} to {} {}", end(joint.min), end(joint.max), joint.unit()),
                slides: joint.kind == JointKind::Linear,
            });
            self.beyond.len() - 1
        });
        let this = &mut self.beyond[k];
        this.seen.again(line);
        if by > this.by {
            (this.at, this.by) = (at, by);
        }
    }

    /// A tool is selected.
    pub(super) fn select(&mut self, number: u32, line: usize) {
        // A magazine holds far fewer; a text of nothing but tool words must not make this long.
        const MOST: usize = 1000;
        if self.selected.len() < MOST && !self.selected.iter().any(|s| s.0 == number) {
            self.selected.push((number, line));
        }
    }
}
