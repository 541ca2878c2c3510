//! The loops of a face for writers: closed walks over edges with the face on their left, seen from outside.

use super::local::LocalEdge;
use super::shared::FaceEdges;
use crate::part::Face;
use osculate_geom::{Side, Surface, Uv, uv};

/// One step of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    /// The edge in the part.
    pub(crate) edge: usize,
    /// Whether it is walked along its own course.
    pub(crate) forward: bool,
    /// The face's own edge.
    pub(crate) local: usize,
}

/// A point this part of the face's size beside an edge is well off it, and rarely across the next one.
const BESIDE: f64 = 1e-4;

/// Edges of a loop that are asked at most.
const ASKED: usize = 8;

/// The outward side of a face relative to `S_u x S_v`.
pub(crate) fn outward(face: &Face) -> Side {
    face.surface.jet2(face.surface.domain().at(0.5, 0.5)).side
}

/// The loops of a face with the face on their left seen from outside. A loop whose every edge has the face on both sides
/// keeps the sense of the file.
pub(crate) fn loops(face: &Face, of: &FaceEdges) -> Vec<Vec<Step>> {
    turned(face, natural_loops(face, of))
}

/// Natural loops with the face on their left seen from outside.
pub(crate) fn turned(face: &Face, mut out: Vec<Vec<Step>>) -> Vec<Vec<Step>> {
    if outward(face) == Side::Against {
        out.iter_mut().for_each(reverse);
    }
    out
}

/// The loops of a face with the face on their left seen against `S_u x S_v`.
pub(crate) fn natural_loops(face: &Face, of: &FaceEdges) -> Vec<Vec<Step>> {
    let mut out = walks(of);
    for walk in &mut out {
        if votes(face, of, walk) < 0.0 {
            reverse(walk);
        }
    }
    out
}

fn reverse(walk: &mut Vec<Step>) {
    walk.reverse();
    for s in walk {
        s.forward = !s.forward;
    }
}

/// Edges of each loop joined end to end by their vertices; one file's loop may be several here, where what joined them
/// was the side of the rectangle.
fn walks(of: &FaceEdges) -> Vec<Vec<Step>> {
    let count = of.local.len();
    let mut used: Vec<bool> = of.uses.iter().map(|u| u.edge.is_none()).collect();
    let mut out = Vec::new();
    for first in 0..count {
        if used[first] {
            continue;
        }
        let mut walk = Vec::new();
        let mut at = first;
        loop {
            used[at] = true;
            if let Some(edge) = of.uses[at].edge {
                walk.push(Step { edge, forward: of.uses[at].forward, local: at });
            }
            let end = of.uses[at].vertices[1];
            let owner = of.local[at].owner;
            let fits = |k: usize| !used[k] && of.local[k].owner == owner && of.uses[k].vertices[0] == end;
            let following = (at + 1..count).find(|k| !used[*k]).filter(|k| fits(*k));
            let closed = end == of.uses[first].vertices[0];
            // A loop goes on through its own start where the file goes on there, as at the seam of a cylinder.
            let next = following.or_else(|| if closed { None } else { (0..count).find(|k| fits(*k)) });
            match next {
                Some(k) => at = k,
                None => break,
            }
        }
        out.push(walk);
    }
    out
}

/// Length of edges with the inside on their left less that of edges with the inside on their right.
fn votes(face: &Face, of: &FaceEdges, walk: &[Step]) -> f64 {
    let mut longest: Vec<&LocalEdge> = walk.iter().map(|s| &of.local[s.local]).collect();
    longest.sort_by(|a, b| b.length_mm.total_cmp(&a.length_mm));
    let mut sum = 0.0;
    for e in longest.into_iter().take(ASKED) {
        let n = e.points.len() - 1;
        for f in [0.3, 0.5, 0.7] {
            let k = ((f * n as f64) as usize).min(n - 1);
            let (a, b) = (e.points[k], e.points[k + 1]);
            let part = f * n as f64 - k as f64;
            let at = uv(a.u + part * (b.u - a.u), a.v + part * (b.v - a.v));
            let shift = of.chart.shift(at);
            let at = uv(at.u - shift.u, at.v - shift.v);
            // Left in the plane of parameters times speeds.
            let speed = of.chart.speed;
            let d = [(b.u - a.u) * speed[0], (b.v - a.v) * speed[1]];
            let length = d[0].hypot(d[1]);
            if length <= 0.0 {
                continue;
            }
            let off = BESIDE * of.chart.size_mm / length;
            let step = uv(-d[1] * off / speed[0], d[0] * off / speed[1]);
            let inside = |p: Uv| {
                let s = of.chart.shift(p);
                face.surface.contains(uv(p.u - s.u, p.v - s.v))
            };
            let left = inside(uv(at.u + step.u, at.v + step.v));
            let right = inside(uv(at.u - step.u, at.v - step.v));
            sum += e.length_mm * (f64::from(u8::from(left)) - f64::from(u8::from(right)));
        }
    }
    sum
}
