//! Points inside a face: a grid by curvature first, then wherever a triangle is still too far off.

use super::options::MeshOptions;
use super::sheet::{Node, Sheet, Triangle};
use osculate_geom::{Axis, Point3, Surface, Uv, uv};
use spade::handles::FixedVertexHandle;
use spade::{Point2, PositionInTriangulation, Triangulation};

/// Rounds of refinement at most; every round halves what is too long.
const ROUNDS: usize = 14;

/// Vertices of one face at most, a bound for hostile surfaces.
const MOST: usize = 2_000_000;

/// A grid point nearer to the boundary than this part of the grid's step would make a flat triangle.
const CLEAR: f64 = 0.35;

/// Lines of the first grid in one direction at most.
const MAX_LINES: usize = 1024;

/// A triangle lower than this in the plane, whose size is one, is a line: nothing is measured in it.
const FLAT: f64 = 1e-9;

/// Fills the face; returns the largest distance that is left, mm.
pub(super) fn refine(sheet: &mut Sheet<'_>, options: &MeshOptions) -> f64 {
    sheet.close_rim();
    grid(sheet, options);
    let mut left = 0.0;
    for round in 0..=ROUNDS {
        let (wanted, found) = wanted(sheet, options);
        left = found;
        if wanted.is_empty() || round == ROUNDS || sheet.plane.num_vertices() + wanted.len() > MOST {
            break;
        }
        for (at, near) in wanted {
            sheet.add(at, Some(near));
        }
    }
    left
}

