//! The shape of source files: a head that says what the file is about, and a length that one can read.

use super::finding::Finding;
use super::tree::{CRATES, File, Tree};

/// Most lines of a Rust file. One idea takes a hundred to four hundred.
const MOST_LINES: usize = 500;

/// Longer files, each with the reason.
const LONG_FILES: [(&str, &str); 0] = [];

fn rust_files(tree: &Tree) -> impl Iterator<Item = &File> {
    CRATES.iter().flat_map(|folder| tree.rust_below(folder))
}

/// Every Rust file begins with a `//!` line that says something.
pub fn heads(tree: &Tree) -> Vec<Finding> {
    let headless = rust_files(tree).filter(|file| {
        let head = file.text().lines().next().and_then(|line| line.strip_prefix("//!"));
        head.is_none_or(|text| text.split_whitespace().count() < 2)
    });
    let what =
        "the first line is no `//!` sentence: say what the file is for, its conventions and its source";
    headless.map(|file| Finding::at(&file.path, 0, what)).collect()
}

/// No Rust file has more than [`MOST_LINES`] lines, but those listed.
pub fn lengths(tree: &Tree) -> Vec<Finding> {
    let listed = |file: &File| LONG_FILES.iter().any(|(path, _)| *path == file.path);
    let lines = |file: &File| file.text().lines().count();
    let long = rust_files(tree).filter(|file| lines(file) > MOST_LINES && !listed(file));
    let what = |file: &File| format!("{} lines, at most {MOST_LINES}: split it by idea", lines(file));
    long.map(|file| Finding::whole(&file.path, what(file))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_without_a_head_is_found() {
        let found = |text| heads(&Tree::of(&[("cli/src/a.rs", text)])).len();
        assert_eq!(found("//! Tool poses: tip and axis.\n"), 0);
        for text in
            ["", "\n//! Tool poses: tip and axis.\n", "fn a() {}", "// Tool poses: tip", "//! poses\n"]
        {
            assert_eq!(found(text), 1, "{text:?}");
        }
    }

    #[test]
    fn a_long_file_is_found() {
        let found = |lines: usize| lengths(&Tree::of(&[("geom/tests/a.rs", &"\n".repeat(lines))])).len();
        assert_eq!((found(MOST_LINES), found(MOST_LINES + 1)), (0, 1));
    }
}
