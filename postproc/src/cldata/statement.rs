//! Lines of APT text put together to statements: comments off, continuations joined, upper case.

/// One statement.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statement {
    /// The line on which it starts, from 1.
    pub line: usize,
    /// The word before the slash, without blanks.
    pub word: String,
    /// What stands behind the slash, separated by commas, trimmed; upper case.
    pub fields: Vec<String>,
}

/// Words whose text is free: they are never split, continued or put into upper case by rule.
const FREE_TEXT: [&str; 6] = ["PARTNO", "PPRINT", "INSERT", "TPRINT", "OPNAME", "REMARK"];

/// A statement, or the numbers of a plain `GOTO/` line, of which long files consist.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    Goto { line: usize, numbers: [f64; 6], count: usize },
    Other(Statement),
}

/// A line `GOTO/` with three or six numbers and nothing else.
fn plain_goto(line: &str) -> Option<([f64; 6], usize)> {
    let mut numbers = [0.0; 6];
    let mut count = 0;
    for field in line.strip_prefix("GOTO/")?.split(',') {
        *numbers.get_mut(count)? = decimal(field.trim())?;
        count += 1;
    }
    (count == 3 || count == 6).then_some((numbers, count))
}

/// Powers of ten, all exact in f64.
const POWERS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// A finite number. With at most 15 digits and no exponent both the digits and the power of ten are exact, so that one
/// division rounds right; anything else goes the general way.
fn decimal(text: &str) -> Option<f64> {
    let general = || text.parse().ok().filter(|v: &f64| v.is_finite());
    let bytes = text.as_bytes();
    let (negative, digits) = match bytes.first()? {
        b'-' => (true, &bytes[1..]),
        _ => (false, bytes),
    };
    // 15 digits and a point.
    if digits.len() > 16 {
        return general();
    }
    let (mut whole, mut after, mut count) = (0u64, None, 0usize);
    for b in digits {
        match b {
            b'0'..=b'9' => {
                whole = 10 * whole + u64::from(b - b'0');
                count += 1;
            }
            b'.' if after.is_none() => after = Some(count),
            _ => return general(),
        }
    }
    if count == 0 || count > 15 {
        return general();
    }
    let value = whole as f64 / POWERS[after.map_or(0, |a| count - a)];
    Some(if negative { -value } else { value })
}

/// Puts lines together to statements, a line at a time.
#[derive(Clone, Debug, Default)]
pub(super) struct Joiner {
    /// Lines seen.
    pub lines: usize,
    pending: Option<(usize, String)>,
}

impl Joiner {
    /// The statement that ends on this line, if one does.
    pub fn line(&mut self, raw: &str) -> Option<Item> {
        let raw = if self.lines == 0 { raw.trim_start_matches('\u{feff}') } else { raw };
        self.lines += 1;
        if self.pending.is_none()
            && let Some((numbers, count)) = plain_goto(raw)
        {
            return Some(Item::Goto { line: self.lines, numbers, count });
        }
        let free = self.pending.is_none() && is_free(raw);
        let line = if free { raw } else { raw.find("$$").map_or(raw, |at| &raw[..at]) };
        let line = line.trim();
        let (start, mut joined) = self.pending.take().unwrap_or((self.lines, String::new()));
        if let (Some(head), false) = (line.strip_suffix('$'), free) {
            joined.push_str(head);
            self.pending = Some((start, joined));
            return None;
        }
        joined.push_str(line);
        statement(start, &joined).map(Item::Other)
    }

    /// What an open continuation at the end of the text holds.
    pub fn finish(&mut self) -> Option<Item> {
        self.pending.take().and_then(|(start, joined)| statement(start, &joined)).map(Item::Other)
    }
}

fn is_free(line: &str) -> bool {
    let word: String = line.trim_start().chars().take_while(char::is_ascii_alphabetic).collect();
    FREE_TEXT.contains(&word.to_ascii_uppercase().as_str())
}

fn statement(line: usize, text: &str) -> Option<Statement> {
    let text = text.trim();
    if text.is_empty() {
        return None;
    }
    let (word, rest) = match text.split_once('/') {
        Some((word, rest)) if !is_free(text) => (word, Some(rest)),
        _ => (text.split_whitespace().next().unwrap_or(text), None),
    };
    let word = word.split_whitespace().collect::<String>().to_ascii_uppercase();
    let word = if rest.is_none() { word.split('/').next().unwrap_or_default().to_string() } else { word };
    let fields = rest.filter(|r| !r.trim().is_empty());
    let fields =
        fields.map_or_else(Vec::new, |r| r.split(',').map(|f| f.trim().to_ascii_uppercase()).collect());
    Some(Statement { line, word, fields })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_continuations_case_and_blanks() {
        let text =
            "$$ nothing\npartno a / b $$ stays\nGoto  / 1., 2 $\n  ,3 $$ end\n\nFEDRAT/ 10,mmpm\nRAPID\n";
        let mut joiner = Joiner::default();
        let mut found: Vec<Item> = text.lines().filter_map(|line| joiner.line(line)).collect();
        found.extend(joiner.finish());
        let other = |item| match item {
            Item::Other(s) => Some(s),
            Item::Goto { .. } => None,
        };
        let all: Vec<Statement> = found.into_iter().filter_map(other).collect();
        let words: Vec<_> = all.iter().map(|s| (s.line, s.word.as_str(), s.fields.join(";"))).collect();
        assert_eq!(
            words,
            [
                (2, "PARTNO", String::new()),
                (3, "GOTO", "1.;2;3".into()),
                (6, "FEDRAT", "10;MMPM".into()),
                (7, "RAPID", String::new())
            ]
        );
    }

    proptest::proptest! {
        /// The short way gives the bits of the general one.
        #[test]
        fn decimals_round_right(digits in 0u64..2_000_000_000_000_000, places in 0usize..17, minus in proptest::bool::ANY) {
            let mut text = format!("{digits:0>18}");
            text.insert(18 - places, '.');
            let text = format!("{}{}", if minus { "-" } else { "" }, text.trim_start_matches('0'));
            proptest::prop_assert_eq!(decimal(&text), text.parse().ok(), "{}", text);
        }
    }

    #[test]
    fn odd_decimals() {
        for text in ["1e3", "-1.5E-3", "+2.", ".5", "-.5", "0", "-0.0", "123456789012345678.25"] {
            assert_eq!(decimal(text).map(f64::to_bits), text.parse::<f64>().ok().map(f64::to_bits), "{text}");
        }
        for text in ["", "-", ".", "1.2.3", "x", "NaN", "inf", "1e999", "1 2"] {
            assert_eq!(decimal(text), None, "{text}");
        }
    }
}
