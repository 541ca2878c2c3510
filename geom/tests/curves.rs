//! Curves against their closed forms, and surfaces swept by them against other kinds.

use osculate_geom::analytic::{Cone, Conic, ConicKind, Cylinder, Line, Placed, Placement, Sphere, Torus};
use osculate_geom::curve::{self, LengthError};
use osculate_geom::{
    Curve, CurveTaylor, Extruded, FrenetError, Interval, Point3, Revolved, Ruled, Surface, SweepError,
    TurnAxis, Unit3, Vec3, laws, uv,
};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// `(a cos t, a sin t, b t)`: curvature `a / (a^2 + b^2)`, torsion `b / (a^2 + b^2)`.
struct Helix {
    a: f64,
    b: f64,
}

impl Curve for Helix {
    fn domain(&self) -> Interval {
        Interval::new(-10.0, 10.0)
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let (s, c) = t.sin_cos();
        let wave = [c, -s, -c, s];
        CurveTaylor::from_derivatives(t, order, |k| {
            let z = [self.b * t, self.b, 0.0][k.min(2)];
            Vec3::new(self.a * wave[k % 4], self.a * wave[(k + 3) % 4], z)
        })
    }
}

fn tilted() -> Placement {
    Placement::new(
        Point3::new(3.0, -1.0, 0.5),
        Unit3::new_normalize(Vec3::new(0.3, -0.5, 0.8)),
        Some(Vec3::new(1.0, 0.2, 0.0)),
    )
}

