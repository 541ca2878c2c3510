//! Why a path cannot be posted.

use std::io;

use crate::cldata::ClStreamError;
use crate::motion::TooLong;
use crate::nc::WriteError;
use crate::solve_error::SolveError;

/// Why a path cannot be posted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PostError {
    /// The machine cannot run the path.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The dialect cannot say the program.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The moves cannot be had.
    #[error(transparent)]
    Source(#[from] ClStreamError),
    /// It runs longer than anybody waits.
    #[error(transparent)]
    TooLong(#[from] TooLong),
    /// The sink takes no more.
    #[error("the program cannot be written: {kind}")]
    Sink {
        /// What the sink says.
        kind: io::ErrorKind,
    },
    /// Nothing to post.
    #[error("there is no path to post")]
    NoSection,
    /// A section with what a program has once.
    #[error(
        "section {section}, {name}: dialect, feed mode, orientation and subprogram are the same in all of a program"
    )]
    Sections {
        /// Which, from 1.
        section: usize,
        /// Its name.
        name: String,
    },
    /// An orientation that the feed mode does not allow.
    #[error("the tool's orientation as vectors or planes needs feed mode tcp: there X Y Z are the tip")]
    Orientation,
    /// A rewind, which directions cannot say.
    #[error(
        "CL move {index}: the rotary joints must be rewound here, and directions of the tool do not say to which turn: \
         write joints instead of vectors"
    )]
    Rewind {
        /// The CL move.
        index: usize,
    },
    /// The tool turns at feed.
    #[error(
        "CL move {index}: the tool axis turns at feed, which tilted planes cannot say: write joints or vectors"
    )]
    Turns {
        /// The CL move.
        index: usize,
    },
    /// A position beyond what an axis word holds.
    #[error("CL move {index}: a position of {value} does not fit an axis word")]
    Position {
        /// The CL move.
        index: usize,
        /// The position, mm or deg.
        value: f64,
    },
    /// A feed option that makes no sense.
    #[error("feed option {what} is {value}: it must be finite and above zero")]
    Feed {
        /// The option.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A spindle speed that makes no sense.
    #[error("a spindle speed of {rpm:e} rpm: it must be above zero and at most 999999")]
    Spindle {
        /// What was given.
        rpm: f64,
    },
}

impl From<std::convert::Infallible> for PostError {
    fn from(never: std::convert::Infallible) -> Self {
        match never {}
    }
}

impl PostError {
    /// The CL move that it speaks of, from 0.
    #[must_use]
    pub const fn index(&self) -> Option<usize> {
        match self {
            Self::Solve(e) => e.index(),
            Self::Position { index, .. } | Self::Rewind { index } | Self::Turns { index } => Some(*index),
            _ => None,
        }
    }
}
