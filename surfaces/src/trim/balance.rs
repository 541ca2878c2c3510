//! The area of a face held against its boundary.
//!
//! The area vector of a face depends on its boundary alone (Stokes):
//!
//! ```text
//! integral of n dA = 1/2 integral of r x dr along the boundary
//! ```
//!
//! with n = S_u x S_v / |S_u x S_v| and the inside on the left of the boundary. The left side comes from the loops as they were put
//! together in the parameter plane, the right one from the curves of the file in space. What loops lack or have too much, a
//! side that is a pole, a jump closed the wrong way, an inside that is the outside, shows as a difference of the two, but for
//! its part across the direction that is compared. Closed faces have no boundary, and nothing is said of them.
//!
//! Files write loops against their sense often enough, all of them or holes alone, where the surface leaves no doubt what is inside:
//! areas are compared without sign, and those of holes also as taken away from the largest loop.

use super::curve::{Curve, Piece};
use super::edge::FaceEdge;
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Axis, Point3, Surface, Uv, Vec3, uv};

/// A face whose area does not fit its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Imbalance {
    /// Area as seen along a direction by the face's loops, mm2.
    pub loops_mm2: f64,
    /// The same by the curves of its boundary, mm2.
    pub boundary_mm2: f64,
}

/// Difference of the two as a fraction of the area. Loops follow their curves to 2e-6 of the face's size, and slim faces have
/// up to some ten times more boundary for their area than a square.
const DIFFERS: f64 = 1e-4;

/// Accuracy of the integral over the face.
const ACCURACY: f64 = 1e-6;

/// Pieces of a curve between its breaks. The sums are extrapolated, so that their error goes with the fourth power: a full
/// circle in one piece comes to 4e-7 of its area.
const PIECES: usize = 64;

/// Pieces of one curve at most: long curves have many spans that each bend little.
const MOST_PIECES: usize = 4000;

/// Loops whose ends miss each other by this fraction of their length are told of otherwise, and not judged.
const CLOSED: f64 = 1e-4;

/// Area vectors below this fraction of the squared length of the boundary have no direction: those of a tube's wall cancel.
const DIRECTED: f64 = 1e-4;

/// What a boundary gives.
#[derive(Clone, Copy)]
struct Sum {
    area: Vec3,
    length_mm: f64,
    /// Area that the gaps between curves and surface are worth, mm2.
    gap_mm2: f64,
}

/// Where the area by the loops differs from that by the boundary.
pub(crate) fn imbalance(surface: &TrimmedSurface) -> Option<Imbalance> {
    let edges = surface.edges();
    let origin = surface.point(*edges.iter().find_map(|e| e.points.first())?);
    let mut whole = Sum { area: Vec3::zeros(), length_mm: 0.0, gap_mm2: 0.0 };
    let mut loops = Vec::new();
    for run in edges.chunk_by(|a, b| a.owner == b.owner) {
        let (mut way, mut own, mut length_mm) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for e in run {
            let line = samples(e, surface);
            let of = along(&line, &origin);
            way += line[line.len() - 1] - line[0];
            length_mm += of.length_mm;
            own += of.area;
            whole.length_mm += of.length_mm;
            whole.gap_mm2 += e.gap_mm * of.length_mm;
        }
        let is_closed = way.norm() <= CLOSED * length_mm;
        if !is_closed {
            return None;
        }
        whole.area += own;
        loops.push(own);
    }
    let size = whole.area.norm();
    if !size.is_finite() {
        return None;
    }
    let direction = if size > DIRECTED * whole.length_mm * whole.length_mm {
        whole.area / size
    } else {
        let (at, _) = *surface.samples(1).first()?;
        let jet = surface.jet2(at);
        jet.du.cross(&jet.dv).try_normalize(0.0)?
    };
    let seen = surface.integrate(ACCURACY, &|jet| {
        jet.du.cross(&jet.dv).try_normalize(0.0).map_or(0.0, |n| n.dot(&direction))
    });
    let loops_mm2 = seen.abs();
    let each: Vec<f64> = loops.iter().map(|l| l.dot(&direction).abs()).collect();
    let largest = each.iter().copied().fold(0.0, f64::max);
    let with_holes = 2.0 * largest - each.iter().sum::<f64>();
    let boundary = whole.area.dot(&direction).abs();
    let off = |area: f64| (loops_mm2 - area).abs();
    let boundary_mm2 = if off(with_holes) < off(boundary) { with_holes } else { boundary };
    let difference = off(boundary_mm2);
    let keeps = |area: f64| difference <= DIFFERS * area + 2.0 * whole.gap_mm2;
    // The area itself only where it decides.
    let differs = !keeps(size) && !keeps(surface.integrate(ACCURACY, &|_| 1.0));
    differs.then_some(Imbalance { loops_mm2, boundary_mm2 })
}

/// Points along an edge, an even number of pieces.
fn samples(edge: &FaceEdge, surface: &TrimmedSurface) -> Vec<Point3> {
    match &edge.curve {
        Some(piece) => of_curve(piece),
        None => of_parameters(&edge.points, surface),
    }
}

