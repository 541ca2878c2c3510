//! Passes that end before the tool goes into a wall, against closed forms.

use osculate_geom::analytic::{Line, Plane};
use osculate_geom::{Domain, Extruded, Interval, Point3, Surface, Unit3, Vec3, uv};
use osculate_productivity::axis::Left;
use osculate_productivity::plan::{CcPoint, Guard, LeaveOutError, Named, Pass, Passes, Tolerance, leave_out};
use osculate_tools::{Cutter, CutterSpec, Holder, Pose};

const RADIUS: f64 = 2.0;
const LENGTH: f64 = 30.0;
const GOUGE: f64 = 0.01;
const SCALLOP: f64 = 0.02;
/// Half the side of the plane, and half the length of the wall that stands on it at x = 0, along y.
const SIDE: f64 = 8.0;
const WALL: f64 = 3.0;
/// Distance of passes, mm.
const APART: f64 = 0.25;
/// The longest way between two poses that are looked at.
const STEP: f64 = 0.05 * RADIUS;
/// Stretches end two steps off at most, and the side of the tool keeps off by so much.
const ENDS: f64 = 2.0 * STEP;
const ASIDE: f64 = 0.02;

fn ball() -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * RADIUS, length_mm: LENGTH }).unwrap()
}

fn plane() -> Plane {
    Plane::new(Domain { u: Interval::new(-SIDE, SIDE), v: Interval::new(-SIDE, SIDE) })
}

/// The wall from one height to another.
fn wall(from: f64, to: f64) -> Extruded<Line> {
    let foot = Line::new(Point3::new(0.0, 0.0, 0.0), Vec3::y(), Interval::new(-WALL, WALL)).unwrap();
    Extruded::new(foot, Vec3::z(), Interval::new(from, to)).unwrap()
}

/// Upright at a place of the plane.
fn contact(x: f64, y: f64) -> CcPoint {
    let pose = Pose { tip: Point3::new(x, y, 0.0), axis: Vec3::z_axis() };
    CcPoint { uv: uv(x, y), point: pose.tip, normal: Vec3::z_axis(), pose, width_mm: 2.0 * APART }
}

/// To and fro along x, of two points each: the tool is seen between them.
fn rows() -> Passes {
    let count = (2.0 * SIDE / APART) as usize;
    let one = |k: usize| {
        let y = k as f64 * APART - SIDE;
        let x = if k.is_multiple_of(2) { SIDE } else { -SIDE };
        Pass { points: vec![contact(-x, y), contact(x, y)], closed: false }
    };
    Passes { passes: (0..=count).map(one).collect(), diagnostics: Vec::new() }
}

/// How far a place of the plane is off the wall's foot.
fn off(p: &Point3) -> f64 {
    let y = (p.y.abs() - WALL).max(0.0);
    p.x.hypot(y)
}

fn guard<'a>(faces: &'a [Named<'a>], check: &'a [Named<'a>], cutter: &'a Cutter) -> Guard<'a> {
    let tolerance = Tolerance { scallop_mm: SCALLOP, gouge_mm: GOUGE, chord_mm: 0.005 };
    Guard {
        faces,
        check,
        rims: &[],
        cutter,
        holder: None,
        tolerance,
        keep_off_mm: 0.0,
        left: Left::default(),
    }
}

/// The least distance of passes from the wall's foot, their points and what lies between.
fn nearest(passes: &Passes) -> f64 {
    let pairs = passes.passes.iter().flat_map(|p| p.points.windows(2));
    let at = pairs.flat_map(|w| {
        (0..=200).map(move |k| w[0].point + (w[1].point - w[0].point) * (f64::from(k) / 200.0))
    });
    at.map(|p| off(&p)).fold(f64::INFINITY, f64::min)
}

