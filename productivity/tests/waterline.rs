//! Waterlines around steep faces: what is left is measured with the swept cutter, heights and lengths against closed forms.

use crate::dropped;

use dropped::{TOLERANCE, dropped, holds, left};
use osculate_geom::analytic::{Cone, Cylinder, Placed, Placement, Plane, Sphere};
use osculate_geom::{Domain, Interval, Patch, Point3, Side, Surface, Vec3};
use osculate_productivity::plan::{Passes, PlanError, waterline_3c};
use osculate_tools::{Cutter, CutterSpec};
use std::f64::consts::TAU;

const RADIUS: f64 = 3.0;

fn ball() -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * RADIUS, length_mm: 40.0 }).unwrap()
}

fn toroid() -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 1.5, length_mm: 40.0 })
        .unwrap()
}

fn plan(faces: &[&dyn Surface], check: &[&dyn Surface], cutter: &Cutter) -> Result<Passes, PlanError> {
    dropped(waterline_3c, faces, check, cutter)
}

/// Heights of the passes, which are all level.
fn heights(passes: &Passes) -> Vec<f64> {
    let mut out: Vec<f64> = passes
        .passes
        .iter()
        .map(|p| {
            let z = p.points[0].pose.tip.z;
            assert!(p.points.iter().all(|c| (c.pose.tip.z - z).abs() < 1e-9));
            z
        })
        .collect();
    out.dedup();
    out
}

/// The distance of straight passes beside each other that leave the scallop.
fn step(corner: f64) -> f64 {
    2.0 * (2.0 * corner * TOLERANCE.scallop_mm - TOLERANCE.scallop_mm.powi(2)).sqrt()
}

#[test]
fn a_boss_is_gone_around_in_circles_from_the_top_down() {
    let boss = Cylinder::new(10.0, Interval::new(0.0, 12.0)).unwrap();
    for (cutter, corner, core) in [(ball(), RADIUS, 0.0), (toroid(), 1.5, 2.5)] {
        let passes = plan(&[&boss], &[], &cutter).unwrap();
        holds(&[&boss], &cutter, &passes);
        let levels = heights(&passes);
        assert!(levels.windows(2).all(|w| w[1] < w[0]), "{levels:?}");
        // As many as fill the height; below the lowest there is no place to stand beside.
        let fewest = 12.0 / step(corner);
        assert!(levels.len() as f64 >= fewest && (levels.len() as f64) < 1.15 * fewest + 2.0, "{levels:?}");
        for pass in &passes.passes {
            assert!(pass.closed);
            let around = TAU * (10.0 + corner + core);
            let long: f64 = pass.points.windows(2).map(|w| (w[1].pose.tip - w[0].pose.tip).norm()).sum();
            assert!((long / around - 1.0).abs() < 2e-3, "{long} {around}");
            for p in &pass.points {
                // Where the middle of the corner is above the rim the tool comes so much nearer.
                let above = (p.pose.tip.z + corner - 12.0).max(0.0);
                let reach = core + (corner * corner - above * above).sqrt();
                let off = p.pose.tip.x.hypot(p.pose.tip.y) - 10.0 - reach;
                let chord = TOLERANCE.chord_mm;
                assert!((-0.5 * chord..2.0 * chord).contains(&off), "{off}");
                assert!((p.point.x.hypot(p.point.y) - 10.0).abs() < 0.05, "{}", p.point);
            }
            // Material on the right: around a boss clockwise.
            let (a, b) = (pass.points[0].pose.tip, pass.points[1].pose.tip);
            assert!(a.x * b.y - a.y * b.x < 0.0);
        }
    }
}

#[test]
fn a_cone_and_a_steep_dome_hold_their_scallop() {
    let cone = Cone::new(14.0, -30_f64.to_radians(), Interval::new(0.0, 10.0)).unwrap();
    let dome = Patch {
        surface: Sphere::new(20.0).unwrap(),
        domain: Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(0.1, 0.7) },
        side: Side::Along,
    };
    for face in [&cone as &dyn Surface, &dome] {
        for cutter in [ball(), toroid()] {
            let passes = plan(&[face], &[], &cutter).unwrap();
            holds(&[face], &cutter, &passes);
        }
    }
}

/// A wall between a floor and nothing: the lowest waterline stands on the floor, what is flat is left with a word.
#[test]
fn what_is_flat_or_under_the_tool_is_left_and_told() {
    let boss = Cylinder::new(10.0, Interval::new(0.0, 12.0)).unwrap();
    let floor = Placed {
        surface: Plane::new(Domain { u: Interval::new(-20.0, 20.0), v: Interval::new(-20.0, 20.0) }),
        placement: Placement::new(Point3::origin(), Vec3::z_axis(), Some(Vec3::x())),
    };
    let passes = plan(&[&boss, &floor], &[], &ball()).unwrap();
    let [cut, _] = left(&[&boss, &floor], &ball(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
    let lowest = heights(&passes).last().copied().unwrap();
    assert!((-1e-9..step(RADIUS)).contains(&lowest), "{lowest}");
    let said: Vec<String> = passes.diagnostics.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|d| d.contains("flatter than 45 degrees")), "{said:?}");
    assert!(said.iter().any(|d| d.contains("touches first")), "{said:?}");
}

/// Of a boss beside a wall that is not to be cut the side behind a gap too narrow for the tool is left.
#[test]
fn a_check_face_is_not_cut() {
    let boss = Cylinder::new(10.0, Interval::new(0.0, 12.0)).unwrap();
    let wall = Placed {
        surface: Plane::new(Domain { u: Interval::new(-20.0, 20.0), v: Interval::new(0.0, 12.0) }),
        placement: Placement::new(Point3::new(13.0, 0.0, 0.0), -Vec3::x_axis(), Some(-Vec3::y())),
    };
    let passes = plan(&[&boss], &[&wall], &ball()).unwrap();
    let [cut, _] = left(&[&boss, &wall], &ball(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
    assert!(passes.passes.iter().all(|p| !p.closed));
}

#[test]
fn a_flat_end_and_a_flat_face_are_refused() {
    let boss = Cylinder::new(10.0, Interval::new(0.0, 12.0)).unwrap();
    let flat = Cutter::try_from(CutterSpec::Flat { diameter_mm: 6.0, length_mm: 30.0 }).unwrap();
    assert!(matches!(plan(&[&boss], &[], &flat), Err(PlanError::Tool { strategy: "waterline_3c", .. })));
    let floor = Plane::new(Domain { u: Interval::new(0.0, 20.0), v: Interval::new(0.0, 20.0) });
    assert!(matches!(plan(&[&floor], &[], &ball()), Err(PlanError::Nothing { .. })));
}
