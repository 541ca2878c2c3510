//! CL texts of several tools, with what other systems write in them: every tool makes its moves, with its own speed, and what a program
//! cannot say is named by its line.

use crate::common;

use common::cl_text::{self, posted};
use osculate_geom::{Point3, Severity, Vec3};
use osculate_postproc::cldata::{ClReadOptions, ClStream, read};
use osculate_postproc::source::MoveSource;
use osculate_postproc::{AuxiliaryWord, Dialect, FeedMode, Machine, Spindle};
use osculate_tools::CutterSpec;
use osculate_tools::cl::Motion;
use std::io::Cursor;
use std::ops::ControlFlow;

/// A drill, a mill and a tap; words in the orders of other systems: cutter before the tool, tool before the cutter, coolant and speed changed on
/// the way, a tool that comes again, dwells and stops.
const THREE: &str = "PARTNO/THREE\nUNIT/MM\nRAPID\nGOTO/0,0,100\nCUTTER/12.,0,6.,3.605164,31.,0,63.\nLOAD/TOOL,12\nSELECT/TOOL,3\n\
    COOLNT/FLOOD\nSPINDL/3500,RPM,CLW\nRAPID\nGOTO/10,20,30\nCYCLE/DRILL,FEDTO,5.4,MMPM,364.5,RAPTO,3,RTRCTO,27.5,DWELL,1.5\nGOTO/10,20,-2\n\
    GOTO/40,20,-2\nCYCLE/OFF\nCYCLE/DEEP2,FEDTO,9,1STPECK,5,SUBPECK,2,MMPM,100,RAPTO,3,RTRCTO,27.5\nGOTO/10,5,-2\nCYCLE/OFF\nRAPID\nGOTO/10,5,60\n\
    LOADTL/3,1\nCUTTER/14,2\nSPINDL/6000,CLW\nCOOLNT/OFF\nOPSTOP\nRAPID\nGOTO/0,0,20,0,0.1,1\nFEDRAT/500,MMPM\nGOTO/0,0,1,0,0.1,1\n\
    CIRCLE/20,0,1,0,0,1\nGOTO/40,0,1\nSPINDL/8000\nCOOLNT/MIST\nFEDRAT/800\nDELAY/2\nGOTO/40,15,1,0,0.2,1\nRAPID\nGOTO/40,15,50\n\
    CUTTER/6,0,3,0,0,0,80\nLOADTL/7\nSPINDL/400,CLW\nRAPID\nGOTO/10,20,30,0,0,1\nCYCLE/TAP,FEDTO,8,MMPM,400,RAPTO,4\nGOTO/10,20,-2\nGOTO/40,20,-2\nCYCLE/OFF\n\
    RAPID\nGOTO/40,20,60\nLOADTL/12\nSPINDL/2000,CCLW\nRAPID\nGOTO/0,0,30\nCYCLE/BORE,FEDTO,2,MMPM,50,RAPTO,1\nGOTO/0,0,0\nCYCLE/OFF\nFINI\n";

fn machine(dialect: Dialect) -> Machine {
    let name = if dialect == Dialect::LinuxCnc { "linuxcnc-xyzac" } else { "trunnion-ac" };
    Machine::built_in(name).expect("a built-in machine")
}

#[test]
fn every_tool_makes_its_moves_in_every_dialect() {
    for dialect in Dialect::ALL {
        for feed in [FeedMode::Tcp, FeedMode::Kf] {
            let one =
                posted(THREE, &machine(dialect), dialect, feed).unwrap_or_else(|e| panic!("{dialect}: {e}"));
            assert_eq!(one.difference(), None, "{dialect}\n{}", one.text);
            let numbers: Vec<_> = one.outline.sections.iter().map(|s| s.tool.number).collect();
            assert_eq!(numbers, [Some(12), Some(3), Some(7), Some(12)]);
            let speeds = [(Some(12), 3500.0), (Some(3), 6000.0), (Some(7), 400.0)];
            assert_eq!(one.back.speeds_rpm, speeds, "{dialect}");
            let tools = one.text.lines().filter(|l| l.contains("M6") || l.contains("TOOL CALL 1")).count();
            assert!(tools >= 2, "{}", one.text);
        }
    }
}

