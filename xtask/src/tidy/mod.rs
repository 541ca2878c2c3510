//! `cargo xtask tidy`: the rules of the workspace that neither the compiler nor clippy checks.
//!
//! Each rule is a function from the files (or from cargo's metadata) to findings. All rules run, all findings are
//! printed, one a line, in order of file and line.

mod code;
mod data;
mod docs;
mod effects;
mod floating;
mod layers;
mod notation;
mod packaging;
mod paths;
mod serde;
mod shape;
mod source;
mod tree;
mod words;

use crate::cmd::{Failure, cargo, output, root};
use std::fmt;
use tree::Tree;

/// The folders of the library crates, which compute and do nothing else.
const LIBRARIES: [&str; 5] = ["geom", "surfaces", "tools", "productivity", "postproc"];

/// The folders of all crates.
const CRATES: [&str; 7] = ["geom", "surfaces", "tools", "productivity", "postproc", "cli", "xtask"];

/// A broken rule.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Finding {
    /// File, relative to the root, or what else is concerned.
    place: String,
    /// Line, counted from 1; 0 where the whole is concerned.
    line: usize,
    /// What is wrong and what to do.
    what: String,
}

impl Finding {
    /// A finding about a whole file.
    fn whole(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self { place: place.into(), line: 0, what: what.into() }
    }

    /// A finding about the line with the given index, counted from 0.
    fn at(place: &str, index: usize, what: impl Into<String>) -> Self {
        Self { place: place.to_owned(), line: index + 1, what: what.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.place, self.what),
            line => write!(f, "{}:{line}: {}", self.place, self.what),
        }
    }
}

/// The rules that read files.
const RULES: [fn(&Tree) -> Vec<Finding>; 14] = [
    effects::quiet_libraries,
    floating::no_bare_mul_add,
    serde::serde_on_specs_only,
    words::no_unfinished_work,
    paths::no_machine_paths,
    data::no_large_files,
    data::foreign_data_has_a_notice,
    shape::heads,
    shape::lengths,
    packaging::crate_roots,
    packaging::release_files,
    docs::readme_commands,
    docs::named_files,
    notation::code_names,
];

/// Runs every rule and prints the findings.
pub fn run() -> Result<(), Failure> {
    let root = root()?;
    let tree = Tree::read(&root)?;
    let mut findings: Vec<Finding> = RULES.iter().flat_map(|rule| rule(&tree)).collect();
    let metadata = output(cargo(&root, &["metadata", "--no-deps", "--format-version", "1", "--locked"]))?;
    findings.extend(layers::direction(&metadata)?);
    findings.sort();
    findings.dedup();
    for finding in &findings {
        println!("tidy: {finding}");
    }
    match findings.len() {
        0 => {
            println!("tidy: {} files, no findings", tree.files.len());
            Ok(())
        }
        count => Err(Failure::Untidy(count)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_read_like_compiler_messages() {
        assert_eq!(Finding::at("a.rs", 2, "b").to_string(), "a.rs:3: b");
        assert_eq!(Finding::whole("a.rs", "b").to_string(), "a.rs: b");
    }

    #[test]
    fn the_folders_named_here_are_the_members_of_the_workspace() {
        let manifest = std::fs::read_to_string(root().unwrap().join("Cargo.toml")).unwrap();
        let members = manifest.lines().find(|l| l.starts_with("members")).unwrap();
        let named: Vec<&str> = members.split('"').skip(1).step_by(2).collect();
        assert_eq!(named, CRATES);
        assert_eq!(LIBRARIES, CRATES[..5]);
    }
}
