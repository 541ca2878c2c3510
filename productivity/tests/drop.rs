//! Dropped cutters in parallel planes: what is left is measured with the swept cutter, spacing against closed forms.
#![allow(clippy::unwrap_used)]

use osculate_geom::analytic::{Paraboloid, Placed, Placement, Plane, Sphere};
use osculate_geom::{Domain, Interval, Patch, Point3, Side, Surface, Unit3, Vec3};
use osculate_productivity::plan::{DropTask, Named, Passes, PlanError, Tolerance, drop_cutter};
use osculate_tools::removal::{Job, Sample, Swept, cut, sample_surface};
use osculate_tools::{Cutter, CutterSpec};

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };

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

/// Least and greatest height left on the faces by the passes alone.
fn left(faces: &[&dyn Surface], cutter: &Cutter, passes: &Passes) -> [f64; 2] {
    // Twice as dense as what the planner measures at.
    let samples: Vec<Sample> =
        faces.iter().flat_map(|f| sample_surface(*f, 0, 0.1, 100_000).unwrap().samples).collect();
    let motions: Vec<Swept> = passes
        .passes
        .iter()
        .flat_map(|p| p.points.windows(2))
        .map(|w| Swept { from: w[0].pose, to: w[1].pose, rapid: false, block: 0 })
        .collect();
    let job =
        Job { cutter, holder: None, motions: &motions, samples: &samples, stock_mm: 0.1, depth_mm: 0.1 };
    let cuts = cut(&job, &|_| ()).unwrap();
    cuts.iter().fold([0.0, 0.0], |[lo, hi]: [f64; 2], c| [lo.min(c.standoff_mm), hi.max(c.standoff_mm)])
}

fn plan(faces: &[&dyn Surface], check: &[&dyn Surface], cutter: &Cutter) -> Result<Passes, PlanError> {
    let named = |all: &[&'static str], s: &[&dyn Surface]| -> Vec<(usize, &'static str)> {
        (0..s.len()).map(|k| (k, all[k])).collect()
    };
    let faces: Vec<Named<'_>> =
        named(&["F1", "F2"], faces).into_iter().map(|(k, face)| Named { face, surface: faces[k] }).collect();
    let check: Vec<Named<'_>> =
        named(&["C1", "C2"], check).into_iter().map(|(k, face)| Named { face, surface: check[k] }).collect();
    drop_cutter(&DropTask {
        faces: &faces,
        check: &check,
        cutter,
        axis: Vec3::z_axis(),
        feed: Vec3::x(),
        tolerance: TOLERANCE,
        progress: &|_| {},
    })
}

fn holds(faces: &[&dyn Surface], cutter: &Cutter, passes: &Passes) {
    let [cut, rest] = left(faces, cutter, passes);
    assert!(rest <= TOLERANCE.scallop_mm, "left {rest}");
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
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
