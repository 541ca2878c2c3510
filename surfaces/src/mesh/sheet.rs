//! The plane of a face while it is being triangulated.

use crate::part::Face;
use crate::topology::Chart;
use osculate_geom::{Point3, Surface, Uv, uv};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

/// A vertex of the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) place: Point2<f64>,
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

/// The plane of a face while it is being filled.
pub(super) struct Sheet<'a> {
    pub(super) face: &'a Face,
    pub(super) chart: &'a Chart,
    pub(super) plane: Plane,
    pub(super) own: Vec<Point3>,
    pub(super) shared: usize,
    pub(super) scale: [f64; 2],
    /// The vertices of the boundary, and how many points of its own the face had with them.
    rim: (Vec<Node>, usize),
}

impl<'a> Sheet<'a> {
    pub(super) fn new(face: &'a Face, chart: &'a Chart, own: Vec<Point3>, shared: usize) -> Self {
        let extent = [0, 1].map(|k| chart.speed[k] * chart.side(k).length());
        let most = extent[0].max(extent[1]);
        // A direction of no speed is stretched as if it were short, so that its parameters stay apart.
        let scale = [0, 1].map(|k| (extent[k] / most).max(1e-3) / chart.side(k).length());
        Self { face, chart, plane: Plane::new(), own, shared, scale, rim: (Vec::new(), 0) }
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

    /// The boundary is whole: what is added from now on lies inside.
    pub(super) fn close_rim(&mut self) {
        self.rim = (self.plane.vertices().map(|v| *v.data()).collect(), self.own.len());
    }

    /// Inserts a point of the surface inside the boundary; not where its parameters are no numbers, nor where a vertex is. The place is looked
    /// for from a vertex near it, if one is known.
    pub(super) fn add(&mut self, at: Uv, near: Option<FixedVertexHandle>) {
        let point = self.face.surface.point(at);
        let node = Node { place: self.place(at), at, point, id: self.shared + self.own.len() };
        let before = self.plane.num_vertices();
        let inserted = match near {
            Some(near) => self.plane.insert_with_hint(node, near),
            None => self.plane.insert(node),
        };
        let Ok(handle) = inserted else { return };
        if self.plane.num_vertices() > before {
            self.own.push(point);
            return;
        }
        // The vertex there has taken over what is inserted: it gets back what it was.
        let (rim, own) = &self.rim;
        let was = rim.get(handle.index()).copied().unwrap_or_else(|| {
            let k = own + handle.index() - rim.len();
            Node { point: self.own[k], id: self.shared + k, ..node }
        });
        *self.plane.vertex_data_mut(handle) = was;
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

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: &str = r#"{"format": 1, "faces": [{"id": "F1", "kind": "bspline", "oriented": true, "side": "along", "surface": {"nurbs":
        {"degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]], "poles_mm": [[[0, 0, 0], [0, 9, 0]], [[9, 0, 0], [9, 9, 0]]],
        "side": "along"}}}]}"#;

    /// What is inserted where a vertex is changes nothing: not a shared vertex, whose neighbour would lose it, and not one inside.
    #[test]
    fn a_vertex_keeps_its_number() {
        let faces = crate::json::read(SQUARE.as_bytes()).expect("a square");
        let chart = Chart::new(&faces[0]);
        let mut sheet = Sheet::new(&faces[0], &chart, vec![Point3::origin()], 7);
        let corners = [(0.0, 0.0, 3), (1.0, 0.0, 4), (0.0, 1.0, 5), (1.0, 1.0, 7)];
        for (u, v, id) in corners {
            let at = uv(u, v);
            let node = Node { place: sheet.place(at), at, point: faces[0].surface.point(at), id };
            sheet.plane.insert(node).expect("a corner");
        }
        sheet.close_rim();
        for (u, v) in [(0.5, 0.25), (1.0, 0.0), (0.25, 0.5), (0.5, 0.25), (1.0, 1.0), (0.25, 0.5)] {
            sheet.add(uv(u, v), None);
        }
        let ids: Vec<usize> = sheet.plane.vertices().map(|v| v.data().id).collect();
        assert_eq!(ids, [3, 4, 5, 7, 8, 9]);
        assert_eq!(sheet.own.len(), 3);
        for v in sheet.plane.vertices().skip(4) {
            assert_eq!(v.data().point, sheet.own[v.data().id - sheet.shared]);
        }
    }
}
