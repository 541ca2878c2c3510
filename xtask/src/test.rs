//! `cargo xtask test`: every test of every crate, doctests included, against the committed lock file; and, for `ci`, the
//! programs that show how the library is used.

use crate::cmd::{Failure, cargo, root, run as run_command};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where those programs lie.
const EXAMPLES: &str = "cli/examples";

/// Runs the tests; `rest` is handed on to `cargo test`.
pub fn run(rest: &[&str]) -> Result<(), Failure> {
    let root = root()?;
    let arguments = [&["test", "--workspace", "--locked"], rest].concat();
    run_command(cargo(&root, &arguments))
}

/// Builds and runs every program in `cli/examples`. Each asserts what it claims, so that its exit status tells.
pub fn examples(root: &Path) -> Result<(), Failure> {
    for name in names(root)? {
        let start = Instant::now();
        let arguments = ["run", "--quiet", "--locked", "--package", "osculate", "--example", &name];
        run_command(cargo(root, &arguments))?;
        println!("example {name}: built and run in {:.1} s", start.elapsed().as_secs_f64());
    }
    Ok(())
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
}
