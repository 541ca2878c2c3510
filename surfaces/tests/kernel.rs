//! NURBS surfaces: reference vectors of another kernel (`data/NOTICE.md`), textbook examples, quadrics that
//! NURBS hold exactly, the laws of surfaces, and everything that is refused.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{any_surface, cylinder, moved, reference, sphere, torus};
use osculate_geom::{Axis, Interval, Point3, Side, Surface, Vec3, laws, uv};
use osculate_surfaces::{Net, NurbsCurve, NurbsError, NurbsSurface, RuledError, ruled};
use proptest::prelude::*;

fn check(surface: &NurbsSurface, vectors: &str) {
    let mut lines = vectors.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |n: &str| names.iter().position(|x| *x == n).unwrap();
    let mut seen = 0;
    for line in lines.filter(|l| !l.is_empty()) {
        let v: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let at = |n: &str| v[column(n)];
        let vector = |n: &str| Vec3::new(at(&format!("{n}_x")), at(&format!("{n}_y")), at(&format!("{n}_z")));
        let jet = surface.jet2(uv(at("u"), at("v")));
        // Sizes of the surface and of its derivatives: about 70 mm over a unit rectangle with 7 spans.
        let close = |got: Vec3, want: Vec3, size: f64, relative: f64, name: &str| {
            assert!((got - want).norm() <= relative * size, "{name} at {line}: {got:?} against {want:?}");
        };
        close(jet.point.coords, vector("S"), 70.0, 1e-14, "S");
        close(jet.du, vector("Su"), 70.0, 1e-12, "Su");
        close(jet.dv, vector("Sv"), 70.0, 1e-12, "Sv");
        close(jet.duu, vector("Suu"), 500.0, 1e-12, "Suu");
        close(jet.duv, vector("Suv"), 500.0, 1e-12, "Suv");
        close(jet.dvv, vector("Svv"), 500.0, 1e-12, "Svv");
        // The reference counts bending towards the normal as positive: the opposite of convex.
        let p = jet.forms().unwrap().principal();
        let (k_max, k_min) = (-at("kmin"), -at("kmax"));
        let size = k_max.abs().max(k_min.abs());
        assert!((p.k_max - k_max).abs() <= 1e-9 * size, "k_max at {line}: {} against {k_max}", p.k_max);
        assert!((p.k_min - k_min).abs() <= 1e-9 * size, "k_min at {line}: {} against {k_min}", p.k_min);
        if k_max - k_min > 1e-3 * size {
            assert!(p.d_max.dot(&vector("dmin")).abs() > 1.0 - 1e-9, "direction at {line}");
        }
        seen += 1;
    }
    assert_eq!(seen, 120);
}

#[test]
fn reference_vectors() {
    check(&reference(false), include_str!("data/vec_poly.csv"));
    check(&reference(true), include_str!("data/vec_rat.csv"));
}

fn point(c: [f64; 3]) -> Point3 {
    Point3::from(c)
}

#[test]
fn book_curves() {
    // [The NURBS Book, example 4.1]: C(1) = (7/5, 6/5).
    let poles = [[0.0, 0.0], [1.0, 1.0], [3.0, 2.0], [4.0, 1.0], [5.0, -1.0]].map(Into::into).to_vec();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0];
    let c = NurbsCurve::<2>::new(2, knots, poles, Some(vec![1.0, 4.0, 1.0, 1.0, 1.0])).unwrap();
    assert!((c.point(1.0).coords - nalgebra::Vector2::new(1.4, 1.2)).norm() < 1e-15);
    // [Example 4.2]: the quarter circle with weights 1, 1, 2 and its derivatives at both ends.
    let poles = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Into::into).to_vec();
    let c = NurbsCurve::<2>::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], poles, Some(vec![1.0, 1.0, 2.0]))
        .unwrap();
    for (t, want) in
        [(0.0, [[1.0, 0.0], [0.0, 2.0], [-4.0, 0.0]]), (1.0, [[0.0, 1.0], [-1.0, 0.0], [1.0, -1.0]])]
    {
        let j = c.jet(t);
        let got = [j.point.coords, j.first, j.second];
        for (g, w) in got.iter().zip(want) {
            assert!((g - nalgebra::Vector2::from(w)).norm() < 1e-14, "{got:?}");
        }
    }
}

