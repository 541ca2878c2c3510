//! Programs that are written otherwise and do the same: the same moves in the same time, and the same findings but for
//! their lines.

use crate::common;

use common::{path, pose};
use osculate_geom::Vec3;
use osculate_postproc::conduct::{Expected, ExpectedTool};
use osculate_postproc::readback::{ReadBack, ReadOptions, read};
use osculate_postproc::{Coolant, Dialect, FeedMode, Machine, PostOptions, Setup, post};

fn machine(dialect: Dialect) -> Machine {
    let name = if dialect == Dialect::LinuxCnc { "linuxcnc-xyzac" } else { "trunnion-ac" };
    Machine::built_in(name).expect("a built-in machine")
}

fn setup() -> Setup {
    Setup::at(Vec3::new(12.0, -7.0, 30.0), 90.0)
}

fn program(dialect: Dialect, feed: FeedMode) -> String {
    let poses = (0..=20).map(|i| {
        let t = f64::from(i);
        pose([t - 7.5, 0.3 * t, 5.0 - 0.1 * t], [0.2 - 0.02 * t, 0.1, 1.0])
    });
    let options = PostOptions { coolant: Some(Coolant::Mist), ..PostOptions::new(dialect, feed) };
    post(&path(poses, 600.0), &machine(dialect), &setup(), &options).expect("a path within limits").text
}

fn go(text: &str, dialect: Dialect) -> ReadBack {
    read(text, dialect, &machine(dialect), &setup(), &ReadOptions::default())
        .unwrap_or_else(|e| panic!("{dialect}: {e}\n{text}"))
}

/// Everything that a program does, without its lines.
fn deeds(text: &str, dialect: Dialect) -> impl PartialEq + std::fmt::Debug + use<> {
    let back = go(text, dialect);
    let moves: Vec<_> =
        back.moves.iter().map(|m| (m.pose, m.motion, m.time_min, m.tool, m.own_frame)).collect();
    let blocks: Vec<_> = back.blocks.iter().map(|b| (b.from, b.to, b.rapid, b.time_min)).collect();
    // A job that the program is not for, so that there is something to find.
    let tool = ExpectedTool::new(2, 90.0);
    let conduct = back.conduct(&Expected::new(tool, Some(9000.0), 0.02));
    assert!(conduct.findings.len() > 1, "{conduct:?}");
    let findings: Vec<_> = conduct.findings.iter().map(|f| (f.grade, f.what.clone())).collect();
    (moves, blocks, findings, conduct.blend_mm, back.spindle_rpm, back.diagnostics.len())
}

/// The head of a line, its words and its comment.
fn parts(line: &str, dialect: Dialect) -> (String, Vec<String>, String) {
    let sign = if matches!(dialect, Dialect::Sinumerik | Dialect::Heidenhain) { ';' } else { '(' };
    let (code, comment) = line.split_at(line.find(sign).unwrap_or(line.len()));
    let mut words: Vec<String> = code.split_whitespace().map(String::from).collect();
    let numbered = words.first().is_some_and(|w| {
        let digits = w.strip_prefix('N').unwrap_or(w);
        !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
    });
    let number = if numbered { words.remove(0) } else { String::new() };
    (number, words, comment.to_string())
}

/// Every line through `change`, with its number, its words and its comment.
fn each(text: &str, dialect: Dialect, change: impl Fn(String, Vec<String>, String) -> String) -> String {
    let line = |l: &str| {
        let (number, words, comment) = parts(l, dialect);
        change(number, words, comment)
    };
    text.lines().map(|l| line(l) + "\n").collect()
}

fn join(number: &str, words: &[String], comment: &str) -> String {
    let all = std::iter::once(number).chain(words.iter().map(String::as_str)).chain([comment]);
    all.filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ")
}

/// A word that is a letter of an axis or F, a sign and a number, split behind the letter.
fn axis_word(word: &str) -> Option<(&str, &str)> {
    let (name, number) = word.split_at_checked(1)?;
    let of_axis = "XYZACF".contains(name) && number.contains(|c: char| c.is_ascii_digit());
    (of_axis && number.parse::<f64>().is_ok()).then_some((name, number))
}

