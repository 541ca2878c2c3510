//! The laws of surfaces on every kind of this crate, alone and under the wrappers of `geom`.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{moved, reference, sphere, torus};
use osculate_geom::analytic::{Conic, ConicKind, Placed, Placement};
use osculate_geom::laws::{self, Accuracy, Kind, Sample};
use osculate_geom::{
    Axis, Domain, Extruded, Flipped, Interval, Offset, Patch, Point3, Revolved, Ruled, Side, Surface,
    TurnAxis, Unit3, Vec3, uv,
};
use osculate_surfaces::{Analytic, Net, NurbsCurve3, NurbsSurface, Shape, TrimmedSurface, ruled};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A net of poles `f(i, j)`.
fn net(count: [usize; 2], f: impl Fn(f64, f64) -> Point3) -> Net {
    let [n, m] = count;
    let points = (0..n * m).map(|k| f((k / m) as f64, (k % m) as f64)).collect();
    Net { count, points, weights: None }
}

fn hill(i: f64, j: f64) -> Point3 {
    Point3::new(10.0 * i + j, 9.0 * j - 0.5 * i, 4.0 * (0.9 * i + 0.3).sin() - 3.0 * (0.7 * j).cos())
}

fn clamped(p: usize, inner: &[f64], end: f64) -> Vec<f64> {
    let mut k = vec![0.0; p + 1];
    k.extend(inner);
    k.extend(vec![end; p + 1]);
    k
}

fn bezier() -> NurbsSurface {
    NurbsSurface::new([3, 3], [clamped(3, &[], 1.0), clamped(3, &[], 1.0)], net([4, 4], hill)).unwrap()
}

fn spline(rational: bool) -> NurbsSurface {
    let mut net = net([6, 5], hill);
    if rational {
        net.weights = Some((0..30).map(|k| 1.0 + 0.5 * f64::from(k).sin()).collect());
    }
    // A double knot among single ones.
    let knots = [clamped(3, &[1.0, 1.0], 2.5), clamped(2, &[0.5, 2.0], 3.0)];
    NurbsSurface::new([3, 2], knots, net).unwrap()
}

/// A torus with bumps: closed both ways, cubic, smooth to second order across both seams.
fn bumpy_torus() -> NurbsSurface {
    let (n, m) = (9, 7);
    let at = |i: f64, j: f64| {
        let (a, b) = (TAU * (i % n as f64) / n as f64, TAU * (j % m as f64) / m as f64);
        let tube = 6.0 + (2.0 * a + b).sin();
        let r = 20.0 + 2.0 * (3.0 * a).cos() + tube * b.cos();
        Point3::new(r * a.cos(), r * a.sin(), tube * b.sin() + 1.5 * a.sin())
    };
    let knots = |n: usize| (0..n + 7).map(|k| k as f64 - 3.0).collect::<Vec<_>>();
    NurbsSurface::new([3, 3], [knots(n), knots(m)], net([n + 3, m + 3], at)).unwrap()
}

fn curve(rational: bool, shift: Vec3) -> NurbsCurve3 {
    let poles = (0..6).map(|k| hill(f64::from(k), 0.4 * f64::from(k)) + shift).collect();
    let weights = rational.then(|| vec![1.0, 1.4, 0.7, 1.0, 1.2, 0.9]);
    NurbsCurve3::new(3, clamped(3, &[0.5, 2.0], 3.0), poles, weights).unwrap()
}

/// A curve with its poles multiplied.
fn scaled(c: &NurbsCurve3, x: f64) -> NurbsCurve3 {
    let poles = c.poles().iter().map(|p| p * x).collect();
    let weights = c.weights().map(<[f64]>::to_vec);
    NurbsCurve3::new(c.degree(), c.knots().as_slice().to_vec(), poles, weights).unwrap()
}

fn tilted(x: f64) -> Placement {
    let z = Unit3::new_normalize(Vec3::new(0.3, -0.5, 0.8));
    Placement::new(Point3::new(3.0, -1.0, 0.5) * x, z, Some(Vec3::new(1.0, 0.2, 0.0)))
}

