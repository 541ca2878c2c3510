//! Samples: areas, edges, poles, trims, density.

use osculate_geom::analytic::{Cone, Cylinder, Plane, Sphere, Torus};
use osculate_geom::{Domain, Facets, Interval, Jet2, Patch, Point3, Side, Surface, Taylor, Uv, Vec3, uv};
use osculate_tools::removal::{Density, SamplingError, sample_surface};
use std::f64::consts::PI;

fn square(side: f64) -> Plane {
    let i = Interval::new(0.0, side);
    Plane::new(Domain { u: i, v: i })
}

/// A plane face with a round outline.
struct Disc {
    plane: Plane,
    radius: f64,
}

impl Surface for Disc {
    fn domain(&self) -> Domain {
        self.plane.domain()
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.plane.jet2(at)
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.plane.taylor(at, order)
    }
    fn contains(&self, at: Uv) -> bool {
        self.plane.contains(at) && (at.u - 5.0).hypot(at.v - 5.0) <= self.radius
    }
}

/// A disc of 3 mm2 on a square of a square metre: cells of the square are counted, not only samples of the disc.
#[test]
fn little_of_a_large_rectangle() {
    let disc = Disc { plane: square(1000.0), radius: 1.0 };
    let got = sample_surface(&disc, 0, 0.001, 1_000_000).unwrap();
    let spacing = got.density.spacing_mm;
    assert!(spacing > 0.31 && spacing < 0.35, "{spacing}");
    assert!((got.area_mm2 - PI).abs() < 0.05 * PI, "{}", got.area_mm2);
}

#[test]
fn areas_add_up() {
    let sphere = Sphere::new(10.0).unwrap();
    let torus = Torus::new(30.0, 8.0).unwrap();
    let cylinder = Cylinder::new(6.0, Interval::new(-3.0, 9.0)).unwrap();
    // From the apex: one end of the rectangle is a pole.
    let cone = Cone::new(0.0, 0.5, Interval::new(0.0, 12.0)).unwrap();
    let cases: [(&dyn Surface, f64); 5] = [
        (&square(10.0), 100.0),
        (&sphere, 400.0 * PI),
        (&torus, 4.0 * PI * PI * 30.0 * 8.0),
        (&cylinder, 12.0 * 12.0 * PI),
        (&cone, PI * 12.0 * 12.0 * 0.5f64.sin()),
    ];
    for (surface, want) in cases {
        let got = sample_surface(surface, 3, 0.5, 1_000_000).unwrap();
        // Midpoint rule on quarter cells of at most 0.25 mm: relative error (0.25 / R)^2 / 24, R >= 6 mm.
        let tolerance = want * (0.25f64 / 6.0).powi(2) / 24.0;
        assert!((got.area_mm2 - want).abs() < tolerance, "{} want {want}", got.area_mm2);
        assert_eq!(got.lost_area_mm2, 0.0);
        let sum: f64 = got.samples.iter().map(|s| s.area_mm2).sum();
        assert!((sum - got.area_mm2).abs() < 1e-9 * want);
        assert!(got.samples.iter().all(|s| s.face == 3 && s.area_mm2 > 0.0 && !s.check_only));
        for s in &got.samples {
            let jet = surface.jet2(s.uv);
            assert!((jet.point - s.point).norm() == 0.0 && jet.normal().unwrap() == s.normal);
        }
    }
}

/// No point of a face is farther from a sample than the bound on hidden errors takes it to be.
#[test]
fn no_place_is_far_from_a_sample() {
    let sphere = Sphere::new(10.0).unwrap();
    let torus = Torus::new(20.0, 8.0).unwrap();
    let patch = Patch {
        surface: torus,
        domain: Domain { u: Interval::new(0.3, 1.2), v: Interval::new(-1.0, 2.0) },
        side: Side::Along,
    };
    let faces: [&dyn Surface; 3] = [&square(7.3), &sphere, &patch];
    for surface in faces {
        let got = sample_surface(surface, 0, 0.8, 100_000).unwrap();
        let r = got.density.spacing_mm * std::f64::consts::FRAC_1_SQRT_2;
        for k in 0..2000u32 {
            // A low-discrepancy walk over the rectangle.
            let fu = (0.5 + 0.618_033_988_749_895 * f64::from(k)).fract();
            let p = surface.point(surface.domain().at(fu, (f64::from(k) + 0.5) / 2000.0));
            let near = got.samples.iter().map(|s| (s.point - p).norm()).fold(f64::INFINITY, f64::min);
            assert!(near < r, "{near} of {r}");
        }
    }
}

#[test]
fn edges_and_corners_are_sampled() {
    let got = sample_surface(&square(10.0), 0, 0.7, 10_000).unwrap();
    for corner in [(0.0, 0.0), (10.0, 0.0), (0.0, 10.0), (10.0, 10.0)] {
        assert!(got.samples.iter().any(|s| (s.uv.u, s.uv.v) == corner));
    }
    let on_edge = got.samples.iter().filter(|s| s.uv.u == 0.0).count();
    assert!(on_edge as f64 >= 10.0 / 0.7);
}

#[test]
fn a_trimmed_face() {
    let disc = Disc { plane: square(10.0), radius: 4.0 };
    let got = sample_surface(&disc, 0, 0.25, 100_000).unwrap();
    // Crossed cells, about 4 * 8 / 0.25 of them, each good to 1/16 of its area with random sign: one part in
    // a thousand.
    assert!((got.area_mm2 / (16.0 * PI) - 1.0).abs() < 2e-3, "{}", got.area_mm2);
    assert!(got.samples.iter().all(|s| disc.contains(s.uv)));
    let on_trim =
        got.samples.iter().filter(|s| ((s.uv.u - 5.0).hypot(s.uv.v - 5.0) - 4.0).abs() < 1e-9).count();
    assert!(on_trim > 30, "{on_trim} samples on the trim");
}

