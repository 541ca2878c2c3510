//! NC text as words, a line at a time.
//!
//! One lexer serves the ISO dialects: letters with numbers (`X-1.5`, `G43.4`), extended addresses (`CA1=DC(40.8)`,
//! `FGREF[C]=57.3`), names with or without arguments (`TRAORI`, `FGROUP(X,Y)`). Klartext has its own small lexer that
//! ends in the same words.

use super::Dialect;

/// How a position was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Manner {
    /// As the mode in force says.
    Modal,
    /// `AC(...)`.
    Absolute,
    /// `IC(...)`, or Klartext's `I` before the axis.
    Incremental,
    /// `DC(...)`: absolute by the shortest way.
    Shortest,
}

/// One word.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word {
    /// `G` with its number times ten.
    G(i64),
    /// `M` with its number.
    M(i64),
    /// `F`.
    F(f64),
    /// `S`.
    S(f64),
    /// A name with a number: an axis, or an address of no further meaning here.
    Address {
        /// Upper case.
        name: String,
        /// Its number.
        value: f64,
        /// How it is meant.
        manner: Manner,
    },
    /// A name, with what stands in its parentheses.
    Name {
        /// Upper case.
        name: String,
        /// Arguments as text.
        arguments: String,
    },
    /// A slash: the block is left out where a switch is set. Stands first.
    Skip,
}

impl Word {
    /// It does something: it is no number of a block, no slash, no message and no stop.
    pub fn acts(&self) -> bool {
        match self {
            Self::Skip => false,
            Self::Address { name, .. } => name != "N" && name != "O",
            Self::Name { name, .. } => name != "MSG",
            Self::M(code) => !matches!(code, 0 | 1),
            Self::G(_) | Self::F(_) | Self::S(_) => true,
        }
    }
}

/// A line that is no NC.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BadWord(pub String);

/// The words of one line, block numbers and comments left out.
pub(super) fn words(line: &str, dialect: Dialect) -> Result<Vec<Word>, BadWord> {
    let line = line.trim();
    if dialect == Dialect::Heidenhain {
        return klartext(line);
    }
    let line = if dialect == Dialect::Sinumerik { line.split(';').next().unwrap_or_default() } else { line };
    let mut scan = Scan { text: line, at: 0, round_comments: dialect != Dialect::Sinumerik };
    let mut words = Vec::with_capacity(8);
    if line.starts_with('%') {
        return Ok(words);
    }
    // A slash marks an optional block, which is run unless a switch is set. It stands before or behind the block's number.
    if scan.slash() {
        words.push(Word::Skip);
    }
    while let Some(word) = scan.word()? {
        let numbered = matches!(&word, Word::Address { name, .. } if name == "N");
        words.push(word);
        if numbered && words.len() == 1 && scan.slash() {
            words.insert(0, Word::Skip);
        }
    }
    Ok(words)
}

struct Scan<'a> {
    text: &'a str,
    /// In bytes.
    at: usize,
    round_comments: bool,
}

