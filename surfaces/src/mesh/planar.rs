//! The triangulation of one face in its parameter rectangle.
//!
//! Coordinates are parameters times mean speeds, divided by the rectangle's size. The boundary's chords are constraints;
//! what they cut apart is inside or outside as the surface's own loops say at its largest triangle.

use super::boundary::Outline;
use super::interior;
use super::options::MeshOptions;
use super::sheet::{Node, Sheet};
use crate::part::Face;
use crate::topology::Chart;
use osculate_geom::{Point3, Surface, uv};
use spade::handles::FixedVertexHandle;
use spade::{Point2, Triangulation};
use std::cell::RefCell;
use std::collections::HashMap;

/// The triangles of a face.
pub(super) struct FaceMesh {
    pub(super) triangles: Vec<[usize; 3]>,
    /// Vertices of its own, numbered behind the shared ones.
    pub(super) own: Vec<Point3>,
    /// Largest distance found, mm.
    pub(super) chord_error_mm: f64,
    /// Whether it is farther from the face than asked somewhere, or lost a part of its boundary.
    pub(super) unfinished: bool,
    /// Edges whose chords cross others and should be cut finer.
    pub(super) crossing: Vec<usize>,
}

/// What one try at a face goes by.
#[derive(Clone, Copy)]
pub(super) struct Try<'a> {
    /// The shared vertices.
    pub(super) points: &'a [Point3],
    /// Whether chords that cross are cut, there being no further try.
    pub(super) last: bool,
}

/// Triangulates the inside of an outline. Where chords cross, the edges to cut finer come back instead, unless this is
/// the `last` try: then they are cut where they cross.
pub(super) fn triangulate(
    face: &Face,
    chart: &Chart,
    outline: Outline,
    Try { points, last }: Try<'_>,
    options: &MeshOptions,
) -> FaceMesh {
    let mut sheet = Sheet::new(face, chart, outline.own, outline.shared);
    let mut unfinished = false;
    let mut handles: Vec<Option<FixedVertexHandle>> = Vec::with_capacity(outline.corners.len());
    for c in &outline.corners {
        let point = if c.id < sheet.shared { points[c.id] } else { sheet.own[c.id - sheet.shared] };
        let node = Node { place: sheet.place(c.at), at: c.at, point, id: c.id };
        handles.push(sheet.plane.insert(node).ok());
    }
    let mut edge_of: HashMap<[usize; 2], usize> = HashMap::new();
    let mut crossing = Vec::new();
    for ([a, b], edge) in &outline.segments {
        let (Some(from), Some(to)) = (handles[*a], handles[*b]) else {
            unfinished = true;
            continue;
        };
        if from == to {
            continue;
        }
        if let Some(e) = edge {
            let (i, j) = (from.index(), to.index());
            edge_of.insert([i.min(j), i.max(j)], *e);
        }
        if sheet.plane.can_add_constraint(from, to) {
            sheet.plane.add_constraint(from, to);
            continue;
        }
        let before = crossing.len();
        if !last {
            crossing.extend(*edge);
            for other in sheet.plane.get_conflicting_edges_between_vertices(from, to) {
                let [i, j] = other.vertices().map(|v| v.fix().index());
                crossing.extend(edge_of.get(&[i.min(j), i.max(j)]));
            }
        }
        if crossing.len() == before {
            unfinished = true;
            split(&mut sheet, from, to);
        }
    }
    if !crossing.is_empty() {
        crossing.sort_unstable();
        crossing.dedup();
        let (triangles, own) = (Vec::new(), Vec::new());
        return FaceMesh { triangles, own, chord_error_mm: 0.0, unfinished, crossing };
    }
    let found = interior::refine(&mut sheet, options);
    let inside = sheet.inside();
    let turned = turned(face);
    let mut triangles = Vec::new();
    for f in sheet.plane.inner_faces().filter(|f| inside[f.fix().index()]) {
        let [a, b, c] = f.vertices().map(|v| v.data().id);
        if a != b && b != c && c != a {
            triangles.push(if turned { [a, c, b] } else { [a, b, c] });
        }
    }
    unfinished |= found > options.chord_mm * (1.0 + 1e-9);
    FaceMesh { triangles, own: sheet.own, chord_error_mm: found, unfinished, crossing }
}

/// Adds a constraint that crosses others, with vertices at the crossings.
fn split(sheet: &mut Sheet<'_>, from: FixedVertexHandle, to: FixedVertexHandle) {
    let (shared, before) = (sheet.shared, sheet.own.len());
    let domain = sheet.chart.domain;
    let scale = sheet.scale;
    let surface = sheet.face.surface.clone();
    let made: RefCell<Vec<Point3>> = RefCell::new(Vec::new());
    sheet.plane.add_constraint_and_split(from, to, |p: Point2<f64>| {
        let at = uv(domain.u.lo + p.x / scale[0], domain.v.lo + p.y / scale[1]);
        let point = surface.point(at);
        made.borrow_mut().push(point);
        Node { place: p, at, point, id: shared + before + made.borrow().len() - 1 }
    });
    sheet.own.extend(made.into_inner());
}

/// Whether the triangles of a surface's parameter rectangle have to be turned over to be counter-clockwise from
/// outside.
fn turned(face: &Face) -> bool {
    let d = face.surface.domain();
    face.surface.jet2(d.at(0.5, 0.5)).side == osculate_geom::Side::Against
}
