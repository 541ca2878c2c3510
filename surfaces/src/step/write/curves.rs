//! Edge curves as records.

use super::records::{Records, flag, knots, list, real, reals};
use crate::nurbs::NurbsCurve3;
use crate::topology::{Along, Way};
use crate::trim::curve::OpenKind;

/// Writes the curve of a way; its number.
pub(super) fn curve(out: &mut Records<'_>, way: &Way) -> usize {
    match &way.along {
        Along::Line(l) => {
            let origin = out.point(&l.origin);
            let direction = out.direction(&l.direction);
            // The parameter is the length, as for other kernels.
            let vector = out.add(format!("VECTOR('',#{direction},1.)"));
            out.add(format!("LINE('',#{origin},#{vector})"))
        }
        Along::Ellipse(e) => {
            let frame = out.placement(&e.frame);
            let [a, b] = e.semi_axes;
            if a == b {
                out.add(format!("CIRCLE('',#{frame},{})", real(a)))
            } else {
                out.add(format!("ELLIPSE('',#{frame},{},{})", real(a), real(b)))
            }
        }
        Along::Open(c) => {
            let frame = out.placement(&c.frame);
            match c.kind {
                OpenKind::Parabola { focal_mm } => {
                    out.add(format!("PARABOLA('',#{frame},{})", real(focal_mm)))
                }
                OpenKind::Hyperbola { semi_axes_mm: [a, b] } => {
                    out.add(format!("HYPERBOLA('',#{frame},{},{})", real(a), real(b)))
                }
            }
        }
        Along::Polyline(points) => {
            let ids: Vec<usize> = points.iter().map(|p| out.point(p)).collect();
            out.add(format!("POLYLINE('',{})", list(&ids)))
        }
        Along::Spline(s) => spline(out, s, closes(&way.along)),
    }
}

fn spline(out: &mut Records<'_>, s: &NurbsCurve3, closed: &str) -> usize {
    let ids: Vec<usize> = s.poles().iter().map(|p| out.point(p)).collect();
    let poles = list(&ids);
    let (times, values) = knots(s.knots().as_slice());
    let degree = s.degree();
    match s.weights().filter(|_| s.is_rational()) {
        None => out.add(format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{degree},{poles},.UNSPECIFIED.,{closed},.F.,{times},{values},.UNSPECIFIED.)"
        )),
        Some(w) => out.add(format!(
            "(BOUNDED_CURVE()B_SPLINE_CURVE({degree},{poles},.UNSPECIFIED.,{closed},.F.)\
             B_SPLINE_CURVE_WITH_KNOTS({times},{values},.UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()\
             RATIONAL_B_SPLINE_CURVE({})REPRESENTATION_ITEM(''))",
            reals(w)
        )),
    }
}

/// Whether a way ends where it begins, for the flag that nobody may rely on.
fn closes(way: &Along) -> &'static str {
    match way {
        Along::Spline(s) => {
            let (d, poles) = (s.domain(), s.poles());
            let size = osculate_geom::Box3::around(poles).diagonal_mm();
            flag((s.point(d.lo) - s.point(d.hi)).norm() <= 1e-9 * size)
        }
        _ => ".U.",
    }
}
