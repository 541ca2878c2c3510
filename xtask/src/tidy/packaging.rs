//! What every crate and every release needs: a documented root, licences, a changelog of this version.

use super::finding::Finding;
use super::tree::CRATES;
use super::tree::Tree;

/// Fewest words of a crate's documentation: less than a sentence tells nobody what the crate is for.
const FEWEST_WORDS: usize = 6;

/// Every crate has a `src/lib.rs` or `src/main.rs` with documentation, and follows the workspace's lints.
pub fn crate_roots(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for folder in CRATES {
        let roots = ["lib.rs", "main.rs"].map(|name| tree.get(&format!("{folder}/src/{name}")));
        let mut roots = roots.into_iter().flatten().peekable();
        if roots.peek().is_none() {
            findings.push(Finding::whole(folder, "neither src/lib.rs nor src/main.rs"));
        }
        for root in roots {
            let docs = root.text().lines().map_while(|line| line.strip_prefix("//!"));
            if docs.flat_map(str::split_whitespace).count() < FEWEST_WORDS {
                findings.push(Finding::whole(&root.path, "no documentation of the crate worth the name"));
            }
        }
        let manifest = format!("{folder}/Cargo.toml");
        if tree.get(&manifest).and_then(|m| key(m.text(), "[lints]", "workspace")) != Some("true") {
            findings.push(Finding::whole(manifest, "no `workspace = true` under `[lints]`"));
        }
    }
    findings
}

/// The licence texts are there, and CHANGELOG.md has a section for the version of the workspace.
pub fn release_files(tree: &Tree) -> Vec<Finding> {
    let needed =
        ["LICENSE-MIT", "LICENSE-APACHE", "README.md", "ARCHITECTURE.md", "NOTATION.md", "Cargo.lock"];
    let missing = needed.iter().filter(|path| tree.get(path).is_none());
    let mut findings: Vec<Finding> = missing.map(|path| Finding::whole(*path, "missing")).collect();
    let manifest = tree.get("Cargo.toml").map(|f| f.text()).unwrap_or_default();
    match (key(manifest, "[workspace.package]", "version"), tree.get("CHANGELOG.md")) {
        (None, _) => findings.push(Finding::whole("Cargo.toml", "no version under `[workspace.package]`")),
        (_, None) => findings.push(Finding::whole("CHANGELOG.md", "missing")),
        (Some(version), Some(changelog)) => {
            let is_section = |line: &str| {
                let title = line.strip_prefix("## ").and_then(|l| l.split_whitespace().next());
                title.is_some_and(|t| t.trim_matches(['[', ']']) == version)
            };
            if !changelog.text().lines().any(is_section) {
                findings.push(Finding::whole("CHANGELOG.md", format!("no section `## {version}`")));
            }
        }
    }
    findings
}

/// The package that is for the workspace alone.
const OWN: &str = "xtask";

/// Every package that is published has licence texts equal to those at the root, a README, and says what a registry shows of it; it leaves out its
/// tests of the repository. The workspace's own package is not published.
pub fn published(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for folder in CRATES {
        let path = format!("{folder}/Cargo.toml");
        let manifest = tree.get(&path).map(|f| f.text()).unwrap_or_default();
        let of = |name| key(manifest, "[package]", name);
        if folder == OWN {
            if of("publish") != Some("false") {
                findings.push(Finding::whole(&path, "no `publish = false`"));
            }
            continue;
        }
        for name in ["description", "keywords", "categories", "readme"] {
            if of(name).is_none_or(str::is_empty) {
                findings.push(Finding::whole(&path, format!("no {name} under `[package]`")));
            }
        }
        let left_out = of("exclude").is_some_and(|list| list.contains("\"/tests/repository\""));
        if tree.has(&format!("{folder}/tests/repository")) && !left_out {
            findings.push(Finding::whole(&path, "`exclude` does not name \"/tests/repository\""));
        }
        if tree.get(&format!("{folder}/README.md")).is_none() {
            findings.push(Finding::whole(format!("{folder}/README.md"), "missing"));
        }
        for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let copy = format!("{folder}/{name}");
            if tree.get(&copy).map(|f| f.text()) != tree.get(name).map(|f| f.text()) {
                findings.push(Finding::whole(copy, "missing, or not the text at the root"));
            }
        }
    }
    findings
}

