//! Words that say in which order lines are run, as far as their counts are literal: labels, subprograms, repeats, loops.
//!
//! - Heidenhain: `LBL n`, `LBL 0`, `CALL LBL n`, `CALL LBL n REP k`.
//! - Fanuc: `On`, `M98 Pn Lk` (`M98 Pkkknnnn`), `M99`, `#n=..`, `WHILE [#n LT k] DOm`, `ENDm`.
//! - LinuxCNC: as Fanuc but for `DO`, and `o.. sub`, `endsub`, `call`, `repeat [k]`, `endrepeat`, `while [..]`, `endwhile`.
//! - Sinumerik: `NAME:`, `ENDLABEL:`, `REPEAT A [B] P=k`, `REPEATB A P=k`, `FOR Rn=a TO b`, `ENDFOR`, `Rn=..`, `WHILE Rn<k`, `ENDWHILE`.
//!
//! Anything else of that kind (`IF`, `GOTO`, expressions, arguments of calls) is no word here: the reader says that it does not know it.

use super::super::Dialect;

/// What a variable is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Test {
    pub how: How,
    pub with: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum How {
    Less,
    LessOrEqual,
    More,
    MoreOrEqual,
    Equal,
    Other,
}

impl Test {
    pub fn holds(&self, value: f64) -> bool {
        match self.how {
            How::Less => value < self.with,
            How::LessOrEqual => value <= self.with,
            How::More => value > self.with,
            How::MoreOrEqual => value >= self.with,
            How::Equal => value == self.with,
            How::Other => value != self.with,
        }
    }
}

/// One line that steers.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum FlowWord {
    /// A place with a name; what follows it in its line is run.
    Label(String),
    /// A subprogram that is passed over where it stands.
    Sub(String),
    /// Back to the caller.
    Return,
    /// A subprogram, so often.
    Call { name: String, times: u32 },
    /// The lines from a label to here, so often more.
    RepeatToHere { from: String, times: u32 },
    /// The lines from a label to another one or to `ENDLABEL`, both with their own, so often more.
    RepeatPart { from: String, to: Option<String>, times: u32 },
    /// One line, so often more.
    RepeatLine { from: String, times: u32 },
    /// The head of a loop with its count.
    Times { times: u32 },
    /// The head of a loop that runs while a variable passes a test.
    While { name: String, test: Test },
    /// The end of a loop.
    End,
    /// A variable gets a value; not a literal one where that is absent.
    Set { name: String, value: Option<f64> },
    /// A variable grows.
    Add { name: String, by: f64 },
    /// The word of a jump or a condition, which is not followed.
    Jump(&'static str),
}

/// Words of jumps and conditions.
const JUMPS: [&str; 9] = ["GOTOF", "GOTOB", "GOTOC", "GOTOS", "GOTO", "IF", "CASE", "LOOP", "UNTIL"];

/// A line that begins with such a word, behind which no other letters come.
fn jump(text: &str) -> Option<FlowWord> {
    let word = JUMPS.into_iter().find(|j| text.starts_with(j))?;
    let ends = !text[word.len()..].starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    ends.then_some(FlowWord::Jump(word))
}

/// What a line says of the order; `None`: nothing that is known.
pub(super) fn flow_word(line: &str, dialect: Dialect) -> Option<FlowWord> {
    match dialect {
        Dialect::Heidenhain => klartext(line),
        Dialect::Sinumerik => sinumerik(line),
        Dialect::Fanuc | Dialect::LinuxCnc => iso(line, dialect),
    }
}

fn whole(text: &str) -> Option<u32> {
    text.parse().ok()
}

fn klartext(line: &str) -> Option<FlowWord> {
    if !(line.contains("LBL") || line.contains("lbl")) {
        return None;
    }
    let line = line.split(';').next().unwrap_or_default().trim();
    let line = line.trim_start_matches(|c: char| c.is_ascii_digit()).trim().to_ascii_uppercase();
    let parts: Vec<&str> = line.split_whitespace().collect();
    let name = |n: &str| n.trim_matches('"').to_owned();
    Some(match parts[..] {
        ["LBL", "0"] => FlowWord::Return,
        ["LBL", n] => FlowWord::Label(name(n)),
        ["CALL", "LBL", n] => FlowWord::Call { name: name(n), times: 1 },
        ["CALL", "LBL", n, "REP", k] => FlowWord::RepeatToHere { from: name(n), times: whole(k)? },
        ["CALL", "LBL", n, k] => {
            FlowWord::RepeatToHere { from: name(n), times: whole(k.strip_prefix("REP")?)? }
        }
        _ => return None,
    })
}

