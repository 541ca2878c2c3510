//! Workflows of GitHub: few rights, actions of a known major version, nothing secret, and only packages that there are.

use super::finding::Finding;
use super::tree::{File, Tree};

/// The workflows that there must be.
const NEEDED: [&str; 2] = [".github/workflows/ci.yml", ".github/workflows/release.yml"];

/// Each of [`NEEDED`] is there; every workflow may read alone where a job does not ask for more, uses actions by their major version and no secrets.
pub fn workflows(tree: &Tree) -> Vec<Finding> {
    let missing = NEEDED.iter().filter(|path| tree.get(path).is_none());
    let mut findings: Vec<Finding> = missing.map(|path| Finding::whole(*path, "missing")).collect();
    for file in tree.files.iter().filter(|f| f.path.starts_with(".github/workflows/")) {
        if !file.text().contains("\npermissions:\n  contents: read\n") {
            findings.push(Finding::whole(&file.path, "no `permissions:` with `contents: read` for all jobs"));
        }
        for (index, line) in file.text().lines().enumerate() {
            findings.extend(wrong(tree, line).map(|what| Finding::at(&file.path, index, what)));
        }
    }
    findings
}

/// What is wrong with a line.
fn wrong(tree: &Tree, line: &str) -> Option<String> {
    if line.contains('\t') {
        return Some("a tab, which YAML forbids before a key".to_owned());
    }
    if line.contains("secrets.") {
        return Some("a secret: `github.token` is all that is there".to_owned());
    }
    let action = line.trim_start().trim_start_matches("- ").strip_prefix("uses: ");
    let version = action.map(|a| a.rsplit_once("@v").map_or("", |(_, version)| version));
    if version.is_some_and(|v| v.is_empty() || !v.bytes().all(|b| b.is_ascii_digit())) {
        return Some("an action without its major version: write `name@v1`".to_owned());
    }
    let words: Vec<&str> = line.split_whitespace().collect();
    let named = words.windows(2).filter(|w| line.contains("cargo ") && matches!(w[0], "-p" | "--exclude"));
    let known = |name: &str| {
        let says = format!("name = \"{name}\"");
        let has = |f: &File| f.path.ends_with("Cargo.toml") && f.text().lines().any(|l| l == says);
        tree.files.iter().any(has)
    };
    let unknown = named.map(|w| w[1]).find(|name| !known(name))?;
    Some(format!("there is no package {unknown}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_too_much_or_changes_by_itself_is_found() {
        let good = "on: push\npermissions:\n  contents: read\njobs:\n  a:\n    steps:\n      - uses: a/b@v3\n      - run: cargo build -p c\n";
        let found = |text: &str| {
            let manifest = ("c/Cargo.toml", "[package]\nname = \"c\"\n");
            workflows(&Tree::of(&[manifest, (NEEDED[0], text), (NEEDED[1], good)])).len()
        };
        assert_eq!(found(good), 0);
        for (old, new) in [
            ("read", "write"),
            ("@v3", "@main"),
            ("@v3", ""),
            ("@v3", "@v3.1"),
            ("-p c", "-p d"),
            ("-p c", "${{ secrets.KEY }}"),
            ("    steps", "\tsteps"),
        ] {
            assert_eq!(found(&good.replace(old, new)), 1, "{new}");
        }
        assert_eq!(workflows(&Tree::of(&[])).len(), 2);
    }
}
