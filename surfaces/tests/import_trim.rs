//! Trimmed surfaces and their triangles against closed forms and brute force.

use osculate_geom::analytic::{Cylinder, Paraboloid, Plane, Sphere};
use osculate_geom::{Axis, Domain, Interval, Side, Surface, Uv, laws, uv};
use osculate_surfaces::{TrimError, TrimmedSurface, tessellate};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Instant;

fn plane() -> Arc<dyn Surface> {
    let i = Interval::new(-2.0, 2.0);
    Arc::new(Plane::new(Domain { u: i, v: i }))
}

fn ellipse(centre: Uv, axes: [f64; 2], n: usize) -> Vec<Uv> {
    (0..n)
        .map(|k| {
            let t = TAU * k as f64 / n as f64;
            uv(centre.u + axes[0] * t.cos(), centre.v + axes[1] * t.sin())
        })
        .collect()
}

/// Area of the regular n-gon in a circle is short of the circle's by 2 pi^2 / (3 n^2) of it.
const SHORT: f64 = 2.0 * PI * PI / 3.0;

#[test]
fn an_ellipse_with_a_hole() {
    let loops = [ellipse(uv(0.1, 0.0), [1.5, 1.0], 1000), ellipse(uv(0.3, 0.2), [0.3, 0.2], 1000)];
    let s = TrimmedSurface::new(plane(), &loops, Side::Along).unwrap();
    let want = PI * (1.5 - 0.06);
    assert!((s.area_mm2() - want).abs() < 2.0 * SHORT * 1e-6 * want);
    assert!(s.loops()[0].signed_area() > s.loops()[1].signed_area());
    let b = s.bbox(4);
    assert!((b.max.x - 1.6).abs() < 1e-12 && (b.min.y + 1.0).abs() < 1e-12 && b.max.z == 0.0);
}

#[test]
fn loops_around_a_cylinder() {
    // Between z = 1 and a wave about z = 3: the loop runs around, beginning anywhere.
    let carrier: Arc<dyn Surface> = Arc::new(Cylinder::new(2.0, Interval::new(0.0, 5.0)).unwrap());
    let ring = |height: &dyn Fn(f64) -> f64, start: f64| -> Vec<Uv> {
        (0..=1000).map(|k| start + TAU * f64::from(k) / 1000.0).map(|u| uv(u, height(u))).collect()
    };
    let wave = |u: f64| 3.0 + 0.5 * (3.0 * u).sin();
    let s = TrimmedSurface::new(carrier, &[ring(&|_| 1.0, 0.0), ring(&wave, 2.0)], Side::Along).unwrap();
    // The wave has mean zero.
    assert!((s.area_mm2() - 8.0 * PI).abs() < 1e-9);
    for k in 0..200 {
        let u = 0.05 * f64::from(k) - 2.0;
        assert!(s.contains(uv(u, 1.001)) && !s.contains(uv(u, 0.999)), "{u}");
        assert!(s.contains(uv(u, wave(u) - 1e-4)) && !s.contains(uv(u, wave(u) + 1e-4)), "{u}");
    }
    // One outline, cut along the seam, with the same area in parameters.
    assert_eq!(s.loops().len(), 1);
    assert!((s.loops()[0].signed_area().abs() - 2.0 * TAU).abs() < 1e-9);
    let span = s.spans(Axis::V, 1.0);
    assert!(span.len() == 1 && (span[0].lo - 1.0).abs() < 1e-12 && (span[0].hi - wave(1.0)).abs() < 1e-5);
    assert!(s.spans(Axis::U, 0.5).is_empty() && s.spans(Axis::U, 2.0).len() == 1);
}

#[test]
fn a_loop_across_the_seam() {
    let carrier: Arc<dyn Surface> = Arc::new(Cylinder::new(2.0, Interval::new(0.0, 5.0)).unwrap());
    let s = TrimmedSurface::new(carrier, &[ellipse(uv(0.1, 2.0), [0.5, 1.0], 2000)], Side::Along).unwrap();
    let want = 2.0 * PI * 0.5;
    assert!((s.area_mm2() - want).abs() < SHORT * 1e-6 * want);
    assert!(s.contains(uv(TAU - 0.2, 2.0)) && s.contains(uv(0.3, 2.0)) && !s.contains(uv(1.0, 2.0)));
    assert!(s.contains(uv(-0.2, 2.0)) && s.contains(uv(TAU + 0.3, 2.0)));
    // Cut in two along the seam.
    assert_eq!(s.loops().len(), 2);
    let total: f64 = s.loops().iter().map(|l| l.signed_area().abs()).sum();
    assert!((total - PI * 0.5).abs() < 1e-5);
    assert_eq!(s.spans(Axis::U, 2.0).len(), 2);
}

