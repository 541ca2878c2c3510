//! Umbilics and lines of curvature against closed forms: ellipsoid, monkey saddle, Enneper, surfaces of revolution.

#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use crate::common;

use common::graph;
use osculate_geom::analytic::{Ellipsoid, Paraboloid, Sphere, Torus};
use osculate_geom::{Axis, Domain, Flipped, Interval, Patch, Point3, Side, Surface, uv};
use osculate_surfaces::gallery;
use osculate_surfaces::lines::{
    Chart, Course, Family, LineEnd, LineTolerance, SurfacePolyline, TraceStops, UmbilicKind, curvature_line,
    trace, umbilics,
};

fn chart(surface: &dyn Surface) -> Chart<'_> {
    let size = Chart::new(surface, LineTolerance::for_size(1.0)).unwrap().size_mm();
    Chart::new(surface, LineTolerance::for_size(size)).unwrap()
}

fn ellipsoid() -> Ellipsoid {
    Ellipsoid::new([3.0, 2.0, 1.0]).unwrap()
}

/// The umbilics of an ellipsoid a > b > c: x = +-a sqrt((a2 - b2) / (a2 - c2)), z likewise, k = ac / b3.
#[test]
fn ellipsoid_has_four_lemons() {
    let e = ellipsoid();
    for surface in [&e as &dyn Surface, &Flipped(e)] {
        let found = umbilics(&chart(surface));
        assert_eq!(found.points.len(), 4, "{found:?}");
        assert!(found.confirmed());
        assert_eq!(found.index_sum_twice, Some(4));
        let sign = surface.jet2(uv(0.3, 0.3)).side.sign();
        let mut corners = [[false; 2]; 2];
        for u in &found.points {
            assert_eq!((u.kind, u.index_twice), (UmbilicKind::Lemon, Some(1)));
            let p = u.point;
            // The field has sixteen digits, its slope is about 1: the place has as many.
            let want =
                Point3::new(2.3717082451262845_f64.copysign(p.x), 0.0, 0.6123724356957945_f64.copysign(p.z));
            assert!((p - want).norm() < 1e-13, "{p:?}");
            assert!((u.curvature_per_mm - sign * 0.375).abs() < 1e-13);
            corners[usize::from(p.x > 0.0)][usize::from(p.z > 0.0)] = true;
        }
        assert_eq!(corners, [[true; 2]; 2]);
    }
}

/// The confocal parameters of a point of the ellipsoid: the roots other than zero of
/// x2 / (a2 - t) + y2 / (b2 - t) + z2 / (c2 - t) = 1.
fn confocal(p: &Point3) -> [f64; 2] {
    let [a, b, c] = [9.0, 4.0, 1.0];
    let [x, y, z] = [p.x * p.x, p.y * p.y, p.z * p.z];
    // t2 - s t + q = 0 after division by t.
    let s = a + b + c - x - y - z;
    let q = a * b + b * c + c * a - x * (b + c) - y * (a + c) - z * (a + b);
    let r = (0.25 * s * s - q).max(0.0).sqrt();
    [0.5 * s - r, 0.5 * s + r]
}

/// Along a line of curvature one confocal parameter is constant. As a distance: the difference over its gradient.
#[test]
fn lines_of_curvature_of_the_ellipsoid_are_confocal() {
    let e = ellipsoid();
    let tolerance = LineTolerance { position_mm: 1e-10, chord_mm: 1e-3, cell_mm: 0.15 };
    let mut worst = 0.0_f64;
    for at in [uv(0.7, 0.3), uv(1.4, -0.6), uv(2.9, 1.2), uv(4.4, 0.1)] {
        for family in Family::ALL {
            let line = curvature_line(&e, at, family, &tolerance).unwrap();
            assert_eq!(line.ends, [LineEnd::Closed; 2], "{at:?} {family:?}");
            let start = confocal(&line.points[0].point);
            let off: Vec<f64> = [0, 1]
                .map(|k| {
                    let far = |p: &Point3| (confocal(p)[k] - start[k]).abs();
                    line.points.iter().map(|p| far(&p.point)).fold(0.0, f64::max)
                })
                .to_vec();
            let k = if off[0] < off[1] { 0 } else { 1 };
            // The gradient of the confocal parameter t of a quadric is 2 / |grad|, at least of order 1 here.
            worst = worst.max(off[k]);
            assert!(off[1 - k] > 0.1, "the other parameter changes along the line");
        }
    }
    assert!(worst < 1e-8, "{worst:e}");
}