/// Without comments, blanks and the number of the block, in capitals.
fn bare(line: &str, round_comments: bool) -> String {
    let mut out = String::with_capacity(line.len());
    let mut depth = 0;
    for c in line.chars() {
        match c {
            '(' if round_comments => depth += 1,
            ')' if round_comments && depth > 0 => depth -= 1,
            ';' if depth == 0 => break,
            c if depth == 0 && !c.is_whitespace() => out.push(c.to_ascii_uppercase()),
            _ => {}
        }
    }
    match out.strip_prefix('N') {
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => {
            rest.trim_start_matches(|c: char| c.is_ascii_digit()).to_owned()
        }
        _ => out,
    }
}

fn iso(line: &str, dialect: Dialect) -> Option<FlowWord> {
    let letter = |b| matches!(b, b'O' | b'o' | b'#' | b'W' | b'w' | b'E' | b'e' | b'[');
    if !(line.bytes().any(letter) || line.contains("M9") || line.contains("m9")) {
        return None;
    }
    let text = bare(line, true);
    if text == "M99" {
        return Some(FlowWord::Return);
    }
    if let Some(rest) = text.strip_prefix("M98P") {
        let (p, l) = rest.split_once('L').map_or((rest, None), |(p, l)| (p, Some(l)));
        let (number, times) = match l {
            Some(l) => (p, whole(l)?),
            // Count and number in one word.
            None if p.len() > 4 && dialect == Dialect::Fanuc => {
                let (k, n) = p.split_at_checked(p.len() - 4)?;
                (n, whole(k)?)
            }
            None => (p, 1),
        };
        return Some(FlowWord::Call { name: whole(number)?.to_string(), times });
    }
    if let Some(rest) = text.strip_prefix('#') {
        return assigned("#", rest);
    }
    if dialect == Dialect::Fanuc {
        if let Some(jump) = jump(&text) {
            return Some(jump);
        }
        if let Some(rest) = text.strip_prefix("WHILE") {
            let (test, level) = rest.rsplit_once("DO")?;
            whole(level)?;
            return tested(test);
        }
        if let Some(level) = text.strip_prefix("END") {
            return whole(level).map(|_| FlowWord::End);
        }
        return text.strip_prefix('O').and_then(whole).map(|n| FlowWord::Label(n.to_string()));
    }
    let rest = text.strip_prefix('O')?;
    let (name, word) = match rest.strip_prefix('<') {
        Some(rest) => rest.split_once('>')?,
        None => rest.split_at(rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())),
    };
    if name.is_empty() {
        return None;
    }
    let name = whole(name).map_or_else(|| name.to_owned(), |n| n.to_string());
    Some(match word {
        "" => FlowWord::Label(name),
        "SUB" => FlowWord::Sub(name),
        "ENDSUB" => FlowWord::Return,
        "CALL" => FlowWord::Call { name, times: 1 },
        "ENDREPEAT" | "ENDWHILE" => FlowWord::End,
        word => {
            if let Some(k) = word.strip_prefix("REPEAT[").and_then(|k| k.strip_suffix(']')) {
                return Some(FlowWord::Times { times: whole(k)? });
            }
            word.strip_prefix("WHILE").map_or_else(|| jump(word), tested)?
        }
    })
}

/// `n=5`, `n=#n+1` behind the sign of variables.
fn assigned(sign: &str, text: &str) -> Option<FlowWord> {
    let (number, value) = text.split_once('=')?;
    let name = format!("{sign}{}", whole(number)?);
    if let Ok(value) = value.parse::<f64>() {
        return Some(FlowWord::Set { name, value: Some(value).filter(|v| v.is_finite()) });
    }
    let value = value.strip_prefix('[').and_then(|v| v.strip_suffix(']')).unwrap_or(value);
    let by = value.strip_prefix(&name).filter(|rest| rest.starts_with(['+', '-']));
    Some(match by.and_then(|by| by.parse::<f64>().ok()).filter(|by| by.is_finite()) {
        Some(by) => FlowWord::Add { name, by },
        None => FlowWord::Set { name, value: None },
    })
}

