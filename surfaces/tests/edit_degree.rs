//! Degree elevation and knot removal: the same points, and a bound that holds where they are not.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{any_surface, cylinder, reference, sphere, torus};
use osculate_geom::{Axis, Point3, Surface, uv};
use osculate_surfaces::{EditError, NurbsCurve, NurbsCurve3};
use proptest::prelude::*;

/// Coordinates up to 130 mm, some tens of roundings a degree of means between them.
const POINT: f64 = 1e-11;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_raised_degree_changes_no_point(
        s in any_surface(), by in 1usize..4, along in any::<bool>(), f in 0.0f64..=1.0, g in 0.0f64..=1.0,
    ) {
        let axis = if along { Axis::U } else { Axis::V };
        let raised = s.elevated(axis, by).unwrap();
        prop_assert_eq!(raised.knots(axis).degree(), s.knots(axis).degree() + by);
        prop_assert_eq!(raised.knots(axis).breaks(), s.knots(axis).breaks());
        for t in &s.knots(axis).breaks()[1..s.knots(axis).span_count()] {
            // No smoother and no rougher than before.
            prop_assert_eq!(raised.knots(axis).multiplicity(*t), s.knots(axis).multiplicity(*t) + by);
        }
        let at = s.domain().at(f, g);
        prop_assert!((raised.point(at) - s.point(at)).norm() <= POINT);
        let same = s.elevated(axis, 0).unwrap();
        prop_assert_eq!(same.net(), s.net());
    }

    #[test]
    fn an_inserted_knot_can_be_removed(
        s in any_surface(), t in 0.1f64..0.9, along in any::<bool>(), f in 0.0f64..=1.0, g in 0.0f64..=1.0,
    ) {
        let axis = if along { Axis::U } else { Axis::V };
        let at = s.domain().get(axis).at(t);
        let times = s.knots(axis).degree().min(2);
        // Knots one thousandth of a span from another one amplify rounding by its powers.
        prop_assume!(s.knots(axis).breaks().iter().all(|b| (b - at).abs() > 0.05));
        let finer = s.insert_knot(axis, at, times).unwrap();
        let back = finer.remove_knot(axis, at, times).unwrap();
        prop_assert_eq!(back.surface.knots(axis), s.knots(axis));
        prop_assert!(back.bound_mm <= 1e-6, "{}", back.bound_mm);
        let place = s.domain().at(f, g);
        prop_assert!((back.surface.point(place) - s.point(place)).norm() <= back.bound_mm + POINT);
    }

    #[test]
    fn a_removed_knot_moves_the_surface_within_its_bound(
        s in any_surface(), along in any::<bool>(), f in 0.0f64..=1.0, g in 0.0f64..=1.0,
    ) {
        let axis = if along { Axis::U } else { Axis::V };
        let knots = s.knots(axis);
        prop_assume!(knots.span_count() > 1);
        let t = knots.breaks()[1];
        match s.remove_knot(axis, t, 1) {
            Ok(r) => {
                let at = s.domain().at(f, g);
                prop_assert_eq!(r.surface.net().points.len() < s.net().points.len(), true);
                prop_assert!((r.surface.point(at) - s.point(at)).norm() <= r.bound_mm * (1.0 + 1e-9) + POINT);
                prop_assert!(r.bound_mm > 0.0);
            }
            // Weights that would leave the positive numbers are refused.
            Err(e) => prop_assert!(matches!(e, EditError::Weight { .. }), "{e}"),
        }
    }
}

#[test]
fn quadrics_stay_quadrics_when_raised() {
    for s in [sphere(20.0), torus(40.0, 9.0), cylinder(5.0, 8.0)] {
        let r = s.elevated(Axis::U, 1).unwrap().elevated(Axis::V, 2).unwrap();
        assert_eq!(r.degree(), [s.degree()[0] + 1, s.degree()[1] + 2]);
        assert_eq!((r.domain(), r.closed(Axis::U)), (s.domain(), true));
        for k in 0..50 {
            let at = s.domain().at(f64::from(k) / 49.0, (f64::from(k) * 0.61).fract());
            assert!((r.point(at) - s.point(at)).norm() < 1e-13);
            let (a, b) = (r.jet2(at), s.jet2(at));
            assert!((a.duv - b.duv).norm() < 1e-11 * (1.0 + b.duv.norm()), "{at:?}");
        }
    }
}

#[test]
fn a_line_raised_to_a_cubic_and_every_refusal() {
    let ends = vec![Point3::new(1.0, 2.0, 3.0), Point3::new(7.0, -1.0, 3.0)];
    let line: NurbsCurve3 = NurbsCurve::new(1, vec![0.0, 0.0, 1.0, 1.0], ends.clone(), None).unwrap();
    let cubic = line.elevated(2).unwrap();
    // Poles at thirds [The NURBS Book, 5.5].
    for (k, p) in cubic.poles().iter().enumerate() {
        assert!((p - (ends[0] + (ends[1] - ends[0]) * (k as f64 / 3.0))).norm() < 1e-15);
    }
    assert_eq!(line.elevated(40).unwrap_err(), EditError::Degree { degree: 41, most: 25 });
    let outside = EditError::Outside { got: 1.0, lo: 0.0, hi: 1.0 };
    assert_eq!(line.remove_knot(1.0, 1).unwrap_err(), outside);
    let missing = EditError::NoKnot { at: 0.5, multiplicity: 0, times: 1 };
    assert_eq!(line.remove_knot(0.5, 1).unwrap_err(), missing);
    let r = line.insert_knot(0.5, 1).unwrap().remove_knot(0.5, 1).unwrap();
    assert_eq!((r.curve.poles().len(), r.bound), (2, 0.0));
    // A corner cannot go: the bound says how far it moves, and it does.
    let poles = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [2.0, 0.0, 0.0]].map(Point3::from).to_vec();
    let roof: NurbsCurve3 = NurbsCurve::new(1, vec![0.0, 0.0, 1.0, 2.0, 2.0], poles, None).unwrap();
    let flat = roof.remove_knot(1.0, 1).unwrap();
    assert!((flat.bound - 1.0).abs() < 1e-15 && (flat.curve.point(1.0) - roof.point(1.0)).norm() == 1.0);
    assert!(reference(true).remove_knot(Axis::U, 0.123, 1).is_err());
    let far = reference(true).elevated(Axis::V, 1).unwrap();
    assert!((far.point(uv(0.3, 0.9)) - reference(true).point(uv(0.3, 0.9))).norm() < 1e-13);
}
