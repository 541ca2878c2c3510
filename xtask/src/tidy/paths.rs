//! No absolute path of a machine: it would mean nothing on another one.

use super::finding::Finding;
use super::tree::Tree;

/// Beginnings of such paths, put together from two parts so that this file does not hold what it looks for.
const ROOTS: [&str; 5] = [
    concat!("/wo", "rk/"),
    concat!("/ho", "me/"),
    concat!("/ro", "ot/"),
    concat!("/Use", "rs/"),
    concat!("/tmp/", "bash_jobs"),
];

/// No path that begins with one of [`ROOTS`] in any text file.
pub fn no_machine_paths(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in &tree.files {
        for (index, line) in file.text().lines().enumerate() {
            if let Some(root) = ROOTS.iter().find(|root| begins_a_path(line, root)) {
                let what = format!("a path of one machine (`{root}...`): make it relative or leave it out");
                findings.push(Finding::at(&file.path, index, what));
            }
        }
    }
    findings
}

/// Whether `root` occurs where a path can begin: not after what would make it the middle of a longer path or address.
fn begins_a_path(line: &str, root: &str) -> bool {
    line.match_indices(root).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || "_-.}".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_root_is_found() {
        for root in ROOTS {
            for line in [format!("{root}x"), format!("a = '{root}x'"), format!("see file://{root}x")] {
                let found = no_machine_paths(&Tree::of(&[("a.txt", &line)]));
                assert_eq!(found.len(), 1, "{line}");
            }
        }
    }

    #[test]
    fn relative_paths_and_addresses_are_free() {
        for root in ROOTS {
            for line in [format!("net{root}x"), format!("https://a.org{root}x"), format!("${{A}}{root}x")] {
                assert!(no_machine_paths(&Tree::of(&[("a.txt", &line)])).is_empty(), "{line}");
            }
        }
    }
}