fn curves() -> Vec<(&'static str, Box<dyn Curve>)> {
    let conic = |kind, lo, hi| Box::new(Conic::new(kind, tilted(), Interval::new(lo, hi)).unwrap());
    let some = Interval::new(-2.0, 3.0);
    vec![
        ("line", Box::new(Line::new(Point3::new(1.0, 2.0, 3.0), Vec3::new(0.5, -2.0, 1.0), some).unwrap())),
        ("circle", Box::new(Conic::circle(2.5, tilted()).unwrap())),
        ("ellipse", conic(ConicKind::Ellipse { semi_axes_mm: [3.0, 1.2] }, 0.4, 4.0)),
        ("parabola", conic(ConicKind::Parabola { focal_mm: 0.7 }, -2.0, 1.5)),
        ("hyperbola", conic(ConicKind::Hyperbola { semi_axes_mm: [2.0, 0.5] }, -1.0, 1.5)),
        ("helix", Box::new(Helix { a: 2.0, b: 0.5 })),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn derivatives_are_the_differences_of_the_order_below(f in 0.02..0.98f64) {
        for (name, c) in curves() {
            let t = c.domain().at(f);
            let h = 1e-5;
            let (here, up, down) = (c.taylor(t, 6), c.taylor(t + h, 5), c.taylor(t - h, 5));
            let size = (1..=6).fold(0.0, |m, k| here.derivative(k).norm().max(m));
            for k in 1..=6 {
                let want = (up.derivative(k - 1) - down.derivative(k - 1)) / (2.0 * h);
                // Derivatives k + 2 are of the size of the others: 1e-10 / 6; rounding 1e-15 / 1e-5.
                prop_assert!((here.derivative(k) - want).norm() < 1e-8 * (1.0 + size), "{name} {k}");
            }
            prop_assert!((c.point(t).coords - here.derivative(0)).norm() < 1e-14 * 10.0);
        }
    }

    #[test]
    fn the_frenet_frame_turns_as_it_says(f in 0.05..0.95f64) {
        for (name, c) in curves().into_iter().skip(1) {
            let t = c.domain().at(f);
            let h = 1e-5;
            let (a, x, b) = (c.jet(t - h).frenet().unwrap(), c.jet(t).frenet().unwrap(), c.jet(t + h).frenet().unwrap());
            let d = |p: Unit3, q: Unit3| (q.into_inner() - p.into_inner()) / (2.0 * h * c.jet(t).first.norm());
            let (k, tau) = (x.curvature_per_mm, x.torsion_per_mm);
            let want_n = x.binormal.into_inner() * tau - x.tangent.into_inner() * k;
            prop_assert!((d(a.tangent, b.tangent) - x.normal.into_inner() * k).norm() < 1e-8 * (1.0 + k), "{name}");
            prop_assert!((d(a.normal, b.normal) - want_n).norm() < 1e-8 * (1.0 + k), "{name}");
            prop_assert!((d(a.binormal, b.binormal) + x.normal.into_inner() * tau).norm() < 1e-8 * (1.0 + k), "{name}");
        }
    }

    /// A point is found again by its arc length.
    #[test]
    fn arc_length_and_back(f in 0.0..=1.0f64) {
        for (name, c) in curves() {
            let d = c.domain();
            let t = d.at(f);
            let s = curve::length(&*c, Interval::new(d.lo, t), 1e-13);
            let back = curve::parameter_at(&*c, s.value, 1e-9).unwrap();
            // The slowest parameter here moves 0.5 mm a unit.
            prop_assert!((back - t).abs() < 1e-8, "{name}: {back} for {t}");
        }
    }
}

#[test]
fn closed_forms_of_curvature_torsion_and_length() {
    let helix = Helix { a: 2.0, b: 0.5 };
    let f = helix.jet(1.3).frenet().unwrap();
    assert!((f.curvature_per_mm - 2.0 / 4.25).abs() < 1e-15 && (f.torsion_per_mm - 0.5 / 4.25).abs() < 1e-15);
    let s = curve::length(&helix, Interval::new(-1.0, 2.0), 1e-14);
    assert!((s.value - 3.0 * 4.25f64.sqrt()).abs() < 1e-13);
    // The vertices of an ellipse: a / b^2 and b / a^2.
    let e = Conic::new(ConicKind::Ellipse { semi_axes_mm: [3.0, 2.0] }, tilted(), Interval::new(0.0, TAU))
        .unwrap();
    assert!(e.domain().periodic);
    assert!((e.jet(0.0).curvature_per_mm().unwrap() - 0.75).abs() < 1e-14);
    assert!((e.jet(FRAC_PI_2).curvature_per_mm().unwrap() - 2.0 / 9.0).abs() < 1e-14);
    assert!(e.jet(0.7).frenet().unwrap().torsion_per_mm.abs() < 1e-14);
    // Its circumference, from the series in the eccentricity (Gauss-Kummer): 15.865 439 589 290 59.
    let whole = curve::length(&e, e.domain(), 1e-14);
    assert!((whole.value - 15.865_439_589_290_59).abs() < 1e-12, "{whole:?}");
    // A parabola of focal distance f from the vertex to t: f (t sqrt(1 + t^2) + asinh t).
    let p = Conic::new(ConicKind::Parabola { focal_mm: 0.7 }, tilted(), Interval::new(0.0, 2.0)).unwrap();
    let want = 0.7 * (2.0 * 5f64.sqrt() + 2f64.asinh());
    assert!((curve::length(&p, p.domain(), 1e-14).value - want).abs() < 1e-13);
    // Vertex of a hyperbola: a / b^2.
    let h = Conic::new(ConicKind::Hyperbola { semi_axes_mm: [2.0, 0.5] }, tilted(), Interval::new(-1.0, 1.0))
        .unwrap();
    assert!((h.jet(0.0).curvature_per_mm().unwrap() - 8.0).abs() < 1e-13);
}

#[test]
fn what_a_curve_cannot_give_is_an_error() {
    let line = Line::segment(Point3::origin(), Point3::new(0.0, 3.0, 4.0)).unwrap();
    assert_eq!(line.jet(0.5).curvature_per_mm(), Ok(0.0));
    let straight = line.jet(0.5).frenet();
    assert!(matches!(straight, Err(FrenetError::Straight { sine, .. }) if sine == 0.0));
    assert!(straight.unwrap_err().to_string().contains("straight"));
    // A cusp: (t^2, t^3, 0).
    let cusp =
        CurveTaylor::from_coefficients(0.0, 3, |k| [Vec3::zeros(), Vec3::zeros(), Vec3::x(), Vec3::y()][k]);
    assert!(matches!(cusp.jet().frenet(), Err(FrenetError::Still { speed_mm, .. }) if speed_mm == 0.0));
    assert!(cusp.derivative(4).iter().all(|c| c.is_nan()));
    let beyond = curve::parameter_at(&line, 5.5, 1e-9);
    assert!(matches!(beyond, Err(LengthError::Beyond { whole_mm, .. }) if (whole_mm - 5.0).abs() < 1e-12));
    assert!(
        curve::parameter_at(&line, -1.0, 1e-9).is_err()
            && curve::parameter_at(&line, f64::NAN, 1e-9).is_err()
    );
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert!(Conic::circle(bad, tilted()).is_err(), "{bad}");
        let parabola = ConicKind::Parabola { focal_mm: bad };
        assert!(Conic::new(parabola, tilted(), Interval::new(0.0, 1.0)).is_err());
    }
    let ellipse = ConicKind::Ellipse { semi_axes_mm: [1.0, 2.0] };
    assert!(Conic::new(ellipse, tilted(), Interval::new(0.0, 7.0)).is_err());
    assert!(Conic::new(ellipse, tilted(), Interval::new(1.0, 1.0)).is_err());
    assert!(Conic::new(ellipse, tilted(), Interval::new(f64::NEG_INFINITY, f64::INFINITY)).is_err());
    assert!(Line::segment(Point3::origin(), Point3::origin()).is_err());
    assert!(Line::new(Point3::new(f64::NAN, 0.0, 0.0), Vec3::x(), Interval::new(0.0, 1.0)).is_err());
}

