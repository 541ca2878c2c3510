//! Closest points: a thousand hard queries with known distances, closed forms on quadrics, every kind of
//! foot, and brute force on random surfaces.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{any_surface, cylinder, moved, reference, sphere, torus};
use osculate_geom::analytic::{Plane, Torus};
use osculate_geom::{Axis, Domain, Interval, Point3, Surface, Vec3, uv};
use osculate_surfaces::{
    ClosestError, Foot, FootKind, Net, NurbsSurface, closest, closest_batch, closest_near, closest_sampled,
};
use proptest::prelude::*;

/// Checks a foot against the surface: the point, the distance, and a right angle where the parameters are
/// free.
fn consistent(s: &NurbsSurface, q: &Point3, foot: &Foot) {
    assert!(s.domain().contains(foot.uv), "{foot:?}");
    let size = foot.point.coords.norm() + q.coords.norm();
    assert!((s.point(foot.uv) - foot.point).norm() <= 1e-14 * size, "{foot:?}");
    assert!(((foot.point - q).norm() - foot.distance_mm).abs() <= 1e-15 * size, "{foot:?}");
    assert!(foot.residual <= 1e-6, "{foot:?}");
}

fn far(rational: bool, data: &str, edges: usize) {
    let s = reference(rational);
    let mut lines = data.lines();
    let count: usize = lines.next().unwrap().parse().unwrap();
    let mut kinds = [0; 4];
    let mut seen = 0;
    for line in lines {
        let v: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
        let q = Point3::new(v[0], v[1], v[2]);
        let foot = closest(&s, &q, None).unwrap();
        consistent(&s, &q, &foot);
        // Never farther than the reference; nearer by what its Newton iteration left in flat valleys.
        let off = (foot.distance_mm - v[3]) / v[3];
        assert!((-1e-7..=1e-9).contains(&off), "{line}: {foot:?}");
        assert_eq!(foot.gap_mm, 0.0, "{line}");
        kinds[foot.kind as usize] += 1;
        seen += 1;
    }
    assert_eq!((seen, count), (1000, 1000));
    assert_eq!(kinds[FootKind::Edge as usize] + kinds[FootKind::Corner as usize], edges, "{kinds:?}");
}

#[test]
fn a_thousand_far_points_of_a_polynomial_surface() {
    far(false, include_str!("data/far_poly.txt"), 809);
}

#[test]
fn a_thousand_far_points_of_a_rational_surface() {
    far(true, include_str!("data/far_rat.txt"), 809);
}

#[test]
fn distances_from_a_sphere_are_exact_at_every_scale() {
    for scale in [1e-6, 1.0, 1e6] {
        let s = sphere(20.0 * scale);
        for k in 1..60 {
            let a = f64::from(k) * 0.37;
            let d = Vec3::new(a.cos(), a.sin(), 1.4 * (a * 0.7).sin()).normalize();
            for r in [4.0, 19.0, 20.0, 33.0] {
                let q = Point3::from(d * (r * scale));
                let foot = closest(&s, &q, None).unwrap();
                consistent(&s, &q, &foot);
                assert!(
                    (foot.distance_mm - (r - 20.0).abs() * scale).abs() <= 1e-13 * scale,
                    "{r}: {foot:?}"
                );
                assert!(foot.gap_mm <= 1e-11 * scale, "{foot:?}");
            }
        }
    }
}

/// A part a kilometre from its origin, with queries close to it: rounding of coordinates is 1e-10 mm there, and
/// that must not end a descent early.
#[test]
fn a_part_far_from_the_origin_is_found_from_near_it() {
    let shift = Vec3::new(1e6, -7e5, 3e5);
    for rational in [false, true] {
        let s = moved(&reference(rational), 1.0, shift);
        for k in 0..400 {
            let t = f64::from(k);
            let at = uv((t * 0.618_034).fract(), (t * 0.754_878).fract());
            let jet = s.jet2(at);
            let above = 0.001 + 0.1 * (t * 0.1).fract();
            let q = jet.point + jet.normal().unwrap().into_inner() * above;
            let foot = closest(&s, &q, None).unwrap();
            assert!(foot.distance_mm <= above + 1e-8, "{k}: {foot:?}");
            assert!(foot.residual <= 1e-6, "{k}: {foot:?}");
        }
    }
}

