//! Dropped cutters in parallel planes: what is left is measured with the swept cutter, spacing against closed forms.

use crate::dropped;

use dropped::{TOLERANCE, dropped, holds, left};
use osculate_geom::analytic::{Cylinder, Paraboloid, Placed, Placement, Plane, Sphere};
use osculate_geom::{Domain, Interval, Patch, Point3, Side, Surface, Unit3, Vec3};
use osculate_productivity::plan::{Passes, PlanError, drop_cutter};
use osculate_tools::{Cutter, CutterSpec};

fn ball() -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 40.0 }).unwrap()
}

fn toroid() -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 2.0, length_mm: 40.0 })
        .unwrap()
}

fn square(side: f64) -> Domain {
    Domain { u: Interval::new(0.0, side), v: Interval::new(0.0, side) }
}

fn plan(faces: &[&dyn Surface], check: &[&dyn Surface], cutter: &Cutter) -> Result<Passes, PlanError> {
    dropped(drop_cutter, faces, check, cutter)
}

#[test]
fn a_ball_on_a_plane_steps_by_the_closed_form() {
    let plane = Plane::new(square(30.0));
    let passes = plan(&[&plane], &[], &ball()).unwrap();
    holds(&[&plane], &ball(), &passes);
    // Cusp h between passes d apart: h = R - sqrt(R^2 - d^2/4).
    let d = 2.0 * (2.0 * 4.0 * 0.01 - 0.01_f64.powi(2)).sqrt();
    let count = passes.passes.len() as f64;
    assert!(count >= 30.0 / d && count <= 30.0 / d * 1.15 + 1.0, "{count} passes, {}", 30.0 / d);
}

#[test]
fn domes_are_cut_by_both_and_a_dish_by_the_ball() {
    let dome = Patch {
        surface: Sphere::new(40.0).unwrap(),
        domain: Domain { u: Interval::new(0.2, 1.2), v: Interval::new(0.6, 1.3) },
        side: Side::Along,
    };
    let dish = Paraboloid::new([0.01, 0.02], 12.0).unwrap();
    for (face, cutter) in [(&dome as &dyn Surface, ball()), (&dome, toroid()), (&dish, ball())] {
        let passes = plan(&[face], &[], &cutter).unwrap();
        holds(&[face], &cutter, &passes);
    }
    // A flat bottom bridges the hollow.
    let passes = plan(&[&dish], &[], &toroid()).unwrap();
    assert!(
        passes.diagnostics.iter().any(|d| d.to_string().contains("too hollow")),
        "{:?}",
        passes.diagnostics
    );
    assert!(left(&[&dish], &toroid(), &passes)[0] >= -TOLERANCE.gouge_mm);
}

/// Along a thin edge places for which a pass stands lie far apart across it, but not along it.
#[test]
fn passes_along_a_thin_edge_end_with_it() {
    let surface = Cylinder::new(0.3, Interval::new(0.0, 20.0)).unwrap();
    let rod =
        Placed { surface, placement: Placement::new(Point3::origin(), Vec3::x_axis(), Some(Vec3::y())) };
    let passes = plan(&[&rod], &[], &ball()).unwrap();
    // A strip on a plane is as wide as this.
    let strip = 2.0 * (2.0 * 4.0 * TOLERANCE.scallop_mm).sqrt();
    for p in passes.passes.iter().flat_map(|p| &p.points) {
        let x = p.pose.tip.x;
        assert!(x >= -strip && x <= 20.0 + strip, "{x}");
    }
    assert!(passes.passes.len() > 4);
}

/// Two planes that rise to both sides of a valley that the feed crosses.
fn valley() -> [Placed<Plane>; 2] {
    // Each rises from x = 0 to its side.
    let domain = Domain { u: Interval::new(-7.0, 7.0), v: Interval::new(0.0, 15.0) };
    let tilted = |side: f64| {
        let normal = Unit3::new_normalize(Vec3::new(-0.5 * side, 0.0, 1.0));
        let placement = Placement::new(Point3::origin(), normal, Some(Vec3::y() * -side));
        Placed { surface: Plane::new(domain), placement }
    };
    [tilted(1.0), tilted(-1.0)]
}

#[test]
fn a_valley_of_two_faces_keeps_only_its_fillet() {
    let [a, b] = valley();
    let passes = plan(&[&a, &b], &[], &ball()).unwrap();
    let [cut, _] = left(&[&a, &b], &ball(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
    // The fillet of a ball between the faces is left, and said.
    assert!(
        passes.diagnostics.iter().any(|d| d.to_string().contains("touches first")),
        "{:?}",
        passes.diagnostics
    );
}

#[test]
fn a_check_face_is_not_cut() {
    let [a, b] = valley();
    let passes = plan(&[&a], &[&b], &ball()).unwrap();
    let [cut, _] = left(&[&b], &ball(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
}

/// Between the levels of a step the tool goes down beside the upper edge, not through it.
#[test]
fn a_step_keeps_its_edge() {
    let at = |x: f64, z: f64| Placed {
        surface: Plane::new(square(12.0)),
        placement: Placement::new(Point3::new(x, 0.0, z), Vec3::z_axis(), Some(Vec3::x())),
    };
    let (low, high) = (at(0.0, 0.0), at(12.0, 9.0));
    let passes = plan(&[&low, &high], &[], &ball()).unwrap();
    let [cut, _] = left(&[&low, &high], &ball(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
}

#[test]
fn a_face_that_looks_away_is_refused() {
    let plane = osculate_geom::Flipped(Plane::new(square(10.0)));
    assert!(matches!(plan(&[&plane], &[], &ball()), Err(PlanError::Nothing { .. })));
}
