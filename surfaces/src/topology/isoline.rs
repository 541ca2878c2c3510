//! Lines of one constant parameter in closed form, for faces whose edges are their rectangle's sides.

use super::way::{HAIR, at_knot};
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use crate::trim::curve::{Curve, Ellipse, Line, Piece};
use crate::trim::spline::Spline;
use osculate_geom::analytic::Placement;
use osculate_geom::{Axis, Domain, Interval, Surface, Unit3, Uv, uv};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// The curve from one parameter pair to another where they differ in one parameter only; `None` where the surface has no
/// closed form there.
pub(super) fn between(carrier: &FaceSurface, a: Uv, b: Uv) -> Option<Piece> {
    let axis = if a.v == b.v && a.u != b.u {
        Axis::U
    } else if a.u == b.u && a.v != b.v {
        Axis::V
    } else {
        return None;
    };
    match carrier {
        FaceSurface::Analytic(s) => on_analytic(s, axis, a, b),
        FaceSurface::Offset(_) => None,
        FaceSurface::Nurbs(n) => {
            // A thin strip with the line as its first row of poles.
            let d = n.domain();
            let fixed = a.get(axis.other());
            let across = d.get(axis.other());
            let (lo, hi) = (a.get(axis).min(b.get(axis)), a.get(axis).max(b.get(axis)));
            let hair = HAIR * d.get(axis).length();
            if lo < d.get(axis).lo - hair || hi > d.get(axis).hi + hair {
                return None;
            }
            let at_end = fixed >= across.at(0.5);
            let strip =
                if at_end { Interval::new(across.lo, fixed) } else { Interval::new(fixed, across.hi) };
            let knots = n.knots(axis).as_slice();
            let part = Interval::new(at_knot(knots, lo, hair), at_knot(knots, hi, hair));
            let domain = match axis {
                Axis::U => Domain { u: part, v: strip },
                Axis::V => Domain { u: strip, v: part },
            };
            let piece = n.restricted(&domain).ok()?;
            let net = piece.net();
            let [nu, nv] = net.count;
            let row: Vec<usize> = match axis {
                Axis::U => (0..nu).map(|i| i * nv + if at_end { nv - 1 } else { 0 }).collect(),
                Axis::V => (0..nv).map(|j| (if at_end { nu - 1 } else { 0 }) * nv + j).collect(),
            };
            let knots = piece.knots(axis);
            let poles = row.iter().map(|k| net.points[*k]).collect();
            let weights = net.weights.as_ref().map_or_else(Vec::new, |w| row.iter().map(|k| w[*k]).collect());
            let curve = Spline::new(knots.degree(), knots.as_slice().to_vec(), poles, weights).ok()?;
            let [lo, hi] = curve.range();
            let ends = if a.get(axis) < b.get(axis) { [lo, hi] } else { [hi, lo] };
            Some(Piece { curve: Arc::new(curve), ends })
        }
    }
}

fn on_analytic(s: &Analytic, axis: Axis, a: Uv, b: Uv) -> Option<Piece> {
    let straight = matches!(
        (s.shape(), axis),
        (Shape::Plane, _) | (Shape::Cylinder { .. } | Shape::Cone { .. }, Axis::V)
    );
    if straight {
        return Some(Piece { curve: Arc::new(Line::segment(s.point(a), s.point(b))), ends: [0.0, 1.0] });
    }
    // A circle with the parameter as its angle: opposite points have the centre between them.
    let fixed = a.get(axis.other());
    let at = |t: f64| s.point(Uv::from_axis(axis, t, fixed));
    let centre = at(0.0) + (at(PI) - at(0.0)) * 0.5;
    let (x, y) = (at(0.0) - centre, at(FRAC_PI_2) - centre);
    let z = Unit3::try_new(x.cross(&y), 0.0)?;
    let radius = x.norm();
    let frame = Placement::new(centre, z, Some(x));
    let [lo, hi] = [a.get(axis), b.get(axis)];
    let circle = Ellipse { frame, semi_axes: [radius; 2], range: [lo.min(hi), lo.max(hi)] };
    // Any other kind of surface would not keep to the circle.
    let probe = 0.37 * lo + 0.63 * hi;
    let near = (circle.point(probe) - s.point(Uv::from_axis(axis, probe, fixed))).norm() <= 1e-9 * radius;
    near.then(|| Piece { curve: Arc::new(circle), ends: [lo, hi] })
}

/// Whether a polyline of parameters is one straight line along a parameter, but for `hair` in the other one; its ends if so.
pub(super) fn ends_if_straight(points: &[Uv], hair: [f64; 2]) -> Option<[Uv; 2]> {
    let (first, last) = (*points.first()?, *points.last()?);
    let along_u = points.iter().all(|p| (p.v - first.v).abs() <= hair[1]);
    let along_v = points.iter().all(|p| (p.u - first.u).abs() <= hair[0]);
    (along_u != along_v).then(|| {
        let end = if along_u { uv(last.u, first.v) } else { uv(first.u, last.v) };
        [first, end]
    })
}
