//! APT text: what this library writes comes back, and what other systems write is read or named.

use crate::common;

use common::{angle, pose, wave};
use osculate_geom::Severity;
use osculate_postproc::cldata::{ClReadError, ClWriteError, ClWriteOptions, read, write};
use osculate_tools::CutterSpec;
use osculate_tools::cl::{ClMove, ClPath, Motion};
use proptest::prelude::*;

fn whole() -> ClPath {
    let mut path = wave(30, 0.7);
    path.cutter = Some(CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 });
    path.moves[7].motion = Motion::Rapid;
    path.moves[9].motion = Motion::Feed(123.456);
    path
}

#[test]
fn there_and_back() {
    let path = whole();
    let text = write(&path, &ClWriteOptions::default()).unwrap();
    let back = read(&text).unwrap();
    assert_eq!(back.diagnostics, []);
    assert_eq!(back.path.cutter, path.cutter);
    assert_eq!(back.path.spindle_rpm, path.spindle_rpm);
    assert_eq!(back.path.moves.len(), path.moves.len());
    for (a, b) in back.path.moves.iter().zip(&path.moves) {
        assert_eq!(a.motion, b.motion);
        // Seven decimals of a mm and ten of a unit vector, half a count on three components.
        assert!((a.pose.tip - b.pose.tip).norm() < 1e-7);
        assert!(angle(&a.pose.axis, &b.pose.axis) < 1e-10);
    }
    assert!(text.lines().filter(|l| l.starts_with("GOTO/")).count() == path.moves.len());
    // One-shot RAPID: two in the path, two in the text; FEDRAT only where the feed changes.
    assert_eq!(text.matches("RAPID\n").count(), 2);
    assert_eq!(text.matches("FEDRAT/").count(), 3);
}

#[test]
fn forms_of_other_systems() {
    let text = "partno / part\nUNITS / INCHES $$ comment\nSPINDL / 2000, CLW\nFROM / 0, 0, 1\nFEDRAT / 0.004, ipr\n\
                GOTO  /  1.0 , $\n  0., 0.D0\nMULTAX/ON\nGOTO/1,0,0, 0,3,4\nGODLTA/0,0,-0.5\nGODLTA/ 1.\n\
                FEDRAT/10,IPM\nRAPID\nGOTO/0,0,2\nGOTO/1,0,2\nUNITS/MM\nFEDRAT/250\nGOTO/1,2,3,0,0,-1\nFINI\nGOTO/9,9,9\n";
    let data = read(text).unwrap();
    let feed = |f: f64| Motion::Feed(f);
    let want = [
        ([0.0, 0.0, 25.4], [0.0, 0.0, 1.0], Motion::Rapid),
        ([25.4, 0.0, 0.0], [0.0, 0.0, 1.0], feed(0.004 * 25.4 * 2000.0)),
        ([25.4, 0.0, 0.0], [0.0, 3.0, 4.0], feed(0.004 * 25.4 * 2000.0)),
        ([25.4, 0.0, -12.7], [0.0, 3.0, 4.0], feed(0.004 * 25.4 * 2000.0)),
        ([25.4, 0.6 * 25.4, 0.3 * 25.4], [0.0, 3.0, 4.0], feed(0.004 * 25.4 * 2000.0)),
        ([0.0, 0.0, 50.8], [0.0, 3.0, 4.0], Motion::Rapid),
        ([25.4, 0.0, 50.8], [0.0, 3.0, 4.0], feed(254.0)),
        ([1.0, 2.0, 3.0], [0.0, 0.0, -1.0], feed(250.0)),
    ];
    assert_eq!(data.path.moves.len(), want.len());
    for (i, (got, (tip, axis, motion))) in data.path.moves.iter().zip(want).enumerate() {
        let wanted = pose(tip, axis);
        assert!(
            (got.pose.tip - wanted.tip).norm() < 1e-12 && angle(&got.pose.axis, &wanted.axis) < 1e-12,
            "{i}: {got:?}"
        );
        match (got.motion, motion) {
            (Motion::Feed(a), Motion::Feed(b)) => assert!((a - b).abs() < 1e-9, "{i}: {a} is not {b}"),
            (a, b) => assert_eq!(a, b, "{i}"),
        }
    }
}

#[test]
fn what_is_not_interpreted_is_named() {
    let text = "CUTTER/12,0,6,3.6,31,0,63\nLOADTL/1\nSPINDL/1000,CLW\nFEDRAT/100,MMPM\nCOOLNT/FLOOD\nRAPID\nGOTO/0,0,10\n\
                TRACUT/0,0,0,0,0,1,5\nGOTO/1,0,0\nTRACUT/0,0,0,0,0,1,5\nCSYS/1,0,0,0,0,1,0,0,0,0,1,0\nCSYS/0,1,0,0,-1,0,0,0,0,0,1,0\n\
                FROBNI/1\nLOADTL/2\nGOTO/2,0,0\nFINI\n";
    let data = read(text).unwrap();
    assert_eq!((data.path.moves.len(), data.path.cutter), (3, None));
    let said = |place: &str, severity: Severity, word: &str| {
        let hit = data
            .diagnostics
            .iter()
            .any(|d| d.place == place && d.severity == severity && d.message.contains(word));
        assert!(hit, "{place} {word}: {:#?}", data.diagnostics);
    };
    said("line 1", Severity::Loss, "CUTTER/12,0,6,3.6,31,0,63");
    said("line 8", Severity::Loss, "TRACUT/");
    said("line 10", Severity::Loss, "TRACUT/");
    said("line 11", Severity::Note, "CSYS");
    said("line 12", Severity::Loss, "CSYS");
    said("line 13", Severity::Loss, "FROBNI");
    said("line 14", Severity::Loss, "tool change to 2");
    assert_eq!(data.diagnostics.len(), 7);
}

