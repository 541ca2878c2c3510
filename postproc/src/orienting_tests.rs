//! Reach and turns against forward kinematics of joints within their limits, and in closed form.

use osculate_geom::Vec3;
use proptest::prelude::*;

use super::*;
use crate::machine::built_in_names;

/// Axes from the inverse of the kinematics come back within the square root of rounding where both branches meet, rad.
const NEAR_BORDER_RAD: f64 = 1e-7;

fn unit(x: f64, y: f64, z: f64) -> Unit3 {
    Unit3::new_normalize(Vec3::new(x, y, z))
}

/// The axis that leans from +z by an angle, towards an azimuth; degrees.
fn leaning(tilt_deg: f64, azimuth_deg: f64) -> Unit3 {
    let ((s, c), (y, x)) = (tilt_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    unit(s * x, s * y, c)
}

fn machine(name: &str) -> Machine {
    Machine::built_in(name).unwrap()
}

fn standing(machine: &Machine) -> Orienting<'_> {
    Orienting::new(machine, &UnitQuaternion::identity())
}

/// A machine of the library with some words of its file changed.
fn changed(name: &str, changes: &[(&str, &str)]) -> Machine {
    let mut text = crate::built_in_text(name).unwrap().to_owned();
    for (from, to) in changes {
        assert!(text.contains(from));
        text = text.replacen(from, to, 1);
    }
    Machine::from_toml(&text).unwrap()
}

#[test]
fn three_linear_joints_have_one_axis() {
    let three = machine("3-axis");
    let (up, side) = (Vec3::z_axis(), Vec3::x_axis());
    assert!(standing(&three).reaches(&up));
    assert!(!standing(&three).reaches(&leaning(0.01, 30.0)));
    assert_eq!(standing(&three).nearest(&side), up);
    assert_eq!(standing(&three).turn_s(&up, &up), Some(0.0));
    assert_eq!(standing(&three).turn_s(&up, &side), None);
    // Laid over, the part shows its x to the tool.
    let part = UnitQuaternion::from_axis_angle(&Vec3::y_axis(), -std::f64::consts::FRAC_PI_2);
    let laid = Orienting::new(&three, &part);
    assert!(laid.reaches(&side) && !laid.reaches(&up));
    assert!((laid.nearest(&up).into_inner() - side.into_inner()).norm() < 1e-15);
}

#[test]
fn one_rotary_joint_has_a_circle_of_axes() {
    // The tool lies along X and C turns the part about Z, at 600 degrees a second.
    let mill_turn = machine("mill-turn-xyzc");
    let joints = standing(&mill_turn);
    let around = |deg: f64| leaning(90.0, deg);
    assert!(joints.reaches(&around(137.0)) && !joints.reaches(&leaning(89.0, 137.0)));
    assert!((joints.nearest(&leaning(70.0, 137.0)).into_inner() - around(137.0).into_inner()).norm() < 1e-15);
    // Without end the shorter way is taken: 20 degrees over the seam, not 340.
    assert!((joints.turn_s(&around(170.0), &around(-170.0)).unwrap() - 20.0 / 600.0).abs() < 1e-12);
    // From -30 to 200 degrees of C only 20 degrees short of a whole turn are out of reach.
    let text = ("max_velocity_deg_s = 600", "min_deg = -30\nmax_deg = 200\nmax_velocity_deg_s = 600");
    let limited = changed("mill-turn-xyzc", &[text]);
    let joints = standing(&limited);
    // As in ISO 841, where the tool turns about the part.
    assert!(joints.reaches(&around(200.0)) && joints.reaches(&around(-30.0)));
    assert!(!joints.reaches(&around(-40.0)) && !joints.reaches(&around(210.0)));
    assert!((joints.turn_s(&around(170.0), &around(-20.0)).unwrap() - 190.0 / 600.0).abs() < 1e-12);
    let nearest = joints.nearest(&around(-50.0));
    assert!((nearest.into_inner() - around(-30.0).into_inner()).norm() < 1e-12, "{nearest:?}");
}

/// A joint about the tool itself turns nothing and costs nothing.
#[test]
fn a_turntable_leaves_the_axis_where_it_is() {
    let table = changed("mill-turn-xyzc", &[("tool_axis = [1, 0, 0]", "tool_axis = [0, 0, 1]")]);
    let joints = standing(&table);
    let up = Vec3::z_axis();
    assert!(joints.reaches(&up) && !joints.reaches(&leaning(1.0, 0.0)));
    assert_eq!(joints.turn_s(&up, &up), Some(0.0));
    assert_eq!(joints.nearest(&leaning(20.0, 50.0)), up);
}

