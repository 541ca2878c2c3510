//! The second opinion's reader on programs that the post has written: every built-in machine, dialect, feed mode and wording of
//! the tool's direction gives the CL points back, and the joints' forward kinematics are the post's.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate::second::{self, Station};
use osculate_geom::{Point3, Unit3, Vec3};
use osculate_postproc::{Dialect, FeedMode, Machine, Orientation, PostOptions, Setup, built_in_names, post};
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};

fn machine_text(name: &str) -> &'static str {
    osculate_postproc::built_in_text(name).expect("built in")
}

/// Directions that every machine of this name reaches, away from its poles, in the table's frame.
fn direction(name: &str, t: f64) -> Vec3 {
    match name {
        "3-axis" => Vec3::z(),
        // The tool stays across the turning axis.
        "mill-turn-xyzc" => Vec3::new((2.0 + t).cos(), (2.0 + t).sin(), 0.0),
        // All around the vertical, leaning by 20 to 30 deg.
        _ => {
            let (lean, round) = (0.45 + 0.1 * (3.0 * t).sin(), 4.0 * t);
            Vec3::new(lean.sin() * round.cos(), lean.sin() * round.sin(), lean.cos())
        }
    }
}

fn setup() -> Setup {
    let turn = UnitQuaternion::from_scaled_axis(Vec3::new(0.2, -0.1, 0.4));
    let place = Translation3::new(-20.0 / 3.0, 11.0, 70.0 / 11.0);
    Setup { part_zero: Isometry3::from_parts(place, turn), gauge_length_mm: 250.0 / 3.0 }
}

/// Two rows of points, with a rapid over to the second; `turning`: the tool turns from point to point, else from row to row.
fn path(name: &str, turning: bool) -> ClPath {
    let setup = setup();
    let at = |row: i32, k: i32, lift: f64| {
        let t = f64::from(row) * 0.8 + if turning { 0.04 * f64::from(k) } else { 0.0 };
        let axis = Unit3::new_normalize(direction(name, t));
        // Placed in the table's frame, near its middle; over the turning axis of a lathe.
        let tip = Point3::new(f64::from(k) * 1.3 - 10.0, 7.0 * f64::from(row), 5.0 + 0.01 * f64::from(k * k));
        let tip = if name == "mill-turn-xyzc" { tip + axis.into_inner() * 30.0 } else { tip };
        setup.to_part(&Pose { tip: tip + axis.into_inner() * lift, axis })
    };
    let mut moves = Vec::new();
    for row in 0..2 {
        moves.push(ClMove { pose: at(row, 0, 20.0), motion: Motion::Rapid, aloft: false });
        moves.extend((0..20).map(|k| ClMove {
            pose: at(row, k, 0.0),
            motion: Motion::Feed(800.0),
            aloft: false,
        }));
        moves.push(ClMove { pose: at(row, 19, 20.0), motion: Motion::Rapid, aloft: false });
    }
    ClPath { moves, ..ClPath::default() }
}

/// The CL points come in their order among the stations, where the post may have put in others.
fn comes_back(label: &str, path: &ClPath, stations: &[Station]) {
    let mut from = 0;
    for (k, m) in path.moves.iter().enumerate() {
        // The first place is where the program begins: rapids across and down, of which only the last is known.
        let off = |s: &Station| {
            let tip = (Point3::from(s.tip_mm) - m.pose.tip).norm();
            let axis = (Vec3::from(s.axis) - m.pose.axis.into_inner()).norm();
            (tip, axis)
        };
        // Four decimals of a degree at some 300 mm are 3e-4 mm; three axes' own 1e-4 mm beside it. A direction has the same.
        let found = stations[from..].iter().position(|s| {
            let (tip, axis) = off(s);
            tip < 1e-3 && axis < 5e-6 && (s.rapid == (m.motion == Motion::Rapid) || k == 0)
        });
        let Some(found) = found else {
            let best = stations[from..].iter().map(off).min_by(|a, b| a.0.total_cmp(&b.0));
            panic!("{label}: CL point {k} does not come back: {best:?}");
        };
        // What lies between stays between: the post does not wander.
        from += found + 1;
    }
}

