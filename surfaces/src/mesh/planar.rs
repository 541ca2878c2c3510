//! The triangulation of one face in its parameter rectangle.
//!
//! Coordinates are parameters times mean speeds, divided by the rectangle's size. The boundary's chords are constraints;
//! what they cut apart is inside or outside as the surface's own loops say at its largest triangle.

use super::boundary::Outline;
use super::{MeshOptions, interior, turned};
use crate::part::Face;
use crate::topology::Chart;
use osculate_geom::{Point3, Surface, Uv, uv};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};
use std::cell::RefCell;
use std::collections::HashMap;

/// A vertex of the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    place: Point2<f64>,
    pub(super) at: Uv,
    pub(super) point: Point3,
    /// Number in the mesh.
    pub(super) id: usize,
}

impl HasPosition for Node {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.place
    }
}

pub(super) type Plane = ConstrainedDelaunayTriangulation<Node>;
pub(super) type Triangle = FixedFaceHandle<InnerTag>;

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

/// The plane of a face while it is being filled.
pub(super) struct Sheet<'a> {
    pub(super) face: &'a Face,
    pub(super) chart: &'a Chart,
    pub(super) plane: Plane,
    pub(super) own: Vec<Point3>,
    pub(super) shared: usize,
    scale: [f64; 2],
}

impl<'a> Sheet<'a> {
    fn new(face: &'a Face, chart: &'a Chart, own: Vec<Point3>, shared: usize) -> Self {
        let extent = [0, 1].map(|k| chart.speed[k] * chart.side(k).length());
        let most = extent[0].max(extent[1]);
        // A direction of no speed is stretched as if it were short, so that its parameters stay apart.
        let scale = [0, 1].map(|k| (extent[k] / most).max(1e-3) / chart.side(k).length());
        Self { face, chart, plane: Plane::new(), own, shared, scale }
    }

    /// The place of parameters in the plane.
    pub(super) fn place(&self, at: Uv) -> Point2<f64> {
        let d = self.chart.domain;
        // Values below the triangulation's least are zero.
        let one = |t: f64| if t.abs() < 1e-30 { 0.0 } else { t };
        Point2::new(one((at.u - d.u.lo) * self.scale[0]), one((at.v - d.v.lo) * self.scale[1]))
    }

    /// The parameters at a place of the plane.
    fn parameters(&self, p: Point2<f64>) -> Uv {
        let d = self.chart.domain;
        uv(d.u.lo + p.x / self.scale[0], d.v.lo + p.y / self.scale[1])
    }

    /// Inserts a point of the surface; `None` where its parameters are no numbers.
    pub(super) fn add(&mut self, at: Uv) -> Option<FixedVertexHandle> {
        let point = self.face.surface.point(at);
        let node = Node { place: self.place(at), at, point, id: self.shared + self.own.len() };
        let before = self.plane.num_vertices();
        let handle = self.plane.insert(node).ok()?;
        if self.plane.num_vertices() > before {
            self.own.push(point);
        }
        Some(handle)
    }

    /// Which inner triangles are inside the face, by index.
    pub(super) fn inside(&self) -> Vec<bool> {
        let count = self.plane.num_inner_faces();
        let mut part = vec![usize::MAX; count + 1];
        let mut answers = Vec::new();
        for start in self.plane.inner_faces() {
            if part[start.fix().index()] != usize::MAX {
                continue;
            }
            let number = answers.len();
            let mut largest = (-1.0, start.fix());
            let mut pending = vec![start.fix()];
            part[start.fix().index()] = number;
            while let Some(f) = pending.pop() {
                let face = self.plane.face(f);
                if face.area() > largest.0 {
                    largest = (face.area(), f);
                }
                for e in face.adjacent_edges() {
                    if e.is_constraint_edge() {
                        continue;
                    }
                    if let Some(next) = e.rev().face().as_inner()
                        && part[next.fix().index()] == usize::MAX
                    {
                        part[next.fix().index()] = number;
                        pending.push(next.fix());
                    }
                }
            }
            let centre = self.parameters(self.plane.face(largest.1).center());
            answers.push(self.face.surface.contains(centre));
        }
        part.into_iter().map(|p| answers.get(p).copied().unwrap_or(false)).collect()
    }
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