#[test]
fn errors_carry_their_line() {
    let is = |text: &str, want: fn(&ClReadError) -> bool| {
        let e = read(text).unwrap_err();
        assert!(want(&e), "{text}: {e}");
    };
    is("", |e| matches!(e, ClReadError::NoPoints { lines: 0 }));
    is("PARTNO A\nFINI", |e| matches!(e, ClReadError::NoPoints { lines: 2 }));
    is("RAPID\nGOTO/1,x,3", |e| matches!(e, ClReadError::Number { line: 2, field, .. } if field == "X"));
    is("RAPID\nGOTO/1,NaN,3", |e| matches!(e, ClReadError::Number { line: 2, .. }));
    is("RAPID\nGOTO/1,1e999,3", |e| matches!(e, ClReadError::Number { line: 2, .. }));
    is("GOTO/1,2", |e| matches!(e, ClReadError::Count { line: 1, got: 2, .. }));
    is("GOTO/1,2,3,0,0", |e| matches!(e, ClReadError::Count { line: 1, got: 5, .. }));
    is("GOTO/1,2,3,0,0,0", |e| matches!(e, ClReadError::ZeroAxis { line: 1, .. }));
    is("GODLTA/1,2,3", |e| matches!(e, ClReadError::Count { line: 1, .. }));
    is("GOTO/1,2,3\nGOTO/1,2,4", |e| matches!(e, ClReadError::NoFeed { line: 2 }));
    is("FEDRAT/0.1,MMPR\nFROM/0,0,0\nGOTO/1,0,0", |e| matches!(e, ClReadError::NoSpindle { line: 1 }));
    is("\n\nFEDRAT/-5", |e| matches!(e, ClReadError::Feed { line: 3, .. }));
    is("FEDRAT/MMPM", |e| matches!(e, ClReadError::Count { line: 1, got: 0, .. }));
}

#[test]
fn what_is_no_path_is_not_written() {
    let mut path = whole();
    path.moves[4].pose.tip.x = f64::INFINITY;
    assert_eq!(write(&path, &ClWriteOptions::default()), Err(ClWriteError::NotFinite { index: 4 }));
    let mut path = whole();
    path.moves[5].motion = Motion::Feed(-1.0);
    assert_eq!(write(&path, &ClWriteOptions::default()), Err(ClWriteError::NotFinite { index: 5 }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any path within a few metres survives; reading never panics on what a line may hold.
    #[test]
    fn any_path(tips in prop::collection::vec(prop::array::uniform6(-3000.0..3000.0f64), 2..20), feed in 1e-3..1e5f64) {
        let poses = tips.iter().filter(|t| t[3..].iter().any(|c| c.abs() > 1.0));
        let mut moves: Vec<ClMove> = poses
            .map(|t| ClMove { pose: pose([t[0], t[1], t[2]], [t[3], t[4], t[5]]), motion: Motion::Feed(feed), aloft: false })
            .collect();
        prop_assume!(!moves.is_empty());
        moves[0].motion = Motion::Rapid;
        let path = ClPath { moves, ..ClPath::default() };
        let back = read(&write(&path, &ClWriteOptions::default()).unwrap()).unwrap().path;
        for (a, b) in back.moves.iter().zip(&path.moves) {
            prop_assert_eq!(a.motion, b.motion);
            prop_assert!((a.pose.tip - b.pose.tip).norm() < 1e-6 && angle(&a.pose.axis, &b.pose.axis) < 1e-9);
        }
    }

    #[test]
    fn any_text(text in "[A-Z/$,.0-9 \\-\n]{0,200}") {
        let _ = read(&format!("RAPID\nGOTO/0,0,0\nFEDRAT/5\nGOTO/{text}"));
    }
}

/// A feed per revolution may stand before the speed; without any speed the line of the feed is named.
#[test]
fn feed_per_revolution_waits_for_the_spindle() {
    let text = "FROM/0,0,0\nFEDRAT/0.25,MMPR\nSPINDL/4000,RPM\nGOTO/10,0,0\nFINI\n";
    let data = read(text).unwrap();
    assert_eq!(data.path.moves[1].motion, Motion::Feed(1000.0));
    let refused = read(&text.replace("SPINDL/4000,RPM\n", "")).unwrap_err();
    assert!(refused.to_string().contains("line 2"), "{refused}");
}