fn of_curve(piece: &Piece) -> Vec<Point3> {
    let mut breaks = vec![0.0];
    breaks.extend(piece.breaks());
    breaks.push(1.0);
    let pieces = (MOST_PIECES / breaks.len()).clamp(2, PIECES) & !1;
    let mut points = vec![piece.point(0.0)];
    for w in breaks.windows(2) {
        points.extend((1..=pieces).map(|k| piece.point(w[0] + (w[1] - w[0]) * k as f64 / pieces as f64)));
    }
    points
}

/// Along straight parameter lines, each of which bends in space with the spans that it crosses.
fn of_parameters(points: &[Uv], surface: &TrimmedSurface) -> Vec<Point3> {
    let breaks = [Axis::U, Axis::V].map(|axis| surface.breaks(axis));
    let crossed = |a: Uv, b: Uv| -> usize {
        let of = |(axis, breaks): (Axis, &Vec<f64>)| {
            let (lo, hi) = (a.get(axis).min(b.get(axis)), a.get(axis).max(b.get(axis)));
            breaks.iter().filter(|t| **t > lo && **t < hi).count()
        };
        [Axis::U, Axis::V].into_iter().zip(&breaks).map(of).sum()
    };
    let each = (MOST_PIECES / points.len().max(1)).clamp(2, PIECES);
    let mut out: Vec<Point3> = points.first().map(|p| surface.point(*p)).into_iter().collect();
    for w in points.windows(2) {
        // Even, for the sum over every second point.
        let pieces = (each * (1 + crossed(w[0], w[1]))).min(MOST_PIECES) & !1;
        let at = |k: usize| {
            let t = k as f64 / pieces as f64;
            uv(w[0].u + t * (w[1].u - w[0].u), w[0].v + t * (w[1].v - w[0].v))
        };
        out.extend((1..=pieces).map(|k| surface.point(at(k))));
    }
    out
}

/// The sum over chords and over those of every second point, extrapolated: the error of chords goes with their square.
fn along(line: &[Point3], origin: &Point3) -> Sum {
    let of = |step: usize| {
        let mut sum = Sum { area: Vec3::zeros(), length_mm: 0.0, gap_mm2: 0.0 };
        let ends = line.iter().step_by(step);
        for (a, b) in ends.clone().zip(ends.skip(1)) {
            sum.area += 0.5 * (a - origin).cross(&(b - origin));
            sum.length_mm += (b - a).norm();
        }
        sum
    };
    let (fine, coarse) = (of(1), of(2));
    Sum { area: fine.area + (fine.area - coarse.area) / 3.0, ..fine }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::{Plane, Sphere};
    use osculate_geom::{Domain, Interval, Side};
    use std::f64::consts::TAU;
    use std::sync::Arc;

    fn edge(points: Vec<Uv>) -> FaceEdge {
        FaceEdge { key: None, owner: 0, curve: None, gap_mm: 0.0, points }
    }

    #[test]
    fn a_loop_cut_short_is_seen() {
        let i = Interval::new(0.0, 4.0);
        let plane = Arc::new(Plane::new(Domain { u: i, v: i }));
        let square = vec![uv(1.0, 1.0), uv(3.0, 1.0), uv(3.0, 3.0), uv(1.0, 3.0)];
        let closed = |points: &[Uv]| [points, &points[..1]].concat();
        let face = TrimmedSurface::new(plane.clone(), std::slice::from_ref(&square), Side::Along).unwrap();
        let whole = face.clone().with_edges(vec![edge(closed(&square))]);
        assert_eq!(imbalance(&whole), None);
        // A loop against its sense bounds the same.
        let back: Vec<Uv> = square.iter().rev().copied().collect();
        assert_eq!(imbalance(&face.with_edges(vec![edge(closed(&back))])), None);
        let triangle = TrimmedSurface::new(plane, &[square[..3].to_vec()], Side::Along).unwrap();
        let told = imbalance(&triangle.with_edges(vec![edge(closed(&square))])).unwrap();
        assert!((told.loops_mm2 - 2.0).abs() < 1e-12 && (told.boundary_mm2 - 4.0).abs() < 1e-12, "{told:?}");
    }

    #[test]
    fn a_cap_by_its_rim_and_half_of_it() {
        // Above z = 1 on a sphere of 3 mm: the area vector is that of the rim's disc, 8 pi.
        let sphere = Arc::new(Sphere::new(3.0).unwrap());
        let (v, d) = ((1.0_f64 / 3.0).asin(), sphere.domain());
        let rim: Vec<Uv> = (0..=360).map(|k| uv(TAU * f64::from(k) / 360.0, v)).collect();
        for (end, share) in [(TAU, 1.0), (0.5 * TAU, 0.5)] {
            let band = vec![uv(0.0, v), uv(end, v), uv(end, d.v.hi), uv(0.0, d.v.hi)];
            let face = TrimmedSurface::new(sphere.clone(), &[band], Side::Along).unwrap();
            let told = imbalance(&face.with_edges(vec![edge(rim.clone())]));
            let seen = told.map_or(1.0, |t| t.loops_mm2 / t.boundary_mm2);
            assert!((seen - share).abs() < 1e-5 && told.is_some() == (share < 1.0), "{told:?}");
        }
    }
}
