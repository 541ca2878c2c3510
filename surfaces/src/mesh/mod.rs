//! Triangles of faces.
//!
//! [`tessellate`] makes a quick mesh of one surface for pictures. [`mesh_faces`] meshes the faces of a part together:
//! an edge that faces share is cut into chords once, and every face that it bounds takes the same points, so that the
//! mesh of a closed body is closed. Inside a face a constrained Delaunay triangulation of the parameter rectangle,
//! scaled to mean lengths, is refined until the middle of every edge and every triangle is within the tolerance.

mod boundary;
mod discretise;
mod grid;
mod interior;
mod options;
mod planar;
mod report;
mod sheet;

pub use grid::{Mesh, tessellate};
pub use options::MeshOptions;
pub use report::MeshReport;

use crate::part::Face;
use crate::topology::Topology;
use boundary::Outline;
use discretise::EdgePoints;
use osculate_geom::{Point3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Why there is no mesh.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A length or angle that is no limit.
    #[error("{what} is {got}: it must be positive and finite")]
    Limit {
        /// Which one.
        what: &'static str,
        /// Its value.
        got: f64,
    },
    /// The chord tolerance asks for more triangles than a mesh can have.
    #[error(
        "a chord tolerance of {chord_mm:.3e} mm on a part of {size_mm:.3e} mm needs too many triangles; {least_mm:.3e} mm is the least"
    )]
    TooFine {
        /// The tolerance, mm.
        chord_mm: f64,
        /// The part's size, mm.
        size_mm: f64,
        /// The least tolerance for this size, mm.
        least_mm: f64,
    },
}

/// The triangles of several faces with common vertices along common edges.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct PartMesh {
    /// Vertices, mm.
    pub positions: Vec<Point3>,
    /// Vertex numbers, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The triangles of each face, in the order of the faces.
    pub faces: Vec<Range<usize>>,
    /// How good it is.
    pub report: MeshReport,
}

/// The least chord tolerance as a part of the size: a sphere then has some twenty million triangles.
const LEAST_CHORD: f64 = 1e-7;

/// Rounds in which edges whose chords cross inside a face are cut finer.
const ROUNDS: usize = 5;

/// Meshes faces together. The same faces give the same mesh whatever the number of threads.
///
/// ```
/// use osculate_surfaces::{MeshOptions, mesh_faces, patches};
/// // A cube of 10 mm as six patches: common edges have common vertices, so that the mesh is closed.
/// let corner = |k: usize| format!("{} {} {}\n", 10 * (k / 4), 10 * (k / 2 % 2), 10 * (k % 2));
/// let sides = [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]];
/// let text: String = sides.iter().map(|s| format!("1 1\n{}", s.map(corner).concat())).collect();
/// let cube = patches::read(format!("6\n{text}").as_bytes())?;
/// let mesh = mesh_faces(&cube.faces, &MeshOptions::chord(0.01))?;
/// assert!(mesh.report.watertight() && (mesh.volume_mm3() - 1000.0).abs() < 1e-9);
/// assert!((mesh.area_mm2() - 600.0).abs() < 1e-9 && mesh.positions.len() == 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MeshError`] for limits that are none.
pub fn mesh_faces(faces: &[Face], options: &MeshOptions) -> Result<PartMesh, MeshError> {
    let positive = |what, got: f64| {
        if got > 0.0 && got.is_finite() { Ok(()) } else { Err(MeshError::Limit { what, got }) }
    };
    positive("the chord tolerance, mm,", options.chord_mm)?;
    options.angle_rad.map_or(Ok(()), |a| positive("the angle tolerance, rad,", a))?;
    options.max_edge_mm.map_or(Ok(()), |e| positive("the longest edge, mm,", e))?;
    options.join_mm.map_or(Ok(()), |e| positive("the joining distance, mm,", e))?;
    if faces.is_empty() {
        return Ok(PartMesh::default());
    }
    let topology = Topology::new(faces, options.join_mm);
    let least_mm = LEAST_CHORD * topology.size_mm;
    if options.chord_mm < least_mm {
        let (chord_mm, size_mm) = (options.chord_mm, topology.size_mm);
        return Err(MeshError::TooFine { chord_mm, size_mm, least_mm });
    }
    let crossings = discretise::seam_crossings(faces, &topology);
    let mut chord = vec![options.chord_mm; topology.edges.len()];
    let mut made: Vec<planar::FaceMesh> = Vec::new();
    let mut edges: Vec<EdgePoints> = Vec::new();
    for round in 0..=ROUNDS {
        let first = topology.vertices.len();
        edges = discretise::edges(&topology, &crossings, &chord, options, first);
        let last = round == ROUNDS;
        let points = shared_points(&topology, &edges);
        made = (0..faces.len())
            .into_par_iter()
            .map(|f| {
                let outline = Outline::new(&faces[f], f, &topology, &edges, options);
                let tried = planar::Try { points: &points, last };
                planar::triangulate(&faces[f], &topology.faces[f].chart, outline, tried, options)
            })
            .collect();
        let mut finer = false;
        for e in made.iter().flat_map(|m| &m.crossing) {
            // Halving the distance at most doubles the points where edges come close.
            chord[*e] *= 0.25;
            finer = true;
        }
        if !finer {
            break;
        }
    }
    Ok(gathered(faces, &topology, &edges, made))
}

