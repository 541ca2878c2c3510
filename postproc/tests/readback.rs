//! NC text that this library did not write, and what a control makes of it.

use crate::common;

use common::pose;
use osculate_geom::{Severity, Vec3};
use osculate_postproc::conduct::{Expected, ExpectedTool, Grade};
use osculate_postproc::motion::program_time;
use osculate_postproc::nc::timing::time;
use osculate_postproc::readback::{ReadBack, ReadError, ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post};
use osculate_tools::cl::Motion;
use proptest::prelude::*;

fn machine(name: &str) -> Machine {
    Machine::built_in(name).expect("a built-in machine")
}

fn go(text: &str, dialect: Dialect, name: &str) -> Result<ReadBack, ReadError> {
    read(text, dialect, &machine(name), &Setup::default(), &ReadOptions::default())
}

fn tip(back: &ReadBack, want: [f64; 3]) {
    let got = back.moves[back.moves.len() - 1].pose.tip;
    assert!((got - osculate_geom::Point3::from(want)).norm() < 1e-9, "{got} is not {want:?}");
}

#[test]
fn units_increments_and_modal_words() {
    let back = go(
        "G21 G90\nG0 X0 Y0 Z5\nG1 Z0 F100\nX10\nY10 F200\nG91 X-5 Z1\nG90 G20 X1\nM2\nX99",
        Dialect::LinuxCnc,
        "3-axis",
    )
    .unwrap();
    tip(&back, [25.4, 10.0, 1.0]);
    assert_eq!(back.blocks.len(), 6);
    let times: Vec<f64> = back.blocks.iter().map(|b| b.time_min).collect();
    let want = [0.0, 5.0 / 100.0, 10.0 / 100.0, 10.0 / 200.0, 26f64.sqrt() / 200.0, 20.4 / 200.0];
    assert!(times.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-12), "{times:?}");
    assert_eq!(back.blocks.iter().map(|b| b.line).collect::<Vec<_>>(), [2, 3, 4, 5, 6, 7]);
    assert_eq!(back.moves[0].motion, Motion::Rapid);
    let Motion::Feed(f) = back.moves[1].motion else { panic!("a feed move") };
    assert!((f - 100.0).abs() < 1e-9);
}

/// Switching tool-centre-point control on leaves the machine where it is; X Y Z mean the tip from then on.
#[test]
fn switching_kinematics() {
    let text = "G21 G90 G94\nM429\nG0 A0 C90\nX10 Y0 Z0\nM428\nG1 X0 F100\nM30";
    let back = go(text, Dialect::LinuxCnc, "linuxcnc-xyzac").unwrap();
    // The table stands right-handed at 90 deg: joint X 10 is at the part's Y -10.
    let first = back.moves[0].pose.tip;
    assert!((first - osculate_geom::Point3::new(0.0, -10.0, 0.0)).norm() < 1e-12, "{first}");
    tip(&back, [0.0, -10.0, 0.0]);
    let text = text.replace("G1 X0", "G1 Y0");
    tip(&go(&text, Dialect::LinuxCnc, "linuxcnc-xyzac").unwrap(), [0.0; 3]);
}

/// A table turning by 180 deg under a tool at radius 50 cuts half a circle, though nothing else is programmed.
#[test]
fn a_turning_table_is_a_circle() {
    let text = "G90 G21 G94\nG0 X50 Y0 Z0 A0 C0\nG1 C180 F360\nM2";
    let back = go(text, Dialect::LinuxCnc, "linuxcnc-xyzac").unwrap();
    let half = 50.0 * std::f64::consts::PI;
    // Chords with a sagitta of 1e-4 at r = 50 miss a fraction of (4/3) sagitta / r of the length.
    assert!((back.blocks[1].tip_length_mm / half - 1.0).abs() < 3e-6, "{}", back.blocks[1].tip_length_mm);
    assert!(back.moves.iter().all(|m| (m.pose.tip.coords.norm() - 50.0).abs() < 1e-9));
    let far =
        back.moves.windows(2).map(|w| 50.0 - (w[0].pose.tip.coords + w[1].pose.tip.coords).norm() * 0.5);
    assert!(far.fold(0.0, f64::max) <= 1e-4);
    // Rotary axes alone: F is deg/min.
    assert!((back.blocks[1].time_min - 0.5).abs() < 1e-12);
}

