//! The poles of a field as nodes over a face: places, areas and neighbours.

use super::pace::{Pace, paces};
use crate::plan::extended::Extended;
use crate::rectangle::{AXES, Rectangle, lengths};
use crate::spline::Spline;
use osculate_geom::{
    Axis, Darboux, Forms, Jet2, Point3, Side, Surface, Unit3, Uv, Vec3, any_perpendicular, uv,
};
use rayon::prelude::*;

/// Distance of nodes, in radii of the tool: a tool sees no more of what stands around it. Fewest and most along a parameter, and
/// most of all.
const APART: f64 = 0.5;
const ALONG: [f64; 2] = [8.0, 96.0];
const NODES: f64 = 2000.0;
/// Share of its area that a place beyond the border counts for.
const BEYOND: f64 = 0.25;

/// The direction in which passes run at a place, in either sense; None where there is none.
pub type Feed<'a> = dyn Fn(Uv, &Jet2) -> Option<Vec3> + Sync + 'a;

/// A pole of the field and the place that it stands over.
#[derive(Clone)]
pub(super) struct Node {
    pub at: Uv,
    pub point: Point3,
    /// Outward normal, the mean of what stands around where the face is rough; None where the face has none.
    pub normal: Option<Unit3>,
    /// Whether the face is rough there.
    pub rough: bool,
    /// The forms and the frame of the passes; None where these have no direction.
    pub frame: Option<(Forms, Darboux)>,
    /// Whether passes may stand there: beyond the border of the face too.
    pub stood: bool,
    /// Area of the face that it stands for, mm2.
    pub area_mm2: f64,
    /// Area that it counts for: what lies beyond the border counts a little too.
    pub weight_mm2: f64,
}

/// Two neighbouring nodes.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub ends: [usize; 2],
    pub length_mm: f64,
    /// Length across it of what it stands for, mm.
    pub across_mm: f64,
    /// How far passes run along it, as a cosine.
    pub along: f64,
}

/// The nodes over a face.
#[derive(Clone)]
pub(super) struct Lattice {
    pub rectangle: Rectangle,
    pub paces: [Pace; 2],
    pub spline: Spline<Vec3>,
    pub nodes: Vec<Node>,
    pub edges: Vec<Edge>,
    /// For each node its edges, by their place among all.
    pub of_node: Vec<Vec<u32>>,
}

/// Places to each side that the normal of a rough place is the mean of.
const AROUND: i32 = 2;
/// A normal that is so far from the mean around it is that of a rough place, rad.
const ROUGH_RAD: f64 = 0.15;

/// The normal at a place of a face, and whether the face is rough there: then it is the mean of those around it, up to `look_mm` to each
/// side. None where there is none.
pub(super) fn steady_normal(
    surface: &dyn Surface,
    at: Uv,
    jet: &Jet2,
    look_mm: f64,
) -> Option<(Unit3, bool)> {
    let normal = jet.normal().ok();
    let step = [jet.du, jet.dv].map(|d| look_mm / f64::from(AROUND) / d.norm().max(f64::MIN_POSITIVE));
    let domain = surface.domain();
    let mut sum = Vec3::zeros();
    for (i, j) in (-AROUND..=AROUND).flat_map(|i| (-AROUND..=AROUND).map(move |j| (i, j))) {
        // Where a face has no width along a parameter all of it is next to the place.
        let t = [step[0] * f64::from(i), step[1] * f64::from(j)];
        let next = |axis: Axis, by: f64| {
            let (x, i) = (at.get(axis) + by, domain.get(axis));
            if i.periodic { x } else { x.clamp(i.lo, i.hi) }
        };
        let near = surface.jet2(uv(next(Axis::U, t[0]), next(Axis::V, t[1])));
        sum += near.normal().map_or_else(|_| Vec3::zeros(), Unit3::into_inner);
    }
    let mean = Unit3::try_new(sum, 1e-6);
    match (normal, mean) {
        (Some(normal), Some(mean)) if normal.angle(&mean) > ROUGH_RAD => Some((mean, true)),
        (Some(normal), _) => Some((normal, false)),
        (None, mean) => mean.map(|mean| (mean, true)),
    }
}