#[test]
fn book_surface() {
    // [The NURBS Book, example 4.3]: only the nine poles that act at (5/2, 1) are given, the others are set
    // to zero.
    let mut net = Net { count: [8, 5], points: vec![Point3::origin(); 40], weights: Some(vec![1.0; 40]) };
    let rows = [
        [([0.0, 2.0, 4.0], 1.0), ([0.0, 3.0, 2.0], 2.0), ([0.0, 2.0, 0.0], 1.0)],
        [([2.0, 3.0, 4.0], 2.0), ([2.0, 4.0, 2.0], 6.0), ([2.0, 3.0, 0.0], 2.0)],
        [([4.0, 2.0, 4.0], 1.0), ([4.0, 3.0, 2.0], 2.0), ([4.0, 2.0, 0.0], 1.0)],
    ];
    for (i, row) in rows.iter().enumerate() {
        for (j, (p, w)) in row.iter().enumerate() {
            net.points[(i + 2) * 5 + j + 1] = point(*p);
            net.weights.as_mut().unwrap()[(i + 2) * 5 + j + 1] = *w;
        }
    }
    let ku = vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0];
    let kv = vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0];
    let s = NurbsSurface::new([2, 2], [ku, kv], net).unwrap();
    let want = point([2.0, 98.0 / 27.0, 68.0 / 27.0]);
    assert!((s.point(uv(2.5, 1.0)) - want).norm() < 4e-15);
}

#[test]
fn mixed_degrees_with_published_derivatives() {
    // A surface of degrees 2 and 1 with jets published to ten digits; the middle pole's weight is 1 or 5/2.
    let points = [
        [-10.0, -5.0, -1.0],
        [-12.0, 3.0, 3.0],
        [-9.0, 11.0, -0.0701928417],
        [-5.0, -3.0, 1.0],
        [-6.0, 4.0, -2.0],
        [-5.0, 7.0, 0.9298071583],
        [0.0, -4.0, -1.0],
        [1.0, 6.0, 5.0],
        [0.0, 13.0, -0.2350184214],
        [4.0, -2.0, 0.0],
        [5.0, 4.0, -1.0],
        [5.0, 11.0, 0.7649815786],
    ]
    .map(point)
    .to_vec();
    let polynomial = [
        [1.46, 0.96, 0.9],
        [0.96, 0.0266666667, -0.2666666667],
        [0.084, 0.832, 0.276],
        [0.0355555556, -0.0088888889, -0.1333333333],
        [0.0106666667, -0.048, -0.064],
        [0.0, 0.0, 0.0],
    ];
    let rational = [
        [1.0377358491, 1.1320754717, 0.7358490566],
        [1.1712353151, -0.0830663344, -0.14833274],
        [-0.0004271983, 0.8173727305, 0.2294054824],
        [0.0334131158, 0.0214196208, -0.171394283],
        [0.0499024922, -0.0351431047, -0.0293933919],
        [9.6724e-06, -0.0185065524, -0.0051940864],
    ];
    for (weight, want) in [(1.0, polynomial), (2.5, rational)] {
        let mut weights = vec![1.0; 12];
        weights[4] = weight;
        let net = Net { count: [4, 3], points: points.clone(), weights: Some(weights) };
        let knots = [vec![0.0, 0.0, 0.0, 7.5, 15.0, 15.0, 15.0], vec![0.0, 0.0, 10.0, 20.0, 20.0]];
        let s = NurbsSurface::new([2, 1], knots, net).unwrap();
        assert_eq!(s.is_rational(), weight != 1.0);
        let j = s.jet2(uv(12.0, 5.0));
        for (got, want) in [j.point.coords, j.du, j.dv, j.duu, j.duv, j.dvv].iter().zip(want) {
            // Half of the tenth decimal in each coordinate.
            assert!((got - Vec3::from(want)).norm() < 1e-10, "{got:?} {want:?}");
        }
    }
}

#[test]
fn a_sphere_is_round_at_every_scale() {
    for radius in [1e-6, 25.0, 1e6] {
        let s = sphere(radius);
        assert!(s.domain().u.periodic && !s.domain().v.periodic && s.closed(Axis::U) && !s.closed(Axis::V));
        for i in 0..=40 {
            for k in 1..40 {
                let jet = s.jet2(s.domain().at(f64::from(i) / 40.0, f64::from(k) / 40.0));
                // A few roundings each.
                assert!((jet.point.coords.norm() / radius - 1.0).abs() < 2e-15);
                let p = jet.forms().unwrap().principal();
                assert!((p.k_max * radius - 1.0).abs() < 1e-12 && (p.k_min * radius - 1.0).abs() < 1e-12);
            }
        }
        // Both poles are points without a tangent plane.
        assert!(s.jet2(uv(0.3, 0.0)).forms().is_err() && s.jet2(uv(0.3, 2.0)).forms().is_err());
    }
}