/// Arcs in all planes and forms against their closed lengths and end points.
#[test]
fn arcs() {
    let full = std::f64::consts::TAU;
    let rows = [
        // Counter-clockwise quarter about the origin, by centre and by radius; the three-quarter arc by negative radius.
        ("G17 G3 X0 Y10 I-10 J0", [0.0, 10.0, 0.0], 10.0 * full / 4.0),
        ("G17 G3 X0 Y10 R10", [0.0, 10.0, 0.0], 10.0 * full / 4.0),
        ("G17 G3 X0 Y10 R-10", [0.0, 10.0, 0.0], 10.0 * full * 0.75),
        ("G17 G2 X0 Y10 I-10 J0", [0.0, 10.0, 0.0], 10.0 * full * 0.75),
        ("G17 G2 I-10", [10.0, 0.0, 0.0], 10.0 * full),
        // Counter-clockwise in G18 is from Z to X, so +X to +Z by the short way is clockwise.
        ("G18 G2 X0 Z10 I-10 K0", [0.0, 0.0, 10.0], 10.0 * full / 4.0),
        ("G18 G3 X0 Z10 I-10 K0", [0.0, 0.0, 10.0], 10.0 * full * 0.75),
        // A helix of one quarter and 3 mm.
        ("G17 G3 X0 Y10 Z3 I-10 J0", [0.0, 10.0, 3.0], (10.0 * full / 4.0f64).hypot(3.0)),
    ];
    for (words, end, length) in rows {
        let back =
            go(&format!("G90 G21\nG0 X10 Y0 Z0\n{words} F100\nM30"), Dialect::LinuxCnc, "3-axis").unwrap();
        tip(&back, end);
        let block = back.blocks[1];
        assert!((block.time_min - length / 100.0).abs() < 1e-12, "{words}: {} min", block.time_min);
        // Chords with a sagitta of 1e-4 at r = 10.
        assert!((block.tip_length_mm / length - 1.0).abs() < 2e-5, "{words}: {}", block.tip_length_mm);
        let off = |m: &osculate_postproc::readback::ReadMove| {
            let p = m.pose.tip;
            let (a, b) = if words.starts_with("G18") { (p.x, p.z) } else { (p.x, p.y) };
            // The larger arc by radius lies about (10, 10).
            let centre = if words.contains("R-") { 10.0 } else { 0.0 };
            ((a - centre).hypot(b - centre) - 10.0).abs()
        };
        assert!(back.moves.iter().map(off).fold(0.0, f64::max) < 1e-9, "{words}");
    }
    let e = go("G90\nG0 X0 Y0 Z0\nG2 X10 I1 F5", Dialect::LinuxCnc, "3-axis").unwrap_err();
    assert!(matches!(e, ReadError::Arc { line: 3, off_mm } if (off_mm - 8.0).abs() < 1e-12), "{e}");
    let e = go("G90\nG0 X0 Y0 Z0\nG2 X10 F5", Dialect::LinuxCnc, "3-axis").unwrap_err();
    assert!(matches!(e, ReadError::Word { line: 3, .. }), "{e}");
}

/// The control's reading of F on one block of 5 mm and 12 deg at F 1300, in every way it can be declared.
#[test]
fn readings_of_f() {
    let head = "G90 G710\nG0 X0 Y0 Z0 A0 C=DC(0)\n";
    let time = |words: &str| {
        let text = format!("{head}{words}\nN1 G1 X3 Y4 C=DC(12) F1300\nM30");
        let back = go(&text, Dialect::Sinumerik, "trunnion-ac").unwrap();
        back.blocks[1].time_min
    };
    let near = |got: f64, want: f64| assert!((got - want).abs() < 1e-9, "{got} is not {want}");
    near(time("G94"), 0.01);
    near(time("FGROUP(X,Y,Z,A,C) FGREF[A]=57.29577951 FGREF[C]=57.29577951"), 0.01);
    near(time("FGROUP(X,Y,Z)"), 5.0 / 1300.0);
    near(time("FGROUP(A,C)"), 12.0 / 1300.0);
    near(time("FGROUP(X,Y,Z,A,C) FGREF[C]=28.64788976"), 5f64.hypot(6.0) / 1300.0);
    near(time("G93"), 1.0 / 1300.0);
    near(time("S100 G95"), 0.01 / 100.0);
    // Switching deletes F: the block has its own, so only a missing one is an error.
    let text = format!("{head}F100\nG93\nG1 X1\nM30");
    let e = go(&text, Dialect::Sinumerik, "trunnion-ac").unwrap_err();
    assert!(matches!(e, ReadError::NoFeed { line: 5, .. }), "{e}");
    let text = format!("{head}G93\nG1 X1 F5\nX2\nM30");
    let e = go(&text, Dialect::Sinumerik, "trunnion-ac").unwrap_err();
    assert!(matches!(e, ReadError::NoFeed { line: 5, .. }), "{e}");
}