/// The vertices of the part and the inner points of its edges, by number.
fn shared_points(topology: &Topology, edges: &[EdgePoints]) -> Vec<Point3> {
    let inner = edges.iter().flat_map(|e| e.inner());
    topology.vertices.iter().chain(inner).copied().collect()
}

/// One mesh from those of the faces.
fn gathered(
    faces: &[Face],
    topology: &Topology,
    edges: &[EdgePoints],
    made: Vec<planar::FaceMesh>,
) -> PartMesh {
    let mut positions = shared_points(topology, edges);
    let shared = positions.len();
    let mut mesh = PartMesh::default();
    let mut chord_error_mm = 0.0_f64;
    let mut unfinished = Vec::new();
    for (f, m) in made.into_iter().enumerate() {
        let base = positions.len();
        let number = |id: usize| if id < shared { id } else { id - shared + base };
        let start = mesh.triangles.len();
        mesh.triangles.extend(m.triangles.iter().map(|t| t.map(|id| number(id) as u32)));
        mesh.faces.push(start..mesh.triangles.len());
        positions.extend(m.own);
        chord_error_mm = chord_error_mm.max(m.chord_error_mm);
        if m.unfinished {
            unfinished.push(faces[f].id.clone());
        }
    }
    // Vertices that no triangle uses (ends of slits, corners outside) are left out.
    let mut used = vec![u32::MAX; positions.len()];
    for t in &mut mesh.triangles {
        for id in t {
            let old = *id as usize;
            if used[old] == u32::MAX {
                used[old] = mesh.positions.len() as u32;
                mesh.positions.push(positions[old]);
            }
            *id = used[old];
        }
    }
    mesh.report = MeshReport::of(&mesh.triangles, chord_error_mm, unfinished);
    mesh
}

impl PartMesh {
    /// Sum of the triangles' areas, mm2.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        self.triangles.iter().map(|t| 0.5 * self.cross(t).norm()).sum()
    }

    /// Volume enclosed, mm3, positive where the triangles' outside is outside; of an open mesh the number says
    /// nothing.
    #[must_use]
    pub fn volume_mm3(&self) -> f64 {
        let Some(origin) = self.positions.first() else { return 0.0 };
        self.triangles
            .iter()
            .map(|t| (self.positions[t[0] as usize] - origin).dot(&self.cross(t)) / 6.0)
            .sum()
    }

    /// Twice the area of a triangle along its outward normal.
    pub(crate) fn cross(&self, t: &[u32; 3]) -> Vec3 {
        let [a, b, c] = t.map(|k| self.positions[k as usize]);
        (b - a).cross(&(c - a))
    }
}
