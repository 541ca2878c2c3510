//! Parts that are meshes: STL, PLY and 3MF.
//!
//! [`read`] gives the triangles of a file, [`mesh_part`] makes a part of them: corners at the same place are one, triangles that do not
//! go with their neighbours are turned over, closed bodies that are inside out too, and what hangs together without a sharp edge is a
//! face. What is changed is told.
//!
//! A mesh does not say how far it lies off what it stands for. [`MeshPart::chord_mm`] is what its angles suggest: over a side at which
//! two triangles of a width w meet under the angle a, a smooth surface through their corners stands off them by about `w a / 8`, as a
//! circle does off its chord.

mod groups;
mod ply;
mod stl;
mod threemf;
mod weld;
mod zip;

pub use groups::{MOST_FACES, MeshFace, MeshPart, SHARP_RAD, mesh_part};
pub use ply::PlyError;
pub use stl::{StlError, read_stl};
pub use threemf::ThreeMfError;
pub use zip::ZipError;

use osculate_geom::Point3;
use std::fmt;

/// The format of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// STL, binary or text.
    Stl,
    /// PLY, binary or text.
    Ply,
    /// 3MF.
    ThreeMf,
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::ThreeMf => "3MF",
        })
    }
}

/// Triangles as a file has them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshFile {
    /// The format.
    pub format: MeshFormat,
    /// Corners, counter-clockwise seen from outside, in the file's unit.
    pub triangles: Vec<[Point3; 3]>,
    /// Millimetres in the file's unit, where it says one.
    pub unit_mm: Option<f64>,
}

/// Why a file is no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// None of the formats.
    #[error("no mesh that is read: STL, PLY and 3MF are")]
    Unknown,
    /// An STL file that cannot be read.
    #[error("STL: {0}")]
    Stl(#[from] StlError),
    /// A PLY file that cannot be read.
    #[error("PLY: {0}")]
    Ply(#[from] PlyError),
    /// A 3MF file that cannot be read.
    #[error("3MF: {0}")]
    ThreeMf(#[from] ThreeMfError),
}

/// The format of a file, by its beginning and its size.
#[must_use]
pub fn mesh_format(bytes: &[u8]) -> Option<MeshFormat> {
    if ply::looks_like(bytes) {
        Some(MeshFormat::Ply)
    } else if threemf::looks_like(bytes) {
        Some(MeshFormat::ThreeMf)
    } else if stl::looks_like(bytes) {
        Some(MeshFormat::Stl)
    } else {
        None
    }
}

/// Reads a mesh of any format that [`mesh_format`] knows.
///
/// ```
/// use osculate_surfaces::facets::{MeshFileError, MeshFormat, read};
/// let text = "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 0 4 0\n\
///             endloop\nendfacet\nendsolid one\n";
/// let mesh = read(text.as_bytes())?;
/// assert_eq!((mesh.format, mesh.triangles.len()), (MeshFormat::Stl, 1));
/// // STL says no unit.
/// assert_eq!(mesh.unit_mm, None);
/// assert!(matches!(read(b"ISO-10303-21;"), Err(MeshFileError::Unknown)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MeshFileError`].
pub fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let format = mesh_format(bytes).ok_or(MeshFileError::Unknown)?;
    let (triangles, unit_mm) = match format {
        MeshFormat::Stl => (read_stl(bytes)?, None),
        MeshFormat::Ply => (ply::read(bytes)?, None),
        MeshFormat::ThreeMf => {
            let (triangles, unit_mm) = threemf::read(bytes)?;
            (triangles, Some(unit_mm))
        }
    };
    Ok(MeshFile { format, triangles, unit_mm })
}
