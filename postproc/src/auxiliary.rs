//! What a program does between two moves: speed of the spindle, coolant, dwells and stops.

use crate::nc::Coolant;

/// The spindle.
///
/// ```
/// use osculate_postproc::Spindle;
///
/// // A tap turns back at the bottom of its hole.
/// let tap = Spindle::Clockwise { rpm: 500.0 };
/// assert_eq!(tap.reversed(), Spindle::Counter { rpm: 500.0 });
/// assert_eq!(tap.reversed().reversed(), tap);
/// assert_eq!((tap.rpm(), Spindle::Off.rpm()), (Some(500.0), None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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
#[non_exhaustive]
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
///
/// ```
/// use osculate_postproc::{Auxiliary, AuxiliaryWord, Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post};
///
/// let path = cldata::read("RAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/8,0,5\nFINI\n")?.path;
/// let mut options = PostOptions::new(Dialect::LinuxCnc, FeedMode::InverseTime);
/// // Wait for half a second before the second move.
/// options.auxiliary = vec![Auxiliary { before: 1, word: AuxiliaryWord::Dwell { seconds: 0.5 } }];
/// let text = post(&path, &Machine::built_in("3-axis")?, &Setup::default(), &options)?.text;
/// let (dwell, cut) = (text.find("G4 P0.5"), text.find("X8"));
/// assert!(dwell.is_some() && dwell < cut);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Auxiliary {
    /// The CL move before which it is done, from 0; beyond the last one: at the end.
    pub before: usize,
    /// What.
    pub word: AuxiliaryWord,
}