#[test]
fn smooth_and_creased_closing() {
    let t = torus(40.0, 7.0);
    assert!(t.domain().u.periodic && t.domain().v.periodic);
    // Wrapped parameters are those of the domain.
    assert_eq!(t.jet2(uv(4.25, -0.5)), t.jet2(uv(0.25, 3.5)));
    let c = cylinder(3.0, 10.0);
    assert!(c.domain().u.periodic && !c.closed(Axis::V));
    // Beyond an open end a parameter is held there.
    assert_eq!(c.point(uv(1.0, 12.0)), c.point(uv(1.0, 10.0)));
    // A square tube: the last side ends where the first begins, at an edge.
    let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0], [0.0, 0.0]];
    let points = square.iter().flat_map(|c| [0.0, 5.0].map(|z| point([c[0], c[1], z]))).collect();
    let knots = [vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0], vec![0.0, 0.0, 1.0, 1.0]];
    let tube = NurbsSurface::new([1, 1], knots, Net { count: [5, 2], points, weights: None }).unwrap();
    assert!(tube.closed(Axis::U) && !tube.domain().u.periodic);
    assert_eq!(tube.breaks(Axis::U), [0.0, 1.0, 2.0, 3.0, 4.0]);
    // An unclamped closed spline: three poles repeated make it smooth everywhere.
    let ring: Vec<Point3> = (0..9)
        .flat_map(|k| {
            let a = f64::from(k) * std::f64::consts::TAU / 6.0;
            [0.0, 5.0].map(|z| point([a.cos(), a.sin(), z]))
        })
        .collect();
    let knots = [(0..13).map(f64::from).collect(), vec![0.0, 0.0, 1.0, 1.0]];
    let ring = NurbsSurface::new([3, 1], knots, Net { count: [9, 2], points: ring, weights: None }).unwrap();
    assert_eq!(ring.domain().u, Interval::periodic(3.0, 9.0));
    // A flat sheet closes nowhere.
    assert!(!reference(false).closed(Axis::U) && !reference(true).closed(Axis::V));
}

#[test]
fn side_turns_the_normal_and_nothing_else() {
    let s = reference(true);
    let turned = s.clone().with_side(Side::Against);
    let (a, b) = (s.jet2(uv(0.3, 0.6)), turned.jet2(uv(0.3, 0.6)));
    assert_eq!((a.point, a.duv, Side::Against), (b.point, b.duv, b.side));
    assert_eq!(a.normal().unwrap().into_inner(), -b.normal().unwrap().into_inner());
}

#[test]
fn derivatives_do_not_lose_digits_far_from_the_origin() {
    for rational in [false, true] {
        let near = reference(rational);
        let far = moved(&near, 1.0, Vec3::new(1e5, -3e5, 2e5));
        let (a, b) = (near.jet2(uv(0.31, 0.77)), far.jet2(uv(0.31, 0.77)));
        // The poles themselves are rounded by 3e-11 mm there; second derivatives multiply that by some 7^2 *
        // 6.
        for (x, y) in [(a.du, b.du), (a.dv, b.dv), (a.duu, b.duu), (a.duv, b.duv), (a.dvv, b.dvv)] {
            assert!((x - y).norm() < 1e-8, "{x:?} {y:?}");
        }
    }
}

#[test]
fn weights_only_matter_by_their_ratios() {
    let s = reference(true);
    let mut net = s.net().clone();
    for w in net.weights.as_mut().unwrap() {
        *w *= 1024.0;
    }
    let knots = [Axis::U, Axis::V].map(|a| s.knots(a).as_slice().to_vec());
    let t = NurbsSurface::new([3, 3], knots.clone(), net).unwrap();
    // A power of two changes no digit.
    assert_eq!(s.jet2(uv(0.4, 0.9)), t.jet2(uv(0.4, 0.9)));
    let same = Net { weights: Some(vec![7.0; 100]), ..s.net().clone() };
    let plain = Net { weights: None, ..s.net().clone() };
    let [same, plain] = [same, plain].map(|n| NurbsSurface::new([3, 3], knots.clone(), n).unwrap());
    assert!(!same.is_rational());
    assert_eq!(same.jet2(uv(0.4, 0.9)), plain.jet2(uv(0.4, 0.9)));
}

