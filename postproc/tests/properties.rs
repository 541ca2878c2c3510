//! Laws for random machines: durations under the control's own reading of F, and text that is no program.

use crate::common;

use osculate_geom::{Unit3, Vec3};
use osculate_postproc::machine::spec::{
    CarriedSide, ControlSpec, FeedReading, JointSpec, MachineSpec, Sense,
};
use osculate_postproc::nc::timing::time;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post};
use osculate_tools::cl::Motion;
use proptest::prelude::*;

fn linear(letter: &str, direction: [f64; 3], side: CarriedSide) -> JointSpec {
    JointSpec::Linear {
        letter: letter.into(),
        side,
        direction,
        sense: Sense::Iso,
        min_mm: None,
        max_mm: None,
        machine_zero_mm: None,
        home_mm: None,
        retract_mm: None,
        // Fast enough that no block is slowed.
        max_velocity_mm_s: 1e5,
        max_acceleration_mm_s2: 1e6,
        max_jerk_mm_s3: None,
        decimals: 4,
    }
}

fn rotary(letter: &str, direction: Unit3, side: CarriedSide, sense: Sense) -> JointSpec {
    JointSpec::Rotary {
        letter: letter.into(),
        side,
        direction: direction.into_inner().into(),
        point_mm: [3.0, -2.0, 7.0],
        sense,
        min_deg: None,
        max_deg: None,
        max_velocity_deg_s: 1e6,
        max_acceleration_deg_s2: 1e7,
        max_jerk_deg_s3: None,
        decimals: 4,
    }
}

fn unit() -> impl Strategy<Value = Unit3> {
    prop::array::uniform3(-1.0..1.0f64)
        .prop_filter_map("too short for a direction", |v| Unit3::try_new(Vec3::from(v), 0.2))
}

/// Any two axis directions, both senses, tables and heads, any reading of F.
fn machine() -> impl Strategy<Value = Machine> {
    let reading = prop_oneof![
        Just(FeedReading::Linear),
        (5.0..100.0f64).prop_map(|radius_mm| FeedReading::Arc { radius_mm }),
        Just(FeedReading::RotaryOnly),
    ];
    (unit(), unit(), 0..3usize, prop::bool::ANY, reading).prop_filter_map(
        "axes that nearly close are ill-conditioned by nature",
        |(outer, inner, heads, opposite, feed_reading)| {
            let side = |head: bool| if head { CarriedSide::Head } else { CarriedSide::Table };
            let sense = if opposite { Sense::Opposite } else { Sense::Iso };
            let b = rotary("C", outer, side(heads > 1), sense);
            let a = rotary("A", inner, side(heads > 0), Sense::Iso);
            let slide = |l, d| linear(l, d, CarriedSide::Head);
            let slides =
                [slide("X", [1.0, 0.0, 0.0]), slide("Y", [0.0, 1.0, 0.0]), slide("Z", [0.0, 0.0, 1.0])];
            let joint = match heads {
                0 => [b, a].into_iter().chain(slides).collect(),
                1 => std::iter::once(b).chain(slides).chain([a]).collect(),
                _ => slides.into_iter().chain([b, a]).collect(),
            };
            let fine = outer.cross(&inner).norm() > 0.5 && inner.cross(&Vec3::z()).norm() > 0.5;
            let spec = MachineSpec {
                format: 1,
                name: "random".into(),
                description: String::new(),
                tool_axis: [0.0, 0.0, 1.0],
                control: ControlSpec {
                    feed_reading,
                    largest_feed: 1e9,
                    max_path_velocity_mm_s: None,
                    linuxcnc_tcp: None,
                },
                joint,
                body: Vec::new(),
            };
            fine.then(|| Machine::from_spec(&spec)).and_then(Result::ok)
        },
    )
}

