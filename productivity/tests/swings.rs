//! What a tool does between the points of a pass where its contact swings round its end, and where the face has a crease.

use osculate_geom::analytic::Cylinder;
use osculate_geom::{Axis, Domain, Interval, Patch, Point3, Side, Surface, Unit3, Vec3, uv};
use osculate_productivity::axis::AxisField;
use osculate_productivity::plan::{Along, Leaning, Pass, Task, Tolerance, isoparametric};
use osculate_surfaces::{Net, NurbsSurface};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Cutter, CutterSpec};
use std::f64::consts::{FRAC_PI_3, PI};

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.05, gouge_mm: 0.02, chord_mm: 0.002 };

fn planned(surface: &dyn Surface, cutter: &Cutter, field: &AxisField, tolerance: Tolerance) -> Vec<Pass> {
    let lean = Leaning::Axes(field);
    let task = Task::new("F1", surface, cutter, lean, tolerance);
    isoparametric(&task, Along::Fixed(Axis::U)).unwrap().passes
}

/// How deep the straight motions between the points of passes go in at places of a part, mm.
fn deepest(passes: &[Pass], cutter: &Cutter, places: &[Point3]) -> f64 {
    let mut deepest = 0.0f64;
    for w in passes.iter().flat_map(|p| p.points.windows(2)) {
        let motion = LinearMotion { from: w[0].pose, to: w[1].pose };
        for k in 0..=16 {
            let pose = motion.at(f64::from(k) / 16.0).unwrap().pose;
            let near = places.iter().filter(|p| (**p - pose.tip).norm() < 3.0 * cutter.radius_mm());
            deepest = near.map(|p| -cutter.distance(&pose, p)).fold(deepest, f64::max);
        }
    }
    deepest
}

/// Across the top of a thin cylinder with an axis that leans along it by a few degrees the contact swings from the one side of a
/// toroidal end round its flank to the other. Where the contact itself is right all the way, the end is not: moved straight it goes in
/// next to the contact, by up to `(R - r) sin lean`.
#[test]
fn a_contact_that_swings_round_the_end_does_not_take_it_into_the_part() {
    let spec = CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 30.0 };
    let cutter = Cutter::try_from(spec).unwrap();
    let tolerance = Tolerance { chord_mm: 0.005, ..TOLERANCE };
    let whole = Cylinder::new(0.3, Interval::new(-4.0, 4.0)).unwrap();
    for (lean_deg, off) in
        [2.0, 2.5, 3.0, 4.0].into_iter().flat_map(|l| (0..5).map(move |k| (l, 0.037 * f64::from(k))))
    {
        let domain = Domain { u: Interval::new(off - 0.7, off + 0.6), v: Interval::new(-4.0, 4.0) };
        let surface = Patch { surface: whole, domain, side: Side::Along };
        let lean = f64::to_radians(lean_deg);
        let field = AxisField::held(&surface, Unit3::new_normalize(Vec3::new(lean.cos(), 0.0, lean.sin())));
        let passes = planned(&surface, &cutter, &field, tolerance);
        let places: Vec<Point3> = (-10..=10)
            .flat_map(|i| (-40..=40).map(move |j| uv(0.03 * f64::from(i), 0.1 * f64::from(j))))
            .map(|at| whole.point(at))
            .collect();
        let deep = deepest(&passes, &cutter, &places);
        assert!(deep < tolerance.chord_mm, "{lean_deg} deg, {off}: {deep}");
    }
}

/// A prism over a hexagon, its seam in an edge: over each edge the ball rolls, the seam's too.
#[test]
fn a_tool_rolls_over_creases_and_over_the_seam() {
    let corner = |k: usize, y: f64| {
        let (s, c) = (FRAC_PI_3 * k as f64).sin_cos();
        Point3::new(20.0 * c, y, -20.0 * s)
    };
    let points: Vec<Point3> = (0..=6).flat_map(|k| [0.0, 2.0].map(|y| corner(k % 6, y))).collect();
    let knots = [vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0], vec![0.0, 0.0, 1.0, 1.0]];
    let net = Net { count: [7, 2], points, weights: None };
    let surface = NurbsSurface::new([1, 1], knots, net).unwrap();
    let out = surface.jet2(uv(0.5, 0.5)).normal().unwrap();
    assert!(out.dot(&corner(0, 0.0).coords) > 0.0, "the material is inside");
    let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 30.0 }).unwrap();
    // It stands along the prism: what turns is its contact alone.
    let field = AxisField::held(&surface, Vec3::y_axis());
    let passes = planned(&surface, &cutter, &field, TOLERANCE);
    let edges: Vec<Point3> = (0..6)
        .flat_map(|k| (0..=40).map(move |j| (k, 0.05 * f64::from(j))))
        .map(|(k, y)| corner(k, y))
        .collect();
    let deep = deepest(&passes, &cutter, &edges);
    assert!(deep < 2.0 * TOLERANCE.chord_mm, "{deep}");
    for pass in &passes {
        assert!(pass.closed);
        let [first, last] = [pass.points[0], pass.points[pass.points.len() - 1]];
        assert!(
            (first.pose.tip - last.pose.tip).norm() < 1e-9 && first.pose.axis.angle(&last.pose.axis) < 1e-9
        );
        let turned: f64 = pass.points.windows(2).map(|w| w[0].normal.angle(&w[1].normal)).sum();
        assert!((turned - 2.0 * PI).abs() < 1e-6, "{turned}");
    }
}
