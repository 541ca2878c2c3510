//! Chord errors with closed forms: a turning table under a straight line.

use osculate_geom::Vec3;
use osculate_tools::cl::Motion;

use super::*;
use crate::machine::MAX_JOINTS;
use crate::solve_options::check_options;

/// LinuxCNC's AC table with its tilt axis at y -7, z 20 and a tool of 80.
fn table() -> (Machine, Setup) {
    let text = include_str!("../machines/linuxcnc-xyzac.toml");
    let text =
        text.replace("direction = [1, 0, 0]\nsense", "direction = [1, 0, 0]\npoint_mm = [0, -7, 20]\nsense");
    (Machine::from_toml(&text).unwrap(), Setup::at(Vec3::zeros(), 80.0))
}

fn joints(machine: &Machine, x: f64, a_deg: f64, c_deg: f64) -> JointValues {
    let mut q = [0.0; MAX_JOINTS];
    for (letter, value) in [("X", x), ("A", a_deg.to_radians()), ("C", c_deg.to_radians())] {
        q[machine.joint_named(letter).unwrap()] = value;
    }
    q
}

fn blocks(
    from: (f64, f64, f64),
    to: (f64, f64, f64),
    options: &SolveOptions,
) -> Result<JointPath, SolveError> {
    line(from, to, (options, false))
}

fn line(
    from: (f64, f64, f64),
    to: (f64, f64, f64),
    (options, aloft): (&SolveOptions, bool),
) -> Result<JointPath, SolveError> {
    let (machine, setup) = table();
    let placed = |(x, a, c)| {
        let joints = joints(&machine, x, a, c);
        Placed { pose: machine.forward(&joints, &setup), joints }
    };
    let mut liner = Liner { machine: &machine, setup: &setup, options, path: JointPath::default() };
    let label = Label { motion: Motion::Feed(100.0), aloft, source: 1, kind: BlockKind::Point };
    liner.line(&placed(from), &placed(to), &label)?;
    Ok(liner.path)
}

fn options(tip_tol_mm: f64) -> SolveOptions {
    SolveOptions { tip_tol_mm, axis_tol_rad: 1.0, singular_cone_rad: 1e-6, ..SolveOptions::default() }
}

/// The sagitta of an arc is r (1 - cos(angle / 2)); halving the angle quarters it.
#[test]
fn chord_of_a_turning_table() {
    let path = blocks((50.0, 0.0, 0.0), (50.0, 0.0, 5.0), &options(1.0)).unwrap();
    assert_eq!(path.blocks.len(), 1);
    // Five decimals printed.
    assert!((path.summary.tip_error_mm - 0.047_59).abs() < 5e-6, "{}", path.summary.tip_error_mm);
    let path = blocks((50.0, 0.0, 0.0), (50.0, 0.0, 5.0), &options(0.01)).unwrap();
    assert_eq!((path.blocks.len(), path.summary.inserted_points), (4, 3));
    assert!(path.summary.tip_error_mm <= 0.01);
    let path = blocks((50.0, 0.0, 0.0), (50.0, 0.0, 90.0), &options(20.0)).unwrap();
    assert!((path.summary.tip_error_mm - 14.644_66).abs() < 5e-6, "{}", path.summary.tip_error_mm);
    let path = blocks((50.0, 0.0, 0.0), (50.0, 0.0, 90.0), &options(0.01)).unwrap();
    assert_eq!(path.blocks.len(), 64);
    let length: f64 = path.blocks.iter().map(|b| b.tip_length_mm).sum();
    // The chord of a quarter circle.
    assert!((length - 50.0 * 2f64.sqrt()).abs() < 1e-9);
}

/// Off everything the tool may stray more: as many blocks as the wider tolerance needs, of which the summary of what may touch says nothing; no
/// wider one leaves the line as it is.
#[test]
fn off_everything_blocks_are_fewer() {
    let fine = SolveOptions { aloft_tol: (0.05, 1.0), ..options(0.01) };
    let ends = ((50.0, 0.0, 0.0), (50.0, 0.0, 5.0));
    let count = |options: &SolveOptions, aloft: bool| {
        let path = line(ends.0, ends.1, (options, aloft)).unwrap();
        (path.blocks.len(), path.summary.tip_error_mm)
    };
    // 0.0476 mm in one block.
    assert_eq!(count(&fine, true), (1, 0.0));
    assert_eq!(count(&SolveOptions { aloft_tol: (0.045, 1.0), ..fine }, true).0, 2);
    assert_eq!(count(&fine, false), count(&options(0.01), false));
    let (blocks, _) = count(&options(0.01), true);
    assert_eq!(blocks, 4);
    let wrong = SolveOptions { aloft_tol: (-1.0, 0.0), ..fine };
    assert!(matches!(check_options(&wrong), Err(SolveError::Option { what: "aloft_tol", .. })));
}

