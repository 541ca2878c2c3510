//! Sharp outer edges: a tool that goes a little too deep over one face takes little of the part, whatever the normal of the other says.

use crate::removal::common::ball;
use osculate_geom::analytic::{Placed, Placement, Plane};
use osculate_geom::{Domain, Interval, Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_tools::removal::{
    Answer, Goal, GoalFace, GoalLimits, GoalStock, GoalTool, Looks, Program, Swept, Verdict, prove,
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
    let faces = [face("F1", &top, &[]), face("F2", &side, &[])];
    judged_on(faces, (cutter, motions))
}

fn face<'a>(name: &'a str, surface: &'a dyn Surface, open_rims: &'a [Vec<Uv>]) -> GoalFace<'a> {
    let mut face = GoalFace::new(name, surface);
    face.open_rims = open_rims;
    face
}

/// The first face is machined, others are checked.
fn judged_on<'a>(
    faces: impl IntoIterator<Item = GoalFace<'a>>,
    (cutter, motions): (&Cutter, &[Swept]),
) -> Verdict {
    let mut faces = faces.into_iter();
    let goal = goal_of(cutter, faces.next().into_iter().collect(), faces.collect());
    prove(&goal, Program { motions, times_min: &[], changes: &[] }, &|_| ()).expect("faces and motions")
}

fn goal_of<'a>(cutter: &'a Cutter, machined: Vec<GoalFace<'a>>, checked: Vec<GoalFace<'a>>) -> Goal<'a> {
    let (tools, stock) = (vec![GoalTool::new(cutter)], GoalStock::Assumed { layer_mm: 0.5 });
    let mut goal = Goal::new(machined, tools, stock, GoalLimits::new(0.02, GOUGE_MM));
    goal.checked = checked;
    goal.looks = Looks::spaced(0.1, 1_000_000);
    goal
}

#[test]
fn the_wall_lies_where_it_should() {
    let jet = wall().jet2(uv(1.0, 2.0));
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

/// The plane alone, as a sheet whose rims are all open: what goes down beside it takes as much as it comes in beside the rim, however
/// deep it goes.
#[test]
fn beneath_an_open_rim_depth_counts_up_to_the_rim() {
    let cutter = ball(6.0);
    let sheet = plane();
    let corners = [uv(0.0, 0.0), uv(6.0, 0.0), uv(6.0, 6.0), uv(0.0, 6.0)];
    let rims: Vec<Vec<Uv>> = (0..4).map(|k| vec![corners[k], corners[(k + 1) % 4]]).collect();
    let of = |inside_mm: f64, rims: &[Vec<Uv>]| {
        let v = judged_on([face("F1", &sheet, rims)], (&cutter, &motions(0.0, -inside_mm)));
        (v.answer(), v.figures().tally.gouge_max_mm)
    };
    for inside in [0.002, 0.006] {
        let (answer, found) = of(inside, &rims);
        assert_eq!(answer, Answer::Held, "{inside}: {found}");
        assert!(found < inside + 0.25 * GOUGE_MM + 1e-9, "{inside}: {found}");
        // With nothing said of the rim the sheet goes on downwards.
        let (answer, found) = of(inside, &[]);
        assert!(answer == Answer::NotHeld && found > 1.0, "{inside}: {found}");
    }
    let (answer, found) = of(0.05, &rims);
    assert_eq!(answer, Answer::NotHeld);
    // What is deeper than the limit from the rim too is told as it is along the normal.
    assert!(found > 0.02, "{found}");
    // What is too deep in the middle of the sheet is so with open rims as well.
    let v = judged_on([face("F1", &sheet, &rims)], (&cutter, &motions(-0.02, 0.5)));
    assert!(v.answer() == Answer::NotHeld && (v.figures().tally.gouge_max_mm - 0.02).abs() < 1e-6, "{v}");
}

/// Where an area is accepted, what bounds leave open counts into it; where none is, nothing is shown.
#[test]
fn what_may_hide_counts_into_an_area_that_is_accepted() {
    let cutter = ball(6.0);
    // Cusps of the passes, 0.3 mm apart, are 0.00375 mm high; so few samples may be added that bounds stay above the limit.
    let sheet = plane();
    let all = motions(0.0, 0.5);
    let of = |unreached_mm2: f64| {
        let mut goal = goal_of(&cutter, vec![face("F1", &sheet, &[])], Vec::new());
        (goal.limits.scallop_mm, goal.limits.unreached_mm2) = (0.00376, unreached_mm2);
        goal.looks = Looks::spaced(0.1, 4600);
        prove(&goal, Program { motions: &all, times_min: &[], changes: &[] }, &|_| ()).expect("a face")
    };
    let open = of(0.0);
    assert_eq!(open.answer(), Answer::NotShown, "{open}");
    let counted = of(36.0);
    assert_eq!(counted.answer(), Answer::Held, "{counted}");
    let (area, uncut) = (counted.figures().open_area_mm2, counted.figures().tally.uncut_area_mm2);
    assert!(area > 0.0 && area <= uncut + 1e-9 && uncut <= 36.0, "{area} {uncut}");
    assert!(counted.scope().iter().any(|row| row.covers.contains("may hide")), "{counted}");
    // None of it was measured so high.
    assert_eq!(counted.figures().high_area_mm2, 0.0);
    // An area that does not suffice changes nothing.
    let few = of(0.1 * area);
    assert!(few.answer() == Answer::NotShown && few.figures().open_area_mm2 == 0.0, "{few}");
}

/// Of an area that is accepted that is told which was measured too high: beside the last pass a ball leaves its circle.
#[test]
fn what_is_measured_too_high_is_told_of_an_area_that_is_accepted() {
    let cutter = ball(6.0);
    let sheet = plane();
    let rows = 14;
    let last_y = 0.3 * f64::from(rows - 1) - 0.9;
    let all = motions(0.0, 0.5);
    let mut goal = goal_of(&cutter, vec![face("F1", &sheet, &[])], Vec::new());
    goal.limits.unreached_mm2 = 30.0;
    let some = &all[..2 * rows as usize - 1];
    let v = prove(&goal, Program { motions: some, times_min: &[], changes: &[] }, &|_| ()).expect("a face");
    assert_eq!(v.answer(), Answer::Held, "{v}");
    let scallop = goal.limits.scallop_mm;
    let low = (scallop * (6.0 - scallop)).sqrt();
    let (high, uncut) = (v.figures().high_area_mm2, v.figures().tally.uncut_area_mm2);
    // Samples are 0.1 mm apart.
    assert!((high - 6.0 * (6.0 - last_y - low)).abs() <= 6.0 * 0.1, "{high}");
    assert!(uncut >= high && uncut <= high + 6.0 * 0.8, "{uncut}");
}