/// Lines that meet an umbilic end in it: the ellipse y = 0 is cut by its four umbilics.
#[test]
fn lines_stop_at_umbilics() {
    let e = ellipsoid();
    let c = chart(&e);
    let stops = TraceStops {
        places: umbilics(&c)
            .points
            .iter()
            .map(|u| osculate_surfaces::lines::LinePoint { at: u.at, point: u.point })
            .collect(),
        longest_mm: None,
    };
    // (3, 0, 0) lies between two umbilics; the ellipse's direction there is z.
    let [a, b] = Family::ALL.map(|f| trace(&c, Course::Curvature(f), uv(0.0, 0.0), &stops));
    let ended = |l: &SurfacePolyline| l.ends.iter().all(|e| matches!(e, LineEnd::Stop(_)));
    let (arc, other) = if ended(&a) { (a, b) } else { (b, a) };
    assert!(ended(&arc) && other.is_closed());
    assert!(arc.points.iter().all(|p| p.point.y.abs() < 1e-9 && p.point.x > 2.3));
}

#[test]
fn monkey_saddle_has_one_star() {
    let s = gallery::monkey_saddle();
    let found = umbilics(&chart(&s));
    assert!(found.confirmed());
    let [u] = &found.points[..] else { panic!("{found:?}") };
    assert_eq!((u.kind, u.index_twice), (UmbilicKind::Star, Some(-1)));
    assert!(u.point.coords.norm() < 1e-12 * s.control_box().diagonal_mm());
}

/// Enneper's surface in its own parameters: E = G, F = 0, M = 0.
#[test]
fn enneper_lines_of_curvature_are_parameter_lines() {
    let s = gallery::enneper();
    let size = s.control_box().diagonal_mm();
    let tolerance = LineTolerance { position_mm: 1e-11 * size, ..LineTolerance::for_size(size) };
    for at in [uv(0.3, 0.2), uv(-0.7, 0.5), uv(0.1, -0.9)] {
        let lines = Family::ALL.map(|f| curvature_line(&s, at, f, &tolerance).unwrap());
        let constant = |l: &SurfacePolyline, axis: Axis| {
            l.points.iter().all(|p| (p.at.get(axis) - at.get(axis)).abs() < 1e-9)
        };
        for axis in [Axis::U, Axis::V] {
            assert_eq!(lines.iter().filter(|l| constant(l, axis)).count(), 1, "{at:?} {axis:?}");
        }
        for l in &lines {
            assert_eq!(l.ends, [LineEnd::Border; 2]);
            // From border to border.
            let d = s.domain();
            let reach = l.points.last().unwrap().at.u - l.points[0].at.u + l.points.last().unwrap().at.v
                - l.points[0].at.v;
            assert!((reach.abs() - d.u.length()).abs() < 1e-9, "{reach}");
        }
    }
    let found = umbilics(&chart(&s));
    assert!(found.confirmed() && found.points.is_empty());
}

/// z = (x2 / p + y2 / q) / 2 with p > q has its umbilics at x = 0, y = +-sqrt(q (p - q)).
#[test]
fn paraboloid_umbilics() {
    let (p, q) = (50.0, 30.0);
    let s = Paraboloid::new([0.5 / p, 0.5 / q], 40.0).unwrap();
    let found = umbilics(&chart(&s));
    assert!(found.confirmed());
    assert_eq!(found.points.len(), 2);
    for u in &found.points {
        let want = (q * (p - q)).sqrt();
        assert!(u.point.x.abs() < 1e-11 && (u.point.y.abs() - want).abs() < 1e-11, "{:?}", u.point);
        assert_eq!(u.kind, UmbilicKind::Lemon);
    }
}

/// The surface z = (x2 + y2) / 2 R + cubic has an umbilic of the cubic's type at the origin. Lemon for a > 2 c > 0,
/// monstar for c < a < 2 c (b = d = 0), star for c < 0.
#[test]
fn cubic_graphs_have_their_type() {
    for (a, c, kind) in
        [(3.0, 1.0, UmbilicKind::Lemon), (1.5, 1.0, UmbilicKind::Monstar), (1.0, -1.0, UmbilicKind::Star)]
    {
        let s =
            graph(1.0, |x, y| 0.05 * (x * x + y * y) + 0.01 * (a * x * x * x + 3.0 * c * x * y * y) / 6.0);
        let found = umbilics(&chart(&s));
        assert!(found.confirmed(), "{found:?}");
        let u = found.points.iter().find(|u| u.point.coords.norm() < 1e-9).unwrap();
        assert_eq!(u.kind, kind);
        assert_eq!(u.index_twice, Some(if kind == UmbilicKind::Star { -1 } else { 1 }));
        // The form in the tangent frame is the graph's own, for the normal is +z and x runs along u; into the
        // material is downwards.
        let want = [a, 0.0, c, 0.0].map(|x| -0.01 * x);
        assert!(
            u.cubic_per_mm2.iter().zip(want).all(|(g, w)| (g - w).abs() < 1e-12),
            "{:?}",
            u.cubic_per_mm2
        );
    }
}

