//! How far two right programs may differ at a sample, and why.
//!
//! Every bound comes from what is known of the numbers compared, none from the differences seen:
//!
//! - parameters are printed with 15 digits, coordinates with 13, curvatures with 10;
//! - both programs round coordinates of size M. A derivative over a knot span of width h is a difference of poles
//!   divided by h: `|sum N_i' P_i| <= 2 p / h max |P|`, and `4 p (p - 1) / h^2` for a second one, so that the
//!   rounding of M turns up enlarged by as much.

use osculate_geom::{Axis, Jet2, Surface, Uv, uv};
use osculate_surfaces::NurbsSurface;

/// Files whose unit the reference has wrong: its scale over the file's, and why.
pub const UNITS: [(&str, f64, &str); 1] = [(
    "iges/pythonocc_testfile.igs",
    25.4,
    "the file says unit flag 2, name MM; the reference took inches (its record of the file has flag 1 and, as the \
     resolution, the coordinate of a pole)",
)];

/// A bound and what it is made of.
#[derive(Clone, Copy)]
pub struct Why {
    /// In the units of the error it is held against.
    pub bound: f64,
    pub reason: &'static str,
}

/// Half a unit of the fifteenth digit, at worst.
const PARAMETER: f64 = 5e-15;
/// Half a unit of the thirteenth digit of every coordinate, at worst.
const COORDINATE: f64 = 5e-13 * 1.732_050_807_568_877_2;
/// Half a unit of the tenth digit.
const PRINTED_CURVATURE: f64 = 5e-10;
/// Roundings of a sum over poles in one program and the other.
const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

/// A point, relative to `scale`.
pub fn point(jet: &Jet2, scale: f64) -> Why {
    let moves = PARAMETER * (jet.uv.u.abs() * jet.du.norm() + jet.uv.v.abs() * jet.dv.norm());
    Why {
        bound: (moves + COORDINATE * jet.point.coords.norm()) / scale + ROUNDINGS,
        reason: "parameters are printed with 15 digits: that rounding, times the first derivatives, moves the point",
    }
}

/// Principal curvatures, relative to `scale`, 1/mm; `None` where there is no tangent plane.
pub fn curvature(s: &NurbsSurface, jet: &Jet2, scale: f64) -> Option<Why> {
    let at = jet.uv;
    let axes = [Axis::U, Axis::V];
    let width = axes.map(|axis| {
        let (breaks, t) = (s.breaks(axis), at.get(axis));
        let k = breaks.partition_point(|b| *b <= t).clamp(1, breaks.len() - 1);
        breaks[k] - breaks[k - 1]
    });
    let degree = s.degree().map(|p| p as f64);
    let rounding = ROUNDINGS * s.net().points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
    let lengths = [jet.du.norm(), jet.dv.norm()];
    let first = [0, 1].map(|k| rounding * 2.0 * degree[k] / width[k] / lengths[k]);
    let twice = |k: usize| {
        let p = degree[k];
        rounding * 4.0 * p * (p - 1.0) / (width[k] * width[k]) / (lengths[k] * lengths[k])
    };
    let mixed = rounding * 4.0 * degree[0] * degree[1] / (width[0] * width[1]) / (lengths[0] * lengths[1]);
    let sine = jet.du.cross(&jet.dv).norm() / (lengths[0] * lengths[1]);
    let principal = |at: Uv| s.jet2(at).forms().ok().map(|f| f.principal());
    let p = principal(at)?;
    let largest = p.k_max.abs().max(p.k_min.abs());
    let rounded = (twice(0) + 2.0 * mixed + twice(1) + 2.0 * largest * (first[0] + first[1])) / (sine * sine);
    // What the rounding of the parameters changes: a difference quotient over a small part of the span.
    let mut moved = 0.0;
    for k in 0..2 {
        let step = 1e-4 * width[k];
        let to = |sign: f64| if k == 0 { uv(at.u + sign * step, at.v) } else { uv(at.u, at.v + sign * step) };
        for sign in [-1.0, 1.0] {
            let q = principal(to(sign))?;
            let change = (q.k_max - p.k_max).abs().max((q.k_min - p.k_min).abs()) / step;
            moved += change * PARAMETER * at.get(axes[k]).abs();
        }
    }
    let reason = if rounded >= moved {
        "short knot spans or large coordinates: rounding of the poles, times 4 p (p - 1) / h^2"
    } else {
        "parameters are printed with 15 digits: that rounding, times the change of the curvatures"
    };
    Some(Why { bound: (rounded + moved + PRINTED_CURVATURE * largest) / scale, reason })
}

/// First derivatives by u of a surface whose poles were written with fewer digits than those of the other, mm.
pub fn poles(written: &NurbsSurface, exact: &NurbsSurface) -> Why {
    let (a, b) = (written.net(), exact.net());
    let weight = |w: &Option<Vec<f64>>, k: usize| w.as_ref().map_or(1.0, |w| w[k]);
    let centre = exact.control_box().centre();
    let (mut off, mut least) = (0.0_f64, f64::INFINITY);
    for k in 0..b.points.len().min(a.points.len()) {
        let (wa, wb) = (weight(&a.weights, k), weight(&b.weights, k));
        off = off.max(((a.points[k] - centre) * wa - (b.points[k] - centre) * wb).norm());
        off = off.max((wa - wb).abs() * (b.points[k] - centre).norm());
        least = least.min(wb);
    }
    let breaks = exact.breaks(Axis::U);
    let h = breaks.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    Why {
        // Numerator and denominator of the quotient each carry it.
        bound: 2.0 * (off / least) * 2.0 * exact.degree()[0] as f64 / h,
        reason: "the STEP file has its poles with 12 to 15 digits: the difference of the poles, times 2 p / h",
    }
}
