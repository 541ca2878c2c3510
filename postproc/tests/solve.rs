//! Branches, turns, poles, limits and rewinds over whole paths.

use crate::common;

use common::{angle, path, pose, wave};
use osculate_geom::Vec3;
use osculate_postproc::machine::JointKind;
use osculate_postproc::{BlockKind, JointPath, Machine, Setup, SolveError, SolveOptions};
use osculate_tools::Pose;
use osculate_tools::cl::{ClPath, Motion};

fn machine(name: &str) -> Machine {
    Machine::built_in(name).expect("a built-in machine")
}

fn leaning(tip: [f64; 3], lean_deg: f64, round_deg: f64) -> Pose {
    let (s, c) = lean_deg.to_radians().sin_cos();
    let (y, x) = round_deg.to_radians().sin_cos();
    pose(tip, [s * x, s * y, c])
}

fn rotary_deg(machine: &Machine, joints: &JointPath, letter: &str) -> Vec<f64> {
    let place = machine.joint_named(letter).expect("a joint of this letter");
    joints.blocks.iter().map(|b| b.joints[place].to_degrees()).collect()
}

/// No joint leaves its range, and every block that ends at a CL point is at it.
fn sound(machine: &Machine, setup: &Setup, path: &ClPath, joints: &JointPath, axis_tol_rad: f64) {
    for block in &joints.blocks {
        for (joint, value) in machine.joints().iter().zip(block.joints) {
            assert!(
                joint.excess(joint.at_nose(value, setup.gauge_length_mm)) < 1e-8,
                "{} at {value}",
                joint.letter
            );
        }
        let reached = machine.forward(&block.joints, setup);
        assert!((reached.tip - block.tip).norm() < 1e-8);
        if block.kind == BlockKind::Point {
            let wanted = &path.moves[block.source].pose;
            assert!((reached.tip - wanted.tip).norm() < 1e-8);
            assert!(angle(&reached.axis, &wanted.axis) <= axis_tol_rad + 1e-8);
        }
    }
    assert_eq!(joints.blocks.iter().filter(|b| b.kind == BlockKind::Point).count(), path.moves.len());
}

/// Five times round a cone: an endless table turns five times, without a jump.
#[test]
fn an_endless_axis_counts_on() {
    let m = machine("trunnion-ac");
    let around = path((0..=360).map(|i| leaning([10.0, 0.0, 5.0], 25.0, 5.0 * f64::from(i))), 500.0);
    let joints = m.solve(&around, &Setup::default(), &SolveOptions::default()).unwrap();
    sound(&m, &Setup::default(), &around, &joints, 0.0);
    let c = rotary_deg(&m, &joints, "C");
    assert!((c[c.len() - 1] - c[0] - 1800.0).abs() < 1e-6, "from {} to {}", c[0], c[c.len() - 1]);
    assert!(c.windows(2).all(|w| (w[1] - w[0]).abs() <= 5.0 + 1e-9));
    assert_eq!(joints.summary.rewinds, 0);
}

/// The same on a head whose C has 740 deg: 1800 deg need rewinds, as few as possible, away from the part.
#[test]
fn a_limited_axis_rewinds() {
    let m = machine("head-ca");
    let around = path((0..=360).map(|i| leaning([10.0, 0.0, 5.0], 25.0, 5.0 * f64::from(i))), 500.0);
    let setup = Setup::at(Vec3::zeros(), 80.0);
    let options = SolveOptions::default();
    let joints = m.solve(&around, &setup, &options).unwrap();
    sound(&m, &setup, &around, &joints, 0.0);
    // A turn of the tool by 1800 deg in ranges of 740: two rewinds at least, and two are enough.
    assert_eq!(joints.summary.rewinds, 2);
    assert_eq!(joints.diagnostics.len(), 2);
    let far = joints.blocks.iter().filter(|b| b.kind == BlockKind::Rewind);
    let reach = far.map(|b| (b.tip - around.moves[b.source].pose.tip).norm()).fold(0.0, f64::max);
    assert!(reach >= options.rewind_retract_mm - 1.0, "only {reach} mm away");
    // While the joints turn by a lot the tool is away from the part.
    let c = rotary_deg(&m, &joints, "C");
    for (i, w) in c.windows(2).enumerate() {
        let block = &joints.blocks[i + 1];
        assert!((w[1] - w[0]).abs() < 6.0 || block.motion == Motion::Rapid, "{w:?} at {:?}", block.motion);
    }
}