fn kinds() -> Vec<Kind> {
    fn kind<S: Surface + 'static>(
        name: &'static str,
        make: impl Fn(f64) -> S + Send + Sync + 'static,
    ) -> Kind {
        // Pieces in powers lose a bit a degree; some hundred roundings. Curvatures here are up to 30 times smaller
        // than |S_uu| / |S_u|^2.
        let accuracy = Accuracy { differences: 1e-6, curvature: 1e-10 };
        Kind { name, make: Box::new(move |x| Box::new(make(x))), accuracy }
    }
    let of = |s: NurbsSurface| move |x: f64| moved(&s, x, Vec3::zeros());
    let analytic = |shape: fn(f64) -> Shape| {
        move |x: f64| {
            let part = Domain { u: Interval::new(0.2, 1.7), v: Interval::new(0.3, 1.2) };
            let limits = Domain {
                u: if shape(1.0) == Shape::Plane { Interval::new(0.2 * x, 1.7 * x) } else { part.u },
                v: match shape(1.0) {
                    Shape::Sphere { .. } | Shape::Torus { .. } => part.v,
                    _ => Interval::new(0.3 * x, 1.2 * x),
                },
            };
            Analytic::new(shape(x), tilted(x)).unwrap().limited(limits)
        }
    };
    let up = Vec3::new(3.0, 2.0, 30.0);
    let axis = |x: f64| TurnAxis {
        origin: Point3::new(0.0, -60.0, 0.0) * x,
        direction: Unit3::new_normalize(Vec3::new(1.0, 0.1, 0.2)),
    };
    let turned = move |x: f64| {
        Revolved::new(scaled(&curve(true, Vec3::zeros()), x), axis(x), Interval::new(-0.5, 2.0)).unwrap()
    };
    let arc = |x: f64| {
        // Below the spline, in its sense.
        let frame = Placement { origin: Point3::new(25.0, 10.0, -5.0) * x, ..Placement::identity() };
        let kind = ConicKind::Ellipse { semi_axes_mm: [40.0 * x, 20.0 * x] };
        Conic::new(kind, frame, Interval::new(PI + 0.3, TAU - 0.3)).unwrap()
    };
    vec![
        kind("Bezier", of(bezier())),
        kind("B-spline", of(spline(false))),
        kind("NURBS", of(spline(true))),
        kind("reference polynomial", of(reference(false))),
        kind("reference rational", of(reference(true))),
        kind("periodic B-spline", of(bumpy_torus())),
        kind("rational sphere", of(sphere(7.0))),
        kind("rational torus", of(torus(9.0, 4.0))),
        kind("B-spline with the material above", |x| {
            moved(&spline(false), x, Vec3::zeros()).with_side(Side::Against)
        }),
        kind("ruled B-spline", move |x| {
            let both = [curve(false, Vec3::zeros()), curve(false, up)].map(|c| scaled(&c, x));
            ruled(&both[0], &both[1]).unwrap()
        }),
        kind("ruled between spline and arc", move |x| {
            Ruled::new(scaled(&curve(true, up), x), arc(x)).unwrap()
        }),
        kind("revolved spline", turned),
        kind("extruded spline", move |x| {
            let c = scaled(&curve(true, Vec3::zeros()), x);
            Extruded::new(c, up * (0.1 * x), Interval::new(-2.0, 5.0)).unwrap()
        }),
        kind("offset Bezier", |x| Offset::new(moved(&bezier(), x, Vec3::zeros()), 1.5 * x).unwrap()),
        kind("offset NURBS", |x| Offset::new(moved(&spline(true), x, Vec3::zeros()), -0.7 * x).unwrap()),
        kind("offset periodic", |x| Offset::new(moved(&bumpy_torus(), x, Vec3::zeros()), 0.5 * x).unwrap()),
        kind("offset revolved", move |x| Offset::new(turned(x), 0.8 * x).unwrap()),
        kind("trimmed NURBS", |x| {
            let loops = [vec![uv(0.1, 0.1), uv(2.4, 0.2), uv(1.5, 2.9)]];
            TrimmedSurface::new(Arc::new(moved(&spline(true), x, Vec3::zeros())), &loops, Side::Against)
                .unwrap()
        }),
        kind("trimmed offset", |x| {
            let base = Offset::new(moved(&bezier(), x, Vec3::zeros()), x).unwrap();
            let loops = [vec![uv(0.1, 0.1), uv(0.9, 0.2), uv(0.5, 0.9)]];
            TrimmedSurface::new(Arc::new(base), &loops, Side::Along).unwrap()
        }),
        kind("placed NURBS", |x| Placed {
            surface: moved(&spline(true), x, Vec3::zeros()),
            placement: tilted(x),
        }),
        kind("flipped NURBS", |x| Flipped(moved(&spline(true), x, Vec3::zeros()))),
        kind("patch of a NURBS", |x| Patch {
            surface: moved(&spline(true), x, Vec3::zeros()),
            domain: Domain { u: Interval::new(0.3, 2.1), v: Interval::new(0.2, 2.5) },
            side: Side::Against,
        }),
        kind("plane of a face", analytic(|_| Shape::Plane)),
        kind("cylinder of a face", analytic(|x| Shape::Cylinder { radius_mm: 3.0 * x })),
        kind("cone of a face", analytic(|x| Shape::Cone { radius_mm: 2.0 * x, half_angle_rad: 0.4 })),
        kind("sphere of a face", analytic(|x| Shape::Sphere { radius_mm: 4.0 * x })),
        kind(
            "torus of a face",
            analytic(|x| Shape::Torus { major_radius_mm: 6.0 * x, minor_radius_mm: 1.5 * x }),
        ),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

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
}

#[test]
fn total_curvature_of_closed_splines() {
    // Rational sphere and torus, and a free-form torus: 2 pi chi.
    let check = |s: &dyn Surface, panels: usize, want: f64| {
        let total = laws::total_curvature(s, panels);
        assert!(total.error < 1e-6 && (total.value - want).abs() < 1e-7, "{total:?} for {want}");
    };
    check(&sphere(7.0), 6, 4.0 * PI);
    check(&moved(&sphere(7.0), 1e-5, Vec3::new(1.0, 2.0, 3.0)), 6, 4.0 * PI);
    check(&torus(9.0, 4.0), 6, 0.0);
    // A stretched sphere is closed and smooth as well.
    let mut net = sphere(7.0).net().clone();
    for p in &mut net.points {
        *p = Point3::new(p.x * 2.0 + 0.3 * p.z, p.y, p.z * 0.7);
    }
    let knots = [Axis::U, Axis::V].map(|a| sphere(7.0).knots(a).as_slice().to_vec());
    check(&NurbsSurface::new([2, 2], knots, net).unwrap(), 16, 4.0 * PI);
    let ring = bumpy_torus();
    assert!(ring.domain().u.periodic && ring.domain().v.periodic);
    // Positive and negative parts of about 4 pi each cancel.
    check(&ring, 6, 0.0);
    check(&Offset::new(ring, 0.5).unwrap(), 6, 0.0);
}
