//! Contours, gradient lines, parabolic lines, asymptotic lines and ridges against closed forms and a dense grid.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use crate::common;

use common::bezier_graph;
use osculate_geom::analytic::{Ellipsoid, Paraboloid, Placed, Placement, Sphere, Torus};
use osculate_geom::{Axis, Point3, Side, Surface, Unit3, Vec3, uv};
use osculate_surfaces::lines::{
    Chart, Course, Cover, CriticalKind, CurvatureDifference, Family, Gauss, Height, LineEnd, LinePoint,
    LineTolerance, TraceStops, Turn, contours, cover, critical_points, ridges, trace, turned, umbilics,
};
use osculate_surfaces::{NurbsSurface, TrimmedSurface, gallery};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

fn chart(surface: &dyn Surface) -> Chart<'_> {
    let size = Chart::new(surface, LineTolerance::for_size(1.0)).unwrap().size_mm();
    Chart::new(surface, LineTolerance::for_size(size)).unwrap()
}

fn along(x: f64, y: f64, z: f64) -> Height {
    Height { axis: Unit3::new_normalize(Vec3::new(x, y, z)) }
}

/// Curvatures of a sphere differ by rounding alone, wherever it lies: nothing of that noise is a critical point, and every cell is flat.
#[test]
fn the_noise_of_a_constant_field_has_no_critical_points() {
    let there = Placement::new(
        Point3::new(9_400.0, -12_000.0, 17.0),
        Unit3::new_normalize(Vec3::new(0.3, -0.5, 0.8)),
        None,
    );
    let sphere = Placed { surface: Sphere::new(211.0).unwrap(), placement: there };
    let c = chart(&sphere);
    let found = critical_points(&c, &CurvatureDifference);
    let cells = [Axis::U, Axis::V].map(|a| c.borders(a).len() - 1);
    assert_eq!(found.flat.len(), cells[0] * cells[1]);
    assert!(found.points.is_empty() && found.lines.is_empty(), "{:?}", found.points);
}

/// A plane cuts a sphere in a circle, through the poles and across the seam too.
#[test]
fn contours_of_a_sphere_are_circles() {
    let r = 10.0;
    let s = Sphere::new(r).unwrap();
    let c = chart(&s);
    for axis in [along(0.0, 0.0, 1.0), along(1.0, 0.0, 0.0), along(0.0, 1.0, 0.0), along(1.0, -2.0, 0.5)] {
        let extremes = critical_points(&c, &axis);
        let kinds = |k| extremes.inside(k).count();
        assert_eq!(
            (kinds(CriticalKind::Minimum), kinds(CriticalKind::Maximum)),
            (1, 1),
            "{axis:?} {extremes:?}"
        );
        assert_eq!(kinds(CriticalKind::Saddle), 0);
        let levels = [-9.9999, -5.0, 0.0, 3.0, 9.99, 9.999_999];
        let found = contours(&c, &axis, &levels, Some(&extremes));
        assert_eq!(found.lines.len(), levels.len(), "{axis:?}");
        for (line, level) in found.lines.iter().zip(levels) {
            assert_eq!(line.level, level);
            assert!(line.line.is_closed(), "{axis:?} {level}");
            for p in &line.line.points {
                assert!((p.point.coords.dot(&axis.axis) - level).abs() < 1e-8, "{axis:?} {level} {p:?}");
            }
            // The length is that of the circle less what the chords cut off: pieces of angle 2 t with a sagitta
            // r (1 - cos t) below the tolerance lose t^2 / 6 of it.
            let radius = (r * r - level * level).sqrt();
            let t = (1.0 - c.tolerance().chord_mm / radius).max(-1.0).acos();
            let share = line.line.length_mm() / (2.0 * PI * radius);
            assert!(share < 1.0 + 1e-12 && share > 1.0 - t * t / 6.0, "{axis:?} {level}: {share}");
        }
    }
}