impl Scan<'_> {
    fn peek(&self) -> Option<char> {
        match self.text.as_bytes().get(self.at)? {
            b if b.is_ascii() => Some(char::from(*b)),
            _ => self.text.get(self.at..)?.chars().next(),
        }
    }

    /// A slash with the number of its switch, if it has one.
    fn slash(&mut self) -> bool {
        self.blanks();
        if self.peek() != Some('/') {
            return false;
        }
        self.at += 1;
        self.while_is(|c| c.is_ascii_digit());
        true
    }

    fn bad(&self, from: usize) -> BadWord {
        BadWord(self.text[from..].chars().take(24).collect())
    }

    fn rest(&self) -> String {
        self.text[self.at..].chars().take(24).collect()
    }

    fn blanks(&mut self) {
        loop {
            match self.peek() {
                Some(c) if c.is_whitespace() => self.at += c.len_utf8(),
                Some('(') if self.round_comments => {
                    // An open comment is left in place, where it is no word.
                    let Some(end) = self.text[self.at..].find(')') else { return };
                    self.at += end + 1;
                }
                Some(';') if self.round_comments => self.at = self.text.len(),
                _ => return,
            }
        }
    }

    fn while_is(&mut self, keep: impl Fn(char) -> bool) -> &str {
        let start = self.at;
        while let Some(c) = self.peek().filter(|c| keep(*c)) {
            self.at += c.len_utf8();
        }
        &self.text[start..self.at]
    }

    fn number(&mut self) -> Option<f64> {
        self.blanks();
        let start = self.at;
        if matches!(self.peek(), Some('+' | '-')) {
            self.at += 1;
        }
        self.while_is(|c| c.is_ascii_digit() || c == '.');
        let value = self.text[start..self.at].parse::<f64>().ok().filter(|v| held(*v));
        if value.is_none() {
            self.at = start;
        }
        value
    }

    fn word(&mut self) -> Result<Option<Word>, BadWord> {
        self.blanks();
        let Some(first) = self.peek() else { return Ok(None) };
        if !first.is_ascii_alphabetic() && first != '_' {
            return Err(BadWord(self.rest()));
        }
        let from = self.at;
        let mut name = self.while_is(|c| c.is_ascii_alphabetic() || c == '_').to_ascii_uppercase();
        if name.len() == 1 {
            let start = self.at;
            if let Some(value) = self.number() {
                let digits = &self.text[start..self.at];
                // `A3=`, `C1=`: the digits belong to the name.
                if self.peek() == Some('=') && digits.chars().all(|c| c.is_ascii_digit()) {
                    name.push_str(digits);
                    self.at += 1;
                    return self.assigned(name).map(Some);
                }
                return Ok(Some(lettered(&name, value)));
            }
        } else {
            let rest = self.while_is(|c| c.is_ascii_alphanumeric() || c == '_').to_ascii_uppercase();
            name.push_str(&rest);
        }
        self.blanks_only();
        match self.peek() {
            Some('=') => {
                self.at += 1;
                self.assigned(name).map(Some)
            }
            Some('[') if name.len() > 1 => {
                let inside = self.enclosed('[', ']').ok_or_else(|| self.bad(from))?;
                name = format!("{name}[{}]", inside.trim().to_ascii_uppercase());
                self.blanks_only();
                if self.peek() == Some('=') {
                    self.at += 1;
                    return self.assigned(name).map(Some);
                }
                Ok(Some(Word::Name { name, arguments: String::new() }))
            }
            Some('(') if !self.round_comments => {
                let arguments = self.enclosed('(', ')').ok_or_else(|| self.bad(from))?;
                Ok(Some(Word::Name { name, arguments }))
            }
            _ if name.len() == 1 => Err(self.bad(from)),
            _ => Ok(Some(Word::Name { name, arguments: String::new() })),
        }
    }

    fn blanks_only(&mut self) {
        self.while_is(char::is_whitespace);
    }

    /// What stands between the brackets; texts in quotes may contain brackets.
    fn enclosed(&mut self, open: char, close: char) -> Option<String> {
        let start = self.at + 1;
        let (mut depth, mut quoted) = (0, false);
        while let Some(c) = self.peek() {
            self.at += c.len_utf8();
            if c == '"' {
                quoted = !quoted;
            } else if !quoted && c == open {
                depth += 1;
            } else if !quoted && c == close {
                depth -= 1;
                if depth == 0 {
                    return Some(self.text[start..self.at - 1].to_string());
                }
            }
        }
        None
    }

    fn assigned(&mut self, name: String) -> Result<Word, BadWord> {
        self.blanks_only();
        if let Some(value) = self.number() {
            return Ok(if name.len() == 1 {
                lettered(&name, value)
            } else {
                address(name, value, Manner::Modal)
            });
        }
        let bad = BadWord(format!("{name}={}", self.rest()));
        if self.peek() == Some('"') {
            self.at += 1;
            let text = self.while_is(|c| c != '"').to_string();
            self.while_is(|c| c == '"');
            return Ok(Word::Name { name, arguments: text });
        }
        let manner = match self.while_is(|c| c.is_ascii_alphabetic()).to_ascii_uppercase().as_str() {
            "DC" => Manner::Shortest,
            "AC" => Manner::Absolute,
            "IC" => Manner::Incremental,
            _ => return Err(bad),
        };
        let inside = self.enclosed('(', ')').ok_or_else(|| bad.clone())?;
        let value = inside.trim().parse::<f64>().ok().filter(|v| held(*v)).ok_or(bad)?;
        Ok(address(name, value, manner))
    }
}

