//! Tables and numbers as text, for screens and pages.

use osculate_geom::{Diagnostic, Severity};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Whether a character steers a terminal instead of standing on it: control characters, and those that turn the direction of writing.
#[must_use]
pub fn steers(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Text as it may go to a terminal: what [`steers`] stands as an escape, such as `\u{1b}`; ends of lines stay.
#[must_use]
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |c| steers(c) && c != '\n')
}

fn escaped(text: &str, which: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&which) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match which(c) {
            true => out.extend(c.escape_default()),
            false => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// Words as a sentence lists them, the first `most` of them.
///
/// ```
/// use osculate::words::listed;
///
/// assert_eq!(listed(&["F1", "F2", "F3", "F4"], 2), "F1, F2 and 2 more");
/// assert_eq!(listed(&["F1", "F2"], 2), "F1, F2");
/// ```
#[must_use]
pub fn listed<T: AsRef<str>>(all: &[T], most: usize) -> String {
    let some: Vec<&str> = all.iter().take(most).map(AsRef::as_ref).collect();
    let more = all.len() - some.len();
    some.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// A table with right-aligned columns but the first.
///
/// ```
/// use osculate::words::{Table, number};
///
/// let mut table = Table::new(["tool", "width mm"]);
/// table.row(["ball 6".into(), number(0.77421, 3)]);
/// assert_eq!(table.render(), "  tool    width mm\n  ----------------\n  ball 6     0.774\n");
/// ```
pub struct Table {
    rows: Vec<Vec<String>>,
    left: bool,
}

impl Table {
    /// A table with these headings, units in them.
    pub fn new<'a>(headings: impl IntoIterator<Item = &'a str>) -> Self {
        Self { rows: vec![headings.into_iter().map(ToString::to_string).collect()], left: false }
    }

    /// A table of words, all columns left-aligned.
    pub fn left<'a>(headings: impl IntoIterator<Item = &'a str>) -> Self {
        Self { left: true, ..Self::new(headings) }
    }

    /// Adds a row; a cell is one line, whatever it holds.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().map(|c| escaped(&c, steers).into_owned()).collect());
    }

    /// The table as text.
    pub fn render(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |c: usize| self.rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
        let mut out = String::new();
        for (k, row) in self.rows.iter().enumerate() {
            let mut line = String::from(" ");
            for (c, (cell, w)) in row.iter().zip(&widths).enumerate() {
                let pad = " ".repeat(w.saturating_sub(cell.chars().count()));
                if c == 0 {
                    line.push_str(&format!(" {cell}{pad}"));
                } else if self.left {
                    line.push_str(&format!("  {cell}{pad}"));
                } else {
                    line.push_str(&format!("  {pad}{cell}"));
                }
            }
            out.push_str(line.trim_end());
            out.push('\n');
            if k == 0 {
                let rule: usize = widths.iter().sum::<usize>() + 2 * columns.saturating_sub(1);
                out.push_str(&format!("  {}\n", "-".repeat(rule)));
            }
        }
        out
    }
}

/// Places of findings that say the same which a line names; with more it counts the others.
const PLACES: usize = 3;

/// Findings, one a line; those that say the same of several places are one.
pub fn findings(all: &[Diagnostic]) -> String {
    let mut told: Vec<(&Diagnostic, Vec<&str>)> = Vec::new();
    let mut places: BTreeMap<(Severity, &str), usize> = BTreeMap::new();
    for d in all {
        let k = *places.entry((d.severity, &d.message)).or_insert(told.len());
        if k == told.len() {
            told.push((d, Vec::new()));
        }
        if !d.place.is_empty() {
            told[k].1.push(&d.place);
        }
    }
    let line = |(first, places): (&Diagnostic, Vec<&str>)| {
        let mut place = places[..places.len().min(PLACES)].join(", ");
        if places.len() > PLACES {
            place += &format!(" and {} more", places.len() - PLACES);
        }
        let one = Diagnostic { place, ..first.clone() };
        format!("  {}\n", escaped(&one.to_string(), steers))
    };
    told.into_iter().map(line).collect()
}

/// A number with `digits` significant digits, plain where it is neither huge nor tiny.
///
/// ```
/// use osculate::words::number;
///
/// assert_eq!((number(0.0123456, 3), number(123_456.0, 3)), ("0.0123".into(), "123456".into()));
/// assert_eq!((number(-0.0, 3), number(1.5e-9, 3)), ("0".into(), "1.50e-9".into()));
/// ```
pub fn number(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        // No minus before a zero.
        return format!("{}", x + 0.0);
    }
    let exponent = x.abs().log10().floor();
    if (-5.0..7.0).contains(&exponent) {
        let decimals = (digits as f64 - 1.0 - exponent).max(0.0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.*e}", digits.saturating_sub(1))
    }
}

/// A number of minima.
pub fn minima(count: usize) -> String {
    format!("{count} {}", if count == 1 { "minimum" } else { "minima" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits() {
        assert_eq!(number(0.0123456, 3), "0.0123");
        assert_eq!(number(123_456.0, 3), "123456");
        assert_eq!(number(1.5e-9, 3), "1.50e-9");
        assert_eq!(number(0.0, 3), "0");
    }

    #[test]
    fn names_cannot_steer_a_terminal() {
        assert_eq!(visible("plain, \u{e4} \u{221e}\n"), "plain, \u{e4} \u{221e}\n");
        assert_eq!(visible("a\u{1b}[31mb\r\u{9b}\u{202e}"), "a\\u{1b}[31mb\\r\\u{9b}\\u{202e}");
        let mut t = Table::new(["name"]);
        t.row(["two\nlines".into()]);
        assert_eq!(t.render(), "  name\n  ----------\n  two\\nlines\n");
        let found = findings(&[Diagnostic::note("F1 'a\nnote: F2'", "all is well")]);
        assert_eq!(found.lines().count(), 1, "{found}");
    }

    #[test]
    fn what_is_the_same_in_several_places_is_one_line() {
        let all = ["T1", "T2", "T3", "T4"].map(|place| Diagnostic::warning(place, "it is a drill"));
        let other = Diagnostic::note("T2", "it is long");
        let found = findings(&[all[0].clone(), other, all[1].clone(), all[2].clone(), all[3].clone()]);
        assert_eq!(found, "  warning: T1, T2, T3 and 1 more: it is a drill\n  note: T2: it is long\n");
        assert_eq!(findings(&all[..1]), "  warning: T1: it is a drill\n");
    }

    #[test]
    fn tables_line_up() {
        let mut t = Table::new(["form", "width mm"]);
        t.row(["exact".into(), "1.25".into()]);
        assert_eq!(t.render(), "  form   width mm\n  ---------------\n  exact      1.25\n");
    }
}
