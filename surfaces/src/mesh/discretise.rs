//! Edges cut into chords, once for all faces that they bound.
//!
//! From dense samples those are kept that the chord tolerance needs [Douglas and Peucker 1973], together with the places
//! where the edge crosses a closing side of some face's rectangle: there the face is cut open.

use super::options::MeshOptions;
use crate::part::Face;
use crate::topology::{Course, Follower, Spacing, Topology, Wrapped, on_polyline};
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::{Point3, Uv, uv};

/// The points of an edge along its course.
#[derive(Clone, Debug)]
pub(super) struct EdgePoints {
    /// Vertex numbers in the mesh.
    pub(super) ids: Vec<usize>,
    /// The points, mm.
    pub(super) points: Vec<Point3>,
    /// Fractions of the length.
    pub(super) fractions: Vec<f64>,
    /// Parameters that are known exactly: face, edge of the face, index, parameters.
    pub(super) known: Vec<Known>,
}

/// Exact parameters of a point of an edge on a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub(super) face: usize,
    pub(super) local: usize,
    pub(super) index: usize,
    pub(super) at: Uv,
}

impl EdgePoints {
    /// The points between the ends, which are vertices of the part.
    pub(super) fn inner(&self) -> &[Point3] {
        &self.points[1..self.points.len() - 1]
    }
}

/// A place where an edge crosses a closing side of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeamCrossing {
    face: usize,
    local: usize,
    edge: usize,
    at: Uv,
    point: Point3,
}

/// All crossings of edges with closing sides.
pub(super) fn seam_crossings(faces: &[Face], topology: &Topology) -> Vec<SeamCrossing> {
    let mut out = Vec::new();
    for (face, of) in topology.faces.iter().enumerate() {
        for axis in (0..2).filter(|k| of.chart.closes[*k]) {
            let i = of.chart.side(axis);
            let value = |p: Uv| (if axis == 0 { p.u - i.lo } else { p.v - i.lo }) / i.length();
            for (local, (e, on)) in of.local.iter().zip(&of.uses).enumerate() {
                let Some(edge) = on.edge else { continue };
                for (k, w) in e.points.windows(2).enumerate() {
                    let (a, b) = (value(w[0]), value(w[1]));
                    let (lo, hi) = (a.min(b), a.max(b));
                    // A hair inside, so that an end on the side is no crossing.
                    let hair = 1e-9;
                    let (first, last) = ((lo + hair).ceil(), (hi - hair).floor());
                    let mut turn = first;
                    while turn <= last && turn - first < 64.0 {
                        let f = (turn - a) / (b - a);
                        let mut at = on_polyline(&e.points, k as f64 + f);
                        let exact = i.lo + turn * i.length();
                        if axis == 0 {
                            at.u = exact
                        } else {
                            at.v = exact
                        }
                        let shift = of.chart.shift(uv(at.u + 0.5 * hair, at.v));
                        let inside = uv(at.u - shift.u, at.v - shift.v);
                        let point = osculate_geom::Surface::point(&*faces[face].surface, inside);
                        out.push(SeamCrossing { face, local, edge, at, point });
                        turn += 1.0;
                    }
                    // A corner of the polyline on the side is a crossing as well.
                    if k > 0 && (a - a.round()).abs() <= hair {
                        let at = w[0];
                        let shift = of.chart.shift(at);
                        let inside = uv(at.u - shift.u, at.v - shift.v);
                        let point = osculate_geom::Surface::point(&*faces[face].surface, inside);
                        out.push(SeamCrossing { face, local, edge, at, point });
                    }
                }
            }
        }
    }
    out
}

/// Cuts all edges; vertex numbers of inner points begin at `first`.
pub(super) fn edges(
    topology: &Topology,
    crossings: &[SeamCrossing],
    chord_mm: &[f64],
    options: &MeshOptions,
    first: usize,
) -> Vec<EdgePoints> {
    let mut next = first;
    topology
        .edges
        .iter()
        .enumerate()
        .map(|(number, edge)| {
            let here: Vec<&SeamCrossing> = crossings.iter().filter(|c| c.edge == number).collect();
            let mut cut = cut(&edge.course, &here, chord_mm[number], options, edge.vertices);
            cut.points[0] = topology.vertices[edge.vertices[0]];
            let last = cut.points.len() - 1;
            cut.points[last] = topology.vertices[edge.vertices[1]];
            cut.ids = (0..=last)
                .map(|k| match k {
                    0 => edge.vertices[0],
                    _ if k == last => edge.vertices[1],
                    _ => {
                        next += 1;
                        next - 1
                    }
                })
                .collect();
            cut
        })
        .collect()
}

/// Chords of an edge that begins and ends at one vertex: fewer enclose nothing.
const CLOSED_CHORDS: usize = 4;

