//! What a first job is made for, and the part with its groups of faces.

use crate::job::Normals;
use crate::job::library::Library;
use crate::part::{self, Loaded};
use osculate_postproc::Machine;
use osculate_surfaces::groups::{FaceGroup, groups};
use osculate_surfaces::sides::{Meeting, meetings};
use std::path::{Path, PathBuf};

/// What a first job is made for.
pub struct Wanted<'a> {
    /// The part's file.
    pub part: &'a Path,
    /// The job's file, which names the part relative to itself.
    pub job: &'a Path,
    /// Ids of faces, or of groups; the program chooses where there are none.
    pub faces: &'a [String],
    /// Name of a machine, or a machine file.
    pub machine: &'a str,
    /// The same as a machine.
    pub on: &'a Machine,
    /// The tools to choose from, and the library's name.
    pub tools: (&'a Library, &'a str),
}

/// A part with its groups.
#[non_exhaustive]
pub struct Grouped {
    /// The part, its faces turned to the side of their material.
    pub part: Loaded,
    /// Faces of which nothing says a side.
    pub open: Vec<String>,
    /// How faces meet.
    pub meetings: Vec<Meeting>,
    /// The groups, largest first.
    pub groups: Vec<FaceGroup>,
}

impl Grouped {
    /// Settles the sides of a part's faces and groups them. The word is what is said of normals.
    #[must_use]
    pub fn of(mut part: Loaded, normals: Normals) -> Self {
        let all: Vec<String> = part.faces.iter().map(|f| f.id.clone()).collect();
        let open = part::settle(&mut part, (normals, &[]), &all);
        let shapes = part.shapes();
        let shapes: Vec<_> = shapes.iter().collect();
        let meetings = meetings(&shapes, part.uncertainty_mm);
        let groups = if shapes.len() == part.faces.len() { groups(&shapes, &meetings) } else { Vec::new() };
        Self { part, open, meetings, groups }
    }

    /// Ids of the faces of a group.
    #[must_use]
    pub fn ids(&self, group: usize) -> Vec<&str> {
        self.groups[group].faces.iter().map(|f| self.part.faces[*f].id.as_str()).collect()
    }
}

/// The name of a group by its place.
#[must_use]
pub fn name(group: usize) -> String {
    format!("G{}", group + 1)
}

/// A path as a file in the folder of `from` names it; as it stands where there is no way from one to the other.
#[must_use]
pub fn relative(to: &Path, from: &Path) -> PathBuf {
    let folder = from.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let (Ok(to), Ok(folder)) = (std::path::absolute(to), std::path::absolute(folder)) else {
        return to.to_path_buf();
    };
    let same = to.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    // Nothing in common but the root, or another drive.
    if same < 2 {
        return to;
    }
    let up = folder.components().skip(same).map(|_| "..");
    up.map(Path::new).chain(to.components().skip(same).map(|c| Path::new(c.as_os_str()))).collect()
}
