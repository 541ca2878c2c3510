//! Normals and curvatures where the parametrisation gives none.

use osculate_geom::analytic::{Cone, Conic, ConicKind, Ellipsoid, Line, Placement, Sphere, Spindle, Torus};
use osculate_geom::limit::{self, LimitError, Tolerance};
use osculate_geom::{
    Curve, CurveTaylor, Domain, Extruded, Flipped, Interval, Jet2, Offset, Point3, Revolved, Series, Side,
    Surface, Taylor, TurnAxis, Uv, Vec3, uv,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const EXACT: Tolerance = Tolerance::ROUNDING;

/// A surface given by its formula in series arithmetic.
struct Formula<F> {
    domain: Domain,
    f: F,
}

impl<F: Fn(Series, Series) -> [Series; 3] + Send + Sync> Surface for Formula<F> {
    fn domain(&self) -> Domain {
        self.domain
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.taylor(uv, 2).jet2()
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let (u, v) = (
            Series::variable(osculate_geom::Axis::U, uv.u, order),
            Series::variable(osculate_geom::Axis::V, uv.v, order),
        );
        Taylor { uv, side: Side::Along, coordinates: (self.f)(u, v) }
    }
}

fn unit_square() -> Domain {
    Domain { u: Interval::new(0.0, 1.0), v: Interval::new(0.0, 1.0) }
}

/// A half circle through both poles, turned: at the poles the angle has no tangent.
fn turned_half_circle(semi_axes_mm: [f64; 2], turn: Interval) -> Revolved<Conic> {
    let frame = Placement { y: Vec3::z_axis(), z: -Vec3::y_axis(), ..Placement::identity() };
    let half = Interval::new(-FRAC_PI_2, FRAC_PI_2);
    let curve = Conic::new(ConicKind::Ellipse { semi_axes_mm }, frame, half).unwrap();
    Revolved::new(curve, TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() }, turn).unwrap()
}

#[test]
fn the_pole_of_a_sphere_is_as_round_as_the_rest() {
    for turn in [Interval::new(0.0, TAU), Interval::new(0.3, 2.0)] {
        for v in [-FRAC_PI_2, FRAC_PI_2] {
            let ball = turned_half_circle([2.0, 2.0], turn);
            for u in [turn.lo, turn.at(0.4), turn.hi] {
                let n = limit::normal(&ball, uv(u, v), &EXACT).unwrap();
                assert!((n.z - v.signum()).abs() < 1e-14, "{n:?}");
                let k = limit::forms(&ball, uv(u, v), &EXACT).unwrap().principal();
                assert!((k.k_max - 0.5).abs() < 1e-11 && (k.k_min - 0.5).abs() < 1e-11, "{k:?}");
                let hole = limit::forms(&Flipped(&ball), uv(u, v), &EXACT).unwrap();
                assert!((hole.mean() + 0.5).abs() < 1e-11 && (hole.normal.z + v.signum()).abs() < 1e-14);
            }
        }
    }
    // The closed forms' own poles, and those of an ellipsoid of three axes: c / a^2 and c / b^2.
    let s = Sphere::new(2.0).unwrap();
    let k = limit::forms(&s, uv(1.0, FRAC_PI_2), &EXACT).unwrap().principal();
    assert!((k.k_max - 0.5).abs() < 1e-12 && (k.k_min - 0.5).abs() < 1e-12);
    let e = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let k = limit::forms(&e, uv(0.8, -FRAC_PI_2), &EXACT).unwrap().principal();
    assert!((k.k_max - 0.25).abs() < 1e-10 && (k.k_min - 1.0 / 9.0).abs() < 1e-10, "{k:?}");
    assert!(k.d_max.y.abs() > 1.0 - 1e-8);
}

