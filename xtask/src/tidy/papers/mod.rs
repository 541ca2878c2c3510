//! The table of all that the papers say, [`PAGE`]: nothing is left out, and what it names exists.
//!
//! A citation such as `[R97, eq. 37]` in a source leads to a row here, and the row to code, test and command.

mod citations;
mod commands;
mod rows;

use super::finding::Finding;
use super::source::has_word;
use super::tree::{File, Tree};
use citations::{Sort, cited};
use rows::{Row, rows};
use std::collections::BTreeSet;

/// The page with a table for each paper.
const PAGE: &str = "docs/papers/equations.md";

/// Where the program's verbs and options are written.
const ARGUMENTS: &str = "cli/src/screen/args.rs";

/// Where the keys of jobs are written.
const KEYS: &str = "cli/src/job/keys.rs";

/// A paper, and the highest number of what it numbers. M86 and Z17 print formulas without numbers.
struct Paper {
    key: &'static str,
    equations: u32,
    figures: u32,
    tables: u32,
}

const PAPERS: [Paper; 4] = [
    Paper { key: "R97", equations: 63, figures: 4, tables: 0 },
    Paper { key: "M86", equations: 0, figures: 5, tables: 0 },
    Paper { key: "D98", equations: 18, figures: 10, tables: 0 },
    Paper { key: "Z17", equations: 0, figures: 16, tables: 3 },
];

/// What stands first in the cell of commands of a row that has none: nobody has written one yet; what the paper says is wrong; it says
/// nothing that could be computed, as a definition or what others did.
const WITHOUT: [&str; 3] = ["no command yet", "wrong", "empty"];

/// Everything that the papers number has a row, and what the rows name exists.
pub fn every_statement(tree: &Tree) -> Vec<Finding> {
    let Some(page) = tree.get(PAGE) else { return vec![Finding::whole(PAGE, "missing")] };
    let (rows, mut findings) = rows(page.text(), &PAPERS.map(|p| p.key));
    let mut seen = BTreeSet::new();
    for row in &rows {
        if !seen.insert((row.paper, row.number)) {
            let what = format!("{} has two rows for {}", row.paper, row.number);
            findings.push((row.line, what));
        }
    }
    let mut findings: Vec<Finding> =
        findings.into_iter().map(|(line, what)| Finding::at(PAGE, line, what)).collect();
    for paper in PAPERS {
        for (sort, most) in
            [(Sort::Equation, paper.equations), (Sort::Figure, paper.figures), (Sort::Table, paper.tables)]
        {
            let missing =
                (1..=most).map(|n| sort.number(n)).filter(|n| !seen.contains(&(paper.key, n.as_str())));
            findings
                .extend(missing.map(|n| Finding::whole(PAGE, format!("{} has no row for {n}", paper.key))));
        }
    }
    let known = Known::of(tree);
    if known.verbs.is_empty() {
        findings.push(Finding::whole(ARGUMENTS, "no verbs found: has the enum `Verb` moved?"));
        return findings;
    }
    for row in &rows {
        findings.extend(known.wrong(row).into_iter().map(|what| Finding::at(PAGE, row.line, what)));
    }
    findings
}

/// Every equation, figure or table that a source or a page cites has a row.
pub fn citations(tree: &Tree) -> Vec<Finding> {
    let keys = PAPERS.map(|p| p.key);
    let page = tree.get(PAGE).map_or("", File::text);
    let numbers: BTreeSet<(&str, String)> =
        rows(page, &keys).0.iter().map(|row| (row.paper, row.number.to_owned())).collect();
    let mut findings = Vec::new();
    for file in tree.files.iter().filter(|f| (f.is("rs") || f.is("md")) && f.path != PAGE && !is_of_checks(f))
    {
        for (index, line) in file.text().lines().enumerate() {
            for (key, number) in cited(line, &keys) {
                if !numbers.contains(&(key, number.clone())) {
                    findings.push(Finding::at(
                        &file.path,
                        index,
                        format!("{PAGE} has no row for {key}, {number}"),
                    ));
                }
            }
        }
    }
    findings
}

