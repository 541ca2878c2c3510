//! How each control reads F, in which words, and where that is written.
//!
//! What differs from machine to machine (whether a turning table counts in G94, and at which radius) is data of the
//! machine file ([`crate::machine::spec::FeedReading`]); here stands what the dialects fix.

use super::Dialect;

/// One reading of F.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct FeedRow {
    /// The words with which F is read so.
    pub words: &'static str,
    /// What F is then.
    pub meaning: &'static str,
    /// Where that is written.
    pub source: &'static str,
}

const fn row(words: &'static str, meaning: &'static str, source: &'static str) -> FeedRow {
    FeedRow { words, meaning, source }
}

const SIEMENS: &str =
    "Siemens, SINUMERIK 840D sl, Programming Manual Fundamentals: Feedrate (G93, G94, G95, F, FGROUP, FGREF)";
const SIEMENS_ORI: &str =
    "Siemens, SINUMERIK 840D sl, Programming Manual Job Planning: Transformations (TRAORI)";
const TNC: &str = "HEIDENHAIN, TNC 640 user's manual: Miscellaneous functions for rotary axes (M116, M128)";
const TNC_TCPM: &str = "HEIDENHAIN, TNC 640 user's manual: FUNCTION TCPM";
const FANUC: &str = "FANUC, Series 30i operator's manual (B-63944EN, B-64484EN): Feed functions";
const FANUC_TCP: &str = "FANUC, Series 30i operator's manual: Tool center point control (G43.4, G43.5)";
const LINUXCNC: &str = "LinuxCNC 2.9 user manual: Machining center overview, Feed rate; G93, G94, G95 mode";

const SINUMERIK_ROWS: &[FeedRow] = &[
    row(
        "G94 with FGROUP(...) FGREF[...]",
        "mm/min over the axes of FGROUP, a rotary one as an arc of radius FGREF (57.296 mm: a degree is a mm)",
        SIEMENS,
    ),
    row("G94, rotary axes alone, not in FGROUP", "deg/min", SIEMENS),
    row("G94 with TRAORI", "mm/min of the tip relative to the part", SIEMENS_ORI),
    row("G93", "1/min, in every block; a switch of G93, G94, G95 deletes F", SIEMENS),
];
const HEIDENHAIN_ROWS: &[FeedRow] = &[
    row(
        "F, linear and rotary axes, no TCPM",
        "over all axes, a degree as a mm (M116: rotary tables in mm/min)",
        TNC,
    ),
    row("F, rotary axes alone", "deg/min", TNC),
    row("FUNCTION TCPM F TCP, M128", "mm/min of the tip relative to the part", TNC_TCPM),
];
const FANUC_ROWS: &[FeedRow] = &[
    row("G94, linear and rotary axes", "over all axes, a degree as a mm", FANUC),
    row("G94, rotary axes alone", "deg/min", FANUC),
    row("G43.4, G43.5", "mm/min of the tip relative to the part", FANUC_TCP),
    row("G93", "1/min, in every block", FANUC),
];
const LINUXCNC_ROWS: &[FeedRow] = &[
    row("G94, any of X Y Z moves", "mm/min over X Y Z; rotary axes take the same time", LINUXCNC),
    row("G94, rotary axes alone", "deg/min", LINUXCNC),
    row("kinematics switched to the tip (M428)", "mm/min over X Y Z, which are the tip's", LINUXCNC),
    row("G93", "1/min, in every block", LINUXCNC),
];

impl Dialect {
    /// How the control reads F.
    #[must_use]
    pub const fn feed_rows(self) -> &'static [FeedRow] {
        match self {
            Self::Sinumerik => SINUMERIK_ROWS,
            Self::Heidenhain => HEIDENHAIN_ROWS,
            Self::Fanuc => FANUC_ROWS,
            Self::LinuxCnc => LINUXCNC_ROWS,
        }
    }
}
