//! Surfaces as records.

use super::records::{Records, flag, knots, list, real, reals};
use crate::nurbs::NurbsSurface;
use crate::part::Face;
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use osculate_geom::Axis;
use osculate_geom::analytic::Placement;

/// Writes the carrier of a face, its natural normal along `S_u x S_v`; its number.
pub(super) fn surface(out: &mut Records<'_>, face: &Face) -> usize {
    match &face.carrier {
        FaceSurface::Analytic(a) => analytic(out, a),
        FaceSurface::Nurbs(n) => spline(out, n),
        FaceSurface::Offset(o) => {
            let base = spline(out, o.base());
            out.add(format!("OFFSET_SURFACE('',#{base},{},.U.)", real(o.distance_mm())))
        }
    }
}

fn analytic(out: &mut Records<'_>, a: &Analytic) -> usize {
    let frame = *a.placement();
    match a.shape() {
        Shape::Plane => {
            let at = out.placement(&frame);
            out.add(format!("PLANE('',#{at})"))
        }
        Shape::Cylinder { radius_mm } => {
            let at = out.placement(&frame);
            out.add(format!("CYLINDRICAL_SURFACE('',#{at},{})", real(radius_mm)))
        }
        Shape::Cone { radius_mm, half_angle_rad } => {
            // The format's cones open upwards: one that opens downwards stands on its head, with the same normal.
            let turned = Placement { z: -frame.z, y: -frame.y, ..frame };
            let at = out.placement(if half_angle_rad < 0.0 { &turned } else { &frame });
            let angle = real(half_angle_rad.abs());
            out.add(format!("CONICAL_SURFACE('',#{at},{},{angle})", real(radius_mm)))
        }
        Shape::Sphere { radius_mm } => {
            let at = out.placement(&frame);
            out.add(format!("SPHERICAL_SURFACE('',#{at},{})", real(radius_mm)))
        }
        Shape::Torus { major_radius_mm, minor_radius_mm } => {
            let at = out.placement(&frame);
            let sizes = format!("{},{}", real(major_radius_mm), real(minor_radius_mm));
            if major_radius_mm < minor_radius_mm {
                // The outer side of a torus that meets itself.
                out.add(format!("DEGENERATE_TOROIDAL_SURFACE('',#{at},{sizes},.T.)"))
            } else {
                out.add(format!("TOROIDAL_SURFACE('',#{at},{sizes})"))
            }
        }
        Shape::Lemon { major_radius_mm, minor_radius_mm } => {
            let at = out.placement(&frame);
            let sizes = format!("{},{}", real(major_radius_mm), real(minor_radius_mm));
            out.add(format!("DEGENERATE_TOROIDAL_SURFACE('',#{at},{sizes},.F.)"))
        }
    }
}

fn spline(out: &mut Records<'_>, n: &NurbsSurface) -> usize {
    let net = n.net();
    let columns = net.count[1];
    let ids: Vec<usize> = net.points.iter().map(|p| out.point(p)).collect();
    let rows: Vec<String> = ids.chunks(columns).map(list).collect();
    let poles = format!("({})", rows.join(","));
    let [du, dv] = n.degree();
    let [cu, cv] = [Axis::U, Axis::V].map(|axis| flag(n.closed(axis)));
    let (mu, ku) = knots(n.knots(Axis::U).as_slice());
    let (mv, kv) = knots(n.knots(Axis::V).as_slice());
    match net.weights.as_ref().filter(|_| n.is_rational()) {
        None => out.add(format!(
            "B_SPLINE_SURFACE_WITH_KNOTS('',{du},{dv},{poles},.UNSPECIFIED.,{cu},{cv},.F.,{mu},{mv},{ku},{kv},\
             .UNSPECIFIED.)"
        )),
        Some(w) => {
            let rows: Vec<String> = w.chunks(columns).map(reals).collect();
            out.add(format!(
                "(BOUNDED_SURFACE()B_SPLINE_SURFACE({du},{dv},{poles},.UNSPECIFIED.,{cu},{cv},.F.)\
                 B_SPLINE_SURFACE_WITH_KNOTS({mu},{mv},{ku},{kv},.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()\
                 RATIONAL_B_SPLINE_SURFACE(({}))REPRESENTATION_ITEM('')SURFACE())",
                rows.join(",")
            ))
        }
    }
}
