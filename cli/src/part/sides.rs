//! On which side of each face of a part the material is, as file, job and shape of the part say it.

use crate::failure::Failure;
use crate::job::words::MaterialWord;
use crate::job::{Job, Normals};
use crate::part::loaded::Loaded;
use crate::words;
use osculate_geom::{Diagnostic, Side};
use osculate_surfaces::sides::{self, Before, Settled, SideGroup, Sides};
use osculate_surfaces::{Face, TrimmedSurface};
use std::sync::Arc;

/// Rays that speak this clearly against what the job says are told.
const CLEAR_DOUBT: f64 = 0.5;
/// Ids that a message lists at most.
const LISTED: usize = 40;

/// What a job says of sides: a word for all faces to machine, and a word or none for each face.
pub type Told<'a> = (Normals, &'a [Option<MaterialWord>]);

/// Turns the faces of a part to the side that the job, the file, their neighbours or the part as a whole say. `machined` are the
/// ids of the faces that the job works on: what `[part] normals` says, the word, is meant for them first, what `[[part.side]]` says for
/// the faces that it names, and both settle what hangs together with them. The numbers of the faces for which nothing says a side
/// come back.
pub(super) fn settle((word, said): Told<'_>, part: &mut Loaded, machined: &[String]) -> Vec<usize> {
    let said = |k: usize| said.get(k).copied().flatten();
    for k in 0..part.faces.len() {
        match said(k) {
            Some(MaterialWord::Above) => flip(part, k),
            None if word == Normals::Reversed => flip(part, k),
            _ => {}
        }
    }
    let open: Vec<bool> = (0..part.faces.len()).map(|k| unsaid(part, k)).collect();
    if !open.contains(&true) {
        return Vec::new();
    }
    let told = |k: usize| said(k).is_some() || word != Normals::Auto && machined.contains(&part.faces[k].id);
    let known: Vec<Option<Side>> =
        (0..part.faces.len()).map(|k| (!open[k] || told(k)).then_some(Side::Along)).collect();
    let doubted: Vec<bool> = (0..part.faces.len()).map(|k| open[k] && told(k)).collect();
    let shapes: Option<Vec<Face>> =
        part.faces.iter().map(|f| shape(f.source.as_deref(), &f.surface)).collect();
    let Some(shapes) = shapes else { return Vec::new() };
    let solids = part.structure.solids(part.faces.iter().map(|f| f.id.as_str()));
    let before = Before { sides: &known, solids: &solids, uncertainty_mm: part.uncertainty_mm };
    let found = sides::settle(&shapes.iter().collect::<Vec<_>>(), &before);
    let mut left = Vec::new();
    for (k, (of, known)) in found.of.iter().zip(&known).enumerate() {
        match of {
            Some(Side::Against) if known.is_none() => flip(part, k),
            None => left.push(k),
            Some(_) => {}
        }
    }
    tell(part, &found, &known);
    doubt(part, &found, &doubted);
    if left.is_empty() {
        return left;
    }
    let ids = listed(part, &left);
    if word == Normals::Auto {
        part.diagnostics.push(Diagnostic::note(
            ids,
            "nothing says on which side of these faces the material is: they hang together with no face whose side is known, and \
             the part does not enclose anything there; they are left out; [[part.side]] says it for each, [part] normals for all faces to machine",
        ));
        return left;
    }
    let text = "nothing but [part] normals says on which side of these faces the material is: they are taken as it has them";
    part.diagnostics.push(Diagnostic::note(ids, text));
    Vec::new()
}

/// Whether the file leaves the side of a face open.
fn unsaid(part: &Loaded, k: usize) -> bool {
    part.faces[k].source.as_ref().is_some_and(|f| !f.oriented)
}

/// What `[[part.side]]` says of each face.
///
/// # Errors
/// Where it names a face that is not there, or one of which the file says the side.
pub(super) fn said(job: &Job, part: &Loaded) -> Result<Vec<Option<MaterialWord>>, Failure> {
    let mut all = vec![None; part.faces.len()];
    for (id, side) in job.part().sides() {
        let wrong = |what: String| Failure::file(job.path(), format!("[[part.side]] {what}"));
        let Some(k) = part.faces.iter().position(|f| f.id == *id) else {
            return Err(wrong(part.face(id).err().map_or_else(String::new, |e| e.message().to_owned())));
        };
        if !unsaid(part, k) {
            let what = format!(
                "names {id}, of which the file says the side: take it out, or turn all faces over by normals = \"reversed\""
            );
            return Err(wrong(what));
        }
        all[k] = Some(*side);
    }
    Ok(all)
}