#[test]
fn errors_and_whole_rectangles() {
    let two = vec![uv(0.0, 0.0), uv(1.0, 0.0)];
    let e = TrimmedSurface::new(plane(), std::slice::from_ref(&two), Side::Along).unwrap_err();
    assert_eq!(e, TrimError::TooFewPoints { index: 0, got: 2 });
    let nan = vec![uv(0.0, 0.0), uv(1.0, 0.0), uv(0.0, f64::NAN)];
    assert!(matches!(
        TrimmedSurface::new(plane(), &[nan], Side::Along),
        Err(TrimError::NotFinite { index: 0, .. })
    ));
    let flat = vec![uv(0.0, 0.0), uv(1.0, 0.0), uv(0.5, 0.0)];
    assert!(matches!(TrimmedSurface::new(plane(), &[flat], Side::Along), Err(TrimError::Empty { loops: 1 })));
    let i = Interval::new(f64::NEG_INFINITY, 1.0);
    let open: Arc<dyn Surface> = Arc::new(Plane::new(Domain { u: i, v: Interval::new(0.0, 1.0) }));
    assert!(matches!(
        TrimmedSurface::new(open, &[], Side::Along),
        Err(TrimError::Unlimited { axis: Axis::U })
    ));
    let square = vec![uv(-2.0, -2.0), uv(2.0, -2.0), uv(2.0, 2.0), uv(-2.0, 2.0)];
    let whole = TrimmedSurface::new(plane(), &[square], Side::Against).unwrap();
    assert!(!whole.is_trimmed() && whole.jet2(uv(0.0, 0.0)).normal().unwrap().z == -1.0);
    assert_eq!(whole.flipped().jet2(uv(0.0, 0.0)).normal().unwrap().z, 1.0);
}

#[test]
fn the_inside_test_is_quick() {
    // A wavy loop of 2000 segments.
    let points: Vec<Uv> = (0..2000)
        .map(|k| {
            let t = TAU * f64::from(k) / 2000.0;
            let r = 1.0 + 0.3 * (40.0 * t).sin();
            uv(r * t.cos(), r * t.sin())
        })
        .collect();
    let s = TrimmedSurface::new(plane(), &[points], Side::Along).unwrap();
    let n = 200_000;
    let (mut inside, mut each_ns) = (0_u32, f64::INFINITY);
    let (mut start, block) = (Instant::now(), 5000);
    for k in 0..n {
        let (f, g) = (f64::from(k) * 0.618_033_988_75 % 1.0, f64::from(k) * 0.414_213_562_37 % 1.0);
        inside += u32::from(s.contains(uv(4.0 * f - 2.0, 4.0 * g - 2.0)));
        // The least of forty blocks: other work on the machine does not slow down all of them.
        if (k + 1) % block == 0 {
            each_ns = each_ns.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(block));
            start = Instant::now();
        }
    }
    // Area pi (1 + 0.09 / 2) of 16; the points fill the square evenly to about 1e-4.
    assert!((f64::from(inside) / f64::from(n) - PI * 1.045 / 16.0).abs() < 1e-3);
    // About 100 ns on a slow core; a scan of all segments takes 2000.
    assert!(each_ns < 1000.0, "{each_ns} ns");
}

#[test]
fn jets_are_the_carriers() {
    let bowl: Arc<dyn Surface> = Arc::new(Paraboloid::new([0.3, -0.2], 2.0).unwrap());
    let s = TrimmedSurface::new(bowl, &[ellipse(uv(0.0, 0.0), [1.0, 1.0], 64)], Side::Against).unwrap();
    laws::breaks_are_ordered(&s);
    laws::jets_match_differences(&s, uv(0.3, -0.4), 1e-4, 1e-7);
    laws::curvature_laws(&s, uv(0.3, -0.4), 0.7, 1e-12);
    let flipped = s.clone().flipped();
    let (a, b) = (s.jet2(uv(0.3, -0.4)).forms().unwrap(), flipped.jet2(uv(0.3, -0.4)).forms().unwrap());
    assert!((a.mean() + b.mean()).abs() < 1e-15);
}

