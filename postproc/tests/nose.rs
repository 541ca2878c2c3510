//! Ends of travel and places of the machine's own frame are at the spindle nose; words of programs are of the tip.

use crate::common;

use common::{path, pose};
use osculate_geom::Vec3;
use osculate_postproc::conduct::{Expected, ExpectedTool, Grade};
use osculate_postproc::readback::{ReadBack, ReadOptions, read_tools};
use osculate_postproc::{
    Dialect, FeedMode, Machine, PostOptions, Section, Setup, SolveError, post, post_sections,
};
use osculate_postproc::{PostError, in_travel};

/// Z of the built-in `3-axis` and `linuxcnc-xyzac` ends here, mm, and a control's zero is there.
const TOP_MM: f64 = 500.0;

/// Tools by number and length, mm.
const TOOLS: [(u32, f64); 2] = [(1, 80.0), (2, 130.0)];

fn setup() -> Setup {
    Setup::at(Vec3::zeros(), TOOLS[0].1)
}

fn back(text: &str, dialect: Dialect, machine: &str) -> ReadBack {
    let machine = Machine::built_in(machine).unwrap();
    read_tools(text, dialect, &machine, (&setup(), &TOOLS), &ReadOptions::default()).unwrap()
}

fn retract(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::Heidenhain => "L Z+0 R0 FMAX M91",
        Dialect::Sinumerik => "G0 SUPA Z0 D0",
        Dialect::Fanuc | Dialect::LinuxCnc => "G53 G0 Z0",
    }
}

fn call(dialect: Dialect, tool: u32) -> String {
    match dialect {
        Dialect::Heidenhain => format!("TOOL CALL {tool} Z S8000"),
        Dialect::Sinumerik => format!("T{tool} M6 D1"),
        Dialect::Fanuc | Dialect::LinuxCnc => format!("T{tool} M6\nG43 H{tool}"),
    }
}

fn rapid(dialect: Dialect, words: &str) -> String {
    match dialect {
        Dialect::Heidenhain => format!("L {words} R0 FMAX"),
        _ => format!("G0 {words}"),
    }
}

/// The tip hangs below the top of the slide by the length of the tool in hand, and goes down when a longer one is put in.
#[test]
fn retracts_are_lower_by_the_length_of_the_tool() {
    for dialect in Dialect::ALL {
        let (own, rapid) = (retract(dialect), |words| rapid(dialect, words));
        let (first, second) = (call(dialect, 1), call(dialect, 2));
        let head = match dialect {
            Dialect::Heidenhain => "BEGIN PGM X MM\n",
            Dialect::Sinumerik => "G90 G710\n",
            _ => "G90 G21\n",
        };
        let text =
            [head, &first, "\n", &rapid("X1 Y2 Z3"), "\n", own, "\n", &second, "\n", &rapid("X5"), "\n", own]
                .concat();
        let read = back(&text, dialect, "3-axis");
        let tips: Vec<Vec3> = read.moves.iter().map(|m| m.pose.tip.coords).collect();
        let z_mm = |tool: usize| TOP_MM - TOOLS[tool].1;
        let up = tips
            .iter()
            .position(|t| (t.z - z_mm(0)).abs() < 1e-9)
            .unwrap_or_else(|| panic!("{dialect}: {tips:?}"));
        assert!((tips[up - 1].z - 3.0).abs() < 1e-9, "{dialect}: {tips:?}");
        // With the other tool in hand X goes at the height of that one, where it is already: the last retract is no move.
        assert!((tips[up + 1] - Vec3::new(5.0, 2.0, z_mm(1))).norm() < 1e-9, "{dialect}: {tips:?}");
        assert_eq!(tips.len(), up + 2, "{dialect}: {tips:?}");
    }
}

/// The tip stands still on a table that turns from -30 to 30 deg: the slide swings out between the ends of the block, to the radius.
#[test]
fn slides_that_swing_out_within_a_block_are_seen() {
    let expected = Expected::new(ExpectedTool::new(1, TOOLS[0].1), Some(8000.0), 0.01);
    let turn = |radius_mm: f64| {
        let text = format!(
            "G90 G21 G94 G54 G64 P0.001\nT1 M6\nG43 H1\nS8000 M3\nM428\nG0 X{radius_mm} Y0 Z0 A0 C-30\nG1 C30 F500\nM2"
        );
        let read = back(&text, Dialect::LinuxCnc, "linuxcnc-xyzac");
        let x = read.blocks.last().unwrap().to[2];
        assert!((x - radius_mm * 30f64.to_radians().cos()).abs() < 1e-9, "the ends are within: {x}");
        read.conduct(&expected)
    };
    let held = turn(399.0);
    assert!(held.findings.iter().all(|f| !f.what.contains("travel")), "{held:?}");
    let out = turn(410.0);
    let found: Vec<_> = out.findings.iter().filter(|f| f.what.contains("travel")).collect();
    assert_eq!((found.len(), found[0].grade, found[0].line), (1, Grade::Breaks, 7), "{out:?}");
    let told = found[0].what.strip_prefix("X would have to go to ").and_then(|w| w.split(',').next());
    let at: f64 = told.unwrap_or_else(|| panic!("{out:?}")).parse().unwrap();
    assert!((409.8..=410.0).contains(&at), "{out:?}");
}