/// No word of a control holds more than nine digits before the point.
fn held(value: f64) -> bool {
    value.abs() <= 1e9
}

fn address(name: String, value: f64, manner: Manner) -> Word {
    Word::Address { name, value, manner }
}

fn lettered(name: &str, value: f64) -> Word {
    // Codes are small numbers with at most one decimal; anything else rounds to a code that nobody knows.
    #[allow(clippy::cast_possible_truncation)]
    match name {
        "G" => Word::G((value * 10.0).round() as i64),
        "M" => Word::M(value.round() as i64),
        "F" => Word::F(value),
        "S" => Word::S(value),
        _ => address(name.to_string(), value, Manner::Modal),
    }
}

/// Klartext: words between blanks; an axis carries its sign, `IX` is incremental.
fn klartext(line: &str) -> Result<Vec<Word>, BadWord> {
    let line = without_number(line.split(';').next().unwrap_or_default().trim());
    // A slash before or behind the block's number: it may be left out.
    let hidden = line.strip_prefix('/').map(|rest| without_number(rest.trim_start()));
    let mut words = klartext_words(hidden.unwrap_or(line))?;
    if hidden.is_some() && !words.is_empty() {
        words.insert(0, Word::Skip);
    }
    Ok(words)
}

/// Klartext without the number of the block.
fn without_number(line: &str) -> &str {
    let rest = line.trim_start_matches(|c: char| c.is_ascii_digit());
    let ends = rest.is_empty() || rest.starts_with(|c: char| c.is_whitespace() || c == '/');
    if ends { rest.trim_start() } else { line }
}

fn klartext_words(text: &str) -> Result<Vec<Word>, BadWord> {
    let parts: Vec<String> = text.split_whitespace().map(str::to_ascii_uppercase).collect();
    let Some(first) = parts.first() else { return Ok(Vec::new()) };
    let name = |name: &str, rest: &[String]| Word::Name { name: name.into(), arguments: rest.join(" ") };
    match first.as_str() {
        "L" | "LN" => {}
        "BEGIN" | "END" | "FUNCTION" => return Ok(vec![name(first, &parts[1..])]),
        "TOOL" => {
            let number = |letter: char| {
                let numbers = parts.iter().filter_map(|p| p.strip_prefix(letter));
                numbers.filter_map(|n| n.parse::<f64>().ok()).find(|n| held(*n))
            };
            let call = std::iter::once(name("TOOL", &parts[1..]));
            return Ok(call.chain(number('S').map(Word::S)).chain(number('F').map(Word::F)).collect());
        }
        other if other.starts_with('M') && other.len() > 1 => {
            return parts.iter().map(|p| klartext_word(p)).collect();
        }
        other => return Ok(vec![name(other, &parts[1..])]),
    }
    let straight = std::iter::once(Ok(name("L", &[])));
    straight.chain(parts[1..].iter().map(|p| klartext_word(p))).collect()
}

