//! The rows of the page's tables.

/// Headings of the columns, in their order.
pub const COLUMNS: [&str; 7] =
    ["number", "what it is", "code", "test", "command", "ours / the paper's", "remark"];

/// One row.
#[derive(Debug, PartialEq, Eq)]
pub struct Row<'a> {
    /// Index of the line.
    pub line: usize,
    /// Key of the paper.
    pub paper: &'static str,
    /// As sources cite it: `eq. 37`, `fig. 4`, `table 1`, or a name of ours.
    pub number: &'a str,
    pub code: &'a str,
    pub test: &'a str,
    pub command: &'a str,
}

/// The rows below headings `## KEY`, and what is wrong with their shape, by line.
pub fn rows<'a>(text: &'a str, keys: &[&'static str]) -> (Vec<Row<'a>>, Vec<(usize, String)>) {
    let (mut rows, mut wrong, mut paper, mut heads) = (Vec::new(), Vec::new(), None, 0);
    for (line, content) in text.lines().enumerate() {
        if let Some(title) = content.strip_prefix("## ") {
            paper = keys.iter().copied().find(|key| title.split([':', ' ']).next() == Some(*key));
        }
        let Some(inner) = content.strip_prefix('|').and_then(|l| l.strip_suffix('|')) else {
            heads = 0;
            continue;
        };
        let cells: Vec<&str> = inner.split('|').map(str::trim).collect();
        heads += 1;
        let Some(paper) = paper.filter(|_| heads != 2) else { continue };
        let [number, _, code, test, command, _, _] = cells[..] else {
            wrong.push((line, format!("{} cells, {} are wanted", cells.len(), COLUMNS.len())));
            continue;
        };
        if heads == 1 {
            if cells != COLUMNS {
                wrong.push((line, format!("the columns are {}", COLUMNS.join(", "))));
            }
            continue;
        }
        rows.push(Row { line, paper, number, code, test, command });
    }
    (rows, wrong)
}
