//! What a mesh is worth: whether it closes, and how far it is from its faces.

use std::collections::HashMap;

/// Findings about a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshReport {
    /// Largest distance found between a triangle and its face at the middles of sides and triangles, mm.
    pub chord_error_mm: f64,
    /// Triangle sides without a neighbour.
    pub open_edges: usize,
    /// Triangle sides with more than two triangles, or two that run along them in the same sense.
    pub bad_edges: usize,
    /// Faces, by id, in which some triangle is farther off than asked, or whose edges could not all be kept.
    pub unfinished: Vec<String>,
}

impl MeshReport {
    /// Looks at the triangles' sides.
    pub(super) fn of(triangles: &[[u32; 3]], chord_error_mm: f64, unfinished: Vec<String>) -> Self {
        // Uses in the sense from the smaller number to the greater, and against it.
        let mut sides: HashMap<[u32; 2], [u32; 2]> = HashMap::with_capacity(3 * triangles.len() / 2);
        for t in triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                sides.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
            }
        }
        let open_edges = sides.values().filter(|n| n[0] + n[1] == 1).count();
        let bad_edges = sides.values().filter(|n| n[0] + n[1] > 1 && **n != [1, 1]).count();
        Self { chord_error_mm, open_edges, bad_edges, unfinished }
    }

    /// Whether every side has exactly one neighbour that runs against it.
    #[must_use]
    pub const fn watertight(&self) -> bool {
        self.open_edges == 0 && self.bad_edges == 0
    }
}
