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

/// The programs of a crate's tests by their folders: one that is published with it, and one that needs the repository.
const PROGRAMS: [(&str, &str); 2] = [("tests", "all.rs"), ("tests/repository", "main.rs")];

/// Every file in a crate's folders of tests is a module of its program: cargo does not look for others, and what it leaves out runs nowhere.
pub fn tests_run(tree: &Tree) -> Vec<Finding> {
    let mut out = Vec::new();
    for (folder, main) in CRATES.iter().flat_map(|name| PROGRAMS.map(|(f, m)| (format!("{name}/{f}"), m))) {
        let program = format!("{folder}/{main}");
        let all = tree.get(&program).map_or("", File::text);
        let named = |stem: &str| all.lines().any(|line| line == format!("mod {stem};"));
        for file in tree.rust_below(&folder) {
            let name = file.path.strip_prefix(&format!("{folder}/")).unwrap_or_default();
            let stem = name.strip_suffix(".rs").filter(|stem| !stem.contains('/') && name != main);
            if stem.is_some_and(|stem| !named(stem)) {
                out.push(Finding::whole(
                    &file.path,
                    format!("no test of it runs: {program} does not name it"),
                ));
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_tests_that_runs_nowhere_is_found() {
        let found = |all: &str| {
            let files = [("geom/tests/all.rs", all), ("geom/tests/a.rs", ""), ("geom/tests/common/b.rs", "")];
            let of_repository = [
                ("geom/tests/repository/main.rs", all),
                ("geom/tests/repository/a.rs", ""),
                ("geom/tests/repository/data/b.rs", ""),
            ];
            let counts = [&files, &of_repository].map(|files| tests_run(&Tree::of(files)).len());
            assert_eq!(counts[0], counts[1]);
            counts[0]
        };
        assert_eq!([found("//! All.\n\nmod a;\n"), found("mod ab;\n// mod a;\n")], [0, 1]);
    }

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
