//! The code names in NOTATION.md exist.

use super::code::library_code;
use super::finding::Finding;
use super::source::has_word;
use super::tree::Tree;

/// Heading of the column that holds code names.
const COLUMN: &str = "code";

/// Every name in code font in a column headed [`COLUMN`] of a table of NOTATION.md stands in a library: there is one
/// file whose code or path has all the identifiers of `module::Type::member`.
pub fn code_names(tree: &Tree) -> Vec<Finding> {
    let Some(notation) = tree.get("NOTATION.md") else {
        return vec![Finding::whole("NOTATION.md", "missing")];
    };
    let code = library_code(tree);
    let is_somewhere = |name: &str| {
        let parts: Vec<&str> = name.split("::").collect();
        code.iter().any(|(file, code)| parts.iter().all(|p| has_word(&file.path, p) || has_word(code, p)))
    };
    let (mut findings, mut column, mut names) = (Vec::new(), None, 0);
    for (index, line) in notation.text().lines().enumerate() {
        if !line.starts_with('|') {
            column = None;
            continue;
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let Some(at) = column else {
            // The first row of a table is its heading; a table without the column is not looked at.
            column = Some(cells.iter().position(|cell| *cell == COLUMN));
            continue;
        };
        let Some(cell) = at.and_then(|at: usize| cells.get(at)) else { continue };
        for name in cell.split('`').skip(1).step_by(2) {
            names += 1;
            if !is_somewhere(name) {
                findings.push(Finding::at("NOTATION.md", index, format!("no library has `{name}`")));
            }
        }
    }
    if names == 0 {
        findings.push(Finding::whole("NOTATION.md", format!("no table has names in a column `{COLUMN}`")));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(row: &str) -> Vec<String> {
        let notation = format!("# Notation\n\n| symbol | code | `x` |\n|---|---|---|\n{row}\n");
        let source = "pub struct Lean { lead_rad: f64 } // tilt_rad";
        let tree = Tree::of(&[("NOTATION.md", &notation), ("tools/src/strip/exact.rs", source)]);
        code_names(&tree).iter().map(|f| f.to_string()).collect()
    }

    #[test]
    fn a_name_that_is_nowhere_is_found() {
        assert!(found("| a | `Lean::lead_rad`, `strip::exact` | `no` |").is_empty());
        assert_eq!(
            found("| a | `Lean` or `Lean::tilt_rad` | |"),
            ["NOTATION.md:5: no library has `Lean::tilt_rad`"]
        );
        assert_eq!(found("| a | `lead` | |").len(), 1);
    }

    #[test]
    fn a_document_without_names_is_found() {
        assert_eq!(found("| a | b | |").len(), 1);
        assert_eq!(code_names(&Tree::of(&[])).len(), 1);
    }
}
