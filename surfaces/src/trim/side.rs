//! Edges that are a side of their spline surface, pole by pole: their parameters are known without a search.
//!
//! Writers bound a whole patch by the curves of its outer poles. A curve with the same degree, knots (up to the
//! parameter's scale), poles and weights (up to a common factor) as a side is that side, point by point.

use super::curve::{Form, Piece};
use crate::knots::Knots;
use crate::nurbs::{NurbsCurve3, NurbsSurface};
use osculate_geom::{Axis, Interval, Surface, Uv};

/// Relative difference of numbers that were written twice, the second time after arithmetic.
const SAME: f64 = 1e-12;

/// The parameters of a piece of a side, from its start to its end; `None` for any other curve.
pub(super) fn along_side(piece: &Piece, surface: &NurbsSurface) -> Option<[Uv; 2]> {
    let Some(Form::Spline(spline)) = piece.curve.form() else { return None };
    let curve = spline.curve();
    let [lo, hi] = spline.range();
    // Across the seam of a closed curve parameters go on beyond its range.
    if piece.ends.iter().any(|t| *t < lo || *t > hi) {
        return None;
    }
    let d = surface.domain();
    for axis in [Axis::U, Axis::V] {
        let along = d.get(axis);
        if !same_knots(surface.knots(axis), curve.knots(), false)
            && !same_knots(surface.knots(axis), curve.knots(), true)
        {
            continue;
        }
        for end in [0, 1] {
            for backwards in [false, true] {
                if same_knots(surface.knots(axis), curve.knots(), backwards)
                    && clamped(surface.knots(axis.other()))
                    && same_poles(surface, axis, end, curve, backwards)
                {
                    let across = d.get(axis.other());
                    let fixed = if end == 0 { across.lo } else { across.hi };
                    return Some(piece.ends.map(|t| {
                        let f = (t - lo) / (hi - lo);
                        Uv::from_axis(axis, place(along, if backwards { 1.0 - f } else { f }), fixed)
                    }));
                }
            }
        }
    }
    None
}

/// The parameter at a fraction, both ends exact.
fn place(i: Interval, f: f64) -> f64 {
    if f == 1.0 { i.hi } else { i.at(f) }
}

/// Whether the first and last knots are repeated so that the outer poles are the side.
fn clamped(knots: &Knots) -> bool {
    let (p, k) = (knots.degree(), knots.as_slice());
    let n = k.len();
    k[..=p].iter().all(|t| *t == k[p]) && k[n - p - 1..].iter().all(|t| *t == k[n - 1 - p])
}

fn same_knots(a: &Knots, b: &Knots, backwards: bool) -> bool {
    let (x, y) = (a.as_slice(), b.as_slice());
    let n = x.len();
    if a.degree() != b.degree() || n != y.len() {
        return false;
    }
    let ([x0, x1], [y0, y1]) = (a.domain(), b.domain());
    (0..n).all(|k| {
        let f = (x[k] - x0) / (x1 - x0);
        let g = if backwards { (y1 - y[n - 1 - k]) / (y1 - y0) } else { (y[k] - y0) / (y1 - y0) };
        (f - g).abs() <= SAME
    })
}

fn same_poles(surface: &NurbsSurface, axis: Axis, end: usize, curve: &NurbsCurve3, backwards: bool) -> bool {
    let net = surface.net();
    let [nu, nv] = net.count;
    let n = if axis == Axis::U { nu } else { nv };
    if curve.poles().len() != n {
        return false;
    }
    let index = |k: usize| match (axis, end) {
        (Axis::U, 0) => k * nv,
        (Axis::U, _) => k * nv + nv - 1,
        (Axis::V, 0) => k,
        (Axis::V, _) => (nu - 1) * nv + k,
    };
    let of = |k: usize| if backwards { n - 1 - k } else { k };
    let weight = |k: usize| net.weights.as_ref().map_or(1.0, |w| w[index(k)]);
    let own = |k: usize| curve.weights().map_or(1.0, |w| w[of(k)]);
    let factor = weight(0) / own(0);
    (0..n).all(|k| {
        let (p, q) = (net.points[index(k)], curve.poles()[of(k)]);
        (p - q).norm() <= SAME * (1.0 + p.coords.norm())
            && (weight(k) - factor * own(k)).abs() <= SAME * weight(k).abs()
    })
}