#[test]
fn triangles_of_a_trimmed_bowl() {
    let bowl: Arc<dyn Surface> = Arc::new(Paraboloid::new([0.3, 0.2], 2.0).unwrap());
    let loops = [ellipse(uv(0.0, 0.0), [1.5, 1.2], 800), ellipse(uv(0.4, 0.1), [0.3, 0.3], 300)];
    for side in [Side::Along, Side::Against] {
        let s = TrimmedSurface::new(bowl.clone(), &loops, side).unwrap();
        let chord = 1e-3;
        let mesh = tessellate(&s, chord, Some(0.4));
        // Chord errors bend areas by squares of slopes, boundaries by chord times length (12 mm) over area (6 mm2).
        assert!((mesh.area_mm2() / s.area_mm2() - 1.0).abs() < 2.0 * chord * 12.0 / 6.0);
        for t in &mesh.triangles {
            let p = t.map(|k| osculate_geom::Vec3::from(mesh.positions[k as usize]));
            let n = (p[1] - p[0]).cross(&(p[2] - p[0]));
            // Counter-clockwise seen from outside.
            let mean = t.iter().fold(osculate_geom::Vec3::zeros(), |a, k| {
                a + osculate_geom::Vec3::from(mesh.normals[*k as usize])
            });
            assert!(n.norm() < 1e-12 || n.dot(&mean) > 0.0);
            let c = (p[0] + p[1] + p[2]) / 3.0;
            // The centre is below the surface's height by the chord error only.
            assert!((c.z - 0.3 * c.x * c.x - 0.2 * c.y * c.y).abs() < 1.5 * chord, "{c:?}");
        }
        for (at, p) in mesh.uvs.iter().zip(&mesh.positions) {
            assert!((s.point(uv(at[0], at[1])).coords - osculate_geom::Vec3::from(*p)).norm() == 0.0);
        }
    }
}

#[test]
fn triangles_of_a_whole_sphere() {
    let ball: Arc<dyn Surface> = Arc::new(Sphere::new(3.0).unwrap());
    let s = TrimmedSurface::new(ball, &[], Side::Along).unwrap();
    let mesh = tessellate(&s, 1e-3, None);
    assert!((mesh.area_mm2() / (36.0 * PI) - 1.0).abs() < 2e-3 && mesh.triangles.len() < 40_000);
    for (n, p) in mesh.normals.iter().zip(&mesh.positions) {
        let dot: f64 = (0..3).map(|k| n[k] * p[k] / 3.0).sum();
        // Next to a pole the normal is taken a little beside it.
        assert!(dot > 1.0 - 1e-6, "{n:?} {p:?}");
    }
}

/// Even-odd by the text book.
fn brute(points: &[Uv], at: Uv) -> bool {
    let n = points.len();
    (0..n).fold(false, |inside, k| {
        let (a, b) = (points[k], points[(k + 1) % n]);
        let crosses = (a.u <= at.u) != (b.u <= at.u) && a.v + (at.u - a.u) * (b.v - a.v) / (b.u - a.u) < at.v;
        inside ^ crosses
    })
}

fn polygon() -> impl Strategy<Value = Vec<Uv>> {
    prop::collection::vec((-1.9..1.9, -1.9..1.9), 3..40)
        .prop_map(|p| p.into_iter().map(|(u, v)| uv(u, v)).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any polygon, crossing itself or not, against the text book; lines and areas agree with the points.
    #[test]
    fn inside_is_even_odd(points in polygon(), queries in prop::collection::vec((-2.0..2.0, -2.0..2.0), 50)) {
        let s = TrimmedSurface::new(plane(), std::slice::from_ref(&points), Side::Along);
        prop_assume!(s.is_ok());
        let s = s.unwrap();
        for (u, v) in queries {
            let at = uv(u, v);
            prop_assert_eq!(s.contains(at), brute(&points, at), "{:?}", at);
            for axis in [Axis::U, Axis::V] {
                let t = at.get(axis);
                let on = s.spans(axis, at.get(axis.other())).iter().any(|i| i.lo <= t && t <= i.hi);
                prop_assert_eq!(on, s.contains(at), "{:?} along {:?}", at, axis);
            }
        }
    }

    /// The area of a star-shaped polygon is the shoelace formula's, whatever period it is moved by.
    #[test]
    fn areas_are_exact_on_planes(radii in prop::collection::vec(0.2..1.0, 5..30), turns in -3..3_i32) {
        let n = radii.len();
        let at = |k: usize| {
            let t = TAU * (k % n) as f64 / n as f64;
            (radii[k % n] * t.cos(), radii[k % n] * t.sin())
        };
        let area: f64 = (0..n).map(|k| {
            let (a, b) = (at(k), at(k + 1));
            0.5 * (a.0 * b.1 - a.1 * b.0)
        }).sum();
        let shift = TAU * f64::from(turns);
        let points: Vec<Uv> = (0..n).map(|k| uv(3.0 + shift + at(k).0, 2.0 + at(k).1)).collect();
        let carrier: Arc<dyn Surface> = Arc::new(Cylinder::new(1.0, Interval::new(0.0, 5.0)).unwrap());
        let s = TrimmedSurface::new(carrier, &[points], Side::Along).unwrap();
        prop_assert!((s.area_mm2() - area).abs() < 1e-9, "{} {}", s.area_mm2(), area);
    }
}
