//! The boundary of a face in its parameter rectangle: chords of its edges, closing sides and poles.
//!
//! A closing side appears twice, with the same vertices on both; a pole is a line of parameters with a single vertex.
//! What lies beyond a trim is cut away later, so that sides are drawn in full.

use super::discretise::{EdgePoints, on_face};
use super::options::MeshOptions;
use crate::part::Face;
use crate::topology::{Chart, Topology};
use osculate_geom::{Axis, Point3, Surface, Uv, uv};
use std::collections::HashMap;

/// A boundary vertex: parameters and number in the mesh. Numbers at or above the count of shared vertices are the
/// face's own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) at: Uv,
    pub(super) id: usize,
}

/// Boundary segments between corners.
pub(super) struct Outline {
    pub(super) corners: Vec<Corner>,
    /// Pairs of corners, with the edge that they are a chord of.
    pub(super) segments: Vec<([usize; 2], Option<usize>)>,
    /// Vertices of the face's own, numbered behind the shared ones.
    pub(super) own: Vec<Point3>,
    /// How many vertices are shared.
    pub(super) shared: usize,
    /// The corners of each vertex.
    by_id: HashMap<usize, Vec<usize>>,
}

/// Parameters within this fraction of a side are on it.
const ON_SIDE: f64 = 1e-7;

/// Parameter values closer than this fraction of the rectangle are made equal, so that points of a straight
/// parameter line stand on it exactly and no flat triangle fits between them.
const SAME_VALUE: f64 = 1e-9;

/// Ends of neighbouring edges at one vertex are one corner within this fraction of the face's size.
const SAME_CORNER: f64 = 2e-4;

impl Outline {
    pub(super) fn new(
        face: &Face,
        number: usize,
        topology: &Topology,
        edges: &[EdgePoints],
        options: &MeshOptions,
    ) -> Self {
        let of = &topology.faces[number];
        let chart = &of.chart;
        let shared = topology.vertices.len() + edges.iter().map(|e| e.inner().len()).sum::<usize>();
        let mut outline = Self {
            corners: Vec::new(),
            segments: Vec::new(),
            own: Vec::new(),
            shared,
            by_id: HashMap::new(),
        };
        let mut pieces: Vec<([Corner; 2], Option<usize>)> = Vec::new();
        for local in 0..of.local.len() {
            let on = of.uses[local];
            let (ids, places) = on_face(face, number, local, topology, edges, options.chord_mm)
                .unwrap_or_else(|| {
                    let points = of.local[local].points.clone();
                    (vec![on.vertices[0]; points.len()], points)
                });
            for k in 1..ids.len() {
                let (a, b) = (places[k - 1], places[k]);
                let shift = chart.shift(uv(0.5 * (a.u + b.u), 0.5 * (a.v + b.v)));
                let corner =
                    |p: Uv, id: usize| Corner { at: settled(chart, uv(p.u - shift.u, p.v - shift.v)), id };
                pieces.push(([corner(a, ids[k - 1]), corner(b, ids[k])], on.edge));
            }
        }
        for axis in [0, 1] {
            level(chart, axis, &mut pieces);
        }
        outline.sides(face, chart, &mut pieces, options);
        for (ends, edge) in pieces {
            let [a, b] = ends.map(|c| outline.corner(chart, c));
            if a != b {
                outline.segments.push(([a, b], edge));
            }
        }
        outline
    }

    /// The number of a corner, the same for corners of one vertex at one place.
    fn corner(&mut self, chart: &Chart, c: Corner) -> usize {
        let slack = SAME_CORNER * chart.size_mm;
        let of_vertex = self.by_id.entry(c.id).or_default();
        let found = of_vertex.iter().copied().find(|k| {
            let at = self.corners[*k].at;
            let near = chart.length_mm(at, c.at) <= slack;
            at == c.at || (near && !on_pole(chart, at) && !on_pole(chart, c.at))
        });
        found.unwrap_or_else(|| {
            of_vertex.push(self.corners.len());
            self.corners.push(c);
            self.corners.len() - 1
        })
    }

    fn own_vertex(&mut self, p: Point3) -> usize {
        self.own.push(p);
        self.shared + self.own.len() - 1
    }

