//! Dialects made of a file alone: what they write, that it comes back, and what is no dialect file.

use crate::common;

use common::{path, pose};
use osculate_geom::Vec3;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{
    Auxiliary, AuxiliaryWord, Coolant, Dialect, DialectFile, DialectFileError, FeedMode, Machine,
    Orientation, PostOptions, Setup, post, shipped_dialects,
};

/// A file for a control that no line of this library knows; the page that explains dialects to users shows it.
const MADE_UP: &str = include_str!("data/osp.toml");

fn options(dialect: Dialect, feed: FeedMode) -> PostOptions {
    PostOptions {
        tool_number: 4,
        program_number: 12,
        spindle_rpm: Some(5000.0),
        coolant: Some(Coolant::Flood),
        auxiliary: vec![Auxiliary { before: 4, word: AuxiliaryWord::Dwell { seconds: 0.5 } }],
        ..PostOptions::new(dialect, feed)
    }
}

fn posted(file: &DialectFile, feed: FeedMode) -> (String, String) {
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let poses = (0..12).map(|k| {
        let t = f64::from(k);
        pose([t, 0.5 * t, 5.0 - 0.1 * t], [0.1 * t, 0.2, 1.0])
    });
    let setup = Setup::at(Vec3::new(3.0, 4.0, 50.0), 90.0);
    let engine =
        post(&path(poses, 400.0), &machine, &setup, &options(file.engine(), feed)).expect("posted").text;
    let text = file.out(&engine).expect("it can be said");
    (engine, text)
}

fn assert_comes_back(file: &DialectFile, feed: FeedMode) {
    let (engine, text) = posted(file, feed);
    let machine = Machine::built_in("trunnion-ac").expect("built in");
    let setup = Setup::at(Vec3::new(3.0, 4.0, 50.0), 90.0);
    let go = |text: &str| {
        read(text, file.engine(), &machine, &setup, &ReadOptions::default())
            .unwrap_or_else(|e| panic!("{}: {e}\n{text}", file.name()))
    };
    let back_text = file.back_text(&text);
    assert_eq!(back_text.lines().count(), text.lines().count(), "lines stay where they are");
    let (want, got) = (go(&engine), go(&back_text));
    assert_eq!(want.moves.len(), got.moves.len(), "{}", file.name());
    for (a, b) in want.moves.iter().zip(&got.moves) {
        assert_eq!((a.pose, a.motion, a.tool), (b.pose, b.motion, b.tool));
        assert!((a.time_min - b.time_min).abs() < 1e-12);
    }
    assert_eq!(Setup::of_program(&back_text, file.engine()), Setup::of_program(&engine, file.engine()));
}

#[test]
fn a_dialect_made_by_toml_alone() {
    let file = DialectFile::from_toml(MADE_UP).unwrap();
    assert_eq!((file.name(), file.engine(), file.extension()), ("osp", Dialect::Fanuc, "min"));
    let (_, text) = posted(&file, FeedMode::Tcp);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "O0012(OSCULATE)");
    let has = |body: &str| {
        lines.iter().any(|l| {
            l.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit()).trim() == body
        })
    };
    for body in [
        "T4 M06",
        "(TOOL 4 IN)",
        "G15 H1",
        "S5000 M3",
        "M8",
        "G169 HA=4",
        "G131 F2 J1",
        "G130",
        "G170",
        "G4 P500",
        "M02",
    ] {
        assert!(has(body), "{body}\n{text}");
    }
    assert!(!text.contains('%') && !text.contains("G43.4"), "{text}");
    // Every block that moves says how, and at which feed; numbers end with their last digit that counts.
    let moves: Vec<&&str> =
        lines.iter().filter(|l| l.contains(" X")).filter(|l| !l.starts_with('(')).collect();
    assert!(moves.len() > 10);
    assert!(moves.iter().all(|l| l.contains(" G0 ") || l.contains(" G1 ") && l.contains(" F")), "{text}");
    assert!(text.contains(" X1. ") && !text.contains("X1.0000"), "{text}");
    // Blocks are numbered, comments are not.
    let numbers: Vec<u64> =
        lines.iter().filter_map(|l| l.strip_prefix('N')?.split(' ').next()?.parse().ok()).collect();
    assert!(numbers[0] == 100 && numbers.windows(2).all(|w| w[1] == w[0] + 5), "{numbers:?}");
    for feed in [FeedMode::Tcp, FeedMode::Kv { fgref_mm: None }, FeedMode::InverseTime] {
        assert_comes_back(&file, feed);
    }
}

