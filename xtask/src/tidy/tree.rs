//! The files that the checks look at: what git tracks or would track, else what lies in the folder.

use crate::cmd::Failure;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The folders of the library crates, which compute and do nothing else.
pub const LIBRARIES: [&str; 5] = ["geom", "surfaces", "tools", "productivity", "postproc"];

/// The folders of all crates.
pub const CRATES: [&str; 7] = ["geom", "surfaces", "tools", "productivity", "postproc", "cli", "xtask"];

/// One file of the workspace.
#[derive(Clone, Debug)]
pub struct File {
    /// Path relative to the root, with `/` between the parts.
    pub path: String,
    /// Size on disk in bytes.
    pub bytes: u64,
    /// The content where it is UTF-8 text.
    pub text: Option<String>,
}

impl File {
    /// Whether the path ends in `.extension`.
    pub fn is(&self, extension: &str) -> bool {
        Path::new(&self.path).extension().is_some_and(|e| e == extension)
    }

    /// The text, empty for a file that is none.
    pub fn text(&self) -> &str {
        self.text.as_deref().unwrap_or_default()
    }
}

/// All files, in order of their paths.
#[derive(Clone, Debug)]
pub struct Tree {
    /// The files.
    pub files: Vec<File>,
}

impl Tree {
    /// The files of the workspace at `root`. New files that git does not ignore belong to them, so that a finding shows
    /// before the commit and not after it.
    pub fn read(root: &Path) -> Result<Self, Failure> {
        let mut paths = match from_git(root) {
            Some(paths) => paths,
            None => walked(root)?,
        };
        paths.sort();
        paths.dedup();
        let mut files = Vec::new();
        for path in paths {
            let full = root.join(&path);
            // A path that git still knows and that is gone from the folder is on its way out.
            if !full.is_file() {
                continue;
            }
            let content =
                std::fs::read(&full).map_err(|why| Failure::Read { path: PathBuf::from(&path), why })?;
            files.push(File { path, bytes: content.len() as u64, text: String::from_utf8(content).ok() });
        }
        Ok(Self { files })
    }

    /// The file with this path.
    pub fn get(&self, path: &str) -> Option<&File> {
        self.files.iter().find(|f| f.path == path)
    }

    /// Whether there is a file with this path, or a file below a folder with this path.
    pub fn has(&self, path: &str) -> bool {
        let path = path.trim_start_matches("./").trim_end_matches('/');
        self.files
            .iter()
            .any(|f| f.path.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('/')))
    }

    /// The Rust files below `folder`.
    pub fn rust_below(&self, folder: &str) -> impl Iterator<Item = &File> + use<'_> {
        let start = format!("{folder}/");
        self.files.iter().filter(move |f| f.is("rs") && f.path.starts_with(&start))
    }

    /// A tree from paths and texts, for the tests of the checks.
    #[cfg(test)]
    pub fn of(files: &[(&str, &str)]) -> Self {
        let file = |&(path, text): &(&str, &str)| File {
            path: path.to_owned(),
            bytes: text.len() as u64,
            text: Some(text.to_owned()),
        };
        Self { files: files.iter().map(file).collect() }
    }
}

/// The paths that git knows or would add; `None` where there is no git or no repository.
fn from_git(root: &Path) -> Option<Vec<String>> {
    let mut git = Command::new("git");
    git.current_dir(root).args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"]);
    let answer = git.stderr(Stdio::null()).output().ok()?;
    if !answer.status.success() {
        return None;
    }
    let names = String::from_utf8_lossy(&answer.stdout).into_owned();
    Some(names.split('\0').filter(|name| !name.is_empty()).map(str::to_owned).collect())
}

/// Whether the walk leaves a top-level entry out: build and result folders, and what git keeps.
fn is_skipped(top: &str) -> bool {
    top.starts_with("target") || top == "out" || top == ".git"
}

/// The paths of all files below `root`, without build and result folders.
fn walked(root: &Path) -> Result<Vec<String>, Failure> {
    let mut found = Vec::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        let failed = |why| Failure::Read { path: PathBuf::from(&folder), why };
        for entry in std::fs::read_dir(root.join(&folder)).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if folder.is_empty() && is_skipped(&name) {
                continue;
            }
            let path = if folder.is_empty() { name } else { format!("{folder}/{name}") };
            if entry.file_type().map_err(failed)?.is_dir() {
                folders.push(path);
            } else {
                found.push(path);
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walking_finds_what_git_finds() {
        // xtask's own folder, so that nothing else that changes meanwhile matters.
        let folder = crate::cmd::root().unwrap().join("xtask");
        let tracked = from_git(&folder).unwrap_or_default();
        let walked = walked(&folder).unwrap();
        assert!(walked.iter().any(|p| p == "src/tidy/tree.rs"));
        for path in tracked {
            assert!(!folder.join(&path).is_file() || walked.contains(&path), "{path} was not walked");
        }
        assert!(["target", "target-a", "out", ".git"].into_iter().all(is_skipped) && !is_skipped(".ci"));
    }

    #[test]
    fn a_folder_is_there_when_a_file_lies_in_it() {
        let tree = Tree::of(&[("examples/blade/job.toml", "")]);
        assert!(tree.has("examples/blade") && tree.has("./examples/blade/job.toml"));
        assert!(!tree.has("examples/bla") && !tree.has("blade"));
    }
}
