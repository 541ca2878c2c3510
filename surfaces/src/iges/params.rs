//! Parameters of IGES records: free text with the delimiters that the file names, numbers, Hollerith strings.
//!
//! Numbers take eight bytes each, whatever their text; strings are kept beside them.

/// A parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Param<'p> {
    /// Left out.
    Default,
    /// A number; integers are exact.
    Number(f64),
    /// A Hollerith string.
    Text(&'p str),
    /// Anything else.
    Other(&'p str),
}

/// The parameters of a record.
#[derive(Clone, Debug, Default)]
pub(crate) struct Params {
    /// NaN where the parameter is no number.
    values: Vec<f64>,
    /// Index, whether it is a Hollerith string, and text, ascending.
    words: Vec<(u32, bool, Box<str>)>,
}

impl Params {
    /// How many there are.
    pub(crate) const fn len(&self) -> usize {
        self.values.len()
    }

    /// Parameter `k` from zero.
    pub(crate) fn get(&self, k: usize) -> Option<Param<'_>> {
        let value = *self.values.get(k)?;
        if !value.is_nan() {
            return Some(Param::Number(value));
        }
        Some(match self.words.binary_search_by(|w| (w.0 as usize).cmp(&k)) {
            Ok(at) if self.words[at].1 => Param::Text(&self.words[at].2),
            Ok(at) => Param::Other(&self.words[at].2),
            Err(_) => Param::Default,
        })
    }

    /// Parameter `k` where it is a number.
    pub(crate) fn number(&self, k: usize) -> Option<f64> {
        self.values.get(k).copied().filter(|v| !v.is_nan())
    }

    /// Parameter `k` where it is a string or another word.
    pub(crate) fn text(&self, k: usize) -> Option<&str> {
        match self.get(k)? {
            Param::Text(t) | Param::Other(t) => Some(t),
            _ => None,
        }
    }

    /// The parameters from `from` to `to`, where all of them are numbers or left out (zero).
    pub(crate) fn numbers(&self, from: usize, to: usize) -> Option<Vec<f64>> {
        let values = self.values.get(from..to)?;
        if values.iter().any(|v| v.is_nan()) && (from..to).any(|k| self.text(k).is_some()) {
            return None;
        }
        Some(values.iter().map(|v| if v.is_nan() { 0.0 } else { *v }).collect())
    }

    /// Without the first one.
    pub(crate) fn behind_first(mut self) -> Self {
        if !self.values.is_empty() {
            self.values.remove(0);
        }
        self.words.retain(|w| w.0 > 0);
        for w in &mut self.words {
            w.0 -= 1;
        }
        self
    }

    fn push_word(&mut self, hollerith: bool, text: String) {
        // More than 2^32 parameters need a file of 4 GiB and more of delimiters alone.
        let at = u32::try_from(self.values.len()).unwrap_or(u32::MAX);
        self.values.push(f64::NAN);
        self.words.push((at, hollerith, text.into_boxed_str()));
    }
}

/// Parameter and record delimiter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Separators {
    pub(crate) parameter: u8,
    pub(crate) record: u8,
}

/// The standard's own.
pub(crate) const STANDARD: Separators = Separators { parameter: b',', record: b';' };

/// Parameters of a record.
#[derive(Debug)]
pub(crate) struct Parsed {
    pub(crate) params: Params,
    /// Whether the record delimiter came.
    pub(crate) ended: bool,
    /// Strings whose count does not lead to a delimiter.
    pub(crate) lies: usize,
}

/// Longest text of a number; writers that print more digits than this have none of them right.
const MAX_DIGITS: usize = 64;

