//! Which faces a first job machines.

use super::asked::{Grouped, name};
use crate::failure::Failure;
use crate::words;
use osculate_surfaces::groups::Look;

/// Ids that a sentence lists at most.
const LISTED: usize = 12;

/// Faces to machine.
#[non_exhaustive]
pub struct Target {
    /// Their numbers, ascending.
    pub faces: Vec<usize>,
    /// What they are, in words.
    pub words: String,
    /// The smallest radius inwards, mm.
    pub hollow_mm: f64,
    /// Their area, mm2.
    pub area_mm2: f64,
    /// Why these, in words.
    pub why: String,
}

/// Ids as a sentence lists them.
pub fn listed(ids: &[&str]) -> String {
    words::listed(ids, LISTED)
}

impl Target {
    fn of_groups(grouped: &Grouped, of: &[usize], why: String) -> Self {
        let groups = || of.iter().map(|g| &grouped.groups[*g]);
        let mut faces: Vec<usize> = groups().flat_map(|g| g.faces.iter().copied()).collect();
        faces.sort_unstable();
        let names: Vec<String> = of.iter().map(|g| name(*g)).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let ids: Vec<&str> = faces.iter().map(|f| grouped.part.faces[*f].id.as_str()).collect();
        let look = grouped.groups[of[0]].look;
        Self {
            words: format!("{} ({look}: {})", listed(&names), listed(&ids)),
            hollow_mm: groups().map(|g| g.hollow_mm).fold(f64::INFINITY, f64::min),
            area_mm2: groups().map(|g| g.area_mm2).sum(),
            faces,
            why,
        }
    }

    fn of_faces(grouped: &Grouped, faces: Vec<usize>, why: String) -> Self {
        let within = |g: &&osculate_surfaces::groups::FaceGroup| g.faces.iter().any(|f| faces.contains(f));
        let hollow_mm =
            grouped.groups.iter().filter(within).map(|g| g.hollow_mm).fold(f64::INFINITY, f64::min);
        let of: Vec<_> = faces.iter().map(|f| &grouped.part.faces[*f]).collect();
        let ids: Vec<&str> = of.iter().map(|f| f.id.as_str()).collect();
        let area_mm2 = of.iter().map(|f| crate::part::area(f)).sum();
        Self { words: listed(&ids), hollow_mm, area_mm2, faces, why }
    }

    /// The same without some of its faces, by their places in it; there are others.
    #[must_use]
    pub fn without(&self, grouped: &Grouped, missed: &[usize]) -> Self {
        let id = |k: &usize| grouped.part.faces[self.faces[*k]].id.as_str();
        let gone: Vec<&str> = missed.iter().map(id).collect();
        let left = (0..self.faces.len()).filter(|k| !missed.contains(k)).map(|k| self.faces[k]).collect();
        let why = format!("{}; without {}, which no tool reaches from those axes", self.why, listed(&gone));
        Self::of_faces(grouped, left, why)
    }

    /// A single face of a sheet.
    ///
    /// # Errors
    /// Where there is none of this id.
    pub fn face(grouped: &Grouped, id: &str) -> Result<Self, Failure> {
        let k = number(grouped, id).map_err(Failure::job)?;
        let why = "a single face: it hangs together with none whose side is known".to_owned();
        Ok(Self::of_faces(grouped, vec![k], why))
    }
}

/// The number of a face by its id.
fn number(grouped: &Grouped, id: &str) -> Result<usize, String> {
    grouped.part.faces.iter().position(|f| f.id == id).ok_or_else(|| {
        let ids = grouped.part.faces.iter().map(|f| f.id.as_str());
        let near =
            crate::job::words::nearest(id, ids).map_or_else(String::new, |n| format!(" (is {n} meant?)"));
        format!(
            "has no face {id}{near}: its faces are F1 to F{}, its groups G1 to G{} (inspect lists the faces)",
            grouped.part.faces.len(),
            grouped.groups.len()
        )
    })
}

/// The faces and groups that are named, as numbers of faces.
fn named(grouped: &Grouped, words: &[String]) -> Result<Vec<usize>, String> {
    let mut out = Vec::new();
    for word in words {
        let group = (0..grouped.groups.len()).find(|g| name(*g) == *word);
        match group {
            Some(g) => out.extend(grouped.groups[g].faces.iter().copied()),
            None if word == "all" => out.extend(0..grouped.part.faces.len()),
            None => out.push(number(grouped, word)?),
        }
    }
    out.sort_unstable();
    out.dedup();
    Ok(out)
}

/// The face that is machined where nothing says on which side its material is: the named one, or the largest. None where sides are known.
///
/// # Errors
/// Where several such faces are named: one word cannot turn all of them.
pub fn open_face(grouped: &Grouped, words: &[String]) -> Result<Option<String>, String> {
    let is_open = |f: &usize| grouped.open.contains(&grouped.part.faces[*f].id);
    let asked = named(grouped, words)?;
    let id = |f: usize| grouped.part.faces[f].id.clone();
    if let [one] = asked[..] {
        return Ok(is_open(&one).then(|| id(one)));
    }
    if let Some(f) = asked.iter().find(|f| is_open(f)) {
        return Err(format!(
            "nothing says on which side of {} the material is: name one such face by itself, or write the job by hand with [part] normals",
            id(*f)
        ));
    }
    if !asked.is_empty() || grouped.open.len() < grouped.part.faces.len() {
        return Ok(None);
    }
    let largest =
        grouped.part.faces.iter().max_by(|a, b| crate::part::area(a).total_cmp(&crate::part::area(b)));
    Ok(largest.map(|f| f.id.clone()))
}

/// What may be machined, the best first: what is named, or groups with all that are like them.
///
/// # Errors
/// Where a name is that of no face and no group.
pub fn targets(grouped: &Grouped, words: &[String]) -> Result<Vec<Target>, String> {
    let asked = named(grouped, words)?;
    if !asked.is_empty() {
        return Ok(vec![Target::of_faces(grouped, asked, "as asked for".to_owned())]);
    }
    let open = |g: usize| grouped.ids(g).iter().any(|id| grouped.open.iter().any(|o| o == id));
    let mut order: Vec<usize> = (0..grouped.groups.len()).filter(|g| !open(*g)).collect();
    // Holes are drilled and bored; a fillet comes with what it rounds.
    let rank = |g: &usize| match grouped.groups[*g].look {
        Look::Formed => 0,
        Look::Round | Look::Flat => 1,
        Look::Fillet => 2,
        Look::Hole => 3,
    };
    order.sort_by_key(rank);
    let mut taken = vec![false; grouped.groups.len()];
    let mut out = Vec::new();
    for g in order {
        if taken[g] {
            continue;
        }
        let of = &grouped.groups[g];
        let like = |h: &usize| {
            let other = &grouped.groups[*h];
            other.look == of.look
                && other.alike == of.alike
                && other.faces.len() == of.faces.len()
                && (other.area_mm2 - of.area_mm2).abs() <= 0.01 * of.area_mm2
        };
        let all: Vec<usize> = if of.alike > 1 {
            (0..grouped.groups.len()).filter(|h| !open(*h)).filter(like).collect()
        } else {
            vec![g]
        };
        all.iter().for_each(|h| taken[*h] = true);
        let why = match (of.look, all.len()) {
            (Look::Formed, 1) => "the largest formed group of faces".to_owned(),
            (Look::Formed, n) => format!("the {n} largest formed groups of faces, which are alike"),
            (look, _) => {
                format!("the largest group of faces; it is {look}, and no formed one can be reached")
            }
        };
        out.push(Target::of_groups(grouped, &all, why));
    }
    Ok(out)
}