/// Grid lines strictly inside, by curvature along the parameter.
fn lines(sheet: &Sheet<'_>, axis: Axis, options: &MeshOptions) -> Vec<f64> {
    let surface = &*sheet.face.surface;
    let breaks = surface.breaks(axis);
    let across = surface.domain().get(axis.other());
    let per_span = (MAX_LINES / breaks.len()).max(1);
    let mut out = vec![breaks[0]];
    for w in breaks.windows(2) {
        let width = w[1] - w[0];
        let (mut bend, mut speed, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
        for f in [0.02, 0.35, 0.65, 0.98] {
            for g in [0.02, 0.2, 0.4, 0.6, 0.8, 0.98] {
                let jet = surface.jet2(Uv::from_axis(axis, w[0] + f * width, across.at(g)));
                let (first, second) = if axis == Axis::U { (jet.du, jet.duu) } else { (jet.dv, jet.dvv) };
                // What bends out of the tangent plane counts; along it only the parameter changes its pace.
                let out_of_plane = jet.normal().map_or_else(|_| second.norm(), |n| second.dot(&n).abs());
                bend = bend.max(out_of_plane);
                speed = speed.max(first.norm());
                turn = turn.max(out_of_plane / first.norm().max(f64::MIN_POSITIVE));
            }
        }
        // Sagitta |S''| h^2 / 8, two thirds of the tolerance for each direction.
        let by_chord = width * (bend / (8.0 * 0.66 * options.chord_mm)).sqrt();
        let by_edge = options.max_edge_mm.map_or(0.0, |e| width * speed * std::f64::consts::SQRT_2 / e);
        let by_angle = options.angle_rad.map_or(0.0, |t| width * turn / t);
        let n = by_chord.max(by_edge).max(by_angle).ceil().clamp(1.0, per_span as f64) as usize;
        out.extend((1..=n).map(|k| if k == n { w[1] } else { w[0] + width * k as f64 / n as f64 }));
    }
    // Breaks of no curvature need no lines.
    if out.len() == breaks.len() && options.max_edge_mm.is_none() {
        let curved = |t: f64| {
            let jet = surface.jet2(Uv::from_axis(axis, t, across.at(0.4)));
            let second = if axis == Axis::U { jet.duu } else { jet.dvv };
            second.norm() * (breaks[breaks.len() - 1] - breaks[0]).powi(2) > 0.5 * options.chord_mm
        };
        if !breaks.windows(2).any(|w| curved(0.5 * (w[0] + w[1]))) {
            return Vec::new();
        }
    }
    out.pop();
    out.remove(0);
    out
}

fn grid(sheet: &mut Sheet<'_>, options: &MeshOptions) {
    let [us, vs] = [Axis::U, Axis::V].map(|axis| lines(sheet, axis, options));
    if us.is_empty() || vs.is_empty() {
        return;
    }
    let step = |lines: &[f64], k: usize, whole: f64| {
        let before = if k == 0 { None } else { Some(lines[k] - lines[k - 1]) };
        let after = lines.get(k + 1).map(|t| t - lines[k]);
        before.into_iter().chain(after).fold(whole, f64::min)
    };
    let d = sheet.chart.domain;
    let inside = sheet.inside();
    let mut points = Vec::new();
    for (i, u) in us.iter().enumerate() {
        for (j, v) in vs.iter().enumerate() {
            let at = uv(*u, *v);
            if !sheet.face.surface.contains(at) {
                continue;
            }
            let (du, dv) = (step(&us, i, d.u.length()), step(&vs, j, d.v.length()));
            let p = sheet.place(at);
            let q = sheet.place(uv(at.u + du, at.v + dv));
            let reach = CLEAR * (q.x - p.x).min(q.y - p.y);
            if clear(sheet, &inside, p, reach) {
                points.push(at);
            }
        }
    }
    for at in points {
        sheet.add(at, None);
    }
}

/// Whether a place is within a triangle of the inside and at least `reach` from the constraints around it. Looks at
/// the boundary only: called before any point inside is there.
fn clear(sheet: &Sheet<'_>, inside: &[bool], p: Point2<f64>, reach: f64) -> bool {
    let PositionInTriangulation::OnFace(f) = sheet.plane.locate(p) else { return false };
    if !inside[f.index()] {
        return false;
    }
    let face = sheet.plane.face(f);
    // The triangle's own sides and those of its neighbours: a longer way round is farther off.
    let around = face.adjacent_edges().into_iter().flat_map(|e| {
        let next = e.rev().face().as_inner().map(|n| n.adjacent_edges());
        std::iter::once(e).chain(next.into_iter().flatten())
    });
    around.into_iter().all(|e| {
        let far = if e.is_constraint_edge() {
            e.distance_2(p)
        } else {
            let [a, b] = e.vertices().map(|v| v.position());
            let gap = |q: Point2<f64>| (q.x - p.x).powi(2) + (q.y - p.y).powi(2);
            gap(a).min(gap(b))
        };
        far > reach * reach
    })
}

/// Parameters of points to insert, each with a vertex beside it, and the largest distance found, mm.
fn wanted(sheet: &Sheet<'_>, options: &MeshOptions) -> (Vec<(Uv, FixedVertexHandle)>, f64) {
    let inside = sheet.inside();
    let mut points = Vec::new();
    let mut worst = 0.0_f64;
    for edge in sheet.plane.undirected_edges() {
        if edge.is_constraint_edge() {
            continue;
        }
        let of_inside = edge.as_directed().face().as_inner().is_some_and(|f| inside[f.fix().index()]);
        let [a, b] = edge.vertices().map(|v| *v.data());
        if !of_inside || a.id == b.id || beside_flat(sheet, edge.as_directed().fix()) {
            continue;
        }
        let at = mean(sheet, [&a, &b]);
        let p = sheet.face.surface.point(at);
        let off = from_segment(&p, &a.point, &b.point);
        worst = worst.max(off);
        let long = options.max_edge_mm.is_some_and(|e| (a.point - b.point).norm() > e);
        let turned = options.angle_rad.is_some_and(|limit| {
            let normal = |n: &Node| sheet.face.surface.jet2(n.at).normal().ok();
            match (normal(&a), normal(&b)) {
                (Some(m), Some(n)) => m.angle(&n) > limit,
                _ => false,
            }
        });
        if off > options.chord_mm || long || turned {
            points.push((at, edge.as_directed().from().fix()));
        }
    }
    if !points.is_empty() {
        return (points, worst);
    }
    for face in sheet.plane.inner_faces().filter(|f| inside[f.fix().index()]) {
        let nodes = face.vertices().map(|v| *v.data());
        let [a, b, c] = nodes;
        if a.id == b.id || b.id == c.id || c.id == a.id || flat(sheet, face.fix()) {
            continue;
        }
        let at = mean(sheet, [&a, &b, &c]);
        let normal = (b.point - a.point).cross(&(c.point - a.point));
        let area = normal.norm();
        if area <= 0.0 {
            continue;
        }
        let p = sheet.face.surface.point(at);
        let off = (p - a.point).dot(&normal).abs() / area;
        worst = worst.max(off);
        if off > options.chord_mm {
            points.push((at, face.vertices()[0].fix()));
        }
    }
    (points, worst)
}

/// The mean of parameters. Of a pole only the parameter that leads to it counts: the other one has no meaning there.
fn mean<const N: usize>(sheet: &Sheet<'_>, nodes: [&Node; N]) -> Uv {
    let chart = sheet.chart;
    let one = |axis: Axis| {
        let across = usize::from(axis == Axis::U);
        let free = |n: &Node| {
            let t = n.at.get(axis.other());
            let i = chart.side(across);
            (chart.pole[across][0] && t == i.lo) || (chart.pole[across][1] && t == i.hi)
        };
        let bound: Vec<f64> = nodes.iter().filter(|n| !free(n)).map(|n| n.at.get(axis)).collect();
        if bound.is_empty() {
            nodes.iter().map(|n| n.at.get(axis)).sum::<f64>() / N as f64
        } else {
            bound.iter().sum::<f64>() / bound.len() as f64
        }
    };
    uv(one(Axis::U), one(Axis::V))
}

/// Whether a triangle has no height in the plane.
fn flat(sheet: &Sheet<'_>, face: Triangle) -> bool {
    let face = sheet.plane.face(face);
    let longest = face.adjacent_edges().into_iter().map(|e| e.length_2()).fold(0.0, f64::max).sqrt();
    2.0 * face.area() <= FLAT * longest
}

/// Whether the edge has a triangle without height on either side.
fn beside_flat(sheet: &Sheet<'_>, edge: spade::handles::FixedDirectedEdgeHandle) -> bool {
    let edge = sheet.plane.directed_edge(edge);
    [edge.face(), edge.rev().face()].into_iter().any(|f| f.as_inner().is_some_and(|f| flat(sheet, f.fix())))
}

/// Distance of `x` from the segment `p q`.
fn from_segment(x: &Point3, p: &Point3, q: &Point3) -> f64 {
    let d = q - p;
    let l2 = d.norm_squared();
    let t = if l2 > 0.0 { ((x - p).dot(&d) / l2).clamp(0.0, 1.0) } else { 0.0 };
    (p + d * t - x).norm()
}
