//! Where the tool points, in other words than joints: directions and tilted planes, written and read back.

use crate::common;

use common::{angle, path, pose, wave};
use osculate_geom::{Point3, Vec3};
use osculate_postproc::readback::{ReadBack, ReadError, ReadOptions, read};
use osculate_postproc::{
    Dialect, FeedMode, Machine, Orientation, PostError, PostOptions, Posted, Setup, post,
};
use osculate_tools::cl::{ClMove, ClPath, Motion};

const DIALECTS: [Dialect; 3] = [Dialect::Sinumerik, Dialect::Heidenhain, Dialect::Fanuc];

fn options(dialect: Dialect, orientation: Orientation) -> PostOptions {
    PostOptions { orientation, ..PostOptions::new(dialect, FeedMode::Tcp) }
}

fn there_and_back(
    path: &ClPath,
    machine: &Machine,
    setup: &Setup,
    dialect: Dialect,
    orientation: Orientation,
) -> (Posted, ReadBack) {
    let posted = post(path, machine, setup, &options(dialect, orientation)).expect("posts");
    let back = read(&posted.text, dialect, machine, setup, &ReadOptions::default()).expect("our own text");
    assert!(back.diagnostics.is_empty(), "{:?}", back.diagnostics);
    (posted, back)
}

/// Every CL point is met in order, within half a count on three axes and the given angle.
fn meets(path: &ClPath, back: &ReadBack, (tip_mm, axis_rad): (f64, f64), name: &str) {
    let mut at = 0;
    for (i, m) in path.moves.iter().enumerate() {
        // The first one is reached by joints, in counts of 1e-4 deg.
        let axis_rad = if i == 0 { axis_rad.max(1e-4f64.to_radians()) } else { axis_rad };
        let near = |r: &osculate_postproc::readback::ReadMove| {
            (r.pose.tip - m.pose.tip).norm() <= tip_mm && angle(&r.pose.axis, &m.pose.axis) <= axis_rad
        };
        let hit = back.moves[at..].iter().position(near);
        at += hit.unwrap_or_else(|| panic!("{name}: CL point {i} is not met after {at}"));
    }
}

#[test]
fn directions_come_back() {
    let path = wave(40, 0.3);
    let setup = Setup::at(Vec3::new(12.0, -7.0, 30.0), 90.0);
    for dialect in DIALECTS {
        for name in ["trunnion-ac", "trunnion-bc", "head-ca", "head-b-table-c", "nutated-b-table-c"] {
            let machine = Machine::built_in(name).expect("built in");
            let (posted, back) = there_and_back(&path, &machine, &setup, dialect, Orientation::Vectors);
            let name = format!("{dialect} {name}");
            // Half a count of 1e-4 mm on three axes, of 1e-7 on three components.
            meets(&path, &back, (0.5e-4 * 3f64.sqrt() + 1e-9, 1e-7), &name);
            let word = match dialect {
                Dialect::Sinumerik => "ORIWKS ORIVECT",
                Dialect::Heidenhain => " TX",
                _ => "G43.5 H1",
            };
            assert!(posted.text.contains(word), "{name}");
            // The same way with joints takes the same time.
            let (_, joints) = there_and_back(&path, &machine, &setup, dialect, Orientation::Joints);
            assert!((back.time_min() / joints.time_min() - 1.0).abs() < 1e-3, "{name}");
        }
    }
}

/// Three positions, the tool upright between them, a line in each.
fn three_positions() -> ClPath {
    let axes = [[0.0, 0.3, 1.0], [0.4, -0.2, 1.0], [0.0, 0.0, 1.0]];
    let mut moves = Vec::new();
    for (k, axis) in axes.into_iter().enumerate() {
        let x = 20.0 * k as f64;
        for (tip, motion) in [
            ([x, 0.0, 40.0], Motion::Rapid),
            ([x, 0.0, 5.0], Motion::Rapid),
            ([x, 0.0, 0.0], Motion::Feed(300.0)),
            ([x + 11.0, 7.0, 1.0], Motion::Feed(800.0)),
            ([x + 11.0, 7.0, 40.0], Motion::Rapid),
        ] {
            moves.push(ClMove { pose: pose(tip, axis), motion, aloft: false });
        }
    }
    ClPath { moves, spindle_rpm: Some(8000.0), ..ClPath::default() }
}

