//! No bare fused multiply-add. Where the target lacks the instruction it becomes a call of a library function, far slower
//! than the two operations that it replaces.

use super::code::library_code;
use super::finding::Finding;
use super::source::has_word;
use super::tree::Tree;

/// No `mul_add` in the libraries, as a method or by its path.
pub fn no_bare_mul_add(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (file, code) in library_code(tree) {
        let called = |line: &str| has_word(line, ".mul_add(") || has_word(line, "::mul_add");
        for (index, _) in code.lines().enumerate().filter(|(_, line)| called(line)) {
            findings.push(Finding::at(&file.path, index, "`mul_add`: write the product and the sum"));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy::tree::LIBRARIES;

    #[test]
    fn both_forms_are_found() {
        let text =
            "let a = x.mul_add(y, z);\nlet b = f64::mul_add(x, y, z);\n// x.mul_add(y, z)\nfn mul_add() {}";
        for folder in LIBRARIES {
            let path = format!("{folder}/src/a.rs");
            let found = no_bare_mul_add(&Tree::of(&[(&path, text)]));
            assert_eq!(found.iter().map(|f| f.line).collect::<Vec<_>>(), [1, 2]);
        }
    }
}
