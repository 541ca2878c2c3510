//! Nothing unfinished: no marks of open work, no tests that do not run.

use super::finding::Finding;
use super::source::has_word;
use super::tree::Tree;

/// The marks. Each is put together from two parts so that this file does not hold what it looks for.
const MARKS: [&str; 7] = [
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("XX", "X"),
    concat!("HA", "CK"),
    concat!("to", "do!"),
    concat!("unimple", "mented!"),
    concat!("#[ig", "nore"),
];

/// None of [`MARKS`] in Rust, Markdown or TOML, comments included.
pub fn no_unfinished_work(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in tree.files.iter().filter(|f| f.is("rs") || f.is("md") || f.is("toml")) {
        for (index, line) in file.text().lines().enumerate() {
            let marks = MARKS.iter().filter(|mark| has_word(line, mark));
            findings.extend(marks.map(|mark| {
                Finding::at(
                    &file.path,
                    index,
                    format!("`{mark}`: finish it, or say what is missing in words"),
                )
            }));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mark_is_found_in_code_and_prose() {
        for mark in MARKS {
            for path in ["geom/src/a.rs", "README.md", "Cargo.toml"] {
                let text = format!("a\n// {mark}: b\n");
                let found = no_unfinished_work(&Tree::of(&[(path, &text)]));
                assert_eq!(found.iter().map(|f| f.line).collect::<Vec<_>>(), [2], "{mark} in {path}");
            }
            assert!(no_unfinished_work(&Tree::of(&[("a.step", mark)])).is_empty());
        }
    }

    #[test]
    fn words_that_contain_a_mark_are_free() {
        let text = format!("{}LIST {}S", MARKS[0], MARKS[3]);
        assert!(no_unfinished_work(&Tree::of(&[("a.md", &text)])).is_empty());
    }
}
