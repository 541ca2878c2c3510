//! Surfaces with closed forms as splines over their rectangles, exactly.

use crate::nurbs::{Net, NurbsSurface};
use crate::part::Face;
use crate::topology::{FaceEdges, LocalEdge};
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::spline::Spline;
use crate::trim::sweep::revolve;
use osculate_geom::{Domain, Interval, Point3, Surface, Uv, uv};
use std::f64::consts::TAU;

/// The carrier of a face as a spline, natural normals alike, and the rectangle that it covers in the face's parameters:
/// the face's own, or where that closes one that begins at a vertex, for other kernels cut such surfaces there.
pub(super) fn surface(face: &Face, of: &FaceEdges) -> Option<(NurbsSurface, Domain)> {
    match &face.carrier {
        FaceSurface::Nurbs(n) => Some(((**n).clone(), face.domain())),
        FaceSurface::Analytic(a) => {
            let domain = match a.shape() {
                Shape::Plane if face.trimmed() => beyond(face.domain()),
                _ => rectangle(face, of),
            };
            Some((analytic(a, domain)?, domain))
        }
        // No spline is exactly an offset of one.
        FaceSurface::Offset(_) => None,
    }
}

/// A rectangle somewhat larger: an edge that touches its side would have feet beyond it.
fn beyond(d: Domain) -> Domain {
    /// Of a side, to both ends.
    const MARGIN: f64 = 0.01;
    let wider = |i: Interval| Interval::new(i.at(-MARGIN), i.at(1.0 + MARGIN));
    Domain { u: wider(d.u), v: wider(d.v) }
}

/// The face's rectangle; where it closes, from a seam or else from a vertex of the face on.
fn rectangle(face: &Face, of: &FaceEdges) -> Domain {
    let mut domain = face.domain();
    for (k, closes) in of.chart.closes.into_iter().enumerate() {
        let value = |p: Uv| if k == 0 { p.u } else { p.v };
        let runs = |e: &LocalEdge| e.points.first().copied().zip(e.points.last().copied());
        let mm = |a: Uv, b: Uv, k: usize| of.chart.speed[k] * if k == 0 { a.u - b.u } else { a.v - b.v };
        let seam = of.local.iter().zip(&of.uses).find(|(e, used)| {
            let uses = of.uses.iter().filter(|other| other.edge.is_some() && other.edge == used.edge).count();
            uses == 2 && runs(e).is_some_and(|(a, b)| mm(a, b, k).abs() < mm(a, b, 1 - k).abs())
        });
        let Some((start, _)) = seam.map(|s| s.0).or(of.local.first()).and_then(runs) else { continue };
        if closes {
            let i = of.chart.side(k);
            let turns = ((value(start) - i.lo) / i.length()).floor() * i.length();
            let lo = value(start) - turns;
            let moved = Interval::new(lo, lo + i.length());
            *(if k == 0 { &mut domain.u } else { &mut domain.v }) = moved;
        }
    }
    domain
}

fn analytic(a: &Analytic, d: Domain) -> Option<NurbsSurface> {
    let frame = a.placement();
    let local = |x: f64, z: f64| frame.point(&Point3::new(x, 0.0, z));
    let generatrix = match a.shape() {
        Shape::Plane => {
            let corners = [(d.u.lo, d.v.lo), (d.u.lo, d.v.hi), (d.u.hi, d.v.lo), (d.u.hi, d.v.hi)];
            let points = corners.map(|(u, v)| a.point(uv(u, v))).to_vec();
            let knots = [d.u, d.v].map(|i| vec![i.lo, i.lo, i.hi, i.hi]);
            return NurbsSurface::new([1, 1], knots, Net { count: [2, 2], points, weights: None }).ok();
        }
        Shape::Cylinder { .. } | Shape::Cone { .. } => {
            Spline::polyline([d.v.lo, d.v.hi].map(|v| a.point(uv(0.0, v))).to_vec())
        }
        Shape::Sphere { radius_mm } => meridian(a, local(0.0, 0.0), radius_mm, [d.v.lo, d.v.hi]),
        Shape::Torus { major_radius_mm, minor_radius_mm }
        | Shape::Lemon { major_radius_mm, minor_radius_mm } => {
            meridian(a, local(major_radius_mm, 0.0), minor_radius_mm, [d.v.lo, d.v.hi])
        }
    };
    let angles = [d.u.lo, d.u.hi.min(d.u.lo + TAU)];
    revolve(&generatrix.ok()?, frame, angles).ok()
}

/// An arc in the half plane at angle zero.
fn meridian(
    a: &Analytic,
    centre: Point3,
    radius_mm: f64,
    range: [f64; 2],
) -> Result<Spline, crate::nurbs::CurveError> {
    let frame = a.placement();
    Spline::arc(centre, frame.x.into_inner() * radius_mm, frame.z.into_inner() * radius_mm, range)
}
