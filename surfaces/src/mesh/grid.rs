//! Triangles of a trimmed surface, for pictures.
//!
//! A grid in the parameter rectangle, fine enough for the chord tolerance; cells inside become two triangles, cells
//! that the loops cross are cut into trapezoids between the loops' vertices, so that the edge of the picture follows
//! the trim. The mesh is not watertight between faces, and cells of different fineness meet with vertices on each
//! other's sides: gaps stay below the chord tolerance.

use crate::trim::region::{Chain, Known, Region};
use crate::trim::{Cell, Crossing, crossing};
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Axis, Facets, Side, Surface, Uv, Vec3, uv};
use std::collections::HashMap;

/// A triangle mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices, mm.
    pub positions: Vec<[f64; 3]>,
    /// Outward unit normals at the vertices; zero where there is no tangent plane nearby.
    pub normals: Vec<[f64; 3]>,
    /// Surface parameters of the vertices.
    pub uvs: Vec<[f64; 2]>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Grid lines in one direction at most.
const MAX_LINES: usize = 512;

/// Vertices whose parameters agree to this fraction of the rectangle are one.
const SAME: f64 = 1e-10;

/// Triangulates the inside of a surface. `chord_mm` is the largest distance between mesh and surface aimed at,
/// `max_edge_mm` the longest side of a cell. Tolerances that are not positive count as one part in a thousand of the
/// surface's size. Of a surface that is made of triangles these are the mesh, as they are.
///
/// ```
/// use osculate_geom::{Side, analytic::Sphere};
/// use osculate_surfaces::{TrimmedSurface, tessellate};
/// use std::sync::Arc;
/// // Vertices lie on the ball; the middles of triangles are as far inside as the chord at most.
/// let ball = TrimmedSurface::new(Arc::new(Sphere::new(10.0)?), &[], Side::Along)?;
/// let mesh = tessellate(&ball, 0.05, None);
/// let r = |p: [f64; 3]| p.iter().map(|c| c * c).sum::<f64>().sqrt();
/// assert!(mesh.positions.iter().all(|p| (r(*p) - 10.0).abs() < 1e-9));
/// let middle = |t: &[u32; 3]| [0, 1, 2].map(|c| t.iter().map(|k| mesh.positions[*k as usize][c] / 3.0).sum());
/// assert!(mesh.triangles.iter().all(|t| r(middle(t)) > 10.0 - 0.1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn tessellate(surface: &TrimmedSurface, chord_mm: f64, max_edge_mm: Option<f64>) -> Mesh {
    if let Some(facets) = surface.facets() {
        return as_they_are(facets, surface.side());
    }
    let size = surface.bbox(1).diagonal_mm();
    let chord_mm = if chord_mm > 0.0 { chord_mm } else { 1e-3 * size };
    let edge_mm = max_edge_mm.filter(|e| *e > 0.0).unwrap_or(f64::INFINITY);
    let [us, vs] = [Axis::U, Axis::V].map(|axis| lines(surface, axis, chord_mm, edge_mm));
    let region = coarse_region(surface, chord_mm);
    let mut builder = Builder { surface, mesh: Mesh::default(), index: HashMap::new() };
    for u in us.windows(2) {
        for v in vs.windows(2) {
            let cell = Cell { u: [u[0], u[1]], v: [v[0], v[1]] };
            match region.as_ref().map_or(Crossing::Inside, |r| crossing(cell, r)) {
                Crossing::Outside => {}
                Crossing::Inside => {
                    builder.quad([uv(u[0], v[0]), uv(u[1], v[0]), uv(u[1], v[1]), uv(u[0], v[1])])
                }
                Crossing::Cut(columns) => {
                    if let Some(r) = &region {
                        for c in columns.windows(2) {
                            builder.column(r, cell, [c[0], c[1]]);
                        }
                    }
                }
            }
        }
    }
    builder.mesh
}