/// A place that is a pole to the last digit, not to the rounding of pi: `(y cos x, y sin x, f(y cos x, y sin x))`.
#[test]
fn the_vertex_of_a_paraboloid_in_polar_parameters() {
    let (a, b, c) = (0.3, -0.1, 0.2);
    let domain = Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(0.0, 2.0) };
    let polar = Formula {
        domain,
        f: move |u: Series, v: Series| {
            let (s, co) = u.sin_cos();
            let (x, y) = (v * co, v * s);
            [x, y, x * x * a + y * y * b + x * y * c]
        },
    };
    assert!(polar.jet2(uv(0.3, 0.0)).forms().is_err());
    let f = limit::forms(&polar, uv(0.3, 0.0), &EXACT).unwrap();
    // S_u x S_v = -y n: material above. W = Hessian.
    assert!((f.normal.z + 1.0).abs() < 1e-14);
    assert!((f.mean() - (a + b)).abs() < 1e-12 && (f.gauss() - (4.0 * a * b - c * c)).abs() < 1e-12);
    let along_x = f.normal_curvature(&Vec3::x());
    assert!((along_x - 2.0 * a).abs() < 1e-12, "{along_x}");
    assert!((f.normal_curvature(&Vec3::new(1.0, 1.0, 0.0)) - (a + b + c)).abs() < 1e-12);
}

#[test]
fn an_apex_is_an_error_with_its_opening() {
    let half = 0.4;
    let cone = Cone::new(0.0, half, Interval::new(0.0, 1.0)).unwrap();
    match limit::normal(&cone, uv(0.3, 0.0), &EXACT) {
        // Normals on opposite sides of the cone: pi - 2 half.
        Err(LimitError::Apex { spread_rad, at }) => {
            assert!((spread_rad - (PI - 2.0 * half)).abs() < 0.1 && at == uv(0.3, 0.0), "{spread_rad}");
        }
        other => panic!("{other:?}"),
    }
    assert!(limit::forms(&cone, uv(0.3, 0.0), &EXACT).unwrap_err().to_string().contains("apex"));
    // Along one line there is a normal: cos alpha outwards, sin alpha down.
    let one = limit::sides(&cone, uv(0.0, 0.0), &EXACT).unwrap();
    assert_eq!(one.len(), 1);
    assert!((one[0].normal.x - half.cos()).abs() < 1e-14 && (one[0].normal.z + half.sin()).abs() < 1e-14);
    assert!(matches!(limit::normal(&ExactApex, uv(0.7, 0.0), &EXACT), Err(LimitError::Apex { .. })));
}

#[test]
fn a_spindle_torus_has_two_apexes_and_two_parts() {
    let whole = Torus::new(1.0, 2.0).unwrap();
    let apex = 2.0 * PI / 3.0;
    for v in [apex, TAU - apex] {
        let at = uv(0.7, v);
        let p = whole.point(at);
        assert!(p.x.hypot(p.y) < 1e-15 && (p.z.abs() - 3f64.sqrt()).abs() < 1e-15);
        assert!(whole.jet2(at).forms().is_err());
        assert!(matches!(limit::normal(&whole, at, &EXACT), Err(LimitError::Apex { .. })));
    }
    for part in [Spindle::Apple, Spindle::Lemon] {
        let s = whole.spindle(part).unwrap();
        let v = s.domain().v;
        assert!((s.point(uv(0.0, v.lo)).z + s.point(uv(0.0, v.hi)).z).abs() < 1e-15);
        assert!(matches!(limit::normal(&s, uv(0.2, v.lo), &EXACT), Err(LimitError::Apex { .. })));
        for k in 1..20 {
            let jet = s.jet2(uv(f64::from(k), v.at(f64::from(k) / 20.0)));
            let forms = jet.forms().unwrap();
            // Out of the tube: from the axis on the lemon and the outer half of the apple; convex along the tube.
            let radial = Vec3::new(jet.point.x, jet.point.y, 0.0).normalize();
            let v = jet.uv.v;
            if v.cos().abs() > 0.1 {
                let outward = forms.normal.dot(&radial) > 0.0;
                assert_eq!(outward, part == Spindle::Lemon || v.cos() > 0.0, "{part:?} {v}");
            }
            assert!((forms.normal_curvature(&jet.dv) - 0.5).abs() < 1e-14);
        }
    }
    assert!(Torus::new(3.0, 2.0).unwrap().spindle(Spindle::Apple).is_err());
    assert!(Torus::new(2.0, 2.0).unwrap().spindle(Spindle::Lemon).is_err());
    assert!(Torus::new(2.0, 2.0).unwrap().spindle(Spindle::Apple).is_ok());
}

