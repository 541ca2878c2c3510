//! `cargo xtask tidy`: the rules of the workspace that neither the compiler nor clippy checks.
//!
//! Each rule is a function from the files (or from cargo's metadata) to findings. All rules run, all findings are
//! printed, one a line, in order of file and line.

mod circles;
mod code;
mod data;
mod docs;
mod effects;
mod finding;
mod floating;
mod known_circles;
mod layers;
mod modules;
mod notation;
mod packaging;
mod papers;
mod paths;
mod serde;
mod shape;
mod source;
mod tree;
mod words;
mod workflows;

use crate::cmd::{Failure, cargo, output, root};
use finding::Finding;
use tree::Tree;

/// The rules that read files.
const RULES: [fn(&Tree) -> Vec<Finding>; 20] = [
    circles::no_module_circles,
    effects::quiet_libraries,
    floating::no_bare_mul_add,
    serde::serde_on_specs_only,
    words::no_unfinished_work,
    paths::no_machine_paths,
    data::no_large_files,
    data::foreign_data_has_a_notice,
    shape::heads,
    shape::lengths,
    shape::tests_run,
    packaging::crate_roots,
    packaging::release_files,
    packaging::published,
    docs::readme_commands,
    docs::named_files,
    notation::code_names,
    papers::every_statement,
    papers::citations,
    workflows::workflows,
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
    use super::tree::{CRATES, LIBRARIES};
    use super::*;

    #[test]
    fn the_folders_named_here_are_the_members_of_the_workspace() {
        let manifest = std::fs::read_to_string(root().unwrap().join("Cargo.toml")).unwrap();
        let members = manifest.lines().find(|l| l.starts_with("members")).unwrap();
        let named: Vec<&str> = members.split('"').skip(1).step_by(2).collect();
        assert_eq!(named, CRATES);
        assert_eq!(LIBRARIES, CRATES[..5]);
    }
}