/// `[#1LT5]`.
fn tested(text: &str) -> Option<FlowWord> {
    let text = text.strip_prefix('[')?.strip_suffix(']')?;
    let at = text.find(|c: char| c.is_ascii_alphabetic())?;
    let (name, rest) = text.split_at(at);
    let number = whole(name.strip_prefix('#')?)?;
    let (how, with) = rest.split_at_checked(2)?;
    let how = match how {
        "LT" => How::Less,
        "LE" => How::LessOrEqual,
        "GT" => How::More,
        "GE" => How::MoreOrEqual,
        "EQ" => How::Equal,
        "NE" => How::Other,
        _ => return None,
    };
    let with = with.parse::<f64>().ok().filter(|w| w.is_finite())?;
    Some(FlowWord::While { name: format!("#{number}"), test: Test { how, with } })
}

fn sinumerik(line: &str) -> Option<FlowWord> {
    let word = line.trim_start().trim_start_matches(|c: char| c == 'N' || c == 'n' || c.is_ascii_digit());
    let begins = word.trim_start().starts_with(['R', 'E', 'F', 'W', 'G', 'I', 'C', 'L', 'U'])
        || word.trim_start().starts_with(['r', 'e', 'f', 'w', 'g', 'i', 'c', 'l', 'u']);
    if !(begins || line.contains(':')) {
        return None;
    }
    let line = line.split(';').next().unwrap_or_default().trim().to_ascii_uppercase();
    let line = match line.strip_prefix('N') {
        Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => {
            rest.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start()
        }
        _ => line.as_str(),
    };
    if let Some((name, _)) = line.split_once(':')
        && is_label(name)
    {
        return Some(FlowWord::Label(name.to_owned()));
    }
    if let Some(jump) = jump(line) {
        return Some(jump);
    }
    if let Some(rest) = line.strip_prefix('R').filter(|r| r.starts_with(|c: char| c.is_ascii_digit())) {
        let text: String = rest.split_whitespace().collect();
        return assigned("R", &text);
    }
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    match word {
        "ENDFOR" | "ENDWHILE" if rest.is_empty() => Some(FlowWord::End),
        "REPEAT" | "REPEATB" => {
            let rest = rest.replace("P =", "P=").replace("= ", "=");
            let mut parts: Vec<&str> = rest.split_whitespace().collect();
            let times = match parts.last()?.strip_prefix("P=") {
                Some(k) => {
                    parts.pop();
                    whole(k)?
                }
                None => 1,
            };
            let own = |name: &str| is_label(name).then(|| name.to_owned());
            match (word, &parts[..]) {
                ("REPEATB", [one]) => Some(FlowWord::RepeatLine { from: own(one)?, times }),
                ("REPEAT", [from]) => Some(FlowWord::RepeatPart { from: own(from)?, to: None, times }),
                ("REPEAT", [from, to]) => {
                    Some(FlowWord::RepeatPart { from: own(from)?, to: Some(own(to)?), times })
                }
                _ => None,
            }
        }
        "FOR" => {
            let (range, to) = rest.split_once(" TO ")?;
            let (name, from) = range.split_once('=')?;
            whole(name.trim().strip_prefix('R')?)?;
            let (from, to): (i32, i32) = (from.trim().parse().ok()?, to.trim().parse().ok()?);
            let times = i64::from(to) - i64::from(from) + 1;
            Some(FlowWord::Times { times: u32::try_from(times.max(0)).ok()? })
        }
        "WHILE" => {
            let text: String = rest.split_whitespace().collect();
            let at = text.find(['<', '>', '='])?;
            let (name, rest) = text.split_at(at);
            let (how, with) = [
                ("<=", How::LessOrEqual),
                (">=", How::MoreOrEqual),
                ("<>", How::Other),
                ("==", How::Equal),
                ("<", How::Less),
                (">", How::More),
            ]
            .into_iter()
            .find_map(|(sign, how)| Some((how, rest.strip_prefix(sign)?)))?;
            let number = whole(name.strip_prefix('R')?)?;
            let with = with.parse::<f64>().ok().filter(|w| w.is_finite())?;
            Some(FlowWord::While { name: format!("R{number}"), test: Test { how, with } })
        }
        _ => None,
    }
}