#[test]
fn passes_end_before_a_wall() {
    let (floor, wall, cutter) = (plane(), wall(0.0, 10.0), ball());
    let (faces, check) =
        ([Named { face: "floor", surface: &floor }], [Named { face: "wall", surface: &wall }]);
    let guard = guard(&faces, &check, &cutter);
    let whole = rows();
    let left = leave_out(&whole, &guard).unwrap();
    // Half the gouge tolerance ends a stretch; between samples of the wall the tool's side is no nearer than at them, but for a
    // twentieth of it.
    let near = nearest(&left.passes);
    assert!((RADIUS - 0.6 * GOUGE..=RADIUS + ENDS).contains(&near), "{near}");
    // Every row that the wall is in the way of, by more than the tolerance, is two now, and ends no further off it than two steps. The
    // side of the tool far above its contact keeps off the wall by a part of the distance of samples.
    let blocked = |by: f64| whole.passes.iter().filter(|p| p.points[0].point.y.abs() < WALL + by).count();
    assert!((blocked(RADIUS - GOUGE)..=blocked(RADIUS + ASIDE)).contains(&left.touched), "{}", left.touched);
    assert_eq!(left.passes.passes.len(), whole.passes.len() + left.touched);
    let length = |p: &Passes| p.passes.iter().map(Pass::length_mm).sum::<f64>();
    let blocked_mm = |y: f64| 2.0 * (RADIUS.powi(2) - (y.abs() - WALL).max(0.0).powi(2)).max(0.0).sqrt();
    let gone: f64 = whole.passes.iter().map(|p| blocked_mm(p.points[0].point.y)).sum();
    let is = length(&whole) - length(&left.passes);
    // Either end of a row is two steps off at most. Where a row only grazes the circle the half tolerance is a longer way.
    let most = left.touched as f64 * 2.0 * ENDS;
    assert!(is > gone - 0.5 && is < gone + most, "{is} {gone}");
    // What stands above five scallops: between the wall and the ball's nearest places, at height h the ball is
    // sqrt(2 R h - h^2) wide.
    let height: f64 = 5.0 * SCALLOP;
    let wide = (height * (2.0 * RADIUS - height)).sqrt();
    let round = RADIUS - wide;
    let area = 4.0 * WALL * round + std::f64::consts::PI * round * round;
    let found = left.area_mm2[0];
    // Ends two steps further off make it larger by that all around.
    let around = 4.0 * WALL + 2.0 * std::f64::consts::PI * round;
    assert!(found > 0.97 * area && found < area + ENDS * around, "{found} {area}");
    // Twice is once.
    let again = leave_out(&left.passes, &guard).unwrap();
    assert!(again.touched == 0 && again.passes == left.passes && again.area_mm2 == [0.0]);
    // With a distance to keep.
    let kept = leave_out(&whole, &Guard { keep_off_mm: 0.5, ..guard }).unwrap();
    let near = nearest(&kept.passes);
    assert!((RADIUS + 0.5..RADIUS + 0.6 + ENDS).contains(&near), "{near}");
    let bad = leave_out(&whole, &Guard { keep_off_mm: -1.0, ..guard });
    assert!(matches!(bad, Err(LeaveOutError::KeepOff { got }) if got == -1.0));
}

#[test]
fn only_the_holder_is_in_the_way() {
    const HOLDER: f64 = 4.0;
    // The wall hangs above the cutter's length.
    let (floor, wall, cutter) = (plane(), wall(LENGTH + 1.0, LENGTH + 6.0), ball());
    let (faces, check) =
        ([Named { face: "floor", surface: &floor }], [Named { face: "wall", surface: &wall }]);
    let whole = rows();
    let guard = guard(&faces, &check, &cutter);
    let without = leave_out(&whole, &guard).unwrap();
    assert!(without.touched == 0 && without.passes == whole);
    let holder = Holder::cylinder(2.0 * HOLDER, 20.0).unwrap();
    let with = leave_out(&whole, &Guard { holder: Some(&holder), ..guard }).unwrap();
    let near = nearest(&with.passes);
    assert!((HOLDER - 0.6 * GOUGE..=HOLDER + ENDS).contains(&near), "{near}");
    // Raw material of the same shape that is left, as points: half their distance is kept from them.
    let apart_mm = 0.2;
    let across = (0..=(2.0 * WALL / apart_mm) as usize).map(|k| k as f64 * apart_mm - WALL);
    let points: Vec<Point3> =
        across.flat_map(|y| [1.0, 3.0, 6.0].map(|z| Point3::new(0.0, y, LENGTH + z))).collect();
    let raw = Guard { check: &[], left: Left { points: &points, apart_mm }, ..guard };
    assert_eq!(leave_out(&whole, &raw).unwrap().touched, 0);
    let with = leave_out(&whole, &Guard { holder: Some(&holder), ..raw }).unwrap();
    let near = nearest(&with.passes);
    let kept = HOLDER + 0.5 * apart_mm;
    assert!((kept - 0.01..=kept + ENDS).contains(&near), "{near}");
}