#[test]
fn limits_of_a_trunnion() {
    // A to 120 degrees either way, at 180 degrees a second; C without end, at 360.
    let trunnion = machine("trunnion-ac");
    let joints = standing(&trunnion);
    for azimuth in [0.0, 77.0, 180.0, 301.0] {
        assert!(joints.reaches(&leaning(119.9, azimuth)) && !joints.reaches(&leaning(120.1, azimuth)));
        let nearest = joints.nearest(&leaning(140.0, azimuth));
        assert!((nearest.into_inner() - leaning(120.0, azimuth).into_inner()).norm() < 1e-12);
    }
    // A part on its head: what looks down in its frame looks up on the table.
    let over = UnitQuaternion::from_axis_angle(&Vec3::x_axis(), std::f64::consts::PI);
    assert!(Orienting::new(&trunnion, &over).reaches(&-Vec3::z_axis()));
    assert!(!Orienting::new(&trunnion, &over).reaches(&Vec3::z_axis()));
    // With A to one side only there is one branch left, which still reaches all round.
    let half = changed("trunnion-ac", &[("min_deg = -120", "min_deg = 0")]);
    assert!((0..24).all(|k| standing(&half).reaches(&leaning(80.0, 15.0 * f64::from(k)))));
}

#[test]
fn turns_in_closed_form() {
    let trunnion = machine("trunnion-ac");
    let joints = standing(&trunnion);
    let turn_s =
        |a: [f64; 2], b: [f64; 2]| joints.turn_s(&leaning(a[0], a[1]), &leaning(b[0], b[1])).unwrap();
    // The faster joint waits for the slower one: A by 40 at 180, C by 30 at 360 degrees a second.
    assert!((turn_s([20.0, 10.0], [60.0, 40.0]) - 40.0 / 180.0).abs() < 1e-12);
    // C by 50, A by 10.
    assert!((turn_s([60.0, 10.0], [70.0, 60.0]) - 50.0 / 360.0).abs() < 1e-12);
    // To the other side of the pole: A over to the other branch by 20 is faster than C by 180.
    assert!((turn_s([10.0, 0.0], [10.0, 180.0]) - 20.0 / 180.0).abs() < 1e-12);
    // The turns of both joints on the same ways, the outer first: C, then A.
    let turns = |a: [f64; 2], b: [f64; 2]| {
        let turns = joints.turns_rad(&leaning(a[0], a[1]), &leaning(b[0], b[1])).unwrap();
        turns.map(f64::to_degrees)
    };
    let near = |got: [f64; 2], wanted: [f64; 2]| got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(near(turns([20.0, 10.0], [60.0, 40.0]), [30.0, 40.0]));
    assert!(near(turns([60.0, 10.0], [70.0, 60.0]), [50.0, 10.0]));
    // A swings through to its other side, and C rests.
    assert!(near(turns([10.0, 0.0], [10.0, 180.0]), [0.0, 20.0]));
    assert_eq!(joints.turns_rad(&leaning(150.0, 0.0), &leaning(10.0, 0.0)), None);
    // Low down it is C that turns.
    assert!((turn_s([100.0, 0.0], [100.0, 180.0]) - 0.5).abs() < 1e-12);
    // With one branch only there is no other way.
    let half = changed("trunnion-ac", &[("min_deg = -120", "min_deg = 0")]);
    let around = standing(&half).turn_s(&leaning(10.0, 0.0), &leaning(10.0, 180.0)).unwrap();
    assert!((around - 0.5).abs() < 1e-12);
}

#[test]
fn the_pole_leaves_the_outer_joint_free() {
    let trunnion = machine("trunnion-ac");
    let joints = standing(&trunnion);
    let up = Vec3::z_axis();
    assert_eq!(joints.turn_s(&up, &up), Some(0.0));
    for azimuth in [0.0, 40.0, 90.0, 200.0, 350.0] {
        for (a, b) in [(up, leaning(36.0, azimuth)), (leaning(36.0, azimuth), up)] {
            // Both branches meet at the pole, so that A is zero there to the square root of rounding.
            assert!((joints.turn_s(&a, &b).unwrap() - 0.2).abs() < 1e-7);
        }
    }
    // A limited outer joint that never stands at zero is free there all the same.
    let limited = changed(
        "trunnion-ac",
        &[("max_velocity_deg_s = 360", "min_deg = 40\nmax_deg = 260\nmax_velocity_deg_s = 360")],
    );
    let joints = standing(&limited);
    assert!(joints.reaches(&up));
    assert!((joints.turn_s(&up, &leaning(36.0, 0.0)).unwrap() - 0.2).abs() < 1e-7);
}

