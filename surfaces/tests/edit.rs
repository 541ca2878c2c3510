//! Refining, cutting and turning NURBS surfaces and curves: every result against evaluation of the original.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{any_surface, cylinder};
use osculate_geom::{Axis, Domain, Interval, Jet2, Point3, Surface, uv};
use osculate_surfaces::{EditError, NurbsCurve, NurbsCurve2, NurbsSurface};
use proptest::prelude::*;

/// Coordinates are up to 130 mm and means are convex: a few roundings at each of two axes, and up to 18 bits
/// for the powers of degree 9 (7 at most is evaluated by powers).
const POINT: f64 = 1e-10;

fn same_jet(a: &Jet2, b: &Jet2) -> Result<(), TestCaseError> {
    let pairs = [(a.du, b.du), (a.dv, b.dv), (a.duu, b.duu), (a.duv, b.duv), (a.dvv, b.dvv)];
    let size = pairs.iter().fold(100.0_f64, |m, (x, _)| m.max(x.norm()));
    prop_assert!((a.point - b.point).norm() <= POINT, "{a:?} {b:?}");
    for (x, y) in pairs {
        // Derivatives of a cut piece multiply the rounding of poles by the square of twice the degree over a
        // span, a tenth of a unit at least: 1e-14 * (2 * 9 / 0.1)^2 of the poles.
        prop_assert!((x - y).norm() <= 1e-8 * size, "{x:?} {y:?}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn inserted_knots_change_nothing(
        s in any_surface(), t in 0.05f64..0.95, f in 0.0f64..=1.0, g in 0.0f64..=1.0, along in any::<bool>(),
    ) {
        let axis = if along { Axis::U } else { Axis::V };
        let at = s.domain().get(axis).at(t);
        let degree = s.knots(axis).degree();
        let finer = s.insert_knot(axis, at, degree).unwrap();
        prop_assert_eq!(finer.knots(axis).multiplicity(at), degree);
        prop_assert_eq!(finer.knots(axis).poles(), s.knots(axis).poles() + degree);
        prop_assert_eq!(finer.domain(), s.domain());
        let place = s.domain().at(f, g);
        prop_assert!((s.point(place) - finer.point(place)).norm() <= POINT);
        prop_assert_eq!(
            finer.insert_knot(axis, at, 1).unwrap_err(),
            EditError::Multiplicity { at, multiplicity: degree + 1, degree }
        );
    }

    #[test]
    fn a_piece_is_the_surface_there(
        s in any_surface(), a in 0.0f64..0.45, b in 0.55f64..1.0, f in 0.0f64..=1.0, g in 0.0f64..=1.0,
    ) {
        let d = s.domain();
        let part = Domain {
            u: Interval::new(d.u.at(a), d.u.at(b)),
            v: Interval::new(d.v.at(1.0 - b), d.v.at(1.0 - a)),
        };
        let piece = s.restricted(&part).unwrap();
        prop_assert_eq!((piece.domain().u.lo, piece.domain().v.hi), (part.u.lo, part.v.hi));
        let at = part.at(f, g);
        // At a knot the right-hand piece counts for both unless the cut is there; second derivatives jump.
        let far = |axis: Axis, t: f64| s.breaks(axis).iter().all(|k| (k - t).abs() > 1e-9);
        if far(Axis::U, at.u) && far(Axis::V, at.v) {
            same_jet(&s.jet2(at), &piece.jet2(at))?;
        }
        // Clamped: its corners are poles.
        let last = piece.net().points.len() - 1;
        prop_assert!((piece.net().points[0] - s.point(uv(part.u.lo, part.v.lo))).norm() <= POINT);
        prop_assert!((piece.net().points[last] - s.point(uv(part.u.hi, part.v.hi))).norm() <= POINT);
    }

    #[test]
    fn bezier_patches_cover_the_surface(s in any_surface(), f in 0.0f64..=1.0, g in 0.0f64..=1.0) {
        let patches = s.bezier_patches();
        prop_assert_eq!(patches.len(), s.knots(Axis::U).span_count() * s.knots(Axis::V).span_count());
        let at = s.domain().at(f, g);
        let patch = patches.iter().find(|p| p.domain.contains(at)).unwrap();
        // De Casteljau's scheme in both directions, a way of evaluation that shares nothing with the
        // surface's.
        let [n, m] = patch.net.count;
        let weight = |k: usize| patch.net.weights.as_ref().map_or(1.0, |w| w[k]);
        let reduce = |mut row: Vec<nalgebra::Vector4<f64>>, t: f64| {
            while row.len() > 1 {
                row = row.windows(2).map(|w| w[0] * (1.0 - t) + w[1] * t).collect();
            }
            row[0]
        };
        let part = |i: Interval, t: f64| (t - i.lo) / i.length();
        let column = (0..n).map(|i| {
            let row = (0..m).map(|j| {
                let (p, w) = (patch.net.points[i * m + j], weight(i * m + j));
                nalgebra::Vector4::new(p.x * w, p.y * w, p.z * w, w)
            });
            reduce(row.collect(), part(patch.domain.v, at.v))
        });
        let sum = reduce(column.collect(), part(patch.domain.u, at.u));
        prop_assert!((Point3::from(sum.xyz() / sum.w) - s.point(at)).norm() <= POINT);
    }

    #[test]
    fn turned_and_swapped_parameters(s in any_surface(), f in 0.0f64..=1.0, g in 0.0f64..=1.0) {
        let d = s.domain();
        let at = d.at(f, g);
        let (a, r, w) = (s.jet2(at), s.reversed(Axis::U), s.swapped());
        let b = r.jet2(uv(d.u.lo + (d.u.hi - at.u), at.v));
        prop_assert!((a.point - b.point).norm() <= POINT);
        let c = w.jet2(uv(at.v, at.u));
        prop_assert!((a.point - c.point).norm() <= POINT && (a.du - c.dv).norm() <= 1e-8 * a.du.norm().max(100.0));
        // The outward normal is that of the original.
        if let (Ok(n), Ok(nc)) = (a.normal(), c.normal()) {
            let sine = a.du.cross(&a.dv).norm() / (a.du.norm() * a.dv.norm());
            if sine > 0.01 {
                prop_assert!(n.dot(&nc) > 1.0 - 1e-9);
            }
        }
        let (again, back) = (w.swapped(), r.reversed(Axis::U));
        prop_assert_eq!(again.net(), s.net());
        prop_assert_eq!(back.net(), s.net());
        prop_assert_eq!(s.reversed(Axis::V).reversed(Axis::U).swapped().side(), s.side().flipped());
    }

    #[test]
    fn both_parts_of_a_split(s in any_surface(), t in 0.05f64..0.95, f in 0.0f64..=1.0, g in 0.0f64..=1.0) {
        let at = s.domain().v.at(t);
        let [low, high] = s.split(Axis::V, at).unwrap();
        let place = s.domain().at(f, g);
        let part = if place.v < at { &low } else { &high };
        prop_assert!(part.domain().contains(place));
        prop_assert!((part.point(place) - s.point(place)).norm() <= POINT);
    }
}

#[test]
fn cutting_a_closed_surface_opens_it() {
    let c = cylinder(5.0, 8.0);
    let [half, _] = c.split(Axis::U, 2.0).unwrap();
    assert!(c.domain().u.periodic && !half.domain().u.periodic && !half.closed(Axis::U));
    assert!((half.point(uv(1.7, 3.0)).coords.xy().norm() - 5.0).abs() < 4e-15);
    let refused = c.split(Axis::U, 4.0).unwrap_err();
    assert_eq!(refused, EditError::Outside { got: 4.0, lo: 0.0, hi: 4.0 });
    let mut d = c.domain();
    d.v.hi = 9.0;
    assert_eq!(c.restricted(&d).unwrap_err(), EditError::Interval { from: 0.0, to: 9.0, lo: 0.0, hi: 8.0 });
    d.v = Interval::new(f64::NAN, 1.0);
    assert!(c.restricted(&d).is_err());
}

/// A plane curve with a double knot, clamped or not.
fn any_curve() -> impl Strategy<Value = NurbsCurve2> {
    (1usize..7, 0usize..6, any::<bool>(), any::<bool>(), proptest::collection::vec(-1.0f64..1.0, 60))
        .prop_map(|(p, extra, clamped, rational, x)| {
            let n = p + 1 + extra;
            let mut t = 0.0;
            let knots = (0..=n + p)
                .map(|i| {
                    let fixed = clamped && (i <= p || i > n);
                    if i > 0 && !fixed && !(p > 1 && i == p + 2 && i < n) {
                        t += 0.6 + 0.4 * x[i];
                    }
                    t
                })
                .collect();
            let poles = (0..n).map(|k| [k as f64 + 2.0 * x[3 * k], 2.0 * x[3 * k + 1]].into()).collect();
            let weights = rational.then(|| (0..n).map(|k| 1.5 + x[3 * k + 2]).collect());
            NurbsCurve::new(p, knots, poles, weights).unwrap()
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn curves_refined_cut_and_turned(c in any_curve(), t in 0.05f64..0.95, f in 0.0f64..=1.0) {
        let d = c.domain();
        let (cut, at) = (d.at(t), d.at(f));
        let p = c.point(at);
        // Poles within 15 units: roundings of convex means.
        let near = |q: nalgebra::Point2<f64>| (p - q).norm() <= 1e-13;
        prop_assert!(near(c.insert_knot(cut, c.degree()).unwrap().point(at)));
        // Many at once as one after the other.
        let more = [(cut, 1), (at.max(cut), usize::from(at > cut && at < d.hi))];
        let one_by_one = more.iter().try_fold(c.clone(), |c, (t, times)| c.insert_knot(*t, *times)).unwrap();
        let at_once = c.insert_knots(&more).unwrap();
        prop_assert_eq!(at_once.knots(), one_by_one.knots());
        prop_assert!(near(at_once.point(at)));
        let [low, high] = c.split(cut).unwrap();
        let part = if at < cut { &low } else { &high };
        prop_assert!(near(part.point(at)));
        prop_assert!(near(c.reversed().point(d.lo + (d.hi - at))));
        let pieces = c.bezier_pieces();
        prop_assert!(near(pieces.iter().find(|b| b.domain().contains(at)).unwrap().point(at)));
        if f > 0.0 {
            prop_assert!(near(c.restricted(Interval::new(d.lo, at)).unwrap().point(at)));
        }
    }

    #[test]
    fn curve_derivatives_match_differences(c in any_curve(), f in 0.0f64..1.0) {
        let b = c.knots().breaks();
        let k = ((b.len() - 1) as f64 * f) as usize;
        let h = 1e-4 * (b[k + 1] - b[k]);
        let t = b[k] + (b[k + 1] - b[k]) * (0.01 + 0.98 * ((b.len() - 1) as f64 * f - k as f64));
        let (j, up, down) = (c.jet(t), c.jet(t + h), c.jet(t - h));
        prop_assert!((j.point - c.point(t)).norm() <= 1e-13);
        // The third derivative is at most some (4 * 6)^3 of a span to the third: 1e4 * 1e-8 / 6, times a few
        // units.
        let (size1, size2) = (j.first.norm().max(10.0), j.second.norm().max(100.0));
        prop_assert!(((up.point - down.point) / (2.0 * h) - j.first).norm() <= 1e-4 * size1);
        prop_assert!(((up.first - down.first) / (2.0 * h) - j.second).norm() <= 1e-3 * size2);
    }

    #[test]
    fn polylines_keep_their_chord(c in any_curve(), digits in 1i32..5) {
        let chord = 10f64.powi(-digits);
        let ts = c.polyline(chord).unwrap();
        prop_assert_eq!((ts[0], ts[ts.len() - 1]), (c.domain().lo, c.domain().hi));
        for k in c.knots().breaks() {
            prop_assert!(ts.contains(k));
        }
        for w in ts.windows(2) {
            prop_assert!(w[0] < w[1]);
            let (a, b) = (c.point(w[0]), c.point(w[1]));
            for i in 1..8 {
                let q = c.point(w[0] + (w[1] - w[0]) * f64::from(i) / 8.0);
                let along = b - a;
                let s = ((q - a).dot(&along) / along.norm_squared().max(1e-300)).clamp(0.0, 1.0);
                prop_assert!((a + along * s - q).norm() <= chord * (1.0 + 1e-9) + 1e-13);
            }
        }
    }
}

#[test]
fn a_surface_of_a_high_degree_is_evaluated_directly() {
    // Degree 20 in one direction: z = x^20 by its Bezier poles is e_20 alone.
    let n = 21;
    let points = (0..n)
        .flat_map(|i| [0.0, 1.0].map(|y| Point3::new(i as f64 / 20.0, y, if i == 20 { 1.0 } else { 0.0 })))
        .collect();
    let knots = [vec![0.0; n].into_iter().chain(vec![1.0; n]).collect(), vec![0.0, 0.0, 1.0, 1.0]];
    let s =
        NurbsSurface::new([20, 1], knots, osculate_surfaces::Net { count: [n, 2], points, weights: None })
            .unwrap();
    for x in [0.0, 0.3, 0.77, 1.0f64] {
        let j = s.jet2(uv(x, 0.5));
        // Sums of 21 terms below one, times 20 and 380 for the derivatives.
        assert!((j.point - Point3::new(x, 0.5, x.powi(20))).norm() < 2e-14);
        assert!((j.du.z - 20.0 * x.powi(19)).abs() < 4e-13 && (j.duu.z - 380.0 * x.powi(18)).abs() < 1e-11);
        let q = Point3::new(x, 0.5, x.powi(20) - 2.0);
        let foot = osculate_surfaces::closest(&s, &q, None).unwrap();
        assert!(foot.distance_mm <= 2.0 && foot.gap_mm == 0.0, "{foot:?}");
    }
}
