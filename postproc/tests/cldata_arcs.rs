//! Arcs, cycles and streams of CL data.

use crate::common;

use std::io;

use common::wave;
use osculate_geom::{Point3, Severity};
use osculate_postproc::cldata::{
    ClReadOptions, ClReader, ClStream, ClStreamError, ClWriteOptions, read, write,
};
use osculate_postproc::{
    Coolant, Dialect, FeedMode, Machine, PostError, PostOptions, Setup, SolveError, post, post_from,
};
use osculate_tools::cl::Motion;

const HEAD: &str = "FEDRAT/100,MMPM\nRAPID\nGOTO/10,0,0\n";

fn tips(text: &str) -> Vec<Point3> {
    read(text).expect("CL data").path.moves.iter().map(|m| m.pose.tip).collect()
}

/// Every form of an arc against its closed end, length, sense and sagitta.
#[test]
fn arcs_in_all_forms() {
    let turn = std::f64::consts::TAU;
    let rows = [
        // CAMWorks: centre and axis; NX: with radius and more numbers.
        ("CIRCLE/0,0,0,0,0,1\nGOTO/0,10,0\n", [0.0, 10.0, 0.0], turn / 4.0),
        ("CIRCLE/0,0,0,0,0,-1,10,0.01,0.5\nGOTO/0,10,0\n", [0.0, 10.0, 0.0], 0.75 * turn),
        ("CIRCLE/0,0,0,0,0,1,10\nGOTO/10,0,0\n", [10.0, 0.0, 0.0], turn),
        ("MOVARC/0,0,0,0,0,1,10,ANGLE,90\nGOTO/0,10,0\n", [0.0, 10.0, 0.0], turn / 4.0),
        ("MOVARC/0,0,0,0,0,1,10,ANGLE,450\nGOTO/0,10,0\n", [0.0, 10.0, 0.0], 1.25 * turn),
        ("MOVARC/0,0,0,0,0,1,10,ANGLE,180\n", [-10.0, 0.0, 0.0], turn / 2.0),
        // CATIA: direction of leaving, then circle and line to the end.
        (
            "INDIRV/0,1,0\nTLON,GOFWD/ (CIRCLE/ 0.0, 0.0, 0.0,$\n 10.0),ON,(LINE/ 0,0,0,$\n 0.0, 10.0, 0.0)\n",
            [0.0, 10.0, 0.0],
            turn / 4.0,
        ),
        (
            "INDIRV/0,-1,0\nTLON,GOFWD/(CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)\n",
            [0.0, 10.0, 0.0],
            0.75 * turn,
        ),
    ];
    for (arc, end, angle) in rows {
        let data = read(&format!("{HEAD}{arc}FINI\n")).unwrap();
        let tips: Vec<Point3> = data.path.moves.iter().map(|m| m.pose.tip).collect();
        let last = tips[tips.len() - 1];
        assert!((last - Point3::from(end)).norm() < 1e-9, "{arc}: {last}");
        let mut round = 0.0;
        for pair in tips.windows(2) {
            assert!((pair[1].coords.norm() - 10.0).abs() < 1e-9, "{arc}");
            let middle = nalgebra::center(&pair[0], &pair[1]);
            assert!(10.0 - middle.coords.norm() <= 0.001 + 1e-12, "{arc}: a chord strays");
            let (a, b) = (pair[0], pair[1]);
            round += (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y).abs();
        }
        assert!((round - angle).abs() < 1e-9, "{arc}: {round}");
        assert!(data.path.moves[1..].iter().all(|m| m.motion == Motion::Feed(100.0)));
        let said =
            data.diagnostics.iter().any(|d| d.severity == Severity::Note && d.message.contains("chords"));
        assert!(said, "{:?}", data.diagnostics);
    }
    // A helix rises evenly; another plane; inches.
    let tips = tips(&format!("{HEAD}CIRCLE/0,0,0,0,0,1\nGOTO/-10,0,4\n"));
    for p in &tips[1..] {
        let turned = p.y.atan2(p.x) / std::f64::consts::PI;
        assert!((p.z - 4.0 * turned).abs() < 1e-9, "{p}");
    }
    let data = read("UNITS/INCHES\nFEDRAT/1\nFROM/1,0,0\nCIRCLE/0,0,0,0,1,0\nGOTO/0,0,1\n").unwrap();
    let far = |p: Point3| (p.coords.norm() - 25.4).abs();
    assert!(data.path.moves.iter().all(|m| far(m.pose.tip) < 1e-9 && m.pose.tip.y.abs() < 1e-12));
}

