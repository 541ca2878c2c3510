//! Poles, collapsed sides, cusps and seams of spline surfaces: limits where they exist, errors where they do not.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{moved, sphere, torus};
use osculate_geom::limit::{self, LimitError, Tolerance};
use osculate_geom::{Axis, Offset, OffsetError, Point3, Side, Surface, TurnAxis, Unit3, Vec3, uv};
use osculate_surfaces::{Net, NurbsCurve3, NurbsSurface};
use std::f64::consts::PI;

const EXACT: Tolerance = Tolerance::ROUNDING;

fn bezier(degree: [usize; 2], points: Vec<Point3>) -> NurbsSurface {
    let count = degree.map(|p| p + 1);
    let knots = degree.map(|p| [vec![0.0; p + 1], vec![1.0; p + 1]].concat());
    NurbsSurface::new(degree, knots, Net { count, points, weights: None }).unwrap()
}

/// A quarter of the lid of Newell's teapot, by his numbers (M. Newell, 1975): the knob's top is one point. Along u
/// around, along v down.
fn teapot_lid() -> NurbsSurface {
    let ring = |r: f64, h: f64, z: f64| [[r, 0.0, z], [r, -h, z], [h, -r, z], [0.0, -r, z]];
    let rows = [ring(0.0, 0.0, 3.15), ring(0.8, 0.45, 3.15), ring(0.0, 0.0, 2.85), ring(0.2, 0.112, 2.7)];
    let points =
        (0..4).flat_map(|i| (0..4).map(move |j| (i, j))).map(|(i, j)| Point3::from(rows[j][i])).collect();
    bezier([3, 3], points)
}

#[test]
fn the_knob_of_the_teapot() {
    let lid = teapot_lid();
    for k in 0..=10 {
        let top = uv(f64::from(k) / 10.0, 0.0);
        assert!(lid.jet2(top).forms().is_err(), "S_u is zero there");
        let n = limit::normal(&lid, top, &EXACT).unwrap();
        // All tangents are level; around and down is upwards against the sense of u, v.
        assert!((n.z.abs() - 1.0).abs() < 1e-14, "{n:?}");
        let near = lid.jet2(uv(top.u, 1e-7)).normal().unwrap();
        assert!((n.into_inner() - near.into_inner()).norm() < 1e-5);
        // The circle is only nearly one (0.45 / 0.8 for 0.5523): curvatures over the top differ a little.
        match limit::forms(&lid, top, &EXACT) {
            Err(LimitError::Varies { spread_per_mm, size_per_mm, .. }) => {
                assert!(spread_per_mm > 1e-3 * size_per_mm && spread_per_mm < 0.2 * size_per_mm);
            }
            other => panic!("{other:?}"),
        }
    }
    // z = 3.15 - 0.9 t^2 (..), r = 2.4 t: k = 1.8 / 2.4^2 along the meridians that end in the net's corners.
    let loose = Tolerance { curvature_relative: 0.2, ..EXACT };
    let k = limit::forms(&lid, uv(0.0, 0.0), &loose).unwrap();
    let down = k.normal_curvature(&Vec3::x()).abs();
    assert!((down - 1.8 / 5.76).abs() < 1e-12, "{down}");
}

#[test]
fn poles_of_rational_spheres() {
    for scale in [1e-6, 1.0, 1e6] {
        let ball = moved(&sphere(2.0), scale, Vec3::new(3.0, -1.0, 2.0) * scale);
        let v = ball.domain().v;
        for u in [0.0, 0.5, 1.0, 2.7, 4.0] {
            for (end, up) in [(v.lo, -1.0), (v.hi, 1.0)] {
                assert!(ball.jet2(uv(u, end)).forms().is_err());
                let f = limit::forms(&ball, uv(u, end), &EXACT).unwrap();
                let k = f.principal();
                assert!((f.normal.z - up).abs() < 1e-12, "{f:?}");
                assert!(
                    (k.k_max * scale - 0.5).abs() < 1e-9 && (k.k_min * scale - 0.5).abs() < 1e-9,
                    "{k:?}"
                );
            }
        }
        // The other side of the material.
        let hole = ball.clone().with_side(Side::Against);
        let f = limit::forms(&hole, uv(0.3, v.hi), &EXACT).unwrap();
        assert!((f.mean() * scale + 0.5).abs() < 1e-9 && (f.normal.z + 1.0).abs() < 1e-12);
    }
    // Stretched to the semi-axes 3, 2, 1: c / a^2 and c / b^2 at the poles, along x and y.
    let unit = sphere(1.0);
    let mut net = unit.net().clone();
    for p in &mut net.points {
        *p = Point3::new(3.0 * p.x, 2.0 * p.y, p.z);
    }
    let knots = [Axis::U, Axis::V].map(|a| unit.knots(a).as_slice().to_vec());
    let egg = NurbsSurface::new([2, 2], knots, net).unwrap();
    let f = limit::forms(&egg, uv(1.3, egg.domain().v.hi), &EXACT).unwrap();
    assert!((f.normal_curvature(&Vec3::x()) - 1.0 / 9.0).abs() < 1e-11);
    assert!((f.normal_curvature(&Vec3::y()) - 0.25).abs() < 1e-11);
    assert!(f.geodesic_torsion(&Vec3::x()).abs() < 1e-11);
}