#[test]
fn shortest_way_of_endless_axes() {
    let text = "G90\nG0 X0 Y0 Z0 A0 C=DC(350)\nG1 C=DC(10) F100\nC=IC(-30)\nC=AC(355)\nM30";
    let back = go(text, Dialect::Sinumerik, "trunnion-ac").unwrap();
    let c = machine("trunnion-ac").joint_named("C").unwrap();
    let turns: Vec<f64> = back.blocks.iter().map(|b| b.to[c].to_degrees().round()).collect();
    assert_eq!(turns, [350.0, 370.0, 340.0, 355.0]);
}

#[test]
fn strict_and_lenient() {
    let cases = [
        ("G90\nG0 X0 Y0 Z0\nG6.2 X1 I1 F5\nM30", 3),
        ("G90\nG0 X0 Y0 Z0\nG5.2 X1\nM30", 3),
        ("G90\nG0 X0 Y0 Z0\nM98 P7\nM30", 3),
        ("G90\nG0 X0 Y0 Z0\nG1 X#5 F5\nM30", 3),
        ("G90\nG0 X0 Y0 Z0\nG1 W1 F5\nM30", 3),
    ];
    for (text, at) in cases {
        let e = go(text, Dialect::Fanuc, "3-axis").unwrap_err();
        assert!(
            matches!(e, ReadError::Word { line, .. } | ReadError::Syntax { line, .. } if line == at),
            "{text}: {e}"
        );
        let options = ReadOptions { strict: false, ..ReadOptions::default() };
        let back = read(text, Dialect::Fanuc, &machine("3-axis"), &Setup::default(), &options).unwrap();
        let lost =
            back.diagnostics.iter().any(|d| d.severity == Severity::Loss && d.place == format!("line {at}"));
        assert!(lost, "{text}: {:?}", back.diagnostics);
    }
    let none = go("(nothing)\nM30", Dialect::LinuxCnc, "3-axis");
    assert!(matches!(none, Err(ReadError::NoMoves { lines: 2, .. })));
    let half = go("G90 G0 X1 Y1\nG1 X2 F5\nG91 Z1", Dialect::LinuxCnc, "3-axis");
    assert!(matches!(half, Err(ReadError::Increment { line: 3, .. })));
    let silent = go("X1 Y1 Z1", Dialect::LinuxCnc, "3-axis");
    assert!(matches!(silent, Err(ReadError::NoFeed { line: 1, .. })));
}

/// Axes that a text never names are said to be taken at zero.
#[test]
fn unnamed_axes() {
    let back = go("G90 G21\nG0 X0 Y0 Z0\nG1 X5 F10\nM30", Dialect::LinuxCnc, "linuxcnc-xyzac").unwrap();
    assert_eq!(back.diagnostics.len(), 2);
    assert!(back.diagnostics.iter().all(|d| d.message.contains("never named")));
    tip(&back, [5.0, 0.0, 0.0]);
}

/// Z of the machine's own frame is zero at the top of the slide, 500 mm; the other joints stay.
#[test]
fn machine_coordinates_are_joints() {
    let text = "G90\nG0 X1 Y2 Z0\nG53 G0 Z-20\nG0 X5\nZ3\nG1 X6 F10\nM30";
    let back = go(text, Dialect::LinuxCnc, "3-axis").unwrap();
    assert_eq!(back.blocks.iter().map(|b| b.line).collect::<Vec<_>>(), [2, 3, 4, 5, 6]);
    assert!(back.blocks[1].rapid && back.blocks[1].own_frame && back.blocks[1].time_min > 0.0);
    let tips: Vec<[f64; 3]> = back.moves.iter().map(|m| m.pose.tip.coords.into()).collect();
    let want = [[1.0, 2.0, 0.0], [1.0, 2.0, 480.0], [5.0, 2.0, 480.0], [5.0, 2.0, 3.0], [6.0, 2.0, 3.0]];
    assert_eq!(tips, want);
    // Before anything else it makes Z known: the first place is up there.
    let text = "G90 G53 G0 Z0\nG0 X1 Y2\nZ3\nM30";
    let back = go(text, Dialect::Fanuc, "3-axis").unwrap();
    let tips: Vec<[f64; 3]> = back.moves.iter().map(|m| m.pose.tip.coords.into()).collect();
    assert_eq!(tips, [[1.0, 2.0, 500.0], [1.0, 2.0, 3.0]]);
}