/// The same surface by two formulas: points, jets and third orders agree where the parameters do.
fn same(a: &dyn Surface, b: &dyn Surface, map: impl Fn(f64, f64) -> [(f64, f64); 2]) {
    for k in 0..60 {
        let (f, g) = (f64::from(k % 10) / 9.1, f64::from(k / 10) / 5.3);
        let [p, q] = map(f, g);
        let (s, t) = (a.taylor(uv(p.0, p.1), 4), b.taylor(uv(q.0, q.1), 4));
        for n in 0..=4usize {
            for j in 0..=n {
                let off = (s.derivative(n - j, j) - t.derivative(n - j, j)).norm();
                // Sizes up to 10, a dozen operations.
                assert!(off < 1e-13 * 10.0, "order {n}, {j} at {p:?}: {off:.1e}");
            }
        }
        let (j2, k2) = (a.jet2(uv(p.0, p.1)), b.jet2(uv(q.0, q.1)));
        for (x, y) in [(j2.du, k2.du), (j2.dv, k2.dv), (j2.duu, k2.duu), (j2.duv, k2.duv), (j2.dvv, k2.dvv)] {
            assert!((x - y).norm() < 1e-12, "{p:?}");
        }
    }
}

#[test]
fn swept_kinds_are_the_analytic_ones() {
    let frame = tilted();
    let axis = TurnAxis { origin: frame.origin, direction: frame.z };
    let turn = Interval::new(0.0, TAU);
    // Meridians lie in the xz plane of the frame.
    let meridian = Placement { origin: frame.origin, x: frame.x, y: frame.z, z: -frame.y };
    let tube = Placement { origin: frame.point(&Point3::new(5.0, 0.0, 0.0)), ..meridian };
    let torus = Revolved::new(Conic::circle(2.0, tube).unwrap(), axis, turn).unwrap();
    let want = Placed { surface: Torus::new(5.0, 2.0).unwrap(), placement: frame };
    same(&torus, &want, |f, g| [(TAU * f, TAU * g); 2]);
    assert!(torus.domain().u.periodic && torus.domain().v.periodic);
    let half = ConicKind::Ellipse { semi_axes_mm: [3.0; 2] };
    let half = Conic::new(half, meridian, Interval::new(-FRAC_PI_2, FRAC_PI_2)).unwrap();
    let sphere = Placed { surface: Sphere::new(3.0).unwrap(), placement: frame };
    same(&Revolved::new(half, axis, turn).unwrap(), &sphere, |f, g| [(TAU * f, PI * (g - 0.5)); 2]);
    let (s, c) = 0.4f64.sin_cos();
    let slope = frame.vector(&Vec3::new(s, 0.0, c));
    let line = Line::new(frame.point(&Point3::new(4.0, 0.0, 0.0)), slope, Interval::new(-2.0, 3.0)).unwrap();
    let cone = Placed { surface: Cone::new(4.0, 0.4, Interval::new(-2.0, 3.0)).unwrap(), placement: frame };
    same(&Revolved::new(line, axis, turn).unwrap(), &cone, |f, g| [(TAU * f, 5.0 * g - 2.0); 2]);
    let circle = Conic::circle(2.0, frame).unwrap();
    let cylinder =
        Placed { surface: Cylinder::new(2.0, Interval::new(-2.0, 3.0)).unwrap(), placement: frame };
    let wall = Extruded::new(circle, frame.z.into_inner(), Interval::new(-2.0, 3.0)).unwrap();
    same(&wall, &cylinder, |f, g| [(TAU * f, 5.0 * g - 2.0); 2]);
    assert!(wall.domain().u.periodic);
    let lid = Conic::circle(2.0, Placement { origin: frame.point(&Point3::new(0.0, 0.0, 1.0)), ..frame });
    let ruled = Ruled::new(circle, lid.unwrap()).unwrap();
    same(&ruled, &cylinder, |f, g| [(TAU * f, g); 2]);
    for s in [&torus as &dyn Surface, &wall, &ruled] {
        laws::breaks_are_ordered(s);
    }
}

