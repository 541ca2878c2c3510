//! Exact NURBS forms: points lie on the kind that they came from, corners, areas and normals agree.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use osculate_geom::analytic::{
    Cone, Conic, ConicKind, Cylinder, Ellipsoid, Line, Paraboloid, Placed, Placement, Plane, Sphere, Spindle,
    Torus,
};
use osculate_geom::{
    Curve, Domain, Extruded, Flipped, Interval, Patch, Point3, Revolved, Side, Surface, TurnAxis, Unit3,
    Vec3, quadrature, uv,
};
use osculate_surfaces::{ConvertError, CurveToNurbs, NurbsCurve3, ToNurbs};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn tilted() -> Placement {
    let z = Unit3::new_normalize(Vec3::new(0.3, -0.5, 0.8));
    Placement::new(Point3::new(3.0, -1.0, 0.5), z, Some(Vec3::new(1.0, 0.2, 0.0)))
}

/// `off` is a function that vanishes on the surface and grows like the distance from it.
fn check(name: &str, s: &dyn ToNurbs, part: Domain, off: &dyn Fn(&Point3) -> f64) {
    let n = s.to_nurbs(part).unwrap();
    let d = n.domain();
    for k in 0..=12 {
        for l in 0..=12 {
            let p = n.point(d.at(f64::from(k) / 12.0, f64::from(l) / 12.0));
            // Coordinates up to 10.
            assert!(off(&p).abs() < 1e-13, "{name}: {p} is off by {:.1e}", off(&p));
        }
    }
    for (f, g) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let gap = (n.point(d.at(f, g)) - s.point(part.at(f, g))).norm();
        assert!(gap < 1e-13, "{name}: corner {f} {g} is off by {gap:.1e}");
    }
    let whole = Patch { surface: s, domain: part, side: Side::Along };
    let [a, b] = [quadrature::area(&n, 1e-9), quadrature::area(&whole, 1e-9)].map(|i| i.value);
    assert!((a - b).abs() < 1e-6 * b, "{name}: area {a} for {b}");
    // Symmetric parametrisations meet in the middle.
    let [x, y] = [n.jet2(d.at(0.5, 0.5)), s.jet2(part.at(0.5, 0.5))];
    if (x.point - y.point).norm() < 1e-9 {
        let [x, y] = [x.normal().unwrap(), y.normal().unwrap()];
        assert!((x.into_inner() - y.into_inner()).norm() < 1e-9, "{name}: normals {x:?} {y:?}");
    }
}

#[test]
fn every_kind_with_an_exact_form_has_it() {
    let part =
        |u: [f64; 2], v: [f64; 2]| Domain { u: Interval::new(u[0], u[1]), v: Interval::new(v[0], v[1]) };
    let i = Interval::new(-2.0, 3.0);
    let r = |p: &Point3| p.x.hypot(p.y);
    check("plane", &Plane::new(Domain { u: i, v: i }), part([-1.0, 3.0], [-2.0, 0.5]), &|p| p.z);
    check("cylinder", &Cylinder::new(2.0, i).unwrap(), part([0.3, 0.3 + TAU], [-2.0, 3.0]), &|p| r(p) - 2.0);
    let (s, c) = 0.4f64.sin_cos();
    let cone = Cone::new(4.0, 0.4, i).unwrap();
    check("cone", &cone, part([-1.0, 2.0], [-2.0, 3.0]), &|p| (r(p) - 4.0) * c - p.z * s);
    let ball = |p: &Point3| p.coords.norm() - 2.5;
    let sphere = Sphere::new(2.5).unwrap();
    check("sphere", &sphere, sphere.domain(), &ball);
    check("part of a sphere", &Flipped(sphere), part([1.0, 2.0], [-0.3, FRAC_PI_2]), &ball);
    let tube = |major: f64, minor: f64| move |p: &Point3| (p.x.hypot(p.y) - major).hypot(p.z) - minor;
    let torus = Torus::new(5.0, 2.0).unwrap();
    check("torus", &torus, torus.domain(), &tube(5.0, 2.0));
    let patch = Patch { surface: torus, domain: part([0.2, 2.0], [1.0, 4.0]), side: Side::Against };
    check("part of a torus", &patch, patch.domain, &tube(5.0, 2.0));
    let apple = Torus::new(1.0, 2.0).unwrap().spindle(Spindle::Apple).unwrap();
    check("apple", &apple, apple.domain(), &tube(1.0, 2.0));
    let lemon = Torus::new(1.0, 2.0).unwrap().spindle(Spindle::Lemon).unwrap();
    check("lemon", &lemon, lemon.domain(), &|p| (p.x.hypot(p.y) + 1.0).hypot(p.z) - 2.0);
    let egg = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let on_egg = |p: &Point3| (p.x / 3.0).hypot(p.y / 2.0).hypot(p.z) - 1.0;
    check("ellipsoid", &egg, egg.domain(), &on_egg);
    let frame = tilted();
    check(
        "placed ellipsoid",
        &Placed { surface: egg, placement: frame },
        part([0.4, 1.5], [-1.0, 1.0]),
        &|p| on_egg(&frame.local(p)),
    );
    let bowl = Paraboloid::new([0.3, -0.2], 2.0).unwrap();
    check("paraboloid", &bowl, part([-2.0, 1.0], [0.5, 1.5]), &|p| p.z - 0.3 * p.x * p.x + 0.2 * p.y * p.y);
    let axis = TurnAxis { origin: frame.origin, direction: frame.z };
    let radius = |p: &Point3| r(&frame.local(p));
    let line =
        Line::segment(frame.point(&Point3::new(2.0, 0.0, 0.0)), frame.point(&Point3::new(5.0, 0.0, 4.0)))
            .unwrap();
    let turned = Revolved::new(line, axis, Interval::new(0.3, 5.0)).unwrap();
    check("revolved line", &turned, turned.domain(), &|p| radius(p) - 2.0 - 0.75 * frame.local(p).z);
    // Parabola z^2 = 4 f (r - 1) turned: not in the plane of the axis but in the xz plane of the frame.
    let upright =
        Placement { origin: frame.point(&Point3::new(1.0, 0.0, 0.0)), x: frame.x, y: frame.z, z: -frame.y };
    let parabola =
        Conic::new(ConicKind::Parabola { focal_mm: 0.7 }, upright, Interval::new(-1.0, 1.2)).unwrap();
    let horn = Revolved::new(parabola, axis, Interval::new(0.0, TAU)).unwrap();
    check("revolved parabola", &horn, part([0.0, TAU], [-0.5, 1.0]), &|p| {
        let z = frame.local(p).z;
        radius(p) - 1.0 - z * z / 2.8
    });
    let kind = ConicKind::Hyperbola { semi_axes_mm: [2.0, 1.5] };
    let branch = Conic::new(kind, frame, Interval::new(-1.0, 1.2)).unwrap();
    let wall = Extruded::new(branch, frame.z.into_inner() * 2.0, Interval::new(-1.0, 1.0)).unwrap();
    check("extruded hyperbola", &wall, wall.domain(), &|p| {
        let q = frame.local(p);
        q.x - 2.0 * 1f64.hypot(q.y / 1.5)
    });
}