/// dx / 2 a x = dy / 2 b y: along a gradient line y^(a/b) / x is constant, on the surface as in the plane below.
#[test]
fn gradient_lines_of_a_paraboloid() {
    let (a, b) = (0.01, 0.03);
    let s = Paraboloid::new([a, b], 50.0).unwrap();
    let c = chart(&s);
    let up = along(0.0, 0.0, 1.0);
    let extremes = critical_points(&c, &up);
    assert_eq!(extremes.confirmed, Some(true));
    let low: Vec<_> = extremes.inside(CriticalKind::Minimum).collect();
    assert_eq!(low.len(), 1);
    assert!(low[0].point.coords.norm() < 1e-10);
    let stops =
        TraceStops { places: vec![LinePoint { at: low[0].at, point: low[0].point }], longest_mm: None };
    for at in [uv(30.0, 20.0), uv(-10.0, 45.0), uv(3.0, -3.0)] {
        let line = trace(&c, Course::Gradient(up.axis), at, &stops);
        let ends = [LineEnd::Stop(0), LineEnd::Border];
        assert!(line.ends == ends || line.ends == [ends[1], ends[0]], "{:?}", line.ends);
        let constant = |p: &Point3| p.y.abs().powf(a / b) / p.x.abs();
        let want = constant(&s.point(at));
        // Near the minimum the powers lose their digits.
        for p in line.points.iter().filter(|p| p.point.y.abs() > 0.1) {
            assert!((constant(&p.point) / want - 1.0).abs() < 1e-7, "{p:?}");
        }
    }
}

#[test]
fn parabolic_lines_of_a_torus_are_top_and_bottom() {
    let t = Torus::new(5.0, 2.0).unwrap();
    let found = contours(&chart(&t), &Gauss, &[0.0], None);
    assert_eq!(found.lines.len(), 2);
    for l in &found.lines {
        assert!(l.line.is_closed());
        assert!(l.line.points.iter().all(|p| (p.point.z.abs() - 2.0).abs() < 1e-12));
        assert!((l.line.length_mm() / (10.0 * PI) - 1.0).abs() < 1e-3);
    }
    // Asymptotic lines live between them, on the inside of the ring, and end on them.
    let c = chart(&t);
    for left in [false, true] {
        let line = trace(&c, Course::Asymptotic { left }, uv(0.3, 3.0), &TraceStops::default());
        assert_eq!(line.ends, [LineEnd::Isotropic; 2]);
        for p in &line.points {
            assert!(p.point.x.hypot(p.point.y) < 5.0 + 1e-9);
        }
        let tips = [line.points[0], line.points[line.points.len() - 1]];
        assert!(tips.iter().all(|p| (p.point.z.abs() - 2.0).abs() < 1e-6), "{tips:?}");
    }
}

/// A hyperbolic paraboloid z = a (x2 - y2): asymptotic lines are its rulings, x +- y constant.
#[test]
fn asymptotic_lines_of_a_saddle_are_rulings() {
    let s = Paraboloid::new([0.02, -0.02], 20.0).unwrap();
    let c = chart(&s);
    let mut senses = [false; 2];
    for left in [false, true] {
        let line = trace(&c, Course::Asymptotic { left }, uv(3.0, 5.0), &TraceStops::default());
        assert_eq!(line.ends, [LineEnd::Border; 2]);
        let constant = |f: &dyn Fn(&Point3) -> f64, want: f64| {
            line.points.iter().all(|p| (f(&p.point) - want).abs() < 1e-8)
        };
        if constant(&|p| p.x + p.y, 8.0) {
            senses[0] = true;
        } else if constant(&|p| p.x - p.y, -2.0) {
            senses[1] = true;
        }
    }
    assert_eq!(senses, [true; 2]);
}

