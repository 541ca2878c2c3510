//! Why there is no second opinion: it never guesses.

/// What stands in the way of a second opinion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoOpinion {
    /// A dialect of another control.
    #[error("there is no second opinion on programs in the dialect '{name}'")]
    Dialect {
        /// Its name.
        name: String,
    },
    /// A word of the program.
    #[error("there is no second opinion: line {line}: {why}: {word}")]
    Word {
        /// From 1.
        line: usize,
        /// As it stands there.
        word: String,
        /// What is the matter with it.
        why: Unread,
    },
    /// The program's end is missing, or it moves nothing.
    #[error("there is no second opinion: the program {what}")]
    Program {
        /// What it does.
        what: &'static str,
    },
    /// The machine's description.
    #[error("there is no second opinion: machine: {what}")]
    Machine {
        /// What is wrong with it.
        what: String,
    },
    /// Where the part stands is not known.
    #[error("there is no second opinion: setup: {what}")]
    Setup {
        /// What is wrong with it.
        what: String,
    },
    /// The tool's sizes make no tool.
    #[error("there is no second opinion: tool: {what} = {got} does not go with the rest of it")]
    Tool {
        /// The size.
        what: &'static str,
        /// Its value.
        got: f64,
    },
    /// Points or tolerances that are none.
    #[error("there is no second opinion: {what}")]
    Points {
        /// What is wrong.
        what: &'static str,
    },
}

/// What is the matter with a word of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unread {
    /// Not one that the reader knows.
    #[error("not known")]
    Unknown,
    /// No number where one belongs, or a bracket without its other.
    #[error("not understood")]
    Syntax,
    /// Known, but not there or not so.
    #[error("not known in this place")]
    Misplaced,
    /// A move before G0 or G1.
    #[error("a move before any word for rapid or feed")]
    Motion,
    /// A feed move of which an end is not known, as an axis has not been named.
    #[error("a feed move from or to a place of which not every axis is known")]
    Unplaced,
    /// A linear position while the tool's length is not applied.
    #[error("a position without the tool's length")]
    Length,
    /// A turn of an endless axis that could go either way.
    #[error("a turn that could go either way")]
    EitherWay,
    /// A direction that the rotary axes do not reach.
    #[error("a direction that the machine does not reach")]
    Unreached,
    /// The tool does not stand across the tilted plane.
    #[error("a tilted plane across which the tool does not stand")]
    Plane,
    /// What goes evenly between two directions has not been said.
    #[error("a turn of the tool of which the program does not say how it goes")]
    Turning,
    /// Another tool than the one that is looked at.
    #[error("another tool")]
    Tool,
    /// A second work offset.
    #[error("another work offset")]
    Offset,
    /// A subprogram that is not in the text, or calls itself.
    #[error("a call of what is not in the text")]
    Call,
}