/// The quadratic `z = a x^2 + b y^2 + c x y` over a triangle with one corner in the origin, exactly, as a patch of
/// degrees 2 and 2 with one side collapsed: `x = 2 v (1 - u), y = 3 v u`.
#[test]
fn a_triangle_with_a_collapsed_side() {
    let (a, b, c) = (0.3, 0.5, -0.4);
    // Blossom of z in both parameters: x and y are bilinear, their products biquadratic.
    let points = (0..9)
        .map(|k| {
            let (i, j) = (k / 3, k % 3);
            let args = |n: usize| [f64::from(u8::from(n > 1)), f64::from(u8::from(n > 0))];
            let ([u0, u1], [v0, v1]) = (args(i), args(j));
            let x = |u: f64, v: f64| 2.0 * v * (1.0 - u);
            let y = |u: f64, v: f64| 3.0 * v * u;
            // Symmetrised over both arguments of each parameter.
            let mean = |f: &dyn Fn(f64, f64, f64, f64) -> f64| 0.5 * (f(u0, v0, u1, v1) + f(u0, v1, u1, v0));
            let product = |p: &dyn Fn(f64, f64) -> f64, q: &dyn Fn(f64, f64) -> f64| {
                0.5 * (mean(&|a, b, c, d| p(a, b) * q(c, d)) + mean(&|a, b, c, d| q(a, b) * p(c, d)))
            };
            let bilinear =
                |p: &dyn Fn(f64, f64) -> f64| 0.25 * (p(u0, v0) + p(u0, v1) + p(u1, v0) + p(u1, v1));
            let z = a * product(&x, &x) + b * product(&y, &y) + c * product(&x, &y);
            Point3::new(bilinear(&x), bilinear(&y), z)
        })
        .collect();
    let s = bezier([2, 2], points);
    let p = s.point(uv(0.3, 0.7));
    assert!(
        (p.z - (a * p.x * p.x + b * p.y * p.y + c * p.x * p.y)).abs() < 1e-14,
        "the patch is the quadratic"
    );
    for u in [0.0, 0.4, 1.0] {
        let f = limit::forms(&s, uv(u, 0.0), &EXACT).unwrap();
        // The parameters run left-handed: the normal is -z, and W the Hessian.
        assert!((f.normal.z + 1.0).abs() < 1e-14);
        assert!((f.normal_curvature(&Vec3::x()) - 2.0 * a).abs() < 1e-11);
        assert!((f.normal_curvature(&Vec3::y()) - 2.0 * b).abs() < 1e-11);
        assert!((f.gauss() - (4.0 * a * b - c * c)).abs() < 1e-11);
    }
}

