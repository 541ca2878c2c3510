//! Documents name what exists: files, folders, and the commands of README.md, which can be typed as they stand.

use super::finding::Finding;
use super::tree::CRATES;
use super::tree::{File, Tree};

/// The folder of the examples; a path below it in README.md must exist wherever it stands.
const EXAMPLES: &str = "examples/";

/// Every job file named after `plan ` in a code block of README.md exists, so does every path below `examples/` in it,
/// and there is at least one `plan` command.
pub fn readme_commands(tree: &Tree) -> Vec<Finding> {
    let Some(readme) = tree.get("README.md") else {
        return vec![Finding::whole("README.md", "missing")];
    };
    let (mut findings, mut in_block, mut plans) = (Vec::new(), false, 0);
    for (index, line) in readme.text().lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
            continue;
        }
        let job = job_of(line).filter(|_| in_block);
        plans += usize::from(job.is_some());
        for path in job.into_iter().chain(example_paths(line)) {
            if !tree.has(path) {
                findings.push(Finding::at("README.md", index, format!("{path} does not exist")));
            }
        }
    }
    if plans == 0 {
        findings.push(Finding::whole("README.md", "no code block shows `osculate plan JOB.toml`"));
    }
    findings.dedup();
    findings
}

/// The word after `plan` where it names a file.
fn job_of(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace().skip_while(|w| *w != "plan").skip(1);
    words.next().filter(|w| w.contains('.') || w.contains('/'))
}

/// The paths below the examples folder that the line names.
fn example_paths(line: &str) -> impl Iterator<Item = &str> {
    let words = line.split(|c: char| !(c.is_alphanumeric() || "_-./".contains(c)));
    words.map(|w| w.trim_end_matches('.')).filter(|w| w.starts_with(EXAMPLES))
}

/// Every relative link in a Markdown file, and in those at the root every file or folder of a crate in code font, leads
/// somewhere.
pub fn named_files(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in tree.files.iter().filter(|f| f.is("md")) {
        let folder = file.path.rsplit_once('/').map_or("", |(folder, _)| folder);
        for (index, line) in file.text().lines().enumerate() {
            let links = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
            let links = links.map(|link| link.split('#').next().unwrap_or(link));
            let links = links.filter(|link| !link.is_empty() && !link.contains(':'));
            let mut gone: Vec<&str> = links.filter(|link| !tree.has(&joined(folder, link))).collect();
            gone.extend(crate_paths(file, line).filter(|path| !tree.has(path)));
            let what = |path: &str| format!("{path} does not exist");
            findings.extend(gone.into_iter().map(|path| Finding::at(&file.path, index, what(path))));
        }
    }
    findings
}

/// The paths in code font that begin with a crate's folder, in a document at the root.
fn crate_paths<'a>(file: &File, line: &'a str) -> impl Iterator<Item = &'a str> {
    let at_root = !file.path.contains('/');
    let spans = line.split('`').skip(1).step_by(2).filter(move |_| at_root);
    let is_path = |span: &&str| span.chars().all(|c| c.is_alphanumeric() || "_-./".contains(c));
    spans.filter(is_path).filter(|span| {
        let top = span.split_once('/').map(|(top, _)| top);
        top.is_some_and(|top| CRATES.contains(&top) || top == ".ci" || top == "examples")
    })
}

/// The path of a link from a file in `folder`, with `..` resolved.
fn joined(folder: &str, link: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in link.split('/').filter(|part| !part.is_empty() && *part != ".") {
        if part == ".." {
            parts.pop();
        } else {
            parts.push(part);
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(readme: &str) -> Vec<String> {
        let tree = Tree::of(&[("README.md", readme), ("examples/blade/job.toml", "")]);
        readme_commands(&tree).iter().map(|f| f.to_string()).collect()
    }

    #[test]
    fn a_command_on_a_file_that_is_gone_is_found() {
        assert!(found("```sh\nosculate plan examples/blade/job.toml --out out\n```\n").is_empty());
        assert_eq!(
            found("```\nosculate plan jobs/hull.toml --out out\n```\n"),
            ["README.md:2: jobs/hull.toml does not exist"]
        );
        let prose = "See [the hull](examples/hull/).\n```\nosculate plan examples/blade/job.toml\n```\n";
        assert_eq!(found(prose), ["README.md:1: examples/hull/ does not exist"]);
    }

    #[test]
    fn a_readme_without_the_main_command_is_found() {
        let missing = ["README.md: no code block shows `osculate plan JOB.toml`"];
        assert_eq!(found(""), missing);
        assert_eq!(found("We plan a.b for later.\n"), missing);
        assert_eq!(readme_commands(&Tree::of(&[])).len(), 1);
    }

    #[test]
    fn names_of_files_that_are_gone_are_found() {
        let found = |path: &str, text: &str| {
            let tree = Tree::of(&[(path, text), ("geom/src/lib.rs", ""), ("geom/NOTES.md", "")]);
            named_files(&tree).len()
        };
        for good in
            ["`geom/src/lib.rs`", "[a](geom/NOTES.md#b)", "[a](https://b.org/c)", "[a](#b)", "`n/a` `geom`"]
        {
            assert_eq!(found("CONTRIBUTING.md", good), 0, "{good}");
        }
        for bad in ["`geom/src/gone.rs`", "[a](geom/gone.md)", "`geom/srclib` b", "see [a](./x)"] {
            assert_eq!(found("CONTRIBUTING.md", bad), 1, "{bad}");
        }
        assert_eq!(found("geom/src/A.md", "[a](../NOTES.md) [b](../../geom/src/lib.rs) [c](NOTES.md)"), 1);
        assert_eq!(found("geom/A.md", "`geom/src/gone.rs`"), 0);
    }
}
