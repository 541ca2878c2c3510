//! One suite of laws that every kind of surface runs.
//!
//! A [`Kind`] is a recipe for a surface at any scale; [`suite`] holds it against every local law at one [`Sample`]:
//! order of breaks, jets and Taylor polynomials against differences, Euler, the sum of curvatures, the theorema
//! egregium, rigid motion, scale, parameters swapped and reversed, material turned over, and Gauss and Bonnet on a small
//! rectangle. The laws of closed surfaces are in [`total_curvature`].

use super::local::{breaks_are_ordered, curvature_laws, jets_match_differences, taylor_matches};
use super::wrappers::{Reversed, Swapped};
use crate::analytic::{Placed, Placement};
use crate::frame::geodesic_curvature;
use crate::jet::Jet2;
use crate::point::{Axis, Uv, uv};
use crate::quadrature::{Integral, gauss};
use crate::surface::{Flipped, Surface};
use std::f64::consts::{PI, TAU};

/// A recipe for surfaces of one kind.
pub struct Kind {
    /// What the laws call it where one is broken.
    pub name: &'static str,
    /// The surface with all its lengths multiplied by the argument.
    pub make: Box<dyn Fn(f64) -> Box<dyn Surface> + Send + Sync>,
    /// How exact it is.
    pub accuracy: Accuracy,
}

/// What rounding leaves of a kind's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Derivatives against differences over 1e-5 of a span, relative to the largest of their order: a third derivative
    /// times 1e-10 of a span squared, and rounding over 1e-5.
    pub differences: f64,
    /// Curvatures computed in two ways, relative to the largest.
    pub curvature: f64,
}

/// Where and with what the laws are asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Fractions of the way over the rectangle, 0 to 1; the place is moved off the breaks.
    pub fraction: Uv,
    /// Direction in the tangent plane, rad.
    pub angle_rad: f64,
    /// The other scale.
    pub scale: f64,
    /// The motion.
    pub placement: Placement,
}

/// Steps of differences, as a fraction of a span.
const STEP: f64 = 1e-5;

/// A place inside a span, at least a twentieth of it from its ends, and the lengths of the spans.
///
/// # Panics
/// For a surface without breaks or with an infinite rectangle.
#[must_use]
pub fn inside(surface: &dyn Surface, fraction: Uv) -> (Uv, [f64; 2]) {
    let mut lengths = [0.0; 2];
    let mut at = [0.0; 2];
    for (k, axis) in [Axis::U, Axis::V].into_iter().enumerate() {
        let breaks = surface.breaks(axis);
        let n = breaks.len() - 1;
        let f = fraction.get(axis).clamp(0.0, 1.0) * n as f64;
        let span = (f as usize).min(n - 1);
        lengths[k] = breaks[span + 1] - breaks[span];
        assert!(lengths[k].is_finite(), "the laws need a rectangle with ends: {breaks:?}");
        at[k] = breaks[span] + lengths[k] * (0.05 + 0.9 * (f - span as f64).clamp(0.0, 1.0));
    }
    (uv(at[0], at[1]), lengths)
}

