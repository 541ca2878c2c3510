//! Data in the repository: not too large, and with a notice where others made it.

use super::finding::Finding;
use super::tree::{File, Tree};

/// The largest size of a file that needs no reason, bytes. A clone of the repository stays a matter of seconds.
const LARGEST: u64 = 3_000_000;

/// Larger files, each with the reason.
const LARGE_FILES: [(&str, &str); 0] = [];

/// No file above [`LARGEST`] that is not listed.
pub fn no_large_files(tree: &Tree) -> Vec<Finding> {
    let listed = |file: &File| LARGE_FILES.iter().any(|(path, _)| *path == file.path);
    let large = tree.files.iter().filter(|f| f.bytes > LARGEST && !listed(f));
    large.map(|f| Finding::whole(&f.path, format!("{} bytes, at most {LARGEST} are kept", f.bytes))).collect()
}

/// Formats in which parts and meshes come from elsewhere.
const PART_FORMATS: [&str; 6] = ["step", "stp", "igs", "iges", "stl", "obj"];

/// Every folder with a part file has, there or above, a `NOTICE.md` that names the part file.
pub fn foreign_data_has_a_notice(tree: &Tree) -> Vec<Finding> {
    let parts = tree.files.iter().filter(|f| PART_FORMATS.iter().any(|e| f.is(e)));
    let unnamed = parts.filter(|part| {
        let name = part.path.rsplit('/').next().unwrap_or(&part.path);
        !notices_above(tree, &part.path).any(|notice| notice.text().contains(name))
    });
    let what =
        "no NOTICE.md beside or above it names this file: say where it is from and under which licence";
    unnamed.map(|part| Finding::whole(&part.path, what)).collect()
}

/// The notices in the folder of `path` and in the folders above it.
fn notices_above<'a>(tree: &'a Tree, path: &'a str) -> impl Iterator<Item = &'a File> {
    path.match_indices('/').filter_map(|(at, _)| tree.get(&format!("{}/NOTICE.md", &path[..at])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_file_is_found() {
        let mut tree = Tree::of(&[("a.bin", ""), ("b.bin", "")]);
        tree.files[0].bytes = LARGEST;
        tree.files[1].bytes = LARGEST + 1;
        let found = no_large_files(&tree);
        assert_eq!((found.len(), found[0].place.as_str()), (1, "b.bin"));
    }

    #[test]
    fn a_part_without_a_notice_is_found() {
        let found = |files: &[(&str, &str)]| foreign_data_has_a_notice(&Tree::of(files)).len();
        let part = ("examples/a/blade.igs", "");
        assert_eq!(found(&[part]), 1);
        assert_eq!(found(&[part, ("examples/a/NOTICE.md", "# hull.step")]), 1);
        assert_eq!(found(&[part, ("examples/a/NOTICE.md", "# blade.igs")]), 0);
        assert_eq!(found(&[part, ("examples/NOTICE.md", "# blade.igs")]), 0);
        assert_eq!(found(&[part, ("examples/b/NOTICE.md", "# blade.igs")]), 1);
        assert_eq!(found(&[("examples/a/job.toml", "")]), 0);
    }
}