/// Words of a move are put in another order.
fn backwards(words: &[String], dialect: Dialect) -> Vec<String> {
    let moves = |w: &String| axis_word(w).is_some() || w.contains("=DC(") || w == "G0" || w == "G1";
    let klartext = dialect == Dialect::Heidenhain;
    let body = if klartext { words.get(1..).unwrap_or_default() } else { words };
    let whole = !klartext || words.first().is_some_and(|w| w == "L");
    // The axis words of a move only; R0 FMAX M91 keep their place.
    let first_other = body.iter().position(|w| !moves(w)).unwrap_or(body.len());
    if !whole || first_other < 2 {
        return words.to_vec();
    }
    let head = &words[..words.len() - body.len()];
    let turned = body[..first_other].iter().rev().chain(&body[first_other..]);
    head.iter().chain(turned).cloned().collect()
}

#[test]
fn harmless_rewritings() {
    for dialect in Dialect::ALL {
        let own = if dialect == Dialect::Heidenhain { FeedMode::Kf } else { FeedMode::InverseTime };
        for feed in [FeedMode::Tcp, own] {
            let text = program(dialect, feed);
            let want = deeds(&text, dialect);
            let klartext = dialect == Dialect::Heidenhain;
            let comment = match dialect {
                Dialect::Sinumerik | Dialect::Heidenhain => "; X99 M5 /",
                Dialect::Fanuc | Dialect::LinuxCnc => "(X99 M5 /)",
            };
            let ready = |line: &str| line.is_empty() || line.starts_with('%');
            let rewritten: Vec<(&str, String)> = vec![
                ("wide blanks", each(&text, dialect, |n, w, c| join(&n, &w, &c).replace(' ', "   ") + "  ")),
                (
                    "tabs",
                    each(&text, dialect, |n, w, c| {
                        if c.is_empty() { join(&n, &w, &c).replace(' ', "\t") } else { join(&n, &w, &c) }
                    }),
                ),
                (
                    "leading blanks",
                    each(&text, dialect, |n, w, c| {
                        let line = join(&n, &w, &c);
                        if ready(&line) || n.is_empty() && line.starts_with('O') {
                            line
                        } else {
                            format!("  {line}")
                        }
                    }),
                ),
                (
                    "comments",
                    each(&text, dialect, |n, w, c| {
                        let line = join(&n, &w, &c);
                        if ready(&line) { line } else { format!("{line} {comment}") }
                    }),
                ),
                ("a comment line", text.replacen('\n', &format!("\n{comment}\n"), 3)),
                ("without comments", each(&text, dialect, |n, w, _| join(&n, &w, ""))),
                (
                    "other block numbers",
                    each(&text, dialect, |n, w, c| {
                        let number = match (n.is_empty(), klartext) {
                            (true, _) if klartext || w.is_empty() || w[0].starts_with(['%', 'O']) => n,
                            (_, true) => "7".into(),
                            _ => "N123".into(),
                        };
                        join(&number, &w, &c)
                    }),
                ),
                ("without block numbers", each(&text, dialect, |_, w, c| join("", &w, &c))),
                ("empty lines", text.replace('\n', "\n\n")),
                ("ends of lines", text.replace('\n', "\r\n")),
                ("lower case", text.to_lowercase()),
                ("order of words", each(&text, dialect, |n, w, c| join(&n, &backwards(&w, dialect), &c))),
                (
                    "more zeros",
                    each(&text, dialect, |n, w, c| {
                        let more = |w: &String| match axis_word(w) {
                            Some((_, number)) if number.contains('.') => format!("{w}000"),
                            Some(_) => format!("{w}.0"),
                            None => w.clone(),
                        };
                        join(&n, &w.iter().map(more).collect::<Vec<_>>(), &c)
                    }),
                ),
                (
                    "fewer zeros",
                    each(&text, dialect, |n, w, c| {
                        let fewer = |w: &String| match axis_word(w) {
                            Some((_, number)) if number.contains('.') => {
                                let short = w.trim_end_matches('0');
                                let bare = short.trim_end_matches('.');
                                if klartext && axis_word(bare).is_some() { bare.into() } else { short.into() }
                            }
                            _ => w.clone(),
                        };
                        join(&n, &w.iter().map(fewer).collect::<Vec<_>>(), &c)
                    }),
                ),
                (
                    "a plus",
                    each(&text, dialect, |n, w, c| {
                        let plus = |w: &String| match axis_word(w) {
                            Some((name, number)) if !number.starts_with(['-', '+']) && name != "F" => {
                                format!("{name}+{number}")
                            }
                            _ => w.clone(),
                        };
                        join(&n, &w.iter().map(plus).collect::<Vec<_>>(), &c)
                    }),
                ),
                (
                    "modal words again",
                    each(&text, dialect, |n, w, c| {
                        let bare = w.first().is_some_and(|w| axis_word(w).is_some());
                        let again = match (klartext, w.is_empty()) {
                            (false, false) if bare => vec!["G90".to_string()],
                            _ => Vec::new(),
                        };
                        join(&n, &again.iter().chain(&w).cloned().collect::<Vec<_>>(), &c)
                    }),
                ),
            ];
            assert!(rewritten.len() >= 10);
            for (how, other) in rewritten {
                let idle = match how {
                    "modal words again" => true,
                    "a plus" => klartext,
                    "without block numbers" => !(klartext || dialect == Dialect::Sinumerik),
                    _ => false,
                };
                assert!(idle || other != text, "{dialect} {how} changes nothing");
                assert!(deeds(&other, dialect) == want, "{dialect} {feed:?} {how}:\n{other}");
            }
        }
    }
}

