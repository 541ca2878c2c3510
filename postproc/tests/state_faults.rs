//! Programs that move as they should in a state of the control that the job does not mean, and programs that are only
//! written otherwise.

use crate::common;

use common::{path, pose};
use osculate_geom::Vec3;
use osculate_postproc::conduct::{Conduct, Expected, ExpectedTool, Grade};
use osculate_postproc::readback::{ReadBack, ReadOptions, read};
use osculate_postproc::{
    Coolant, Dialect, FeedMode, Machine, Orientation, PostOptions, Setup, WorkOffset, post,
};
use osculate_tools::cl::ClPath;

/// The tolerance of the job, mm.
const TOLERANCE_MM: f64 = 0.02;

fn machine(dialect: Dialect) -> Machine {
    let name = if dialect == Dialect::LinuxCnc { "linuxcnc-xyzac" } else { "trunnion-ac" };
    Machine::built_in(name).expect("a built-in machine")
}

fn setup() -> Setup {
    Setup::at(Vec3::new(12.0, -7.0, 30.0), 90.0)
}

/// Forty feed moves.
fn way() -> ClPath {
    path(
        (0..=40).map(|i| {
            let t = f64::from(i);
            pose([t, 0.3 * t, 0.1 * t], [0.2 + 0.002 * t, 0.1, 1.0])
        }),
        600.0,
    )
}

fn options(dialect: Dialect, feed: FeedMode) -> PostOptions {
    PostOptions { coolant: Some(Coolant::Flood), ..PostOptions::new(dialect, feed) }
}

fn expected() -> Expected {
    let tool = ExpectedTool::new(1, 90.0);
    Expected { coolant: Some(Coolant::Flood), ..Expected::new(tool, Some(8000.0), TOLERANCE_MM) }
}

fn good(dialect: Dialect) -> String {
    let options = options(dialect, FeedMode::Tcp);
    post(&way(), &machine(dialect), &setup(), &options).expect("a path within limits").text
}

fn go(text: &str, dialect: Dialect) -> ReadBack {
    read(text, dialect, &machine(dialect), &setup(), &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{dialect}: {e}\n{text}"))
}

/// Not held, not known, or wider than the tolerance.
fn caught(conduct: &Conduct) -> bool {
    conduct.worst() >= Some(Grade::Open) || conduct.blend_mm > TOLERANCE_MM
}

/// The line, from 0, in the middle of the feed moves.
fn middle(text: &str, dialect: Dialect) -> usize {
    let back = go(text, dialect);
    let feed: Vec<usize> = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.line).collect();
    feed[feed.len() / 2] - 1
}

use Fault::{Amid, Slash, Swap};

