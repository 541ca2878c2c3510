//! Poses and axes against values of other solvers, and laws on random machines.

use osculate_geom::{Point3, Unit3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::machine::spec::{CarriedSide, FeedReading, JointSpec, Sense, TcpWords};

fn setup() -> Setup {
    Setup::default()
}

/// Joint values by letter; rotary in degrees.
fn values(machine: &Machine, by_letter: &[(&str, f64)]) -> JointValues {
    let mut q = [0.0; MAX_JOINTS];
    for (letter, value) in by_letter {
        let place = machine.joint_named(letter).unwrap();
        q[place] = match machine.joints()[place].kind {
            JointKind::Linear => *value,
            JointKind::Rotary => value.to_radians(),
        };
    }
    q
}

fn near(got: &Point3, want: [f64; 3], tol: f64) {
    let d = (got - Point3::from(want)).norm();
    assert!(d < tol, "{got} is {d:.2e} from {want:?}");
}

/// The joints of LinuxCNC's own modules for a tip in the part's frame, all offsets zero (six decimals printed).
#[test]
fn linuxcnc_modules() {
    let ac = Machine::built_in("linuxcnc-xyzac").unwrap();
    let bc = Machine::built_in("linuxcnc-xyzbc").unwrap();
    let rows = [
        (&ac, "A", [10.0, 20.0, 30.0], 30.0, 40.0, [-5.195308, 3.834983, 36.855145]),
        (&ac, "A", [20.0, 5.0, 4.0], 15.0, 25.0, [16.013064, 11.506212, 7.224185]),
        (&bc, "B", [10.0, 20.0, 30.0], 30.0, 40.0, [10.500731, 21.748765, 28.578416]),
    ];
    for (machine, tilt, tip, a, c, [x, y, z]) in rows {
        let q = values(machine, &[("X", x), ("Y", y), ("Z", z), (tilt, a), ("C", c)]);
        near(&machine.forward(&q, &setup()).tip, tip, 2e-6);
        let pose = machine.forward(&q, &setup());
        let back = machine.inverse(&pose, &setup()).unwrap();
        assert!(
            back.iter().any(|b| b.iter().zip(&q).all(|(g, w)| (g - w).abs() < 1e-9)),
            "{back:?} has no {q:?}"
        );
    }
}

/// The same module with its tilt axis at y -7, z 20 and a tool of 80: its pose and joints are those of the spindle
/// nose, ours those of the tip, 80 mm below at zero.
#[test]
fn offsets_of_a_linuxcnc_table() {
    let text = include_str!("../../machines/linuxcnc-xyzac.toml");
    let mut spec: MachineSpec = toml::from_str(text).unwrap();
    for joint in &mut spec.joint {
        if let JointSpec::Rotary { letter, point_mm, .. } = joint
            && letter == "A"
        {
            *point_mm = [0.0, -7.0, 20.0];
        }
    }
    let machine = Machine::from_spec(&spec).unwrap();
    let at = Setup::at(Vec3::zeros(), 80.0);
    let q = values(
        &machine,
        &[("X", -5.195308), ("Y", 52.897161), ("Z", 53.752604 - 80.0), ("A", 30.0), ("C", 40.0)],
    );
    near(&machine.forward(&q, &at).tip, [10.0, 20.0, 30.0 - 80.0], 2e-6);
}

/// Tables of the LinuxCNC sense and heads of the ISO sense on one axis; four or five decimals printed.
#[test]
fn orientations_of_known_machines() {
    let axis = Unit3::new_normalize(Vec3::new(0.3, -0.4, 0.866025));
    // Rotary joints as (inner, outer), deg.
    let rows = [
        ("linuxcnc-xyzac", 1.0, [(-30.0, -36.8699), (30.0, 143.1301)]),
        ("linuxcnc-xyzbc", 1.0, [(-30.0, 53.1301), (30.0, -126.8699)]),
        ("trunnion-ac", -1.0, [(-30.0, -36.8699), (30.0, 143.1301)]),
        ("trunnion-bc", -1.0, [(-30.0, 53.1301), (30.0, -126.8699)]),
        ("head-ca", 1.0, [(30.0, 36.8699), (-30.0, -143.1301)]),
    ];
    for (name, sign, wanted) in rows {
        check_axis(&Machine::built_in(name).unwrap(), &axis, &wanted.map(|(i, o)| (sign * i, sign * o)));
    }
    // The printed nutated machine has a table that turns right-handed; the built-in one is ISO.
    let nutated = Machine::built_in("nutated-b-table-c").unwrap();
    check_axis(&nutated, &axis, &[(42.9414, -68.6724), (-42.9414, 142.4122)]);
    let below = Unit3::new_normalize(Vec3::new(0.6, 0.0, -0.8));
    let off = nutated.orientations(&below).unwrap_err().off_rad;
    // All axes up to 90 deg from Z can be reached; this one is acos(-0.8) away.
    assert!((off - ((-0.8f64).acos() - 0.5 * std::f64::consts::PI)).abs() < 1e-12);
}

fn check_axis(machine: &Machine, axis: &Unit3, wanted: &[(f64, f64)]) {
    let found = machine.orientations(axis).unwrap();
    for (inner, outer) in wanted {
        let hit = found.candidates().iter().any(|c| {
            // Half a unit in the fourth decimal, plus what the six digits of the axis (not of unit length) leave.
            let same =
                |got: f64, want: f64| (nearest_turn(got, want.to_radians()).to_degrees() - want).abs() < 2e-4;
            same(c.rotary_rad[1], *inner) && same(c.rotary_rad[0], *outer)
        });
        assert!(hit, "{}: {:?} has no ({inner}, {outer})", machine.name(), found.candidates());
    }
}

#[test]
fn a_fork_head_keeps_the_tip_in_place_of_the_pivot() {
    let machine = Machine::built_in("head-ca").unwrap();
    let at = Setup::at(Vec3::zeros(), 100.0);
    // Pivot 250 mm above the tip; A = 90 deg swings the tool axis from +Z to -Y, so the tip goes 250 up and 250 to +Y.
    let pose = machine.forward(&values(&machine, &[("A", 90.0)]), &at);
    near(&pose.tip, [0.0, 250.0, 250.0], 1e-10);
    assert!((pose.axis.into_inner() + Vec3::y()).norm() < 1e-12);
}

#[test]
fn a_part_placed_on_the_table() {
    let machine = Machine::built_in("3-axis").unwrap();
    let turn = nalgebra::UnitQuaternion::from_axis_angle(&Vec3::z_axis(), std::f64::consts::FRAC_PI_2);
    let part_zero = nalgebra::Isometry3::from_parts(nalgebra::Translation3::new(100.0, 0.0, 0.0), turn);
    let at = Setup { part_zero, gauge_length_mm: 0.0 };
    // Joint (100, 5, 0) is 5 mm along the part's X, which points along machine Y.
    near(&machine.forward(&values(&machine, &[("X", 100.0), ("Y", 5.0)]), &at).tip, [5.0, 0.0, 0.0], 1e-12);
    let tilted = Unit3::new_normalize(Vec3::new(0.1, 0.0, 1.0));
    assert!((machine.orientations(&tilted).unwrap_err().off_rad - 0.1f64.atan()).abs() < 1e-12);
}

#[test]
fn every_built_in_file_is_a_machine() {
    for name in built_in_names() {
        assert_eq!(Machine::built_in(name).unwrap().name(), name);
    }
    let Err(MachineError::Unknown { known, .. }) = Machine::built_in("lathe") else { panic!("a lathe?") };
    assert!(known.contains("trunnion-ac"));
}

#[test]
fn files_that_are_no_machines() {
    let good = include_str!("../../machines/trunnion-ac.toml");
    let change = |from: &str, to: &str| {
        assert!(good.contains(from));
        Machine::from_toml(&good.replacen(from, to, 1)).unwrap_err()
    };
    assert!(matches!(change("format = 1", "format = 2"), MachineError::Format { got: 2 }));
    assert!(matches!(change("letter = \"C\"", "letter = \"G\""), MachineError::Letter { .. }));
    assert!(matches!(change("letter = \"C\"", "letter = \"A\""), MachineError::Letter { .. }));
    assert!(matches!(change("side = \"table\"", "side = \"head\""), MachineError::Order { .. }));
    assert!(matches!(change("direction = [0, 0, 1]", "direction = [0, 0, 0]"), MachineError::Value { .. }));
    // Numbers that no machine has, each with its line.
    for (from, to, says) in [
        ("max_velocity_deg_s = 360", "max_velocity_deg_s = 0", "is 0.0: a number from 1e-3 to 1e6 is wanted"),
        ("max_velocity_mm_s = 500", "max_velocity_mm_s = 1e-308", "of joint X is 1e-308: "),
        ("max_velocity_mm_s = 500", "max_velocity_mm_s = nan", "of joint X is NaN"),
        (
            "max_acceleration_mm_s2 = 4000",
            "max_acceleration_mm_s2 = 1e300",
            "a number from 1e-3 to 1e9 is wanted",
        ),
        (
            "max_jerk_mm_s3 = 50000",
            "max_jerk_mm_s3 = -1",
            "of joint X is -1.0: a number from 1e-2 to 1e12 is wanted",
        ),
        (
            "min_deg = -120",
            "min_deg = -1e12",
            "min_deg of joint A is -1000000000000.0: a number from -1e9 to 1e9",
        ),
        (
            "min_deg = -120",
            "min_deg = 130",
            "min_deg of joint A is 130.0: it must be smaller than max_deg, which is 120.0",
        ),
    ] {
        let e = change(from, to);
        let line = 1 + good.lines().position(|l| l == from).expect("it stands on a line of its own");
        let told = e.to_string();
        assert!(told.starts_with(&format!("line {line}: ")) && told.contains(says), "{told}");
    }
    assert!(matches!(
        change("direction = [0, 1, 0]", "direction = [1, 0, 0]"),
        MachineError::LinearDependent { .. }
    ));
    assert!(matches!(change("kind = \"rotary\"", "kind = \"spherical\""), MachineError::Toml(_)));
    assert!(matches!(change("format = 1", "format = 1\ncolour = \"red\""), MachineError::Toml(_)));
    let parallel = change(
        "letter = \"C\"\nside = \"table\"\ndirection = [0, 0, 1]",
        "letter = \"C\"\nside = \"table\"\ndirection = [1, 0, 0]",
    );
    assert!(matches!(parallel, MachineError::Orientation(TwoAxisError::ParallelAxes { .. })), "{parallel}");
    let along = change(
        "letter = \"A\"\nside = \"table\"\ndirection = [1, 0, 0]",
        "letter = \"A\"\nside = \"table\"\ndirection = [0, 0, -1]",
    );
    assert!(matches!(along, MachineError::Orientation(_)), "{along}");
}

fn unit() -> impl Strategy<Value = Unit3> {
    [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_filter_map("too short", |v| Unit3::try_new(Vec3::from(v), 0.2))
}

/// A machine with any two rotary axes, each on either side of the bed, and a random sense.
fn random_machine() -> impl Strategy<Value = Machine> {
    (unit(), unit(), prop::array::uniform6(-50.0..50.0f64), 0..3usize, any::<[bool; 2]>()).prop_filter_map(
        "parallel axes",
        |(outer, inner, p, heads, senses)| {
            let rotary =
                |letter: &str, d: &Unit3, p: [f64; 3], head: bool, opposite: bool| JointSpec::Rotary {
                    letter: letter.into(),
                    side: if head { CarriedSide::Head } else { CarriedSide::Table },
                    direction: [d.x, d.y, d.z],
                    point_mm: p,
                    sense: if opposite { Sense::Opposite } else { Sense::Iso },
                    min_deg: None,
                    max_deg: None,
                    max_velocity_deg_s: 100.0,
                    max_acceleration_deg_s2: 1000.0,
                    max_jerk_deg_s3: None,
                    decimals: 4,
                };
            let linear = |letter: &str, direction: [f64; 3]| JointSpec::Linear {
                letter: letter.into(),
                side: CarriedSide::Head,
                direction,
                sense: Sense::Iso,
                min_mm: None,
                max_mm: None,
                machine_zero_mm: None,
                retract_mm: None,
                home_mm: None,
                max_velocity_mm_s: 100.0,
                max_acceleration_mm_s2: 1000.0,
                max_jerk_mm_s3: None,
                decimals: 4,
            };
            let slides =
                [linear("X", [1.0, 0.0, 0.0]), linear("Y", [0.0, 1.0, 0.0]), linear("Z", [0.0, 0.0, 1.0])];
            let b = rotary("C", &outer, [p[0], p[1], p[2]], heads > 1, senses[0]);
            let a = rotary("A", &inner, [p[3], p[4], p[5]], heads > 0, senses[1]);
            let slides = slides.into_iter();
            let joint = match heads {
                0 => [b, a].into_iter().chain(slides).collect(),
                1 => std::iter::once(b).chain(slides).chain([a]).collect(),
                _ => slides.chain([b, a]).collect(),
            };
            let control = ControlSpec {
                feed_reading: FeedReading::Linear,
                largest_feed: 1e5,
                max_path_velocity_mm_s: None,
                linuxcnc_tcp: Some(TcpWords { on: "M428".into(), off: "M429".into() }),
            };
            let spec = MachineSpec {
                format: 1,
                name: "random".into(),
                description: String::new(),
                tool_axis: [0.0, 0.0, 1.0],
                control,
                joint,
                body: Vec::new(),
            };
            // Axes that nearly close are refused by the machine or ill-conditioned by nature.
            (outer.cross(&inner).norm() > 0.1 && inner.cross(&Vec3::z()).norm() > 0.1)
                .then(|| Machine::from_spec(&spec).unwrap())
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Inverse after forward finds the joints again, and every candidate gives the pose.
    #[test]
    fn inverse_after_forward(
        machine in random_machine(),
        linear in prop::array::uniform3(-200.0..200.0f64),
        angles in prop::array::uniform2(-3.1..3.1f64),
        gauge in 0.0..200.0f64,
        part in prop::array::uniform3(-100.0..100.0f64),
    ) {
        let at = Setup::at(Vec3::from(part), gauge);
        let mut q = [0.0; MAX_JOINTS];
        for (place, v) in machine.linear().into_iter().zip(linear) {
            q[place] = v;
        }
        for (place, v) in machine.rotary().iter().zip(angles) {
            q[*place] = v;
        }
        let pose = machine.forward(&q, &at);
        let found = machine.inverse(&pose, &at).unwrap();
        prop_assert_eq!(found.len(), 2);
        for candidate in &found {
            let again = machine.forward(candidate, &at);
            // Axis: rounding grows with the square root near the border of the reachable cone, where the two
            // branches meet: sqrt(2.2e-16) = 1.5e-8. The tip is solved for the angles found and stays at rounding.
            prop_assert!((again.tip - pose.tip).norm() < 1e-9, "tip off by {}", (again.tip - pose.tip).norm());
            prop_assert!(angle_between(&again.axis, &pose.axis) < 1e-7);
        }
        let pole = machine.orientations(&at.to_table(&pose).axis).unwrap().pole_rad;
        // Near a pole the outer angle is anything; near the border both branches are one to 1e-7.
        if pole > 1e-3 {
            let hit = found.iter().any(|c| {
                machine.rotary().iter().all(|&p| (nearest_turn(c[p], q[p]) - q[p]).abs() < 1e-5)
            });
            prop_assert!(hit, "{found:?} has no {q:?}");
        }
    }

    /// The nose is a gauge length up the axis from the tip, wherever the rotary joints stand.
    #[test]
    fn slides_carry_the_nose(
        machine in random_machine(),
        linear in prop::array::uniform3(-200.0..200.0f64),
        angles in prop::array::uniform2(-3.1..3.1f64),
        gauge in 0.0..200.0f64,
    ) {
        let mut words = [0.0; MAX_JOINTS];
        for (place, v) in machine.linear().into_iter().zip(linear) {
            words[place] = v;
        }
        for (place, v) in machine.rotary().iter().zip(angles) {
            words[*place] = v;
        }
        let mut slides = words;
        for (place, joint) in machine.joints().iter().enumerate() {
            slides[place] = joint.at_nose(words[place], gauge);
            prop_assert!((joint.word_at(slides[place], gauge) - words[place]).abs() < 1e-12);
        }
        // Without a tool the tip is the nose.
        let (bare, held) = (Setup::at(Vec3::zeros(), 0.0), Setup::at(Vec3::zeros(), gauge));
        let (nose, tip) = (machine.forward(&slides, &bare), machine.forward(&words, &held));
        prop_assert!((nose.tip - tip.tip - tip.axis.into_inner() * gauge).norm() < 1e-9, "{nose:?} {tip:?}");
        // What the last joint carries is the spindle.
        let spindle = frames(machine.joints(), &slides)[machine.joints().len()];
        prop_assert!((spindle * Point3::origin() - nose.tip).norm() < 1e-9);
        prop_assert!((spindle * machine.tool_axis().into_inner() - nose.axis.into_inner()).norm() < 1e-12);
    }

    /// What is called unreachable is: the reported angle leads exactly to the border.
    #[test]
    fn unreachable_axes(machine in random_machine(), wanted in unit()) {
        let pair = machine.pair().unwrap();
        match pair.solve(&wanted) {
            Ok(found) => for angles in found.branches {
                prop_assert!(angle_between(&pair.axis(&angles), &wanted) < 2e-7);
            },
            Err(e) => {
                // Turned towards or away from the pole by the angle reported, one of the two ways reaches.
                let across = Unit3::new_normalize(pair.pole().cross(&wanted));
                let off = e.off_rad;
                let toward = [off, -off].map(|a| Unit3::new_normalize(two_axis::rotate(&across, a, &wanted)));
                prop_assert!(toward.iter().any(|w| pair.solve(w).is_ok()));
                let short = [0.9 * off, -0.9 * off].map(|a| Unit3::new_normalize(two_axis::rotate(&across, a, &wanted)));
                prop_assert!(off < 1e-6 || short.iter().all(|w| pair.solve(w).is_err()));
            }
        }
    }
}