/// With tool-centre-point control on and the table tilted, a retract is still one joint's, and X Y Z of the tip follow.
#[test]
fn machine_coordinates_with_tool_centre_point_control() {
    let text =
        "G90 G710\nG0 X1 Y2 Z3 A30 C=DC(40)\nTRAORI\nG0 SUPA Z-2950\nG91 G1 X1 F100\nTRAFOOF\nG90 X0\nM30";
    let m = machine("trunnion-ac");
    let setup = Setup::at(Vec3::new(5.0, -6.0, 7.0), 100.0);
    let back = read(text, Dialect::Sinumerik, &m, &setup, &ReadOptions::default()).unwrap();
    let place = |letter: &str| m.joint_named(letter).unwrap();
    let [first, up, along, ..] = back.blocks[..] else { panic!("{:?}", back.blocks) };
    let mut want = first.to;
    // The top of Z is at 3000 mm, where the nose is: the tip is a gauge length below it.
    want[place("Z")] = 3000.0 - 2950.0 - setup.gauge_length_mm;
    // Through the tip and back: the rounding of a few products of some 100 mm.
    let near = |a: &[f64; 5], b: &[f64; 5]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-11);
    assert!(near(&up.from, &first.to) && near(&up.to, &want), "{up:?}");
    let raised = back.moves.iter().rfind(|m| m.line == up.line).unwrap();
    assert!((raised.pose.tip - m.forward(&want, &setup).tip).norm() < 1e-9);
    // The next move starts there, along X of the part.
    let (a, b) = (m.forward(&along.from, &setup).tip, m.forward(&along.to, &setup).tip);
    assert!((a - raised.pose.tip).norm() < 1e-9 && ((b - a) - Vec3::x()).norm() < 1e-9, "{a} {b}");
    assert_eq!(along.to[place("A")], first.to[place("A")]);
}

/// Where home is says the machine file; where it does not, the place is lost until the axis is named again.
#[test]
fn home() {
    let text = "G90\nG0 X0 Y0 Z0\nG91 G28 Z10\nG90 G0 X5\nZ3\nG1 X6 F10\nM30";
    let back = go(text, Dialect::Fanuc, "3-axis").unwrap();
    assert_eq!(back.blocks.iter().map(|b| b.line).collect::<Vec<_>>(), [2, 3, 5, 6]);
    let toml = include_str!("../machines/3-axis.toml").replacen(
        "letter = \"Z\"",
        "letter = \"Z\"\nhome_mm = -50",
        1,
    );
    let told = Machine::from_toml(&toml).unwrap();
    let back = read(text, Dialect::Fanuc, &told, &Setup::default(), &ReadOptions::default()).unwrap();
    let tips: Vec<[f64; 3]> = back.moves.iter().map(|m| m.pose.tip.coords.into()).collect();
    assert_eq!(tips[..4], [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [0.0, 0.0, 450.0], [5.0, 0.0, 450.0]]);
}

/// Joints at their limits slow blocks down; the post says so, keeps the durations honest and stays in F's format.
#[test]
fn caps() {
    let m = machine("trunnion-ac");
    let swing = |i: u32| {
        pose(
            [0.01 * f64::from(i), 0.0, 0.0],
            [0.0, f64::from(i).to_radians().sin(), f64::from(i).to_radians().cos()],
        )
    };
    let path = common::path((5..60).map(swing), 1000.0);
    for feed in [FeedMode::Tcp, FeedMode::InverseTime, FeedMode::Kv { fgref_mm: None }, FeedMode::Kf] {
        let posted = post(&path, &m, &Setup::default(), &PostOptions::new(Dialect::Sinumerik, feed)).unwrap();
        let slow = posted.diagnostics.iter().find(|d| d.message.contains("joint A is at its greatest speed"));
        assert!(slow.is_some(), "{feed:?}: {:?}", posted.diagnostics);
        let back = go(&posted.text, Dialect::Sinumerik, "trunnion-ac").unwrap();
        // 54 deg at 180 deg/s against 0.54 mm at 1000 mm/min.
        let cutting: f64 = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum();
        assert!((cutting * 60.0 - 0.3).abs() < 1e-4, "{feed:?}: {} s", cutting * 60.0);
        let way = common::way_of(&path, &back, 1e-3);
        let time = program_time(&m, way.timed_moves());
        assert!((time.cutting_min / cutting - 1.0).abs() < 1e-4 && time.rapid_min == 0.0);
    }
    // Without correction F is as asked, and it is the machine that takes longer.
    let posted =
        post(&path, &m, &Setup::default(), &PostOptions::new(Dialect::Sinumerik, FeedMode::None)).unwrap();
    assert!(posted.text.contains(" F1000\n"));
    let text = include_str!("../machines/trunnion-ac.toml")
        .replace("largest_feed = 99999.0", "largest_feed = 500.0");
    let small = Machine::from_toml(&text).unwrap();
    let posted =
        post(&path, &small, &Setup::default(), &PostOptions::new(Dialect::Sinumerik, FeedMode::InverseTime))
            .unwrap();
    assert!(
        posted.diagnostics.iter().any(|d| d.message.contains("largest, 500")),
        "{:?}",
        posted.diagnostics
    );
    assert!(posted.text.contains(" F500\n"));
}