#[test]
fn planes_come_back() {
    let path = three_positions();
    let rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vec3::z_axis(), 0.4);
    let part_zero = nalgebra::Isometry3::from_parts(nalgebra::Translation3::new(12.0, -7.0, 30.0), rotation);
    let setup = Setup { part_zero, gauge_length_mm: 90.0 };
    for dialect in DIALECTS {
        for name in ["trunnion-ac", "trunnion-bc", "head-ca", "head-b-table-c", "nutated-b-table-c"] {
            let machine = Machine::built_in(name).expect("built in");
            let (posted, back) = there_and_back(&path, &machine, &setup, dialect, Orientation::Planes);
            let name = format!("{dialect} {name}");
            // The plane's angles and the joints' are rounded to 1e-4 deg; tips lie up to 70 mm from the origin.
            let angles = 3.0 * 0.5e-4f64.to_radians();
            meets(&path, &back, (0.5e-4 * 3f64.sqrt() + 70.0 * angles, angles), &name);
            let word = match dialect {
                Dialect::Sinumerik => "CYCLE800(0,",
                Dialect::Heidenhain => "PLANE SPATIAL SPA",
                _ => "G68.2 X0 Y0 Z0 I",
            };
            assert_eq!(posted.text.matches(word).count(), 3, "{name}");
            let cutting: f64 = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum();
            let wanted = 3.0 * (5.0 / 300.0 + 171f64.sqrt() / 800.0);
            assert!((cutting / wanted - 1.0).abs() < 1e-4, "{name}: {cutting}");
        }
    }
}

#[test]
fn what_cannot_be_said() {
    let setup = Setup::at(Vec3::zeros(), 80.0);
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let refused = |path: &ClPath, machine: &Machine, options: &PostOptions| {
        post(path, machine, &setup, options).expect_err("cannot be said")
    };
    let turning = wave(10, 0.0);
    let e = refused(&turning, &machine, &options(Dialect::Fanuc, Orientation::Planes));
    assert!(matches!(e, PostError::Turns { index: 1 }), "{e}");
    for orientation in [Orientation::Vectors, Orientation::Planes] {
        let e = refused(&turning, &machine, &options(Dialect::LinuxCnc, orientation));
        assert!(e.to_string().contains("choose joints"), "{e}");
        let kv = FeedMode::Kv { fgref_mm: None };
        let e =
            refused(&turning, &machine, &PostOptions { orientation, ..PostOptions::new(Dialect::Fanuc, kv) });
        assert_eq!(e, PostError::Orientation);
    }
    // Five turns on a head with 740 deg.
    let around = |i: u32| {
        let w = f64::from(i) * 5f64.to_radians();
        pose([10.0, 0.01 * f64::from(i), 5.0], [0.4 * w.cos(), 0.4 * w.sin(), 1.0])
    };
    let head = Machine::built_in("head-ca").expect("built in");
    let e = refused(
        &path((0..=360).map(around), 500.0),
        &head,
        &options(Dialect::Sinumerik, Orientation::Vectors),
    );
    assert!(matches!(e, PostError::Rewind { .. }) && e.index().is_some(), "{e}");
}

fn foreign(text: &str, dialect: Dialect) -> Result<ReadBack, ReadError> {
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    read(text, dialect, &machine, &Setup::default(), &ReadOptions::default())
}