#[test]
fn the_apex_of_a_rational_cone() {
    // A quarter of a cone of half angle 45 degrees.
    let h = 0.5f64.sqrt();
    let rim = [[1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];
    let points = rim.iter().flat_map(|p| [Point3::origin(), Point3::from(*p)]).collect();
    let weights = Some(vec![1.0, 1.0, h, h, 1.0, 1.0]);
    let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let cone = NurbsSurface::new([2, 1], knots, Net { count: [3, 2], points, weights }).unwrap();
    match limit::normal(&cone, uv(0.5, 0.0), &EXACT) {
        // From (h, 0, -h) to (0, h, -h): cos = 1/2.
        Err(LimitError::Apex { spread_rad, .. }) => {
            assert!((spread_rad - PI / 3.0).abs() < 1e-7, "{spread_rad}")
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn seams_and_creases() {
    let ring = torus(9.0, 4.0);
    for at in [uv(0.0, 0.0), uv(4.0, 1.5), uv(1.0, 4.0)] {
        assert_eq!(limit::sides(&ring, at, &EXACT).unwrap().len(), 1, "{at:?}");
    }
    // A roof of degree one: a crease along u = 1/2.
    let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]
        .iter()
        .flat_map(|[x, z]| [0.0, 1.0].map(|y| Point3::new(*x, y, *z)))
        .collect();
    let knots = [vec![0.0, 0.0, 0.5, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let roof = NurbsSurface::new([1, 1], knots, Net { count: [3, 2], points, weights: None }).unwrap();
    let both = limit::sides(&roof, uv(0.5, 0.3), &EXACT).unwrap();
    assert_eq!(both.len(), 2);
    assert!((both[0].normal.dot(&both[1].normal)).abs() < 1e-14);
}

/// The cusp line of an offset of a spline: a cylinder of parabolas `z = x^2 / 4`, exact as a Bezier patch.
#[test]
fn the_cusp_line_of_an_offset() {
    let profile = [[-2.0, 1.0], [0.0, -1.0], [2.0, 1.0]];
    let points = profile.iter().flat_map(|[x, z]| [0.0, 3.0].map(|y| Point3::new(*x, y, *z))).collect();
    let gutter = bezier([2, 1], points);
    let s = Offset::new(&gutter, 3.0).unwrap();
    // 1 + 3 k = 0 where k = -1/2 (1 + x^2/4)^(-3/2): x as below, u = (x + 2) / 4.
    let x = 2.0 * (1.5f64.powf(2.0 / 3.0) - 1.0).sqrt();
    let edge = uv((x + 2.0) / 4.0, 0.5);
    match s.regular(edge) {
        Err(OffsetError::Cusp { factor, .. }) => assert!(factor.abs() < 1e-13),
        // Rounding may leave it on the other side.
        Ok(jet) => assert!(jet.du.norm() < 1e-12),
        Err(e) => panic!("{e}"),
    }
    assert!(s.regular(uv(0.5, 0.5)).is_err() && s.regular(uv(0.95, 0.5)).is_ok());
    // The normal is the base's on both sides and on the line.
    for du in [-1e-3, 0.0, 1e-3] {
        let at = uv(edge.u + du, 0.5);
        let n = gutter.jet2(at).normal().unwrap();
        if let Ok(m) = s.jet2(at).normal() {
            assert!((m.into_inner() - n.into_inner()).norm() < 1e-6);
        }
    }
    let found = s.check(8).unwrap();
    assert!(found.message.contains("2.000000"), "{found}");
    // An offset of a sphere's pole: the pole of another sphere.
    let ball = Offset::new(sphere(2.0), 1.0).unwrap();
    let top = uv(0.7, ball.domain().v.hi);
    assert!((ball.point(top).z - 3.0).abs() < 1e-12);
    let f = limit::forms(&ball, top, &EXACT).unwrap();
    assert!((f.mean() - 1.0 / 3.0).abs() < 1e-9, "{}", f.mean());
}

/// A spline meridian that begins on the axis at a right angle, turned: a smooth pole with the meridian's curvature.
#[test]
fn the_pole_of_a_revolved_spline() {
    let poles =
        [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [2.5, 0.0, 1.0], [3.0, 0.0, -1.0]].map(Point3::from).to_vec();
    let meridian = NurbsCurve3::new(3, vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], poles, None).unwrap();
    let axis = TurnAxis { origin: Point3::origin(), direction: Unit3::new_normalize(Vec3::z()) };
    let turn = osculate_geom::Interval::new(0.0, std::f64::consts::TAU);
    let s = osculate_geom::Revolved::new(meridian, axis, turn).unwrap();
    let f = limit::forms(&s, uv(2.0, 0.0), &EXACT).unwrap();
    // C' = (3, 0, 0), C'' = 6 (0.5, 0, -1): curvature 6 / 9 in every direction.
    let k = f.principal();
    assert!((k.k_max.abs() - 6.0 / 9.0).abs() < 1e-12 && (k.k_max - k.k_min).abs() < 1e-12, "{k:?}");
    assert!((f.normal.z.abs() - 1.0).abs() < 1e-14);
}
