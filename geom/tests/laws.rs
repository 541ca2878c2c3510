//! The laws of surfaces on every analytic kind, and closed forms that tie them to known numbers.

#![allow(clippy::unwrap_used)]

use osculate_geom::analytic::{
    Cone, Cylinder, Ellipsoid, Paraboloid, Placed, Placement, Plane, Sphere, Torus,
};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::line::{GeodesicLine, IsoLine, SurfaceLine};
use osculate_geom::{
    Axis, Domain, Flipped, Interval, Patch, Point3, Relative, Side, Surface, ToolCurvature, Unit3, Vec3,
    laws, quadrature, uv,
};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn kinds() -> Vec<(&'static str, Box<dyn Surface>)> {
    let i = Interval::new(-2.0, 3.0);
    let tilted = Placement::new(
        Point3::new(3.0, -1.0, 0.5),
        Unit3::new_normalize(Vec3::new(0.3, -0.5, 0.8)),
        Some(Vec3::new(1.0, 0.2, 0.0)),
    );
    let ellipsoid = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    vec![
        ("plane", Box::new(Plane::new(Domain { u: i, v: i }))),
        ("cylinder", Box::new(Cylinder::new(2.0, i).unwrap())),
        ("cone", Box::new(Cone::new(4.0, 0.4, i).unwrap())),
        ("sphere", Box::new(Sphere::new(2.5).unwrap())),
        ("torus", Box::new(Torus::new(5.0, 2.0).unwrap())),
        ("ellipsoid", Box::new(ellipsoid)),
        ("paraboloid", Box::new(Paraboloid::new([0.3, -0.2], 2.0).unwrap())),
        ("placed ellipsoid", Box::new(Placed { surface: ellipsoid, placement: tilted })),
        ("flipped torus", Box::new(Flipped(Torus::new(5.0, 2.0).unwrap()))),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn jets_and_curvatures_obey_the_laws(fu in 0.02..0.98f64, fv in 0.1..0.9f64, angle in 0.0..PI) {
        for (_, s) in kinds() {
            let at = s.domain().at(fu, fv);
            // Differences over 1e-5 of a parameter: third derivatives (below 10 of the first) times 1e-10, rounding 1e-11.
            laws::jets_match_differences(&*s, at, 1e-5, 1e-8);
            laws::taylor_matches(&*s, at, 1e-5, 1e-8);
            laws::curvature_laws(&*s, at, angle, 1e-12);
            laws::breaks_are_ordered(&*s);
        }
    }

    /// A rigid motion changes no curvature, a scale divides it, turning the material over changes its sign.
    #[test]
    fn curvature_under_motion_scale_and_side(fu in 0.0..1.0f64, fv in 0.1..0.9f64, e in -6.0..6.0f64) {
        let scale = 10f64.powf(e);
        let axes = [3.0, 2.0, 1.0];
        let s = Ellipsoid::new(axes).unwrap();
        let at = s.domain().at(fu, fv);
        let k = s.jet2(at).forms().unwrap().principal();
        let size = k.k_max.abs();
        let big = Ellipsoid::new(axes.map(|a| a * scale)).unwrap().jet2(at).forms().unwrap().principal();
        prop_assert!((big.k_max * scale - k.k_max).abs() < 1e-12 * size);
        prop_assert!((big.k_min * scale - k.k_min).abs() < 1e-12 * size);
        let placement =
            Placement::new(Point3::new(9.0, 8.0, 7.0), Unit3::new_normalize(Vec3::new(fu, fv, 0.7)), None);
        let moved = Placed { surface: s, placement }.jet2(at).forms().unwrap().principal();
        prop_assert!((moved.k_max - k.k_max).abs() < 1e-12 * size);
        let hollow = Flipped(s).jet2(at).forms().unwrap().principal();
        prop_assert!((hollow.k_max + k.k_min).abs() < 1e-12 * size && (hollow.k_min + k.k_max).abs() < 1e-12 * size);
    }

    /// The Darboux frame's angular velocity against differences of the frame along the line.
    #[test]
    fn frames_turn_as_they_say(fu in 0.05..0.95f64, fv in 0.15..0.85f64, angle in 0.0..TAU) {
        for (name, s) in kinds() {
            let at = s.domain().at(fu, fv);
            let forms = s.jet2(at).forms().unwrap();
            let (si, co) = angle.sin_cos();
            let d = forms.frame[0].into_inner() * co + forms.frame[1].into_inner() * si;
            let geodesic = GeodesicLine::new(&*s, at, &d, 0.01).unwrap();
            let iso = IsoLine { surface: &*s, along: Axis::V, fixed: at.u, reversed: true };
            let lines: [(&dyn SurfaceLine, f64); 2] = [(&geodesic, 0.0), (&iso, at.v)];
            for (line, t) in lines {
                let h = 1e-5;
                let (here, speed) = line.frame(t).unwrap();
                let (a, b) = (line.frame(t - h).unwrap().0, line.frame(t + h).unwrap().0);
                let turn = here.turn * speed;
                for (x, y, now) in [
                    (a.tangent, b.tangent, here.tangent),
                    (a.left, b.left, here.left),
                    (a.normal, b.normal, here.normal),
                ] {
                    let rate = (y.into_inner() - x.into_inner()) / (2.0 * h);
                    let want = turn.cross(&now);
                    prop_assert!((rate - want).norm() < 1e-8 * (1.0 + turn.norm()), "{name}: {rate:?} {want:?}");
                }
                let rate = (b.point - a.point) / (2.0 * h);
                prop_assert!((rate - here.tangent.into_inner() * speed).norm() < 1e-8 * (1.0 + speed.abs()));
            }
        }
    }

    /// The eigen-decomposition of Q against its own form in every direction.
    #[test]
    fn relative_form_is_the_sum_of_both(
        fu in 0.0..1.0f64, fv in 0.1..0.9f64, turn in 0.0..PI, d in 0.0..PI, a in 0.05..2.0f64, b in 0.0..2.0f64
    ) {
        let s = Ellipsoid::new([30.0, 20.0, 10.0]).unwrap();
        let forms = s.jet2(s.domain().at(fu, fv)).forms().unwrap();
        let dir = |t: f64| {
            let (si, co) = t.sin_cos();
            Unit3::new_normalize(forms.frame[0].into_inner() * co + forms.frame[1].into_inner() * si)
        };
        let tool = ToolCurvature { along: a, across: b, direction: dir(turn) };
        let q = Relative::new(&forms, &tool);
        let c = (d - turn).cos();
        let want = forms.normal_curvature(&dir(d)) + a * c * c + b * (1.0 - c * c);
        prop_assert!((q.along(&dir(d)) - want).abs() < 1e-12 * (1.0 + a + b));
        prop_assert!(q.min <= want + 1e-12 && want <= q.max + 1e-12);
    }
}

#[test]
fn gauss_bonnet_on_closed_surfaces() {
    let total =
        |s: &dyn Surface| quadrature::over_surface(s, 1e-10, |j| j.forms().map_or(0.0, |f| f.gauss()));
    assert!((total(&Sphere::new(7.0).unwrap()).value - 4.0 * PI).abs() < 1e-8);
    assert!((total(&Ellipsoid::new([3.0, 2.0, 1.0]).unwrap()).value - 4.0 * PI).abs() < 1e-6);
    assert!(total(&Torus::new(5.0, 2.0).unwrap()).value.abs() < 1e-8);
}

#[test]
fn areas_in_closed_form() {
    let area = |s: &dyn Surface| quadrature::area(s, 1e-12).value;
    assert!((area(&Sphere::new(2.0).unwrap()) - 16.0 * PI).abs() < 1e-10);
    assert!((area(&Torus::new(5.0, 2.0).unwrap()) - 4.0 * PI * PI * 10.0).abs() < 1e-9);
    let cone = Cone::new(1.0, 0.3, Interval::new(0.0, 2.0)).unwrap();
    assert!((area(&cone) - TAU * (2.0 + 2.0 * 0.3f64.sin())).abs() < 1e-10);
    let quarter = Patch {
        surface: Sphere::new(2.0).unwrap(),
        domain: Domain { u: Interval::new(0.0, PI / 2.0), v: Interval::new(0.0, PI / 2.0) },
        side: Side::Along,
    };
    assert!((area(&quarter) - 2.0 * PI).abs() < 1e-10);
}

#[test]
fn principal_curvatures_of_a_torus() {
    let t = Torus::new(200.0, 60.0).unwrap();
    for v in [0.0, 1.0, 2.0, PI] {
        let k = t.jet2(uv(0.3, v)).forms().unwrap().principal();
        let parallel = v.cos() / (200.0 + 60.0 * v.cos());
        let (hi, lo) = (parallel.max(1.0 / 60.0), parallel.min(1.0 / 60.0));
        assert!((k.k_max - hi).abs() < 1e-16 && (k.k_min - lo).abs() < 1e-16, "{v}");
    }
}

#[test]
fn geodesics_are_great_circles_and_helices() {
    let s = Sphere::new(10.0).unwrap();
    let jet = s.jet2(uv(0.2, 0.3));
    let d = (jet.du.normalize() + jet.dv.normalize() * 0.7).normalize();
    let line = GeodesicLine::new(&s, uv(0.2, 0.3), &d, 0.05).unwrap();
    let end = line.frame(8.0).unwrap().0.point;
    let want = jet.point.coords * 0.8f64.cos() + d * (10.0 * 0.8f64.sin());
    // 160 Runge-Kutta steps of 0.005 rad: local errors near 1e-13 of the radius.
    assert!((end.coords - want).norm() < 1e-9, "{}", (end.coords - want).norm());
    let c = Cylinder::new(5.0, Interval::new(-50.0, 50.0)).unwrap();
    let start = GeodesicState::start(&c, uv(0.0, 0.0), &Vec3::new(0.0, 3.0, 4.0)).unwrap();
    let end = start.step(&c, 10.0).unwrap();
    assert!((end.at.u - 10.0 * 0.6 / 5.0).abs() < 1e-13 && (end.at.v - 8.0).abs() < 1e-13);
}

#[test]
fn places_without_a_tangent_plane_are_an_error_not_a_nan() {
    let apex = Cone::new(0.0, 0.4, Interval::new(0.0, 1.0)).unwrap().jet2(uv(0.3, 0.0));
    assert!(apex.forms().is_err());
    let error = apex.normal().unwrap_err().to_string();
    assert!(error.contains("no tangent plane"), "{error}");
    assert!(
        Sphere::new(f64::NAN).is_err()
            && Torus::new(1.0, -1.0).is_err()
            && Cone::new(1.0, 2.0, Interval::new(0.0, 1.0)).is_err()
    );
}