#[test]
fn posted_points_come_back() {
    let feeds = [
        FeedMode::Tcp,
        FeedMode::None,
        FeedMode::Kf,
        FeedMode::Kv { fgref_mm: None },
        FeedMode::Kz { step_mm_min: 500.0, fgref_mm: Some(40.0) },
        FeedMode::RotaryOnly,
        FeedMode::InverseTime,
    ];
    let mut posted = 0;
    let mut refused = Vec::new();
    for name in built_in_names() {
        let machine = Machine::built_in(name).unwrap();
        let text = machine_text(name);
        for dialect in Dialect::ALL {
            for feed in feeds {
                for (orientation, turning) in
                    [(Orientation::Joints, true), (Orientation::Vectors, true), (Orientation::Planes, false)]
                {
                    let path = path(name, turning);
                    let options = PostOptions { orientation, ..PostOptions::new(dialect, feed) };
                    let label = format!("{name} {dialect} {feed:?} {orientation:?}");
                    let program = match post(&path, &machine, &setup(), &options) {
                        Ok(program) => program,
                        Err(e) => {
                            refused.push(format!("{label}: {e}"));
                            continue;
                        }
                    };
                    posted += 1;
                    let stations = second::stations(&program.text, dialect.name(), text, None)
                        .unwrap_or_else(|e| panic!("{label}: {e}\n{}", program.text));
                    comes_back(&label, &path, &stations);
                }
            }
        }
    }
    // Joints: nine machines, four dialects, seven feed modes, less inverse time in Klartext and less tool-centre-point control by
    // LinuxCNC on the five machines without a switch for it. Directions and planes: with that control, in three dialects.
    assert_eq!(posted, 9 * 4 * 7 - 9 - 5 + 2 * 9 * 3, "{}", refused.join("\n"));
}

/// A subprogram is read where it is called.
#[test]
fn an_archive_of_sinumerik_comes_back() {
    let machine = Machine::built_in("head-ca").unwrap();
    for feed in [FeedMode::Tcp, FeedMode::None] {
        let options = PostOptions { subprogram: true, ..PostOptions::new(Dialect::Sinumerik, feed) };
        let path = path("head-ca", true);
        let program = post(&path, &machine, &setup(), &options).unwrap();
        assert!(program.text.contains("_SPF"));
        let stations = second::stations(&program.text, "sinumerik", machine_text("head-ca"), None).unwrap();
        comes_back("archive", &path, &stations);
        // Without the subprogram there is nothing to say.
        let main = program.text.split("%_N_OSCULATE_WAY_SPF").next().unwrap();
        assert!(second::stations(main, "sinumerik", machine_text("head-ca"), None).is_err());
    }
}

/// Joints all over their ranges: both ways of carrying the tool come to the same place.
#[test]
fn joints_lead_to_the_same_place() {
    for name in built_in_names() {
        let machine = Machine::built_in(name).unwrap();
        let text = machine_text(name);
        let at_table = Setup { part_zero: Isometry3::identity(), gauge_length_mm: 123.4 };
        for k in 0..200 {
            let wave = |n: f64, size: f64| size * (n * (f64::from(k) + 0.3)).sin();
            let (linear, rotary) = (
                [wave(1.1, 300.0), wave(2.3, 200.0), wave(3.7, 150.0)],
                [wave(0.7, 170.0), wave(1.9, 100.0)],
            );
            let mut values = [0.0; 5];
            for (place, v) in machine.linear().into_iter().zip(linear) {
                values[place] = v;
            }
            for (place, v) in machine.rotary().iter().zip(rotary) {
                values[*place] = v.to_radians();
            }
            let want = machine.forward(&values, &at_table);
            let [tip, axis] = second::forward(text, linear, rotary, 123.4).unwrap();
            // Rounding at half a metre.
            assert!((Point3::from(tip) - want.tip).norm() < 1e-10, "{name}");
            assert!((Vec3::from(axis) - want.axis.into_inner()).norm() < 1e-12, "{name}");
        }
    }
}

/// Whatever a program looks like, it is read or refused.
#[test]
fn spoilt_programs_end_in_an_answer() {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let text = machine_text("trunnion-ac");
    let (mut fine, mut refused, mut counter) = (0, 0, 0.0);
    let junk = [
        "",
        "X",
        "=",
        "(",
        ")",
        "[",
        "]=",
        "é",
        "999999999999",
        "-",
        ".",
        "G",
        "DC(",
        "\"",
        "\n",
        "TRAORI ",
        "M30",
    ];
    // Numbers from 0 to less than n that look like chance.
    let mut place = |n: usize| {
        counter += 1.0;
        let x = (f64::sin(counter * 12.9898) * 43_758.547).abs();
        (x.fract() * n as f64) as usize
    };
    for dialect in Dialect::ALL {
        for feed in [FeedMode::Tcp, FeedMode::None] {
            let path = path("trunnion-ac", true);
            let program = post(&path, &machine, &setup(), &PostOptions::new(dialect, feed)).unwrap();
            for _ in 0..300 {
                let mut spoilt: Vec<char> = program.text.chars().collect();
                let (from, word) = (place(spoilt.len()), junk[place(junk.len())]);
                let to = (from + place(3)).min(spoilt.len());
                spoilt.splice(from..to, word.chars());
                let spoilt: String = spoilt.into_iter().collect();
                match second::stations(&spoilt, dialect.name(), text, None) {
                    Ok(got) => {
                        fine += 1;
                        assert!(
                            got.iter().all(|s| s.tip_mm.iter().chain(&s.axis).all(|x| x.is_finite())),
                            "{spoilt}"
                        );
                    }
                    Err(e) => {
                        refused += 1;
                        assert!(e.to_string().starts_with("there is no second opinion"), "{e}");
                    }
                }
            }
        }
    }
    // Digits may change, most else not.
    assert!(fine > 100 && refused > 1000, "{fine} {refused}");
}
