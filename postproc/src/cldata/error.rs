//! Why a text is no cutter location data: line, value, what would do.

/// Why a text is no cutter location data. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClReadError {
    /// A field that should be a number.
    #[error("line {line}: '{field}' in {word}/ is not a finite number")]
    Number {
        /// Line.
        line: usize,
        /// Statement.
        word: String,
        /// The field as it stands there.
        field: String,
    },
    /// Too few or too many numbers.
    #[error("line {line}: {word}/ has {got} numbers, it needs {need}")]
    Count {
        /// Line.
        line: usize,
        /// Statement.
        word: String,
        /// Numbers found.
        got: usize,
        /// Numbers that would do.
        need: &'static str,
    },
    /// A tool axis of length zero.
    #[error("line {line}: the tool axis has length {length:.3e}: give a direction")]
    ZeroAxis {
        /// Line.
        line: usize,
        /// Its length.
        length: f64,
    },
    /// A feed per revolution without a speed.
    #[error(
        "line {line}: a feed or dwell per revolution or a tap before any SPINDL/ in rpm: put SPINDL/ first, or use MMPM and seconds"
    )]
    NoSpindle {
        /// Line.
        line: usize,
    },
    /// A feed that no control takes.
    #[error("line {line}: a feed of {feed_mm_min:?} mm/min: it must be above zero, from 1e-6 to 1e9")]
    Feed {
        /// Line.
        line: usize,
        /// What was read.
        feed_mm_min: f64,
    },
    /// A move at feed before any feed.
    #[error("line {line}: a move that is not RAPID before any FEDRAT/: the feed is unknown")]
    NoFeed {
        /// Line.
        line: usize,
    },
    /// A speed below zero.
    #[error(
        "line {line}: a spindle speed of {rpm} rpm: it must not be below zero; the direction is CLW or CCLW"
    )]
    Speed {
        /// Line.
        line: usize,
        /// What was read.
        rpm: f64,
    },
    /// A dwell that no control takes.
    #[error("line {line}: a dwell of {seconds} s: from 0 to 36000 s")]
    Dwell {
        /// Line.
        line: usize,
        /// What was read.
        seconds: f64,
    },
    /// More moves than a statement may ask for.
    #[error(
        "line {line}: {what} asks for {count:.0} moves, at most {most}: is a length in another unit, or a count wrong?"
    )]
    Bound {
        /// Line.
        line: usize,
        /// The arc, or the cycle.
        what: &'static str,
        /// What it asks for.
        count: f64,
        /// What is taken.
        most: f64,
    },
    /// A line without end.
    #[error("line {line}: longer than {most} bytes: this is no cutter location data, or in binary form")]
    Long {
        /// Line.
        line: usize,
        /// What is taken.
        most: usize,
    },
    /// Not one point.
    #[error("no GOTO/ or FROM/ in {lines} lines: this is no cutter location data, or in binary form")]
    NoPoints {
        /// Lines read.
        lines: usize,
    },
}
