//! Whatever the numbers are: constructors refuse what makes no curve or surface, and what they accept answers without a
//! panic, anywhere.

use osculate_geom::analytic::{
    Cone, Conic, ConicKind, Cylinder, Ellipsoid, Line, Paraboloid, Placed, Placement, Sphere, Spindle, Torus,
};
use osculate_geom::indicatrix::Conformity;
use osculate_geom::limit::{self, Tolerance};
use osculate_geom::offset::clear_range;
use osculate_geom::{
    Axis, Curve, Extruded, Flipped, Interval, MAX_ORDER, Offset, Point3, Revolved, Ruled, Series, Surface,
    ToolCurvature, TurnAxis, Unit3, Vec3, curve, uv,
};
use proptest::prelude::*;

/// Numbers of all sizes, and those that are none.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -10.0..10.0f64,
        1 => (-320.0..308.0f64).prop_map(|e| 10f64.powf(e)),
        1 => (-320.0..308.0f64).prop_map(|e| -10f64.powf(e)),
        1 => prop_oneof![
            Just(0.0), Just(-0.0), Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY),
            Just(f64::MIN_POSITIVE), Just(f64::MAX)
        ],
    ]
}

fn numbers<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    proptest::collection::vec(any_number(), N).prop_map(|v| std::array::from_fn(|k| v[k]))
}

