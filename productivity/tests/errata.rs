//! Every erratum of R97 and M86: the printed form fails where the corrected one holds.
//!
//! Tests are named by paper and equation.

use osculate_geom::analytic::{Ellipsoid, Paraboloid, Torus};
use osculate_geom::indicatrix::Conformity;
use osculate_geom::quadrature::gauss;
use osculate_geom::{Forms, Relative, Surface, ToolCurvature, Unit3, uv};
use osculate_productivity::closed_form::{
    DomainError, Section, contour_per_mm, five_axis_flat, leading_order, three_axis_flat, width_37,
};
use osculate_productivity::finish::{Across, Place, area_rate_mm2_min};
use osculate_productivity::rate::area_per_tooth_mm2;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// Tangent at an angle from S_u towards S_v.
fn tangent(forms: &Forms, angle: f64) -> Unit3 {
    let (s, c) = angle.sin_cos();
    Unit3::new_normalize(forms.frame[0].into_inner() * c + forms.frame[1].into_inner() * s)
}

/// `(L, M, N)` in an orthonormal frame, convex positive: what (59) to (62) call L, M, N of an orthogonal parametrisation
/// by arc length.
fn lmn(forms: &Forms) -> [f64; 3] {
    let w = forms.curvature;
    [w[(0, 0)], w[(0, 1)], w[(1, 1)]]
}

/// (1) as printed is a dot product, which at a right angle would be nothing; (2) is the product of the lengths.
#[test]
fn r97_1_the_printed_dot_product_contradicts_its_own_limit() {
    let (feed, strip) = (0.2, 3.0);
    let printed = feed * strip * FRAC_PI_2.cos();
    assert!(printed < 1e-15);
    assert!((area_per_tooth_mm2(feed, strip, FRAC_PI_2) - feed * strip).abs() < 1e-15);
    assert!((area_per_tooth_mm2(feed, strip, FRAC_PI_6) - 0.5 * feed * strip).abs() < 1e-15);
}

/// (22) prints `dU dV` under one integral over w: with the area element of the whole patch it has the unit of area, not of
/// area per time, and does not change with the speed of machining.
#[test]
fn r97_22_the_printed_element_is_no_rate() {
    let torus = Torus::new(30.0, 11.0).unwrap();
    let across = Across { from: 0.0, to: 1.0, panels: 4 };
    let rate = |speed: f64| {
        let line = |w: f64| Place { at: uv(0.3, w), by_time: uv(speed, 0.0), by_across: uv(0.0, 1.0) };
        area_rate_mm2_min(&torus, across, line).unwrap()
    };
    assert!((rate(2.0) / rate(1.0) - 2.0).abs() < 1e-12);
    // As printed: |J| dU dV is |J|^2 dt dw, here four times as much at double speed for the same minute.
    let printed = |speed: f64| {
        gauss(0.0, 1.0, 1, |_| {
            gauss(0.0, 1.0, 4, |w| {
                let jet = torus.jet2(uv(0.3, w));
                jet.du.cross(&jet.dv).norm() * speed * speed
            })
        })
    };
    assert!((printed(2.0) / printed(1.0) - 4.0).abs() < 1e-12);
}

/// With `[h] sgn R_P` as (39), (40), (43), (44) and (46) print it the cosine exceeds one for hollow parts.
#[test]
fn r97_39_40_43_44_46_the_printed_sign_has_no_real_value_on_hollow_parts() {
    for (rp, rt, h) in [(-100.0f64, 10.0f64, 0.01f64), (-20.0, 8.0, 0.02), (-100.0, 10.0, 0.1)] {
        let hs = h * rp.signum();
        let c = ((rp + rt).powi(2) + (rp + hs).powi(2) - rt * rt) / (2.0 * (rp + rt) * (rp + hs));
        assert!(c.abs() > 1.0);
        let section = Section { part_per_mm: 1.0 / rp, tool_per_mm: 1.0 / rt, scallop_mm: h };
        assert!(width_37(section).is_ok());
    }
}

