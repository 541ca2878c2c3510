//! The edges of one face: those of its file, or stretches of its loops.

use super::chart::{Chart, Wrapped};
use super::course::{Course, Spacing};
use super::isoline;
use crate::part::Face;
use osculate_geom::{Point3, Surface, Uv};
use std::sync::Arc;

/// An edge as a face has it.
#[derive(Clone)]
pub(crate) struct LocalEdge {
    /// Identity in the file.
    pub(crate) key: Option<u64>,
    /// The loop it belongs to.
    pub(crate) owner: usize,
    /// Its way, in the sense of the loop.
    pub(crate) course: Course,
    /// Carrier parameters along it.
    pub(crate) points: Vec<Uv>,
    /// Points at both ends.
    pub(crate) ends: [Point3; 2],
    /// Points at a quarter, half and three quarters of its length.
    pub(crate) middles: [Point3; 3],
    /// Length, mm.
    pub(crate) length_mm: f64,
}

/// Chords of the samples that lengths and middles are taken from, as a part of the face's size: their lengths are
/// then right to about a thousandth.
const CHORD: f64 = 1e-4;

impl LocalEdge {
    fn new(key: Option<u64>, owner: usize, course: Course, points: Vec<Uv>, size_mm: f64) -> Self {
        let samples = course.samples(Spacing { chord_mm: CHORD * size_mm, length_mm: f64::INFINITY });
        let mut lengths = vec![0.0];
        for w in samples.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (w[1].1 - w[0].1).norm());
        }
        let length_mm = lengths[lengths.len() - 1];
        let at = |f: f64| {
            let k = lengths.partition_point(|l| *l < f * length_mm).clamp(1, lengths.len() - 1);
            let step = lengths[k] - lengths[k - 1];
            let part = if step > 0.0 { (f * length_mm - lengths[k - 1]) / step } else { 0.5 };
            course.point(samples[k - 1].0 + part * (samples[k].0 - samples[k - 1].0))
        };
        let middles = [0.25, 0.5, 0.75].map(at);
        let ends = [samples[0].1, samples[samples.len() - 1].1];
        Self { key, owner, course, points, ends, middles, length_mm }
    }
}

/// The edges of a face.
pub(crate) fn edges(face: &Face, chart: &Chart) -> Vec<LocalEdge> {
    let wrapped: Arc<dyn Surface> = Arc::new(Wrapped::new(face, chart));
    // Files write parameters with ten digits or more.
    let hair = [0, 1].map(|k| ON_SIDE * chart.side(k).length());
    let line = |points: &[Uv]| {
        let straight = isoline::ends_if_straight(points, hair);
        match straight.and_then(|[a, b]| isoline::between(&face.carrier, a, b)) {
            Some(piece) => Course::Space(piece),
            None => Course::OnSurface { surface: wrapped.clone(), points: points.to_vec() },
        }
    };
    let own = face.surface.edges();
    if !own.is_empty() {
        return own
            .iter()
            .filter(|e| e.points.len() > 1)
            .map(|e| {
                let course = match &e.curve {
                    Some(piece) => Course::Space(piece.clone()),
                    None => line(&e.points),
                };
                LocalEdge::new(e.key, e.owner, course, e.points.clone(), chart.size_mm)
            })
            .collect();
    }
    let mut out = Vec::new();
    for (owner, l) in face.surface.loops().iter().enumerate() {
        for points in stretches(chart, &l.points) {
            let course = line(&points);
            out.push(LocalEdge::new(None, owner, course, points, chart.size_mm));
        }
    }
    out
}

/// Places within this fraction of a side of the rectangle are on it.
const ON_SIDE: f64 = 1e-9;

/// A closed loop as pieces between the corners of the rectangle, without what runs along closing sides or poles.
fn stretches(chart: &Chart, points: &[Uv]) -> Vec<Vec<Uv>> {
    let n = points.len();
    let on = |p: Uv, k: usize, end: usize| {
        let i = chart.side(k);
        let t = if k == 0 { p.u } else { p.v };
        (t - if end == 0 { i.lo } else { i.hi }).abs() <= ON_SIDE * i.length()
    };
    // The side that a segment runs along, if it does.
    let along = |a: Uv, b: Uv| {
        [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().find(|(k, end)| on(a, *k, *end) && on(b, *k, *end))
    };
    let sides: Vec<Option<(usize, usize)>> = (0..n).map(|j| along(points[j], points[(j + 1) % n])).collect();
    let left_out =
        |s: Option<(usize, usize)>| s.is_some_and(|(k, end)| chart.closes[k] || chart.pole[k][end]);
    let starts: Vec<usize> = (0..n).filter(|j| sides[*j] != sides[(j + n - 1) % n]).collect();
    let mut out = Vec::new();
    if starts.is_empty() {
        if !left_out(sides[0]) {
            let mut whole = points.to_vec();
            whole.push(points[0]);
            out.push(whole);
        }
        return out;
    }
    for (index, first) in starts.iter().enumerate() {
        if left_out(sides[*first]) {
            continue;
        }
        let next = starts[(index + 1) % starts.len()];
        let count = if next > *first { next - first } else { next + n - first };
        out.push((0..=count).map(|j| points[(first + j) % n]).collect());
    }
    out
}