#[test]
fn every_refusal() {
    let flat = || vec![0.0, 0.0, 1.0, 1.0];
    let net = || Net { count: [2, 2], points: vec![Point3::origin(); 4], weights: None };
    let new = |d, k, n| NurbsSurface::new(d, k, n).unwrap_err();
    assert_eq!(
        new([1, 2], [flat(), flat()], net()),
        NurbsError::Degree { axis: Axis::V, degree: 2, poles: 2 }
    );
    assert_eq!(
        new([1, 1], [flat(), vec![0.0; 3]], net()),
        NurbsError::KnotCount { axis: Axis::V, got: 3, need: 4 }
    );
    let inf = new([1, 1], [vec![0.0, 0.0, 1.0, f64::INFINITY], flat()], net());
    assert_eq!(inf, NurbsError::KnotNotFinite { axis: Axis::U, index: 3, got: f64::INFINITY });
    let down = new([1, 1], [vec![0.0, 0.0, 1.0, 0.5], flat()], net());
    assert_eq!(down, NurbsError::KnotDecreasing { axis: Axis::U, index: 3, got: 0.5, before: 1.0 });
    let empty = new([1, 1], [flat(), vec![2.0; 4]], net());
    assert_eq!(empty, NurbsError::EmptyDomain { axis: Axis::V, lo: 2.0, hi: 2.0 });
    let wide = Net { count: [4, 2], points: vec![Point3::origin(); 8], weights: None };
    let torn = new([1, 1], [vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0], flat()], wide);
    assert_eq!(torn, NurbsError::KnotMultiplicity { axis: Axis::U, at: 1.0, multiplicity: 2, most: 1 });
    let few = Net { points: vec![Point3::origin(); 3], ..net() };
    assert_eq!(new([1, 1], [flat(), flat()], few), NurbsError::PoleCount { got: 3, need: 4 });
    let weights = |w: &[f64]| Net { weights: Some(w.to_vec()), ..net() };
    assert_eq!(
        new([1, 1], [flat(), flat()], weights(&[1.0; 5])),
        NurbsError::WeightCount { got: 5, need: 4 }
    );
    for bad in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            new([1, 1], [flat(), flat()], weights(&[1.0, 1.0, bad, 1.0])),
            NurbsError::Weight { index: 2, got: bad }
        );
    }
    let mut far = net();
    far.points[1].y = f64::NEG_INFINITY;
    let far = new([1, 1], [flat(), flat()], far);
    assert_eq!(far, NurbsError::NonFinite { index: 1, got: [0.0, f64::NEG_INFINITY, 0.0] });
    assert_eq!(far.to_string(), "pole 1 is (0, -inf, 0): all coordinates must be finite");
    // Counts that no net can have end in an error, not in a sum that overflows.
    let huge = Net { count: [usize::MAX, usize::MAX], points: Vec::new(), weights: None };
    assert!(matches!(new([1, 1], [flat(), flat()], huge), NurbsError::KnotCount { got: 4, .. }));
}

#[test]
fn numbers_at_the_end_of_the_range_do_not_panic() {
    for size in [1e200, 1e308] {
        let points =
            [[0.0, 0.0, 0.0], [0.0, size, 0.0], [size, 0.0, 0.0], [size, size, -size]].map(point).to_vec();
        let flat = vec![0.0, 0.0, 1.0, 1.0];
        let net = Net { count: [2, 2], points, weights: Some(vec![1.0, 1e-300, 1e300, 1.0]) };
        let s = NurbsSurface::new([1, 1], [flat.clone(), flat], net).unwrap();
        let jet = s.jet2(uv(f64::NAN, 0.5));
        assert!(jet.point.x.is_nan());
        // Whatever comes of it, it is an answer.
        let _ = osculate_surfaces::closest(&s, &Point3::origin(), None);
    }
}

