//! The verdict: tooth marks against their closed form, what is said of what is not looked at, programs that are far off.

use osculate_geom::analytic::Plane;
use osculate_geom::{Domain, Interval, Point3, Surface, Vec3};
use osculate_tools::removal::{
    Answer, Goal, GoalControl, GoalFace, GoalLimits, GoalStock, GoalTool, Gravity, Looks, Program,
    ProveError, Remark, Swept, Unseen, Verdict, prove,
};
use osculate_tools::{Cutter, CutterSpec, Pose};

const RADIUS_MM: f64 = 3.0;
const STEP_MM: f64 = 0.3;

fn plane() -> Plane {
    let i = Interval::new(0.0, 6.0);
    Plane::new(Domain { u: i, v: i })
}

fn ball() -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * RADIUS_MM, length_mm: 40.0 }).expect("a ball")
}

/// Passes along x over the plane and 2 mm beyond it, each in pieces of 0.7 mm, at this height.
fn raster(z: f64) -> Vec<Swept> {
    let pose = |x: f64, y: f64| Pose { tip: Point3::new(x, y, z), axis: Vec3::z_axis() };
    let mut poses = Vec::new();
    for row in 0..=26 {
        let y = STEP_MM * f64::from(row) - 0.9;
        for k in 0..=14 {
            let x = 0.7 * f64::from(if row % 2 == 0 { k } else { 14 - k }) - 2.0;
            poses.push(pose(x, y));
        }
    }
    poses.windows(2).map(|w| Swept { from: w[0], to: w[1], rapid: false, block: 1 }).collect()
}

/// The ends of the motions at an even feed.
fn times(motions: &[Swept], feed_mm_min: f64) -> Vec<f64> {
    let mut clock = 0.0;
    motions
        .iter()
        .map(|m| {
            clock += (m.to.tip - m.from.tip).norm() / feed_mm_min;
            clock
        })
        .collect()
}

struct Asked {
    z: f64,
    feed_mm_min: f64,
    scallop_mm: f64,
    unseen: Vec<Unseen>,
    remarks: Vec<Remark>,
    blend_mm: f64,
    /// Places that the tool dips to after all passes, a thousandth deep, down and up again at 20 degrees.
    dips: Vec<[f64; 2]>,
}

impl Default for Asked {
    fn default() -> Self {
        Self {
            z: 0.0,
            feed_mm_min: 400.0,
            scallop_mm: 0.02,
            unseen: Vec::new(),
            remarks: Vec::new(),
            blend_mm: 0.0,
            dips: Vec::new(),
        }
    }
}

/// The motions of dips after others.
fn dipped(mut motions: Vec<Swept>, dips: &[[f64; 2]]) -> Vec<Swept> {
    let slope = 20f64.to_radians().tan();
    let mut last = motions[motions.len() - 1].to;
    let mut go = |x: f64, y: f64, z: f64, rapid: bool| {
        let to = Pose { tip: Point3::new(x, y, z), axis: Vec3::z_axis() };
        motions.push(Swept { from: last, to, rapid, block: 2 });
        last = to;
    };
    for [x, y] in dips {
        let (at, high) = (*x, 4.0 * slope);
        go(at - 4.0, *y, 9.0, true);
        go(at - 4.0, *y, high, true);
        go(at, *y, -0.001, false);
        go(at + 4.0, *y, high, false);
        go(at + 4.0, *y, 9.0, true);
    }
    motions
}

fn judged(asked: Asked) -> Result<Verdict, ProveError> {
    let (face, cutter) = (plane(), ball());
    let surface: &dyn Surface = &face;
    // 1000 rpm and two teeth: 2000 a minute.
    let tools = vec![GoalTool::new(&cutter).turning(2, 1000.0)];
    let stock = GoalStock::Assumed { layer_mm: 0.5 };
    let limits = GoalLimits::new(asked.scallop_mm, 0.005);
    let mut goal = Goal::new(vec![GoalFace::new("F1", surface)], tools, stock, limits);
    goal.unseen = asked.unseen;
    goal.looks = Looks::spaced(0.05, 100_000);
    goal.control = GoalControl { remarks: asked.remarks, blend_mm: asked.blend_mm, ..GoalControl::default() };
    let motions = dipped(raster(asked.z), &asked.dips);
    let times_min = times(&motions, asked.feed_mm_min);
    prove(&goal, Program { motions: &motions, times_min: &times_min, changes: &[] }, &|_| ())
}

