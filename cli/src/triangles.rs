//! Files of triangles: STL, PLY and 3MF.

use crate::failure::Failure;
use osculate_geom::Point3;
use osculate_surfaces::facets::{self, MeshFile};
use std::path::Path;

/// Reads a mesh.
///
/// # Errors
/// Where it is none.
pub fn parsed(path: &Path, bytes: &[u8]) -> Result<MeshFile, Failure> {
    facets::read(bytes).map_err(|e| Failure::file(path, e))
}

/// The triangles of a mesh file, mm.
///
/// # Errors
/// Where it cannot be read or is no mesh.
pub fn triangles(path: &Path) -> Result<Vec<[Point3; 3]>, Failure> {
    let file = parsed(path, &crate::failure::read(path)?)?;
    let scale = file.unit_mm.unwrap_or(1.0);
    Ok(scaled(file.triangles, scale))
}

/// Triangles in mm, of whose unit so many go into one.
///
/// ```
/// use osculate::triangles::scaled;
/// use osculate_geom::Point3;
///
/// // A mesh in inches.
/// let inch = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
/// assert_eq!(scaled(vec![inch], 25.4)[0][1], Point3::new(25.4, 0.0, 0.0));
/// ```
#[must_use]
pub fn scaled(mut triangles: Vec<[Point3; 3]>, scale: f64) -> Vec<[Point3; 3]> {
    if scale != 1.0 {
        triangles.iter_mut().flatten().for_each(|p| *p = Point3::from(p.coords * scale));
    }
    triangles
}
