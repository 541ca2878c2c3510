//! The rim of a face as short pieces that know on which side of them the face is.

use crate::part::Face;
use crate::topology::{Chart, LocalEdge, local_edges};
use osculate_geom::{Point3, Side, Surface, Uv, Vec3, uv};

/// A piece with its polyline in the face's parameters.
pub(super) type Traced = (Bit, Vec<Uv>);

/// A short piece of a face's rim. Walked along, it has the face on its left, seen against the face's normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bit {
    /// The face's number.
    pub(super) face: usize,
    /// Both ends and the middle between them, on the face, mm.
    pub(super) points: [Point3; 3],
    /// Unit direction.
    pub(super) along: Vec3,
    /// Unit normal of the face in the middle.
    pub(super) normal: Vec3,
    /// Length of the chord, mm.
    pub(super) length_mm: f64,
}

/// Pieces of an edge at least: short edges have a say too.
const LEAST: usize = 3;
/// Pieces of an edge at most.
const MOST: usize = 1000;
/// Steps off the rim, as parts of a piece's length, at which the face is looked for: the first that finds it on one side only
/// counts. Loops go around arcs by tangents, so that the least steps may be outside on both sides.
const BESIDE: [f64; 4] = [0.01, 0.04, 0.15, 0.5];

/// The pieces of a face's rim, each about `step_mm` long. Where the face lies on both sides (seams and slits), or where it has no
/// normal, there is none.
pub(super) fn rim(number: usize, face: &Face, step_mm: f64) -> Vec<Traced> {
    let chart = Chart::new(face);
    let mut out = Vec::new();
    for edge in local_edges(face, &chart) {
        let wanted = edge.length_mm / step_mm;
        if wanted.is_finite() && wanted > 0.0 {
            let count = (wanted.ceil() as usize).clamp(LEAST, MOST);
            out.extend(bits(number, face, &chart, &edge, count));
        }
    }
    out
}

/// The pieces of one edge.
fn bits(number: usize, face: &Face, chart: &Chart, edge: &LocalEdge, count: usize) -> Vec<Traced> {
    let home = |at: Uv| {
        let shift = chart.shift(at);
        uv(at.u - shift.u, at.v - shift.v)
    };
    let surface = &*face.surface;
    // How far along each parameter is, mm.
    let mut reach = vec![0.0];
    let mut before = surface.point(home(edge.points[0]));
    for w in edge.points.windows(2) {
        let here = surface.point(home(w[1]));
        let step = (here - before).norm().max(chart.length_mm(w[0], w[1]) * f64::EPSILON);
        reach.push(reach[reach.len() - 1] + step);
        before = here;
    }
    let whole = reach[reach.len() - 1];
    let at = |f: f64| {
        let k = reach.partition_point(|r| *r < f * whole).clamp(1, reach.len() - 1);
        let (a, b) = (edge.points[k - 1], edge.points[k]);
        let step = reach[k] - reach[k - 1];
        let t = if step > 0.0 { ((f * whole - reach[k - 1]) / step).clamp(0.0, 1.0) } else { 0.5 };
        uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v))
    };
    let place = |k: usize| at(k as f64 / (2 * count) as f64);
    let points_between = |k: usize| {
        let [from, to] = [k, k + 1].map(|k| k as f64 / count as f64 * whole);
        let between = reach.iter().zip(&edge.points).filter(move |(r, _)| from < **r && **r < to);
        between.map(|(_, p)| *p)
    };
    (0..count)
        .filter_map(|k| {
            let middle = place(2 * k + 1);
            let points = [place(2 * k), middle, place(2 * k + 2)].map(|p| surface.point(home(p)));
            let chord = points[2] - points[0];
            let length_mm = chord.norm();
            if !(length_mm.is_finite() && length_mm > 0.0) {
                return None;
            }
            let jet = surface.jet2(home(middle));
            let normal = jet.normal().ok()?.into_inner();
            let natural = if jet.side == Side::Along { normal } else { -normal };
            let left = natural.cross(&(chord / length_mm));
            // The parameters' step along `left`, by the first form.
            let (e, f, g) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
            let det = e * g - f * f;
            let (p, q) = (jet.du.dot(&left), jet.dv.dot(&left));
            let step = uv((g * p - f * q) / det, (e * q - f * p) / det);
            if !(step.u.is_finite() && step.v.is_finite()) {
                return None;
            }
            let inside = |d: f64| surface.contains(home(uv(middle.u + d * step.u, middle.v + d * step.v)));
            let sense = BESIDE.iter().map(|b| b * length_mm).find_map(|d| match (inside(d), inside(-d)) {
                (true, false) => Some(1.0),
                (false, true) => Some(-1.0),
                _ => None,
            })?;
            let along = chord * (sense * jet.side.sign() / length_mm);
            let shift = chart.shift(middle);
            let traced = std::iter::once(place(2 * k)).chain(points_between(k)).chain([place(2 * k + 2)]);
            let traced = traced.map(|p| uv(p.u - shift.u, p.v - shift.v)).collect();
            Some((Bit { face: number, points, along, normal, length_mm }, traced))
        })
        .collect()
}

impl Bit {
    /// Direction in which the face leaves its rim.
    pub(super) fn inward(&self) -> Vec3 {
        self.normal.cross(&self.along)
    }

    /// Distance of a point from the two chords of the piece, mm, less what the rim may bulge out of them.
    pub(super) fn distance_mm(&self, p: &Point3) -> f64 {
        let [a, m, b] = &self.points;
        let bulge = (m - (a + (b - a) * 0.5)).norm();
        (segment(p, a, m).min(segment(p, m, b)) - 0.5 * bulge).max(0.0)
    }
}

/// Distance of a point from a segment, mm.
fn segment(p: &Point3, a: &Point3, b: &Point3) -> f64 {
    let d = b - a;
    let square = d.norm_squared();
    let t = if square > 0.0 { ((p - a).dot(&d) / square).clamp(0.0, 1.0) } else { 0.0 };
    (p - (a + d * t)).norm()
}
