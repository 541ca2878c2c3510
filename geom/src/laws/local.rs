//! Laws at one place of one surface: derivatives against differences, Taylor polynomials, curvatures, order of breaks.

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

/// The Taylor polynomial is the jet to second order, and its third and fourth order are the differences of the orders
/// below. `step` as in [`jets_match_differences`].
///
/// # Panics
/// Where a derivative disagrees by more than `relative` of the largest derivative of its order or a lower one.
pub fn taylor_matches(surface: &dyn Surface, at: Uv, step: f64, relative: f64) {
    let t = surface.taylor(at, 4);
    let (jet, jet3) = (surface.jet2(at), surface.jet3(at));
    let of_jet = [(jet.du, 1, 0), (jet.dv, 0, 1), (jet.duu, 2, 0), (jet.duv, 1, 1), (jet.dvv, 0, 2)];
    let size = |n: usize| -> f64 {
        (1..=n)
            .flat_map(|n| (0..=n).map(move |j| (n - j, j)))
            .fold(0.0, |m, (i, j)| t.derivative(i, j).norm().max(m))
    };
    for (want, i, j) in of_jet {
        let off = (t.derivative(i, j) - want).norm();
        assert!(off <= 1e-3 * relative * size(i + j), "order {i}, {j} at {at:?} against the jet: {off:.3e}");
    }
    assert!((t.derivative(0, 0) - jet.point.coords).norm() <= 1e-12 * (size(1) + jet.point.coords.norm()));
    for (got, i, j) in [(jet3.duuu, 3, 0), (jet3.duuv, 2, 1), (jet3.duvv, 1, 2), (jet3.dvvv, 0, 3)] {
        assert!((got - t.derivative(i, j)).norm() <= 1e-3 * relative * size(3), "jet3 {i}, {j} at {at:?}");
    }
    let up = [surface.taylor(uv(at.u + step, at.v), 3), surface.taylor(uv(at.u, at.v + step), 3)];
    let down = [surface.taylor(uv(at.u - step, at.v), 3), surface.taylor(uv(at.u, at.v - step), 3)];
    for n in 3..=t.order().min(4) {
        for j in 0..=n {
            let i = n - j;
            // By u where there is a derivative by u to take away, and by v likewise.
            for (axis, a, b) in [(0, i.checked_sub(1), Some(j)), (1, Some(i), j.checked_sub(1))] {
                let (Some(a), Some(b)) = (a, b) else { continue };
                let want = (up[axis].derivative(a, b) - down[axis].derivative(a, b)) / (2.0 * step);
                let off = (t.derivative(i, j) - want).norm();
                assert!(
                    off <= relative * size(n),
                    "order {i}, {j} at {at:?}: off by {off:.3e} of {:.3e}",
                    size(n)
                );
            }
        }
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