/// Planes as other systems write them: with origins, with the control turning the axes, as vectors.
#[test]
fn planes_of_other_systems() {
    let h = 0.5f64.sqrt();
    let rows = [
        // Tilted by 45 deg about X, then 10 mm along the plane's Y, from an origin.
        (
            Dialect::Sinumerik,
            "CYCLE800(1,\"TC1\",0,57,1,2,3,45,0,0,0,10,0,-1)\nG0 X0 Y0 Z0\nG1 X5 F100\nM30",
            [6.0, 2.0 + 10.0 * h, 3.0 + 10.0 * h],
            [0.0, -h, h],
        ),
        // The same rotation in the order Z Y X: C first.
        (
            Dialect::Sinumerik,
            "CYCLE800(0,\"\",0,27,0,0,0,0,0,45,0,0,0,1)\nG0 X0 Y0 Z0\nG1 Y5 F100\nM30",
            [0.0, 5.0 * h, 5.0 * h],
            [0.0, -h, h],
        ),
        (
            Dialect::Fanuc,
            "G90 G21\nG68.2 X1. Y2. Z3. I0 J45. K0\nG53.1\nG43 H1\nG0 X0 Y0 Z0\nG1 Y10. F100\nG69\nM30",
            [1.0, 2.0 + 10.0 * h, 3.0 + 10.0 * h],
            [0.0, -h, h],
        ),
        (
            Dialect::Heidenhain,
            "PLANE SPATIAL SPA+45 SPB+0 SPC+0 TURN FMAX SEQ+ COORD ROT\nL X+0 Y+0 Z+0 R0 FMAX\nL Y+10 F100\nM30",
            [0.0, 10.0 * h, 10.0 * h],
            [0.0, -h, h],
        ),
        (
            Dialect::Heidenhain,
            "PLANE VECTOR BX+1 BY+0 BZ+0 NX+0 NY-1 NZ+1 MOVE FMAX\nL X+0 Y+0 Z+0 R0 FMAX\nL Y+10 F100\nM30",
            [0.0, 10.0 * h, 10.0 * h],
            [0.0, -h, h],
        ),
    ];
    for (dialect, text, tip, axis) in rows {
        let back = foreign(text, dialect).unwrap_or_else(|e| panic!("{text}: {e}"));
        let end = back.moves[back.moves.len() - 1].pose;
        assert!((end.tip - Point3::from(tip)).norm() < 1e-9, "{text}: {}", end.tip);
        assert!((end.axis.into_inner() - Vec3::from(axis)).norm() < 1e-9, "{text}: {:?}", end.axis);
    }
    for (dialect, text) in [
        // A projection mode, an addition to another plane, a plane that the axes do not stand at.
        (Dialect::Sinumerik, "CYCLE800(0,\"\",0,155,0,0,0,45,0,0,0,0,0,1)"),
        (Dialect::Sinumerik, "CYCLE800(0,\"\",1,57,0,0,0,45,0,0,0,0,0,1)"),
        (Dialect::Sinumerik, "G0 A0 C=DC(0)\nCYCLE800(0,\"\",0,57,0,0,0,45,0,0,0,0,0,0)"),
        (Dialect::Heidenhain, "PLANE EULER EULPR45 EULNU20 EULROT0 MOVE"),
        (Dialect::Fanuc, "G53.1"),
    ] {
        let e = foreign(text, dialect).expect_err("not understood");
        assert!(matches!(e, ReadError::Word { .. }), "{text}: {e}");
    }
}

/// With ORIVECT the tool goes on a great circle, with ORIAXES the joints go evenly: a long block tells them apart.
#[test]
fn great_circles() {
    let text = "G90 G710\nG0 A0 C=DC(0)\nTRAORI\nORIWKS ORIVECT\nG0 X0 Y0 Z0 A3=0.5 B3=0 C3=1\n\
                G1 X10 A3=0 B3=0.5 C3=1 F100\nM30";
    let normal = Vec3::new(0.5, 0.0, 1.0).cross(&Vec3::new(0.0, 0.5, 1.0)).normalize();
    let off = |text: &str| {
        let back = foreign(text, Dialect::Sinumerik).expect("our words");
        back.moves.iter().map(|m| m.pose.axis.dot(&normal).abs()).fold(0.0, f64::max)
    };
    assert!(off(text) < 1e-9, "{}", off(text));
    assert!(off(&text.replace("ORIVECT", "ORIAXES")) > 0.05);
}