/// What is done to a program.
enum Fault {
    /// The first occurrence of some text is something else.
    Swap(&'static str, &'static str),
    /// A line is put in amid the feed moves.
    Amid(&'static str),
    /// A slash stands before some blocks amid the feed moves.
    Slash(usize),
}

fn put(text: &str, fault: &Fault, dialect: Dialect) -> String {
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    match fault {
        Swap(from, to) => {
            assert!(text.contains(from), "{dialect}: no {from} in\n{text}");
            return text.replacen(from, to, 1);
        }
        Amid(words) => lines.insert(middle(text, dialect), (*words).to_string()),
        Slash(count) => {
            let at = middle(text, dialect) - count / 2;
            lines[at..at + count].iter_mut().for_each(|l| l.insert(0, '/'));
        }
    }
    lines.join("\n") + "\n"
}

/// Each fault with words that its finding has.
fn check(dialect: Dialect, faults: &[(Fault, &str)]) {
    let text = good(dialect);
    assert!(!caught(&go(&text, dialect).conduct(&expected())));
    for (fault, word) in faults {
        let bad = put(&text, fault, dialect);
        assert_ne!(bad, text);
        let conduct = go(&bad, dialect).conduct(&expected());
        let name = format!("{dialect}, {word}: {conduct:?}");
        assert!(caught(&conduct), "{name}");
        if *word == "blend" {
            let line = conduct.blend_line.expect("a width has its line");
            assert!(conduct.blend_mm > TOLERANCE_MM && line > 1 && line <= bad.lines().count(), "{name}");
            continue;
        }
        let found = conduct.findings.iter().find(|f| f.grade >= Grade::Open && f.what.contains(word));
        let found = found.unwrap_or_else(|| panic!("{name}"));
        assert!(found.line > 1 && found.line <= bad.lines().count(), "{name}");
        // A fault is one finding, or one for each thing that it changes.
        assert!(conduct.findings.len() <= 3, "{name}");
    }
}

#[test]
fn faults_with_sinumerik() {
    check(
        Dialect::Sinumerik,
        &[
            (Swap("D1\n", "\n"), "no D says which edge"),
            (Swap("D1\n", "D0\n"), "switched off"),
            (Swap("D1\n", "D2\n"), "edge D2"),
            (Amid("D0"), "switched off"),
            (Swap("T1\n", "T7\n"), "tool 7"),
            (Amid("T7 M6 D1 M3"), "tool 7"),
            (Amid("G55"), "G55"),
            (Amid("G500"), "G500"),
            (Amid("G505"), "G505"),
            (Swap("S8000 M3", "M3"), "no S"),
            (Swap("S8000 M3", "S8000"), "does not turn"),
            (Swap("S8000 M3", "S8000 M4"), "wrong way"),
            (Amid("M5"), "does not turn"),
            (Amid("S4000"), "4000 rpm"),
            (Amid("S1=8100"), "8100 rpm"),
            (Amid("M9"), "coolant"),
            (Swap("CYCLE832(0.0020,1,1)", "CYCLE832(0.5,1,1)"), "blend"),
            (Amid("G641 ADIS=0.5"), "blend"),
            (Amid("CTOL=0.1"), "blend"),
            (Slash(30), "slash"),
        ],
    );
}

#[test]
fn faults_with_heidenhain() {
    check(
        Dialect::Heidenhain,
        &[
            (Swap("TOOL CALL 1 Z", "TOOL CALL 7 Z"), "tool 7"),
            (Swap("TOOL CALL 1 Z S8000", "TOOL CALL 1 Z"), "no S"),
            (Swap("TOOL CALL 1 Z S8000", "TOOL CALL 1 Z S8100"), "8100 rpm"),
            (Swap("TOOL CALL 1 Z S8000", "TOOL CALL 1 Z S8000 DL+0.5"), "adds 0.5 mm"),
            (Swap(" M3\n", " ; M3\n"), "does not turn"),
            (Swap(" M3\n", " M4\n"), "wrong way"),
            (Amid("99 TOOL CALL 7 Z S8000"), "tool 7"),
            (Amid("99 M5"), "does not turn"),
            (Amid("99 M9"), "coolant"),
            (Amid("99 TOOL CALL Z S500"), "500 rpm"),
            (Amid("99 CYCL DEF 247 DATUM SETTING Q339=+3"), "preset 3"),
            (Amid("99 CYCL DEF 247 DATUM SETTING ~\nQ339=+4 ;DATUM NUMBER"), "preset 4"),
            (Swap("CYCL DEF 32.1 T0.0020", "CYCL DEF 32.1 T0.5"), "blend"),
            (Amid("99 CYCL DEF 32.1 T0.5"), "blend"),
            (Slash(30), "slash"),
        ],
    );
}

#[test]
fn faults_with_fanuc() {
    check(
        Dialect::Fanuc,
        &[
            (Amid("G49"), "switched off"),
            (Swap("G43.4 H1", "G43.4 H0"), "H0"),
            (Swap("G43.4 H1", "G43.4 H2"), "H2"),
            (Swap("G43.4 H1", "G43.4"), "without H"),
            (Amid("H2"), "H2"),
            (Swap("T1 M6", "T7 M6"), "tool 7"),
            (Amid("T7 M6\nM3"), "tool 7"),
            (Amid("G55"), "G55"),
            (Amid("G54.1 P3"), "G54.1 P3"),
            (Amid("G54 P4"), "G54.1 P4"),
            (Swap("S8000 M3", "M3"), "no S"),
            (Swap("S8000 M3", "S8000"), "does not turn"),
            (Swap("S8000 M3", "S8000 M4"), "wrong way"),
            (Swap("S8000 M3", "S7000 M3"), "7000 rpm"),
            (Amid("M5"), "does not turn"),
            (Amid("M9"), "coolant"),
            (Amid("G64 P0.5"), "blend"),
            (Slash(30), "slash"),
        ],
    );
}

#[test]
fn faults_with_linuxcnc() {
    check(
        Dialect::LinuxCnc,
        &[
            (Swap("G43 H1\n", "\n"), "switched off"),
            (Amid("G49"), "switched off"),
            (Swap("G43 H1\n", "G43 H2\n"), "H2"),
            (Swap("G43 H1\n", "G43.1 Z80\n"), "80 mm"),
            (Swap("T1 M6", "T7 M6"), "tool 7"),
            (Amid("T7 M6\nM3"), "tool 7"),
            (Amid("G55"), "G55"),
            (Amid("G59.2"), "G59.2"),
            (Swap("S8000 M3", "M3"), "no S"),
            (Swap("S8000 M3", "S8000"), "does not turn"),
            (Swap("S8000 M3", "S8000 M4"), "wrong way"),
            (Amid("S100"), "100 rpm"),
            (Amid("M5"), "does not turn"),
            (Swap("G64 P0.0020", "G64 P0.5"), "blend"),
            (Amid("G64 P0.5 Q0"), "blend"),
            (Amid("G64"), "any amount"),
            (Swap("G64 P0.0020", ""), "not said"),
            (Slash(30), "slash"),
        ],
    );
}

/// The same without tool-centre-point control, where G43 is all that applies the length.
#[test]
fn length_without_tool_centre_point_control() {
    for dialect in [Dialect::Fanuc, Dialect::LinuxCnc] {
        let options = options(dialect, FeedMode::InverseTime);
        let text = post(&way(), &machine(dialect), &setup(), &options).expect("a path within limits").text;
        assert_eq!(go(&text, dialect).conduct(&expected()).findings, []);
        for fault in [Swap("G43 H1\n", "\n"), Swap("G43 H1\n", "G43 H2\n"), Amid("G49")] {
            let conduct = go(&put(&text, &fault, dialect), dialect).conduct(&expected());
            assert_eq!(conduct.worst(), Some(Grade::Breaks), "{conduct:?}");
            assert_eq!(conduct.findings.len(), 1, "{conduct:?}");
        }
        // Never said at all: G49 is not there either.
        let bare = text.replacen(" G49", "", 1).replacen("G43 H1\n", "\n", 1);
        let conduct = go(&bare, dialect).conduct(&expected());
        assert!(conduct.findings[0].what.contains("never applied"), "{conduct:?}");
    }
}

/// Where nothing is said of the tool and of the offset, that is told.
#[test]
fn what_is_only_told() {
    for (dialect, from, to, word) in [
        (Dialect::Fanuc, "T1 M6", "", "which tool"),
        (Dialect::LinuxCnc, "T1 M6", "T1", "which tool"),
        (Dialect::Sinumerik, "T1\n", "T=\"MILL 10\"\n", "by a number"),
        (Dialect::Heidenhain, "TOOL CALL 1", "TOOL CALL \"MILL 10\"", "by a number"),
        (Dialect::Fanuc, "G54\n", "\n", "no work offset"),
        (Dialect::LinuxCnc, "S8000", "T7 S8000", "tool 7 is selected"),
        (Dialect::Sinumerik, "CYCLE832(0.0020,1,1)", "", "the machine's data"),
    ] {
        let bad = put(&good(dialect), &Swap(from, to), dialect);
        let conduct = go(&bad, dialect).conduct(&expected());
        let found = conduct.findings.iter().find(|f| f.what.contains(word));
        let found = found.unwrap_or_else(|| panic!("{dialect}, {word}: {conduct:?}"));
        assert!(found.grade == Grade::Warning && found.line > 0, "{conduct:?}");
        assert_eq!(conduct.worst(), Some(Grade::Warning), "{conduct:?}");
    }
}

/// A retract that goes down instead of up is a rapid move through the part; G28 leads where nobody has said.
#[test]
fn retracts_are_moves() {
    for (dialect, from, to, top_mm) in [
        (Dialect::Fanuc, "G53 G0 Z0\nM30", "G53 G0 Z-2990\nM30", 3000.0),
        (Dialect::LinuxCnc, "G53 G0 Z0\nM30", "G53 G0 Z-490\nM30", 500.0),
        (Dialect::Sinumerik, "G0 SUPA Z0 D0\nN", "G0 SUPA Z-2990 D0\nN", 3000.0),
        (Dialect::Heidenhain, "L Z+0.0000 R0 FMAX M91\n", "L Z-2990 R0 FMAX M91\n", 3000.0),
    ] {
        let text = good(dialect);
        let z = machine(dialect).joint_named("Z").expect("there is a Z");
        let end = |text: &str| {
            let back = go(text, dialect);
            let last = back.blocks[back.blocks.len() - 1];
            assert!(last.rapid && last.own_frame && last.line > 1, "{last:?}");
            last.to[z]
        };
        // The nose goes there, and the tip is a gauge length below.
        let below_mm = setup().gauge_length_mm;
        assert!((end(&text) - (top_mm - below_mm)).abs() < 1e-9);
        let at = text.rfind(from).unwrap_or_else(|| panic!("{dialect}: {text}"));
        let bad = format!("{}{}", &text[..at], text[at..].replacen(from, to, 1));
        assert!((end(&bad) - (10.0 - below_mm)).abs() < 1e-9);
    }
    for dialect in [Dialect::Fanuc, Dialect::LinuxCnc] {
        let bad = put(&good(dialect), &Amid("G91 G28 Z0\nG90"), dialect);
        let conduct = go(&bad, dialect).conduct(&expected());
        assert!(conduct.worst() == Some(Grade::Open), "{conduct:?}");
        assert!(conduct.findings.iter().any(|f| f.what.contains("home_mm") && f.line > 1), "{conduct:?}");
    }
    // Before anything is known of the place it loses nothing, and is told.
    let first = good(Dialect::Fanuc).replacen("G53 G0 Z0\n", "G91 G28 Z0\nG90\n", 1);
    let conduct = go(&first, Dialect::Fanuc).conduct(&expected());
    assert!(conduct.worst() == Some(Grade::Warning) && conduct.findings.len() == 1, "{conduct:?}");
    let bad = put(&good(Dialect::Heidenhain), &Amid("99 L Z+0 R0 FMAX M92"), Dialect::Heidenhain);
    assert_eq!(go(&bad, Dialect::Heidenhain).conduct(&expected()).worst(), Some(Grade::Open));
}

/// What we write ourselves is what the job means, in every dialect, feed mode and wording of directions.
#[test]
fn our_own_programs_are_clean() {
    let modes = [
        FeedMode::None,
        FeedMode::Tcp,
        FeedMode::InverseTime,
        FeedMode::Kf,
        FeedMode::Kv { fgref_mm: None },
        FeedMode::Kz { step_mm_min: 5.0, fgref_mm: None },
        FeedMode::RotaryOnly,
        FeedMode::Fastest { tip_mm_min: None },
    ];
    let names = ["trunnion-ac", "linuxcnc-xyzac", "head-ca", "head-b-table-c", "nutated-b-table-c"];
    // Planes hold the tool still.
    let still = path((0..9).map(|i| pose([f64::from(i), 0.0, 0.0], [0.1, 0.2, 1.0])), 600.0);
    let mut posted = 0;
    for dialect in Dialect::ALL {
        for feed in modes {
            for orientation in [Orientation::Joints, Orientation::Vectors, Orientation::Planes] {
                for name in names {
                    let machine = Machine::built_in(name).expect("a built-in machine");
                    let cl = if orientation == Orientation::Planes { &still } else { &way() };
                    let options = PostOptions { orientation, ..options(dialect, feed) };
                    // What a dialect or a machine cannot say.
                    let Ok(text) = post(cl, &machine, &setup(), &options) else { continue };
                    let back = read(&text.text, dialect, &machine, &setup(), &ReadOptions::default());
                    let back = back.unwrap_or_else(|e| panic!("{dialect} {feed:?} {name}: {e}"));
                    let conduct = back.conduct(&expected());
                    assert!(conduct.findings.is_empty(), "{dialect} {feed:?} {name}: {conduct:?}");
                    assert!(conduct.blend_mm <= 2.0 * options.blend_mm, "{conduct:?}");
                    assert!(back.moves.iter().all(|m| m.tool == Some(1)));
                    posted += 1;
                }
            }
        }
    }
    assert!(posted > 120, "{posted}");
}

/// The job's own tool, offset and speed, in the words of each dialect; those of another job break.
#[test]
fn options_are_worded_and_read_back() {
    let cases = [
        (Dialect::Sinumerik, "G55"),
        (Dialect::Sinumerik, "G507"),
        (Dialect::Heidenhain, "preset 2"),
        (Dialect::Fanuc, "G54.1 P12"),
        (Dialect::LinuxCnc, "G59.3"),
    ];
    for (dialect, name) in cases {
        let offset: WorkOffset = name.parse().expect("an offset");
        let options = PostOptions {
            tool_number: 12,
            spindle_rpm: Some(6500.0),
            work_offset: Some(offset),
            program_number: 77,
            ..options(dialect, FeedMode::Tcp)
        };
        let text = post(&way(), &machine(dialect), &setup(), &options).expect("a path within limits").text;
        assert!(text.contains(&offset.words(dialect).expect("its own words")), "{text}");
        assert_eq!(text.contains("O0077"), dialect == Dialect::Fanuc);
        let tool = ExpectedTool::new(12, 90.0);
        let own = Expected { work_offset: Some(offset), ..Expected::new(tool, Some(6500.0), TOLERANCE_MM) };
        let back = go(&text, dialect);
        assert_eq!(back.conduct(&own).findings, []);
        assert_eq!(back.conduct(&expected()).worst(), Some(Grade::Breaks));
        assert_eq!(back.conduct(&expected()).findings.len(), 3, "{:?}", back.conduct(&expected()));
    }
    let options =
        PostOptions { work_offset: Some(WorkOffset::Off), ..options(Dialect::Fanuc, FeedMode::Tcp) };
    let e = post(&way(), &machine(Dialect::Fanuc), &setup(), &options).expect_err("Fanuc has no G500");
    assert!(e.to_string().contains("G500"), "{e}");
}