/// Everything that can be asked of a surface, at one place.
fn ask(s: &dyn Surface, at: [f64; 2]) {
    let at = uv(at[0], at[1]);
    let jet = s.jet3(at);
    for order in [0, 1, 3, MAX_ORDER, 100] {
        assert!(s.taylor(at, order).order() <= MAX_ORDER.min(order));
    }
    let _ = (s.point(at), s.contains(at), s.breaks(Axis::U), s.domain().bring(at));
    if let Ok(f) = jet.jet2.forms() {
        let k = f.principal();
        // Numbers that overflow end in NaN, not in the wrong order.
        assert!(k.k_max >= k.k_min || k.k_max.is_nan() || k.k_min.is_nan());
        let tool = ToolCurvature { along: 0.1, across: 0.2, direction: f.frame[0] };
        let _ = Conformity::new(f, tool).root_mm(&Vec3::x());
    }
    for answer in
        [limit::normal(s, at, &Tolerance::ROUNDING).err(), limit::forms(s, at, &Tolerance::ROUNDING).err()]
    {
        assert!(answer.is_none_or(|e| !e.to_string().is_empty()));
    }
    let _ = limit::sides(s, at, &Tolerance::ROUNDING);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn closed_forms_refuse_or_answer(x in numbers::<5>(), at in numbers::<2>()) {
        let range = Interval::new(x[3], x[4]);
        let mut all: Vec<Box<dyn Surface>> = Vec::new();
        let good = |v: f64| v > 0.0 && v.is_finite();
        match Sphere::new(x[0]) {
            Ok(s) => { prop_assert!(good(x[0])); all.push(Box::new(s)); }
            Err(e) => { prop_assert!(!good(x[0]) && e.to_string().contains("radius_mm")); }
        }
        match Cylinder::new(x[0], range) {
            Ok(s) => { prop_assert!(good(x[0]) && x[3] <= x[4]); all.push(Box::new(s)); }
            Err(_) => prop_assert!(!(good(x[0]) && x[3] <= x[4])),
        }
        if let Ok(s) = Cone::new(x[0], x[1], range) {
            prop_assert!(x[0] >= 0.0 && x[1].abs() < 1.571);
            all.push(Box::new(s));
        }
        match Torus::new(x[0], x[1]) {
            Ok(s) => {
                prop_assert!(good(x[0]) && good(x[1]));
                for part in [Spindle::Apple, Spindle::Lemon] {
                    if let Ok(s) = s.spindle(part) {
                        prop_assert!(x[0] <= x[1]);
                        all.push(Box::new(s));
                    }
                }
                all.push(Box::new(s));
            }
            Err(_) => prop_assert!(!(good(x[0]) && good(x[1]))),
        }
        if let Ok(s) = Ellipsoid::new([x[0], x[1], x[2]]) {
            prop_assert!(x[..3].iter().all(|a| good(*a)));
            all.push(Box::new(Flipped(s)));
        }
        if let Ok(s) = Paraboloid::new([x[0], x[1]], x[2]) {
            prop_assert!(x[0].is_finite() && x[1].is_finite() && good(x[2]));
            if let Ok(o) = Offset::new(s, x[3]) {
                prop_assert!(x[3].is_finite());
                let _ = (o.regular(uv(at[0], at[1])), o.check(2));
                all.push(Box::new(o));
            }
            let _ = clear_range(&s, 2);
            all.push(Box::new(s));
        }
        for s in all {
            ask(&*s, at);
            // Its own corners and middle, where a finite rectangle has them.
            for (f, g) in [(0.0, 0.0), (1.0, 1.0), (0.5, 0.0), (0.5, 0.5)] {
                let p = s.domain().at(f, g);
                ask(&*s, [p.u, p.v]);
            }
        }
    }

    #[test]
    fn curves_and_sweeps_refuse_or_answer(x in numbers::<6>(), r in numbers::<2>(), at in numbers::<2>()) {
        let range = Interval::new(r[0], r[1]);
        let frame = Placement::identity();
        let mut curves: Vec<std::sync::Arc<dyn Curve>> = Vec::new();
        if let Ok(c) = Line::new(Point3::new(x[0], x[1], x[2]), Vec3::new(x[3], x[4], x[5]), range) {
            prop_assert!(x.iter().all(|v| v.is_finite()) && r[0] < r[1]);
            curves.push(std::sync::Arc::new(c));
        }
        for kind in [
            ConicKind::Ellipse { semi_axes_mm: [x[0], x[1]] },
            ConicKind::Parabola { focal_mm: x[0] },
            ConicKind::Hyperbola { semi_axes_mm: [x[0], x[1]] },
        ] {
            if let Ok(c) = Conic::new(kind, frame, range) {
                prop_assert!(x[0] > 0.0 && r[0] < r[1]);
                curves.push(std::sync::Arc::new(c));
            }
        }
        let axis = TurnAxis { origin: Point3::new(x[2], x[3], 0.0), direction: Unit3::new_normalize(Vec3::z()) };
        for c in &curves {
            for t in [at[0], at[1], r[0], r[1]] {
                let jet = c.jet(t);
                if let Ok(f) = jet.frenet() {
                    prop_assert!(f.curvature_per_mm >= 0.0 || f.curvature_per_mm.is_nan());
                }
                let _ = (c.point(t), c.breaks(), jet.curvature_per_mm());
            }
            if let Ok(s) = Revolved::new(c.clone(), axis, Interval::new(x[4], x[5])) {
                prop_assert!(x[4] < x[5]);
                ask(&s, at);
                ask(&s, [x[4], r[0]]);
            }
            if let Ok(s) = Extruded::new(c.clone(), Vec3::new(x[3], x[4], x[5]), range) {
                ask(&s, at);
                let placed = Placed { surface: s, placement: frame };
                ask(&placed, [r[0], r[1]]);
            }
            if let Ok(s) = Ruled::new(c.clone(), curves[0].clone()) {
                ask(&s, at);
                ask(&s, [r[0], 0.0]);
            }
        }
    }

    /// Lengths end, with a number or an error, for curves of ordinary size.
    #[test]
    fn lengths_end(a in 0.01..100.0f64, b in 0.01..100.0f64, lo in -3.0..3.0f64, l in any_number(), tol in 1e-9..1e-3f64) {
        let kind = ConicKind::Hyperbola { semi_axes_mm: [a, b] };
        let c = Conic::new(kind, Placement::identity(), Interval::new(lo, lo + 2.0)).unwrap();
        if let Ok(t) = curve::parameter_at(&c, l, tol) {
            let back = curve::length(&c, Interval::new(lo, t), 1e-12).value;
            prop_assert!((back - l).abs() <= 2.0 * tol + 1e-11 * back, "{back} {l}");
        } else {
            let whole = curve::length(&c, c.domain(), 1e-12).value;
            prop_assert!(!(l >= 0.0 && l <= whole));
        }
    }

    /// Series of any numbers: no panic, and orders that are not known are NaN.
    #[test]
    fn series_never_panic(x in numbers::<3>(), order in 0usize..12) {
        let (u, v) = (Series::variable(Axis::U, x[0], order), Series::variable(Axis::V, x[1], order));
        let f = (u * v + u.sin_cos().0 * x[2]).sqrt().recip();
        prop_assert!(f.order() == order.min(MAX_ORDER));
        prop_assert!(f.derivative(f.order() + 1, 0).is_nan() && f.coefficient(usize::MAX / 4, 0).is_nan());
        prop_assert!(f.differentiated(Axis::U).order() <= f.order());
    }
}