/// Two circles of radius R at the distance of a tooth's feed f meet at `R - sqrt(R^2 - f^2/4)`. The search for the worst phase
/// closes in to a thousandth of a period, and what it leaves adds to the mark: less than `f / 4096` times the slope `f / 2R`.
#[test]
fn marks_on_a_plane_are_those_of_two_circles() {
    for f in [0.1f64, 0.2, 0.5] {
        let v = judged(Asked { feed_mm_min: 2000.0 * f, scallop_mm: 0.05, ..Asked::default() }).unwrap();
        let want = RADIUS_MM - (RADIUS_MM * RADIUS_MM - 0.25 * f * f).sqrt();
        let got = v.figures().mark_max_mm.unwrap();
        assert!(got >= want - 1e-9 && got < want + f * f / RADIUS_MM / 1000.0 + 1e-6, "{f}: {got} {want}");
        let scallop = RADIUS_MM - (RADIUS_MM * RADIUS_MM - 0.25 * STEP_MM * STEP_MM).sqrt();
        // Marks and scallops add: the lattice of centres leaves (f^2 + s^2) / 8R to leading order.
        let sum = v.figures().height_max_mm;
        assert!(sum <= got + scallop + 1e-9 && sum > want + 0.8 * scallop, "{f}: {sum}");
        assert_eq!(v.answer(), Answer::Held, "{v}");
    }
    // 4 mm a tooth: 0.76 mm, above the layer that is looked at.
    let v = judged(Asked { feed_mm_min: 8000.0, ..Asked::default() }).unwrap();
    assert_eq!(v.answer(), Answer::NotHeld);
    assert!(
        v.why().iter().any(|w| w.contains("tooth mark")) && v.figures().mark_max_mm.unwrap() > 0.45,
        "{v}"
    );
}

/// A pass that grazes a place for less than the time from tooth to tooth may leave much, but not more than the passes before it have left.
#[test]
fn what_other_passes_have_taken_bears_no_mark() {
    let f = 0.2;
    let asked = |dips: Vec<[f64; 2]>| Asked { feed_mm_min: 2000.0 * f, dips, ..Asked::default() };
    let plain = judged(asked(Vec::new())).unwrap();
    let dips = judged(asked(vec![[1.1, 1.3], [3.0, 2.9], [4.2, 1.7]])).unwrap();
    assert!(plain.is_held() && dips.is_held(), "{:?} {:?}", plain.why(), dips.why());
    // Alone a dip would leave f / 2 tan(20) = 0.036 mm; below half the limit nothing else is asked.
    let [a, b] = [&plain, &dips].map(|v| v.figures().height_max_mm);
    assert!(b <= a.max(0.5 * 0.02) + 1e-6, "{b} instead of {a}");
}

#[test]
fn what_is_not_looked_at_is_named() {
    let hit =
        judged(Asked { unseen: vec![Unseen::MayBeHit(vec!["F2".into()])], ..Asked::default() }).unwrap();
    assert!(hit.is_held() && hit.words().contains("held for F1 only"), "{hit}");
    assert!(hit.scope().iter().any(|row| row.covers.contains("NOT looked at") && row.covers.contains("F2")));
    let open = judged(Asked { unseen: vec![Unseen::NoSide(vec!["F3".into()])], ..Asked::default() }).unwrap();
    assert_eq!(open.answer(), Answer::NotShown);
    assert!(open.words().contains("F3"), "{open}");
}

#[test]
fn the_control_belongs_to_the_verdict() {
    let say = |gravity| vec![Remark { gravity, text: "line 7: something".into() }];
    for (gravity, want) in
        [(Gravity::Told, Answer::Held), (Gravity::Open, Answer::NotShown), (Gravity::Breaks, Answer::NotHeld)]
    {
        let v = judged(Asked { remarks: say(gravity), ..Asked::default() }).unwrap();
        assert_eq!(v.answer(), want, "{v}");
        assert!(v.to_string().contains("line 7"));
    }
    // Corners blended by more than the gouge limit leave nothing shown, and nothing disproved.
    let v = judged(Asked { blend_mm: 0.01, ..Asked::default() }).unwrap();
    assert_eq!(v.answer(), Answer::NotShown);
    assert!(v.words().contains("blended"), "{v}");
}

/// A path that is 0.003 mm deep everywhere, where 0.005 mm is accepted: corners blended by 0.001 mm leave room, by 0.003 mm none, and
/// nothing that lies between samples can turn that.
#[test]
fn what_blended_corners_leave_no_room_for_is_not_looked_at_closer() {
    let deep = |blend_mm| judged(Asked { z: -0.003, blend_mm, ..Asked::default() }).unwrap();
    let room = deep(0.001);
    assert!(room.is_held(), "{room}");
    let none = deep(0.003);
    assert!(none.answer() == Answer::NotShown && none.words().contains("blended"), "{none}");
    assert_eq!(none.figures().added, 0);
}

/// A program 2 mm too deep, or one that never comes near, is told after a coarse look; one a little too deep is measured.
#[test]
fn hopeless_programs_end_early() {
    for z in [-2.0, 5.0] {
        let v = judged(Asked { z, ..Asked::default() }).unwrap();
        assert!(v.answer() == Answer::NotHeld && v.figures().coarse, "{v}");
        assert!(v.samples().len() < 1500, "{}", v.samples().len());
    }
    let v = judged(Asked { z: -0.01, ..Asked::default() }).unwrap();
    assert!(v.answer() == Answer::NotHeld && !v.figures().coarse, "{v}");
    assert!((v.figures().tally.gouge_max_mm - 0.01).abs() < 1e-9);
}

#[test]
fn verdicts_do_not_depend_on_threads() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let v = pool.install(|| judged(Asked::default())).unwrap();
        (v.to_string(), format!("{:?}", v.figures()))
    };
    let one = on(1);
    assert!(one == on(2) && one == on(5));
}