proptest! {
    /// (57), (58), (61), (62) are the curvatures in the direction turned by 90 degrees: cos(2 xi + 180 deg) turns the sign of
    /// both the difference L - N and of M. With `+ M sin 2 xi` the two do not add up to 2 H.
    #[test]
    fn r97_57_58_61_62_the_turned_direction_has_minus_m(u in 0.1..3.0f64, v in -1.2..1.2f64, xi in 0.0..PI) {
        let part = Ellipsoid::new([9.0, 6.0, 4.0]).unwrap();
        let forms = part.jet2(uv(u, v)).forms().unwrap();
        // The frame turned, so that M does not vanish.
        let d = [tangent(&forms, 0.6), tangent(&forms, 0.6 + FRAC_PI_2)];
        let [l, m, n] = [
            forms.normal_curvature(&d[0]),
            {
                let both = Unit3::new_normalize(d[0].into_inner() + d[1].into_inner());
                forms.normal_curvature(&both) - forms.mean()
            },
            forms.normal_curvature(&d[1]),
        ];
        let (s, c) = xi.sin_cos();
        let across = l * c * c + m * (2.0 * xi).sin() + n * s * s;
        let printed = l * s * s + m * (2.0 * xi).sin() + n * c * c;
        let corrected = l * s * s - m * (2.0 * xi).sin() + n * c * c;
        let along = forms.normal_curvature(&tangent(&forms, 0.6 + xi + FRAC_PI_2));
        prop_assert!((forms.normal_curvature(&tangent(&forms, 0.6 + xi)) - across).abs() < 1e-12);
        prop_assert!((corrected - along).abs() < 1e-12);
        prop_assert!((across + corrected - 2.0 * forms.mean()).abs() < 1e-12);
        let off = 2.0 * m * (2.0 * xi).sin();
        prop_assert!((across + printed - 2.0 * forms.mean() - off).abs() < 1e-12);
        prop_assume!(off.abs() > 1e-3);
        prop_assert!((printed - along).abs() > 1e-3);
    }

    /// General parametrisations: Euler's form from W is `II(d, d) / I(d, d)` for any d = S_u du + S_v dv.
    #[test]
    fn general_parametrisations(u in 0.1..3.0f64, v in -1.2..1.2f64, du in -1.0..1.0f64, dv in -1.0..1.0f64) {
        prop_assume!(du.hypot(dv) > 0.1);
        let part = Ellipsoid::new([9.0, 6.0, 4.0]).unwrap();
        let jet = part.jet2(uv(u, v));
        let forms = jet.forms().unwrap();
        let ([e, f, g], [l, m, n]) = (forms.first, forms.second);
        let want = -(l * du * du + 2.0 * m * du * dv + n * dv * dv) / (e * du * du + 2.0 * f * du * dv + g * dv * dv);
        let got = forms.normal_curvature(&jet.tangent(uv(du, dv)));
        prop_assert!((got - want).abs() < 1e-12 * (1.0 + want.abs()), "{got} {want}");
    }
}

/// (61) and (62) print M_P and N_P in the tool's radius: then the strip would not know the tool's second curvature.
#[test]
fn r97_61_62_the_tools_radius_has_the_tools_coefficients() {
    let part = Paraboloid::new([0.005, 0.01], 1.0).unwrap().jet2(uv(0.0, 0.0)).forms().unwrap();
    let [_, mp, np] = lmn(&part);
    let widths = [0.05, 0.2].map(|across| {
        let tool = ToolCurvature { along: 0.1, across, direction: part.frame[0] };
        let (xi, lt) = (0.7f64, tool.along);
        let (s, c) = xi.sin_cos();
        let printed = lt * s * s - mp * (2.0 * xi).sin() + np * c * c;
        let corrected = lt * s * s + tool.across * c * c;
        let q = Relative::new(&part, &tool);
        let d = tangent(&part, xi + FRAC_PI_2);
        let exact = q.along(&d) - part.normal_curvature(&d);
        assert!((corrected - exact).abs() < 1e-14);
        assert!((printed - exact).abs() > 1e-2);
        printed
    });
    assert_eq!(widths[0], widths[1], "the printed radius ignores the tool");
}

