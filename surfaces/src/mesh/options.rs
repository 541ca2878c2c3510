//! How fine a mesh is to be.

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// Largest distance between mesh and faces, mm.
    pub chord_mm: f64,
    /// Largest angle between the normals at the ends of a triangle's side, and between chords of an edge, rad.
    pub angle_rad: Option<f64>,
    /// Longest side of a triangle, mm.
    pub max_edge_mm: Option<f64>,
    /// Distance within which edges that the file does not call the same are taken as one; a hundred-thousandth of
    /// the part's size where not given.
    pub join_mm: Option<f64>,
}

impl MeshOptions {
    /// Only a chord tolerance.
    #[must_use]
    pub const fn chord(chord_mm: f64) -> Self {
        Self { chord_mm, angle_rad: None, max_edge_mm: None, join_mm: None }
    }
}
