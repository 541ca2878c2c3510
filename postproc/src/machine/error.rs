//! What is wrong with a machine file.

use super::two_axis::TwoAxisError;

/// The format number that this version reads.
pub(super) const FORMAT: u32 = 1;

/// Why a machine file is no machine.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MachineError {
    /// Not TOML, an unknown key or a missing one.
    #[error("the machine file cannot be read: {0}")]
    Toml(#[from] toml::de::Error),
    /// Another version of the format.
    #[error("the machine file has format = {got}, this version reads format = {FORMAT}")]
    Format {
        /// What stands there.
        got: u32,
    },
    /// No built-in machine of this name.
    #[error("no built-in machine is called '{name}'; there are {known}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// Wrong number of joints.
    #[error("{linear} linear and {rotary} rotary joints: a machine needs 3 linear and 0 to 2 rotary ones")]
    JointCount {
        /// Linear joints.
        linear: usize,
        /// Rotary joints.
        rotary: usize,
    },
    /// The joints are not in the order part to tool.
    #[error(
        "joint {letter} carries the part but stands after one that carries the tool: order them from part to tool"
    )]
    Order {
        /// The joint.
        letter: String,
    },
    /// A letter is missing, malformed or used twice.
    #[error(
        "joint letter '{letter}' must be one capital letter with optional digits (CA1), once per machine"
    )]
    Letter {
        /// What stands there.
        letter: String,
    },
    /// A number that makes no sense.
    #[error("{}{what} of {whose} is {value:?}: {wanted}", at(*line))]
    Value {
        /// The line of the file that says it, where there is one.
        line: Option<usize>,
        /// The joint, "the machine" or "the control".
        whose: String,
        /// The key.
        what: &'static str,
        /// What stands there.
        value: f64,
        /// What would do.
        wanted: String,
    },
    /// A body without a name of its own.
    #[error("the machine has a body called '{name}': every [[body]] needs a name, and no two the same")]
    BodyName {
        /// What stands there.
        name: String,
    },
    /// A body that moves with nothing there is.
    #[error("body {body} is carried_by = \"{got}\": give the letter of a joint ({known}), or \"bed\"")]
    Carrier {
        /// The body.
        body: String,
        /// What stands there.
        got: String,
        /// The joints there are.
        known: String,
    },
    /// A body that is none.
    #[error("body {name}: {why}")]
    Body {
        /// Its name.
        name: String,
        /// Why not.
        why: String,
    },
    /// The linear joints do not span space.
    #[error("the three linear directions span a volume of only {volume:.2e}: they must be independent")]
    LinearDependent {
        /// Volume of the box of unit directions.
        volume: f64,
    },
    /// The rotary joints cannot orient a tool.
    #[error(transparent)]
    Orientation(#[from] TwoAxisError),
}

/// A line in front of what is said of it.
fn at(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}