/// (63): feed across the direction of smallest r. Where principal directions coincide it is 90 degrees off in this hollow
/// part, and the strip there is narrower than the best by the root of two.
#[test]
fn r97_63_the_smallest_conformity_radius_is_not_the_widest_strip() {
    let part = Paraboloid::new([0.005, 0.01], 1.0).unwrap().jet2(uv(0.0, 0.0)).forms().unwrap();
    let tool = ToolCurvature { along: 0.05, across: 0.1, direction: part.frame[0] };
    let claim = Conformity::new(part, tool).claim();
    assert!((claim.off_rad - FRAC_PI_2).abs() < 1e-5);
    let q = Relative::new(&part, &tool);
    let width = |d: &Unit3| {
        let part_per_mm = part.normal_curvature(d);
        width_37(Section { part_per_mm, tool_per_mm: q.along(d) - part_per_mm, scallop_mm: 0.01 }).unwrap()
    };
    assert!(width(&claim.widest) / width(&claim.across) > 1.41);
}

/// (63) on convex parts: up to a right angle off, and never by less than nothing.
#[test]
fn r97_63_the_claim_on_convex_parts_is_plainly_wrong() {
    let mut worst = 0.0f64;
    for turn in 0..18 {
        for across in [0.02, 0.05] {
            let part = Paraboloid::new([-0.01, -0.03], 1.0).unwrap().jet2(uv(0.0, 0.0)).forms().unwrap();
            let direction = tangent(&part, f64::from(turn) * PI / 18.0);
            worst = worst
                .max(Conformity::new(part, ToolCurvature { along: 0.2, across, direction }).claim().off_rad);
        }
    }
    assert!(worst.to_degrees() > 45.0, "{}", worst.to_degrees());
}

/// 5C as printed, `2 sqrt(4 sqrt(2h/dk - 8h/dk))`: the inner root has no real value for any tolerance and any difference of
/// curvatures.
#[test]
fn m86_5c_the_printed_width_is_never_real() {
    for h in [1e-5, 1e-3, 1e-1] {
        for difference in [1e-3, 0.1, 10.0] {
            let inner: f64 = 2.0 * h / difference - 8.0 * h / difference;
            assert!((4.0 * inner.sqrt()).sqrt().is_nan());
        }
    }
    // The corrected one, in the paper's units (R = 1): 4 sqrt(2h/dk) - 8h/dk under one root.
    let (kf, ky, h) = (0.05f64, -0.9f64, 1e-3f64);
    let d = kf - ky;
    let want = 2.0 * (4.0 * (2.0 * h / d).sqrt() - 8.0 * h / d).sqrt();
    let got = five_axis_flat(1.0, 0.0, kf, ky, h).unwrap();
    assert!((got.width_mm - want).abs() < 1e-14);
}

/// 3C: a hollow contour line cannot be machined when its *radius* of curvature is below the tool's. As printed, 'curvature
/// smaller than 1/r', the condition forbids what can be machined and allows what cannot.
#[test]
fn m86_3c_the_condition_is_on_the_radius() {
    let (radius, lead) = (10.0f64, 0.4f64);
    for (contour_radius, machinable) in [(9.0, false), (11.0, true), (200.0, true)] {
        // Meusnier: the contour line's own curvature is that of the surface across the feed over the sine of the lead.
        let across = -lead.sin() / contour_radius;
        assert!((contour_per_mm(across, lead).unwrap() + 1.0 / contour_radius).abs() < 1e-15);
        let width = three_axis_flat(radius, lead, across, 1e-3);
        assert_eq!(width.is_ok(), machinable, "{width:?}");
        assert!(machinable || matches!(width, Err(DomainError::DoesNotFit { .. })));
        let printed_forbids = 1.0 / contour_radius < 1.0 / radius;
        assert_eq!(printed_forbids, machinable, "the printed condition says the opposite");
    }
}

/// The leading order takes part and tool as one: (37) does not, and is the same for any pair of arcs only as h vanishes.
#[test]
fn all_forms_meet_at_the_leading_order() {
    for (kp, kt) in [(0.01, 0.1), (-0.01, 0.1), (0.02, -0.005), (-0.05, 0.125)] {
        let mut last = f64::INFINITY;
        for h in [1e-2, 1e-4, 1e-6] {
            let s = Section { part_per_mm: kp, tool_per_mm: kt, scallop_mm: h };
            let off = (width_37(s).unwrap() / leading_order(s).unwrap() - 1.0).abs();
            assert!(off < 0.02 * last, "{off} {last}");
            last = off.max(1e-13);
        }
    }
}