#[test]
fn arcs_that_are_none_are_said() {
    for (arc, place, word) in [
        ("CIRCLE/0,0,0,0,0,1\nGOTO/0,11,0\n", "line 5", "misses its ends"),
        ("CIRCLE/0,0,0,0,0,1\nFINI\n", "line 4", "no end"),
    ] {
        let data = read(&format!("{HEAD}{arc}")).unwrap();
        let hit = data
            .diagnostics
            .iter()
            .any(|d| d.severity == Severity::Loss && d.place == place && d.message.contains(word));
        assert!(hit, "{arc}: {:?}", data.diagnostics);
    }
    let e = read(&format!("{HEAD}CIRCLE/0,0,0\nGOTO/1,1,1\n")).unwrap_err();
    assert!(e.to_string().contains("line 4"), "{e}");
    let e = read(&format!("{HEAD}CIRCLE/0,0,0,0,0,0\nGOTO/1,1,1\n")).unwrap_err();
    assert!(e.to_string().contains("line 4"), "{e}");
}

/// Cycles as the moves that they stand for; forms that are not known are losses with their line.
#[test]
fn cycles_become_moves() {
    let holes = |cycle: &str| {
        let text = format!("{HEAD}CYCLE/INIT\nCYCLE/{cycle}\nGOTO/20,0,1\nCYCLE/OFF\nFINI\n");
        let data = read(&text).unwrap();
        let all: Vec<(f64, bool)> =
            data.path.moves[1..].iter().map(|m| (m.pose.tip.z, m.motion == Motion::Rapid)).collect();
        (all, data)
    };
    let (drill, data) = holes("DRILL,FEDTO,5,MMPM,364.5,RAPTO,3,RTRCTO,27,DWELL,0");
    assert_eq!(drill, [(28.0, true), (4.0, true), (-4.0, false), (4.0, true), (28.0, true)]);
    assert_eq!(data.path.moves[3].motion, Motion::Feed(364.5));
    let (ream, _) = holes("REAM,FEDTO,5,RAPTO,3");
    assert_eq!(ream, [(4.0, true), (4.0, true), (-4.0, false), (4.0, false)]);
    let (deep, _) = holes("DEEP2,FEDTO,9,1STPECK,5,SUBPECK,2,MMPM,100,RAPTO,3,RTRCTO,3");
    let feeds: Vec<f64> = deep.iter().filter(|m| !m.1).map(|m| m.0).collect();
    assert_eq!(feeds, [-4.0, -6.0, -8.0]);
    assert_eq!(deep.iter().filter(|m| m.0 == 4.0).count(), 2 + 3);
    // Along a leaning axis.
    let text = format!("{HEAD}TLAXIS/1,0,0\nCYCLE/DRILL,FEDTO,5,MMPM,9,RAPTO,3\nGOTO/20,0,1\nFINI\n");
    let deepest = tips(&text).iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
    assert!((deepest - 10.0).abs() < 1e-12 || (deepest - 15.0).abs() < 1e-12, "{deepest}");
    for unknown in ["TAP,50.7,1.0", "WEIRD,FEDTO,5", "DEEP,FEDTO,5,STEP,1E-9"] {
        let (_, data) = holes(unknown);
        let hit = data.diagnostics.iter().any(|d| d.severity == Severity::Loss && d.place == "line 5");
        assert!(hit, "{unknown}: {:?}", data.diagnostics);
    }
}

/// Surface speed (turning): revolutions follow the distance from Z, and no file is refused for it.
#[test]
fn surface_speeds() {
    let text =
        "CUTTER/0.8\nFEDRAT/0.1,MMPR\nSPINDL/500,SFM,CCLW\nGOTO/17,0,2\nGOTO/17,0,0\nGOTO/0.2,0,0\nFINI\n";
    let data = read(text).unwrap();
    let feed = |radius: f64| Motion::Feed(0.1 * 500.0 * 304.8 / (std::f64::consts::TAU * radius));
    assert_eq!((data.path.moves[1].motion, data.path.moves[2].motion), (feed(17.0), feed(1.0)));
    assert!(data.diagnostics.iter().any(|d| d.severity == Severity::Loss && d.place == "line 3"));
    assert_eq!(data.path.spindle_rpm, None);
}