/// Re (x + i y)^4 has second derivatives that turn twice around the origin: index -1.
#[test]
fn a_degenerate_umbilic_has_its_index() {
    let s = gallery_quartic();
    let found = umbilics(&chart(&s));
    let [u] = &found.points[..] else { panic!("{found:?}") };
    assert_eq!((u.kind, u.index_twice), (UmbilicKind::Degenerate, Some(-2)));
    assert!(found.confirmed());
}

fn gallery_quartic() -> impl Surface {
    common::bezier_graph(1.0, 4, |x, y| 0.1 * (x.powi(4) - 6.0 * x * x * y * y + y.powi(4)))
}

/// A spheroid's poles have index 1 each, and nothing else is umbilic.
#[test]
fn spheroid_poles() {
    let s = Ellipsoid::new([2.0, 2.0, 1.0]).unwrap();
    let found = umbilics(&chart(&s));
    assert_eq!(found.points.len(), 2, "{found:?}");
    for u in &found.points {
        assert_eq!(u.index_twice, Some(2));
        assert!((u.point.z.abs() - 1.0).abs() < 1e-12);
        assert!((u.curvature_per_mm - 0.25).abs() < 1e-5);
    }
    assert_eq!(found.index_sum_twice, found.border_sum_twice);
}

/// A sphere and a plane consist of umbilics; a torus has none.
#[test]
fn regions_are_reported_as_regions() {
    let sphere = Sphere::new(7.0).unwrap();
    let found = umbilics(&chart(&sphere));
    assert!(found.points.iter().all(|u| u.point.z.abs() > 6.9) && !found.regions.is_empty());
    let d = Domain { u: Interval::new(0.0, 2.0), v: Interval::new(0.0, 1.0) };
    let plane = osculate_geom::analytic::Plane::new(d);
    let found = umbilics(&chart(&plane));
    assert!(found.points.is_empty() && !found.regions.is_empty());
    let torus = Torus::new(5.0, 2.0).unwrap();
    let found = umbilics(&chart(&torus));
    assert!(found.confirmed() && found.points.is_empty());
    assert_eq!(found.border_sum_twice, Some(0));
}

/// The lines of curvature of a torus are its circles, across both seams.
#[test]
fn torus_circles_close_across_seams() {
    let torus = Torus::new(5.0, 2.0).unwrap();
    let c = chart(&torus);
    for family in Family::ALL {
        let line = trace(&c, Course::Curvature(family), uv(0.05, 6.2), &TraceStops::default());
        assert!(line.is_closed());
        let round = std::f64::consts::TAU
            * if line.points.iter().all(|p| (p.at.u - 0.05).abs() < 1e-9) {
                2.0
            } else {
                5.0 + 2.0 * 6.2_f64.cos()
            };
        // Chords are shorter than the arc by less than 8/3 of the sagitta over the chord each.
        assert!(
            line.length_mm() < round && line.length_mm() > round * (1.0 - 1e-3),
            "{} {round}",
            line.length_mm()
        );
    }
}

/// Lines end on trims, exactly there.
#[test]
fn lines_end_on_trims() {
    let torus = Torus::new(5.0, 2.0).unwrap();
    let d = Domain { u: Interval::new(0.0, 1.0), v: Interval::new(-1.0, 1.0) };
    let patch = Patch { surface: torus, domain: d, side: Side::Along };
    let hole = vec![uv(0.4, -0.2), uv(0.6, -0.2), uv(0.6, 0.2), uv(0.4, 0.2)];
    let rim = vec![uv(0.0, -1.0), uv(1.0, -1.0), uv(1.0, 1.0), uv(0.0, 1.0)];
    let face = osculate_surfaces::TrimmedSurface::new(std::sync::Arc::new(patch), &[rim, hole], Side::Along)
        .unwrap();
    let c = chart(&face);
    for family in Family::ALL {
        let line = trace(&c, Course::Curvature(family), uv(0.5, 0.7), &TraceStops::default());
        if line.points.iter().all(|p| (p.at.u - 0.5).abs() < 1e-9) {
            assert_eq!(line.ends.iter().filter(|e| **e == LineEnd::Trim).count(), 1);
            let low = line.points.iter().map(|p| p.at.v).fold(f64::INFINITY, f64::min);
            assert!((low - 0.2).abs() < 1e-12, "{low}");
        } else {
            assert_eq!(line.ends, [LineEnd::Border; 2]);
        }
    }
}