/// By symmetry every principal section of an ellipsoid is a ridge of the family across it. The sections z = 0 and
/// x = 0 each have one family across; on y = 0 the families change places at the four umbilics.
#[test]
fn ridges_of_an_ellipsoid_are_its_principal_sections() {
    let e = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let c = chart(&e);
    let found = ridges(&c, &umbilics(&c));
    assert_eq!(found.coarse_pieces, 0, "the sense turns over at umbilics, which is no noise");
    let found = found.lines;
    let mut lengths = [0.0; 3];
    for r in &found {
        let plane = (0..3)
            .find(|k| r.line.points.iter().all(|p| p.point[*k].abs() < 1e-6))
            .unwrap_or_else(|| panic!("{:?} {:?}", r.family, r.line.points[0]));
        lengths[plane] += r.line.length_mm();
        // Closed sections and arcs between umbilics, nothing else.
        assert!(
            r.line.is_closed() || r.line.ends.iter().all(|e| matches!(e, LineEnd::Stop(_))),
            "{:?}",
            r.line.ends
        );
        // Crests are on the rim z = 0, where the ellipsoid is sharpest across.
        if r.crest {
            assert!(plane == 2 || plane == 1);
        }
    }
    let round = |a: f64, b: f64| {
        osculate_geom::quadrature::gauss(0.0, 2.0 * PI, 64, |t| (a * t.sin()).hypot(b * t.cos()))
    };
    let want = [round(2.0, 1.0), round(3.0, 1.0), round(3.0, 2.0)];
    for k in 0..3 {
        // Within the chords' share and the ends at the umbilics.
        assert!((lengths[k] / want[k] - 1.0).abs() < 2e-3, "{k}: {lengths:?} {want:?}");
    }
}

/// Where a field is constant but for rounding it has no lines: a torus has no ridges, for its curvatures are constant
/// along their own lines, a cylinder no parabolic ones, for it is parabolic all over.
#[test]
fn constant_fields_have_no_lines() {
    let t = Torus::new(5.0, 2.0).unwrap();
    let c = chart(&t);
    assert!(ridges(&c, &umbilics(&c)).lines.is_empty());
    let s = osculate_geom::analytic::Cylinder::new(3.0, osculate_geom::Interval::new(0.0, 5.0)).unwrap();
    let c = chart(&s);
    assert!(contours(&c, &Gauss, &[0.0], None).lines.is_empty());
    assert!(contours(&c, &CurvatureDifference, &[1.0 / 9.0], None).lines.is_empty());
    // The circles on top and bottom of the torus are lines of critical points, not points.
    let c = chart(&t);
    let z = critical_points(&c, &along(0.0, 0.0, 1.0));
    assert!(z.points.is_empty() && !z.lines.is_empty() && z.confirmed.is_none());
}

/// The monkey saddle's own saddle is degenerate: the gradient turns twice, backwards.
#[test]
fn the_monkey_saddle_is_a_saddle_of_index_minus_two() {
    let s = gallery::monkey_saddle();
    let found = critical_points(&chart(&s), &along(0.0, 0.0, 1.0));
    let [p] = &found.points[..] else { panic!("{found:?}") };
    assert_eq!((p.kind, p.index, found.confirmed), (CriticalKind::Saddle, Some(-2), Some(true)));
}

/// Lines of constant difference of the curvatures carry that difference; around the umbilics of an ellipsoid they
/// close.
#[test]
fn constant_difference_lines() {
    let e = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
    let c = chart(&e);
    let extremes = critical_points(&c, &CurvatureDifference);
    // Minima at the four umbilics.
    let low: Vec<_> = extremes.inside(CriticalKind::Minimum).filter(|p| p.value < 1e-12).collect();
    assert_eq!(low.len(), 4, "{extremes:?}");
    // On the closed surface, minima and maxima less saddles are two.
    let sum: i32 = extremes.points.iter().map(|p| p.index.unwrap()).sum();
    assert_eq!(sum, 2, "{extremes:?}");
    let levels: [f64; 3] = [0.01, 0.1, 0.2];
    let found = contours(&c, &CurvatureDifference, &levels.map(|d| d * d), Some(&extremes));
    for l in &found.lines {
        assert!(l.line.is_closed());
        for p in &l.line.points {
            let k = e.jet2(p.at).forms().unwrap().principal();
            assert!((k.k_max - k.k_min - l.level.sqrt()).abs() < 1e-8);
        }
    }
    assert_eq!(found.lines.iter().filter(|l| l.level < 0.001).count(), 4);
}