/// The tests of these rules cite what is not there.
fn is_of_checks(file: &File) -> bool {
    file.path.starts_with("xtask/src/tidy/papers/")
}

/// What there is to name.
struct Known<'a> {
    tree: &'a Tree,
    items: BTreeSet<&'a str>,
    verbs: commands::Verbs,
}

impl<'a> Known<'a> {
    fn of(tree: &'a Tree) -> Self {
        let lists = tree.files.iter().filter(|f| f.path.starts_with("api/") && f.is("txt"));
        let items = lists.flat_map(|f| f.text().lines()).filter_map(item_of).collect();
        let verbs = tree.get(ARGUMENTS).map_or_else(Default::default, |file| commands::verbs(file.text()));
        Self { tree, items, verbs }
    }

    /// What is wrong with a row.
    fn wrong(&self, row: &Row<'_>) -> Vec<String> {
        let mut out = Vec::new();
        for item in spans(row.code).filter(|item| !self.items.contains(item)) {
            out.push(format!("no list in api has `{item}`"));
        }
        out.extend(spans(row.test).filter_map(|test| self.wrong_test(test)));
        if spans(row.code).next().is_some() && spans(row.test).next().is_none() {
            out.push(format!("{} has code and no test", row.number));
        }
        out.extend(spans(row.command).filter_map(|span| self.wrong_in_command(span)));
        let runs = spans(row.command).any(|span| span.starts_with(commands::PROGRAM));
        if !runs && !WITHOUT.iter().any(|word| row.command.starts_with(word)) {
            let words = WITHOUT.map(|w| format!("`{w}`")).join(", ");
            out.push(format!("{} names no command: begin with one of {words}", row.number));
        }
        out
    }

    /// A test is `file::name`.
    fn wrong_test(&self, test: &str) -> Option<String> {
        let Some((path, name)) = test.rsplit_once("::") else {
            return Some(format!("`{test}` is no test: file::name is wanted"));
        };
        match self.tree.get(path) {
            None => Some(format!("{path} does not exist")),
            Some(file) if is_test(file.text(), name) => None,
            Some(_) => Some(format!("{path} has no test {name}")),
        }
    }

    /// A command, `[table] key` of a job, or a word of an answer.
    fn wrong_in_command(&self, span: &str) -> Option<String> {
        if span.starts_with(commands::PROGRAM) {
            return commands::wrong(span, &self.verbs);
        }
        if let Some((table, rest)) = span.strip_prefix('[').and_then(|s| s.split_once(']')) {
            let keys = self.tree.get(KEYS).map_or("", File::text);
            let key = rest.trim_start().split([' ', '=']).next().unwrap_or_default();
            let is_there = |word: &str| word.is_empty() || keys.contains(&format!("\"{word}\""));
            let gone = [table, key].into_iter().find(|word| !is_there(word))?;
            return Some(format!("no job has `{gone}` of `{span}`"));
        }
        let mut sources = self.tree.rust_below("cli/src");
        let parts: Vec<&str> = span.split(['.', '/']).collect();
        let all = |file: &File| parts.iter().all(|part| has_word(file.text(), part));
        (!sources.any(all)).then(|| format!("no source of the program has `{span}`"))
    }
}

/// The path of a public item in a line of a list.
fn item_of(line: &str) -> Option<&str> {
    let path = line.split_whitespace().find(|word| word.starts_with("osculate"))?;
    let end = path.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(path.len());
    Some(path[..end].trim_end_matches(':'))
}

/// What stands in code font.
fn spans(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// Whether a source has a test of this name: after an attribute `#[test]`, or in a block of `proptest!`.
fn is_test(text: &str, name: &str) -> bool {
    let start = format!("fn {name}(");
    let mut lines: Vec<&str> = Vec::new();
    for line in text.lines().map(str::trim) {
        if line.starts_with(&start) {
            let above = lines.iter().rev().take_while(|l| l.starts_with('#') || l.starts_with("//"));
            return above.into_iter().any(|l| *l == "#[test]")
                || lines.iter().any(|l| l.starts_with("proptest!"));
        }
        lines.push(line);
    }
    false
}

#[cfg(test)]
mod tests;
