//! Programs of several tools: what each tool does comes back from the text with its own length and speed, and a wrong tool is found.

use crate::common;

use common::{path, pose};
use osculate_geom::Vec3;
use osculate_postproc::conduct::{Conduct, Expected, ExpectedTool, Grade};
use osculate_postproc::readback::{ReadBack, ReadOptions, read_tools};
use osculate_postproc::{
    Coolant, Dialect, FeedMode, Machine, PostError, PostOptions, PostedSections, Section, Setup, post,
    post_sections,
};
use osculate_tools::cl::{ClPath, Motion};
use proptest::prelude::*;

/// Number, gauge length in mm, speed.
const TOOLS: [(u32, f64, f64); 3] = [(3, 90.0, 8000.0), (7, 131.5, 5000.0), (12, 74.25, 11000.0)];

fn machine(dialect: Dialect) -> Machine {
    let name = if dialect == Dialect::LinuxCnc { "linuxcnc-xyzac" } else { "trunnion-ac" };
    Machine::built_in(name).expect("a built-in machine")
}

fn setup() -> Setup {
    Setup::at(Vec3::new(12.0, -7.0, 30.0), TOOLS[0].1)
}

/// A way beside those of the other tools.
fn way(k: usize) -> ClPath {
    let poses = (0..=20).map(|i| {
        let (t, y) = (f64::from(i), 9.0 * k as f64);
        pose([t - 7.5, 0.3 * t + y, 5.0 - 0.1 * t], [0.2 - 0.02 * t, 0.05 * k as f64, 1.0])
    });
    path(poses, 400.0 + 100.0 * k as f64)
}

fn sections<'a>(ways: &'a [ClPath], dialect: Dialect, feed: FeedMode) -> Vec<Section<'a>> {
    ways.iter()
        .zip(TOOLS)
        .enumerate()
        .map(|(k, (path, (tool_number, gauge_length_mm, rpm)))| Section {
            name: format!("finish {k}"),
            path,
            gauge_length_mm,
            options: PostOptions {
                tool_number,
                spindle_rpm: Some(rpm),
                coolant: (k != 1).then_some(Coolant::Flood),
                ..PostOptions::new(dialect, feed)
            },
        })
        .collect()
}

fn posted(ways: &[ClPath], dialect: Dialect, feed: FeedMode) -> PostedSections {
    post_sections(&sections(ways, dialect, feed), &machine(dialect), &setup())
        .unwrap_or_else(|e| panic!("{dialect}: {e}"))
}

