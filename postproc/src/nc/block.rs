//! A program before any dialect: moves in counts of the output resolution, and what stands around them.

use super::Dialect;
use super::orientation::Orientation;
use super::work_offset::WorkOffset;
use crate::feed::PathMetric;
use crate::machine::spec::TcpWords;

/// How F is written in a program.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FeedWord {
    /// G94: mm/min (or deg/min) over a metric that the program declares where its dialect can; `None`: the control's own.
    PerMinute(Option<PathMetric>),
    /// G93: 1/min.
    Inverse,
}

/// One move, from where the one before ended. Positions in counts of [`super::number`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NcMove {
    /// G0.
    pub rapid: bool,
    /// Linear words: X Y Z of the tip with tool-centre-point control or in a tilted plane, else the linear joints in
    /// chain order.
    pub linear: [i64; 3],
    /// Rotary words, outer first.
    pub rotary: [i64; 2],
    /// The tool's direction or the angles of the plane across it, where the program says those.
    pub orientation: [i64; 3],
    /// The linear word that goes most along the tool, if one does.
    pub along: Option<usize>,
    /// F; not read in rapid moves.
    pub feed: f64,
}

/// A rotary axis as a program names it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RotaryName {
    /// The axis letter.
    pub letter: String,
    /// It turns without end.
    pub endless: bool,
    /// Decimals of its positions.
    pub decimals: usize,
}

/// Coolant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coolant {
    /// M8.
    Flood,
    /// M7.
    Mist,
}

impl Coolant {
    /// The word that turns it on; `M9` turns it off.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::Flood => "M8",
            Self::Mist => "M7",
        }
    }
}

/// What stands around the moves of a program, and how they are worded.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Its name; letters, digits and underscores survive.
    pub name: String,
    /// Comments at its head.
    pub comments: Vec<String>,
    /// Tool-centre-point control is on.
    pub tcp: bool,
    /// How it says where the tool points.
    pub orientation: Orientation,
    /// LinuxCNC's kinematics switch of this machine.
    pub linuxcnc_tcp: Option<TcpWords>,
    /// The moves stand in a subprogram of their own.
    pub subprogram: bool,
    /// Its number, where the dialect has one.
    pub number: u32,
    /// Tool in the spindle.
    pub tool_number: u32,
    /// The tool to be put ready meanwhile.
    pub next_tool: Option<u32>,
    /// Where program zero is; `None`: [`WorkOffset::usual`].
    pub work_offset: Option<WorkOffset>,
    /// The box around the raw material in the coordinates of the program: its least and its greatest corner.
    pub blank: Option<[[i64; 3]; 2]>,
    /// Spindle speed; `None` leaves the spindle alone.
    pub spindle_rpm: Option<f64>,
    /// The spindle turns counter-clockwise.
    pub counter_clockwise: bool,
    /// Coolant at the first approach.
    pub coolant: Option<Coolant>,
    /// Coolant is on at some time.
    pub cools: bool,
    /// How F is written.
    pub feed_word: FeedWord,
    /// How far the control may round corners, mm.
    pub blend_mm: f64,
    /// LinuxCNC may join straight moves ([`crate::PostOptions::joins`]).
    pub joins: bool,
    /// Where Z goes in the machine's own coordinates at the start, between tools and at the end; `None`: it is left alone.
    pub retract: Option<i64>,
    /// Names of the linear words.
    pub linear_names: [String; 3],
    /// Decimals of the linear words.
    pub linear_decimals: [usize; 3],
    /// Names of the rotary words, outer first.
    pub rotary_names: Vec<RotaryName>,
}

/// Why a dialect cannot say a program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// A feed word that the control does not have.
    #[error("{dialect} has no {what}: choose another feed mode")]
    Feed {
        /// The dialect.
        dialect: &'static str,
        /// What it lacks.
        what: &'static str,
    },
    /// An axis name that the control does not take.
    #[error("{dialect} takes no axis called {letter}: use one letter in the machine file")]
    Axis {
        /// The dialect.
        dialect: &'static str,
        /// The name.
        letter: String,
    },
    /// No words for directions or planes.
    #[error("{dialect} has no words for the tool's orientation as {what}: choose joints")]
    Orientation {
        /// The dialect.
        dialect: &'static str,
        /// What it lacks.
        what: &'static str,
    },
    /// A work offset that the control does not have.
    #[error("{dialect} has no work offset {offset}")]
    WorkOffset {
        /// The dialect.
        dialect: &'static str,
        /// The offset.
        offset: WorkOffset,
    },
    /// A program number that the control does not take.
    #[error("{dialect} takes no program number {number}: from 1 to 9999")]
    Number {
        /// The dialect.
        dialect: &'static str,
        /// The number.
        number: u32,
    },
    /// No subprograms.
    #[error("{dialect} programs are written as one: subprograms are for sinumerik")]
    Subprogram {
        /// The dialect.
        dialect: &'static str,
    },
    /// Several tools and a subprogram.
    #[error("{dialect} programs of several tools are written as one: leave the subprogram out")]
    Sections {
        /// The dialect.
        dialect: &'static str,
    },
    /// No switch for tool-centre-point control.
    #[error(
        "the machine file has no control.linuxcnc_tcp (the words that switch its kinematics): add it or choose a feed \
         mode without tool-centre-point control"
    )]
    NoTcpSwitch,
}

impl Program {
    /// The name with only letters, digits and underscores, never empty.
    #[must_use]
    pub fn safe_name(&self) -> String {
        let name: String = self
            .name
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' })
            .collect();
        if name.is_empty() { "PROGRAM".into() } else { name }
    }

    /// The words of its work offset; none where the dialect's usual one needs none.
    pub(crate) fn work_offset_words(&self, dialect: Dialect) -> Result<Option<String>, WriteError> {
        match self.work_offset.or(WorkOffset::usual(dialect)) {
            None => Ok(None),
            Some(offset) => match offset.words(dialect) {
                Some(words) => Ok(Some(words)),
                None => Err(WriteError::WorkOffset { dialect: dialect.name(), offset }),
            },
        }
    }

    /// The word that starts its spindle.
    pub(crate) const fn spindle_word(&self) -> &'static str {
        if self.counter_clockwise { "M4" } else { "M3" }
    }

    /// It works in tilted planes.
    pub(crate) fn in_planes(&self) -> bool {
        self.orientation == Orientation::Planes
    }

    /// It says directions.
    pub(crate) fn in_vectors(&self) -> bool {
        self.orientation == Orientation::Vectors
    }

    /// Refuses axis names of more than one letter.
    pub(crate) fn single_letters(&self, dialect: &'static str) -> Result<(), WriteError> {
        let names = self.linear_names.iter().chain(self.rotary_names.iter().map(|r| &r.letter));
        match names.clone().find(|n| n.len() != 1) {
            Some(letter) => Err(WriteError::Axis { dialect, letter: letter.clone() }),
            None => Ok(()),
        }
    }

    /// Comment lines without what would end a comment or a line.
    pub(crate) fn safe_comments(&self) -> Vec<String> {
        let clean =
            |c: char| if c.is_ascii() && !c.is_ascii_control() && !"();%\"".contains(c) { c } else { ' ' };
        self.comments.iter().map(|line| line.chars().map(clean).collect()).collect()
    }
}
