//! Where lines of intersection may be: triangles of one face that cross triangles of another.

use super::soup::{Patch, Soup, blend};
use osculate_geom::{Box3, Point3, Uv};

/// A place near which two faces meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    /// Number of the other face.
    pub(super) other: usize,
    /// Parameters on either face.
    pub(super) at: [Uv; 2],
    /// Length of the segment that the two triangles have in common, mm.
    pub(super) length_mm: f64,
}

/// The middles of the segments that triangles of a face have in common with those of a body.
pub(super) fn seeds(face: &[Patch], body: &Soup) -> Vec<Seed> {
    let mut out = Vec::new();
    for a in face {
        for k in body.meeting(&Box3::around(&a.corners)) {
            out.extend(common(a, &body.patches[k]));
        }
    }
    out
}

/// A place on two triangles.
type Both = (Point3, [Uv; 2]);

/// The middle of the segment that two triangles have in common.
fn common(a: &Patch, b: &Patch) -> Option<Seed> {
    let mut found: Vec<Both> = Vec::new();
    for (p, q, turned) in [(a, b, false), (b, a, true)] {
        for k in 0..3 {
            let j = (k + 1) % 3;
            if let Some((way, w)) = pierced(&p.corners[k], &p.corners[j], &q.corners) {
                let mut along = [0.0; 3];
                (along[k], along[j]) = (1.0 - way, way);
                let point = p.corners[k] + (p.corners[j] - p.corners[k]) * way;
                let of = [blend(&p.at, along), blend(&q.at, w)];
                found.push((point, if turned { [of[1], of[0]] } else { of }));
            }
        }
    }
    // The two that are farthest apart: a corner in an edge is found twice.
    let mut best: Option<Seed> = None;
    for (k, p) in found.iter().enumerate() {
        for q in &found[k + 1..] {
            let length_mm = (p.0 - q.0).norm();
            if length_mm > best.map_or(0.0, |b| b.length_mm) {
                let at = [0, 1].map(|i| super::sheet::between(p.1[i], q.1[i], 0.5));
                best = Some(Seed { other: b.face, at, length_mm });
            }
        }
    }
    best
}

/// Where a segment goes through a triangle: the way along it, and the weights of the corners.
fn pierced(p: &Point3, q: &Point3, [a, b, c]: &[Point3; 3]) -> Option<(f64, [f64; 3])> {
    let (d, e1, e2) = (q - p, b - a, c - a);
    let h = d.cross(&e2);
    let det = e1.dot(&h);
    // Parallel to rounding: such triangles share no single segment.
    if det.abs() <= 1e-12 * e1.norm() * e2.norm() * d.norm() {
        return None;
    }
    let s = p - a;
    let u = s.dot(&h) / det;
    let r = s.cross(&e1);
    let v = d.dot(&r) / det;
    let way = e2.dot(&r) / det;
    let within = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&way);
    within.then_some((way, [1.0 - u - v, u, v]))
}
