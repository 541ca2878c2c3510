//! The laws of surfaces on every analytic kind, and closed forms that tie them to known numbers.

use osculate_geom::analytic::{
    Cone, Conic, ConicKind, Cylinder, Ellipsoid, Line, Paraboloid, Placed, Placement, Plane, Sphere, Spindle,
    Torus,
};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::laws::{Accuracy, Kind, Sample};
use osculate_geom::line::{GeodesicLine, IsoLine, SurfaceLine};
use osculate_geom::{
    Axis, Curve, Domain, Extruded, Flipped, Interval, Offset, Patch, Point3, Relative, Revolved, Ruled, Side,
    Surface, ToolCurvature, TurnAxis, Unit3, Vec3, laws, quadrature, uv,
};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn tilted(size: f64) -> Placement {
    Placement::new(
        Point3::new(3.0, -1.0, 0.5) * size,
        Unit3::new_normalize(Vec3::new(0.3, -0.5, 0.8)),
        Some(Vec3::new(1.0, 0.2, 0.0)),
    )
}

/// Every kind of this crate, closed, open, swept, offset and wrapped.
fn kinds() -> Vec<Kind> {
    fn kind<S: Surface + 'static>(
        name: &'static str,
        make: impl Fn(f64) -> S + Send + Sync + 'static,
    ) -> Kind {
        // Closed forms and offsets of them: rounding of a dozen operations; normals near poles carry 1 / sin.
        let accuracy = Accuracy { differences: 1e-7, curvature: 1e-11 };
        Kind { name, make: Box::new(move |x| Box::new(make(x))), accuracy }
    }
    let i = |x: f64| Interval::new(-2.0 * x, 3.0 * x);
    let ellipsoid = |x: f64| Ellipsoid::new([3.0 * x, 2.0 * x, x]).unwrap();
    let paraboloid = |x: f64| Paraboloid::new([0.3 / x, -0.2 / x], 2.0 * x).unwrap();
    let torus = |x: f64| Torus::new(5.0 * x, 2.0 * x).unwrap();
    let axis = |x: f64| TurnAxis {
        origin: Point3::new(0.5, -4.0, 0.0) * x,
        direction: Unit3::new_normalize(Vec3::new(1.0, 0.1, 0.2)),
    };
    let parabola = |x: f64| {
        let range = Interval::new(-1.5, 1.0);
        Conic::new(ConicKind::Parabola { focal_mm: 0.7 * x }, tilted(x), range).unwrap()
    };
    let hyperbola = |x: f64| {
        let kind = ConicKind::Hyperbola { semi_axes_mm: [2.0 * x, 1.5 * x] };
        Conic::new(kind, tilted(x), Interval::new(-1.0, 1.2)).unwrap()
    };
    let ellipse = |x: f64| {
        let kind = ConicKind::Ellipse { semi_axes_mm: [3.0 * x, 1.2 * x] };
        Conic::new(kind, tilted(x), Interval::new(0.0, TAU)).unwrap()
    };
    // A straight line above an arc, from end to end.
    let ruled = |x: f64| {
        let kind = ConicKind::Ellipse { semi_axes_mm: [3.0 * x, 2.0 * x] };
        let arc = Conic::new(kind, tilted(x), Interval::new(0.0, 2.0)).unwrap();
        let above = |t: f64| arc.point(t) + tilted(x).vector(&Vec3::new(0.6, 0.2 * t, 4.0 - t)) * x;
        Ruled::new(Line::segment(above(0.0), above(2.0)).unwrap(), arc).unwrap()
    };
    vec![
        kind("plane", move |x| Plane::new(Domain { u: i(x), v: i(x) })),
        kind("cylinder", move |x| Cylinder::new(2.0 * x, i(x)).unwrap()),
        kind("cone", move |x| Cone::new(4.0 * x, 0.4, i(x)).unwrap()),
        kind("sphere", move |x| Sphere::new(2.5 * x).unwrap()),
        kind("torus", torus),
        kind("apple", |x| Torus::new(x, 2.0 * x).unwrap().spindle(Spindle::Apple).unwrap()),
        kind("lemon", |x| Torus::new(x, 2.0 * x).unwrap().spindle(Spindle::Lemon).unwrap()),
        kind("ellipsoid", ellipsoid),
        kind("paraboloid", paraboloid),
        kind("placed ellipsoid", move |x| Placed { surface: ellipsoid(x), placement: tilted(x) }),
        kind("flipped torus", move |x| Flipped(torus(x))),
        kind("patch of a torus", move |x| {
            let domain = Domain { u: Interval::new(0.3, 2.0), v: Interval::new(1.0, 5.0) };
            Patch { surface: torus(x), domain, side: Side::Against }
        }),
        kind("revolved parabola", move |x| {
            Revolved::new(parabola(x), axis(x), Interval::new(-0.5, 3.0)).unwrap()
        }),
        kind("revolved hyperbola, closed", move |x| {
            Revolved::new(hyperbola(x), axis(x), Interval::new(0.0, TAU)).unwrap()
        }),
        kind("extruded ellipse", move |x| {
            Extruded::new(ellipse(x), Vec3::new(0.2, 0.1, 1.0) * x, Interval::new(-1.0, 2.0)).unwrap()
        }),
        kind("ruled between line and ellipse", ruled),
        kind("offset ellipsoid", move |x| Offset::new(ellipsoid(x), 0.8 * x).unwrap()),
        kind("offset paraboloid, inwards", move |x| Offset::new(paraboloid(x), -0.9 * x).unwrap()),
        kind("offset of a ruled surface", move |x| Offset::new(ruled(x), 0.3 * x).unwrap()),
        kind("offset of a placed and flipped one of a revolved one", move |x| {
            let base = Revolved::new(parabola(x), axis(x), Interval::new(-0.5, 3.0)).unwrap();
            let inner = Placed { surface: Offset::new(base, 0.2 * x).unwrap(), placement: tilted(x) };
            Offset::new(Flipped(inner), 0.1 * x).unwrap()
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn every_kind_obeys_the_laws(
        fu in 0.0..1.0f64, fv in 0.0..1.0f64, angle_rad in 0.0..PI, e in -6.0..6.0f64,
        axis in proptest::array::uniform3(-1.0..1.0f64), shift in proptest::array::uniform3(-20.0..20.0f64),
    ) {
        let z = Vec3::from(axis);
        prop_assume!(z.norm() > 0.1);
        let placement = Placement::new(Point3::from(shift), Unit3::new_normalize(z), None);
        let sample = Sample { fraction: uv(fu, fv), angle_rad, scale: 10f64.powf(e), placement };
        for kind in kinds() {
            laws::suite(&kind, &sample);
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
        for kind in kinds() {
            let (name, s) = (kind.name, (kind.make)(1.0));
            let (at, _) = laws::inside(&*s, uv(fu, fv));
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

/// A sphere that lies about one thing.
struct Liar {
    ball: Sphere,
    about: &'static str,
}

impl Surface for Liar {
    fn domain(&self) -> Domain {
        self.ball.domain()
    }
    fn jet2(&self, at: osculate_geom::Uv) -> osculate_geom::Jet2 {
        let mut jet = self.ball.jet2(at);
        if self.about == "second" {
            jet.duv *= 1.0 + 1e-5;
        }
        jet
    }
    fn taylor(&self, at: osculate_geom::Uv, order: usize) -> osculate_geom::Taylor {
        let mut t = self.ball.taylor(at, order);
        if self.about == "third" && order >= 3 {
            t.coordinates[0] = osculate_geom::Series::from_coefficients(order, |i, j| {
                let wrong = if (i, j) == (2, 1) { 1.0 + 1e-5 } else { 1.0 };
                wrong * t.coordinates[0].coefficient(i, j)
            });
        }
        t
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.ball.breaks(axis)
    }
}

/// The suite sees what is wrong by a hundred-thousandth in a derivative, or a hundred-millionth in a size.
#[test]
fn the_suite_catches_liars() {
    for (about, caught) in [("nothing", false), ("second", true), ("third", true), ("size", true)] {
        let make = move |x: f64| -> Box<dyn Surface> {
            let off = if about == "size" && x != 1.0 { 1.0 + 1e-8 } else { 1.0 };
            Box::new(Liar { ball: Sphere::new(2.0 * x * off).unwrap(), about })
        };
        let accuracy = Accuracy { differences: 1e-7, curvature: 1e-11 };
        let kind = Kind { name: "a liar", make: Box::new(make), accuracy };
        let placement = Placement::identity();
        let sample = Sample { fraction: uv(0.3, 0.6), angle_rad: 0.5, scale: 1e3, placement };
        let run = std::panic::AssertUnwindSafe(|| laws::suite(&kind, &sample));
        assert_eq!(std::panic::catch_unwind(run).is_err(), caught, "{about}");
    }
}