/// The mode that is right for a reading of F.
fn right(machine: &Machine) -> FeedMode {
    match machine.control().feed_reading {
        FeedReading::Linear => FeedMode::Kf,
        FeedReading::Arc { radius_mm } => FeedMode::Kv { fgref_mm: Some(radius_mm) },
        FeedReading::RotaryOnly => FeedMode::RotaryOnly,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// T = L_CL / F0 for every block, as the control reads F: in the right mode and in inverse time.
    #[test]
    fn every_block_takes_its_time(machine in machine(), inverse in prop::bool::ANY, phase in 0.0..6.0f64) {
        // Poses near the machine's own tool axis at some rotary place: always within reach.
        let setup = Setup::at(Vec3::new(11.0, -5.0, 20.0), 70.0);
        let at = |i: u32| {
            let t = f64::from(i) / 12.0;
            let mut q = [0.0; 5];
            for (k, place) in machine.rotary().iter().enumerate() {
                q[*place] = 0.8 + 0.3 * (phase + t + k as f64).sin();
            }
            for (k, place) in machine.linear().iter().enumerate() {
                q[*place] = 30.0 * (t + 2.0 * k as f64).sin();
            }
            machine.forward(&q, &setup)
        };
        let path = common::path((0..13).map(at), 700.0);
        let feed = if inverse { FeedMode::InverseTime } else { right(&machine) };
        let posted = post(&path, &machine, &setup, &PostOptions::new(Dialect::Fanuc, feed));
        // Some paths run through a pole; that is for other tests.
        prop_assume!(posted.is_ok());
        let posted = posted.expect("asked above");
        prop_assume!(posted.summary.rewinds == 0);
        let back = read(&posted.text, Dialect::Fanuc, &machine, &setup, &ReadOptions::default())
            .expect("our own text");
        for block in back.blocks.iter().filter(|b| !b.rapid) {
            let asked_mm = block.time_min * 700.0;
            // Rounding of both ends to 1e-4 mm and deg at up to 300 mm from the axes, seven digits of F, and 2 um
            // of chord.
            let tol = 2.0 * (1e-4 * 3f64.sqrt() + 300.0 * 2.0 * 1e-4f64.to_radians()) + 0.002 + 1e-6 * asked_mm;
            prop_assert!(
                (asked_mm - block.tip_length_mm).abs() <= tol,
                "line {}: {asked_mm} for {}", block.line, block.tip_length_mm
            );
        }
        let cl_mm: f64 = path.moves.windows(2).map(|w| (w[1].pose.tip - w[0].pose.tip).norm()).sum();
        let minutes: f64 = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum();
        prop_assert!((minutes * 700.0 / cl_mm - 1.0).abs() < 1e-3);
    }

    /// No text makes the readers panic or run away, and what is not understood comes with its line.
    #[test]
    fn any_text_is_answered(
        lines in prop::collection::vec("[GMXYZABCFSNTLRIJKQPHDO%;/()=\\[\\]\"0-9.+# -]{0,24}", 0..30),
        which in 0..4usize,
    ) {
        let text = lines.join("\n");
        let machine = Machine::built_in("linuxcnc-xyzac").expect("built in");
        let dialect = Dialect::ALL[which];
        let setup = Setup::default();
        if let Ok(timed) = time(&text, dialect, &machine, &setup, false) {
            prop_assert!(timed.time.time_min() >= 0.0);
            for d in &timed.diagnostics {
                let said = d.to_string();
                prop_assert!(said.contains("line ") || said.contains("program"), "{}", said);
            }
        }
        // Strictness and apt text: an answer of either kind will do.
        let _ = read(&text, dialect, &machine, &setup, &ReadOptions::default());
        let _ = cldata::read(&text.replace('G', "GOTO/").replace('F', "FEDRAT/"));
    }
}

/// The fastest program keeps to the joints: read back, no joint is asked for more than its speed, and with a cap the
/// tip's feed stays below it.
#[test]
fn the_fastest_program_is_one_that_the_joints_follow() {
    let machine = Machine::built_in("mill-turn-xyzc").expect("built in");
    let setup = Setup::at(Vec3::new(0.0, 0.0, 200.0), 60.0);
    let path = common::blade::mill_turn(1, 500.0);
    let mut before = f64::INFINITY;
    for cap in [Some(500.0), Some(2000.0), None] {
        let feed = FeedMode::Fastest { tip_mm_min: cap };
        let posted = post(&path, &machine, &setup, &PostOptions::new(Dialect::Fanuc, feed)).expect("posts");
        let back =
            read(&posted.text, Dialect::Fanuc, &machine, &setup, &ReadOptions::default()).expect("reads");
        for b in back.blocks.iter().filter(|b| !b.rapid) {
            for (joint, (from, to)) in machine.joints().iter().zip(b.from.iter().zip(b.to)) {
                let speed = (to - from).abs() / (60.0 * b.time_min);
                // A part in a thousand for the rounding of short blocks.
                assert!(speed <= joint.drive.velocity_per_s * 1.001 + 1e-3, "{} at {speed}", joint.letter);
            }
            let slack = 4e-4 + 1e-6 * b.tip_length_mm;
            let most = cap.unwrap_or(f64::INFINITY);
            assert!(b.tip_length_mm - slack <= most * b.time_min, "line {}", b.line);
        }
        let total = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum::<f64>();
        assert!(total < before);
        before = total;
        assert!(matches!(path.moves[1].motion, Motion::Feed(_)));
    }
}