fn stream(text: &str) -> ClStream<impl Fn() -> io::Result<io::Cursor<Vec<u8>>>> {
    ClStream::new(|| Ok(io::Cursor::new(text.as_bytes().to_vec())), ClReadOptions::default())
}

/// A text read as a stream gives the program of the path in memory, and errors say the line and the way.
#[test]
fn streams() {
    let path = wave(20_000, 0.0);
    let text = write(&path, &ClWriteOptions::default()).unwrap();
    let (machine, setup) = (Machine::built_in("trunnion-ac").unwrap(), Setup::default());
    let options = PostOptions::new(Dialect::Fanuc, FeedMode::InverseTime);
    let whole = post(&read(&text).unwrap().path, &machine, &setup, &options).unwrap();
    let cl = stream(&text);
    let head = cl.head().unwrap();
    assert_eq!(head.coolant(), None);
    let options = PostOptions { spindle_rpm: head.spindle_rpm(), ..options };
    let mut sink = Vec::new();
    let report = post_from(&cl, &machine, &setup, &options, &mut sink).unwrap();
    assert_eq!(String::from_utf8(sink).unwrap(), whole.text);
    assert_eq!(report.summary, whole.summary);
    let place = cl.locate(&[0, 19_999, 30_000]).unwrap();
    assert_eq!(place.len(), 2);
    assert_eq!((place[0].line, place[0].length_mm), (7, 0.0));
    let length: f64 = path.moves.windows(2).map(|w| (w[1].pose.tip - w[0].pose.tip).norm()).sum();
    assert!((place[1].length_mm / length - 1.0).abs() < 1e-6);

    let bad = text.replacen("FINI", "GOTO/0,0,0,0,0,-1\nFINI", 1);
    let e = post_from(&stream(&bad), &machine, &setup, &options, &mut Vec::new()).unwrap_err();
    assert_eq!(e.index(), Some(20_000));
    assert!(matches!(e, PostError::Solve(SolveError::Limit { .. })), "{e}");
    let cut = text.replacen("FINI", "GOTO/0,0,x", 1);
    let e = post_from(&stream(&cut), &machine, &setup, &options, &mut Vec::new()).unwrap_err();
    assert!(
        matches!(e, PostError::Source(ClStreamError::Read(_))) && e.to_string().contains("line 20008"),
        "{e}"
    );
    let gone =
        ClStream::new(|| Err::<io::Empty, _>(io::ErrorKind::NotFound.into()), ClReadOptions::default());
    let e = post_from(&gone, &machine, &setup, &options, &mut Vec::new()).unwrap_err();
    assert!(matches!(e, PostError::Source(ClStreamError::Io { kind: io::ErrorKind::NotFound })), "{e}");
}

#[test]
fn a_reader_keeps_nothing() {
    let mut reader = ClReader::default();
    for k in 0..5000 {
        reader.line("RAPID").unwrap();
        reader.line(&format!("GOTO/{k},0,0")).unwrap();
        assert_eq!((reader.take_moves().count(), reader.waiting()), (1, 0));
    }
    reader.end().unwrap();
}

/// Coolant goes from the CL data into every dialect, and off at the end.
#[test]
fn coolant() {
    let text =
        "COOLNT/MIST\nSPINDL/900\nCUTTER/6\nRAPID\nGOTO/0,0,5\nFEDRAT/100\nGOTO/1,0,0\nCOOLNT/OFF\nFINI\n";
    let head = stream(text).head().unwrap();
    assert_eq!(head.coolant(), Some(Coolant::Mist));
    let (machine, setup) = (Machine::built_in("3-axis").unwrap(), Setup::default());
    for dialect in Dialect::ALL {
        let options = PostOptions { coolant: head.coolant(), ..PostOptions::new(dialect, FeedMode::Kf) };
        let posted = post(&read(text).unwrap().path, &machine, &setup, &options).unwrap();
        let at = |word: &str| posted.text.lines().position(|l| l.split(' ').any(|w| w == word)).unwrap();
        assert!(at("M3") <= at("M7") && at("M7") < at("M9") && at("M9") < at("M5"), "{}", posted.text);
        let options = osculate_postproc::readback::ReadOptions::default();
        osculate_postproc::readback::read(&posted.text, dialect, &machine, &setup, &options).unwrap();
    }
}
