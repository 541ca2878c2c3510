//! Sharp outer edges: a tool that goes a little too deep over one face takes little of the part, whatever the normal of the other says.

use crate::common::ball;
use osculate_geom::analytic::{Placed, Placement, Plane};
use osculate_geom::{Domain, Interval, Point3, Surface, Unit3, Vec3};
use osculate_tools::removal::{
    Answer, Goal, GoalControl, GoalFace, GoalLimits, GoalStock, GoalTool, Looks, Program, Swept, Verdict,
    prove,
};
use osculate_tools::{Cutter, Pose};

const GOUGE_MM: f64 = 0.01;

fn plane() -> Plane {
    let i = Interval::new(0.0, 6.0);
    Plane::new(Domain { u: i, v: i })
}

/// The wall below the edge of the plane at x = 6, its normal along x.
fn wall() -> Placed<Plane> {
    let at = Placement::new(Point3::new(6.0, 0.0, -6.0), Vec3::x_axis(), Some(Vec3::y()));
    Placed { surface: plane(), placement: at }
}

/// Passes over the plane and beyond it at this height, and then one down beside the wall that leaves it by this much.
fn motions(z: f64, off_mm: f64) -> Vec<Swept> {
    let pose = |x: f64, y: f64, z: f64| Pose { tip: Point3::new(x, y, z), axis: Vec3::z_axis() };
    let mut poses = Vec::new();
    for row in 0..=26 {
        let y = 0.3 * f64::from(row) - 0.9;
        let ends = if row % 2 == 0 { [-2.0, 9.0] } else { [9.0, -2.0] };
        poses.extend(ends.map(|x| pose(x, y, z)));
    }
    // A cylinder's side: the ball's radius away.
    poses.extend([
        pose(9.0 + off_mm, 3.0, 12.0),
        pose(9.0 + off_mm, 3.0, -5.0),
        pose(9.0 + off_mm, 3.0, 12.0),
    ]);
    poses.windows(2).map(|w| Swept { from: w[0], to: w[1], rapid: false, block: 1 }).collect()
}

fn judged(cutter: &Cutter, motions: &[Swept]) -> Verdict {
    let (top, side) = (plane(), wall());
    let face =
        |name: &'static str, surface| GoalFace { name, surface, outlines: Vec::new(), part_of_it: None };
    let goal = Goal {
        machined: vec![face("F1", &top as &dyn Surface)],
        checked: vec![face("F2", &side as &dyn Surface)],
        unseen: Vec::new(),
        fixtures: Vec::new(),
        tools: vec![GoalTool {
            cutter,
            flutes: cutter,
            shank: None,
            holder: None,
            teeth: None,
            spindle_rpm: None,
        }],
        stock: GoalStock::Assumed { layer_mm: 0.5 },
        limits: GoalLimits { scallop_mm: 0.02, gouge_mm: GOUGE_MM, unreached_mm2: 0.0, at_samples: false },
        looks: Looks { spacing_mm: Some(0.1), max_samples: 1_000_000, between: true },
        roughing_mm: None,
        control: GoalControl::default(),
    };
    prove(&goal, Program { motions, times_min: &[], changes: &[] }, &|_| ()).expect("two faces")
}

#[test]
fn the_wall_lies_where_it_should() {
    let jet = wall().jet2(osculate_geom::uv(1.0, 2.0));
    assert!((jet.point.x - 6.0).abs() < 1e-12 && jet.point.z <= 0.0, "{}", jet.point);
    assert!(jet.normal().is_ok_and(|n: Unit3| n.dot(&Vec3::x()) > 0.999));
}

#[test]
fn too_deep_over_one_face_is_no_deeper_beside_its_edge() {
    let cutter = ball(6.0);
    for depth in [0.0, 0.001, 0.004] {
        let v = judged(&cutter, &motions(-depth, 0.5));
        // Along the wall's normal it is 0.08 mm at a depth of 0.001 mm.
        assert_eq!(v.answer(), Answer::Held, "{depth}: {v}");
        let found = v.figures().tally.gouge_max_mm;
        // No less, and more by a fiftieth of the limit at most; below a quarter of it nothing is measured closer.
        let most = (depth + 0.025 * GOUGE_MM).max(0.25 * GOUGE_MM + 1e-9);
        assert!(found > depth - 1e-6 && found < most, "{depth}: {found}");
    }
}

#[test]
fn what_goes_into_the_wall_is_found_beside_the_edge_too() {
    let cutter = ball(6.0);
    let v = judged(&cutter, &motions(0.0, -0.05));
    assert_eq!(v.answer(), Answer::NotHeld, "{v}");
    let found = v.figures().tally.gouge_max_mm;
    // Samples of the wall are 0.4 mm apart across the pass.
    assert!(found <= 0.05 + 1e-9 && found > 0.05 - 0.2 * 0.2 / 6.0 - 1e-4, "{found}");
    // Too deep over the plane is found on the plane.
    let v = judged(&cutter, &motions(-0.02, 0.5));
    assert_eq!(v.answer(), Answer::NotHeld, "{v}");
    let found = v.figures().tally.gouge_max_mm;
    assert!((found - 0.02).abs() < 1e-6, "{found}");
}