    /// Adds closing sides and poles to the pieces.
    fn sides(
        &mut self,
        face: &Face,
        chart: &Chart,
        pieces: &mut Vec<([Corner; 2], Option<usize>)>,
        options: &MeshOptions,
    ) {
        // Poles first: their vertex is the end of a closing side.
        let mut poles: Vec<([usize; 2], usize)> = Vec::new();
        for [k, end] in ENDS.into_iter().filter(|[k, end]| chart.pole[*k][*end]) {
            let side = end_of(chart, k, end);
            let met = pieces.iter().flat_map(|p| &p.0).find(|c| get(c.at, k) == side).map(|c| c.id);
            let id = met.unwrap_or_else(|| {
                self.own_vertex(face.surface.point(on_side(chart, k, end, chart.side(1 - k).lo)))
            });
            poles.push(([k, end], id));
        }
        let pole = |k: usize, end: usize| poles.iter().find(|p| p.0 == [k, end]).map(|p| p.1);
        // A torus has one corner.
        let both = chart.closes == [true, true];
        let mut common: Option<usize> = None;
        for k in 0..2 {
            if !chart.closes[k] {
                continue;
            }
            let across = chart.side(1 - k);
            let mut stops: Vec<(f64, usize)> = pieces
                .iter()
                .flat_map(|p| &p.0)
                .filter(|c| get(c.at, k) == chart.side(k).lo || get(c.at, k) == chart.side(k).hi)
                .map(|c| (get(c.at, 1 - k), c.id))
                .collect();
            for (end, t) in [across.lo, across.hi].into_iter().enumerate() {
                if stops.iter().any(|s| s.0 == t) {
                    continue;
                }
                let opposite = if end == 0 { across.hi } else { across.lo };
                let id = match pole(1 - k, end) {
                    Some(id) => id,
                    None if both => {
                        let at_corner = stops.iter().find(|s| s.0 == opposite).map(|s| s.1).or(common);
                        at_corner
                            .unwrap_or_else(|| self.own_vertex(face.surface.point(chart.domain.at(0.0, 0.0))))
                    }
                    None => self.own_vertex(face.surface.point(on_side(chart, k, 0, t))),
                };
                stops.push((t, id));
            }
            stops.sort_by(|a, b| a.0.total_cmp(&b.0));
            stops.dedup_by(|b, a| b.0 == a.0);
            if both {
                common = Some(stops[0].1);
            }
            let covered: Vec<[f64; 2]> = pieces
                .iter()
                .filter(|p| {
                    p.1.is_some()
                        && p.0.iter().all(|c| {
                            let t = get(c.at, k);
                            t == chart.side(k).lo || t == chart.side(k).hi
                        })
                        && get(p.0[0].at, k) == get(p.0[1].at, k)
                })
                .map(|p| {
                    let (a, b) = (get(p.0[0].at, 1 - k), get(p.0[1].at, 1 - k));
                    [a.min(b), a.max(b)]
                })
                .collect();
            let mut along: Vec<(f64, usize)> = vec![stops[0]];
            for w in stops.windows(2) {
                let (a, b) = (w[0].0, w[1].0);
                let middle = 0.5 * (a + b);
                let is_edge = covered.iter().any(|c| c[0] < middle && middle < c[1]);
                let parts = if is_edge { 1 } else { parts(face, chart, k, [a, b], options) };
                for j in 1..parts {
                    let t = a + (b - a) * j as f64 / parts as f64;
                    let id = self.own_vertex(face.surface.point(on_side(chart, k, 0, t)));
                    along.push((t, id));
                }
                along.push(w[1]);
            }
            for w in along.windows(2) {
                for end in 0..2 {
                    let ends = [w[0], w[1]].map(|s| Corner { at: on_side(chart, k, end, s.0), id: s.1 });
                    pieces.push((ends, None));
                }
            }
        }
        for ([k, end], id) in poles {
            pole_line(chart, [k, end], id, pieces);
        }
    }
}

/// The ends of both parameters: which parameter, which end.
const ENDS: [[usize; 2]; 4] = [[0, 0], [0, 1], [1, 0], [1, 1]];

/// Pieces that a pole is cut into at least. Its parameters are free: as many as give triangles of fair shape.
const POLE_PIECES: f64 = 16.0;

