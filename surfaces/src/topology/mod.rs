//! Edges and vertices that the faces of a part share.
//!
//! A STEP file says which edge two faces have in common; IGES faces, and STEP faces that only touch, are matched by
//! geometry: both ends, the middle and the length agree within a tolerance. An edge has one course in space for all
//! its uses. Vertices come from the order of edges in loops, so that no tolerance decides on them where the file
//! is sound.

mod bodies;
mod chart;
mod course;
mod isoline;
mod local;
mod loops;
mod matching;
mod pcurve;
mod way;

pub(crate) use bodies::bodies;
pub(crate) use chart::{Chart, Wrapped};
pub(crate) use course::{Course, Follower, Spacing, on_polyline};
pub(crate) use local::LocalEdge;
pub(crate) use loops::{Step, loops, natural_loops, outward, turned};
pub(crate) use pcurve::{Ground, Track, pcurves};
pub(crate) use way::{Along, Way, as_spline, way};

use crate::part::Face;
use osculate_geom::{Box3, Point3};

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

impl Topology {
    /// Finds the shared edges. `join_mm` is the distance within which edges without a common identity are the same.
    pub(crate) fn new(faces: &[Face], join_mm: Option<f64>) -> Self {
        let made: Vec<(Chart, Vec<LocalEdge>)> = faces
            .iter()
            .map(|f| {
                let chart = Chart::new(f);
                let local = local::edges(f, &chart);
                (chart, local)
            })
            .collect();
        let mut all = Box3::empty();
        for e in made.iter().flat_map(|m| &m.1) {
            e.ends.iter().chain(&e.middles).for_each(|p| all.add(p));
        }
        let size_mm = made.iter().map(|m| m.0.size_mm).fold(all.diagonal_mm().max(0.0), f64::max);
        let join_mm = join_mm.unwrap_or(matching::JOIN * size_mm);
        matching::build(made, size_mm, join_mm)
    }
}
