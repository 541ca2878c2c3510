//! What a kind of plan has beside what every plan has: maps, tables and findings for its report.

use crate::report::{self, Table};
use osculate_geom::{Diagnostic, Point3, Unit3};
use serde::Serialize;

/// The area of a face that is left out.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct FaceLeftOut {
    /// The face.
    pub face: String,
    /// What passes would have cut and leave standing, mm2.
    pub area_mm2: f64,
}

/// A value of a place of a machined face, given by its number; NaN where there is none.
pub type Field<'a> = Box<dyn Fn(usize, &Point3) -> f64 + Sync + 'a>;

/// Tables and maps of one kind of report.
#[derive(Default)]
pub struct Extras<'a> {
    /// Maps over the machined faces, with name and unit.
    pub maps: Vec<(report::Scalar, Field<'a>)>,
    /// Tables, first on the page.
    pub tables: Vec<Table>,
    /// Tool axes, for a setup in which they look up.
    pub axes: Vec<Unit3>,
    /// What passes leave out of faces so as not to go into the part.
    pub left_out: Vec<FaceLeftOut>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}
