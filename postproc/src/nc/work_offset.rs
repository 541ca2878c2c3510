//! Work offsets: where a control has its program zero, by the name that its programs give it.
//!
//! `G54` to `G59` with Fanuc and LinuxCNC (`G54` to `G57` with Sinumerik, whose `G58` and `G59` shift instead),
//! `G59.1` to `G59.3` with LinuxCNC, `G54.1 P1` on with Fanuc, `G505` to `G599` with Sinumerik, where `G500` is none, and
//! a line of the preset table with Heidenhain.

use std::fmt;
use std::str::FromStr;

use super::Dialect;

/// A work offset.
///
/// ```
/// use osculate_postproc::{Dialect, WorkOffset};
///
/// let offset: WorkOffset = "G54.1 P12".parse()?;
/// assert_eq!(offset, WorkOffset::Extended(12));
/// // Only Fanuc has it.
/// assert_eq!(offset.words(Dialect::Fanuc).as_deref(), Some("G54.1 P12"));
/// assert_eq!(offset.words(Dialect::LinuxCnc), None);
/// assert_eq!(WorkOffset::usual(Dialect::LinuxCnc), Some(WorkOffset::Standard(54)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum WorkOffset {
    /// `G54` to `G59`, by the number behind the G.
    Standard(u32),
    /// `G59.1` to `G59.3`, by the number behind the point.
    Further(u32),
    /// `G54.1 P1` and on.
    Extended(u32),
    /// `G505` to `G599`, by the number behind the G.
    Settable(u32),
    /// `G500`: none.
    Off,
    /// A line of the preset table.
    Preset(u32),
}

/// No work offset is called so.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no work offset is called '{name}'; there are G54 to G59, G59.1 to G59.3, G54.1 P1 and on, G505 to G599, G500 and \
     'preset 1' and on"
)]
#[non_exhaustive]
pub struct UnknownWorkOffset {
    /// The name asked for.
    pub name: String,
}

impl WorkOffset {
    /// What a program works in where nobody says otherwise; with Heidenhain the preset that is active.
    #[must_use]
    pub const fn usual(dialect: Dialect) -> Option<Self> {
        match dialect {
            Dialect::Heidenhain => None,
            Dialect::Sinumerik | Dialect::Fanuc | Dialect::LinuxCnc => Some(Self::Standard(54)),
        }
    }

    /// The words that switch to it, where the dialect has some.
    #[must_use]
    pub fn words(self, dialect: Dialect) -> Option<String> {
        let has = match self {
            Self::Standard(n) => match dialect {
                Dialect::Heidenhain => false,
                Dialect::Sinumerik => (54..=57).contains(&n),
                Dialect::Fanuc | Dialect::LinuxCnc => (54..=59).contains(&n),
            },
            Self::Further(n) => dialect == Dialect::LinuxCnc && (1..=3).contains(&n),
            Self::Extended(n) => dialect == Dialect::Fanuc && (1..=300).contains(&n),
            Self::Settable(n) => dialect == Dialect::Sinumerik && (505..=599).contains(&n),
            Self::Off => dialect == Dialect::Sinumerik,
            Self::Preset(_) => dialect == Dialect::Heidenhain,
        };
        has.then(|| match self {
            Self::Preset(n) => format!("CYCL DEF 247 PRESETTING Q339={n:+}"),
            other => other.to_string(),
        })
    }
}

impl fmt::Display for WorkOffset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard(n) | Self::Settable(n) => write!(f, "G{n}"),
            Self::Further(n) => write!(f, "G59.{n}"),
            Self::Extended(n) => write!(f, "G54.1 P{n}"),
            Self::Off => f.write_str("G500"),
            Self::Preset(n) => write!(f, "preset {n}"),
        }
    }
}

impl FromStr for WorkOffset {
    type Err = UnknownWorkOffset;

    fn from_str(name: &str) -> Result<Self, UnknownWorkOffset> {
        let plain: String = name.to_ascii_uppercase().split_whitespace().collect();
        let number = |head: &str| plain.strip_prefix(head)?.parse::<u32>().ok();
        let found = number("G54.1P").filter(|n| *n > 0).map(Self::Extended);
        let found = found.or_else(|| number("G59.").filter(|n| (1..=3).contains(n)).map(Self::Further));
        let found = found.or_else(|| number("PRESET").map(Self::Preset));
        let found = found.or_else(|| match number("G")? {
            n @ 54..=59 => Some(Self::Standard(n)),
            500 => Some(Self::Off),
            n @ 505..=599 => Some(Self::Settable(n)),
            _ => None,
        });
        found.ok_or_else(|| UnknownWorkOffset { name: name.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for name in ["G54", "G59", "G59.2", "G54.1 P12", "G505", "G500", "preset 3"] {
            assert_eq!(name.parse::<WorkOffset>().map(|w| w.to_string()), Ok(name.to_string()));
        }
        assert_eq!("g54.1p12".parse(), Ok(WorkOffset::Extended(12)));
        for name in ["G53", "G60", "G54.1", "G54.1 P0", "G59.4", "G600", "preset", ""] {
            assert!(name.parse::<WorkOffset>().is_err(), "{name}");
        }
    }

    #[test]
    fn each_dialect_says_its_own() {
        let says = |w: WorkOffset| Dialect::ALL.map(|d| w.words(d).is_some());
        // Sinumerik, Heidenhain, Fanuc, LinuxCNC.
        assert_eq!(says(WorkOffset::Standard(55)), [true, false, true, true]);
        assert_eq!(says(WorkOffset::Standard(59)), [false, false, true, true]);
        assert_eq!(says(WorkOffset::Extended(1)), [false, false, true, false]);
        assert_eq!(says(WorkOffset::Settable(505)), [true, false, false, false]);
        assert_eq!(
            WorkOffset::Preset(3).words(Dialect::Heidenhain).as_deref(),
            Some("CYCL DEF 247 PRESETTING Q339=+3")
        );
    }
}