/// Three blocks of a millimetre each, a tenth of a second by their F: A turns at 180 degrees a second, C at 360.
#[test]
fn what_feed_moves_ask_of_joints() {
    let m = machine("trunnion-ac");
    let program = |last: &str| {
        format!(
            "TRAORI\nG0 X0 Y0 Z0 A0 C0\nG93\nG1 X1 A10 C20 F600\nX2 C60 F600\nX3 A46 F{last}\nG0 A0 C300\nM30"
        )
    };
    let demand = |text: &str, feed_mm_min: f64| {
        go(text, Dialect::Sinumerik, "trunnion-ac").unwrap().joint_demand(&m, feed_mm_min)
    };
    let d = demand(&program("600"), 600.0);
    let steps: Vec<_> = d.largest_steps.iter().map(|s| (s.letter.as_str(), s.line)).collect();
    assert_eq!(steps, [("C", 5), ("A", 6)]);
    for (step, deg) in d.largest_steps.iter().zip([40.0, 36.0]) {
        assert!((step.step_rad.to_degrees() - deg).abs() < 1e-9);
    }
    // Rapid moves are none of them. C needs 40 / 360 s in line 5, A 36 / 180 s in line 6.
    assert_eq!((d.blocks, d.slowed_blocks), (3, 2));
    let (line_5_s, line_6_s) = (40.0 / 360.0, 36.0 / 180.0);
    assert!((60.0 * d.slowed_min - line_5_s - line_6_s).abs() < 1e-9);
    assert!((d.slowed_share() - (line_5_s + line_6_s) / (0.1 + line_5_s + line_6_s)).abs() < 1e-9);
    let slowest = d.slowest.clone().unwrap();
    assert_eq!((slowest.letter.as_str(), slowest.line), ("A", 6));
    assert!((slowest.ratio - 2.0).abs() < 1e-9);
    // The same of the text's own F, and where F says already what A can do.
    let timed = time(&program("600"), Dialect::Sinumerik, &m, &Setup::default(), true).unwrap();
    assert_eq!((timed.joints.slowed_blocks, timed.joints.slowest.map(|s| s.line)), (2, Some(6)));
    let lowered = demand(&program("300"), 600.0);
    assert!((lowered.slowest.unwrap().ratio - 2.0).abs() < 1e-9 && lowered.slowed_blocks == 2);
    // At half the feed no joint is too slow.
    let half = demand(&program("300"), 300.0);
    assert_eq!((half.slowed_blocks, half.slowest.clone(), half.slowed_share()), (0, None, 0.0));
    // Without rotary joints there are no steps.
    let flat = go("G0 X0 Y0 Z0\nG1 X5 F100\nM30", Dialect::Fanuc, "3-axis").unwrap();
    let flat = flat.joint_demand(&machine("3-axis"), 100.0);
    assert!(flat.largest_steps.is_empty() && flat.blocks == 1 && flat.slowed_blocks == 0);
}