#[test]
fn sections_know_their_tools() {
    let cl = ClStream::new(|| Ok(Cursor::new(THREE.as_bytes())), ClReadOptions::default());
    let outline = cl.outline().unwrap();
    let lost: Vec<_> = outline.diagnostics.iter().filter(|d| d.severity == Severity::Loss).collect();
    assert!(lost.is_empty(), "{lost:?}");
    let [drill, mill, tap, bore] = &outline.sections[..] else { panic!("{:?}", outline.sections) };
    // The point before the first tool is the drill's; loaded again it has its cutter still.
    assert_eq!((drill.line, drill.moves), (6, 2 + 2 * 5 + 2 + 3 + 2 * 2 + 2 + 1));
    assert_eq!(bore.tool.cutter, drill.tool.cutter);
    assert_eq!(bore.tool.spindle, Some(Spindle::Counter { rpm: 2000.0 }));
    let toroidal = CutterSpec::Toroidal { diameter_mm: 14.0, corner_radius_mm: 2.0, length_mm: 42.0 };
    assert_eq!(mill.tool.cutter, Some(toroidal));
    assert_eq!(mill.tool.coolant, None);
    let dwells = drill.auxiliary.iter().filter(|a| a.word == AuxiliaryWord::Dwell { seconds: 1.5 });
    assert_eq!(dwells.count(), 2);
    let words: Vec<AuxiliaryWord> = mill.auxiliary.iter().map(|a| a.word).collect();
    assert_eq!(words[0], AuxiliaryWord::OptionalStop);
    assert!(words.contains(&AuxiliaryWord::Spindle(Spindle::Clockwise { rpm: 8000.0 })));
    assert!(words.contains(&AuxiliaryWord::Dwell { seconds: 2.0 }));
    let turns: Vec<AuxiliaryWord> = tap.auxiliary.iter().map(|a| a.word).collect();
    let (back, on) = (Spindle::Counter { rpm: 400.0 }, Spindle::Clockwise { rpm: 400.0 });
    assert_eq!(turns, [back, on, back, on].map(AuxiliaryWord::Spindle));
}

/// The next tool is put ready behind each call, and what is read back stays the same.
#[test]
fn the_next_tool_is_put_ready() {
    for dialect in Dialect::ALL {
        let plain = posted(THREE, &machine(dialect), dialect, FeedMode::Tcp).unwrap();
        let ready = cl_text::posted_ready(THREE, &machine(dialect), dialect, FeedMode::Tcp).unwrap();
        assert_eq!(ready.difference(), None, "{dialect}\n{}", ready.text);
        assert_eq!(
            (&ready.back.moves.len(), &ready.back.speeds_rpm),
            (&plain.back.moves.len(), &plain.back.speeds_rpm)
        );
        let bare = |line: &str| {
            let line = line.trim_start_matches(|c: char| c == 'N' || c.is_ascii_digit()).trim();
            line.strip_prefix(if dialect == Dialect::Heidenhain { "TOOL DEF " } else { "T" })?
                .parse::<u32>()
                .ok()
        };
        let numbers: Vec<u32> = ready.text.lines().filter_map(bare).collect();
        // Sinumerik selects with the same word before M6.
        let want: &[u32] =
            if dialect == Dialect::Sinumerik { &[12, 3, 3, 7, 7, 12, 12] } else { &[3, 7, 12] };
        assert_eq!(numbers, want, "{dialect}\n{}", ready.text);
    }
}

