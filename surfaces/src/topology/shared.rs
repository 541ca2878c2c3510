//! Shared edges and vertices of faces.

use super::chart::Chart;
use super::course::Course;
use super::local::LocalEdge;
use osculate_geom::Point3;

/// An edge and where it is used.
pub(crate) struct Edge {
    /// Its way in space, from its first use.
    pub(crate) course: Course,
    /// Vertex numbers at start and end.
    pub(crate) vertices: [usize; 2],
    /// The faces that use it, one entry a use.
    pub(crate) uses: Vec<usize>,
    /// Length, mm.
    pub(crate) length_mm: f64,
}

/// A face's use of an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeUse {
    /// The edge; `None` where the use has no length in space.
    pub(crate) edge: Option<usize>,
    /// Whether the use runs along the edge's own course.
    pub(crate) forward: bool,
    /// Vertex numbers at the start and the end of the use.
    pub(crate) vertices: [usize; 2],
}

/// A face with its edges.
pub(crate) struct FaceEdges {
    pub(crate) chart: Chart,
    /// The edges as the face has them, loop by loop.
    pub(crate) local: Vec<LocalEdge>,
    /// What they are in the part, in the same order.
    pub(crate) uses: Vec<EdgeUse>,
}

/// Shared edges and vertices of faces.
pub(crate) struct Topology {
    pub(crate) faces: Vec<FaceEdges>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) vertices: Vec<Point3>,
    /// Diagonal of the box around all edges and faces, mm.
    pub(crate) size_mm: f64,
}