fn cut(
    course: &Course,
    crossings: &[&SeamCrossing],
    chord_mm: f64,
    options: &MeshOptions,
    vertices: [usize; 2],
) -> EdgePoints {
    let long = options.max_edge_mm.unwrap_or(f64::INFINITY);
    let mut dense = course.samples(Spacing { chord_mm: 0.05 * chord_mm, length_mm: 0.25 * long });
    let mut keep = vec![false; dense.len()];
    // Crossings become samples of their own, or take the sample at hand.
    let mut forced: Vec<(f64, &SeamCrossing)> = Vec::new();
    for c in crossings {
        let t = nearest(course, &dense, &c.point);
        let at = dense.partition_point(|s| s.0 < t);
        let beside = [at.saturating_sub(1), at.min(dense.len() - 1)];
        let hit = beside.into_iter().find(|k| (dense[*k].0 - t).abs() <= 1e-9);
        match hit {
            Some(k) => {
                keep[k] = true;
                forced.push((dense[k].0, c));
            }
            None => {
                dense.insert(at, (t, course.point(t)));
                keep.insert(at, true);
                forced.push((t, c));
            }
        }
    }
    let last = dense.len() - 1;
    keep[0] = true;
    keep[last] = true;
    if vertices[0] == vertices[1] {
        for k in 1..CLOSED_CHORDS {
            keep[k * last / CLOSED_CHORDS] = true;
        }
    }
    let fixed: Vec<usize> = (0..=last).filter(|k| keep[*k]).collect();
    let mut pending: Vec<[usize; 2]> = fixed.windows(2).map(|w| [w[0], w[1]]).collect();
    while let Some([a, b]) = pending.pop() {
        if b - a < 2 {
            continue;
        }
        let (p, q) = (dense[a].1, dense[b].1);
        let far = (a + 1..b)
            .map(|k| (off_chord(&dense[k].1, &p, &q), k))
            .max_by(|x, y| x.0.total_cmp(&y.0))
            .unwrap_or((0.0, a + 1));
        let bent = options.angle_rad.is_some_and(|limit| {
            let (from, to) = (dense[a + 1].1 - p, q - dense[b - 1].1);
            from.angle(&to) > limit
        });
        // The dense samples are themselves off by a part of the tolerance.
        let middle = if far.0 > 0.9 * chord_mm {
            Some(far.1)
        } else if bent || (q - p).norm() > long {
            Some((a + b) / 2)
        } else {
            None
        };
        if let Some(m) = middle {
            keep[m] = true;
            pending.push([a, m]);
            pending.push([m, b]);
        }
    }
    let mut lengths = vec![0.0];
    for w in dense.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (w[1].1 - w[0].1).norm());
    }
    let whole = lengths[last].max(f64::MIN_POSITIVE);
    let kept: Vec<usize> = (0..=last).filter(|k| keep[*k]).collect();
    let known = forced
        .iter()
        .filter_map(|(t, c)| {
            let index = kept.iter().position(|k| dense[*k].0 == *t)?;
            Some(Known { face: c.face, local: c.local, index, at: c.at })
        })
        .collect();
    EdgePoints {
        ids: Vec::new(),
        points: kept.iter().map(|k| dense[*k].1).collect(),
        fractions: kept.iter().map(|k| lengths[*k] / whole).collect(),
        known,
    }
}

/// Distance of `x` from the chord `p q`.
fn off_chord(x: &Point3, p: &Point3, q: &Point3) -> f64 {
    let d = q - p;
    let l2 = d.norm_squared();
    let t = if l2 > 0.0 { ((x - p).dot(&d) / l2).clamp(0.0, 1.0) } else { 0.0 };
    (p + d * t - x).norm()
}

/// The parameter of the course nearest to a point: the best chord of the samples, then the minimum along it.
fn nearest(course: &Course, dense: &[(f64, Point3)], p: &Point3) -> f64 {
    let best = (1..dense.len())
        .min_by(|a, b| {
            let d = |k: usize| off_chord(p, &dense[k - 1].1, &dense[k].1);
            d(*a).total_cmp(&d(*b))
        })
        .unwrap_or(1);
    let ends = [dense[best - 1].0, dense[best].0];
    let t = minimum(ends, FLAT, |t| (course.point(t) - p).norm_squared()).x;
    // The ends are met exactly where they are as near.
    ends.into_iter()
        .find(|end| (course.point(*end) - p).norm() <= (course.point(t) - p).norm() + 1e-12 * p.coords.norm())
        .unwrap_or(t)
}

/// The parameters of an edge's points on one of its faces, in the edge's own order.
pub(super) fn on_face(
    face: &Face,
    number: usize,
    local: usize,
    topology: &Topology,
    edges: &[EdgePoints],
    chord_mm: f64,
) -> Option<(Vec<usize>, Vec<Uv>)> {
    let of = &topology.faces[number];
    let edge = of.uses[local].edge?;
    let forward = of.uses[local].forward;
    let cut = &edges[edge];
    let polyline = &of.local[local].points;
    let carrier = Wrapped::new(face, &of.chart);
    let spacing = Spacing { chord_mm: 0.05 * chord_mm, length_mm: f64::INFINITY };
    let follower = Follower::new(&carrier, polyline, spacing);
    let n = cut.points.len();
    let mut out = Vec::with_capacity(n);
    let mut from = 0.0;
    // In the sense of the use, so that the parameter only grows.
    for step in 0..n {
        let k = if forward { step } else { n - 1 - step };
        let at = if step == 0 {
            polyline[0]
        } else if step == n - 1 {
            polyline[polyline.len() - 1]
        } else if let Some(known) =
            cut.known.iter().find(|c| c.face == number && c.local == local && c.index == k)
        {
            known.at
        } else {
            let f = if forward { cut.fractions[k] } else { 1.0 - cut.fractions[k] };
            from = follower.place(&cut.points[k], f, from);
            on_polyline(polyline, from)
        };
        out.push((cut.ids[k], at));
    }
    Some(out.into_iter().unzip())
}
