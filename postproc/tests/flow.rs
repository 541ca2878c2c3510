//! Subprograms, labels and loops with literal counts: read back they are the lines that the control runs, and nothing else; what asks for
//! too much or is not understood is said.

use osculate_geom::Severity;
use osculate_postproc::nc::timing;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, Machine, Setup};

fn machine() -> Machine {
    Machine::built_in("3-axis").expect("a built-in machine")
}

/// X Y Z of every move, rounded to um.
fn way(text: &str, dialect: Dialect) -> Vec<[i64; 3]> {
    let back = read(text, dialect, &machine(), &Setup::default(), &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{dialect}: {e}\n{text}"));
    assert!(back.diagnostics.iter().all(|d| d.severity != Severity::Loss), "{:?}", back.diagnostics);
    #[allow(clippy::cast_possible_truncation)]
    let um = |v: f64| (v * 1000.0).round() as i64;
    let own = back.moves.iter().filter(|m| !m.own_frame);
    own.map(|m| m.pose.tip).map(|p| [um(p.x), um(p.y), um(p.z)]).collect()
}

/// A text with an order of its own, and the same written out.
fn alike(dialect: Dialect, short: &str, long: &str) {
    assert_eq!(way(short, dialect), way(long, dialect), "{dialect}\n{short}");
    let time = |text: &str| {
        timing::time(text, dialect, &machine(), &Setup::default(), true)
            .expect("it can be timed")
            .time
            .time_min()
    };
    let (a, b) = (time(short), time(long));
    assert!((a - b).abs() < 1e-9 * b, "{dialect}: {a} min, written out {b} min\n{short}");
}

const HEAD: &str = "G17 G21 G90 G94\nG0 X0 Y0 Z10\n";
/// Down, on by ten, up.
const HOLE: &str = "G1 Z-2 F100\nG0 Z10\nG91 X10 G90\n";

#[test]
fn klartext_labels() {
    let head = "0 BEGIN PGM A MM\n1 L X+0 Y+0 Z+10 R0 FMAX\n";
    let hole = "L Z-2 F100\nL Z+10 FMAX\nL IX+10 FMAX\n";
    let end = "M30\n";
    let tail = "END PGM A MM\n";
    alike(
        Dialect::Heidenhain,
        &format!(
            "{head}CALL LBL 1\nL IY+5 FMAX\nCALL LBL \"ROW\"\n{end}LBL 1\n{hole}LBL 0\nLBL \"ROW\"\nCALL LBL 1\nCALL LBL 1\nLBL 0\n{tail}"
        ),
        &format!("{head}{hole}L IY+5 FMAX\n{hole}{hole}{end}{tail}"),
    );
    // Parts of a program that come again: the count says how often more; rows in rows.
    alike(
        Dialect::Heidenhain,
        &format!("{head}LBL 5\nLBL 6\n{hole}CALL LBL 6 REP 2\nL X+0 IY+5 FMAX\nCALL LBL 5 REP1\n{end}{tail}"),
        &format!("{head}{0}L X+0 IY+5 FMAX\n{0}L X+0 IY+5 FMAX\n{end}{tail}", hole.repeat(3)),
    );
    // A subprogram that stands before the end is run through where it stands too.
    alike(
        Dialect::Heidenhain,
        &format!("{head}LBL 7\n{hole}LBL 0\nCALL LBL 7\n{end}{tail}"),
        &format!("{head}{hole}{hole}{end}{tail}"),
    );
}

#[test]
fn fanuc_subprograms_and_loops() {
    for sub in ["O20", "O0020 (HOLE)"] {
        for call in ["M98 P20 L3", "M98 P30020", "M98 P0020 L3", "N90 M98 P20 L3 (three holes)"] {
            alike(
                Dialect::Fanuc,
                &format!("%\nO0001 (MAIN)\n{HEAD}{call}\nG0 Y5\nM98 P20\nM30\n{sub}\n{HOLE}M99\n%\n"),
                &format!("%\nO0001 (MAIN)\n{HEAD}{0}{0}{0}G0 Y5\n{0}M30\n%\n", HOLE),
            );
        }
    }
    alike(
        Dialect::Fanuc,
        &format!(
            "O1\n{HEAD}#1=0\nWHILE [#1 LT 3] DO1\n#2=5\nWHILE[#2GT4]DO2\n{HOLE}#2=#2-1\nEND2\n#1=#1+1\nG0 Y5\nEND1\nM30\n"
        ),
        &format!("O1\n{HEAD}{0}G0 Y5\n{0}G0 Y5\n{0}G0 Y5\nM30\n", HOLE),
    );
    alike(
        Dialect::Fanuc,
        &format!("O1\n{HEAD}#1=9\nWHILE [#1 LT 3] DO1\n{HOLE}END1\nG0 Y5\nM30\n"),
        &format!("O1\n{HEAD}G0 Y5\nM30\n"),
    );
}

#[test]
fn linuxcnc_words() {
    alike(
        Dialect::LinuxCnc,
        &format!(
            "o<hole> sub\n{HOLE}o<hole> endsub\n{HEAD}o<hole> call\no1 repeat [2]\no<hole> call\nG0 Y5\no1 endrepeat\nM2\n"
        ),
        &format!("{HEAD}{0}{0}G0 Y5\n{0}G0 Y5\nM2\n", HOLE),
    );
    alike(
        Dialect::LinuxCnc,
        &format!(
            "{HEAD}#1 = 1\nO10 while [#1 LE 2]\n{HOLE}#1 = [#1 + 1]\nO10 endwhile\nM98 P7 L2\nM2\nO7\n{HOLE}M99\n"
        ),
        &format!("{HEAD}{}M2\n", HOLE.repeat(4)),
    );
}

#[test]
fn sinumerik_repeats() {
    let hole = HOLE;
    alike(
        Dialect::Sinumerik,
        &format!("{HEAD}N40 HOLE: {hole}N80 REPEAT HOLE P=2\nG0 Y5\nFOR R1=1 TO 3\n{hole}ENDFOR\nM30\n"),
        &format!("{HEAD}{0}{0}{0}G0 Y5\n{0}{0}{0}M30\n", hole),
    );
    alike(
        Dialect::Sinumerik,
        &format!("{HEAD}FIRST: {hole}LAST: G0 Y5\nREPEAT FIRST LAST P=2\nREPEATB LAST\nM30\n"),
        &format!("{HEAD}{0}G0 Y5\n{0}G0 Y5\n{0}G0 Y5\nG0 Y5\nM30\n", hole),
    );
    alike(
        Dialect::Sinumerik,
        &format!(
            "{HEAD}ROW: {hole}ENDLABEL:\nG0 Y5\nREPEAT ROW P=1\nR5=0\nWHILE R5<2\n{hole}R5=R5+1\nENDWHILE\nM30\n"
        ),
        &format!("{HEAD}{0}G0 Y5\n{0}{0}{0}M30\n", hole),
    );
}

/// What the text says of it with `strict`.
fn refused(text: &str, dialect: Dialect) -> String {
    let options = ReadOptions::default();
    let e = read(text, dialect, &machine(), &Setup::default(), &options).expect_err(text);
    e.to_string()
}

#[test]
fn what_asks_for_too_much_or_is_not_known_is_refused() {
    use Dialect::{Fanuc, Heidenhain, LinuxCnc, Sinumerik};
    for (dialect, body, want) in [
        (
            Fanuc,
            "M98 P9 L9999999\nM30\nO9\nG0 X1\nM99\n",
            "line 4: more than 300000 lines run by calls and repeats",
        ),
        (Fanuc, "M98 P9\nM30\nO9\nM98 P9\nM99\n", "line 7: more than 16 calls and repeats within each other"),
        (Fanuc, "M98 P9\nM30\nO9\nG0 X1\n", "line 4: the subprogram that is called here has no end"),
        (Fanuc, "M98 P77\nM30\n", "line 4: M98 is not interpreted"),
        (Fanuc, "M99\n", "line 4: M99 is not interpreted"),
        (Fanuc, "#1=0\nWHILE[#1LT2]DO1\nG0 X1\nEND1\nM30\n", "line 7: more than 300000 lines run"),
        (Fanuc, "WHILE[#1LT2]DO1\nG0 X1\nEND1\nM30\n", "line 4: WHILE[#1LT2] is not"),
        (Fanuc, "IF[#1LT2]GOTO10\nM30\n", "line 4: IF is not interpreted"),
        (LinuxCnc, "o1 repeat [1000000]\nG0 X1\no1 endrepeat\nM2\n", "line 6: more than 300000 lines run"),
        (LinuxCnc, "o1 repeat [4000000000]\no1 endrepeat\nM2\n", "line 5: more than 300000 lines run"),
        (LinuxCnc, "o<gone> call\nM2\n", "line 4: "),
        (LinuxCnc, "o1 if [#1 EQ 1]\nG0 X1\no1 endif\nM2\n", "line 4: IF is not interpreted"),
        (Sinumerik, "REPEAT GONE P=2\nM30\n", "line 4: REPEAT"),
        (Sinumerik, "HERE: G0 X1\nREPEAT HERE P=9999999\nM30\n", "line 5: more than 300000 lines run"),
        (Sinumerik, "HERE: G0 X1\nIF R1<5 GOTOB HERE\nM30\n", "line 5: IF is not interpreted"),
        (Sinumerik, "R1=SIN(3)\nM30\n", "line 4: "),
    ] {
        let text = format!("%\n{HEAD}{body}").replace('%', if dialect == Fanuc { "O1" } else { "" });
        let said = refused(&text, dialect);
        assert!(said.starts_with(want), "{dialect} {body}: {said}");
    }
    let said = refused("L X+0 Y+0 Z+9 FMAX\nCALL LBL 9\nM30\n", Heidenhain);
    assert!(said.starts_with("line 2: CALL LBL 9 is not interpreted"), "{said}");
    // Read leniently such a text goes on, and what was left out is a loss.
    let lenient = ReadOptions { strict: false, ..ReadOptions::default() };
    let back =
        read(&format!("{HEAD}o<gone> call\nG0 X7\nM2\n"), LinuxCnc, &machine(), &Setup::default(), &lenient)
            .unwrap();
    assert!(
        back.diagnostics.iter().any(|d| d.severity == Severity::Loss && d.place == "line 3"),
        "{:?}",
        back.diagnostics
    );
}