/// A face as it is now turned.
fn shape(source: Option<&Face>, surface: &Arc<TrimmedSurface>) -> Option<Face> {
    source.map(|f| Face { surface: surface.clone(), ..f.clone() })
}

fn flip(part: &mut Loaded, k: usize) {
    let face = &mut part.faces[k];
    face.surface = Arc::new(TrimmedSurface::clone(&face.surface).flipped());
}

/// Ids of faces as a message names them.
fn listed(part: &Loaded, faces: &[usize]) -> String {
    let ids: Vec<&str> = faces.iter().map(|k| part.faces[*k].id.as_str()).collect();
    words::listed(&ids, LISTED)
}

/// A note for each group of which a face was settled, and one for neighbours that do not fit.
fn tell(part: &mut Loaded, found: &Sides, known: &[Option<Side>]) {
    let mut notes = Vec::new();
    for group in found.groups.iter().filter(|g| g.settled != Settled::Open) {
        let settled: Vec<usize> = group.faces.iter().copied().filter(|k| known[*k].is_none()).collect();
        if settled.is_empty() {
            continue;
        }
        let what = match settled.len() {
            1 => "the file does not say where the material of this face is".to_owned(),
            n => format!("the file does not say where the material of these {n} faces is"),
        };
        let turned = settled.iter().filter(|k| found.of[**k] == Some(Side::Against)).count();
        let how = match group.settled {
            Settled::Known => {
                let by: Vec<usize> = group.faces.iter().copied().filter(|k| known[*k].is_some()).collect();
                let whose = if by.len() == 1 { "that of" } else { "those of" };
                format!(
                    "it is on the same side as {whose} {}, with which they hang together",
                    listed(part, &by)
                )
            }
            Settled::Enclosed => {
                let certainty = 100.0 * group.certainty;
                format!("it is on the side that the part encloses (certainty {certainty:.0} %)")
            }
            Settled::Closed | Settled::Open => "it is on the side around which they close".to_owned(),
        };
        notes.push(Diagnostic::note(listed(part, &settled), format!("{what}; {how}; {turned} turned over")));
    }
    if !found.conflicts.is_empty() {
        let pairs = found.conflicts.iter().rev().take(LISTED);
        let pairs: Vec<String> = pairs.map(|c| listed(part, &c.faces).replace(", ", " and ")).collect();
        notes.push(Diagnostic::note(
            pairs.join("; "),
            "these neighbours do not say the same of the side of the material: longer edges with others count instead",
        ));
    }
    part.diagnostics.extend(notes);
}

/// Warns of faces that the job has machined from the side on which the part has its material: a blade from within. Only
/// where the file itself says no side, as a job may well turn over what a file says.
fn doubt(part: &mut Loaded, found: &Sides, told: &[bool]) {
    let mut warnings = Vec::new();
    for group in &found.groups {
        let from_within = |g: &SideGroup, s: Side| g.certainty * s.sign() <= -CLEAR_DOUBT;
        let of = group.faces.iter().zip(&group.sides).filter(|(k, _)| told[**k]);
        let (within, others): (Vec<_>, Vec<_>) = of.partition(|(_, s)| from_within(group, **s));
        let within: Vec<usize> = within.into_iter().map(|(k, _)| *k).collect();
        if !within.is_empty() {
            warnings.push(Diagnostic::warning(
                listed(part, &within),
                format!(
                    "the tool is on the side that the part encloses (certainty {:.0} %), as the job has it: the \
                     part would be cut from within; leave out what it says, or turn it over",
                    100.0 * group.certainty.abs()
                ),
            ));
        }
        // Without a clear vote the neighbours still say which of them do not go together.
        let apart: Vec<usize> =
            others.into_iter().map(|(k, _)| *k).filter(|k| group.otherwise.contains(k)).collect();
        if !apart.is_empty() && group.certainty.abs() < CLEAR_DOUBT {
            warnings.push(Diagnostic::warning(
                listed(part, &apart),
                "the job has the tool on the other side of these faces than of the faces next to them; the sides of those \
                 count for the rest of the part",
            ));
        }
    }
    part.diagnostics.extend(warnings);
}