/// With the tool at 30 deg over the centre, C 0 to 90 leaves the tip where it is, but takes the axis round the cone
/// instead of over the great circle: 30 deg less atan(sin 30 cos 45 / cos 30) in the middle.
#[test]
fn axis_stray_with_a_resting_tip() {
    // The tilt axis is off the table's centre: X Y Z follow so that the tip rests at the part's origin.
    let (machine, setup) = table();
    let placed = |c: f64| {
        let tip = osculate_geom::Point3::origin();
        let joints =
            machine.with_tip(&[c.to_radians(), 30f64.to_radians()], &tip, setup.gauge_length_mm).unwrap();
        Placed { pose: machine.forward(&joints, &setup), joints }
    };
    let wide = SolveOptions { tip_tol_mm: 1e-6, ..options(1.0) };
    let mut liner = Liner { machine: &machine, setup: &setup, options: &wide, path: JointPath::default() };
    let label = Label { motion: Motion::Feed(100.0), aloft: false, source: 1, kind: BlockKind::Point };
    liner.line(&placed(0.0), &placed(90.0), &label).unwrap();
    assert_eq!(liner.path.blocks.len(), 1);
    assert!((liner.path.summary.axis_error_rad.to_degrees() - 7.7923).abs() < 5e-5);
    assert!(liner.path.summary.tip_error_mm < 1e-9);
    let fine = SolveOptions { axis_tol_rad: 0.01f64.to_radians(), ..wide };
    let mut liner = Liner { machine: &machine, setup: &setup, options: &fine, path: JointPath::default() };
    liner.line(&placed(0.0), &placed(90.0), &label).unwrap();
    assert!(liner.path.summary.axis_error_rad <= fine.axis_tol_rad && liner.path.blocks.len() > 16);
}

#[test]
fn tool_centre_point_control_needs_no_points_for_the_tip() {
    let tcp = SolveOptions { tcp: true, ..options(0.01) };
    let path = blocks((50.0, 0.0, 0.0), (50.0, 0.0, 60.0), &tcp).unwrap();
    assert_eq!((path.blocks.len(), path.summary.tip_error_mm), (1, 0.0));
}

/// What counts of a stray tip is the most that goes along any normal within the angle, found here by trying many.
#[test]
fn a_stray_tip_counts_by_its_share_towards_the_part() {
    let axis = Unit3::new_normalize(Vector3::new(0.2, -0.3, 1.0));
    let side = any_perpendicular(&axis);
    let other = axis.cross(&side);
    for touch_deg in [0.0f64, 3.0, 20.0, 60.0, 90.0] {
        let touch = touch_deg.to_radians();
        for (along, across) in [(1.0f64, 0.0f64), (-1.0, 0.1), (1.0, 0.5), (0.5, 2.0), (0.1, 3.0), (0.0, 1.0)]
        {
            let off = axis.into_inner() * along + side.into_inner() * across;
            let mut most = 0.0f64;
            for i in 0..=900 {
                let t = touch * f64::from(i) / 900.0;
                for j in 0..360 {
                    let (s, c) = f64::from(j).to_radians().sin_cos();
                    let normal = axis.into_inner() * t.cos() + (side.into_inner() * c + other * s) * t.sin();
                    most = most.max(off.dot(&normal).abs());
                }
            }
            let got = towards(&off, &axis, touch);
            let want = most.max(across / ACROSS);
            assert!((got - want).abs() < 1e-5, "{touch_deg} deg, {along} and {across}: {got}, not {want}");
        }
    }
}

/// A table that turns under a tool that stands upright moves the tip across its axis alone: blocks may be twice as long.
#[test]
fn blocks_are_longer_where_the_tip_strays_across_the_axis() {
    let anywhere = options(0.001);
    let below = SolveOptions { touch_rad: 0.1, ..anywhere };
    let [many, few] =
        [anywhere, below].map(|o| blocks((50.0, 0.0, 0.0), (50.0, 0.0, 90.0), &o).unwrap().blocks.len());
    assert_eq!((many, few), (256, 128));
    let beyond = SolveOptions { touch_rad: 2.0, ..anywhere };
    assert!(matches!(check_options(&beyond), Err(SolveError::Option { what: "touch_rad", .. })));
}
