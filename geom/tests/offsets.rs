//! Offsets against closed forms, against their own laws, and where they end.

use osculate_geom::analytic::{Cone, Cylinder, Ellipsoid, Paraboloid, Sphere, Torus};
use osculate_geom::offset::clear_range;
use osculate_geom::{Flipped, Interval, Offset, OffsetError, Severity, Surface, laws, quadrature, uv};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn offsets_of_round_kinds_are_round_kinds() {
    let i = Interval::new(-2.0, 3.0);
    let d = 0.7;
    let pairs: Vec<(Box<dyn Surface>, Box<dyn Surface>)> = vec![
        (
            Box::new(Offset::new(Sphere::new(2.5).unwrap(), d).unwrap()),
            Box::new(Sphere::new(2.5 + d).unwrap()),
        ),
        (
            Box::new(Offset::new(Torus::new(5.0, 2.0).unwrap(), -d).unwrap()),
            Box::new(Torus::new(5.0, 2.0 - d).unwrap()),
        ),
        (
            Box::new(Offset::new(Cylinder::new(2.0, i).unwrap(), d).unwrap()),
            Box::new(Cylinder::new(2.0 + d, i).unwrap()),
        ),
        // A hole becomes narrower.
        (
            Box::new(Offset::new(Flipped(Cylinder::new(2.0, i).unwrap()), d).unwrap()),
            Box::new(Flipped(Cylinder::new(2.0 - d, i).unwrap())),
        ),
        // The offset of an offset is one offset, and one through a wrapper is as good.
        (
            Box::new(Offset::new(Sphere::new(2.5).unwrap(), 4.0).unwrap().further(-4.0 + d).unwrap()),
            Box::new(Sphere::new(2.5 + d).unwrap()),
        ),
        (
            Box::new(Offset::new(Offset::new(Torus::new(5.0, 2.0).unwrap(), 1.0).unwrap(), -1.7).unwrap()),
            Box::new(Torus::new(5.0, 1.3).unwrap()),
        ),
    ];
    for (offset, want) in pairs {
        for k in 0..40 {
            let at = offset.domain().at(f64::from(k % 8) / 8.3, 0.05 + 0.9 * f64::from(k / 8) / 4.0);
            let (a, b) = (offset.taylor(at, 4), want.taylor(at, 4));
            for n in 0..=4usize {
                for j in 0..=n {
                    // Sizes up to 10; near the poles each order loses a factor of 1 / cos v, six at most.
                    let off = (a.derivative(n - j, j) - b.derivative(n - j, j)).norm();
                    assert!(off < 1e-11, "order {n}, {j}: {off:.1e}");
                }
            }
            let (a, b) = (offset.jet3(at), want.jet3(at));
            assert!((a.jet2.duu - b.jet2.duu).norm() < 1e-13 && (a.jet2.dvv - b.jet2.dvv).norm() < 1e-13);
            assert!((a.jet2.duv - b.jet2.duv).norm() < 1e-13 && (a.duuv - b.duuv).norm() < 1e-12);
            assert_eq!(a.jet2.side, b.jet2.side);
            assert!((offset.point(at) - want.point(at)).norm() < 1e-14 * 10.0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn offsets_obey_the_laws(fu in 0.02..0.98f64, fv in 0.1..0.9f64, d in -0.15..2.0f64, angle in 0.0..PI) {
        let base = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
        let s = Offset::new(base, d).unwrap();
        let at = s.domain().at(fu, fv);
        // The axes' ratio squared enters each derivative of the normal.
        laws::jets_match_differences(&s, at, 1e-5, 1e-7);
        laws::taylor_matches(&s, at, 1e-5, 1e-6);
        laws::curvature_laws(&s, at, angle, 1e-11);
        let (f, g) = (base.jet2(at).forms().unwrap(), s.jet2(at).forms().unwrap());
        let (k, o) = (f.principal(), g.principal());
        prop_assert!((f.normal.into_inner() - g.normal.into_inner()).norm() < 1e-13);
        prop_assert!((o.k_max - k.k_max / (1.0 + d * k.k_max)).abs() < 1e-10 * (1.0 + o.k_max.abs()));
        prop_assert!((o.k_min - k.k_min / (1.0 + d * k.k_min)).abs() < 1e-10);
        let stretch = (1.0 + d * k.k_max) * (1.0 + d * k.k_min);
        prop_assert!((g.area_density() - stretch * f.area_density()).abs() < 1e-12 * f.area_density());
    }

    /// Behind both centres of curvature, between them, and in front: the normal stays, curvatures follow the formula.
    #[test]
    fn an_offset_inside_out_keeps_its_normal(fu in 0.0..1.0f64, fv in 0.1..0.9f64, d in -12.0..-0.2f64) {
        let base = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
        let s = Offset::new(base, d).unwrap();
        let at = s.domain().at(fu, fv);
        let k = base.jet2(at).forms().unwrap().principal();
        let factors = [1.0 + d * k.k_min, 1.0 + d * k.k_max];
        prop_assume!(factors.iter().all(|f| f.abs() > 1e-3));
        let jet = s.jet2(at);
        let forms = jet.forms().unwrap();
        prop_assert!((forms.normal.into_inner() - base.jet2(at).normal().unwrap().into_inner()).norm() < 1e-10);
        prop_assert_eq!(jet.side, s.taylor(at, 2).side);
        let gauss = k.k_min * k.k_max / (factors[0] * factors[1]);
        prop_assert!((forms.gauss() - gauss).abs() < 1e-7 * (1.0 + gauss.abs()));
        match s.regular(at) {
            Ok(_) => prop_assert!(factors.iter().all(|f| *f > 0.0)),
            Err(OffsetError::Cusp { k_per_mm, factor, .. }) => {
                prop_assert!(factor <= 0.0 && (factor - 1.0 - d * k_per_mm).abs() < 1e-15);
            }
            Err(e) => prop_assert!(false, "{e}"),
        }
    }
}

/// Steiner: the area of the offset is `A + 2 d int H dA + d^2 int K dA`, and total curvature stays.
#[test]
fn areas_follow_steiners_formula() {
    let base = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let integral = |f: &dyn Fn(&osculate_geom::Forms) -> f64| {
        quadrature::over_surface(&base, 1e-7, |j| j.forms().map_or(0.0, |x| f(&x))).value
    };
    let (h, k) = (integral(&|x| x.mean()), integral(&|x| x.gauss()));
    // Refinements agree to 1e-7 of some hundred square millimetres.
    for d in [-0.2, 3.0] {
        let s = Offset::new(base, d).unwrap();
        let want = quadrature::area(&base, 1e-8).value + 2.0 * d * h + d * d * k;
        assert!((quadrature::area(&s, 1e-8).value - want).abs() < 1e-5, "{d}");
        let total = quadrature::over_surface(&s, 1e-7, |j| j.forms().map_or(0.0, |x| x.gauss())).value;
        assert!((total - 4.0 * PI).abs() < 1e-5);
    }
}

#[test]
fn clear_ranges_end_at_the_sharpest_places() {
    // Semi-axes 3, 2, 1: most convex at the ends of the longest axis, a / c^2 = 3; nowhere concave.
    let e = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let r = clear_range(&e, 4);
    assert!((r.inward_mm + 1.0 / 3.0).abs() < 1e-12 && r.outward_mm == f64::INFINITY, "{r:?}");
    // Tube 2 about a circle of 5: convex 1/2, most concave on the inner equator, 1/3.
    let t = clear_range(&Torus::new(5.0, 2.0).unwrap(), 3);
    assert!((t.inward_mm + 2.0).abs() < 1e-12 && (t.outward_mm - 3.0).abs() < 1e-12, "{t:?}");
    assert!((t.outward_at.unwrap().v - PI).abs() < 1e-6);
    // z = a x^2 + b y^2 with material below: at the vertex -2 a.
    let bowl = clear_range(&Paraboloid::new([0.25, -0.1], 2.0).unwrap(), 5);
    assert!((bowl.outward_mm - 2.0).abs() < 1e-12 && (bowl.inward_mm + 5.0).abs() < 1e-12, "{bowl:?}");
    let torus = Torus::new(5.0, 2.0).unwrap();
    assert!(Offset::new(torus, 2.9).unwrap().check(3).is_none());
    let found = Offset::new(torus, 3.1).unwrap().check(3).unwrap();
    assert!(found.severity == Severity::Warning && found.message.contains("up to 3.000000"), "{found}");
    assert!(Offset::new(torus, -2.1).unwrap().check(3).is_some());
}

#[test]
fn a_cusp_line_is_an_error_with_its_numbers() {
    // z = x^2 / 4, offset into the bowl by its least radius: the cusp of the evolute at the vertex.
    let bowl = Paraboloid::new([0.25, 0.0], 2.0).unwrap();
    let s = Offset::new(bowl, 2.0).unwrap();
    match s.regular(uv(0.0, 0.5)) {
        Err(OffsetError::Cusp { k_per_mm, factor, distance_mm, .. }) => {
            assert!((k_per_mm + 0.5).abs() < 1e-15 && factor.abs() < 1e-15 && distance_mm == 2.0);
        }
        other => panic!("{other:?}"),
    }
    assert!(s.jet2(uv(0.0, 0.5)).forms().is_err());
    assert!(s.regular(uv(0.1, 0.5)).is_ok());
    let deep = Offset::new(bowl, 3.0).unwrap();
    assert!(deep.regular(uv(0.0, 0.0)).unwrap_err().to_string().contains("cusp"));
    assert!(Offset::new(bowl, f64::NAN).is_err() && Offset::new(bowl, f64::INFINITY).is_err());
}

/// The offset of a cone ends in a circle about the apex: the frustum of another cone.
#[test]
fn the_offset_of_an_apex_is_a_circle() {
    let half = 0.4f64;
    let s = Offset::new(Cone::new(0.0, half, Interval::new(0.0, 3.0)).unwrap(), 0.5).unwrap();
    for k in 0..12 {
        let u = TAU * f64::from(k) / 12.0;
        let p = s.point(uv(u, 0.0));
        let (si, co) = half.sin_cos();
        // Out of the cone: radially 0.5 cos, down 0.5 sin.
        assert!((p.x.hypot(p.y) - 0.5 * co).abs() < 1e-14 && (p.z + 0.5 * si).abs() < 1e-14);
        let forms = s.jet2(uv(u, 0.0)).forms().unwrap();
        // The parallel cone: curvature cos / r.
        assert!((forms.principal().k_max - co / (0.5 * co)).abs() < 1e-12);
        assert!(forms.principal().k_min.abs() < 1e-12);
    }
    // The pole of a sphere stays a pole.
    let ball = Offset::new(Sphere::new(2.0).unwrap(), 1.0).unwrap();
    assert!((ball.point(uv(0.3, FRAC_PI_2)).z - 3.0).abs() < 1e-15);
}
