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

use super::curve::{Curve, Piece};
use super::edge::FaceEdge;
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Point3, Surface, Uv, Vec3, uv};

/// A face whose area does not fit its boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Pieces of a curve between its breaks. The sums are extrapolated: an arc of a half circle comes to 1e-6 of its area.
const PIECES: usize = 16;

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

/// Where the area by the loops differs from that by the boundary; `oriented` says that loops have the inside on their left.
pub(crate) fn imbalance(surface: &TrimmedSurface, oriented: bool) -> Option<Imbalance> {
    let edges = surface.edges();
    let origin = surface.point(*edges.iter().find_map(|e| e.points.first())?);
    let mut whole = Sum { area: Vec3::zeros(), length_mm: 0.0, gap_mm2: 0.0 };
    let mut loops = 0;
    for run in edges.chunk_by(|a, b| a.owner == b.owner) {
        loops += 1;
        let (mut way, mut length_mm) = (Vec3::zeros(), 0.0);
        for e in run {
            let line = samples(e, surface);
            let of = along(&line, &origin);
            way += line[line.len() - 1] - line[0];
            length_mm += of.length_mm;
            whole.area += of.area;
            whole.length_mm += of.length_mm;
            whole.gap_mm2 += e.gap_mm * of.length_mm;
        }
        if !(way.norm() <= CLOSED * length_mm) {
            return None;
        }
    }
    let size = whole.area.norm();
    if !size.is_finite() || !oriented && loops > 1 {
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
    let boundary = whole.area.dot(&direction);
    let (loops_mm2, boundary_mm2) = if oriented { (seen, boundary) } else { (seen.abs(), boundary.abs()) };
    let difference = (loops_mm2 - boundary_mm2).abs();
    let allowed = |area: f64| DIFFERS * area + 2.0 * whole.gap_mm2;
    // The area itself only where it decides.
    let differs =
        !(difference <= allowed(size)) && !(difference <= allowed(surface.integrate(ACCURACY, &|_| 1.0)));
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

/// Along straight parameter lines.
fn of_parameters(points: &[Uv], surface: &TrimmedSurface) -> Vec<Point3> {
    let mut out: Vec<Point3> = points.first().map(|p| surface.point(*p)).into_iter().collect();
    for w in points.windows(2) {
        out.push(surface.point(uv(0.5 * (w[0].u + w[1].u), 0.5 * (w[0].v + w[1].v))));
        out.push(surface.point(w[1]));
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
        let face = TrimmedSurface::new(plane.clone(), &[square.clone()], Side::Along).unwrap();
        let whole = face.clone().with_edges(vec![edge(closed(&square))]);
        assert_eq!(imbalance(&whole, true), None);
        // The other way round the inside would be the outside.
        let back: Vec<Uv> = square.iter().rev().copied().collect();
        let turned = face.with_edges(vec![edge(closed(&back))]);
        assert!(imbalance(&turned, true).is_some() && imbalance(&turned, false).is_none());
        let triangle = TrimmedSurface::new(plane, &[square[..3].to_vec()], Side::Along).unwrap();
        let told = imbalance(&triangle.with_edges(vec![edge(closed(&square))]), true).unwrap();
        assert!((told.loops_mm2 - 2.0).abs() < 1e-12 && (told.boundary_mm2 - 4.0).abs() < 1e-12, "{told:?}");
    }

    #[test]
    fn the_rest_of_a_sphere_is_not_its_cap() {
        // Above z = 1 on a sphere of 3 mm; both have the same rim, and area vectors of +-8 pi.
        let cap = Arc::new(Sphere::new(3.0).unwrap());
        let v = (1.0_f64 / 3.0).asin();
        let rim: Vec<Uv> = (0..=360).map(|k| uv(TAU * f64::from(k) / 360.0, v)).collect();
        let d = cap.domain();
        let band =
            |lo: f64, hi: f64| -> Vec<Uv> { vec![uv(0.0, lo), uv(d.u.hi, lo), uv(d.u.hi, hi), uv(0.0, hi)] };
        for (points, fits) in [(band(v, d.v.hi), true), (band(d.v.lo, v), false)] {
            let face = TrimmedSurface::new(cap.clone(), &[points], Side::Along).unwrap();
            let told = imbalance(&face.with_edges(vec![edge(rim.clone())]), true);
            assert_eq!(told.is_none(), fits, "{told:?}");
        }
    }
}