#[test]
fn ruled_surfaces_are_straight_across() {
    let line = |a: [f64; 3], b: [f64; 3]| {
        NurbsCurve::<3>::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![point(a), point(b)], None).unwrap()
    };
    // The hyperbolic paraboloid z = x y.
    let (a, b) = (line([0.0, 0.0, 0.0], [2.0, 0.0, 0.0]), line([0.0, 3.0, 0.0], [2.0, 3.0, 6.0]));
    let s = ruled(&a, &b).unwrap();
    for (u, v) in [(0.1, 0.9), (0.5, 0.5), (1.0, 0.0), (0.7, 1.0)] {
        let p = s.point(uv(u, v));
        assert!((p - point([2.0 * u, 3.0 * v, 6.0 * u * v])).norm() < 4e-15);
    }
    // A rational curve against a polynomial one: both edges are kept and the rulings straight.
    let arc = NurbsCurve::<3>::new(
        2,
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]].map(point).to_vec(),
        Some(vec![1.0, 0.5f64.sqrt(), 1.0]),
    )
    .unwrap();
    let parabola = NurbsCurve::<3>::new(
        2,
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        [[1.0, 0.0, 4.0], [2.0, 2.0, 5.0], [0.0, 1.0, 4.0]].map(point).to_vec(),
        None,
    )
    .unwrap();
    let s = ruled(&arc, &parabola).unwrap();
    for k in 0..=8 {
        let u = f64::from(k) / 8.0;
        let (p, q) = (arc.point(u), parabola.point(u));
        assert!((s.point(uv(u, 0.0)) - p).norm() < 1e-15 && (s.point(uv(u, 1.0)) - q).norm() < 2e-15);
        let d = s.point(uv(u, 0.3)) - p;
        assert!(d.cross(&(q - p)).norm() < 1e-14);
    }
    assert_eq!(ruled(&a, &arc).unwrap_err(), RuledError::Degree { degrees: [1, 2] });
    let finer = a.insert_knot(0.5, 1).unwrap();
    assert_eq!(ruled(&a, &finer).unwrap_err(), RuledError::Poles { poles: [2, 3] });
    let other = b.insert_knot(0.25, 1).unwrap();
    assert_eq!(ruled(&finer, &other).unwrap_err(), RuledError::Knots { index: 2, knots: [0.5, 0.25] });
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn laws_of_surfaces(s in any_surface(), f in 0.0f64..1.0, g in 0.0f64..1.0, angle in 0.0f64..3.0) {
        laws::breaks_are_ordered(&s);
        // Inside a span, away from its ends by more than the step.
        let inside = |axis: Axis, f: f64| {
            let b = s.breaks(axis);
            let k = ((b.len() - 1) as f64 * f) as usize;
            let part = (b.len() - 1) as f64 * f - k as f64;
            (b[k] + (b[k + 1] - b[k]) * (0.01 + 0.98 * part), b[k + 1] - b[k])
        };
        let ((u, hu), (v, hv)) = (inside(Axis::U, f), inside(Axis::V, g));
        // Step 1e-5 of a span of a polynomial of degree 9 with a third derivative up to (2 * 9)^2 times the
        // first one: 3e-8; rounding 1e-15 * 100 mm / 1e-5 of 10 mm a span: 1e-9; rational ones are some tens
        // of times steeper.
        let step = 1e-5 * hu.min(hv);
        laws::jets_match_differences(&s, uv(u, v), step, 2e-6);
        let jet = s.jet2(uv(u, v));
        // Curvatures of a surface that nearly folds over itself have few digits.
        let sine = jet.du.cross(&jet.dv).norm() / (jet.du.norm() * jet.dv.norm());
        if sine > 0.05 {
            laws::curvature_laws(&s, uv(u, v), angle, 1e-11);
        }
    }

    #[test]
    fn the_surface_stays_in_the_box_of_its_poles(s in any_surface(), f in 0.0f64..=1.0, g in 0.0f64..=1.0) {
        let around = s.control_box().grown(1e-12);
        let p = s.point(s.domain().at(f, g));
        prop_assert!((0..3).all(|k| p[k] >= around.min[k] && p[k] <= around.max[k]));
        // The point alone and the point of the jet differ by rounding of coordinates up to 130 mm.
        prop_assert!((s.jet2(s.domain().at(f, g)).point - p).norm() <= 1e-12);
    }

    #[test]
    fn scaling_by_a_power_of_two_changes_no_digit(s in any_surface(), f in 0.0f64..=1.0, g in 0.0f64..=1.0) {
        for scale in [2f64.powi(-20), 2f64.powi(20)] {
            let t = moved(&s, scale, Vec3::zeros());
            let (a, b) = (s.jet2(s.domain().at(f, g)), t.jet2(s.domain().at(f, g)));
            prop_assert_eq!(a.point * scale, b.point);
            prop_assert_eq!(a.duv * scale, b.duv);
            prop_assert_eq!(a.dvv * scale, b.dvv);
        }
    }

    #[test]
    fn the_batch_is_the_scalar(s in any_surface(), places in proptest::collection::vec((-0.2f64..1.2, -0.2f64..1.2), 0..20)) {
        let at: Vec<_> = places.iter().map(|(f, g)| s.domain().at(*f, *g)).collect();
        let mut jets = Vec::new();
        s.jet2_batch(&at, &mut jets);
        prop_assert_eq!(jets, at.iter().map(|a| s.jet2(*a)).collect::<Vec<_>>());
    }
}
