//! The suite of laws that every [`Surface`] must pass, to be run from the tests of any crate that implements one.
//!
//! Each function panics with the place and the numbers where a law is broken, so that a test or a property test
//! can call it directly.

use crate::point::{Axis, Uv, uv};
use crate::surface::Surface;

/// Derivatives agree with central differences of the function one order below.
///
/// `uv` must lie at least `step` inside a smooth span. `step` is a parameter step for which a third derivative
/// times `step^2` and a rounding error divided by `step` are both small: about 1e-5 of the span.
///
/// # Panics
/// Where a derivative disagrees by more than `relative` of the largest derivative of its kind.
pub fn jets_match_differences(surface: &dyn Surface, at: Uv, step: f64, relative: f64) {
    let jet = surface.jet2(at);
    let (up, um) = (surface.jet2(uv(at.u + step, at.v)), surface.jet2(uv(at.u - step, at.v)));
    let (vp, vm) = (surface.jet2(uv(at.u, at.v + step)), surface.jet2(uv(at.u, at.v - step)));
    let d = 0.5 / step;
    let first = [("S_u", jet.du, (up.point - um.point) * d), ("S_v", jet.dv, (vp.point - vm.point) * d)];
    let second = [
        ("S_uu", jet.duu, (up.du - um.du) * d),
        ("S_uv", jet.duv, (vp.du - vm.du) * d),
        ("S_vu", jet.duv, (up.dv - um.dv) * d),
        ("S_vv", jet.dvv, (vp.dv - vm.dv) * d),
    ];
    let size1 = jet.du.norm().max(jet.dv.norm());
    let size2 = second.iter().map(|s| s.1.norm()).fold(size1, f64::max);
    for (size, (name, got, want)) in
        first.into_iter().map(|x| (size1, x)).chain(second.into_iter().map(|x| (size2, x)))
    {
        let off = (got - want).norm();
        assert!(off <= relative * size, "{name} at {at:?}: {got:?} against differences {want:?}");
    }
}

/// `k(d) + k(d turned by 90 degrees) = 2 H` and Euler's formula, for the direction at `angle` in the tangent frame.
///
/// # Panics
/// Where a curvature disagrees by more than `relative` of the largest one.
pub fn curvature_laws(surface: &dyn Surface, at: Uv, angle: f64, relative: f64) {
    let forms = surface.jet2(at).forms().expect("the law is asked at a regular point");
    let p = forms.principal();
    let size = p.k_max.abs().max(p.k_min.abs()).max(1e-300);
    let (s, c) = angle.sin_cos();
    let d = p.d_max.into_inner() * c + p.d_min.into_inner() * s;
    let e = forms.normal.cross(&d);
    let (kd, ke) = (forms.normal_curvature(&d), forms.normal_curvature(&e));
    assert!((kd + ke - 2.0 * forms.mean()).abs() <= relative * size, "sum of curvatures at {at:?}");
    let euler = p.k_max * c * c + p.k_min * s * s;
    assert!((kd - euler).abs() <= relative * size, "Euler at {at:?}: {kd} against {euler}");
    assert!((forms.gauss() - p.k_max * p.k_min).abs() <= relative * size * size, "Gauss at {at:?}");
    assert!(forms.normal.dot(&p.d_max).abs() <= 1e-12 && p.d_max.dot(&p.d_min).abs() <= 1e-12);
}

/// Breaks are ascending and begin and end at the domain's ends.
///
/// # Panics
/// Where they are not.
pub fn breaks_are_ordered(surface: &dyn Surface) {
    for axis in [Axis::U, Axis::V] {
        let (b, i) = (surface.breaks(axis), surface.domain().get(axis));
        assert!(b.len() >= 2 && b[0] == i.lo && b[b.len() - 1] == i.hi, "{axis:?}: {b:?} over {i:?}");
        assert!(b.windows(2).all(|w| w[0] < w[1]), "{axis:?}: {b:?}");
    }
}