fn klartext_word(part: &str) -> Result<Word, BadWord> {
    let bad = || BadWord(part.to_string());
    if matches!(part, "R0" | "RL" | "RR" | "FMAX") {
        return Ok(Word::Name { name: part.into(), arguments: String::new() });
    }
    let (name, manner) = match part.strip_prefix('I') {
        Some(rest) => (rest, Manner::Incremental),
        None => (part, Manner::Modal),
    };
    let split = name.find(|c: char| !c.is_ascii_alphabetic()).ok_or_else(bad)?;
    let (letters, number) = name.split_at(split);
    let value: f64 = number.parse().ok().filter(|v: &f64| held(*v)).ok_or_else(bad)?;
    let of_direction = matches!(letters, "TX" | "TY" | "TZ" | "NX" | "NY" | "NZ");
    if letters.len() != 1 && !of_direction {
        return Err(bad());
    }
    Ok(match lettered(letters, value) {
        Word::Address { name, value, .. } => address(name, value, manner),
        word => word,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(name: &str, value: f64, manner: Manner) -> Word {
        address(name.into(), value, manner)
    }

    #[test]
    fn sinumerik_words() {
        let got = words("N1990 X1.926 Y-5.915 Z=-10.818 CA1=DC(40.683) ; end", Dialect::Sinumerik).unwrap();
        let want = [
            axis("N", 1990.0, Manner::Modal),
            axis("X", 1.926, Manner::Modal),
            axis("Y", -5.915, Manner::Modal),
            axis("Z", -10.818, Manner::Modal),
            axis("CA1", 40.683, Manner::Shortest),
        ];
        assert_eq!(got, want);
        let got = words("FGROUP(X,Y,C) FGREF[C]=57.3 A3=0.5 MSG(\"a ) b\") G1", Dialect::Sinumerik).unwrap();
        assert_eq!(got.len(), 5);
        assert_eq!(got[1], axis("FGREF[C]", 57.3, Manner::Modal));
        assert_eq!(got[2], axis("A3", 0.5, Manner::Modal));
        assert_eq!(got[4], Word::G(10));
    }

    #[test]
    fn compact_and_commented_words() {
        let got = words("/G1X10Y-.5(go) F100. ; end", Dialect::LinuxCnc).unwrap();
        let want = [
            Word::Skip,
            Word::G(10),
            axis("X", 10.0, Manner::Modal),
            axis("Y", -0.5, Manner::Modal),
            Word::F(100.0),
        ];
        assert_eq!(got, want);
        for hidden in ["/2 N10 G1", "N10 /G1", "/N10G1", "N10 /3 G1"] {
            let got = words(hidden, Dialect::Sinumerik).unwrap();
            assert_eq!(got, [Word::Skip, axis("N", 10.0, Manner::Modal), Word::G(10)], "{hidden}");
        }
        assert!(words("G1 / X5", Dialect::Fanuc).is_err());
        assert_eq!(words("G43.4 H1", Dialect::Fanuc).unwrap()[0], Word::G(434));
        assert!(words("X[#1+2]", Dialect::LinuxCnc).is_err());
        assert!(words("X", Dialect::LinuxCnc).is_err());
        assert!(words("X1 (open", Dialect::LinuxCnc).is_err());
        assert!(words("T=\"open", Dialect::Sinumerik).is_ok());
        assert!(words("#1=5", Dialect::LinuxCnc).is_err());
    }

    #[test]
    fn klartext_words() {
        let got = words("12 L X+1.5 IY-2 C+30 R0 FMAX M3", Dialect::Heidenhain).unwrap();
        assert_eq!(got[1], axis("X", 1.5, Manner::Modal));
        assert_eq!(got[2], axis("Y", -2.0, Manner::Incremental));
        assert_eq!(got[6], Word::M(3));
        for hidden in ["/12 L X+1.5", "12 /L X+1.5", "/ 12 L X+1.5", "/L X+1.5"] {
            let got = words(hidden, Dialect::Heidenhain).unwrap();
            assert!(got.len() == 3 && got[0] == Word::Skip, "{hidden}: {got:?}");
        }
        assert!(words("/ ; nothing", Dialect::Heidenhain).unwrap().is_empty());
        assert!(words("3 L X", Dialect::Heidenhain).is_err());
    }
}
