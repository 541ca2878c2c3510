//! Surfaces with closed forms as splines over their rectangles, exactly.

use crate::nurbs::{Net, NurbsSurface};
use crate::part::Face;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::spline::Spline;
use crate::trim::sweep::revolve;
use osculate_geom::{Point3, Surface, uv};
use std::f64::consts::TAU;

/// The carrier of a face as a spline over the face's rectangle, natural normals alike.
pub(super) fn surface(face: &Face) -> Option<NurbsSurface> {
    match &face.carrier {
        FaceSurface::Nurbs(n) => Some((**n).clone()),
        FaceSurface::Analytic(a) => analytic(a, face),
        // No spline is exactly an offset of one.
        FaceSurface::Offset(_) => None,
    }
}

fn analytic(a: &Analytic, face: &Face) -> Option<NurbsSurface> {
    let d = face.domain();
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
) -> Result<Spline, crate::nurbs_curve::CurveError> {
    let frame = a.placement();
    Spline::arc(centre, frame.x.into_inner() * radius_mm, frame.z.into_inner() * radius_mm, range)
}
