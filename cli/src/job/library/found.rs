//! What a reader of a foreign library finds, before it is checked as the tables of a job are.

use crate::job::raw;
use crate::job::words::ToolKind;
use osculate_geom::Diagnostic;

/// Tools of a foreign file, each with its place there, and what was found.
#[derive(Default)]
pub(super) struct Found {
    /// Each with its place in the file.
    pub tools: Vec<(String, raw::Tool)>,
    /// What was left out, and why.
    pub diagnostics: Vec<Diagnostic>,
}

/// A tool of which only kind and diameter are known.
pub(super) fn bare(kind: ToolKind, diameter_mm: f64) -> raw::Tool {
    raw::Tool {
        kind,
        diameter_mm,
        number: None,
        corner_radius_mm: None,
        length_mm: None,
        flute_length_mm: None,
        taper_deg: None,
        tip_diameter_mm: None,
        barrel_radius_mm: None,
        bottom_angle_deg: None,
        side_angle_deg: None,
        teeth: None,
        plunges: false,
        holder: None,
        name: None,
        cutting: None,
    }
}
