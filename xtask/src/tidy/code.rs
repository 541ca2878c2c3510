//! What crates execute: their sources without comments, literals and tests.

use super::source::{code_only, without_tests};
use super::tree::LIBRARIES;
use super::tree::{File, Tree};

/// The sources of the libraries with comments, literals and tests blanked.
pub fn library_code(tree: &Tree) -> Vec<(&File, String)> {
    code_of(tree, &LIBRARIES)
}

/// The sources of the crates in these folders with comments, literals and tests blanked. Files that hold a test module
/// are left out.
pub fn code_of<'a>(tree: &'a Tree, folders: &[&str]) -> Vec<(&'a File, String)> {
    let sources = folders.iter().flat_map(|folder| tree.rust_below(&format!("{folder}/src")));
    let mut kept = Vec::new();
    let mut test_modules = Vec::new();
    for file in sources {
        let (code, modules) = without_tests(&code_only(file.text()));
        let folder = module_folder(&file.path);
        test_modules.extend(modules.into_iter().map(|name| format!("{folder}/{name}")));
        kept.push((file, code));
    }
    let is_test = |path: &str| {
        test_modules
            .iter()
            .any(|m| path.strip_prefix(m.as_str()).is_some_and(|rest| rest == ".rs" || rest.starts_with('/')))
    };
    kept.retain(|(file, _)| !is_test(&file.path));
    kept
}

/// The folder in which the modules of a source file lie.
fn module_folder(path: &str) -> &str {
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    match name {
        "mod.rs" | "lib.rs" | "main.rs" => folder,
        _ => path.strip_suffix(".rs").unwrap_or(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_module_in_its_own_file_is_left_out() {
        let tree = Tree::of(&[
            ("geom/src/a/mod.rs", "#[cfg(test)]\nmod tests;"),
            ("geom/src/a/tests.rs", "println!()"),
            ("geom/src/b.rs", "#[cfg(test)]\nmod checks;"),
            ("geom/src/b/checks/deep.rs", "println!()"),
            ("geom/src/tests.rs", "println!()"),
        ]);
        let kept: Vec<&str> = library_code(&tree).iter().map(|(file, _)| file.path.as_str()).collect();
        assert_eq!(kept, ["geom/src/a/mod.rs", "geom/src/b.rs", "geom/src/tests.rs"]);
    }
}
