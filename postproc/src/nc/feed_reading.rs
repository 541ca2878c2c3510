//! Over what a control reads F in G94 where a program does not say it: dialect and machine together.
//!
//! ```text
//! LinuxCNC    X Y Z where any of them moves, else the rotary axes in degrees; a machine file cannot change that
//! Fanuc       all axes, a degree counting as 1 mm, or as the machine's parameters have it
//! Heidenhain  as Fanuc; with M116 or TCPM otherwise
//! Sinumerik   the axes of FGROUP, a rotary one as an arc of the radius FGREF; both from the machine's data where a program is silent
//! ```
//!
//! With tool-centre-point control F is the tip's in all of them. The machine file's `feed_reading` is what the last three rows leave open.
//!
//! Sources: LinuxCNC, G-code reference, "Feed Rate" of mixed linear and rotary motion; Fanuc, Series 30i operator's manual, "Feed functions";
//! Heidenhain, TNC 640 user's manual, "Feed rate in mm/min on rotary axes: M116"; Siemens, Sinumerik 840D sl programming manual
//! fundamentals, "Feedrate (G93, G94, G95, F, FGROUP, FGREF)".

use super::Dialect;
use crate::feed::PathMetric;
use crate::machine::Machine;

impl Dialect {
    /// Over what F is read without tool-centre-point control, where the program does not say it.
    ///
    /// ```
    /// use osculate_postproc::{Dialect, Machine, PathMetric};
    ///
    /// // This machine's control counts a degree as 1 mm, unless it is LinuxCNC, which feeds along X Y Z.
    /// let machine = Machine::built_in("trunnion-ac")?;
    /// assert!((Dialect::Fanuc.feed_metric(&machine).radius_mm() - 1f64.to_degrees()).abs() < 1e-12);
    /// assert_eq!(Dialect::LinuxCnc.feed_metric(&machine), PathMetric::Linear);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn feed_metric(self, machine: &Machine) -> PathMetric {
        match self {
            Self::LinuxCnc => PathMetric::Linear,
            Self::Sinumerik | Self::Heidenhain | Self::Fanuc => machine.control().feed_reading.into(),
        }
    }
}