/// Regions into which a level cuts the square, counted on a dense grid: its triangles connect equal signs, so that
/// both signs are treated alike.
fn regions(f: &dyn Fn(f64, f64) -> f64, half: f64, level: f64, n: usize) -> usize {
    let at = |k: usize| half * (2.0 * k as f64 / n as f64 - 1.0);
    let above: Vec<bool> =
        (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| f(at(i), at(j)) >= level).collect();
    let mut seen = vec![false; above.len()];
    let id = |i: usize, j: usize| i * (n + 1) + j;
    let mut count = 0;
    for start in 0..above.len() {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        count += 1;
        let mut queue = vec![start];
        while let Some(k) = queue.pop() {
            let (i, j) = (k / (n + 1), k % (n + 1));
            for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1)] {
                let (a, b) = (i as i64 + di, j as i64 + dj);
                if a < 0 || b < 0 || a > n as i64 || b > n as i64 {
                    continue;
                }
                let m = id(a as usize, b as usize);
                if !seen[m] && above[m] == above[k] {
                    seen[m] = true;
                    queue.push(m);
                }
            }
        }
    }
    count
}

/// The smallest distance of a level from where the picture changes: critical values inside, along the border and at
/// the corners.
fn margin(s: &NurbsSurface, critical: &[f64], level: f64) -> f64 {
    let d = s.domain();
    let z = |fu: f64, fv: f64| s.point(d.at(fu, fv)).z;
    let mut all: Vec<f64> = critical.to_vec();
    for side in 0..4 {
        let on = |k: i32| {
            let t = f64::from(k) / 400.0;
            match side {
                0 => z(t, 0.0),
                1 => z(t, 1.0),
                2 => z(0.0, t),
                _ => z(1.0, t),
            }
        };
        for k in 1..400 {
            if (on(k) - on(k - 1)) * (on(k + 1) - on(k)) <= 0.0 {
                all.push(on(k));
            }
        }
        all.extend([on(0), on(400)]);
    }
    all.iter().map(|v| (v - level).abs()).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Each component of a level cuts the square into one region more: the components are as many as a dense grid has
    /// regions, less one. Levels nearer to a critical value than the dense grid can tell are left out.
    #[test]
    fn no_component_is_missed(
        heights in proptest::collection::vec(-1.0f64..1.0, 64),
        fraction in 0.05f64..0.95,
    ) {
        // Degree 7: up to a dozen hills and hollows.
        let mut s = bezier_graph(10.0, 7, |_, _| 0.0);
        let mut net = s.net().clone();
        for (p, h) in net.points.iter_mut().zip(&heights) {
            p.z = 40.0 * h;
        }
        let knots = [Axis::U, Axis::V].map(|a| s.knots(a).as_slice().to_vec());
        s = NurbsSurface::new([7, 7], knots, net).unwrap();
        let c = chart(&s);
        let up = along(0.0, 0.0, 1.0);
        let extremes = critical_points(&c, &up);
        prop_assert_ne!(extremes.confirmed, Some(false));
        let values: Vec<f64> = extremes.points.iter().map(|p| p.value).collect();
        let (lo, hi) = values.iter().fold((-10.0_f64, 10.0_f64), |r, v| (r.0.min(*v), r.1.max(*v)));
        let level = lo + fraction * (hi - lo);
        prop_assume!(margin(&s, &values, level) > 0.02);
        let found = contours(&c, &up, &[level], Some(&extremes));
        let dense = regions(&|x, y| s.point(uv(x, y)).z, 10.0, level, 300);
        prop_assert_eq!(found.lines.len() + 1, dense);
        for l in &found.lines {
            let ends = l.line.ends;
            prop_assert!(l.line.is_closed() || ends == [LineEnd::Border; 2], "{:?}", ends);
            for p in &l.line.points {
                prop_assert!((p.point.z - level).abs() < 1e-7);
            }
        }
    }
}

