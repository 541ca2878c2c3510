//! Lines with places for words: `G43.4 H{tool}`, `({text*})`.

use std::collections::BTreeMap;

/// A piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    /// A word or a part of one: anything without a blank, as short as what follows allows; with the flag, blanks too.
    Any(String, bool),
}

/// A line with places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Pattern(Vec<Piece>);

/// What stands in the places.
pub(super) type Found<'a> = BTreeMap<&'a str, &'a str>;

impl Pattern {
    /// # Errors
    /// Where a brace does not close, a name is used twice or two places touch, with a word on it.
    pub fn new(text: &str) -> Result<Self, String> {
        let mut pieces = Vec::new();
        let mut rest = text;
        if text.contains(['\n', '\r']) || text != text.trim() {
            return Err(format!("'{text}' is no single line without blanks around it"));
        }
        while let Some(open) = rest.find('{') {
            if open > 0 {
                pieces.push(Piece::Text(rest[..open].to_owned()));
            } else if matches!(pieces.last(), Some(Piece::Any(..))) {
                return Err(format!("two places of '{text}' touch: nothing says where one ends"));
            }
            let close =
                rest.find('}').filter(|c| *c > open).ok_or(format!("a brace of '{text}' does not close"))?;
            let name = &rest[open + 1..close];
            let (name, all) = name.strip_suffix('*').map_or((name, false), |n| (n, true));
            let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
            let twice = pieces.iter().any(|p| matches!(p, Piece::Any(n, _) if n == name));
            if !plain || twice {
                return Err(format!("{{{name}}} of '{text}' must be small letters, once a line"));
            }
            pieces.push(Piece::Any(name.to_owned(), all));
            rest = &rest[close + 1..];
        }
        if rest.contains('}') {
            return Err(format!("a brace of '{text}' does not open"));
        }
        if !rest.is_empty() {
            pieces.push(Piece::Text(rest.to_owned()));
        }
        if pieces.is_empty() {
            return Err("a line is empty".into());
        }
        Ok(Self(pieces))
    }

    /// The names of its places, sorted.
    pub fn names(&self) -> Vec<&str> {
        let mut all: Vec<&str> = self
            .0
            .iter()
            .filter_map(|p| match p {
                Piece::Any(name, _) => Some(name.as_str()),
                Piece::Text(_) => None,
            })
            .collect();
        all.sort_unstable();
        all
    }

    /// It fits the same lines, whatever its places are called.
    pub fn same(&self, other: &Self) -> bool {
        let bare = |p: &Piece| match p {
            Piece::Text(text) => Piece::Text(text.clone()),
            Piece::Any(_, all) => Piece::Any(String::new(), *all),
        };
        self.0.iter().map(bare).eq(other.0.iter().map(bare))
    }

    /// What a line has in its places; `None` where it does not fit.
    pub fn matches<'a>(&'a self, line: &'a str) -> Option<Found<'a>> {
        let mut found = Found::new();
        let mut rest = line;
        for (k, piece) in self.0.iter().enumerate() {
            match piece {
                Piece::Text(text) => rest = rest.strip_prefix(text.as_str())?,
                Piece::Any(name, all) => {
                    let end = match self.0.get(k + 1) {
                        // Of a text at the end of the line the last place counts.
                        Some(Piece::Text(next)) if k + 2 == self.0.len() => {
                            rest.strip_suffix(next.as_str()).map(str::len)?
                        }
                        Some(Piece::Text(next)) => rest.find(next.as_str())?,
                        _ => rest.len(),
                    };
                    let word = &rest[..end];
                    if !all && (word.is_empty() || word.contains(' ')) {
                        return None;
                    }
                    found.insert(name, word);
                    rest = &rest[end..];
                }
            }
        }
        rest.is_empty().then_some(found)
    }

    /// The line with these words in its places.
    pub fn filled(&self, found: &Found<'_>) -> String {
        self.0
            .iter()
            .map(|p| match p {
                Piece::Text(text) => text.as_str(),
                Piece::Any(name, _) => found.get(name.as_str()).copied().unwrap_or_default(),
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_come_back() {
        let p = Pattern::new("G43.4 H{tool}").unwrap();
        let found = p.matches("G43.4 H12").unwrap();
        assert_eq!(found["tool"], "12");
        assert_eq!(Pattern::new("G234 H{tool} P1").unwrap().filled(&found), "G234 H12 P1");
        for other in ["G43.4 H", "G43.4 H1 X2", "G43.5 H1", "XG43.4 H1"] {
            assert!(p.matches(other).is_none(), "{other}");
        }
        let p = Pattern::new("O{number} ({name*})").unwrap();
        let found = p.matches("O0012 (A (B) C)").unwrap();
        assert_eq!((found["number"], found["name"]), ("0012", "A (B) C"));
        let p = Pattern::new("CYCLE832({tol},1,1)").unwrap();
        assert_eq!(p.matches("CYCLE832(0.0020,1,1)").unwrap()["tol"], "0.0020");
    }

    #[test]
    fn what_is_no_line() {
        for bad in ["", " G1", "G{", "G{a}{b}", "G{a} H{a}", "G{A}", "G}", "A\nB", "{}"] {
            assert!(Pattern::new(bad).is_err(), "{bad}");
        }
    }
}