/// A tap turns back at the bottom and not before, in every dialect.
#[test]
fn taps_turn_back_at_the_bottom() {
    for dialect in Dialect::ALL {
        let one = posted(THREE, &machine(dialect), dialect, FeedMode::Tcp).unwrap();
        let lines: Vec<&str> = one.text.lines().collect();
        let at: Vec<usize> = (0..lines.len()).filter(|k| lines[*k].split(' ').any(|w| w == "M4")).collect();
        // Twice in the taps, once for the bore.
        assert_eq!(at.len(), 3, "{dialect}\n{}", one.text);
        for k in &at[..2] {
            let z = |k: usize| lines[k].split(' ').find_map(|w| w.strip_prefix('Z')?.parse::<f64>().ok());
            let before = (0..*k).rev().find_map(z).unwrap();
            let after = (*k..lines.len()).find_map(z).unwrap();
            assert!(
                (before + 10.0).abs() < 1e-3 && (after - 2.0).abs() < 1e-3,
                "{dialect}: {before} {after}"
            );
        }
    }
}

/// Moves of a text, all tools together.
fn moves(text: &str) -> Vec<(Point3, Vec3, bool)> {
    let cl = ClStream::new(|| Ok(Cursor::new(text.as_bytes())), ClReadOptions::default());
    let outline = cl.outline().expect("CL data");
    let lost: Vec<_> = outline.diagnostics.iter().filter(|d| d.severity == Severity::Loss).collect();
    assert!(lost.is_empty(), "{text}: {lost:?}");
    let mut all = Vec::new();
    for part in cl.parts(&outline) {
        part.pieces(7, &mut |piece| {
            all.extend(
                piece.iter().map(|m| (m.pose.tip, m.pose.axis.into_inner(), m.motion == Motion::Rapid)),
            );
            ControlFlow::Continue(())
        })
        .expect("it can be read again");
    }
    all
}

/// Placings as whoever writes the points out would have them.
#[test]
fn copies_and_placings_are_the_points_written_out() {
    let head = "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\n";
    // A hole with an arc beside it, three in a row, four rows about Z, the tool leaning; then a mirror, and back.
    let short = format!(
        "{head}INDEX/1\nINDEX/2\nRAPID\nGOTO/10,2,5,0,0.6,0.8\nGOTO/10,2,1\nCIRCLE/10,4,1,0,0,1\nGOTO/10,6,1\nGODLTA/4\nFEDRAT/200\n\
         COPY/2,TRANSL,5,0,0,2\nCOPY/1,XYROT,90,3\nTRACUT/-1,0,0,7,0,1,0,0,0,0,1,0\nRAPID\nGOTO/1,2,3\nGOTO/2,2,3\nTRACUT/NOMORE\nGOTO/4,4,4\nFINI\n"
    );
    let one: Vec<_> = moves(&format!(
        "{head}RAPID\nGOTO/10,2,5,0,0.6,0.8\nGOTO/10,2,1\nCIRCLE/10,4,1,0,0,1\nGOTO/10,6,1\nGODLTA/4\nFINI\n"
    ));
    let (approach, hole) = (one[0], &one[1..]);
    let mut want = vec![approach];
    for turn in 0..4 {
        let (s, c) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][turn];
        let about = |v: Vec3| Vec3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
        for row in [0.0, 5.0, 10.0] {
            want.extend(hole.iter().map(|(p, a, rapid)| {
                (Point3::from(about(p.coords + Vec3::new(row, 0.0, 0.0))), about(*a), *rapid)
            }));
        }
    }
    let axis = Vec3::new(0.0, 0.6, 0.8);
    want.push((Point3::new(6.0, 2.0, 3.0), axis, true));
    want.push((Point3::new(5.0, 2.0, 3.0), axis, false));
    want.push((Point3::new(4.0, 4.0, 4.0), axis, false));
    let got = moves(&short);
    assert_eq!(got.len(), want.len());
    for (k, (g, w)) in got.iter().zip(&want).enumerate() {
        assert!(
            (g.0 - w.0).norm() < 1e-12 && (g.1 - w.1).norm() < 1e-12 && g.2 == w.2,
            "{k}: {g:?} is not {w:?}"
        );
    }
    for dialect in Dialect::ALL {
        let one = posted(&short, &machine(dialect), dialect, FeedMode::Tcp)
            .unwrap_or_else(|e| panic!("{dialect}: {e}"));
        assert_eq!(one.difference(), None, "{dialect}\n{}", one.text);
    }
}