/// A tiny hollow between the cells' corners is found by its critical point.
#[test]
fn a_small_closed_contour_is_not_missed() {
    let s = Paraboloid::new([0.01, 0.013], 50.0).unwrap();
    let c = chart(&s);
    let up = along(0.0, 0.0, 1.0);
    let extremes = critical_points(&c, &up);
    let level = 1e-6;
    let found = contours(&c, &up, &[level], Some(&extremes));
    assert_eq!(found.lines.len(), 1);
    assert!(found.lines[0].line.is_closed());
    let across = found.lines[0].line.points.iter().map(|p| p.point.x.abs()).fold(0.0, f64::max);
    assert!((across / (level / 0.01_f64).sqrt() - 1.0).abs() < 0.1, "{across}");
}

/// A contour is cut where it leaves the trims, and its ends lie on them.
#[test]
fn contours_are_cut_at_trims() {
    let s = Paraboloid::new([0.01, 0.01], 50.0).unwrap();
    let window = vec![uv(-20.0, -50.0), uv(20.0, -50.0), uv(20.0, 50.0), uv(-20.0, 50.0)];
    let face = TrimmedSurface::new(Arc::new(s), &[window], Side::Along).unwrap();
    let c = chart(&face);
    let up = along(0.0, 0.0, 1.0);
    let found = contours(&c, &up, &[9.0], Some(&critical_points(&c, &up)));
    assert_eq!(found.lines.len(), 2);
    for l in &found.lines {
        assert_eq!(l.line.ends, [LineEnd::Trim; 2]);
        for p in [l.line.points[0], l.line.points[l.line.points.len() - 1]] {
            assert!((p.at.u.abs() - 20.0).abs() < 1e-9 && (p.point.z - 9.0).abs() < 1e-9, "{p:?}");
        }
    }
}

/// M86's features: umbilics, contour minima along z, an extremum of the difference on the second surface.
#[test]
fn gallery_surfaces_have_their_features() {
    let up = along(0.0, 0.0, 1.0);
    for (number, want) in [(1, (0, 0)), (2, (0, 0)), (3, (1, 1)), (4, (2, 1))] {
        let s = gallery::m86(number);
        let c = chart(&s);
        let u = umbilics(&c);
        assert!(u.confirmed(), "{number}: {u:?}");
        let heights = critical_points(&c, &up);
        assert_eq!(heights.confirmed, Some(true), "{number}");
        let got = (u.inside().count(), heights.inside(CriticalKind::Minimum).count());
        let d = critical_points(&c, &CurvatureDifference);
        assert_eq!(got, want, "m86-{number}");
        match number {
            1 => assert!(d.points.is_empty()),
            2 => assert_eq!(d.points.iter().map(|p| p.kind).collect::<Vec<_>>(), [CriticalKind::Maximum]),
            // Minima where the difference vanishes.
            _ => assert_eq!(d.inside(CriticalKind::Minimum).count(), want.0),
        }
    }
}

/// Minima of the height over a grid's inner nodes: places lower than their eight neighbours.
fn minima_of_a_grid(s: &dyn Surface, axis: &Unit3, n: usize) -> usize {
    let d = s.domain();
    let at = |i: usize, j: usize| {
        s.point(d.at((i as f64 + 0.37) / n as f64, (j as f64 + 0.41) / n as f64)).coords.dot(axis)
    };
    let heights: Vec<f64> = (0..n * n).map(|k| at(k / n, k % n)).collect();
    (1..n - 1)
        .flat_map(|i| (1..n - 1).map(move |j| (i, j)))
        .filter(|(i, j)| {
            (i - 1..=i + 1)
                .flat_map(|a| (j - 1..=j + 1).map(move |b| a * n + b))
                .all(|k| k == i * n + j || heights[k] > heights[i * n + j])
        })
        .count()
}