/// All local laws at one sample.
///
/// # Panics
/// Where a law is broken, with the kind, the place and the numbers.
pub fn suite(kind: &Kind, sample: &Sample) {
    let surface = (kind.make)(1.0);
    let (name, s, accuracy) = (kind.name, &*surface, &kind.accuracy);
    breaks_are_ordered(s);
    let (at, lengths) = inside(s, sample.fraction);
    let step = STEP * lengths[0].min(lengths[1]);
    jets_match_differences(s, at, step, accuracy.differences);
    // Each order more costs the span's length twice: once in the derivative, once in the rounding.
    taylor_matches(s, at, step, 30.0 * accuracy.differences);
    curvature_laws(s, at, sample.angle_rad, accuracy.curvature);
    let jet = s.jet2(at);
    theorema_egregium(name, &jet, accuracy.curvature);
    let k = [principal(&jet), principal(&s.taylor(at, 2).jet2())];
    same(name, "the Taylor polynomial", k[0], k[1], accuracy.curvature);
    let k = k[0];
    let placed = Placed { surface: s, placement: sample.placement };
    // The motion moves the point by as much as the part is large, and rounds there.
    same(name, "a rigid motion", principal(&placed.jet2(at)), k, 10.0 * accuracy.curvature);
    let moved = sample.placement.vector(&jet.normal().expect("asked at a regular place"));
    let normal = placed.jet2(at).normal().expect("as regular as before");
    assert!((moved - normal.into_inner()).norm() < 1e-12, "{name}: a motion turns the normal at {at:?}");
    let flipped = principal(&Flipped(s).jet2(at));
    same(name, "material turned over", [-flipped[1], -flipped[0]], k, accuracy.curvature);
    let swapped = Swapped(s);
    same(name, "swapped", principal(&swapped.jet2(uv(at.v, at.u))), k, accuracy.curvature);
    for axis in [Axis::U, Axis::V] {
        let back = Reversed { surface: s, axis };
        let place = back.place(at);
        same(name, "reversed", principal(&back.jet2(place)), k, accuracy.curvature);
        // The normal is the surface's, not the parameters'.
        let (a, b) = (back.jet2(place).normal(), jet.normal());
        let (a, b) = (a.expect("as regular as before"), b.expect("asked at a regular place"));
        assert!((a.into_inner() - b.into_inner()).norm() < 1e-10, "{name}: reversed at {at:?}");
    }
    let other = (kind.make)(sample.scale);
    let (far, _) = inside(&*other, sample.fraction);
    let scaled = principal(&other.jet2(far)).map(|x| x * sample.scale);
    same(name, "another scale", scaled, k, 10.0 * accuracy.curvature);
    let grown = (other.point(far).coords - s.point(at).coords * sample.scale).norm() / sample.scale;
    let size = s.point(at).coords.norm() + jet.du.norm() * lengths[0] + jet.dv.norm() * lengths[1];
    assert!(grown <= 1e-11 * size, "{name} at the scale {}: off by {grown:.3e}", sample.scale);
    // A tenth of a span around the place, still inside it.
    let half = lengths.map(|l| 0.045 * l);
    gauss_bonnet(name, s, [uv(at.u - half[0], at.v - half[1]), uv(at.u + half[0], at.v + half[1])], accuracy);
}

fn principal(jet: &Jet2) -> [f64; 2] {
    let k = jet.forms().expect("asked at a regular place").principal();
    [k.k_max, k.k_min]
}

fn same(name: &str, law: &str, got: [f64; 2], want: [f64; 2], relative: f64) {
    let size = want[0].abs().max(want[1].abs());
    for (g, w) in got.into_iter().zip(want) {
        // A plane's curvature is rounding of nothing.
        assert!(
            (g - w).abs() <= relative * size + f64::MIN_POSITIVE,
            "{name}, {law}: {got:?} against {want:?}"
        );
    }
}

/// Gauss: the curvature follows from lengths alone. K by Brioschi's formula from E, F, G and their derivatives, none of
/// which sees the normal, against the determinant of W.
fn theorema_egregium(name: &str, jet: &Jet2, relative: f64) {
    let forms = jet.forms().expect("asked at a regular place");
    let (a, b) = (jet.du.norm(), jet.dv.norm());
    // Parameters at unit speed here, so that the determinants compare like with like.
    let (su, sv) = (jet.du / a, jet.dv / b);
    let (suu, suv, svv) = (jet.duu / (a * a), jet.duv / (a * b), jet.dvv / (b * b));
    let (e, f, g) = (su.dot(&su), su.dot(&sv), sv.dot(&sv));
    let (eu, ev) = (2.0 * suu.dot(&su), 2.0 * suv.dot(&su));
    let (gu, gv) = (2.0 * suv.dot(&sv), 2.0 * svv.dot(&sv));
    let (fu, fv) = (suu.dot(&sv) + su.dot(&suv), suv.dot(&sv) + su.dot(&svv));
    // -E_vv / 2 + F_uv - G_uu / 2: the third derivatives cancel.
    let second = suu.dot(&svv) - suv.dot(&suv);
    let m1 = nalgebra::Matrix3::new(second, 0.5 * eu, fu - 0.5 * ev, fv - 0.5 * gu, e, f, 0.5 * gv, f, g);
    let m2 = nalgebra::Matrix3::new(0.0, 0.5 * ev, 0.5 * gu, 0.5 * ev, e, f, 0.5 * gu, f, g);
    let density = e * g - f * f;
    let k = (m1.determinant() - m2.determinant()) / (density * density);
    // Tangential parts of the second derivatives enter and cancel.
    let size = (suu.norm() + suv.norm() + svv.norm()).powi(2) / (density * density);
    let off = (k - forms.gauss()).abs();
    assert!(
        off <= 10.0 * relative * size,
        "{name}, theorema egregium at {:?}: {k} and {}",
        jet.uv,
        forms.gauss()
    );
}