/// The plane at right angles to a normal at a place.
fn flat(jet: &Jet2, normal: &Unit3) -> Jet2 {
    let du = any_perpendicular(normal).into_inner();
    let none = Vec3::zeros();
    Jet2 { du, dv: normal.cross(&du), duu: none, duv: none, dvv: none, side: Side::Along, ..*jet }
}

impl Lattice {
    /// The nodes over a face for passes that run out by `beyond_mm` at most; what is narrower than `look_mm` counts as rough.
    pub fn new(surface: &Extended<'_>, radius_mm: f64, (beyond_mm, look_mm): (f64, f64)) -> Self {
        let rectangle = Rectangle::of(surface);
        let long = lengths(surface, &rectangle);
        let side = (APART * radius_mm).max((long[0] * long[1] / NODES).sqrt());
        let (paces, spans) = paces(surface, &rectangle, side);
        let many = (NODES / (spans[0] * spans[1])).min(1.0).sqrt();
        let spans = spans.map(|n| (many * n).clamp(ALONG[0], ALONG[1]).ceil() as usize);
        let spline = Spline::constant(&rectangle, spans, Vec3::z());
        let spans = spline.bases.map(|b| b.spans);
        let counts = spline.bases.map(|b| b.count());
        // Poles stand over the corners of cells, one row of them outside.
        let part = |k: usize, axis: usize| {
            let n = spans[axis] as f64;
            let x = k as f64 - 1.0;
            if rectangle.closes[axis] { x.rem_euclid(n) / n } else { (x / n).clamp(0.0, 1.0) }
        };
        let outer = |k: usize, axis: usize| !rectangle.closes[axis] && (k == 0 || k + 1 == counts[axis]);
        let cell = AXES.map(|axis| rectangle.domain.get(axis).length());
        let cell = [cell[0] / spans[0] as f64, cell[1] / spans[1] as f64];
        let nodes: Vec<Node> = (0..counts[0] * counts[1])
            .into_par_iter()
            .map(|k| {
                let (i, j) = (k / counts[1], k % counts[1]);
                let stretched = rectangle.domain.at(part(i, 0), part(j, 1));
                let at = uv(paces[0].back(stretched.u), paces[1].back(stretched.v));
                let cell = [cell[0] / paces[0].at(at.u).1, cell[1] / paces[1].at(at.v).1];
                let jet = surface.jet2(at);
                let inside = surface.contains(at);
                let whole = jet.du.cross(&jet.dv).norm() * cell[0] * cell[1];
                let border = |k: usize, axis: usize| {
                    let ends = [1, counts[axis] - 2];
                    if !rectangle.closes[axis] && ends.contains(&k) { 0.5 } else { 1.0 }
                };
                let share = if outer(i, 0) || outer(j, 1) { 0.0 } else { border(i, 0) * border(j, 1) };
                let steady = steady_normal(surface, at, &jet, look_mm);
                Node {
                    at,
                    point: jet.point,
                    normal: steady.map(|(normal, _)| normal),
                    rough: steady.is_some_and(|(_, rough)| rough),
                    frame: None,
                    stood: surface.contains(surface.inner(at)),
                    area_mm2: if inside { share * whole } else { 0.0 },
                    weight_mm2: whole * if inside { share.max(BEYOND) } else { BEYOND },
                }
            })
            .collect();
        let mut lattice = Self { rectangle, paces, spline, nodes, edges: Vec::new(), of_node: Vec::new() };
        lattice.joined(surface, cell);
        for _ in 0..(beyond_mm / side).ceil() as usize {
            lattice.widened();
        }
        lattice
    }

