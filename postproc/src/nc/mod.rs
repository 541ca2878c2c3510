//! NC programs: dialect-free moves, their wording in each dialect, and the way back.

mod archive;
mod asked;
mod auxiliary;
pub mod block;
mod codes;
mod conditions;
pub mod conduct;
mod control;
pub mod dialect_file;
mod event;
mod fanuc;
mod feed_reading;
mod flow;
mod frames;
mod heidenhain;
mod interpret;
mod lines;
mod linuxcnc;
mod machine_frame;
pub mod meetings;
mod modal;
mod names;
pub mod number;
pub mod orientation;
mod read_error;
pub mod readback;
pub mod reading;
mod sections;
mod sinumerik;
mod state;
pub mod timing;
mod token;
mod way;
mod work_offset;
pub(crate) mod writer;

use std::fmt;
use std::str::FromStr;

pub use block::{Coolant, FeedWord, NcMove, Program, WriteError};
pub use control::Record;
pub use orientation::Orientation;
pub use work_offset::{UnknownWorkOffset, WorkOffset};

/// The language of a control.
///
/// ```
/// use osculate_postproc::Dialect;
///
/// for dialect in Dialect::ALL {
///     assert_eq!(dialect.name().parse(), Ok(dialect));
/// }
/// assert_eq!(Dialect::Heidenhain.extension(), "h");
/// let unknown = "klartext".parse::<Dialect>().expect_err("it is called otherwise");
/// assert!(unknown.to_string().contains("heidenhain"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// Siemens Sinumerik 840D.
    Sinumerik,
    /// Heidenhain Klartext (TNC 640 and its like).
    Heidenhain,
    /// Fanuc 30i and its like.
    Fanuc,
    /// LinuxCNC 2.9.
    LinuxCnc,
}

/// No dialect of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no dialect is called '{name}'; there are sinumerik, heidenhain, fanuc, linuxcnc")]
#[non_exhaustive]
pub struct UnknownDialect {
    /// The name asked for.
    pub name: String,
}

impl Dialect {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Sinumerik, Self::Heidenhain, Self::Fanuc, Self::LinuxCnc];

    /// The name in job files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sinumerik => "sinumerik",
            Self::Heidenhain => "heidenhain",
            Self::Fanuc => "fanuc",
            Self::LinuxCnc => "linuxcnc",
        }
    }

    /// How its programs turn an axis without end, and what of the control's data they rely on.
    pub(crate) const fn turning(self) -> &'static str {
        match self {
            Self::Sinumerik => "a modulo axis, DC goes the shortest way",
            Self::Heidenhain => "M126 goes the shortest way",
            Self::Fanuc => "a rollover axis, parameters 1006 and 1008, that goes the shortest way",
            Self::LinuxCnc => {
                "it counts on through whole turns, its limits must hold them, no WRAPPED_ROTARY"
            }
        }
    }

    /// The usual extension of a program file.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Sinumerik => "mpf",
            Self::Heidenhain => "h",
            Self::Fanuc => "nc",
            Self::LinuxCnc => "ngc",
        }
    }
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Dialect {
    type Err = UnknownDialect;

    fn from_str(name: &str) -> Result<Self, UnknownDialect> {
        Self::ALL.into_iter().find(|d| d.name() == name).ok_or_else(|| UnknownDialect { name: name.into() })
    }
}
