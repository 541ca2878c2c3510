//! What a text may ask for in memory and time, and numbers that no control takes: refused, with line and value.

use osculate_postproc::cldata::{ClReadError, read as read_cl};
use osculate_postproc::readback::{ReadError, ReadOptions, read};
use osculate_postproc::{
    Auxiliary, AuxiliaryWord, Dialect, FeedMode, Machine, PostError, PostOptions, Setup, SolveError, Spindle,
    built_in_text, post,
};

/// A trunnion without limits.
fn endless() -> Machine {
    let text = built_in_text("trunnion-ac").expect("built in");
    let lines: Vec<&str> =
        text.lines().filter(|l| !l.starts_with("min_") && !l.starts_with("max_mm")).collect();
    let text = lines.join("\n").replace("max_deg = 120\n", "");
    Machine::from_toml(&text).expect("a machine")
}

fn back(text: &str, dialect: Dialect) -> Result<usize, ReadError> {
    read(text, dialect, &endless(), &Setup::default(), &ReadOptions::default()).map(|b| b.moves.len())
}

/// Four lines of a program that would be tens of millions of moves.
#[test]
fn ways_of_a_block_are_bounded() {
    let start = "G0 X0 Y0 Z0 A0 C0\n";
    for (text, dialect) in [
        ("G2 X0 Y0 I900000000 J0 F1000\nM30\n", Dialect::LinuxCnc),
        ("G1 X1000 C400000000 F1000\nM30\n", Dialect::LinuxCnc),
        ("G1 Y900000000 A90 F1000\nM30\n", Dialect::Sinumerik),
    ] {
        let e = back(&format!("{start}{text}"), dialect).unwrap_err();
        assert!(matches!(e, ReadError::Bound { line: 2, .. }), "{text}: {e}");
    }
    // A thousand turns of a helix are within it.
    assert!(back(&format!("{start}G1 X10 C36000 F1000\nM30\n"), Dialect::LinuxCnc).unwrap() > 1000);
}

#[test]
fn blocks_of_a_move_are_bounded() {
    let text = "FEDRAT/1000\nRAPID\nGOTO/0,0,0,0,0,1\nGOTO/100000000,0,0,1,0,1\nFINI\n";
    let options = PostOptions::new(Dialect::Sinumerik, FeedMode::InverseTime);
    let e = post(&read_cl(text).unwrap().path, &endless(), &Setup::default(), &options).unwrap_err();
    assert!(matches!(e, PostError::Solve(SolveError::Pieces { index: 1, .. })), "{e}");
}

#[test]
fn numbers_that_no_control_holds() {
    for (text, dialect) in [
        ("G0 X1000000000000\n", Dialect::Fanuc),
        ("G0 C=DC(1E30)\n", Dialect::Sinumerik),
        ("S99999999999 M3\n", Dialect::LinuxCnc),
        ("L X+99999999999 FMAX\n", Dialect::Heidenhain),
    ] {
        let e = back(text, dialect).unwrap_err();
        assert!(matches!(e, ReadError::Syntax { line: 1, .. }), "{text}: {e}");
    }
    let path = read_cl("RAPID\nGOTO/0,0,5\nFEDRAT/100\nGOTO/1,0,0\n").unwrap().path;
    let machine = Machine::built_in("3-axis").unwrap();
    let refused = |options: PostOptions| {
        post(&path, &machine, &Setup::default(), &options).expect_err("refused").to_string()
    };
    let plain = PostOptions::new(Dialect::Fanuc, FeedMode::Kf);
    for rpm in [1e308, 1e6, 0.0, -5.0, f64::NAN, f64::INFINITY] {
        let text = refused(PostOptions { spindle_rpm: Some(rpm), ..plain.clone() });
        assert!(text.contains("at most 999999"), "{text}");
        let auxiliary = vec![Auxiliary { before: 1, word: AuxiliaryWord::Spindle(Spindle::Counter { rpm }) }];
        let text = refused(PostOptions { auxiliary, ..plain.clone() });
        assert!(text.contains("at most 999999"), "{text}");
    }
    for (text, line) in
        [("FEDRAT/1e300\n", 1), ("\nFEDRAT/1e-30\n", 2), ("CYCLE/DRILL,FEDTO,5,MMPM,1e-9\n", 1)]
    {
        let e = read_cl(text).unwrap_err();
        assert!(matches!(e, ClReadError::Feed { line: at, .. } if at == line), "{e}");
    }
}

#[test]
fn programs_that_nobody_waits_for() {
    let e = back("G0 X0 Y0 Z0 A0 C0\nG1 X900000000 F0.01\nM30\n", Dialect::LinuxCnc).unwrap_err();
    assert!(matches!(e, ReadError::TooLong(t) if t.time_min > 8e10), "{e}");
    assert!(e.to_string().contains("longer than ten years"), "{e}");
    // The same of the clock, and of a path that is posted for a slow machine.
    let text = "G0 X0 Y0 Z0 A0 C0\nG1 X900000000 F0.01\nM30\n";
    let timed =
        osculate_postproc::nc::timing::time(text, Dialect::Fanuc, &endless(), &Setup::default(), true);
    assert!(matches!(timed, Err(ReadError::TooLong(_))), "{timed:?}");
    let path = read_cl("RAPID\nGOTO/0,0,5\nFEDRAT/0.0001\nGOTO/2000,0,0\n").unwrap().path;
    let options = PostOptions::new(Dialect::Heidenhain, FeedMode::Tcp);
    let posted = post(&path, &endless(), &Setup::default(), &options);
    assert!(matches!(posted, Err(PostError::TooLong(_))), "{posted:?}");
}