/// The moves in a subprogram: an archive that reads back like the plain program, with all its lines in order.
#[test]
fn subprograms() {
    let (path, setup) = (wave(40, 0.3), Setup::at(Vec3::new(12.0, -7.0, 30.0), 90.0));
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let plain = PostOptions::new(Dialect::Sinumerik, FeedMode::InverseTime);
    let split = PostOptions { subprogram: true, program_name: "part 7".into(), ..plain.clone() };
    let one = post(&path, &machine, &setup, &plain).expect("posts");
    let two = post(&path, &machine, &setup, &split).expect("posts");
    let text = &two.text;
    assert!(text.starts_with("%_N_PART_7_MPF\n") && text.ends_with(" M17\n"), "{text}");
    assert!(
        text.find("PART_7_WAY\n") < text.find("M30\n")
            && text.find("M30\n") < text.find("%_N_PART_7_WAY_SPF\n")
    );
    let options = ReadOptions::default();
    let all = |text: &str| read(text, Dialect::Sinumerik, &machine, &setup, &options);
    let (a, b) = (all(&one.text).expect("reads"), all(text).expect("reads"));
    assert_eq!((a.cl_path(), a.blocks.len()), (b.cl_path(), b.blocks.len()));
    let timed = |text: &str| {
        osculate_postproc::nc::timing::time(text, Dialect::Sinumerik, &machine, &setup, true)
            .expect("times")
            .time
    };
    assert_eq!(timed(&one.text), timed(text));
    let lost = text.replace("%_N_PART_7_WAY_SPF", "%_N_OTHER_SPF");
    let e = all(&lost).expect_err("a call of nothing");
    assert!(e.to_string().contains("PART_7_WAY"), "{e}");
    let e = post(&path, &machine, &setup, &PostOptions { dialect: Dialect::Fanuc, ..split })
        .expect_err("one program");
    assert!(e.to_string().contains("sinumerik"), "{e}");
}

/// Decimals are data of the machine file.
#[test]
fn decimals_of_the_machine() {
    let text = include_str!("../machines/trunnion-ac.toml");
    let coarse = text.replace("max_jerk_mm_s3 = 50000", "max_jerk_mm_s3 = 50000\ndecimals = 3");
    let coarse = coarse.replace("max_jerk_deg_s3 = 20000", "max_jerk_deg_s3 = 20000\ndecimals = 2");
    let machine = Machine::from_toml(&coarse).expect("a machine");
    let (path, setup) = (wave(20, 0.3), Setup::default());
    for (dialect, feed) in
        [(Dialect::Sinumerik, FeedMode::Tcp), (Dialect::Heidenhain, FeedMode::Kv { fgref_mm: None })]
    {
        let posted = post(&path, &machine, &setup, &PostOptions::new(dialect, feed)).expect("posts");
        let decimals = |letter: char| -> Vec<usize> {
            let way =
                posted.text.lines().skip_while(|l| !l.contains("CYCLE832") && !l.contains("CYCL DEF 32.2"));
            let words = way.skip(1).filter(|l| !l.contains("M91")).flat_map(str::split_whitespace);
            let own = words.filter(|w| w.starts_with(letter) && w.contains('.'));
            own.map(|w| w.trim_end_matches(')').len() - w.find('.').map_or(0, |at| at + 1)).collect()
        };
        assert!(decimals('X').iter().all(|d| *d == 3) && decimals('X').len() > 3, "{}", posted.text);
        assert!(decimals('C').iter().all(|d| *d == 2) && decimals('A').iter().all(|d| *d == 4));
        let back = read(&posted.text, dialect, &machine, &setup, &ReadOptions::default()).expect("reads");
        let rad = 0.5e-2f64.to_radians() + 0.5e-4f64.to_radians();
        meets(&path, &back, (0.5e-3 * 3f64.sqrt() + 60.0 * rad, rad), "coarse");
    }
    let e = Machine::from_toml(&coarse.replace("decimals = 2", "decimals = 0")).expect_err("no decimals");
    assert!(e.to_string().contains("from 1 to 4"), "{e}");
}