#[test]
fn the_axis_of_a_sphere_ends_at_its_pole() {
    let s = sphere(20.0);
    for z in [26.0, -31.0, 5.0] {
        let foot = closest(&s, &Point3::new(0.0, 0.0, z), None).unwrap();
        assert!((foot.distance_mm - (z.abs() - 20.0).abs()).abs() < 1e-9 && foot.gap_mm < 1e-6, "{foot:?}");
        assert!((foot.point.z - 20.0 * z.signum()).abs() < 1e-9);
    }
}

#[test]
fn the_centre_of_a_sphere_has_no_nearest_point_and_the_gap_says_so() {
    let s = sphere(20.0);
    let foot = closest(&s, &Point3::origin(), None).unwrap();
    assert!((foot.distance_mm - 20.0).abs() < 1e-12);
    // Everything is equally far, so that the work ends with small cells left: a proven bound all the same.
    assert!(foot.gap_mm > 0.0 && foot.gap_mm < 0.5, "{foot:?}");
}

#[test]
fn a_foot_on_a_smooth_seam_is_inside() {
    let c = cylinder(5.0, 30.0);
    // The seam is at y = 0, x > 0.
    let foot = closest(&c, &Point3::new(8.0, 0.0, 11.0), None).unwrap();
    assert_eq!(foot.kind, FootKind::Interior);
    assert!(
        (foot.distance_mm - 3.0).abs() < 1e-14 && (foot.point - Point3::new(5.0, 0.0, 11.0)).norm() < 1e-9
    );
    // A hint on the other side of the seam finds it across.
    let q = Point3::new(8.0, 0.4, 11.0);
    let near = closest(&c, &q, Some(uv(3.9, 10.0))).unwrap();
    assert!((near.distance_mm - (q.coords.xy().norm() - 5.0)).abs() < 1e-14 && near.uv.u < 0.2, "{near:?}");
    // Above the rim: an edge, not a corner, though u stands at its end.
    let rim = closest(&c, &Point3::new(8.0, 0.0, 34.0), None).unwrap();
    assert_eq!(rim.kind, FootKind::Edge);
    assert!((rim.distance_mm - 5.0).abs() < 1e-14 && rim.uv.v == 30.0);
}

/// A roof: two planes at a right angle that meet in a ridge along y.
fn roof() -> NurbsSurface {
    let points = [[-4.0, 0.0], [0.0, 4.0], [4.0, 0.0]]
        .iter()
        .flat_map(|c| [0.0, 9.0].map(|y| Point3::new(c[0], y, c[1])));
    let knots = [vec![0.0, 0.0, 1.0, 2.0, 2.0], vec![0.0, 0.0, 1.0, 1.0]];
    NurbsSurface::new([1, 1], knots, Net { count: [3, 2], points: points.collect(), weights: None }).unwrap()
}

#[test]
fn a_foot_on_a_crease() {
    let s = roof();
    let ridge = closest(&s, &Point3::new(0.5, 3.0, 9.0), None).unwrap();
    assert_eq!((ridge.kind, ridge.uv.u), (FootKind::Crease, 1.0));
    assert!((ridge.point - Point3::new(0.0, 3.0, 4.0)).norm() < 1e-12);
    assert!(
        (ridge.distance_mm - 25.25f64.sqrt()).abs() < 1e-14 && ridge.residual < 1e-12 && ridge.gap_mm == 0.0
    );
    // The end of the ridge is on an edge.
    let gable = closest(&s, &Point3::new(0.5, -3.0, 9.0), None).unwrap();
    assert_eq!(gable.kind, FootKind::Edge);
    assert!((gable.point - Point3::new(0.0, 0.0, 4.0)).norm() < 1e-12);
    // Inside the roof both planes are in reach; the nearer one is found.
    let inside = closest(&s, &Point3::new(0.5, 3.0, 1.0), None).unwrap();
    assert_eq!(inside.kind, FootKind::Interior);
    assert!((inside.distance_mm - 2.5 / 2f64.sqrt()).abs() < 1e-14 && inside.point.x > 0.0);
    // Corners.
    let corner = closest(&s, &Point3::new(9.0, -2.0, -1.0), None).unwrap();
    assert_eq!((corner.kind, corner.uv), (FootKind::Corner, uv(2.0, 0.0)));
}

