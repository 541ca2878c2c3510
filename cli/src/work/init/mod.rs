//! A first job for a part: which faces, from where, with which tools and how exactly, each with its reason.
//!
//! Faces are grouped by how they look and hang together. The groups that are formed come first, with all that are like them; of the
//! tools of a library the largest ball is taken that reaches them, from as few axes as reach nearly all of it. Each axis is an
//! operation of its own, in which the tool keeps that axis, and all are done in one setup. What no ball of the library reaches, beside sharp
//! inner edges, is an area that the job accepts and names. The job says for every choice why it is made, and can be planned as it is.

mod asked;
mod fit;
mod target;
mod text;

use crate::failure::Failure;
use crate::job::Normals;
use crate::part::{self, LoadedFace};
use crate::work::faces_page;
pub use asked::{Grouped, Wanted, name, relative};
use fit::Fit;
use osculate_geom::{Diagnostic, Surface};

use target::Target;

/// Targets that are tried, largest first, before it is said that none can be reached.
const MOST_TRIES: usize = 6;
/// Points a side of a sheet for the way in which it bends.
const GRID: usize = 24;

/// A first job.
#[non_exhaustive]
pub struct First {
    /// Its text.
    pub text: String,
    /// A page that shows the part's faces with their ids.
    pub page: String,
    /// What was chosen, in sentences.
    pub told: Vec<String>,
    /// Ids of the faces to machine.
    pub faces: Vec<String>,
    /// What was found on reading the part.
    pub diagnostics: Vec<Diagnostic>,
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
    let mut read = part::whole(part::open(wanted.part)?)?;
    read.to_plan(wanted.part)?;
    let doubts = part::doubts(&read);
    read.diagnostics.extend(doubts);
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
    let title =
        wanted.part.file_stem().map_or_else(|| "part".to_owned(), |n| n.to_string_lossy().into_owned());
    let page = faces_page::page(grouped, &title);
    First { text, page, told, faces, diagnostics: grouped.part.diagnostics.clone() }
}