/// M86, 5.2: turned far enough, the paper's third and fourth surfaces have no minimum left, as a dense grid says too; turned less they
/// have one wherever they are turned to.
#[test]
fn a_turned_face_has_no_minima() {
    for number in [3, 4] {
        let s = gallery::m86(number);
        let c = chart(&s);
        let turn = turned(&c, Vec3::z_axis());
        assert_eq!((turn.asked.minima, turn.fewest.minima), (1, 0), "m86-{number}");
        assert_eq!((turn.asked.away, turn.fewest.away), (0.0, 0.0));
        assert_eq!(minima_of_a_grid(&s, &Vec3::z_axis(), 120), 1);
        assert_eq!(minima_of_a_grid(&s, &turn.fewest.axis, 120), 0);
        let angle = turn.fewest.axis.angle(&Vec3::z_axis());
        assert!((angle - turn.fewest.turn_rad).abs() < 1e-12);
        for k in 0..36 {
            let (sin, cos) = (angle - 1.1 * Turn::STEP_RAD).sin_cos();
            let (s0, c0) = f64::from(10 * k).to_radians().sin_cos();
            let less = Unit3::new_normalize(Vec3::new(sin * c0, sin * s0, cos));
            assert_eq!(minima_of_a_grid(&s, &less, 240), 1, "m86-{number}, {k}");
        }
    }
    // Two bowls beside each other, z = (x^2 - 1)^2 / 20 + y^2 / 10 over |x|, |y| < 1.3: whichever way it is turned up to the slope of its
    // border, one is left.
    let two = bezier_graph(1.3, 4, |x, y| (x * x - 1.0).powi(2) / 20.0 + y * y / 10.0);
    let turn = turned(&chart(&two), Vec3::z_axis());
    assert_eq!((turn.asked.minima, minima_of_a_grid(&two, &Vec3::z_axis(), 201)), (2, 2));
    assert_eq!(minima_of_a_grid(&two, &turn.fewest.axis, 201), turn.fewest.minima);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A bowl z = a x^2 + b y^2 over |x|, |y| < 20 has a bottom until it leans by the lesser slope of its borders' middles.
    #[test]
    fn a_bowl_is_turned_by_its_lesser_slope(a in 0.002f64..0.014, b in 0.002f64..0.014) {
        let bowl = Paraboloid::new([a, b], 20.0).unwrap();
        let turn = turned(&chart(&bowl), Vec3::z_axis());
        prop_assert_eq!((turn.asked.minima, turn.fewest.minima), (1, 0));
        let least = (2.0 * a.min(b) * 20.0).atan();
        let (found, step) = (turn.fewest.turn_rad, Turn::STEP_RAD);
        // Rings are a step apart; of a ring an axis may stand half a step beside the direction that needs least.
        prop_assert!(found > least && found < least + 2.0 * step, "{} {}", found.to_degrees(), least.to_degrees());
    }
}

/// Lines spread over a face leave no place further than the spacing from all of them, and keep apart.
#[test]
fn lines_are_spread_evenly() {
    let s = gallery::m86(1);
    let c = chart(&s);
    let spacing_mm = 8.0;
    let how = Cover {
        spacing_mm,
        ends_early: true,
        stops: TraceStops::default(),
        seeds: Vec::new(),
        most_lines: 500,
    };
    let lines = cover(&c, Course::Curvature(Family::Most), &how).lines;
    let far = |p: &Point3| {
        let nearest = |l: &osculate_surfaces::lines::SurfacePolyline| {
            l.points
                .windows(2)
                .map(|w| {
                    let way = w[1].point - w[0].point;
                    let t = ((p - w[0].point).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
                    (p - (w[0].point + way * t)).norm()
                })
                .fold(f64::INFINITY, f64::min)
        };
        lines.iter().map(nearest).fold(f64::INFINITY, f64::min)
    };
    for i in 0..20 {
        for j in 0..20 {
            let p = s.point(s.domain().at(f64::from(i) / 19.0, f64::from(j) / 19.0));
            assert!(far(&p) < 1.3 * spacing_mm, "{p:?} {}", far(&p));
        }
    }
    assert!((8..30).contains(&lines.len()), "{}", lines.len());
}