#[test]
fn shipped_dialects_come_back() {
    assert_eq!(shipped_dialects().count(), 3);
    for name in shipped_dialects() {
        let file = DialectFile::shipped(name).unwrap();
        assert_eq!(file.name(), name);
        assert!(!file.description().is_empty());
        for feed in [FeedMode::Tcp, FeedMode::None, FeedMode::InverseTime] {
            assert_comes_back(&file, feed);
        }
    }
    let (_, text) = posted(&DialectFile::shipped("haas").unwrap(), FeedMode::Tcp);
    assert!(text.contains("O00012 (") && text.contains("G234 H4") && text.contains("G187 P3"), "{text}");
    let (_, text) = posted(&DialectFile::shipped("sinumerik-one").unwrap(), FeedMode::Tcp);
    assert!(text.contains(" CYCLE832(0.0020,_FINISH,1)") && text.contains(" SOFT"), "{text}");
}

#[test]
fn what_a_dialect_refuses_is_said() {
    let file = DialectFile::shipped("haas").unwrap();
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let way = path((0..3).map(|k| pose([f64::from(k), 0.0, 5.0], [0.1, 0.2, 1.0])), 400.0);
    let options = PostOptions { orientation: Orientation::Vectors, ..options(Dialect::Fanuc, FeedMode::Tcp) };
    let engine = post(&way, &machine, &Setup::default(), &options).unwrap().text;
    let e = file.out(&engine).unwrap_err();
    assert!(matches!(&e, DialectFileError::Refused { line, .. } if line == "G43.5 H4"), "{e}");
    assert!(e.to_string().contains("haas cannot say"), "{e}");
}

#[test]
fn what_is_no_dialect_file() {
    let refused = |from: &str, to: &str, words: &[&str]| {
        assert!(MADE_UP.contains(from), "{from}");
        let e = DialectFile::from_toml(&MADE_UP.replace(from, to)).expect_err(to).to_string();
        words.iter().for_each(|w| assert!(e.contains(w), "{w}: {e}"));
    };
    refused("format = 1", "format = 2", &["format = 2"]);
    refused(
        "engine = \"fanuc\"",
        "engine = \"okuma\"",
        &["engine", "okuma", "sinumerik, heidenhain, fanuc, linuxcnc"],
    );
    refused("name = \"osp\"", "name = \"fanuc\"", &["name", "no engine's name"]);
    refused("name = \"osp\"", "name = \"O SP\"", &["name", "small letters"]);
    refused("extension = \"min\"", "extension = \"../x\"", &["extension"]);
    refused("letter = \"N\"", "letter = \"B\"", &["blocks.letter"]);
    refused("step = 5", "step = 0", &["step"]);
    refused("engine = \"fanuc\"", "engine = \"sinumerik\"", &["numbers its blocks itself"]);
    refused("words = [\"M02\"]", "wrds = [\"M02\"]", &["wrds"]);
    refused("words = [\"M02\"]", "", &["rule 9", "M30", "words or refused"]);
    refused("words = [\"M02\"]", "words = [\"G170\"]", &["rule 9", "rule 6 says the same"]);
    refused("words = [\"G169 HA={tool}\"]", "words = [\"G169\"]", &["rule 5", "{tool}", "read back"]);
    refused("(TOOL {tool} IN)", "(TOOL {length} IN)", &["rule 4", "a name that the engine's line has not"]);
    refused("G131 F2 J1", "G131 F{", &["rule 7", "does not close"]);
}
