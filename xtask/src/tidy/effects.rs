//! Libraries compute: no files by path, no terminal, no environment. Readers take `&str`, `&[u8]` or `Read`.

use super::code::library_code;
use super::finding::Finding;
use super::source::has_word;
use super::tree::Tree;

/// What stands for an effect, with what it does. The opening sign at the end keeps `print!` from matching a function
/// of that name.
const EFFECTS: [(&str, &str); 13] = [
    ("fs::", "uses the file system"),
    ("std::fs", "uses the file system"),
    ("File::open", "opens a file"),
    ("File::create", "creates a file"),
    ("println!", "prints"),
    ("eprintln!", "prints"),
    ("print!", "prints"),
    ("eprint!", "prints"),
    ("dbg!", "prints"),
    ("io::stdout", "writes to the terminal"),
    ("io::stderr", "writes to the terminal"),
    ("io::stdin", "reads from the terminal"),
    ("std::env", "reads the environment"),
];

/// The library crates have none of [`EFFECTS`] outside their tests.
pub fn quiet_libraries(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (file, code) in library_code(tree) {
        for (index, line) in code.lines().enumerate() {
            let grouped = line.contains("std::{") && has_word(line, "fs");
            let named = EFFECTS.iter().find(|(sign, _)| has_word(line, sign));
            let effect = named.copied().or(grouped.then_some(("std::{fs}", "uses the file system")));
            if let Some((sign, does)) = effect {
                let what = format!("`{sign}` {does}: that is for the cli crate, hand the value in or out");
                findings.push(Finding::at(&file.path, index, what));
            }
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<usize> {
        quiet_libraries(&Tree::of(&[("geom/src/a.rs", text)])).iter().map(|f| f.line).collect()
    }

    #[test]
    fn every_effect_is_found_once_a_line() {
        for (sign, _) in EFFECTS {
            assert_eq!(lines(&format!("fn a() {{\n    {sign}(\"b\");\n}}\n")), [2], "{sign}");
        }
        assert_eq!(lines("use std::{fmt, fs};"), [1]);
    }

    #[test]
    fn comments_texts_tests_and_other_crates_are_free() {
        let quiet = "//! println!(\"a\")\nlet a = \"std::fs\"; // dbg!(a)\nwrite!(f, \"b\")?; offs::b();\n";
        assert!(lines(quiet).is_empty());
        assert!(lines("#[cfg(test)]\nmod tests {\n fn a() { println!(\"b\"); }\n}\n").is_empty());
        let elsewhere = [("cli/src/a.rs", "println!()"), ("geom/tests/a.rs", "println!()")];
        assert!(quiet_libraries(&Tree::of(&elsewhere)).is_empty());
    }
}
