//! The width of a strip at a contact by the planar closed form, for searches that ask it many times.

use crate::closed_form::{Section, width_37};
use osculate_geom::{Darboux, Forms, Relative};
use osculate_tools::{Cutter, Lean};

/// Strips are not counted on to be wider than this, of the tool's radius: there the closed form ends.
pub(crate) const WIDEST: f64 = 1.6;

/// Width across the feed of a frame, mm: that of [`width_37`], and [`WIDEST`] radii where the tool fits closer than it knows.
pub(crate) fn planar_width_mm(
    forms: &Forms,
    frame: &Darboux,
    (cutter, lean): (&Cutter, Lean),
    scallop_mm: f64,
) -> f64 {
    let q = Relative::new(forms, &lean.tool_curvature(cutter, frame)).along(&frame.left);
    let most = WIDEST * cutter.radius_mm();
    if q.is_nan() || q <= 0.0 {
        return most;
    }
    let part_per_mm = forms.normal_curvature(&frame.left);
    let section = Section { part_per_mm, tool_per_mm: q - part_per_mm, scallop_mm };
    width_37(section).unwrap_or(most).min(most)
}