/// The value of `key = value` in a table of a TOML text as cargo writes it, without quotes.
fn key<'a>(toml: &'a str, table: &str, key: &str) -> Option<&'a str> {
    let mut lines = toml.lines().skip_while(|line| line.trim() != table).skip(1);
    let in_table = |line: &&str| !line.starts_with('[');
    lines.by_ref().take_while(in_table).find_map(|line| {
        let (name, value) = line.split_once('=')?;
        (name.trim() == key).then(|| value.trim().trim_matches('"'))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: &str = "//! Cutters, contact poses and what they leave.\n";
    const MANIFEST: &str = "[package]\nname = \"a\"\n\n[lints]\nworkspace = true\n";

    /// All crates in order, but `folder` with the given root and manifest.
    fn crates(folder: &str, root: &str, manifest: &str) -> usize {
        let named = CRATES.map(|f| (f, format!("{f}/src/lib.rs"), format!("{f}/Cargo.toml")));
        let mut files = Vec::new();
        for (f, r, m) in &named {
            let changed = *f == folder;
            files.push((r.as_str(), if changed { root } else { ROOT }));
            files.push((m.as_str(), if changed { manifest } else { MANIFEST }));
        }
        crate_roots(&Tree::of(&files)).len()
    }

    #[test]
    fn crates_without_documentation_or_lints_are_found() {
        assert_eq!(crates("tools", ROOT, MANIFEST), 0);
        assert_eq!(crates("tools", "//! Cutters\n", MANIFEST), 1);
        assert_eq!(crates("tools", "pub mod a;\n", MANIFEST), 1);
        assert_eq!(crates("tools", ROOT, "[lints]\n[workspace]\nworkspace = true\n"), 1);
        assert_eq!(crate_roots(&Tree::of(&[])).len(), 2 * CRATES.len());
    }

    #[test]
    fn packages_that_a_registry_would_show_badly_are_found() {
        let good = "[package]\ndescription = \"a\"\nkeywords = [\"a\"]\ncategories = [\"a\"]\n\
                    readme = \"README.md\"\nexclude = [\"/tests/repository\"]\n";
        // Everything is in order but for one file.
        let found = |changed: &str, text: Option<&str>| {
            let mut files = vec![("LICENSE-MIT".to_owned(), "mit"), ("LICENSE-APACHE".to_owned(), "apache")];
            for folder in CRATES {
                let manifest = if folder == OWN { "[package]\npublish = false\n" } else { good };
                files.extend([
                    (format!("{folder}/Cargo.toml"), manifest),
                    (format!("{folder}/README.md"), "a"),
                ]);
                files.extend([
                    (format!("{folder}/LICENSE-MIT"), "mit"),
                    (format!("{folder}/LICENSE-APACHE"), "apache"),
                ]);
            }
            files.push(("tools/tests/repository/main.rs".to_owned(), ""));
            files.retain(|(path, _)| path != changed);
            files.extend(text.map(|text| (changed.to_owned(), text)));
            let files: Vec<(&str, &str)> = files.iter().map(|(path, text)| (path.as_str(), *text)).collect();
            published(&Tree::of(&files)).len()
        };
        assert_eq!(found("a", None), 0);
        assert_eq!(found("tools/README.md", None), 1);
        assert_eq!([found("geom/LICENSE-MIT", None), found("geom/LICENSE-MIT", Some("other"))], [1, 1]);
        assert_eq!(found("tools/Cargo.toml", Some(&good.replace("[\"/tests/repository\"]", "[]"))), 1);
        assert_eq!(found("geom/Cargo.toml", Some(&good.replace("description", "words"))), 1);
        assert_eq!(found("xtask/Cargo.toml", Some("[package]\n")), 1);
    }

    #[test]
    fn missing_licences_and_versions_are_found() {
        let manifest = ("Cargo.toml", "[workspace.package]\nversion = \"1.2.0\"\n");
        let rest =
            ["LICENSE-MIT", "LICENSE-APACHE", "README.md", "ARCHITECTURE.md", "NOTATION.md", "Cargo.lock"];
        let found = |changelog: &str, without: &str| {
            let mut files = vec![manifest, ("CHANGELOG.md", changelog)];
            files.extend(rest.iter().filter(|p| **p != without).map(|p| (*p, "")));
            release_files(&Tree::of(&files)).iter().map(|f| f.place.clone()).collect::<Vec<_>>()
        };
        assert!(found("# Changes\n\n## 1.2.0 (2031-01-01)\n", "").is_empty());
        assert!(found("## [1.2.0] - 2031-01-01\n", "").is_empty());
        assert_eq!(found("## 1.2.0\n", "LICENSE-MIT"), ["LICENSE-MIT"]);
        for wrong in ["", "## 1.2.00\n", "1.2.0\n", "## 1.1.0: before 1.2.0\n"] {
            assert_eq!(found(wrong, ""), ["CHANGELOG.md"], "{wrong:?}");
        }
        assert_eq!(release_files(&Tree::of(&[])).len(), rest.len() + 1);
    }
}