/// K_Z in a program: no F rises by more than the step.
#[test]
fn k_z_in_a_program() {
    let m = machine("trunnion-ac");
    let path = common::wave(40, 0.3);
    let options = |feed| PostOptions::new(Dialect::Sinumerik, feed);
    let feeds = |feed| {
        let posted = post(&path, &m, &Setup::at(Vec3::new(5.0, 0.0, 0.0), 0.0), &options(feed)).unwrap();
        let words = posted.text.split_whitespace().filter_map(|w| w.strip_prefix('F')?.parse::<f64>().ok());
        (words.collect::<Vec<f64>>(), posted.summary.time_min)
    };
    let (kv, fast) = feeds(FeedMode::Kv { fgref_mm: None });
    let (kz, slow) = feeds(FeedMode::Kz { step_mm_min: 5.0, fgref_mm: None });
    let rise = |f: &[f64]| f.windows(2).map(|w| w[1] - w[0]).fold(f64::MIN, f64::max);
    assert!(rise(&kv) > 10.0 && rise(&kz) < 5.0 + 1e-3, "{} {}", rise(&kv), rise(&kz));
    assert!(slow > fast);
    for what in ["step_mm_min", "fgref_mm"] {
        let fgref_mm = (what == "fgref_mm").then_some(f64::NAN);
        let bad = FeedMode::Kz { step_mm_min: if fgref_mm.is_some() { 1.0 } else { 0.0 }, fgref_mm };
        let e = post(&path, &m, &Setup::default(), &options(bad)).unwrap_err();
        assert!(e.to_string().contains(what), "{e}");
    }
}

#[test]
fn what_a_dialect_cannot_say() {
    let path = common::wave(5, 0.0);
    let e = post(
        &path,
        &machine("trunnion-ac"),
        &Setup::default(),
        &PostOptions::new(Dialect::Heidenhain, FeedMode::InverseTime),
    );
    assert!(e.unwrap_err().to_string().contains("inverse time"));
    let text = include_str!("../machines/trunnion-ac.toml").replace("letter = \"C\"", "letter = \"CA1\"");
    let long = Machine::from_toml(&text).unwrap();
    for dialect in [Dialect::Heidenhain, Dialect::Fanuc, Dialect::LinuxCnc] {
        let e = post(&path, &long, &Setup::default(), &PostOptions::new(dialect, FeedMode::Kf)).unwrap_err();
        assert!(e.to_string().contains("CA1"), "{e}");
    }
    let posted =
        post(&path, &long, &Setup::default(), &PostOptions::new(Dialect::Sinumerik, FeedMode::Kf)).unwrap();
    assert!(posted.text.contains("CA1=DC("));
    let back =
        read(&posted.text, Dialect::Sinumerik, &long, &Setup::default(), &ReadOptions::default()).unwrap();
    assert!(back.diagnostics.is_empty() && back.moves.len() > 5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Nothing that a line may hold makes the reader panic.
    #[test]
    fn any_text(text in "[A-Z0-9=.()\\[\\] ;#/+\\-\n]{0,120}", which in 0..4usize, strict in any::<bool>()) {
        let options = ReadOptions { strict, ..ReadOptions::default() };
        let text = format!("G90 G94 F100\nG0 X0 Y0 Z0 A0 C0\nG1 {text}");
        if let Ok(back) = read(&text, Dialect::ALL[which], &machine("trunnion-ac"), &Setup::default(), &options) {
            let tool = ExpectedTool::new(1, 0.0);
            let conduct = back.conduct(&Expected::new(tool, Some(8000.0), 0.01));
            // None of these programs starts the spindle as the job means it.
            prop_assert!(conduct.worst() == Some(Grade::Breaks) || back.blocks.iter().all(|b| b.rapid));
        }
    }
}

/// `A3= B3= C3=` point the tool; the rotary axes follow by the nearest way, and the tip stays on its words.
#[test]
fn tool_directions_as_vectors() {
    let m = machine("trunnion-ac");
    let text = "G90 G710\nTRAORI\nORIWKS\nCYCLE832(0.002,1,1)\nG0 X0 Y0 Z50 A3=0 B3=0.3 C3=1\n\
                G1 X10 A3=0.1 B3=0.3 C3=1 F800\nX20 A3=0.2 B3=0.3 C3=1\nTRAFOOF\nM30\n";
    let back = read(text, Dialect::Sinumerik, &m, &Setup::default(), &ReadOptions::default()).unwrap();
    tip(&back, [20.0, 0.0, 50.0]);
    let want = Vec3::new(0.2, 0.3, 1.0).normalize();
    let end = back.moves[back.moves.len() - 1].pose;
    assert!((end.axis.into_inner() - want).norm() < 1e-12);
    assert!(back.diagnostics.is_empty(), "{:?}", back.diagnostics);
    // Without the transformation the words point nowhere.
    let text = text.replace("TRAORI\n", "");
    let refused =
        read(&text, Dialect::Sinumerik, &m, &Setup::default(), &ReadOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("line 4"), "{refused}");
}
