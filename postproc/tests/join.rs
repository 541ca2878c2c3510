//! Blocks that go on over CL points: as near to the path as blocks between CL points, and fewer.

use crate::common;

use common::{angle, path, pose, wave};
use osculate_geom::{Point3, Unit3};
use osculate_postproc::{JointPath, Machine, Setup, SolveOptions};
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};
use proptest::prelude::*;

/// Places on a block at which it is looked at.
const PLACES: u32 = 40;

/// What lies between the places at which the solver looks.
const BETWEEN: f64 = 1.1;

fn machine(name: &str) -> Machine {
    Machine::built_in(name).expect("a built-in machine")
}

fn solved(m: &Machine, path: &ClPath, options: SolveOptions) -> [JointPath; 2] {
    [false, true].map(|join| m.solve(path, &Setup::default(), &SolveOptions { join, ..options }).unwrap())
}

/// The tool at a share of a block, as a control moves it.
fn on_block(m: &Machine, joints: &JointPath, k: usize, share: f64, tcp: bool) -> Pose {
    let (a, b) = (&joints.blocks[k - 1], &joints.blocks[k]);
    let mut q = a.joints;
    for (v, end) in q.iter_mut().zip(b.joints) {
        *v += (end - *v) * share;
    }
    let pose = m.forward(&q, &Setup::default());
    if tcp { Pose { tip: a.tip + (b.tip - a.tip) * share, ..pose } } else { pose }
}

/// The greatest distances of tip and axis from a path over joined blocks; of the tip's along directions within an angle of the
/// axis, and a quarter of what it is off across the axis.
fn strays(m: &Machine, path: &ClPath, joints: &JointPath, touch_rad: f64, tcp: bool) -> (f64, f64) {
    let (mut tip, mut axis) = (0.0f64, 0.0f64);
    for k in 1..joints.blocks.len() {
        let (first, last) = (joints.blocks[k - 1].source, joints.blocks[k].source);
        if last < first + 2 {
            continue;
        }
        let part = &path.moves[first..=last];
        for i in 0..=PLACES {
            let now = on_block(m, joints, k, f64::from(i) / f64::from(PLACES), tcp);
            let want = abreast(part, &now);
            let off = now.tip - want.tip;
            let along = off.dot(&want.axis).abs();
            let across = (off.norm_squared() - along * along).max(0.0).sqrt();
            // The direction within the angle along which the tip is furthest off.
            let nearest = (across.atan2(along) - touch_rad).max(0.0);
            tip = tip.max(off.norm() * nearest.cos()).max(0.25 * across);
            axis = axis.max(angle(&want.axis, &now.axis));
        }
    }
    (tip, axis)
}

/// The pose of a path abreast of a tool: as far along the chord of the path.
fn abreast(path: &[ClMove], now: &Pose) -> Pose {
    let (from, to) = (path[0].pose.tip, path[path.len() - 1].pose.tip);
    let along = |p: &Point3| (p - from).dot(&(to - from));
    let past = |w: &[ClMove]| along(&w[1].pose.tip) >= along(&now.tip);
    let w = path.windows(2).find(|w| past(w)).unwrap_or(&path[path.len() - 2..]);
    let (a, b) = (&w[0].pose, &w[1].pose);
    let t = (along(&now.tip) - along(&a.tip)) / (along(&b.tip) - along(&a.tip));
    let (turn, first) = (angle(&a.axis, &b.axis), a.axis.into_inner());
    let across = (b.axis.into_inner() - first * first.dot(&b.axis)).try_normalize(1e-12).unwrap_or_default();
    let axis = first * (turn * t).cos() + across * (turn * t).sin();
    Pose { tip: a.tip + (b.tip - a.tip) * t, axis: Unit3::new_normalize(axis) }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn joined_blocks_keep_to_the_path(
        name in prop::sample::select(vec!["trunnion-ac", "trunnion-bc", "head-ca", "nutated-b-table-c", "head-b-table-c"]),
        points in 50u32..600,
        phase in 0.0..3.0f64,
        tip_tol_mm in 0.002..0.05f64,
        axis_tol_deg in 0.02..0.3f64,
        touch_deg in prop::sample::select(vec![0.0, 3.0, 15.0, 60.0, 90.0f64]),
        tcp in any::<bool>(),
    ) {
        let (m, way) = (machine(name), wave(points, phase));
        let touch_rad = touch_deg.to_radians();
        let options =
            SolveOptions { tip_tol_mm, axis_tol_rad: axis_tol_deg.to_radians(), touch_rad, tcp, ..SolveOptions::default() };
        let [single, joined] = solved(&m, &way, options);
        let s = &joined.summary;
        prop_assert!(s.tip_error_mm <= tip_tol_mm && s.axis_error_rad <= options.axis_tol_rad);
        let (tip, axis) = strays(&m, &way, &joined, touch_rad, tcp);
        prop_assert!(tip <= BETWEEN * tip_tol_mm, "the tip strays by {tip}, not {tip_tol_mm}");
        prop_assert!(axis <= BETWEEN * options.axis_tol_rad + 1e-6, "the axis strays by {axis}, not {}", options.axis_tol_rad);
        prop_assert!(joined.blocks.len() <= single.blocks.len());
        // Every move is there: by the points that are passed, by its length and by its end.
        prop_assert_eq!(joined.blocks.len() + s.joined_points - s.inserted_points, way.moves.len());
        let length = |j: &JointPath| j.blocks.iter().map(|b| b.tip_length_mm).sum::<f64>();
        prop_assert!((length(&joined) - length(&single)).abs() < 1e-9 * length(&single));
        let ends = (joined.blocks.last().map(|b| b.tip), way.moves.last().map(|m| m.pose.tip));
        prop_assert!(matches!(ends, (Some(a), Some(b)) if (a - b).norm() < 1e-9), "{:?}", ends);
    }
}

