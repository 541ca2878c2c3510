//! Writing STEP: AP214 boundary representations of faces.
//!
//! Surfaces with closed forms are written as such, splines as B-splines (rational ones as complex records), edges along
//! the curves of the file that they came from. Faces whose shared edges close a body become a solid, others an open
//! shell. Numbers are written with as many digits as it takes to read the same number back.
//!
//! Source: ISO 10303-21 (form), ISO 10303-42 (geometry and topology), ISO 10303-214 (product structure).

mod curves;
mod options;
mod pcurves;
mod records;
mod shells;
mod surfaces;

pub use options::{StepOptions, StepWriteError};

use crate::part::Face;
use crate::topology::{FaceEdges, Step, Topology, Way, natural_loops, outward, turned, way};
use osculate_geom::{Point3, Side};
use pcurves::Shape;
use records::{Records, flag, list, text};

/// Vertices are at the ends of their edges to at least this part of the part's size.
const ACCURACY: f64 = 1e-7;

/// Faces as a STEP file, lengths in millimetres.
///
/// ```
/// use osculate_surfaces::step::{self, StepOptions, StepWriteError};
/// use osculate_surfaces::{FaceKind, patches};
/// let part = patches::read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 5\n")?;
/// let text = step::write(&part.faces, &StepOptions { name: "twisted".to_owned(), ..Default::default() })?;
/// assert!(text.starts_with("ISO-10303-21;") && text.contains("twisted"));
/// assert_eq!(step::read(text.as_bytes())?.faces[0].kind, FaceKind::Bspline);
/// assert!(matches!(step::write(&[], &StepOptions::default()), Err(StepWriteError::NoFaces)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StepWriteError`].
pub fn write(faces: &[Face], options: &StepOptions) -> Result<String, StepWriteError> {
    let mut out = Vec::new();
    write_to(faces, options, &mut out)?;
    String::from_utf8(out).map_err(|e| StepWriteError::Output { why: e.to_string() })
}

/// As [`write()`], record by record: a file is several times as large as what its faces take in memory. Where it fails the output
/// has a part of the file.
///
/// # Errors
/// [`StepWriteError`].
pub fn write_to(
    faces: &[Face],
    options: &StepOptions,
    out: &mut dyn std::io::Write,
) -> Result<(), StepWriteError> {
    if faces.is_empty() {
        return Err(StepWriteError::NoFaces);
    }
    let topology = Topology::new(faces, None);
    let mut out = Records::new(out, options);
    let vertices: Vec<usize> = topology
        .vertices
        .iter()
        .map(|p| {
            let point = out.point(p);
            out.add(format!("VERTEX_POINT('',#{point})"))
        })
        .collect();
    let ways: Vec<Way> = topology.edges.iter().map(|e| way(&e.course, e.length_mm)).collect();
    let surfaces: Vec<usize> = faces.iter().map(|f| surfaces::surface(&mut out, f)).collect();
    let walks: Vec<Vec<Vec<Step>>> =
        faces.iter().zip(&topology.faces).map(|(face, of)| natural_loops(face, of)).collect();
    let curves = pcurves::curves(
        &mut out,
        &Shape { faces, topology: &topology, ways: &ways, walks: &walks },
        &surfaces,
    );
    let edges: Vec<usize> = topology
        .edges
        .iter()
        .enumerate()
        .map(|(k, e)| {
            let [a, b] = e.vertices.map(|k| vertices[k]);
            let (curve, sense) = (curves[k], flag(ways[k].forward()));
            out.add(format!("EDGE_CURVE('',#{a},#{b},#{curve},{sense})"))
        })
        .collect();
    let mut written = Vec::with_capacity(faces.len());
    for (number, (face, of)) in faces.iter().zip(&topology.faces).enumerate() {
        let mut bounds = Vec::new();
        let walks = turned(face, walks[number].clone());
        let bare = walks.is_empty();
        for walk in walks {
            let bound = edge_loop(&mut out, &walk, &edges);
            bounds.push(out.add(format!("FACE_BOUND('',#{bound},.T.)")));
        }
        if bare {
            let bound = vertex_loop(&mut out, face, of)?;
            bounds.push(out.add(format!("FACE_BOUND('',#{bound},.T.)")));
        }
        let surface = surfaces[number];
        let same = flag(outward(face) == Side::Along);
        let bounds = list(&bounds);
        written.push(out.add(format!("ADVANCED_FACE({},{bounds},#{surface},{same})", text(&face.name))));
    }
    let items = shells::items(&mut out, faces, &topology, &written);
    let accuracy_mm = accuracy(&topology).max(ACCURACY * topology.size_mm);
    shells::product(&mut out, options, &items, accuracy_mm);
    out.end()
}

/// A whole sphere or torus: a loop of one point stands for no boundary.
fn vertex_loop(out: &mut Records<'_>, face: &Face, of: &FaceEdges) -> Result<usize, StepWriteError> {
    if of.chart.closes == [false, false] {
        return Err(StepWriteError::NoBoundary { face: face.id.clone() });
    }
    let at = osculate_geom::Surface::point(&*face.surface, of.chart.domain.at(0.0, 0.0));
    let point = out.point(&at);
    let vertex = out.add(format!("VERTEX_POINT('',#{point})"));
    Ok(out.add(format!("VERTEX_LOOP('',#{vertex})")))
}

fn edge_loop(out: &mut Records<'_>, walk: &[Step], edges: &[usize]) -> usize {
    let uses: Vec<usize> = walk
        .iter()
        .map(|s| out.add(format!("ORIENTED_EDGE('',*,*,#{},{})", edges[s.edge], flag(s.forward))))
        .collect();
    out.add(format!("EDGE_LOOP('',{})", list(&uses)))
}

/// The largest distance of a vertex from the end of an edge that it belongs to, mm.
fn accuracy(topology: &Topology) -> f64 {
    let gap = |p: Point3, k: usize| (p - topology.vertices[k]).norm();
    topology
        .edges
        .iter()
        .flat_map(|e| [gap(e.course.point(0.0), e.vertices[0]), gap(e.course.point(1.0), e.vertices[1])])
        .fold(0.0, f64::max)
}