#[test]
fn a_start_one_rounding_off_an_edge_ends_on_it() {
    let s = reference(true);
    let q = Point3::new(130.0, 40.0, 5.0);
    for u in [1.0, 1.0f64.next_down(), 1.0 - 1e-14, 0.99] {
        let foot = closest(&s, &q, Some(uv(u, 0.4))).unwrap();
        assert_eq!((foot.kind, foot.uv.u), (FootKind::Edge, 1.0), "{foot:?}");
        assert!(foot.residual < 1e-12);
    }
}

#[test]
fn a_batch_is_its_queries_one_by_one() {
    let s = reference(true);
    let mut queries: Vec<Point3> = (0..300)
        .map(|k| Point3::new(f64::from(k % 17) * 5.0, f64::from(k % 13) * 6.0, f64::from(k % 7)))
        .collect();
    queries[40].x = f64::NAN;
    let hints: Vec<_> = (0..150).map(|k| uv(f64::from(k % 10) / 10.0, 0.5)).collect();
    for hints in [None, Some(&hints[..])] {
        let all = closest_batch(&s, &queries, hints);
        assert_eq!(all.len(), queries.len());
        for (k, (q, foot)) in queries.iter().zip(&all).enumerate() {
            let one = closest(&s, q, hints.and_then(|h| h.get(k).copied()));
            assert!(*foot == one || (k == 40 && foot.is_err() && one.is_err()), "{k}");
        }
    }
}

#[test]
fn what_is_not_finite_is_refused() {
    let s = reference(false);
    let q = Point3::new(f64::NAN, 0.0, 0.0);
    assert!(matches!(closest(&s, &q, None), Err(ClosestError::NotFinite { .. })));
    assert!(matches!(closest(&s, &q, Some(uv(0.5, 0.5))), Err(ClosestError::NotFinite { .. })));
    let hint = closest(&s, &Point3::origin(), Some(uv(f64::INFINITY, 0.0)));
    assert!(matches!(hint, Err(ClosestError::NotFinite { .. })));
}

#[test]
fn sampled_search_on_surfaces_with_a_closed_form() {
    let t = Torus::new(40.0, 9.0).unwrap();
    for k in 0..40 {
        let a = f64::from(k);
        let q = Point3::new(60.0 * a.cos(), 55.0 * (1.3 * a).sin(), 30.0 * (0.7 * a).cos());
        let ring = q.coords.xy().norm() - 40.0;
        let want = (ring.hypot(q.z) - 9.0).abs();
        let foot = closest_sampled(&t, &q).unwrap();
        assert!((foot.distance_mm - want).abs() < 1e-12 && foot.residual < 1e-12, "{foot:?} {want}");
        // Nothing is proven about the rest of the surface.
        assert_eq!(foot.gap_mm, foot.distance_mm);
        let nurbs = closest(&torus(40.0, 9.0), &q, None).unwrap();
        assert!((nurbs.distance_mm - want).abs() < 1e-12, "{nurbs:?} {want}");
    }
}