/// Triangles with a normal of their own each.
fn as_they_are(facets: &Facets, side: Side) -> Mesh {
    let mut mesh = Mesh::default();
    for (k, t) in facets.triangles().iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let normal = Facets::normal_of(t).map_or([0.0; 3], |n| (n.into_inner() * side.sign()).into());
        for (c, p) in t.iter().enumerate() {
            let at = Facets::corner(k, c);
            mesh.positions.push((*p).into());
            mesh.normals.push(normal);
            mesh.uvs.push([at.u, at.v]);
        }
        mesh.triangles.push(match side {
            Side::Along => [first, first + 1, first + 2],
            Side::Against => [first, first + 2, first + 1],
        });
    }
    mesh
}

/// Grid lines of one parameter: every span halved until the sagitta of its chords and their length are small enough
/// along a few lines across.
fn lines(surface: &TrimmedSurface, axis: Axis, chord_mm: f64, edge_mm: f64) -> Vec<f64> {
    let breaks = surface.breaks(axis);
    let across = surface.domain().get(axis.other());
    let mut out = vec![breaks[0]];
    let per_span = (MAX_LINES / breaks.len()).max(1);
    for w in breaks.windows(2) {
        let width = w[1] - w[0];
        let (mut bend, mut speed) = (0.0_f64, 0.0_f64);
        for f in [0.0, 0.25, 0.5, 0.75, 1.0] {
            for g in [0.0, 0.2, 0.4, 0.6, 0.8, 1.0] {
                let jet = surface.jet2(Uv::from_axis(axis, w[0] + f * width, across.at(g)));
                let (first, second) = if axis == Axis::U { (jet.du, jet.duu) } else { (jet.dv, jet.dvv) };
                bend = bend.max(second.norm());
                speed = speed.max(first.norm());
            }
        }
        // Sagitta of a chord over h: |S''| h^2 / 8; half the tolerance for each direction.
        let by_chord = width * (bend / (4.0 * chord_mm)).sqrt();
        let by_edge = width * speed / edge_mm;
        let n = by_chord.max(by_edge).ceil().clamp(1.0, per_span as f64) as usize;
        out.extend((1..=n).map(|k| if k == n { w[1] } else { w[0] + width * k as f64 / n as f64 }));
    }
    // A twist bends the diagonals of a bilinear patch: never fewer than four cells.
    while out.len() < 5 {
        out = out.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]).chain(out.last().copied()).collect();
    }
    out
}

/// The surface's loops with only the vertices that the chord tolerance needs.
fn coarse_region(surface: &TrimmedSurface, chord_mm: f64) -> Option<Region> {
    if !surface.is_trimmed() {
        return None;
    }
    let chains: Vec<Chain> = surface
        .loops()
        .iter()
        .map(|l| {
            let mut points = thinned(surface, &l.points, 0.5 * chord_mm);
            points.extend(points.first().copied());
            Chain { points }
        })
        .collect();
    let known = Known { below_out: true, above_out: true, oriented: false };
    Some(Region::new(surface.domain(), [false, false], &chains, known))
}

/// Leaves out vertices of a closed polyline that lie within `slack_mm` of the chord that replaces them, never going
/// below eight (Douglas and Peucker).
fn thinned(surface: &TrimmedSurface, points: &[Uv], slack_mm: f64) -> Vec<Uv> {
    let n = points.len();
    if n <= 8 {
        return points.to_vec();
    }
    let at: Vec<Vec3> = points.iter().map(|p| surface.point(*p).coords).collect();
    let mut keep = vec![false; n];
    // Four fixed corners split the loop, so that no chord joins a point to itself.
    let fixed: Vec<usize> = (0..4).map(|k| k * n / 4).collect();
    let mut stack: Vec<[usize; 2]> = Vec::new();
    for k in 0..4 {
        keep[fixed[k]] = true;
        stack.push([fixed[k], if k == 3 { n } else { fixed[k + 1] }]);
    }
    while let Some([a, b]) = stack.pop() {
        let (p, q) = (at[a], at[b % n]);
        let chord = q - p;
        let length = chord.norm();
        let mut far = (0.0, a);
        for (k, x) in at.iter().enumerate().take(b).skip(a + 1) {
            let d = if length > 0.0 { (x - p).cross(&chord).norm() / length } else { (x - p).norm() };
            // Beyond the ends of the chord the distance to the line says nothing.
            let d = d.max((x - p).norm() - length);
            if d > far.0 {
                far = (d, k);
            }
        }
        if far.0 > slack_mm {
            keep[far.1] = true;
            stack.push([a, far.1]);
            stack.push([far.1, b]);
        }
    }
    (0..n).filter(|k| keep[*k]).map(|k| points[k]).collect()
}