/// A tip within the travel whose nose is not: the program is not held, the place named at the nose.
#[test]
fn programs_beyond_the_travel_are_broken() {
    let expected = Expected::new(ExpectedTool::new(1, TOOLS[0].1), Some(8000.0), 0.01);
    let text = |z_mm: f64| {
        format!(
            "G90 G21 G54\nG53 G0 Z0\nT1 M6\nG43 H1\nS8000 M3\nG0 X0 Y0\nZ{z_mm}\nG1 X5 F100\nG53 G0 Z0\nM30"
        )
    };
    for dialect in [Dialect::Fanuc, Dialect::LinuxCnc] {
        // The nose is 80 mm above the tip.
        let good = back(&text(TOP_MM - 81.0), dialect, "3-axis").conduct(&expected);
        assert!(good.findings.iter().all(|f| !f.what.contains("travel")), "{good:?}");
        let bad = back(&text(TOP_MM - 79.0), dialect, "3-axis").conduct(&expected);
        let found: Vec<_> = bad.findings.iter().filter(|f| f.what.contains("travel")).collect();
        assert_eq!(found.len(), 1, "{bad:?}");
        assert_eq!((found[0].grade, found[0].line), (Grade::Breaks, 7), "{bad:?}");
        assert!(
            found[0].what.contains("Z would have to go to 501.000, beyond its travel of -300 to 500 mm"),
            "{bad:?}"
        );
        assert!(found[0].what.contains("(2 moves)"), "{bad:?}");
    }
}

/// Posting refuses what the slide cannot reach with this tool, and a shorter tool reaches it.
#[test]
fn posting_knows_the_nose() {
    let machine = Machine::built_in("linuxcnc-xyzac").unwrap();
    let high = TOP_MM - 100.0;
    let way = path((0..5).map(|k| pose([f64::from(k), 0.0, high], [0.0, 0.0, 1.0])), 300.0);
    let options = PostOptions::new(Dialect::LinuxCnc, FeedMode::Tcp);
    let at = |gauge_length_mm: f64| Setup { gauge_length_mm, ..setup() };
    let short = post(&way, &machine, &at(99.0), &options).unwrap();
    assert!(!short.text.is_empty() && in_travel(&way.moves[0].pose, &machine, &at(99.0)));
    assert!(!in_travel(&way.moves[0].pose, &machine, &at(101.0)));
    match post(&way, &machine, &at(101.0), &options) {
        Err(PostError::Solve(SolveError::Limit { joint, value, max, .. })) => {
            assert_eq!((joint.as_str(), max), ("Z", TOP_MM));
            assert!((value - (TOP_MM + 1.0)).abs() < 1e-9, "{value}");
        }
        other => panic!("{other:?}"),
    }
}

/// Programs of two tools stay within the travel that they were posted for, and between the tools the tip stands where the spindle left it.
#[test]
fn posted_sections_stay_within_the_travel() {
    let machine = Machine::built_in("linuxcnc-xyzac").unwrap();
    let way = path((0..5).map(|k| pose([f64::from(k), 0.0, 5.0], [0.1, 0.0, 1.0])), 300.0);
    for dialect in Dialect::ALL {
        let sections: Vec<Section<'_>> = TOOLS
            .iter()
            .map(|(number, gauge_length_mm)| Section {
                name: format!("with {number}"),
                path: &way,
                gauge_length_mm: *gauge_length_mm,
                options: PostOptions {
                    tool_number: *number,
                    spindle_rpm: Some(8000.0),
                    ..PostOptions::new(dialect, FeedMode::None)
                },
            })
            .collect();
        let made = post_sections(&sections, &machine, &setup()).unwrap();
        let read = back(&made.text, dialect, "linuxcnc-xyzac");
        for (number, length_mm) in TOOLS {
            let highest =
                read.blocks.iter().filter(|b| b.tool == Some(number) && b.own_frame).map(|b| b.to[4]);
            assert!(
                highest.clone().count() > 0
                    && highest.clone().all(|z| (z - (TOP_MM - length_mm)).abs() < 1e-9),
                "{dialect} T{number}: {:?}\n{}",
                highest.collect::<Vec<_>>(),
                made.text
            );
        }
        let conduct = read.conduct(&Expected {
            tools: Vec::new(),
            ..Expected::new(ExpectedTool::new(1, 80.0), None, 0.01)
        });
        assert!(conduct.findings.iter().all(|f| !f.what.contains("travel")), "{conduct:?}");
    }
}
