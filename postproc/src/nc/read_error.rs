//! Why an NC text cannot be read.

use crate::motion::TooLong;
use crate::setup::SetupError;

/// Why a text cannot be read. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Text that is no word of the dialect.
    #[error("line {line}: '{text}' is no word that can be read")]
    Syntax {
        /// Line.
        line: usize,
        /// Where it stops making sense.
        text: String,
    },
    /// A word that may change the tool's way and is not understood.
    #[error(
        "line {line}: {word} is not interpreted and may change the tool's way; read without `strict` to leave it out"
    )]
    Word {
        /// Line.
        line: usize,
        /// The word.
        word: String,
    },
    /// A feed move without F.
    #[error("line {line}: a feed move without {what}")]
    NoFeed {
        /// Line.
        line: usize,
        /// What is missing.
        what: &'static str,
    },
    /// An arc whose ends lie on no common circle.
    #[error("line {line}: the ends of the arc miss one circle about its centre by {off_mm:.4} mm")]
    Arc {
        /// Line.
        line: usize,
        /// Difference of the radii, mm.
        off_mm: f64,
    },
    /// An incremental position from an unknown place.
    #[error("line {line}: {axis} moves by an increment, but where it stands is not known")]
    Increment {
        /// Line.
        line: usize,
        /// The axis.
        axis: String,
    },
    /// A way that is too long for what it curves by.
    #[error(
        "line {line}: the block's way has more than {most} straight pieces: is a number in another unit?"
    )]
    Bound {
        /// Line.
        line: usize,
        /// Pieces of a block at most.
        most: usize,
    },
    /// More than a text may ask for by calls and repeats.
    #[error("line {line}: more than {most} {what}: is a count wrong?")]
    Repeats {
        /// Line of the call or repeat.
        line: usize,
        /// What there is too much of.
        what: &'static str,
        /// What is taken.
        most: usize,
    },
    /// A subprogram that runs on behind its last line.
    #[error("line {line}: the subprogram that is called here has no end (LBL 0, M99, endsub)")]
    NoReturn {
        /// Line of the call.
        line: usize,
    },
    /// The linear joints cannot hold the tip.
    #[error("line {line}: the machine's linear joints lie in one plane here")]
    Flat {
        /// Line.
        line: usize,
    },
    /// The setup is none.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// It runs longer than anybody waits.
    #[error(transparent)]
    TooLong(#[from] TooLong),
    /// A tolerance that is none.
    #[error("read option {what} is {value}: it must be finite and above zero")]
    Tolerance {
        /// The option.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// Nothing moves.
    #[error(
        "no complete position in {lines} lines: does the text name all axes of {machine}, and is the dialect right?"
    )]
    NoMoves {
        /// Lines read.
        lines: usize,
        /// The machine.
        machine: String,
    },
}