/// A name of a label: two letters first.
fn is_label(name: &str) -> bool {
    let letters = name.len() > 2 && name.bytes().take(2).all(|b| b.is_ascii_alphabetic() || b == b'_');
    letters && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// What stands behind a label in its line.
pub(super) fn behind_label(line: &str, dialect: Dialect) -> &str {
    match dialect {
        Dialect::Sinumerik => line.split_once(':').map_or("", |(_, rest)| rest),
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(line: &str, dialect: Dialect) -> Option<FlowWord> {
        flow_word(line, dialect)
    }

    fn call(name: &str, times: u32) -> Option<FlowWord> {
        Some(FlowWord::Call { name: name.into(), times })
    }

    #[test]
    fn klartext_and_iso_words() {
        use Dialect::{Fanuc, Heidenhain, LinuxCnc};
        assert_eq!(of("12 CALL LBL 3 ; hole", Heidenhain), call("3", 1));
        let again = FlowWord::RepeatToHere { from: "A".into(), times: 4 };
        assert_eq!(of("CALL LBL \"A\" REP 4", Heidenhain), Some(again.clone()));
        assert_eq!(of("9 CALL LBL \"A\" REP4", Heidenhain), Some(again));
        assert_eq!(of("9 LBL 0", Heidenhain), Some(FlowWord::Return));
        assert_eq!(of("9 CALL PGM 7", Heidenhain), None);
        assert_eq!(of("N5 M98 P1000 L3 (go)", Fanuc), call("1000", 3));
        assert_eq!(of("M98P30012", Fanuc), call("12", 3));
        assert_eq!(of("M98 P0012", Fanuc), call("12", 1));
        assert_eq!(of("M98 P30012", LinuxCnc), call("30012", 1));
        assert_eq!(of("G0 X5 M98 P12", Fanuc), None);
        assert_eq!(of("M99 P30", Fanuc), None);
        assert_eq!(of("O0012 (SUB)", Fanuc), Some(FlowWord::Label("12".into())));
        let test = Test { how: How::LessOrEqual, with: 4.5 };
        assert_eq!(of("WHILE [#3 LE 4.5] DO1", Fanuc), Some(FlowWord::While { name: "#3".into(), test }));
        assert_eq!(of("#3 = #3 + 1", Fanuc), Some(FlowWord::Add { name: "#3".into(), by: 1.0 }));
        assert_eq!(of("#3 = [#3 - .5]", Fanuc), Some(FlowWord::Add { name: "#3".into(), by: -0.5 }));
        assert_eq!(of("#3 = #4 + 1", Fanuc), Some(FlowWord::Set { name: "#3".into(), value: None }));
        assert_eq!(of("o100 repeat [5]", LinuxCnc), Some(FlowWord::Times { times: 5 }));
        assert_eq!(of("o<hole> call", LinuxCnc), call("HOLE", 1));
        assert_eq!(of("o<hole> call [5]", LinuxCnc), None);
        assert_eq!(of("o7 if [#1 EQ 2]", LinuxCnc), Some(FlowWord::Jump("IF")));
        assert_eq!(of("N5 IF [#1 EQ 2] GOTO 7", Fanuc), Some(FlowWord::Jump("IF")));
        assert_eq!(of("GOTO7", Fanuc), Some(FlowWord::Jump("GOTO")));
    }

    #[test]
    fn sinumerik_words() {
        let of = |line| of(line, Dialect::Sinumerik);
        assert_eq!(of("N10 HOLE: G0 X5"), Some(FlowWord::Label("HOLE".into())));
        assert_eq!(behind_label("N10 HOLE: G0 X5", Dialect::Sinumerik), " G0 X5");
        let part = |to: Option<&str>, times| FlowWord::RepeatPart {
            from: "HOLE".into(),
            to: to.map(Into::into),
            times,
        };
        assert_eq!(of("N10 REPEAT HOLE P=3"), Some(part(None, 3)));
        assert_eq!(of("REPEAT HOLE LAST P=2 ; twice"), Some(part(Some("LAST"), 2)));
        assert_eq!(of("REPEATB HOLE"), Some(FlowWord::RepeatLine { from: "HOLE".into(), times: 1 }));
        assert_eq!(of("FOR R1 = 0 TO 4"), Some(FlowWord::Times { times: 5 }));
        assert_eq!(of("FOR R1=4 TO 0"), Some(FlowWord::Times { times: 0 }));
        let test = Test { how: How::Less, with: 3.0 };
        assert_eq!(of("WHILE R2 < 3"), Some(FlowWord::While { name: "R2".into(), test }));
        assert_eq!(of("R2=R2+1"), Some(FlowWord::Add { name: "R2".into(), by: 1.0 }));
        for none in ["G1 X5 F100", "MSG(\"a: b\")", "IFX=3", "X=R1", "A3=0 B3=1"] {
            assert_eq!(of(none), None, "{none}");
        }
    }
}