#[test]
fn the_count_is_kept_and_the_spacing_told() {
    for most in [9, 50, 1000, 20_000] {
        for surface in
            [&Sphere::new(10.0).unwrap() as &dyn Surface, &Disc { plane: square(10.0), radius: 2.0 }]
        {
            let got = sample_surface(surface, 0, 1e-4, most).unwrap();
            assert!(
                got.samples.len() <= most && got.samples.len() * 5 > most,
                "{} of {most}",
                got.samples.len()
            );
            assert!(got.density.spacing_mm > 1e-4);
        }
    }
    let kept = sample_surface(&square(10.0), 0, 0.5, 100_000).unwrap();
    assert_eq!(kept.density.spacing_mm, 0.5);
    assert_eq!(kept.density.convex_per_mm, 0.0);
}

#[test]
fn bends_are_sampled_more_densely() {
    // A rod of radius 1: 0.2 rad are 0.2 mm, denser than 0.8 asked for around it, not along it.
    let rod = Cylinder::new(1.0, Interval::new(0.0, 8.0)).unwrap();
    let got = sample_surface(&rod, 0, 0.8, 100_000).unwrap();
    assert_eq!(got.samples.len(), 32 * 11);
    assert!((got.density.convex_per_mm - 1.0).abs() < 1e-12);
}

#[test]
fn bounds_between_samples() {
    let d = Density { spacing_mm: 0.2, convex_per_mm: 0.0 };
    let (r, radius) = (0.1 * 2f64.sqrt(), 5.0);
    // A cusp of height H seen r down its flank at height h: the bound from h is H, whatever H.
    for foot in [0.5f64, 1.0, 2.0] {
        let (top, seen) = (foot * foot / (2.0 * radius), (foot - r).powi(2) / (2.0 * radius));
        assert!((seen + d.bound(radius, seen).scallop_mm - top).abs() < 1e-12);
    }
    // At the bottom of a gouge: r^2 / 2R.
    assert!((d.bound(radius, 0.0).gouge_mm - r * r / (2.0 * radius)).abs() < 1e-15);
    let convex = Density { spacing_mm: 0.1, convex_per_mm: 0.2 };
    assert_eq!(d.union(&convex), Density { spacing_mm: 0.2, convex_per_mm: 0.2 });
}

#[test]
fn nonsense_is_refused() {
    let plane = square(1.0);
    assert!(matches!(sample_surface(&plane, 0, 0.0, 100), Err(SamplingError::Spacing { .. })));
    assert!(matches!(sample_surface(&plane, 0, f64::NAN, 100), Err(SamplingError::Spacing { .. })));
    assert!(matches!(sample_surface(&plane, 0, 0.1, 8), Err(SamplingError::Count { got: 8 })));
    let none = Disc { plane, radius: 0.5 };
    assert!(matches!(sample_surface(&none, 4, 0.1, 100), Err(SamplingError::Nothing { face: 4, .. })));
    let endless = square(f64::INFINITY);
    assert!(matches!(sample_surface(&endless, 4, 0.1, 100), Err(SamplingError::Area { face: 4, .. })));
    assert!(plane_point_is_plain());
}

/// The disc above is built on the plane's own parameters.
fn plane_point_is_plain() -> bool {
    square(1.0).point(uv(0.25, 0.5)).coords.as_slice() == [0.25, 0.5, 0.0]
}

/// A square of 10 mm as triangles: two large ones over the left half, a fan of small ones over the right half.
fn parted() -> Facets {
    let p = |x: f64, y: f64| Point3::new(x, y, 0.25 * x);
    let mut triangles =
        vec![[p(0.0, 0.0), p(5.0, 0.0), p(5.0, 10.0)], [p(0.0, 0.0), p(5.0, 10.0), p(0.0, 10.0)]];
    for i in 0..50 {
        for j in 0..100 {
            let (x, y) = (5.0 + 0.1 * f64::from(i), 0.1 * f64::from(j));
            let [a, b, c, d] = [p(x, y), p(x + 0.1, y), p(x + 0.1, y + 0.1), p(x, y + 0.1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Facets::new(triangles).expect("triangles")
}

#[test]
fn triangles_have_samples_by_their_size() {
    let facets = parted();
    let want = 100.0 * 1.0625f64.sqrt();
    let got = sample_surface(&facets, 2, 0.5, 100_000).unwrap();
    assert!((got.area_mm2 - want).abs() < 1e-9 * want, "{} {want}", got.area_mm2);
    assert_eq!(got.lost_area_mm2, 0.0);
    // One for each small triangle, and over the large ones as many as 51.5 mm2 at half a millimetre have, up to two and a half times: the rows
    // of each are as close as its longest line across asks for, and have samples at both ends.
    let large = got.samples.len() - 10_000;
    assert!((206..515).contains(&large), "{large}");
    let normal = Vec3::new(-0.25, 0.0, 1.0).normalize();
    for (s, patch) in got.samples.iter().zip(&got.patches) {
        assert!((s.normal.into_inner() - normal).norm() < 1e-12 && s.area_mm2 > 0.0);
        assert!((facets.point(s.uv) - s.point).norm() < 1e-12);
        assert_eq!((patch.concave_per_mm, patch.convex_per_mm), (0.0, 0.0));
    }
    // However far samples are apart, each triangle has one; fewer are refused.
    assert!(sample_surface(&facets, 0, 50.0, 100_000).unwrap().samples.len() == 10_002);
    assert_eq!(
        sample_surface(&facets, 4, 50.0, 10_001),
        Err(SamplingError::Pieces { face: 4, pieces: 10_002, max: 10_001 })
    );
}
