//! How closely joints have to follow a path.

use crate::solve_error::SolveError;
use std::f64::consts::FRAC_PI_2;

/// How a path is to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveOptions {
    /// The control keeps the tip on its line (tool-centre-point control).
    pub tcp: bool,
    /// How far the tip may leave the CL line in feed moves, mm.
    pub tip_tol_mm: f64,
    /// The angle between the tool's axis and the normal wherever the tool touches the part, at most, rad. What the tip strays
    /// counts by its share towards the part; straight across the axis up to four times `tip_tol_mm` pass where that
    /// share is small. A right angle, the usual value, says that the tool may touch anywhere.
    pub touch_rad: f64,
    /// How far the axis may leave the CL's in feed moves, rad.
    pub axis_tol_rad: f64,
    /// How far tip and axis may leave the CL's in feed moves on which the tool is off everything ([`ClMove::aloft`]), where that is more, mm and rad.
    ///
    /// [`ClMove::aloft`]: osculate_tools::cl::ClMove::aloft
    pub aloft_tol: (f64, f64),
    /// How far the tip may leave its line in rapid moves, mm.
    pub rapid_tol_mm: f64,
    /// Within this angle of a pole the outer rotary joint is held and the axis errs by at most this, rad.
    pub singular_cone_rad: f64,
    /// Blocks go on over CL points between which the axis turns, for as long as they stay within the tolerances of the tip and the axis: as
    /// few blocks as these need. What of a path's shape its own chords leave out comes on top.
    pub join: bool,
    /// How far the tool leaves the part along its axis for a rewind, mm.
    pub rewind_retract_mm: f64,
}

impl Default for SolveOptions {
    /// No tool-centre-point control; 2 um and 0.02 deg, held within 0.005 deg of a pole; rapids within 0.1 mm;
    /// every CL point ends a block; rewinds 50 mm away from the part.
    fn default() -> Self {
        Self {
            tcp: false,
            tip_tol_mm: 0.002,
            touch_rad: FRAC_PI_2,
            axis_tol_rad: 0.02f64.to_radians(),
            aloft_tol: (0.0, 0.0),
            rapid_tol_mm: 0.1,
            join: false,
            singular_cone_rad: 0.005f64.to_radians(),
            rewind_retract_mm: 50.0,
        }
    }
}

/// # Errors
/// Where a tolerance is none.
pub(crate) fn check_options(o: &SolveOptions) -> Result<(), SolveError> {
    let above =
        [("tip_tol_mm", o.tip_tol_mm), ("axis_tol_rad", o.axis_tol_rad), ("rapid_tol_mm", o.rapid_tol_mm)];
    for (what, value) in above {
        if !(value.is_finite() && value > 0.0) {
            return Err(SolveError::Option { what, value, wanted: "above zero" });
        }
    }
    if !(o.rewind_retract_mm.is_finite() && o.rewind_retract_mm >= 0.0) {
        let (what, value) = ("rewind_retract_mm", o.rewind_retract_mm);
        return Err(SolveError::Option { what, value, wanted: "not below zero" });
    }
    for value in [o.aloft_tol.0, o.aloft_tol.1] {
        if !(value.is_finite() && value >= 0.0) {
            return Err(SolveError::Option { what: "aloft_tol", value, wanted: "not below zero" });
        }
    }
    let (what, value) = ("touch_rad", o.touch_rad);
    if !(0.0..=FRAC_PI_2).contains(&value) {
        return Err(SolveError::Option { what, value, wanted: "from zero to a right angle" });
    }
    let value = o.singular_cone_rad;
    if !(value >= 0.0 && value <= o.axis_tol_rad) {
        return Err(SolveError::Option {
            what: "singular_cone_rad",
            value,
            wanted: "from zero to axis_tol_rad",
        });
    }
    Ok(())
}
