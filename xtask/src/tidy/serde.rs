//! Serde on spec structs only: what a user writes has a format, what is computed has invariants.

use super::code::library_code;
use super::finding::Finding;
use super::source::has_word;
use super::tree::Tree;

/// The files of the libraries that describe what users write in files. The cli's own output types are free.
const SPECS: [&str; 4] = [
    "postproc/src/machine/spec.rs",
    "postproc/src/nc/dialect_file/spec.rs",
    "tools/src/spec.rs",
    "surfaces/src/json/spec.rs",
];

/// Neither a derive nor an implementation of serde's traits in the libraries outside [`SPECS`], and no file in that
/// list that is gone.
pub fn serde_on_specs_only(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (file, code) in library_code(tree) {
        if SPECS.contains(&file.path.as_str()) {
            continue;
        }
        let named = |line: &str| ["serde", "Serialize", "Deserialize"].iter().any(|w| has_word(line, w));
        for (index, _) in code.lines().enumerate().filter(|(_, line)| named(line)) {
            let what =
                "serde outside the spec files: put what users write into a spec struct and validate it";
            findings.push(Finding::at(&file.path, index, what));
        }
    }
    let gone = SPECS.iter().filter(|path| tree.get(path).is_none());
    findings.extend(gone.map(|path| Finding::whole(*path, "listed as a spec file in xtask, but gone")));
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_derive_on_a_mathematical_type_is_found() {
        let derive = "#[derive(Clone, serde::Serialize)]\npub struct A;";
        let mut files: Vec<(&str, &str)> = SPECS.iter().map(|path| (*path, derive)).collect();
        files.push(("cli/src/out.rs", derive));
        assert!(serde_on_specs_only(&Tree::of(&files)).is_empty());
        files.push(("geom/src/a.rs", derive));
        let found = serde_on_specs_only(&Tree::of(&files));
        assert_eq!((found.len(), found[0].line), (1, 1));
        files.push(("geom/src/b.rs", "use x::{A,\n Deserialize};"));
        assert_eq!(serde_on_specs_only(&Tree::of(&files)).len(), 2);
    }

    #[test]
    fn a_listed_file_that_is_gone_is_found() {
        assert_eq!(serde_on_specs_only(&Tree::of(&[])).len(), SPECS.len());
    }
}
