//! Why sections of points are no part.

use crate::fit::FitError;
use crate::trimmed::TrimError;

/// Why a text gives no surface through sections.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SectionsError {
    /// No line of numbers.
    #[error("no line of two or more numbers: rows of points are due, x y z in each")]
    NoRows,
    /// A row of another width.
    #[error("line {line}: {got} numbers where the rows before have {want}")]
    Columns {
        /// Line from one.
        line: usize,
        /// How many it has.
        got: usize,
        /// How many are due.
        want: usize,
    },
    /// Two columns that no names explain.
    #[error(
        "line {line}: two numbers a row; name them x,r in a line above to turn the contour about its axis, or give x, y and z"
    )]
    TwoColumns {
        /// Line from one.
        line: usize,
    },
    /// Columns that no names explain.
    #[error(
        "line {line}: {columns} numbers a row; name the columns in a line above, as index,x,y,z or ss_x,ss_y,ss_z,ps_x,ps_y,ps_z"
    )]
    Unnamed {
        /// Line from one.
        line: usize,
        /// How many there are.
        columns: usize,
    },
    /// A number that is not finite.
    #[error("line {line}: {got} is no finite coordinate")]
    NotFinite {
        /// Line from one.
        line: usize,
        /// What stands there.
        got: f64,
    },
    /// Numbered points without sections.
    #[error(
        "{points} numbered points in no sections: order them along sections, each with an index of its own or behind a blank line"
    )]
    Cloud {
        /// How many.
        points: usize,
    },
    /// A single section.
    #[error(
        "one section of {points} points: two are needed to span a surface; separate sections by a blank line or an index"
    )]
    OneSection {
        /// Its points.
        points: usize,
    },
    /// A section of too few points.
    #[error("the section at line {line} has {got} different points, {need} are needed")]
    FewPoints {
        /// Where it begins.
        line: usize,
        /// How many it has.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// The fit.
    #[error("no surface through the sections: {0}")]
    Fit(#[from] FitError),
    /// The revolution.
    #[error("no surface of revolution from the contour: {0}")]
    Contour(String),
    /// The face.
    #[error(transparent)]
    Trim(#[from] TrimError),
}