/// Parameters up to the record delimiter.
pub(crate) fn parse(text: &[u8], separators: Separators) -> Parsed {
    let mut out = Params::default();
    let mut lies = 0;
    let mut at = 0;
    let delimits = |c: u8| c == separators.parameter || c == separators.record;
    loop {
        while text.get(at) == Some(&b' ') {
            at += 1;
        }
        let start = at;
        while text.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        let digits = &text[start..at];
        if !digits.is_empty() && matches!(text.get(at), Some(b'H' | b'h')) {
            let count: usize =
                std::str::from_utf8(digits).ok().and_then(|d| d.parse().ok()).unwrap_or(usize::MAX);
            let from = at + 1;
            let mut to = from.saturating_add(count).min(text.len());
            let next = text[to..].iter().copied().find(|c| *c != b' ');
            if next.is_none_or(|c| !delimits(c)) {
                // The count lies: what follows is no delimiter. The string then ends at the first one.
                lies += 1;
                to = text[from..].iter().position(|c| delimits(*c)).map_or(text.len(), |n| from + n);
            }
            at = to;
            out.push_word(true, String::from_utf8_lossy(&text[from..to]).into_owned());
        } else {
            while text.get(at).is_some_and(|c| !delimits(*c)) {
                at += 1;
            }
            match plain(&text[start..at]) {
                Plain::Default => out.values.push(f64::NAN),
                Plain::Number(x) => out.values.push(x),
                Plain::Other(t) => out.push_word(false, t),
            }
        }
        // Blanks between a value and its delimiter.
        while text.get(at).is_some_and(|c| !delimits(*c)) {
            at += 1;
        }
        match text.get(at) {
            Some(c) if *c == separators.record => return Parsed { params: out, ended: true, lies },
            Some(_) => at += 1,
            None => return Parsed { params: out, ended: false, lies },
        }
    }
}

enum Plain {
    Default,
    Number(f64),
    Other(String),
}

/// A value that is no string. Blanks within it, which a number across two cards may have, do not count.
fn plain(text: &[u8]) -> Plain {
    let mut buffer = [0_u8; MAX_DIGITS];
    let mut n = 0;
    for c in text.iter().filter(|c| !c.is_ascii_whitespace() && **c != 0) {
        if n == MAX_DIGITS {
            break;
        }
        buffer[n] = if matches!(c, b'd' | b'D') { b'e' } else { *c };
        n += 1;
    }
    let cleaned = &buffer[..n];
    if cleaned.is_empty() {
        return Plain::Default;
    }
    let other = || Plain::Other(String::from_utf8_lossy(text).trim().to_owned());
    // Rust also reads words such as `inf`; a number begins with a digit, a sign or a point.
    if cleaned[0].is_ascii_alphabetic() {
        return other();
    }
    match std::str::from_utf8(cleaned).ok().and_then(|t| t.parse::<f64>().ok()) {
        Some(x) if x.is_finite() => Plain::Number(x),
        _ => other(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(p: &Params) -> Vec<Param<'_>> {
        (0..p.len()).filter_map(|k| p.get(k)).collect()
    }

    #[test]
    fn parameters_of_all_forms() {
        let p = parse(b"110, 1., -2.5D0,,7Ha,b;c d , 3 ; rest", STANDARD);
        assert!(p.ended && p.lies == 0);
        let want = [
            Param::Number(110.0),
            Param::Number(1.0),
            Param::Number(-2.5),
            Param::Default,
            Param::Text("a,b;c d"),
            Param::Number(3.0),
        ];
        assert_eq!(all(&p.params), want);
        assert_eq!(all(&p.params.behind_first()), want[1..]);
        let p = parse(b"110,99999999999Hab", STANDARD);
        assert_eq!((p.params.len(), p.ended, p.lies), (2, false, 1));
        // A count that runs into the next value.
        let p = parse(b"38Hpart.igs,      4Hname,2;", STANDARD);
        assert_eq!(all(&p.params)[1..], [Param::Text("name"), Param::Number(2.0)]);
        assert_eq!((p.ended, p.lies), (true, 1));
    }

    #[test]
    fn numbers_are_numbers_and_nothing_else_is() {
        let p = parse(b"1.5E+2,inf,NaN,-.5d-1,1 2.5,+7,1.e999,*,;", STANDARD);
        let want = [
            Param::Number(150.0),
            Param::Other("inf"),
            Param::Other("NaN"),
            Param::Number(-0.05),
            Param::Number(12.5),
            Param::Number(7.0),
            Param::Other("1.e999"),
            Param::Other("*"),
            Param::Default,
        ];
        assert_eq!(all(&p.params), want);
        assert_eq!(p.params.numbers(3, 6), Some(vec![-0.05, 12.5, 7.0]));
        assert_eq!((p.params.numbers(0, 3), p.params.numbers(5, 99)), (None, None));
        assert_eq!(p.params.numbers(8, 9), Some(vec![0.0]));
    }
}