#[test]
fn faces_to_machine_are_no_prey_either_and_closed_passes_open() {
    // A round pass about the origin that meets the wall at two places, where the wall is a face to machine.
    const AROUND: f64 = WALL + 1.0;
    let (floor, wall, cutter) = (plane(), wall(0.0, 10.0), ball());
    let faces = [Named { face: "floor", surface: &floor }, Named { face: "wall", surface: &wall }];
    let at = |k: u32| {
        let (s, c) = (f64::from(k % 90) * 4f64.to_radians()).sin_cos();
        contact(AROUND * c, AROUND * s)
    };
    let circle = Pass { points: (0..=90).map(at).collect(), closed: true };
    let passes = Passes { passes: vec![circle], diagnostics: Vec::new() };
    let left = leave_out(&passes, &guard(&faces, &[], &cutter)).unwrap();
    // It begins on the x axis, where the tool is clear: of its three stretches the last leads on to the first.
    assert_eq!((left.passes.passes.len(), left.touched), (2, 1));
    assert!(nearest(&left.passes) >= RADIUS - 0.6 * GOUGE);
    for p in &left.passes.passes {
        let (first, last) = (p.points[0].point, p.points[p.points.len() - 1].point);
        assert!(!p.closed && (first.y + last.y).abs() < 2.0 * ENDS, "{first} {last}");
        assert!([first, last].iter().all(|p| off(p) < RADIUS + ENDS));
        let steps = p.points.windows(2).map(|w| (w[1].point - w[0].point).norm());
        assert!(steps.fold(0.0, f64::max) < 0.07 * AROUND * 1.001);
    }
}

#[test]
fn passes_along_a_rim_remain() {
    // The side of a block, x = 0, up to its top, z = 0, which is not machined: passes of a ball along the rim, on it, above and below.
    // The samples of the top that lie on the rim lie on the side too.
    let cutter = ball();
    let line = |way: Vec3| Line::new(Point3::origin(), way, Interval::new(0.0, SIDE)).unwrap();
    let face = |a: Vec3, b: Vec3| Extruded::new(line(a), b, Interval::new(0.0, SIDE)).unwrap();
    let (side, top) = (face(Vec3::z() * -1.0, Vec3::y()), face(Vec3::y(), Vec3::x() * -1.0));
    let out = Vec3::x_axis();
    for (face, normal) in [(&side, out), (&top, Vec3::z_axis())] {
        let found = face.jet2(uv(1.0, 1.0)).normal().unwrap();
        assert!(found.dot(&normal) > 0.999, "{found:?}");
    }
    let (faces, check) = ([Named { face: "side", surface: &side }], [Named { face: "top", surface: &top }]);
    let guard = guard(&faces, &check, &cutter);
    let at = |y: f64, z: f64, deep: f64| {
        let point = Point3::new(0.0, y, z);
        let pose = Pose { tip: point - out.into_inner() * deep, axis: out };
        CcPoint { uv: uv(-z, y), point, normal: out, pose, width_mm: 2.0 * APART }
    };
    for z in [0.2, 0.0, -0.004, -0.01, -0.05, -0.3, -1.0] {
        let touched = |deep: f64| {
            let pass = Pass { points: vec![at(1.0, z, deep), at(SIDE - 1.0, z, deep)], closed: false };
            leave_out(&Passes { passes: vec![pass], diagnostics: Vec::new() }, &guard).unwrap().touched
        };
        // Chords and words take a fifth of the gouge; what is deeper than the gouge goes, rim or not.
        assert_eq!([touched(0.0), touched(0.2 * GOUGE), touched(4.0 * GOUGE)], [0, 0, 1], "at z = {z}");
    }
}

/// The edge of a block that a ball comes at from beside, between its faces: what it may not do to either it may not do to their edge.
#[test]
fn passes_do_not_go_into_an_edge_from_beside() {
    let cutter = ball();
    let line = |way: Vec3| Line::new(Point3::origin(), way, Interval::new(0.0, SIDE)).unwrap();
    let face = |a: Vec3, b: Vec3| Extruded::new(line(a), b, Interval::new(0.0, SIDE)).unwrap();
    let (side, top) = (face(Vec3::z() * -1.0, Vec3::y()), face(Vec3::y(), Vec3::x() * -1.0));
    let far = plane();
    let faces = [Named { face: "elsewhere", surface: &far }];
    let check = [Named { face: "side", surface: &side }, Named { face: "top", surface: &top }];
    let guard = Guard { faces: &faces[..0], ..guard(&faces, &check, &cutter) };
    let between = Unit3::new_normalize(Vec3::x() + Vec3::z());
    let at = |y: f64, deep: f64| {
        let point = Point3::new(0.0, y, 0.0) - between.into_inner() * deep;
        let pose = Pose { tip: point, axis: between };
        CcPoint { uv: uv(0.0, y), point, normal: between, pose, width_mm: 2.0 * APART }
    };
    let touched = |deep: f64| {
        let pass = Pass { points: vec![at(1.0, deep), at(SIDE - 1.0, deep)], closed: false };
        leave_out(&Passes { passes: vec![pass], diagnostics: Vec::new() }, &guard).unwrap().touched
    };
    assert_eq!([touched(0.0), touched(0.2 * GOUGE), touched(0.9 * GOUGE)], [0, 0, 1]);
}
