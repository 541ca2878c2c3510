//! A first job for a part: which faces, from where, with which tools and how exactly, each with its reason.
//!
//! Faces are grouped by how they look and hang together. The groups that are formed come first, with all that are like them; of the
//! tools of a library the largest ball is taken that reaches them, from as few axes as reach nearly all of it. Each axis is an
//! operation of its own, in which the tool keeps that axis, and all are done in one setup. What no ball of the library reaches, beside sharp
//! inner edges, is an area that the job accepts and names. The job says for every choice why it is made, and can be planned as it is.

mod fit;
mod target;
mod text;

use crate::failure::Failure;
use crate::job::Normals;
use crate::job::library::Library;
use crate::part::{self, Loaded, LoadedFace};
use fit::Fit;
use osculate_geom::{Diagnostic, Surface};
use osculate_postproc::Machine;
use osculate_surfaces::Face;
use osculate_surfaces::groups::{FaceGroup, groups};
use osculate_surfaces::sides::{Meeting, meetings};
use std::path::{Path, PathBuf};
use target::Target;

/// Targets that are tried, largest first, before it is said that none can be reached.
const MOST_TRIES: usize = 6;
/// Points a side of a sheet for the way in which it bends.
const GRID: usize = 24;

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

/// A first job.
pub struct First {
    /// Its text.
    pub text: String,
    /// What was chosen, in sentences.
    pub told: Vec<String>,
    /// Ids of the faces to machine.
    pub faces: Vec<String>,
    /// What was found on reading the part.
    pub diagnostics: Vec<Diagnostic>,
}

/// The faces of a part with the sides that they have now.
fn shapes(part: &Loaded) -> Vec<Face> {
    let shape = |f: &LoadedFace| {
        f.source.as_deref().map(|source| Face { surface: f.surface.clone(), ..source.clone() })
    };
    part.faces.iter().filter_map(shape).collect()
}

impl Grouped {
    /// Settles the sides of a part's faces and groups them. The word is what is said of normals.
    #[must_use]
    pub fn of(mut part: Loaded, normals: Normals) -> Self {
        let all: Vec<String> = part.faces.iter().map(|f| f.id.clone()).collect();
        let open = part::settle(&mut part, (normals, &[]), &all);
        let shapes = shapes(&part);
        let shapes: Vec<&Face> = shapes.iter().collect();
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

/// On which side of an open sheet the material is taken to be: the one towards which it bends, as a skin lies on what it covers. The face is
/// as the file has it.
fn bent(face: &LoadedFace) -> Normals {
    let mut sum = 0.0;
    for (at, ..) in part::grid(&*face.surface, GRID) {
        let jet = face.surface.jet2(at);
        if let Ok(forms) = jet.forms() {
            let k = forms.principal();
            // A cap on what is degenerate at an edge or a pole.
            let size_mm = face.surface.bbox(1).diagonal_mm();
            let mean = 0.5 * (k.k_min + k.k_max) * size_mm;
            sum += mean.clamp(-1.0, 1.0) * jet.du.cross(&jet.dv).norm();
        }
    }
    if sum < 0.0 { Normals::Reversed } else { Normals::File }
}

/// Reads the part and makes a first job for it.
///
/// # Errors
/// Where the part has no faces, faces are named that it has not, or no tool of the library reaches what is to be machined, with the reason
/// of each that was tried.
pub fn init(wanted: &Wanted<'_>) -> Result<First, Failure> {
    let refuse = |what: String| Failure::file(wanted.part, what);
    let read = part::whole(part::open(wanted.part)?)?;
    if read.faces.is_empty() {
        return Err(refuse("has no faces to machine (inspect says what it has)".to_owned()));
    }
    let mut grouped = Grouped::of(read.clone(), Normals::Auto);
    let mut normals = Normals::Auto;
    // Nothing says where the material is: what a sheet bends towards is taken for it, for one face alone.
    let open = target::open_face(&grouped, wanted.faces).map_err(&refuse)?;
    if let Some(id) = &open {
        normals = bent(read.face(id)?);
        grouped = Grouped::of(read, normals);
    }
    let all = match &open {
        Some(id) => vec![Target::face(&grouped, id)?],
        None => target::targets(&grouped, wanted.faces).map_err(&refuse)?,
    };
    let mut tried: Vec<String> = Vec::new();
    for mut target in all.into_iter().take(MOST_TRIES) {
        let found = loop {
            let found = fit::fit(&grouped, &target, wanted)?;
            match found {
                // What no axis reaches is left out, and the rest asked for again.
                Ok(fit) if !fit.missed.is_empty() => target = target.without(&grouped, &fit.missed),
                other => break other,
            }
        };
        match found {
            Ok(fit) => return Ok(first(wanted, (&grouped, normals), &target, &fit, &tried)),
            Err(why) => tried.push(format!("{}: {why}", target.words)),
        }
    }
    Err(refuse(format!("no first job can be made of it: {}", tried.join("; "))))
}

fn first(
    wanted: &Wanted<'_>,
    (grouped, normals): (&Grouped, Normals),
    target: &Target,
    fit: &Fit,
    tried: &[String],
) -> First {
    let told = text::told(grouped, target, fit, tried);
    let faces = target.faces.iter().map(|f| grouped.part.faces[*f].id.clone()).collect();
    let text = text::job(wanted, (grouped, normals), target, fit);
    First { text, told, faces, diagnostics: grouped.part.diagnostics.clone() }
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