#[test]
fn a_surface_without_end_needs_a_hint() {
    let all = Interval::new(f64::NEG_INFINITY, f64::INFINITY);
    let s = Plane::new(Domain { u: all, v: all });
    let q = Point3::new(70.0, -30.0, 4.0);
    let refused = closest_sampled(&s, &q).unwrap_err();
    assert_eq!(refused, ClosestError::Unbounded { axis: Axis::U });
    let foot = closest_near(&s, &q, uv(0.0, 0.0)).unwrap();
    assert!((foot.distance_mm - 4.0).abs() < 1e-14 && foot.kind == FootKind::Interior);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn nothing_sampled_is_nearer(
        s in any_surface(), x in -40.0f64..130.0, y in -40.0f64..130.0, z in -60.0f64..60.0,
    ) {
        let q = Point3::new(x, y, z);
        let foot = closest(&s, &q, None).unwrap();
        consistent(&s, &q, &foot);
        let n = 150;
        let mut least = f64::INFINITY;
        for i in 0..=n {
            for k in 0..=n {
                let at = s.domain().at(f64::from(i) / f64::from(n), f64::from(k) / f64::from(n));
                least = least.min((s.point(at) - q).norm());
            }
        }
        prop_assert!(foot.distance_mm - foot.gap_mm <= least + 1e-11, "{} {}", foot.distance_mm, least);
        prop_assert!(foot.distance_mm <= least + 1e-11 || foot.gap_mm > 0.0);
        // Twice is the same to the bit.
        prop_assert_eq!(foot, closest(&s.clone(), &q, None).unwrap());
    }

    #[test]
    fn a_point_above_the_surface_comes_back(
        s in any_surface(), f in 0.02f64..0.98, g in 0.02f64..0.98, up in -0.3f64..0.3,
    ) {
        let at = s.domain().at(f, g);
        let jet = s.jet2(at);
        let sine = jet.du.cross(&jet.dv).norm() / (jet.du.norm() * jet.dv.norm());
        let Ok(forms) = jet.forms() else { return Ok(()) };
        let p = forms.principal();
        // Well inside both centres of curvature and not on a fold, the foot below a point is where it came
        // from.
        prop_assume!(sine > 0.2 && p.k_max.abs().max(p.k_min.abs()) * up.abs() < 0.3);
        let q = jet.point + forms.normal.into_inner() * up;
        let (du, dv) = (1e-3 * s.domain().u.length(), 1e-3 * s.domain().v.length());
        let near = closest(&s, &q, Some(uv(at.u + du, at.v - dv))).unwrap();
        // Coordinates of 130 mm to 1e-14, and the descent stops at that. Where the surface bends sharply beside it the descent may come
        // to another foot, which is nearer then.
        let came_back = (near.point - jet.point).norm() < 1e-10 * (1.0 + 1.0 / sine);
        prop_assert!(came_back || near.distance_mm < up.abs() - 1e-9, "{near:?} {at:?} {up}");
        let whole = closest(&s, &q, None).unwrap();
        prop_assert!(whole.distance_mm <= near.distance_mm + 1e-12);
    }

    #[test]
    fn scale_and_place_do_not_matter(
        x in -20.0f64..120.0, y in -20.0f64..120.0, z in -40.0f64..40.0, rational in any::<bool>(),
    ) {
        let s = reference(rational);
        let q = Point3::new(x, y, z);
        let here = closest(&s, &q, None).unwrap();
        for (scale, shift) in [(1e-6, Vec3::zeros()), (1e6, Vec3::zeros()), (1.0, Vec3::new(1e3, -2e3, 500.0))] {
            let there = closest(&moved(&s, scale, shift), &(q * scale + shift), None).unwrap();
            // Coordinates rounded at 2e3 mm, over a distance of millimetres.
            prop_assert!((there.distance_mm / scale - here.distance_mm).abs() <= 1e-11, "{here:?} {there:?}");
            prop_assert_eq!(there.kind, here.kind);
        }
        let swapped = closest(&s.swapped(), &q, None).unwrap();
        prop_assert!((swapped.distance_mm - here.distance_mm).abs() <= 1e-12);
    }
}