/// Adds the line of parameters that is one point.
fn pole_line(chart: &Chart, [k, end]: [usize; 2], id: usize, pieces: &mut Vec<([Corner; 2], Option<usize>)>) {
    let across = chart.side(1 - k);
    let side = end_of(chart, k, end);
    let on = pieces.iter().flat_map(|p| &p.0).filter(|c| get(c.at, k) == side).map(|c| get(c.at, 1 - k));
    let mut stops: Vec<f64> = on.chain([across.lo, across.hi]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    let step = across.length() / POLE_PIECES;
    let mut along = vec![stops[0]];
    for w in stops.windows(2) {
        let n = ((w[1] - w[0]) / step).ceil().max(1.0) as usize;
        along.extend((1..=n).map(|j| if j == n { w[1] } else { w[0] + (w[1] - w[0]) * j as f64 / n as f64 }));
    }
    for w in along.windows(2) {
        let ends = [w[0], w[1]].map(|t| Corner { at: on_side(chart, k, end, t), id });
        pieces.push((ends, None));
    }
}

/// Pieces of a closing side between two stops, for chord, angle and length.
fn parts(face: &Face, chart: &Chart, k: usize, [a, b]: [f64; 2], options: &MeshOptions) -> usize {
    let axis = if k == 0 { Axis::V } else { Axis::U };
    let (mut bend, mut speed, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
    for f in [0.02, 0.2, 0.4, 0.6, 0.8, 0.98] {
        let jet = face.surface.jet2(on_side(chart, k, 0, a + f * (b - a)));
        let (first, second) = if axis == Axis::U { (jet.du, jet.duu) } else { (jet.dv, jet.dvv) };
        bend = bend.max(second.norm());
        speed = speed.max(first.norm());
        turn = turn.max(first.cross(&second).norm() / first.norm_squared().max(f64::MIN_POSITIVE));
    }
    let by_chord = (b - a) * (bend / (8.0 * 0.9 * options.chord_mm)).sqrt();
    let by_edge = options.max_edge_mm.map_or(0.0, |e| (b - a) * speed / e);
    let by_angle = options.angle_rad.map_or(0.0, |t| (b - a) * turn / t);
    // Spans of a spline are crossed at their own places.
    let breaks = face.surface.breaks(axis).iter().filter(|t| **t > a && **t < b).count() as f64;
    by_chord.max(by_edge).max(by_angle).max((breaks + 1.0).min(3.0)).ceil().clamp(1.0, 4096.0) as usize
}

fn get(p: Uv, k: usize) -> f64 {
    if k == 0 { p.u } else { p.v }
}

fn end_of(chart: &Chart, k: usize, end: usize) -> f64 {
    let i = chart.side(k);
    if end == 0 { i.lo } else { i.hi }
}

fn on_side(chart: &Chart, k: usize, end: usize, across: f64) -> Uv {
    let t = end_of(chart, k, end);
    if k == 0 { uv(t, across) } else { uv(across, t) }
}

fn on_pole(chart: &Chart, p: Uv) -> bool {
    (0..2).any(|k| (0..2).any(|end| chart.pole[k][end] && get(p, k) == end_of(chart, k, end)))
}

/// Parameters put onto a side that they are a hair from.
fn settled(chart: &Chart, p: Uv) -> Uv {
    let one = |t: f64, k: usize| {
        let i = chart.side(k);
        let slack = ON_SIDE * i.length();
        if (t - i.lo).abs() <= slack {
            i.lo
        } else if (t - i.hi).abs() <= slack {
            i.hi
        } else {
            t
        }
    };
    uv(one(p.u, 0), one(p.v, 1))
}

/// Makes parameter values equal that differ by rounding.
fn level(chart: &Chart, k: usize, pieces: &mut [([Corner; 2], Option<usize>)]) {
    let slack = SAME_VALUE * chart.side(k).length();
    let mut values: Vec<f64> = pieces.iter().flat_map(|p| p.0.map(|c| get(c.at, k))).collect();
    values.extend([chart.side(k).lo, chart.side(k).hi]);
    values.sort_by(f64::total_cmp);
    // The first value of a run stands for all; a side stands for what is near it.
    let mut runs: Vec<(f64, f64)> = Vec::new();
    for t in values {
        match runs.last_mut() {
            Some(run) if t - run.0 <= slack => {
                if t == chart.side(k).lo || t == chart.side(k).hi {
                    run.1 = t;
                }
            }
            _ => runs.push((t, t)),
        }
    }
    for c in pieces.iter_mut().flat_map(|p| &mut p.0) {
        let at = runs.partition_point(|r| r.0 <= get(c.at, k));
        let value = runs[at.saturating_sub(1)].1;
        match k {
            0 => c.at.u = value,
            _ => c.at.v = value,
        }
    }
}