fn any_machine() -> impl Strategy<Value = Machine> {
    prop::sample::select(built_in_names()).prop_map(machine)
}

fn any_unit() -> impl Strategy<Value = Unit3> {
    [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_filter_map("too short", |v| Unit3::try_new(Vec3::from(v), 0.2))
}

/// Rotary joints within their limits, from shares of their ranges.
fn joints_at(machine: &Machine, shares: [f64; 2]) -> [f64; 2] {
    let mut rotary_rad = [0.0; 2];
    for (k, &place) in machine.rotary().iter().enumerate() {
        let joint = machine.joint_at(place);
        let (min, max) = (joint.min.unwrap_or(-9.0), joint.max.unwrap_or(9.0));
        rotary_rad[k] = min + shares[k] * (max - min);
    }
    rotary_rad
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Where joints within their limits point the tool is reached, and turning there takes no longer than these joints take.
    #[test]
    fn what_joints_point_at_is_reached(
        machine in any_machine(),
        shares in prop::array::uniform2(prop::array::uniform2(0.0..1.0f64)),
        (about, angle) in (any_unit(), -3.0..3.0f64),
    ) {
        let part = UnitQuaternion::from_axis_angle(&about, angle);
        let joints = Orienting::new(&machine, &part);
        let [p, q] = shares.map(|s| joints_at(&machine, s));
        let [a, b] = [p, q].map(|at| part.inverse() * machine.axis_at(&at));
        prop_assert!(joints.reaches(&a) && joints.reaches(&b));
        prop_assert_eq!(joints.nearest(&a), a);
        let these_s = machine.rotary().iter().enumerate().map(|(k, &place)| {
            (p[k] - q[k]).abs() / machine.joint_at(place).drive.velocity_per_s
        });
        let these_s = these_s.fold(0.0, f64::max);
        let turn_s = joints.turn_s(&a, &b).unwrap();
        // Near a pole the outer angle of an axis is known to rounding over the distance from it.
        prop_assert!(turn_s <= these_s + 1e-6, "{} {turn_s} {these_s}", machine.name());
        let back_s = joints.turn_s(&b, &a).unwrap();
        prop_assert!((turn_s - back_s).abs() <= f64::EPSILON * turn_s);
        prop_assert!(joints.turn_s(&a, &a).unwrap() == 0.0);
    }

    /// What is called out of reach is: no joints within their limits come nearer than the nearest axis, which is reached.
    #[test]
    fn nothing_is_nearer_than_the_nearest(
        machine in any_machine(),
        limits in prop::array::uniform2((-170.0..20.0f64, 10.0..200.0f64)),
        wish in any_unit(),
        shares in prop::collection::vec(prop::array::uniform2(0.0..1.0f64), 200),
    ) {
        let mut spec: crate::machine::spec::MachineSpec =
            toml::from_str(crate::built_in_text(machine.name()).unwrap()).unwrap();
        let mut limits = limits.into_iter();
        for joint in &mut spec.joint {
            if let crate::machine::spec::JointSpec::Rotary { min_deg, max_deg, .. } = joint {
                let (min, range) = limits.next().unwrap();
                (*min_deg, *max_deg) = (Some(min), Some(min + range));
            }
        }
        let machine = Machine::from_spec(&spec).unwrap();
        let joints = standing(&machine);
        let nearest = joints.nearest(&wish);
        let off_rad = angle_between(&nearest, &wish);
        prop_assert!(joints.reaches(&wish) == (off_rad == 0.0));
        for shares in shares {
            let axis = machine.axis_at(&joints_at(&machine, shares));
            prop_assert!(angle_between(&axis, &wish) > off_rad - NEAR_BORDER_RAD, "{} {axis:?}", machine.name());
        }
        // A hair inside: on a limit itself rounding decides.
        let found = machine.orientations(&nearest).unwrap();
        let within = found.candidates().iter().any(|c| machine.rotary().iter().enumerate().all(|(k, &place)| {
            let joint = machine.joint_at(place);
            [-1.0, 0.0, 1.0].iter().any(|t| joint.excess(c.rotary_rad[k] + t * std::f64::consts::TAU) < 1e-6)
                || (k == 0 && found.pole_rad < 1e-6)
        }));
        prop_assert!(within, "{} {nearest:?}", machine.name());
    }
}
