//! Rules found in faces that have them, and bands of those that have not.

use osculate_geom::analytic::{Sphere, Torus};
use osculate_geom::{Axis, Domain, Interval, Patch, Point3, Side, Surface, uv};
use osculate_surfaces::gallery::{d98_eq18, d98_liu, m86};
use osculate_surfaces::{
    Net, NurbsSurface, Ruling, RulingError, RulingOptions, approximate, ruled_bands, ruling,
};

/// The parametrisations of degree one, either way round, and surface (18), which is no spline.
#[test]
fn straight_parameter_lines_are_found() {
    let how = RulingOptions::default();
    let liu = d98_liu();
    for (surface, want) in
        [(&liu as &dyn Surface, Axis::U), (&liu.swapped(), Axis::V), (&d98_eq18(), Axis::U)]
    {
        match ruling(surface, &how).unwrap() {
            Ruling::Straight { along, error_mm } => assert!(along == want && error_mm < 1e-10),
            other => panic!("{other:?}"),
        }
    }
}

/// A hyperbolic paraboloid as a graph z = x y / 50 over a square turned by `turn`: its rules run along x and y, oblique in
/// the parameters, and no parameter line is straight for a turn in between.
fn turned_saddle(turn: f64) -> NurbsSurface {
    let (s, c) = turn.sin_cos();
    let height = |x: f64, y: f64| (c * x - s * y) * (s * x + c * y) / 50.0;
    // Bezier points of a biquadratic graph over [-20, 20]^2 from its polar form.
    let polar = |a: [f64; 2], b: [f64; 2]| {
        // z is a quadratic form: height = A x^2 + B x y + C y^2.
        let (aa, cc) = (c * s / 50.0, -c * s / 50.0);
        let bb = (c * c - s * s) / 50.0;
        let (x, y) = (0.5 * (a[0] + a[1]), 0.5 * (b[0] + b[1]));
        Point3::new(x, y, aa * a[0] * a[1] + bb * x * y + cc * b[0] * b[1])
    };
    let ends = |k: usize| [[-20.0, -20.0], [-20.0, 20.0], [20.0, 20.0]][k];
    let points =
        (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|(i, j)| polar(ends(i), ends(j))).collect();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let made =
        NurbsSurface::new([2, 2], [knots.clone(), knots], Net { count: [3, 3], points, weights: None })
            .expect("nine finite poles");
    let p = made.point(uv(0.3, 0.8));
    assert!((p.z - height(p.x, p.y)).abs() < 1e-13);
    made
}

/// Rules that are no parameter lines: the saddle turned by 10 degrees, whose rules lean by tan(10 deg) of the width.
#[test]
fn oblique_rules_are_found() {
    let turn = 10f64.to_radians();
    let saddle = turned_saddle(turn);
    let how = RulingOptions { keep_corners: false, tolerance_mm: 0.01, ..RulingOptions::default() };
    match ruling(&saddle, &how).unwrap() {
        Ruling::Found(band) => {
            assert!(band.error_mm < 0.01, "{}", band.error_mm);
            // Rules away from the ends lean as those of the saddle do; the ends stop at the corners.
            assert!(band.mates.len() >= 12, "{}", band.mates.len());
            for m in &band.mates {
                let lean = m.at_high - m.at_low;
                assert!((lean.abs() - turn.tan()).abs() < 1e-4 && m.error_mm < 1e-4, "{lean}");
            }
            assert!(band.mates.windows(2).all(|w| w[0].at_high <= w[1].at_high));
        }
        other => panic!("{other:?}"),
    }
}