/// A dense path takes as many blocks as a coarse tolerance needs, however dense it is.
#[test]
fn blocks_follow_the_tolerance_not_the_points() {
    let m = machine("trunnion-ac");
    let counts = |points, tip_tol_mm| {
        let options = SolveOptions { tip_tol_mm, axis_tol_rad: 0.01, ..SolveOptions::default() };
        solved(&m, &wave(points, 0.0), options).map(|j| j.blocks.len())
    };
    let [single, joined] = counts(4000, 0.02);
    assert!(single >= 4000 && joined < single / 10, "{joined} of {single}");
    let denser = counts(8000, 0.02)[1];
    assert!(denser.abs_diff(joined) * 20 < joined, "{denser} and {joined}");
    // A parabola's height goes with the square of its length.
    let finer = counts(8000, 0.005)[1];
    let ratio = finer as f64 / denser as f64;
    assert!((1.7..2.3).contains(&ratio), "{finer} for {denser}");
}

/// Another feed, a rapid, and moves along which the axis stands end a block.
#[test]
fn blocks_end_where_moves_differ() {
    let m = machine("trunnion-ac");
    let lean = |x: f64, deg: f64| pose([x, 5.0, 0.0], [0.0, -deg.to_radians().sin(), deg.to_radians().cos()]);
    let mut way = path((0..=60).map(|i| lean(f64::from(i) * 0.1, 20.0 + 0.05 * f64::from(i))), 500.0);
    for m in &mut way.moves[21..=40] {
        m.motion = Motion::Feed(700.0);
    }
    way.moves[50].motion = Motion::Rapid;
    let options = SolveOptions { tip_tol_mm: 1.0, axis_tol_rad: 0.1, join: true, ..SolveOptions::default() };
    let joints = m.solve(&way, &Setup::default(), &options).unwrap();
    let ends: Vec<usize> = joints.blocks.iter().map(|b| b.source).collect();
    assert_eq!(ends, [0, 20, 40, 49, 50, 60]);
    assert_eq!(joints.summary.joined_points, 61 - ends.len());
    let stands = path((0..=60).map(|i| lean(f64::from(i) * 0.1, 20.0)), 500.0);
    let joints = m.solve(&stands, &Setup::default(), &options).unwrap();
    assert_eq!((joints.blocks.len(), joints.summary.joined_points), (61, 0));
}

/// The time that a block takes is that of all its moves.
#[test]
fn a_program_of_joined_blocks_takes_as_long() {
    use osculate_postproc::{Dialect, FeedMode, PostOptions, post};
    let (m, way) = (machine("trunnion-ac"), wave(2000, 0.3));
    let program = |join| {
        let usual = PostOptions::new(Dialect::LinuxCnc, FeedMode::InverseTime);
        let solve = SolveOptions { join, tip_tol_mm: 0.02, axis_tol_rad: 0.005, ..usual.solve };
        post(&way, &m, &Setup::default(), &PostOptions { solve, ..usual }).unwrap()
    };
    let [single, joined] = [false, true].map(program);
    assert!(joined.summary.blocks * 5 < single.summary.blocks);
    assert!((joined.summary.time_min / single.summary.time_min - 1.0).abs() < 1e-3);
}
