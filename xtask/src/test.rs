//! `cargo xtask test`: every test of every crate, doctests included, against the committed lock file; and, for `ci`, the
//! programs that show how the library is used.

use crate::cmd::{Failure, cargo, output, root, run as run_command};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Where those programs lie.
const EXAMPLES: &str = "cli/examples";

/// Runs the tests; `rest` is handed on to `cargo test`.
pub fn run(rest: &[&str]) -> Result<(), Failure> {
    let root = root()?;
    let arguments = [&["test", "--workspace", "--locked"], rest].concat();
    run_command(cargo(&root, &arguments))
}

/// Runs every program in `cli/examples`. Each asserts what it claims, so that its exit status tells. They are taken from the build
/// of the tests: by itself, a package is built with other features of what it depends on, which takes minutes.
pub fn examples(root: &Path) -> Result<(), Failure> {
    let build = [
        "build",
        "--workspace",
        "--tests",
        "--examples",
        "--locked",
        "--message-format",
        "json-render-diagnostics",
    ];
    let built = executables(&output(cargo(root, &build))?);
    for name in names(root)? {
        let start = Instant::now();
        let program = built.get(&name).ok_or_else(|| Failure::Answer {
            line: format!("cargo {}", build.join(" ")),
            why: format!("it names no program for the example {name}"),
        })?;
        let mut command = Command::new(program);
        command.current_dir(root);
        run_command(command)?;
        println!("example {name}: run in {:.1} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}

/// The programs of examples that cargo's messages name, by the names of their targets.
fn executables(messages: &str) -> BTreeMap<String, PathBuf> {
    let artifacts = messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let examples = artifacts.filter(|m| m["target"]["kind"][0] == "example");
    examples
        .filter_map(|m| {
            Some((m["target"]["name"].as_str()?.to_owned(), PathBuf::from(m["executable"].as_str()?)))
        })
        .collect()
}

/// The names of the programs, in order. There is at least one.
fn names(root: &Path) -> Result<Vec<String>, Failure> {
    let unread = |why: std::io::Error| Failure::Read { path: PathBuf::from(EXAMPLES), why };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(root.join(EXAMPLES)).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        if path.extension().is_some_and(|e| e == "rs") {
            names.extend(path.file_stem().map(|name| name.to_string_lossy().into_owned()));
        }
    }
    if names.is_empty() {
        return Err(unread(std::io::Error::other("there is no program in it")));
    }
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_programs_of_the_folder_are_found_and_none_is_a_failure() {
        let root = root().unwrap();
        assert_eq!(
            names(&root).unwrap(),
            [
                "judge_a_program",
                "own_machine",
                "own_surface",
                "plan_a_part",
                "read_a_face",
                "strip_widths",
                "sweep",
            ]
        );
        let said = names(&root.join("xtask")).unwrap_err().to_string();
        assert!(said.starts_with("cannot read cli/examples"), "{said}");
    }

    #[test]
    fn programs_are_read_from_what_cargo_says() {
        let said = concat!(
            r#"{"reason":"compiler-artifact","target":{"kind":["example"],"name":"sweep"},"executable":"/t/examples/sweep"}"#,
            "\n",
            r#"{"reason":"compiler-artifact","target":{"kind":["bin"],"name":"osculate"},"executable":"/t/osculate"}"#,
            "\n",
            r#"{"reason":"compiler-artifact","target":{"kind":["example"],"name":"library"},"executable":null}"#,
            "\nnot a message\n",
        );
        let found: Vec<_> = executables(said).into_iter().collect();
        assert_eq!(found, [("sweep".to_owned(), PathBuf::from("/t/examples/sweep"))]);
    }
}