/// Holes of a cycle in a copy, and two tools behind each other with copies of their own.
#[test]
fn copies_have_the_cycles_and_the_tool_of_what_they_repeat() {
    let text = "CUTTER/10\nLOADTL/1\nSPINDL/500\nINDEX/3\nRAPID\nGOTO/0,0,9\nCYCLE/DRILL,FEDTO,4,MMPM,50,RAPTO,2\nGOTO/0,0,0\nCYCLE/OFF\n\
        COPY/3,TRANSL,0,20,0,2\nLOADTL/2\nCUTTER/6\nINDEX/3\nRAPID\nGOTO/50,0,9\nFEDRAT/70\nGOTO/50,0,0\nCOPY/3,YZROT,-10,1\nFINI\n";
    let got = moves(text);
    let bottoms: Vec<f64> = got.iter().filter(|m| m.0.z == -4.0).map(|m| m.0.y).collect();
    assert_eq!(bottoms, [0.0, 20.0, 40.0]);
    let one = posted(text, &machine(Dialect::Fanuc), Dialect::Fanuc, FeedMode::Tcp).unwrap();
    assert_eq!(one.difference(), None);
    assert_eq!(one.moves.iter().map(Vec::len).collect::<Vec<_>>(), [3 * 5, 4]);
}

/// A board that is drilled from both sides: a table that turns about X reaches them, a trunnion does not.
#[test]
fn both_sides_of_a_board() {
    let text = "CUTTER/6,0,3,1.8,31,0,60\nLOADTL/1\nSPINDL/3000\nRAPID\nGOTO/10,20,25\nCYCLE/DRILL,FEDTO,5,MMPM,300,RAPTO,3\nGOTO/10,20,0\nCYCLE/OFF\n\
        CUTTER/8,0,4,0,0,0,60\nLOADTL/2\nSPINDL/4000\nRAPID\nGOTO/10,20,-55,0,0,-1\nFEDRAT/500\nGOTO/10,20,-29,0,0,-1\nCUTCOM/LEFT\nGOTO/60,20,-29,0,0,-1\n\
        CUTCOM/OFF\nRAPID\nGOTO/60,20,-55,0,0,-1\nFINI\n";
    let table = cl_text::four_axes();
    for dialect in Dialect::ALL {
        let feed = if dialect == Dialect::LinuxCnc { FeedMode::InverseTime } else { FeedMode::Tcp };
        let one = posted(text, &table, dialect, feed).unwrap_or_else(|e| panic!("{dialect}: {e}"));
        assert_eq!(one.difference(), None, "{dialect}\n{}", one.text);
        let e =
            posted(text, &machine(dialect), dialect, FeedMode::Tcp).err().expect("it does not reach below");
        assert!(e.section == 1 && e.to_string().contains("joint A"), "{e}");
    }
}

/// One path has one tool: whoever reads the text so is told what it leaves out.
#[test]
fn a_single_path_says_what_it_leaves_out() {
    let data = read(THREE).unwrap();
    let lost: Vec<String> =
        data.diagnostics.iter().filter(|d| d.severity == Severity::Loss).map(ToString::to_string).collect();
    for word in ["tool change to 3", "tool change to 7", "SPINDL/8000", "reversed"] {
        assert!(lost.iter().any(|l| l.contains(word)), "{word}: {lost:#?}");
    }
}