/// What a hand may write: digits in codes, words in one line, a slash's switch, codes of the same meaning.
#[test]
fn harmless_words() {
    let cases: [(Dialect, &[(&str, &str)]); 4] = [
        (
            Dialect::Sinumerik,
            &[
                ("M6\n", "M06\n"),
                ("G54\n", "G054\n"),
                ("S8000 M3", "M3 S8000"),
                ("S8000 M3", "M03 S8000.0"),
                ("S8000 M3", "S1=8000 M1=3"),
                ("D1\n", "D01\n"),
                ("CYCLE832(0.0020,1,1)", "CYCLE832( 0.002 , 1 , 1 )"),
                ("G0 SUPA Z0 D0", "SUPA G0 D0 Z=0.000"),
                ("G0 SUPA Z0 D0", "G153 G0 Z0 D0"),
                ("TRAFOOF", "TRAFOOF ; off"),
            ],
        ),
        (
            Dialect::Heidenhain,
            &[
                ("M3\n", "M03\n"),
                ("TOOL CALL 1 Z S8000", "TOOL  CALL  1  Z  S8000.0"),
                ("TOOL CALL 1 Z S8000", "TOOL CALL 1 Z S8000 DL+0 DR+0"),
                ("CYCL DEF 32.1 T0.0020", "CYCL DEF 32.1 T0.002"),
                ("L Z+0.0000 R0 FMAX M91", "L Z0 R0 FMAX M91"),
                ("L Z+0.0000 R0 FMAX M91", "L Z-0 M91 FMAX R0"),
                ("TOOL CALL", "TOOL DEF 5\nTOOL CALL"),
                ("M126", "M126 ; shortest way"),
                ("CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.0 TOLERANZ"),
                ("M7\n", "M07\n"),
            ],
        ),
        (
            Dialect::Fanuc,
            &[
                ("T1 M6", "M06 T01"),
                ("T1 M6", "T1\nM6"),
                ("G43.4 H1", "H01 G43.4"),
                ("S8000 M3", "M03 S8000."),
                ("G54\n", "G54 G90\n"),
                ("G5.1 Q1", "G05.1 Q1"),
                ("G53 G0 Z0", "G00 G53 Z0.0"),
                ("G49", "G49 G49"),
                ("M30", "M30 (end)"),
                ("G17 G21", "G21 G17 G64"),
            ],
        ),
        (
            Dialect::LinuxCnc,
            &[
                ("T1 M6", "m6 t1"),
                ("T1 M6", "T1\nM6"),
                ("G43 H1", "H1 G43"),
                ("G43 H1", "G43"),
                ("S8000 M3", "M3\nS8000"),
                ("G64 P0.0020", "G64 P.002 Q0.002"),
                ("G53 G0 Z0", "G0 G53 Z+0"),
                ("G54", "G54 ; offset"),
                ("G17 G21", "G 17 G21"),
                ("M30", "M2"),
            ],
        ),
    ];
    for (dialect, changes) in cases {
        let text = program(dialect, FeedMode::Tcp);
        let want = deeds(&text, dialect);
        for (from, to) in changes {
            assert!(text.contains(from), "{dialect}: no {from} in\n{text}");
            let other = text.replacen(from, to, 1);
            assert!(deeds(&other, dialect) == want, "{dialect}: {to} for {from}");
        }
    }
}