struct Builder<'a> {
    surface: &'a TrimmedSurface,
    mesh: Mesh,
    index: HashMap<[i64; 2], u32>,
}

impl Builder<'_> {
    /// Vertex number of a parameter pair.
    fn vertex(&mut self, at: Uv) -> u32 {
        let d = self.surface.domain();
        let key = [(at.u - d.u.lo) / d.u.length(), (at.v - d.v.lo) / d.v.length()]
            .map(|f| (f / SAME).round() as i64);
        if let Some(k) = self.index.get(&key) {
            return *k;
        }
        let jet = self.surface.jet2(at);
        let normal = jet.normal().ok().or_else(|| {
            // At a pole: the normal a little towards the middle.
            let middle = d.at(0.5, 0.5);
            let nudged = uv(at.u + 1e-4 * (middle.u - at.u), at.v + 1e-4 * (middle.v - at.v));
            self.surface.jet2(nudged).normal().ok()
        });
        let number = self.mesh.positions.len() as u32;
        self.mesh.positions.push(jet.point.coords.into());
        self.mesh.normals.push(normal.map_or([0.0; 3], |n| n.into_inner().into()));
        self.mesh.uvs.push([at.u, at.v]);
        self.index.insert(key, number);
        number
    }

    /// Two triangles of a quadrilateral that is counter-clockwise in the parameter plane.
    fn quad(&mut self, corners: [Uv; 4]) {
        let [a, b, c, d] = corners.map(|p| self.vertex(p));
        // The shorter diagonal follows the surface better.
        let gap = |i: u32, j: u32| {
            let (p, q) = (self.mesh.positions[i as usize], self.mesh.positions[j as usize]);
            (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f64>()
        };
        if gap(a, c) <= gap(b, d) {
            self.triangle([a, b, c]);
            self.triangle([a, c, d]);
        } else {
            self.triangle([a, b, d]);
            self.triangle([b, c, d]);
        }
    }

    fn triangle(&mut self, t: [u32; 3]) {
        if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
            return;
        }
        let turned = self.surface.side() == Side::Against;
        self.mesh.triangles.push(if turned { [t[0], t[2], t[1]] } else { t });
    }

    /// Trapezoids of the inside in a column of a cell between two loop vertices.
    fn column(&mut self, region: &Region, cell: Cell, u: [f64; 2]) {
        let width = u[1] - u[0];
        if width <= SAME * self.surface.domain().u.length() {
            return;
        }
        // Just inside the column the spans are those of its interior; their ends are straight across it.
        let spans = [1e-7, 0.5, 1.0 - 1e-7].map(|f| region.spans(Axis::V, u[0] + f * width));
        let same = spans[0].len() == spans[1].len() && spans[2].len() == spans[1].len();
        for (k, middle) in spans[1].iter().enumerate() {
            let (left, right) = if same { (spans[0][k], spans[2][k]) } else { (*middle, *middle) };
            let clip = |t: f64| t.clamp(cell.v[0], cell.v[1]);
            let corners = [
                uv(u[0], clip(left.lo)),
                uv(u[1], clip(right.lo)),
                uv(u[1], clip(right.hi)),
                uv(u[0], clip(left.hi)),
            ];
            if corners[3].v > corners[0].v || corners[2].v > corners[1].v {
                self.quad(corners);
            }
        }
    }
}

impl Mesh {
    /// Sum of the triangles' areas, mm2.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        let at = |k: u32| Vec3::from(self.positions[k as usize]);
        self.triangles.iter().map(|t| 0.5 * (at(t[1]) - at(t[0])).cross(&(at(t[2]) - at(t[0]))).norm()).sum()
    }
}
