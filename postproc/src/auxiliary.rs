//! What a program does between two moves: speed of the spindle, coolant, dwells and stops.

use crate::nc::Coolant;

/// The spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spindle {
    /// M5.
    Off,
    /// M3, at this speed.
    Clockwise {
        /// Its speed.
        rpm: f64,
    },
    /// M4, at this speed.
    Counter {
        /// Its speed.
        rpm: f64,
    },
}

impl Spindle {
    /// Its speed, where it turns.
    #[must_use]
    pub const fn rpm(self) -> Option<f64> {
        match self {
            Self::Off => None,
            Self::Clockwise { rpm } | Self::Counter { rpm } => Some(rpm),
        }
    }

    /// The other way round, at the same speed.
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Off => Self::Off,
            Self::Clockwise { rpm } => Self::Counter { rpm },
            Self::Counter { rpm } => Self::Clockwise { rpm },
        }
    }
}

/// What is done between two moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AuxiliaryWord {
    /// The spindle turns so from here on.
    Spindle(Spindle),
    /// Coolant; absent: off.
    Coolant(Option<Coolant>),
    /// All axes wait.
    Dwell {
        /// How long, s.
        seconds: f64,
    },
    /// M0.
    Stop,
    /// M1: the program stops where the operator has asked for it.
    OptionalStop,
}

/// What is done before a move of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Auxiliary {
    /// The CL move before which it is done, from 0; beyond the last one: at the end.
    pub before: usize,
    /// What.
    pub word: AuxiliaryWord,
}