/// Gauss and Bonnet on a parameter rectangle: total curvature, geodesic curvature of the sides and the angles outside
/// the corners make a full turn.
fn gauss_bonnet(name: &str, surface: &dyn Surface, [lo, hi]: [Uv; 2], accuracy: &Accuracy) {
    /// Gauss panels a side of a tenth of a span: converged to rounding.
    const PANELS: usize = 2;
    let forms = |j: &Jet2| j.forms().expect("asked at a regular place");
    let inner = gauss(lo.u, hi.u, PANELS, |u| {
        gauss(lo.v, hi.v, PANELS, |v| {
            let j = surface.jet2(uv(u, v));
            j.du.cross(&j.dv).norm() * forms(&j).gauss()
        })
    });
    // Counter-clockwise in the parameters; seen from the outward normal that is the same or the other way round.
    let sense = surface.jet2(lo).side.sign();
    let bend = |axis: Axis, fixed: f64, [from, to]: [f64; 2]| {
        let sign = (to - from).signum();
        gauss(from.min(to), from.max(to), PANELS, |t| {
            let j = surface.jet2(Uv::from_axis(axis, t, fixed));
            let rate = Uv::from_axis(axis, sign, 0.0);
            let k = geodesic_curvature(&j, rate, uv(0.0, 0.0)).expect("asked at a regular place");
            sense * k * j.tangent(rate).norm()
        })
    };
    let around = bend(Axis::U, lo.v, [lo.u, hi.u])
        + bend(Axis::V, hi.u, [lo.v, hi.v])
        + bend(Axis::U, hi.v, [hi.u, lo.u])
        + bend(Axis::V, lo.u, [hi.v, lo.v]);
    let corner = |at: Uv, flip: bool| {
        let j = surface.jet2(at);
        let angle = j.du.cross(&j.dv).norm().atan2(j.du.dot(&j.dv));
        // Outside the corner between S_u and S_v the path turns by pi less the angle inside.
        if flip { angle } else { PI - angle }
    };
    let corners =
        corner(lo, false) + corner(uv(hi.u, lo.v), true) + corner(hi, false) + corner(uv(lo.u, hi.v), true);
    let off = (inner + around + corners - TAU).abs();
    assert!(
        off <= accuracy.differences.max(1e-10),
        "{name}, Gauss and Bonnet around {lo:?}: off by {off:.3e}"
    );
}

/// The integral of K over a whole surface, by `panels` Gauss panels a span and by half as many, whose difference is the
/// error: `2 pi chi` where the surface is closed.
#[must_use]
pub fn total_curvature(surface: &dyn Surface, panels: usize) -> Integral {
    let (bu, bv) = (surface.breaks(Axis::U), surface.breaks(Axis::V));
    let run = |panels: usize| -> f64 {
        let along = |b: &[f64], f: &mut dyn FnMut(f64) -> f64| -> f64 {
            b.windows(2).map(|w| gauss(w[0], w[1], panels, &mut *f)).sum()
        };
        along(&bu, &mut |u| {
            along(&bv, &mut |v| {
                let jet = surface.jet2(uv(u, v));
                // Where there is no tangent plane there is no area either.
                jet.forms().map_or(0.0, |f| jet.du.cross(&jet.dv).norm() * f.gauss())
            })
        })
    };
    let value = run(panels);
    Integral { value, error: (value - run(panels.div_ceil(2))).abs() }
}
