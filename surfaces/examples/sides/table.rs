//! The sides of all parts of a collection as a table, found without what the files say of them, and held against what knows nothing of
//! the search: the sides that files of solids say, the volume that another kernel computed, and rays through triangles.

use crate::parity::inside;
use crate::{Turned, before, behind, leak, solids, turned};
use osculate_geom::{Box3, Point3, Side};
use osculate_surfaces::sides::{Settled, SideGroup, settle};
use osculate_surfaces::{Face, Part, tessellate};
use rayon::prelude::*;
use std::path::Path;

/// Chord of the triangles, and how far behind a face a place is looked at, as parts of the part's size.
const CHORD: f64 = 5e-4;
const BEHIND: f64 = 1e-4;
/// What normals times areas do not cancel of faces that close is below this part of their area.
const CLOSES: f64 = 1e-3;
/// Places of a face, at its largest triangles.
const PLACES: usize = 3;
/// Kinds of files.
const KINDS: [&str; 2] = ["step", "iges"];

/// A line for every file with faces.
pub fn print(data: &Path) -> Result<(), String> {
    println!(
        "| file | faces | said | right | wrong | off | open | settled by | volume mm3 | reference mm3 | leak | inside | outside | unclear |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for kind in KINDS {
        let folder = data.join("files").join(kind);
        let read = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut files: Vec<_> = read.filter_map(Result::ok).map(|e| e.path()).collect();
        files.sort();
        for path in files {
            let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
            let Some(part) = std::fs::read(&path).ok().and_then(|b| osculate_surfaces::read(&b).ok()) else {
                continue;
            };
            if part.faces.is_empty() {
                continue;
            }
            let reference = reference(&data.join("truth").join(format!("{kind}__{name}.json")));
            println!("| `{name}` {}", row(&part, reference));
        }
    }
    Ok(())
}

/// The volume that the other kernel gives.
fn reference(file: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(file).ok()?;
    serde_json::from_str::<serde_json::Value>(&text).ok()?.get("volume")?.as_f64()
}

fn row(part: &Part, reference: Option<f64>) -> String {
    let Turned { faces, truth } = turned(part);
    let all: Vec<&Face> = faces.iter().collect();
    let solids = solids(part);
    let found = settle(&all, &before(part, &solids));
    let [mut right, mut wrong, mut off, mut open] = [0; 4];
    for group in &found.groups {
        let no_body = said_of_no_body(part, &faces, group);
        for k in &group.faces {
            match found.of[*k] {
                None => open += 1,
                Some(s) if part.faces[*k].oriented && s == truth[*k] => right += 1,
                Some(_) if part.faces[*k].oriented => *(if no_body { &mut off } else { &mut wrong }) += 1,
                Some(_) => {}
            }
        }
    }
    let said = part.faces.iter().filter(|f| f.oriented).count();
    let by = |s: Settled| found.groups.iter().filter(|g| g.settled == s).count();
    let settled =
        [("rays", by(Settled::Enclosed)), ("volume", by(Settled::Closed)), ("nothing", by(Settled::Open))];
    let settled: Vec<String> = settled.iter().filter(|s| s.1 > 0).map(|(w, n)| format!("{w} {n}")).collect();
    let from = part.bbox().centre();
    let known: Vec<f64> =
        faces.iter().zip(&found.of).filter_map(|(f, s)| Some(behind(f, (*s)?, from))).collect();
    let area: f64 = faces.iter().map(Face::area_mm2).sum();
    let leak = leak(&faces, &found.of) / area;
    let [inside, outside, unclear] = parity(&faces, &found.of, part.bbox().diagonal_mm());
    let shown = |volume: Option<f64>| volume.map_or_else(|| "-".to_owned(), |v| format!("{v:.6e}"));
    let volume = shown((!known.is_empty()).then(|| known.iter().sum()));
    let reference = shown(reference);
    format!(
        "| {} | {said} | {right} | {wrong} | {off} | {open} | {} | {volume} | {reference} | {leak:.0e} | {inside} | {outside} | {unclear} |",
        faces.len(),
        settled.join(", ")
    )
}

/// Whether the sides that the file says of a group are those of no body: inside out, or turned against each other so that they leak
/// more than twice as much as the sides found.
fn said_of_no_body(part: &Part, faces: &[Face], group: &SideGroup) -> bool {
    let pick = |all: &[Face]| group.faces.iter().map(|k| all[*k].clone()).collect::<Vec<Face>>();
    let (own, turned) = (pick(&part.faces), pick(faces));
    let from = own.iter().fold(Box3::empty(), |b, f| b.union(&f.bbox())).centre();
    let volume: f64 = own.iter().map(|f| behind(f, Side::Along, from)).sum();
    let along = vec![Some(Side::Along); own.len()];
    let found: Vec<Option<Side>> = group.sides.iter().copied().map(Some).collect();
    let area: f64 = own.iter().map(Face::area_mm2).sum();
    volume < 0.0 && leak(&own, &along) < CLOSES * area
        || leak(&own, &along) > 2.0 * leak(&turned, &found) + CLOSES * area
}

/// Faces with a side behind which most places lie inside, outside, and of which rays say nothing.
fn parity(faces: &[Face], sides: &[Option<Side>], size_mm: f64) -> [usize; 3] {
    let meshes: Vec<_> = faces.par_iter().map(|f| tessellate(&f.surface, CHORD * size_mm, None)).collect();
    let of = |m: &osculate_surfaces::Mesh| -> Vec<[Point3; 3]> {
        m.triangles.iter().map(|t| t.map(|k| Point3::from(m.positions[k as usize]))).collect()
    };
    let own: Vec<Vec<[Point3; 3]>> = meshes.iter().map(of).collect();
    let soup: Vec<[Point3; 3]> = own.iter().flatten().copied().collect();
    let votes: Vec<i32> = own
        .par_iter()
        .zip(sides)
        .filter_map(|(triangles, side)| {
            let sign = (*side)?.sign();
            let mut large: Vec<_> =
                triangles.iter().map(|t| (t, (t[1] - t[0]).cross(&(t[2] - t[0])))).collect();
            large.sort_by(|a, b| b.1.norm().total_cmp(&a.1.norm()));
            let votes = large.iter().take(PLACES).filter_map(|(t, n)| {
                let middle = t[0] + ((t[1] - t[0]) + (t[2] - t[0])) / 3.0;
                let at = middle - n.try_normalize(0.0)? * (sign * BEHIND * size_mm);
                inside(at, &soup).map(|inside| if inside { 1 } else { -1 })
            });
            Some(votes.sum())
        })
        .collect();
    let count = |sign: i32| votes.iter().filter(|v| v.signum() == sign).count();
    [count(1), count(-1), count(0)]
}