/// A ruled surface in disguise: surface (18) away from u = 0 with u and v mixed by a bicubic approximation of it, which has
/// no straight parameter lines left to rounding.
#[test]
fn a_ruled_face_within_a_tolerance_is_found() {
    let domain = Domain { u: Interval::new(0.2, 0.9), v: Interval::new(0.0, 1.0) };
    let near = approximate(&d98_eq18(), &domain, 1e-4).unwrap().surface;
    let how = RulingOptions { tolerance_mm: 0.005, ..RulingOptions::default() };
    match ruling(&near, &how).unwrap() {
        // A cubic through straight lines may be straight to rounding.
        Ruling::Straight { along, .. } => assert_eq!(along, Axis::U),
        Ruling::Found(band) => assert!(band.band.along == Axis::U && band.error_mm <= 0.005),
        Ruling::NotRuled(band) => panic!("{}", band.error_mm),
    }
}

/// A free-form hollow in bands: every band within the tolerance, measured by a second method at other places, and the
/// number of bands as the root of the tolerance.
#[test]
fn free_form_faces_come_in_bands() {
    let face = m86(1);
    let how = RulingOptions { tolerance_mm: 0.4, rules: 9, checks: 5, ..RulingOptions::default() };
    let Ruling::NotRuled(whole) = ruling(&face, &how).unwrap() else { panic!("a doubly curved face") };
    assert!(whole.error_mm > 0.4);
    let count = |tolerance_mm: f64| {
        let how = RulingOptions { tolerance_mm, ..how };
        let bands = ruled_bands(&face, Axis::V, &how).unwrap();
        assert_eq!(bands[0].band.across.lo, 0.0);
        for (a, b) in bands.iter().zip(&bands[1..]) {
            assert_eq!(a.band.across.hi, b.band.across.lo);
        }
        assert_eq!(bands.last().unwrap().band.across.hi, 1.0);
        for b in &bands {
            assert!(b.error_mm <= tolerance_mm);
            for (u, v) in [(0.13, 0.37), (0.52, 0.52), (0.91, 0.81)] {
                let p = b.surface.point(uv(u, v));
                let foot = osculate_surfaces::closest(&face, &p, None).unwrap();
                assert!(foot.distance_mm <= b.error_mm * 1.02 + 1e-9, "{} {}", foot.distance_mm, b.error_mm);
            }
        }
        bands.len()
    };
    let (few, many) = (count(0.4), count(0.1));
    assert!(few >= 2 && many >= 2 * few - 2 && many <= 2 * few + 2, "{few} {many}");
}

/// A band of a torus is nearly a cone: its error is the sagitta of the arc across, r (1 - cos(w/2)) over two by symmetry of
/// nothing but the chord itself.
#[test]
fn the_error_of_a_band_is_the_sagitta() {
    let (minor, half) = (20.0, 0.15f64);
    let torus = Torus::new(80.0, minor).unwrap();
    let domain = Domain { u: Interval::new(0.0, 1.0), v: Interval::new(-half, half) };
    let patch = Patch { surface: torus, domain, side: Side::Along };
    let how = RulingOptions { tolerance_mm: 1.0, ..RulingOptions::default() };
    let Ruling::Found(band) = ruling(&patch, &how).unwrap() else { panic!("within a millimetre") };
    let sagitta = minor * (1.0 - half.cos());
    // The chord itself is as far as the sagitta; its middle is among the places measured.
    assert!((band.error_mm - sagitta).abs() < 1e-4 * sagitta, "{} {sagitta}", band.error_mm);
}

#[test]
fn nonsense_is_refused() {
    let ball = Sphere::new(10.0).unwrap();
    let how = RulingOptions::default();
    assert!(matches!(
        ruling(&ball, &RulingOptions { tolerance_mm: f64::NAN, ..how }),
        Err(RulingError::Option { what: "tolerance_mm", .. })
    ));
    assert!(matches!(ruling(&ball, &RulingOptions { rules: 2, ..how }), Err(RulingError::Option { .. })));
    let strict = RulingOptions { tolerance_mm: 1e-6, most_bands: 4, rules: 5, checks: 3, ..how };
    let face = m86(3);
    assert!(matches!(
        ruled_bands(&face, Axis::U, &strict),
        Err(RulingError::TooMany { bands: 4, error_mm, .. }) if error_mm > 1e-6
    ));
}