#[test]
fn what_cannot_be_said_is_a_loss_with_its_line() {
    let head = "CUTTER/10\nLOADTL/1\nSPINDL/500\nFEDRAT/100\nRAPID\nGOTO/0,0,9\n";
    let found = |text: &str| {
        let text = format!("{head}{text}GOTO/1,0,0\nGOTO/2,0,0\nFINI\n");
        let cl = ClStream::new(|| Ok(Cursor::new(text.clone().into_bytes())), ClReadOptions::default());
        cl.outline().map(|o| {
            let lost = o.diagnostics.into_iter().filter(|d| d.severity == Severity::Loss);
            lost.map(|d| d.to_string()).collect::<Vec<_>>()
        })
    };
    for (text, word) in [
        ("CUTCOM/LEFT\n", "line 7: CUTCOM"),
        ("CUTTER/12\n", "line 7: another CUTTER/"),
        ("LOADTL/MILL\n", "line 7: LOADTL/MILL"),
        ("CYCLE/TAP,50.7,1.0\n", "line 7: CYCLE/TAP"),
        (
            "TRACUT/0,0,0,0,0,1,5\n",
            "line 7: TRACUT/ is not interpreted and may change the tool's way: it needs the 12",
        ),
        (
            "TRACUT/2,0,0,0,0,2,0,0,0,0,2,0\n",
            "line 7: TRACUT/ is not interpreted and may change the tool's way: its matrix",
        ),
        (
            "COPY/1,TRANSL,10,0,0,3\n",
            "line 7: COPY/ is not interpreted and may change the tool's way: no INDEX/",
        ),
        ("INDEX/1\nGOTO/5,5,5\nCOPY/1,TURN,10,3\n", "line 9: COPY/ is not interpreted"),
        (
            "INDEX/1\nGOTO/5,5,5\nLOADTL/2\nCOPY/1,SAME,3\n",
            "line 10: COPY/ is not interpreted and may change the tool's way: another tool",
        ),
        (
            "INDEX/1\nCIRCLE/5,0,0,0,0,1\nGOTO/10,0,9\nCOPY/1,SAME,3\n",
            "line 10: COPY/ is not interpreted and may change the tool's way: what it repeats begins with an arc",
        ),
        ("CALLSUB/1001\n", "line 7: CALLSUB"),
        ("SPINDL/500,SFM\n", "line 7: SPINDL/"),
    ] {
        let lost = found(text).unwrap();
        assert!(lost.iter().any(|l| l.contains(word)), "{text}: {lost:?}");
    }
    for harmless in ["CUTCOM/OFF\n", "TRNTYP/WORLD,0,0,0\nCSYS/-1,0,0,0,0,1,0,0,0,0,-1,0\n", "LOADTL/1,1\n"] {
        assert_eq!(found(harmless).unwrap(), Vec::<String>::new(), "{harmless}");
    }
    for (text, word) in [
        ("SPINDL/-500\n", "line 7: a spindle speed of -500"),
        ("DELAY/1e9\n", "line 7: a dwell of 1000000000 s"),
        ("DELAY/-1\n", "line 7: a dwell of -1 s"),
        ("MOVARC/-1000000,0,9,0,0,1,1000000,ANGLE,36000\nGOTO/0,0,9\n", "line 7: the arc asks for"),
        (
            "INDEX/1\nGOTO/0,0,1\nINDEX/2\nGOTO/0,0,2\nCOPY/2,SAME,90000\nCOPY/1,SAME,90000\n",
            "line 12: COPY/ asks for",
        ),
        ("SPINDL/OFF\nCYCLE/TAP,FEDTO,5,MMPM,100\n", "line 9: a feed or dwell per revolution or a tap"),
    ] {
        let e = found(text).expect_err(text);
        assert!(e.to_string().starts_with(word), "{e}");
    }
    let long = format!("{head}$$ {}\n", "-".repeat(100_000));
    let cl = ClStream::new(|| Ok(Cursor::new(long.clone().into_bytes())), ClReadOptions::default());
    assert!(cl.outline().unwrap_err().to_string().starts_with("line 7: longer than"));
}