/// Both nappes of a cone: the line v = 0 is one point inside the rectangle.
struct ExactApex;

impl Surface for ExactApex {
    fn domain(&self) -> Domain {
        Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(-1.0, 1.0) }
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.taylor(uv, 2).jet2()
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let (s, c) = Series::variable(osculate_geom::Axis::U, uv.u, order).sin_cos();
        let v = Series::variable(osculate_geom::Axis::V, uv.v, order);
        Taylor { uv, side: Side::Along, coordinates: [v * c, v * s, v * 2.0] }
    }
}

/// `(t^2, t^3, 0)` extruded: a cuspidal edge. The tangent plane exists, the normal changes sides, the curvature is
/// unbounded.
struct Cusp;

impl Curve for Cusp {
    fn domain(&self) -> Interval {
        Interval::new(-1.0, 1.0)
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let c = [
            Vec3::new(t * t, t * t * t, 0.0),
            Vec3::new(2.0 * t, 3.0 * t * t, 0.0),
            Vec3::new(1.0, 3.0 * t, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
        ];
        CurveTaylor::from_coefficients(t, order, |k| c.get(k).copied().unwrap_or_default())
    }
}

#[test]
fn a_cuspidal_edge_turns_over() {
    let whole = Extruded::new(Cusp, Vec3::z(), Interval::new(0.0, 1.0)).unwrap();
    let edge = uv(0.0, 0.5);
    assert!(whole.jet2(edge).forms().is_err());
    match limit::normal(&whole, edge, &EXACT) {
        Err(LimitError::TurnsOver { normal, spread_rad, .. }) => {
            assert!((normal.y.abs() - 1.0).abs() < 1e-14 && (spread_rad - PI).abs() < 1e-12);
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(limit::sides(&whole, edge, &EXACT).unwrap().len(), 2);
    // One half of it ends in the edge: its normal is there, its curvature grows without bound.
    let half = osculate_geom::Patch {
        surface: whole,
        domain: Domain { u: Interval::new(0.0, 1.0), v: Interval::new(0.0, 1.0) },
        side: Side::Along,
    };
    let n = limit::normal(&half, edge, &EXACT).unwrap();
    assert!((n.y + 1.0).abs() < 1e-14, "{n:?}");
    let unbounded = limit::forms(&half, edge, &EXACT);
    assert!(matches!(unbounded, Err(LimitError::Unbounded { .. })), "{unbounded:?}");
}

/// The cusp line of an offset: `z = x^2 / 4` (material below) offset to the centre of curvature at its
/// vertex. There S_u vanishes; the normal of the offset is the base's.
#[test]
fn the_cusp_of_an_offset() {
    let s = Offset::new(osculate_geom::analytic::Paraboloid::new([0.25, 0.0], 2.0).unwrap(), 2.0).unwrap();
    let edge = uv(0.0, 0.5);
    let jet = s.jet2(edge);
    assert!(jet.du.norm() < 1e-15 && jet.forms().is_err());
    // O_u = (1 + d k) S_u is of second order in u at the vertex and keeps its sign: the edge is no cusp yet but the
    // swallow's point of the evolute, where the curvature is unbounded.
    let n = limit::normal(&s, edge, &EXACT).unwrap();
    assert!((n.z - 1.0).abs() < 1e-12, "{n:?}");
    assert!(matches!(limit::forms(&s, edge, &EXACT), Err(LimitError::Unbounded { .. })));
    // Farther out there are two cusp lines, where 1 + d k = 0: k = -1/2 (1 + x^2/4)^(-3/2).
    let far = Offset::new(osculate_geom::analytic::Paraboloid::new([0.25, 0.0], 2.0).unwrap(), 3.0).unwrap();
    let x = 2.0 * (1.5f64.powf(2.0 / 3.0) - 1.0).sqrt();
    let before = far.jet2(uv(x - 1e-3, 0.0));
    let behind = far.jet2(uv(x + 1e-3, 0.0));
    assert_ne!(before.side, behind.side);
    let (a, b) = (before.normal().unwrap(), behind.normal().unwrap());
    assert!((a.into_inner() - b.into_inner()).norm() < 2e-3);
}

/// A triangle: the side v = 0 is one corner, `x = v (1 - u), y = v u` over a quadratic.
#[test]
fn the_collapsed_corner_of_a_triangle() {
    let (a, b, c) = (0.3, 0.5, -0.4);
    let triangle = Formula {
        domain: unit_square(),
        f: move |u: Series, v: Series| {
            let one = Series::constant(1.0, u.order());
            let (x, y) = (v * (one - u) * 2.0, v * u * 3.0);
            [x, y, x * x * a + y * y * b + x * y * c + x * 0.5]
        },
    };
    for u in [0.0, 0.25, 0.7, 1.0] {
        let f = limit::forms(&triangle, uv(u, 0.0), &EXACT).unwrap();
        // The graph z(x, y) at the origin: gradient (1/2, 0), Hessian [[2a, c], [c, 2b]].
        let g = 1.25f64;
        let gauss = (4.0 * a * b - c * c) / (g * g);
        assert!((f.gauss() - gauss).abs() < 1e-11, "{} {gauss}", f.gauss());
        // The parameters run left-handed: the normal points down.
        assert!((f.normal.z + 1.0 / g.sqrt()).abs() < 1e-13);
        // H = (z_xx + (1 + z_x^2) z_yy) / (2 W^3).
        let mean = (2.0 * b * g + 2.0 * a) / (2.0 * g.powf(1.5));
        assert!((f.mean() - mean).abs() < 1e-11, "{} {mean}", f.mean());
    }
}

/// A corner whose sides run on in one line: S_u and S_v are parallel there and nowhere else.
#[test]
fn a_corner_with_parallel_sides() {
    // The unit square squared as a complex number: a half plane bent over a parabola, corner at the origin.
    let s = Formula {
        domain: unit_square(),
        f: |u: Series, v: Series| {
            let (x, y) = (u * u - v * v, u * v * 2.0);
            [x + u * 0.0, y, x * x]
        },
    };
    let n = limit::normal(&s, uv(0.0, 0.0), &EXACT);
    // N = 4 (u^2 + v^2) e_z at lowest order: of one sign, though no power of u or v.
    assert!((n.unwrap().z - 1.0).abs() < 1e-12);
    assert!(matches!(limit::forms(&s, uv(0.0, 0.0), &EXACT), Err(LimitError::Undetermined { .. })));
    // Of both signs: no limit.
    let fold = Formula {
        domain: unit_square(),
        f: |u: Series, v: Series| [u * u - v * v, u * u + v * v * 2.0, u * v],
    };
    let none = limit::normal(&fold, uv(0.0, 0.0), &EXACT);
    assert!(matches!(none, Err(LimitError::Undetermined { order: 6, .. })), "{none:?}");
    // A surface that stands still altogether.
    let point = Formula { domain: unit_square(), f: |u: Series, _: Series| [u * 0.0, u * 0.0, u * 0.0] };
    assert!(limit::normal(&point, uv(0.5, 0.5), &EXACT).is_err());
    let line = Formula { domain: unit_square(), f: |u: Series, _: Series| [u, u * 2.0, u * 0.0] };
    assert!(matches!(limit::normal(&line, uv(0.5, 0.5), &EXACT), Err(LimitError::Undetermined { .. })));
}

/// The curvature around a pole that is no quadratic form: the surface has a tangent plane, no curvature.
#[test]
fn curvatures_that_vary_around_a_pole() {
    let domain = Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(0.0, 1.0) };
    let s = Formula {
        domain,
        f: |u: Series, v: Series| {
            let (s, c) = u.sin_cos();
            let (s4, _) = (u * 4.0).sin_cos();
            [v * c, v * s, v * v * (s4 * 0.1 + Series::constant(0.5, u.order()))]
        },
    };
    let n = limit::normal(&s, uv(0.2, 0.0), &EXACT).unwrap();
    assert!((n.z + 1.0).abs() < 1e-14);
    match limit::forms(&s, uv(0.2, 0.0), &EXACT) {
        // k along the meridian from 0.8 to 1.2, and across it more.
        Err(LimitError::Varies { spread_per_mm, size_per_mm, .. }) => {
            assert!(spread_per_mm > 0.4 && size_per_mm > 1.2, "{spread_per_mm} {size_per_mm}");
        }
        other => panic!("{other:?}"),
    }
    // Who takes what lies within the tolerance gets it.
    let loose = Tolerance { curvature_relative: 10.0, ..EXACT };
    assert!(limit::forms(&s, uv(0.2, 0.0), &loose).is_ok());
}

/// A broken line extruded: two normals on the crease, one beside it.
#[test]
fn creases_and_seams_have_a_normal_on_each_side() {
    struct Roof;
    impl Curve for Roof {
        fn domain(&self) -> Interval {
            Interval::new(-1.0, 1.0)
        }
        fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
            let slope = if t < 0.0 { 1.0 } else { -1.0 };
            CurveTaylor::from_coefficients(t, order, |k| match k {
                0 => Vec3::new(t, 0.0, slope * t),
                1 => Vec3::new(1.0, 0.0, slope),
                _ => Vec3::zeros(),
            })
        }
        fn breaks(&self) -> Vec<f64> {
            vec![-1.0, 0.0, 1.0]
        }
    }
    let roof = Extruded::new(Roof, Vec3::y(), Interval::new(0.0, 1.0)).unwrap();
    let two = limit::sides(&roof, uv(0.0, 0.5), &EXACT).unwrap();
    assert_eq!(two.len(), 2);
    let r = 0.5f64.sqrt();
    assert!((two[0].normal.x - r).abs() < 1e-14 && two[0].toward[0] == 1.0);
    assert!((two[1].normal.x + r).abs() < 1e-14 && two[1].toward[0] == -1.0);
    assert_eq!(limit::sides(&roof, uv(0.3, 0.5), &EXACT).unwrap().len(), 1);
    // The seam of a closed surface that is smooth there.
    let t = Torus::new(5.0, 2.0).unwrap();
    for at in [uv(0.0, 0.0), uv(TAU, 1.0), uv(1.0, TAU)] {
        assert_eq!(limit::sides(&t, at, &EXACT).unwrap().len(), 1, "{at:?}");
    }
    // A meridian that ends on the axis at a right angle makes a smooth pole even where it is a straight line.
    let spoke = Line::segment(Point3::origin(), Point3::new(2.0, 0.0, 0.0)).unwrap();
    let axis = TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() };
    let disc = Revolved::new(spoke, axis, Interval::new(0.0, TAU)).unwrap();
    let f = limit::forms(&disc, uv(1.0, 0.0), &EXACT).unwrap();
    assert!(f.mean().abs() < 1e-12 && (f.normal.z.abs() - 1.0).abs() < 1e-14);
}