/// Conics keep their ends, their tangents there and all their points.
#[test]
fn conics_in_space() {
    let frame = tilted();
    for (kind, lo, hi) in [
        (ConicKind::Ellipse { semi_axes_mm: [3.0, 1.2] }, 0.4, 0.4 + 1.5 * PI),
        (ConicKind::Parabola { focal_mm: 0.7 }, -2.0, 1.5),
        (ConicKind::Hyperbola { semi_axes_mm: [2.0, 0.5] }, -1.0, 2.0),
    ] {
        let c = Conic::new(kind, frame, Interval::new(lo, hi)).unwrap();
        let n = c.to_nurbs(c.domain()).unwrap();
        let d = n.domain();
        for (a, b) in [(d.lo, lo), (d.hi, hi)] {
            let (x, y) = (n.jet(a), Curve::jet(&c, b));
            assert!((x.point - y.point).norm() < 1e-14 * 10.0);
            assert!((x.first.normalize() - y.first.normalize()).norm() < 1e-13);
        }
        for k in 0..=40 {
            let q = frame.local(&n.point(d.at(f64::from(k) / 40.0)));
            let off = match kind {
                ConicKind::Ellipse { semi_axes_mm: [a, b] } => (q.x / a).hypot(q.y / b) - 1.0,
                ConicKind::Parabola { focal_mm: f } => (q.y * q.y - 4.0 * f * q.x) / (4.0 * f),
                ConicKind::Hyperbola { semi_axes_mm: [a, b] } => q.x / a - 1f64.hypot(q.y / b),
            };
            assert!(off.abs() < 1e-13 && q.z.abs() < 1e-13, "{kind:?} {off:.1e}");
        }
    }
    let s = NurbsCurve3::new(
        1,
        vec![0.0, 0.0, 1.0, 1.0],
        vec![Point3::origin(), Point3::new(4.0, 0.0, 0.0)],
        None,
    );
    let half = s.unwrap().to_nurbs(Interval::new(0.25, 0.5)).unwrap();
    assert_eq!(half.poles(), [Point3::new(1.0, 0.0, 0.0), Point3::new(2.0, 0.0, 0.0)]);
}

#[test]
fn parts_that_are_none_are_refused() {
    let endless = Interval::new(f64::NEG_INFINITY, f64::INFINITY);
    let wall = Cylinder::new(2.0, endless).unwrap();
    let ask = |u: [f64; 2], v: [f64; 2]| {
        wall.to_nurbs(Domain { u: Interval::new(u[0], u[1]), v: Interval::new(v[0], v[1]) })
    };
    assert!(ask([0.0, 1.0], [-1.0, 1.0]).is_ok());
    for (u, v) in [
        ([0.0, 1.0], [0.0, f64::INFINITY]),
        ([0.0, 1.0], [1.0, 1.0]),
        ([0.0, 7.0], [0.0, 1.0]),
        ([1.0, 0.0], [0.0, 1.0]),
        ([f64::NAN, 1.0], [0.0, 1.0]),
    ] {
        assert!(matches!(ask(u, v), Err(ConvertError::Part { .. })), "{u:?} {v:?}");
    }
    let line = Line::segment(Point3::origin(), Point3::new(1.0, 2.0, 3.0)).unwrap();
    let refused = line.to_nurbs(Interval::new(0.0, 1.5)).unwrap_err();
    assert!(refused.to_string().contains("[0, 1]"), "{refused}");
    let sphere = Sphere::new(1.0).unwrap();
    let beyond = Domain { v: Interval::new(0.0, 2.0), ..sphere.domain() };
    assert!(sphere.to_nurbs(beyond).is_err());
    let at = uv(0.0, 0.0);
    assert!(sphere.contains(at));
}
