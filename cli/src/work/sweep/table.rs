//! All rows of a sweep as one table.

use super::Sweep;
use super::case::{Figures, NAMES, Row};
use std::fmt::Write;

/// The table as CSV with a line of headings: the case, what is varied, the answer, figures with their units in the headings, why. The same
/// bytes in whatever order the rows were made.
#[must_use]
pub fn csv<'a>(sweep: &Sweep, rows: impl Iterator<Item = &'a Row>) -> String {
    let mut out = String::new();
    let varied = sweep.varied().iter().map(|v| v.name.as_str());
    let headings = ["case"].into_iter().chain(varied).chain(["answer"]).chain(NAMES);
    let headings = headings.chain(["passes", "points", "strategy", "tool", "why"]);
    line(&mut out, headings.map(ToOwned::to_owned));
    for row in rows {
        let labels = sweep.labels_of(row.case).into_iter().map(ToOwned::to_owned);
        let cells = std::iter::once(row.case.to_string()).chain(labels).chain([row.answer.clone()]);
        let number = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
        let numbers = NAMES.map(|name| number(row.number(name)));
        let of = |what: &dyn Fn(&Figures) -> String| row.figures.as_ref().map_or_else(String::new, what);
        let more = [
            of(&|f| f.passes.to_string()),
            of(&|f| f.points.to_string()),
            of(&|f| f.strategy.clone()),
            of(&|f| f.tool.clone()),
            row.why.clone(),
        ];
        line(&mut out, cells.chain(numbers).chain(more));
    }
    out
}

/// A line of cells (RFC 4180): quoted where they must be.
fn line(out: &mut String, cells: impl Iterator<Item = String>) {
    for (k, cell) in cells.enumerate() {
        if k > 0 {
            out.push(',');
        }
        if cell.contains([',', '"', '\n', '\r']) {
            let _ = write!(out, "\"{}\"", cell.replace('"', "\"\""));
        } else {
            out.push_str(&cell);
        }
    }
    out.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_commas_quotes_and_ends_of_lines_are_quoted() {
        let mut out = String::new();
        line(&mut out, ["a", "b,c", "d\"e", "f\ng", ""].into_iter().map(ToOwned::to_owned));
        assert_eq!(out, "a,\"b,c\",\"d\"\"e\",\"f\ng\",\n");
    }
}
