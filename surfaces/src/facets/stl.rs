//! Triangles from STL, binary or text. STL has no unit: coordinates are taken as they are.

use osculate_geom::Point3;

/// A file that is no STL.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StlError {
    /// A binary file whose size does not go with its count of triangles.
    #[error(
        "the file says {triangles} triangles, which take {need} bytes; it has {got}: it is truncated or no STL"
    )]
    Size {
        /// Triangles by its header.
        triangles: usize,
        /// Bytes that they need.
        need: usize,
        /// Bytes that are there.
        got: usize,
    },
    /// A vertex that is none.
    #[error("line {line}: '{text}' is no vertex: three numbers are expected")]
    Vertex {
        /// Line, from 1.
        line: usize,
        /// What stands there.
        text: String,
    },
    /// Vertices that do not make triangles.
    #[error("{vertices} vertices do not make triangles")]
    Count {
        /// How many.
        vertices: usize,
    },
    /// Text that ends too early.
    #[error("it does not end with endsolid: it is truncated")]
    Endless,
    /// A coordinate that is not finite.
    #[error("triangle {triangle} has a coordinate that is not finite")]
    NotFinite {
        /// Index of the triangle.
        triangle: usize,
    },
    /// No triangles at all.
    #[error("there is no triangle in it")]
    Empty,
}

/// Bytes of a binary file before the triangles, and of each triangle.
const HEADER: usize = 84;
const FACET: usize = 50;

/// What the last line of text begins with.
const END: &str = "endsolid";
/// How much of a file is looked at to tell that it is STL text, bytes.
const LOOK: usize = 4096;

/// Whether bytes are STL: text that begins with its word and goes on with a facet, or binary whose size goes with its number of
/// triangles.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let count = bytes.get(80..HEADER).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let fits = |n: usize| n.checked_mul(FACET).and_then(|x| x.checked_add(HEADER));
    if count.is_some_and(|n| n > 0 && fits(n) == Some(bytes.len())) {
        return true;
    }
    let head = &bytes[..bytes.len().min(LOOK)];
    let text = String::from_utf8_lossy(head).to_lowercase();
    text.trim_start().starts_with("solid") && (text.contains("facet") || text.contains("endsolid"))
}

/// The triangles of an STL file; normals are left aside.
///
/// # Errors
/// [`StlError`].
pub fn read_stl(bytes: &[u8]) -> Result<Vec<[Point3; 3]>, StlError> {
    let count = bytes.get(80..HEADER).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let fits = |n: usize| n.checked_mul(FACET).and_then(|x| x.checked_add(HEADER));
    // Binary files may begin with "solid" too: the size tells.
    let triangles = match count {
        Some(n) if fits(n) == Some(bytes.len()) => binary(&bytes[HEADER..]),
        Some(n) if !bytes.trim_ascii_start().starts_with(b"solid") => {
            let need = fits(n).unwrap_or(usize::MAX);
            return Err(StlError::Size { triangles: n, need, got: bytes.len() });
        }
        _ => ascii(&String::from_utf8_lossy(bytes))?,
    };
    if triangles.is_empty() {
        return Err(StlError::Empty);
    }
    match triangles.iter().position(|t| !t.iter().flat_map(|p| p.iter()).all(|x| x.is_finite())) {
        Some(triangle) => Err(StlError::NotFinite { triangle }),
        None => Ok(triangles),
    }
}

fn binary(facets: &[u8]) -> Vec<[Point3; 3]> {
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    // After the normal come three vertices of three numbers of four bytes.
    let vertex = |f: &[u8], k: usize| {
        let b = &f[12 + 12 * k..24 + 12 * k];
        Point3::new(number(&b[0..4]), number(&b[4..8]), number(&b[8..12]))
    };
    facets.chunks_exact(FACET).map(|f| [vertex(f, 0), vertex(f, 1), vertex(f, 2)]).collect()
}

fn ascii(text: &str) -> Result<Vec<[Point3; 3]>, StlError> {
    let mut points = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let line = line.trim();
        let Some(rest) = line.strip_prefix("vertex").or_else(|| line.strip_prefix("VERTEX")) else {
            continue;
        };
        let numbers: Vec<f64> = rest.split_whitespace().map_while(|w| w.parse().ok()).collect();
        match numbers[..] {
            [x, y, z] => points.push(Point3::new(x, y, z)),
            _ => return Err(StlError::Vertex { line: k + 1, text: line.to_owned() }),
        }
    }
    if points.len() % 3 != 0 {
        return Err(StlError::Count { vertices: points.len() });
    }
    let last = text.trim_end().lines().next_back().unwrap_or_default().trim_start();
    if !last.get(..END.len()).is_some_and(|word| word.eq_ignore_ascii_case(END)) {
        return Err(StlError::Endless);
    }
    Ok(points.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_and_damage() {
        let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n vertex 0 1e0 0\nendloop\nendfacet\nendsolid";
        let one = read_stl(text.as_bytes()).unwrap();
        assert_eq!(one, [[Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)]]);
        let mut bytes = vec![0u8; 80];
        bytes.extend(1u32.to_le_bytes());
        bytes.extend([0u8; 12]);
        for p in one[0] {
            for x in p.iter() {
                bytes.extend((*x as f32).to_le_bytes());
            }
        }
        bytes.extend([0u8; 2]);
        assert_eq!(read_stl(&bytes).unwrap(), one);
        // A binary header that begins with the word of the other form.
        bytes[..5].copy_from_slice(b"solid");
        assert_eq!(read_stl(&bytes).unwrap(), one);
        bytes[..5].copy_from_slice(b"xxxxx");
        assert!(matches!(read_stl(&bytes[..100]), Err(StlError::Size { triangles: 1, need: 134, got: 100 })));
        assert!(matches!(read_stl(b"solid\nvertex 1 2"), Err(StlError::Vertex { line: 2, .. })));
        assert!(matches!(read_stl(b"solid\nvertex 1 2 3"), Err(StlError::Count { vertices: 1 })));
        assert!(matches!(read_stl(b"solid\nEndSolid a\n\n"), Err(StlError::Empty)));
        assert!(matches!(read_stl(b""), Err(StlError::Endless)));
        let part = text.find("endsolid").unwrap();
        assert!(matches!(read_stl(&text.as_bytes()[..part]), Err(StlError::Endless)));
        let bad = b"solid\nvertex 1 2 3\nvertex 1 2 nan\nvertex 1 2 4\nendsolid\n";
        assert!(matches!(read_stl(bad), Err(StlError::NotFinite { triangle: 0 })));
    }
}