/// Straight over the pole: the outer axis stays, the inner one goes through zero; no rewind, no point off.
#[test]
fn straight_through_the_pole() {
    let m = machine("trunnion-ac");
    let over = path((-20..=20).map(|i| leaning([f64::from(i), 3.0, 0.0], f64::from(i), 30.0)), 500.0);
    for tcp in [true, false] {
        let options = SolveOptions { tcp, ..SolveOptions::default() };
        let joints = m.solve(&over, &Setup::default(), &options).unwrap();
        sound(&m, &Setup::default(), &over, &joints, options.singular_cone_rad);
        let c = rotary_deg(&m, &joints, "C");
        let spread = c.iter().fold(f64::MIN, |a, b| a.max(*b)) - c.iter().fold(f64::MAX, |a, b| a.min(*b));
        assert!(spread < 1e-6, "C moves by {spread} deg");
        assert_eq!(joints.summary.rewinds, 0);
        assert!(joints.summary.tip_error_mm <= options.tip_tol_mm);
        assert!(joints.summary.axis_error_rad <= options.axis_tol_rad);
        assert!(joints.summary.singular_mm > 0.0);
    }
}

/// Past the pole at a distance below the cone the axis is held, above it C must swing by half a turn; either way the
/// tolerances hold.
#[test]
fn past_the_pole() {
    let m = machine("trunnion-ac");
    for (miss_deg, swings) in [(0.001, false), (0.5, true)] {
        let over = path(
            (-40..=40).map(|i| {
                let t = 0.25 * f64::from(i);
                pose(
                    [t, 3.0, 0.0],
                    [f64::to_radians(t).sin(), f64::to_radians(miss_deg).tan(), f64::to_radians(t).cos()],
                )
            }),
            500.0,
        );
        for tcp in [true, false] {
            let options = SolveOptions { tcp, ..SolveOptions::default() };
            let joints = m.solve(&over, &Setup::default(), &options).unwrap();
            sound(&m, &Setup::default(), &over, &joints, options.singular_cone_rad);
            let c = rotary_deg(&m, &joints, "C");
            let travel: f64 = c.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
            assert_eq!(travel > 120.0, swings, "C travels {travel} deg at {miss_deg} deg, tcp {tcp}");
            assert!(joints.summary.tip_error_mm <= options.tip_tol_mm);
            assert!(joints.summary.axis_error_rad <= options.axis_tol_rad);
        }
    }
}

/// A tool as it stands at rest needs no rotary axis to move, whatever the machine.
#[test]
fn three_axis_paths_run_everywhere() {
    for name in osculate_postproc::built_in_names() {
        let m = machine(name);
        let axis: [f64; 3] = m.tool_axis().into_inner().into();
        let flat = path((0..50).map(|i| pose([f64::from(i), (0.3 * f64::from(i)).sin(), 1.0], axis)), 500.0);
        let setup = Setup::at(Vec3::new(5.0, 6.0, 7.0), 60.0);
        let joints = m.solve(&flat, &setup, &SolveOptions::default()).unwrap();
        sound(&m, &setup, &flat, &joints, 0.0);
        assert_eq!(joints.blocks.len(), flat.moves.len());
        for block in &joints.blocks {
            for (joint, value) in m.joints().iter().zip(block.joints) {
                assert!(
                    joint.kind == JointKind::Linear || value.abs() < 1e-12,
                    "{name}: {} moves",
                    joint.letter
                );
            }
        }
    }
}