fn back(text: &str, dialect: Dialect) -> ReadBack {
    let lengths = TOOLS.map(|t| (t.0, t.1));
    read_tools(text, dialect, &machine(dialect), (&setup(), &lengths), &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{dialect}: {e}\n{text}"))
}

fn conduct(text: &str, dialect: Dialect) -> Conduct {
    let tools = TOOLS.iter().map(|t| ExpectedTool {
        spindle_rpm: Some(t.2),
        coolant: (t.0 != 7).then_some(Coolant::Flood),
        ..ExpectedTool::new(t.0, t.1)
    });
    let expected =
        Expected { tools: tools.collect(), ..Expected::new(ExpectedTool::new(3, 90.0), None, 0.02) };
    back(text, dialect).conduct(&expected)
}

fn ways() -> Vec<ClPath> {
    (0..3).map(way).collect()
}

/// The largest distance of a feed move's end from a way.
fn off(way: &ClPath, read: &ReadBack, tool: u32) -> (usize, f64) {
    let own = read.moves.iter().filter(|m| m.tool == Some(tool) && m.motion != Motion::Rapid);
    let (mut count, mut worst) = (0, 0.0f64);
    for m in own {
        count += 1;
        let nearest = way.moves.windows(2).map(|w| {
            let (a, b) = (w[0].pose.tip, w[1].pose.tip);
            let t = ((m.pose.tip - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
            let axis = w[0].pose.axis.lerp(&w[1].pose.axis, t).normalize();
            (m.pose.tip - (a + (b - a) * t)).norm().max(10.0 * (m.pose.axis.into_inner() - axis).norm())
        });
        worst = worst.max(nearest.fold(f64::INFINITY, f64::min));
    }
    (count, worst)
}

#[test]
fn every_tool_comes_back_with_its_own_length_and_speed() {
    let ways = ways();
    for dialect in Dialect::ALL {
        for feed in [FeedMode::Tcp, FeedMode::None] {
            let made = posted(&ways, dialect, feed);
            let read = back(&made.text, dialect);
            for (way, (number, _, rpm)) in ways.iter().zip(TOOLS) {
                let (count, worst) = off(way, &read, number);
                assert!(
                    count >= 20 && worst < 0.002,
                    "{dialect} {feed:?} T{number}: {count} {worst}\n{}",
                    made.text
                );
                assert!(read.speeds_rpm.contains(&(Some(number), rpm)), "{:?}", read.speeds_rpm);
            }
            let conduct = conduct(&made.text, dialect);
            assert!(conduct.worst() < Some(Grade::Open), "{dialect} {feed:?}: {conduct:?}\n{}", made.text);
            assert_eq!(made.sections.len(), 3);
            assert!(made.sections.iter().all(|s| s.blocks >= 20));
        }
    }
}

/// On a machine with a turning head joints go by the length: with that of another tool a program is somewhere else.
#[test]
fn lengths_matter_where_the_head_turns() {
    let (ways, machine) = (ways(), Machine::built_in("head-ca").unwrap());
    let text =
        post_sections(&sections(&ways, Dialect::Fanuc, FeedMode::None), &machine, &setup()).unwrap().text;
    let read = |lengths: &[(u32, f64)]| {
        read_tools(&text, Dialect::Fanuc, &machine, (&setup(), lengths), &ReadOptions::default()).unwrap()
    };
    let (own, one) = (read(&TOOLS.map(|t| (t.0, t.1))), read(&[]));
    for (way, tool) in ways.iter().zip(TOOLS) {
        let (right, wrong) = (off(way, &own, tool.0).1, off(way, &one, tool.0).1);
        assert!(right < 0.002, "{right}");
        assert_eq!(wrong < 0.002, tool.1 == TOOLS[0].1, "{wrong}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// One section alone is the program of its path, but for the line that names it, after which blocks count from one more.
    #[test]
    fn one_section_is_the_program_of_its_path(which in 0usize..4, k in 0usize..3, tcp: bool) {
        let dialect = Dialect::ALL[which];
        let feed = if tcp { FeedMode::Tcp } else { FeedMode::None };
        let ways = ways();
        let one = sections(&ways, dialect, feed).swap_remove(k);
        let own = Setup { gauge_length_mm: one.gauge_length_mm, ..setup() };
        let alone = post(one.path, &machine(dialect), &own, &one.options).unwrap();
        let made = post_sections(&[one], &machine(dialect), &setup()).unwrap();
        let name = "operation 1: ";
        let counted = |l: &str| l.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit()).to_owned();
        let lines = |text: &str, named: bool| -> Vec<String> {
            text.lines().filter(|l| l.to_ascii_lowercase().contains(name) == named).map(counted).collect()
        };
        prop_assert_eq!(lines(&made.text, false), lines(&alone.text, false));
        prop_assert_eq!([lines(&made.text, true).len(), lines(&alone.text, true).len()], [1, 0]);
    }
}

/// What is done to the text of a program, and a word of what is found.
#[test]
fn a_wrong_tool_is_found_with_its_line() {
    let ways = ways();
    let faults: [(Dialect, &str, &str, &str); 8] = [
        (Dialect::Sinumerik, " T7\n", " T3\n", "5000 rpm, the job has 8000"),
        (Dialect::Sinumerik, "S11000", "S1100", "1100 rpm, the job has 11000"),
        (Dialect::Heidenhain, "TOOL CALL 7 Z S5000", "TOOL CALL 8 Z S5000", "tool 8 is in the spindle"),
        (Dialect::Heidenhain, "TOOL CALL 12 Z S11000", "TOOL CALL 12 Z S9000", "9000 rpm, the job has 11000"),
        (Dialect::Fanuc, "T12 M6", "T13 M6", "tool 13 is in the spindle"),
        (Dialect::Fanuc, "G43.4 H7", "G43.4 H3", "the length of H3 applies"),
        (Dialect::LinuxCnc, "G43 H12", "G43 H7", "the length of H7 applies"),
        (Dialect::LinuxCnc, "S5000 M3", "S5000 M5", "the spindle does not turn"),
    ];
    for (dialect, is, wrong, what) in faults {
        let good = posted(&ways, dialect, FeedMode::Tcp).text;
        assert!(good.contains(is), "{dialect}: no {is}\n{good}");
        // What stands in comments comes before it.
        let at = good.rfind(is).unwrap();
        let found = conduct(&(good[..at].to_owned() + wrong + &good[at + is.len()..]), dialect);
        let hit = found.findings.iter().find(|f| f.grade == Grade::Breaks && f.what.contains(what));
        assert!(hit.is_some_and(|f| f.line > 20), "{dialect} {wrong}: {:?}", found.findings);
    }
}

/// The words between two tools, in each dialect: everything off, away, the call, and back with everything on.
#[test]
fn between_two_tools_everything_is_said_again() {
    let ways = ways();
    let want: [(Dialect, &[&str]); 4] = [
        (
            Dialect::Sinumerik,
            &[
                "M9",
                "M5",
                "CYCLE832()",
                "TRAFOOF",
                "G0 SUPA Z0 D0",
                "; operation 2: finish 1, T7",
                "T7",
                "M6",
                "D1",
                "G54",
                "S5000 M3",
            ],
        ),
        (
            Dialect::Heidenhain,
            &[
                "M9",
                "M5",
                "CYCL DEF 32.0 TOLERANCE",
                "CYCL DEF 32.1",
                "FUNCTION RESET TCPM",
                "L Z+0.0000 R0 FMAX M91",
                "; operation 2: finish 1, T7",
                "TOOL CALL 7 Z S5000",
                "M3",
            ],
        ),
        (
            Dialect::Fanuc,
            &[
                "G94",
                "G5.1 Q0",
                "M9",
                "M5",
                "G49",
                "G53 G0 Z0",
                "(operation 2: finish 1, T7)",
                "T7 M6",
                "G54",
                "S5000 M3",
            ],
        ),
        (
            Dialect::LinuxCnc,
            &[
                "G94",
                "M9",
                "M5",
                "M429",
                "G53 G0 Z0",
                "(operation 2: finish 1, T7)",
                "G64 P0.0020",
                "T7 M6",
                "G43 H7",
                "G54",
                "S5000 M3",
            ],
        ),
    ];
    for (dialect, lines) in want {
        let text = posted(&ways, dialect, FeedMode::Tcp).text;
        let bare = |l: &str| {
            let l = l.trim_start_matches('N');
            l.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start().to_owned()
        };
        let all: Vec<String> = text
            .lines()
            .map(|l| {
                if matches!(dialect, Dialect::Sinumerik | Dialect::Heidenhain) {
                    bare(l)
                } else {
                    l.to_owned()
                }
            })
            .collect();
        assert!(all.windows(lines.len()).any(|w| w == lines), "{dialect}\n{text}");
        let tools: Vec<&String> =
            all.iter().filter(|l| l.contains("gauge length") && l.contains("operations")).collect();
        assert_eq!(tools.len(), 3, "{text}");
    }
}

#[test]
fn sections_that_differ_in_what_a_program_has_once_are_refused() {
    let ways = ways();
    let mut two = sections(&ways, Dialect::Fanuc, FeedMode::Tcp);
    two[1].options.feed = FeedMode::None;
    let got = post_sections(&two, &machine(Dialect::Fanuc), &setup());
    assert_eq!(got, Err(PostError::Sections { section: 2, name: "finish 1".into() }));
    assert_eq!(post_sections(&[], &machine(Dialect::Fanuc), &setup()), Err(PostError::NoSection));
    let mut way = sections(&ways, Dialect::Sinumerik, FeedMode::Tcp);
    way.iter_mut().for_each(|s| s.options.subprogram = true);
    let got = post_sections(&way, &machine(Dialect::Sinumerik), &setup());
    assert!(got.unwrap_err().to_string().contains("leave the subprogram out"));
}