/// `z = x y / 4` over a square is ruled by two of its lines; the second curve runs over another domain.
#[test]
fn rulings_of_a_saddle() {
    let a = Line::segment(Point3::new(-2.0, -2.0, 1.0), Point3::new(2.0, -2.0, -1.0)).unwrap();
    let b =
        Line::new(Point3::new(-2.0, 2.0, -1.0), Vec3::new(0.5, 0.0, 0.25), Interval::new(0.0, 8.0)).unwrap();
    let s = Ruled::new(a, b).unwrap();
    for k in 0..30 {
        let at = s.domain().at(f64::from(k % 6) / 5.0, f64::from(k / 6) / 4.0);
        let jet = s.jet2(at);
        assert!((jet.point.z - 0.25 * jet.point.x * jet.point.y).abs() < 1e-15);
        let k = jet.forms().unwrap().gauss();
        let (x, y) = (jet.point.x, jet.point.y);
        // z_xx = z_yy = 0, z_xy = 1/4.
        let want = -0.0625 / (1.0 + 0.0625 * (x * x + y * y)).powi(2);
        assert!((k - want).abs() < 1e-15);
    }
    let endless = Line::new(Point3::origin(), Vec3::x(), Interval::new(f64::NEG_INFINITY, 0.0)).unwrap();
    assert!(matches!(Ruled::new(a, endless), Err(SweepError::Unlimited { .. })));
}

#[test]
fn refusals_of_sweeps() {
    let line = Line::segment(Point3::new(1.0, 0.0, 0.0), Point3::new(1.0, 0.0, 1.0)).unwrap();
    let axis = TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() };
    for (lo, hi) in [(0.0, 0.0), (1.0, 0.0), (0.0, 7.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let turn = Revolved::new(line, axis, Interval::new(lo, hi));
        assert!(matches!(turn, Err(SweepError::Turn { .. })), "{lo} {hi}");
    }
    let lost = TurnAxis { origin: Point3::new(0.0, f64::NAN, 0.0), direction: Vec3::z_axis() };
    assert!(matches!(Revolved::new(line, lost, Interval::new(0.0, 1.0)), Err(SweepError::Axis { .. })));
    for d in [Vec3::zeros(), Vec3::new(f64::NAN, 0.0, 0.0), Vec3::new(f64::INFINITY, 0.0, 0.0)] {
        let none = Extruded::new(line, d, Interval::new(0.0, 1.0));
        assert!(matches!(none, Err(SweepError::Direction { .. })), "{d}");
    }
    assert!(matches!(Extruded::new(line, Vec3::x(), Interval::new(1.0, 1.0)), Err(SweepError::Range { .. })));
    assert!(Extruded::new(line, Vec3::x(), Interval::new(0.0, f64::NAN)).is_err());
}