    /// The nodes for passes that run along a direction.
    pub fn along(&self, surface: &Extended<'_>, feed: &Feed<'_>) -> Self {
        let mut out = self.clone();
        out.nodes.par_iter_mut().for_each(|node| {
            let jet = surface.jet2(node.at);
            // The curvatures of a rough place say nothing of the strip there: it counts as flat.
            let seen = node.normal.filter(|_| node.rough).map_or(jet, |normal| flat(&jet, &normal));
            node.frame = seen.forms().ok().zip(feed(node.at, &jet)).and_then(|(forms, way)| {
                let frame = Darboux::with_forms(&seen, &forms, &way, 0.0);
                frame.tangent.iter().all(|x| x.is_finite()).then_some((forms, frame))
            });
        });
        for e in &mut out.edges {
            let [a, b] = e.ends.map(|k| &out.nodes[k]);
            let way = Unit3::try_new(b.point - a.point, f64::MIN_POSITIVE);
            let tangent = a.frame.as_ref().map(|(_, f)| f.tangent);
            e.along = way.zip(tangent).map_or(0.0, |(way, t)| t.dot(&way).abs().min(1.0));
        }
        out
    }

    /// Has tools stand at the neighbours of all nodes that they stand at.
    fn widened(&mut self) {
        let stood: Vec<bool> = self.nodes.iter().map(|n| n.stood).collect();
        for e in &self.edges {
            let [a, b] = e.ends;
            self.nodes[a].stood |= stood[b];
            self.nodes[b].stood |= stood[a];
        }
    }

    /// Whether passes may stand at a place.
    pub fn stands(&self, at: Uv) -> bool {
        self.nodes[self.nearest(at)].stood
    }

    /// The node next to a place of the rectangle.
    pub fn nearest(&self, at: Uv) -> usize {
        let near = AXES.map(|axis| {
            let k = usize::from(axis == Axis::V);
            let (i, basis) = (self.rectangle.domain.get(axis), &self.spline.bases[k]);
            let x = (self.paces[k].at(at.get(axis)).0 - i.lo) / i.length() * basis.spans as f64;
            // Within the rectangle: no more than the spans.
            let k = x.round().clamp(0.0, basis.spans as f64) as usize;
            if self.rectangle.closes(axis) { (k + 1) % basis.count() } else { k + 1 }
        });
        self.spline.index(near[0], near[1])
    }

    /// Finds the edges between neighbouring nodes.
    fn joined(&mut self, surface: &dyn Surface, cell: [f64; 2]) {
        let counts = self.spline.bases.map(|b| b.count());
        self.of_node = vec![Vec::new(); self.nodes.len()];
        for k in 0..self.nodes.len() {
            let at = [k / counts[1], k % counts[1]];
            let place = self.nodes[k].at;
            let jet = surface.jet2(place);
            let speeds = [self.paces[0].at(place.u).1, self.paces[1].at(place.v).1];
            let sides = [jet.du * (cell[0] / speeds[0]), jet.dv * (cell[1] / speeds[1])];
            for axis in 0..2 {
                let mut next = at;
                next[axis] += 1;
                if next[axis] == counts[axis] {
                    if !self.rectangle.closes[axis] {
                        continue;
                    }
                    next[axis] = 0;
                }
                let end = next[0] * counts[1] + next[1];
                let [length_mm, across_mm] = [sides[axis].norm(), sides[1 - axis].norm()];
                let place = self.edges.len() as u32;
                self.edges.push(Edge { ends: [k, end], length_mm, across_mm, along: 0.0 });
                self.of_node[k].push(place);
                self.of_node[end].push(place);
            }
        }
    }

    /// Places at equal parts of the cells, `parts` of them along each side, and how many that makes along u and along v; v grows first.
    pub fn between(&self, parts: usize) -> ([usize; 2], Vec<Uv>) {
        let counts = self.spline.bases.map(|b| parts * b.spans + 1);
        let part = |k: usize, axis: usize| k as f64 / (counts[axis] - 1) as f64;
        let all = (0..counts[0] * counts[1]).map(|k| (k / counts[1], k % counts[1]));
        let at = all.map(|(i, j)| self.rectangle.domain.at(part(i, 0), part(j, 1)));
        (counts, at.map(|at| uv(self.paces[0].back(at.u), self.paces[1].back(at.v))).collect())
    }
}