/// Tolerances hold at any size, and finer ones need more points.
#[test]
fn tolerances_hold() {
    let m = machine("linuxcnc-xyzac");
    let mut before = 0;
    for tip_tol_mm in [0.1, 0.01, 0.001] {
        let options = SolveOptions { tip_tol_mm, ..SolveOptions::default() };
        let joints = m.solve(&wave(20, 0.0), &Setup::default(), &options).unwrap();
        sound(&m, &Setup::default(), &wave(20, 0.0), &joints, 0.0);
        assert!(
            joints.summary.tip_error_mm <= tip_tol_mm
                && joints.summary.axis_error_rad <= options.axis_tol_rad
        );
        assert!(joints.blocks.len() > before);
        before = joints.blocks.len();
    }
}

#[test]
fn what_cannot_be_reached_is_said() {
    let options = SolveOptions::default();
    let two = |second: Pose| path([leaning([0.0; 3], 10.0, 0.0), second], 100.0);
    let e = machine("nutated-b-table-c").solve(
        &two(pose([1.0, 2.0, 3.0], [0.6, 0.0, -0.8])),
        &Setup::default(),
        &options,
    );
    let Err(SolveError::Unreachable { index: 1, off_deg, .. }) = e else { panic!("{e:?}") };
    // acos(-0.8) is 143.1301 deg, this head stops at 90.
    assert!((off_deg - 53.1301).abs() < 1e-4);
    // A at -120..120 on both branches, so 130 deg from +Z is out by 10.
    let e = machine("trunnion-ac").solve(
        &two(leaning([1.0, 2.0, 3.0], 130.0, 40.0)),
        &Setup::default(),
        &options,
    );
    let Err(SolveError::Limit { index: 1, joint, value, max, .. }) = e else { panic!("{e:?}") };
    assert_eq!(joint, "A");
    assert!((value.abs() - 130.0).abs() < 1e-9 && (max - 120.0).abs() < 1e-12);
    // X at -400..400.
    let e = machine("3-axis").solve(&two(pose([0.0; 3], [0.0, 0.0, 1.0])), &Setup::default(), &options);
    assert!(matches!(e, Err(SolveError::Unreachable { index: 0, .. })));
    let far = path([pose([0.0; 3], [0.0, 0.0, 1.0]), pose([300.0, 0.0, 0.0], [0.0, 0.0, 1.0])], 100.0);
    let e = machine("3-axis").solve(&far, &Setup::at(Vec3::new(150.0, 0.0, 0.0), 0.0), &options);
    let Err(SolveError::Limit { index: 1, joint, value, .. }) = e else { panic!("{e:?}") };
    assert_eq!((joint.as_str(), value), ("X", 450.0));
    let text =
        machine("3-axis").solve(&far, &Setup::at(Vec3::new(150.0, 0.0, 0.0), 0.0), &options).unwrap_err();
    assert!(
        text.to_string().contains("450.0000 mm") && text.to_string().contains("-400.0000 to 400.0000 mm"),
        "{text}"
    );
}

#[test]
fn bad_input_is_refused() {
    let m = machine("trunnion-ac");
    let good = wave(5, 0.0);
    let options = SolveOptions::default();
    assert!(matches!(m.solve(&ClPath::default(), &Setup::default(), &options), Err(SolveError::Empty)));
    let mut nan = good.clone();
    nan.moves[3].pose.tip.y = f64::NAN;
    assert!(matches!(m.solve(&nan, &Setup::default(), &options), Err(SolveError::NotFinite { index: 3 })));
    let mut still = good.clone();
    still.moves[2].motion = Motion::Feed(0.0);
    assert!(matches!(m.solve(&still, &Setup::default(), &options), Err(SolveError::NotFinite { index: 2 })));
    let e = m.solve(&good, &Setup::at(Vec3::zeros(), -1.0), &options);
    assert!(matches!(e, Err(SolveError::Setup(_))));
    let e = m.solve(&good, &Setup::default(), &SolveOptions { tip_tol_mm: 0.0, ..options });
    assert!(matches!(e, Err(SolveError::Option { what: "tip_tol_mm", .. })));
    let e = m.solve(&good, &Setup::default(), &SolveOptions { singular_cone_rad: 1.0, ..options });
    assert!(matches!(e, Err(SolveError::Option { what: "singular_cone_rad", .. })));
}
