//! Meshes as files: STL, binary and text, and Wavefront OBJ. Lengths are millimetres, which none of them can say.
//!
//! STL has single precision and repeats every vertex; equal vertices stay equal, so that a closed mesh stays closed.
//! Triangles that rounding makes flat are left out: both neighbours of the side that vanishes go.

use crate::mesh::PartMesh;
use osculate_geom::{Point3, Vec3};
use std::fmt::Write;

/// Length of a binary file's header, which means nothing.
const HEADER: usize = 80;

/// The mesh as binary STL: counter-clockwise triangles seen from outside, little endian.
///
/// ```
/// use osculate_surfaces::{MeshOptions, facets, mesh_faces, patches, stl};
/// // 80 bytes of head, a count, and 50 bytes a triangle; what was written is read back.
/// let part = patches::read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 5\n")?;
/// let mesh = mesh_faces(&part.faces, &MeshOptions::chord(0.1))?;
/// let bytes = stl::binary(&mesh);
/// assert_eq!(bytes.len(), 84 + 50 * mesh.triangles.len());
/// assert_eq!(facets::read(&bytes)?.triangles.len(), mesh.triangles.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn binary(mesh: &PartMesh) -> Vec<u8> {
    let triangles = rounded(mesh);
    let mut out = Vec::with_capacity(HEADER + 4 + 50 * triangles.len());
    let title = b"triangles, mm";
    out.extend_from_slice(title);
    out.resize(HEADER, b' ');
    out.extend_from_slice(&(triangles.len() as u32).to_le_bytes());
    for t in &triangles {
        for c in normal(t).iter().chain(t.iter().flatten()) {
            out.extend_from_slice(&c.to_le_bytes());
        }
        out.extend_from_slice(&[0, 0]);
    }
    out
}

/// The mesh as text STL under a name, of which line breaks are left out.
#[must_use]
pub fn ascii(mesh: &PartMesh, name: &str) -> String {
    let name: String = name.chars().filter(|c| !c.is_control()).collect();
    let mut out = format!("solid {name}\n");
    for t in rounded(mesh) {
        let [x, y, z] = normal(&t);
        // Writing into a String cannot fail.
        let _ = writeln!(out, "facet normal {x:e} {y:e} {z:e}\nouter loop");
        for [x, y, z] in t {
            let _ = writeln!(out, "vertex {x:e} {y:e} {z:e}");
        }
        out.push_str("endloop\nendfacet\n");
    }
    let _ = writeln!(out, "endsolid {name}");
    out
}

/// The mesh as Wavefront OBJ in full precision, with a group for each face; `ids` names the faces in their order.
#[must_use]
pub fn obj(mesh: &PartMesh, ids: &[&str]) -> String {
    let mut out = String::from("# triangles, mm\n");
    for p in &mesh.positions {
        let _ = writeln!(out, "v {} {} {}", p.x, p.y, p.z);
    }
    for (k, range) in mesh.faces.iter().enumerate() {
        let _ = writeln!(out, "g {}", ids.get(k).copied().unwrap_or("face"));
        for [a, b, c] in &mesh.triangles[range.clone()] {
            let _ = writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1);
        }
    }
    out
}

type Corner = [f32; 3];

/// Triangles in single precision, without those that have become flat.
fn rounded(mesh: &PartMesh) -> Vec<[Corner; 3]> {
    let at = |k: u32| {
        let p: Point3 = mesh.positions[k as usize];
        // Positive zero only, so that equal corners are equal bytes.
        [p.x, p.y, p.z].map(|c| c as f32 + 0.0)
    };
    let all = mesh.triangles.iter().map(|t| t.map(at));
    all.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

/// The outward unit normal; zero where the triangle has no area.
fn normal(t: &[Corner; 3]) -> Corner {
    let [a, b, c] = t.map(|p| Vec3::from(p.map(f64::from)));
    let n = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    [n.x as f32, n.y as f32, n.z as f32]
}
