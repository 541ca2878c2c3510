//! Samples where limits may be exceeded between samples, until none may be, one is, or bounds are as near as they come.
//!
//! Samples an even distance apart miss the tops of cusps by a part of the height of a strip, and a finer raster everywhere
//! costs much for little. The bounds of [`hidden`](super::hidden()) say which parts of which cells can hold more than a
//! limit: an eighth of a cell wide. Samples in their middles show what is there, and have cells of their own, whose bounds
//! are 64 times as near.

use super::cell::judged;
use super::cut::cut_by;
use super::density::Hidden;
use super::edges::Edges;
use super::hidden::{Doubts, Wanted, doubts};
use super::job::{Cut, Job, JobError, Sample};
use super::sampling::Patch;
use super::tree::Ways;
use osculate_geom::Surface;

/// Rounds at most: cells of the last are 8^3 times as small as the first.
const ROUNDS: u32 = 3;

/// Samples with their cells and what was left at them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The samples.
    pub samples: Vec<Sample>,
    /// The cell of each sample, where it has one.
    pub patches: Vec<Option<Patch>>,
    /// What was left at each.
    pub cuts: Vec<Cut>,
}

/// What [`refine`] came to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Refined {
    /// What may still hide between the samples, those added among them.
    pub hidden: Hidden,
    /// Samples added.
    pub added: usize,
    /// Places that would have needed a sample but for the limit on their number, of those that were found.
    pub left_out: usize,
}

impl Measured {
    /// Puts samples into parts of the cell of sample `k`, which gives them their shares of its area. Parts without a tangent
    /// plane get none.
    fn divide(&mut self, surfaces: &[&dyn Surface], k: usize, parts: impl Iterator<Item = Patch>) {
        let (parent, Some(cell)) = (self.samples[k], self.patches[k]) else { return };
        let surface = surfaces[parent.face as usize];
        for part in parts {
            let on_face = part.raster().filter(|at| surface.contains(*at));
            let found = std::iter::once(part.middle())
                .filter(|at| surface.contains(*at))
                .chain(on_face)
                .find_map(|at| surface.jet2(at).forms().ok().map(|forms| (at, forms)));
            let Some((at, forms)) = found else { continue };
            let area_mm2 = (parent.area_mm2 * part.share_of(&cell)).min(self.samples[k].area_mm2);
            self.samples[k].area_mm2 -= area_mm2;
            let (point, normal) = (surface.point(at), forms.normal);
            self.samples.push(Sample { point, normal, uv: at, area_mm2, ..parent });
            let principal = forms.principal();
            self.patches.push(Some(Patch {
                concave_per_mm: (-principal.k_min).max(0.0),
                convex_per_mm: principal.k_max.max(0.0),
                ..part
            }));
        }
    }
}

/// Adds samples where more than the limits may hide between those there are: heights above `wanted.enough_mm`, gouges deeper
/// than `wanted.gouge_mm`; none once one of them shows that a limit is exceeded. No more than `most` are added. The areas of
/// samples that share their cells with new ones are shared too.
///
/// `surfaces` are the faces by number; the job's own samples are not looked at.
///
/// # Errors
/// [`JobError`] for samples that are not finite.
pub fn refine(
    surfaces: &[&dyn Surface],
    job: &Job<'_>,
    measured: &mut Measured,
    wanted: Wanted,
    most: usize,
) -> Result<Refined, JobError> {
    Ok(refine_beside((surfaces, None), job, measured, wanted, most)?.0)
}

/// As [`refine`], with places beside outer edges told apart. Of each sample, those that were added among them, it comes back whether its
/// cell is settled: nothing in it exceeds what is wanted, but in parts of it that have samples of their own.
pub(super) fn refine_beside(
    (surfaces, edges): (&[&dyn Surface], Option<&Edges<'_>>),
    job: &Job<'_>,
    measured: &mut Measured,
    wanted: Wanted,
    most: usize,
) -> Result<(Refined, Vec<bool>), JobError> {
    let even = measured.samples.len();
    // Samples come and go, motions stay.
    let ways = Ways::of_job(job)?;
    let mut out = Refined { hidden: Hidden { scallop_mm: 0.0, gouge_mm: 0.0 }, added: 0, left_out: 0 };
    // Bounds over all cells that have not been replaced by smaller ones.
    let (mut height, mut depth) = (0.0f64, 0.0f64);
    let mut settled = vec![false; even];
    let mut from = 0;
    for round in 0..=ROUNDS {
        let part = &measured.samples[from..];
        let here = (&measured.patches[from..], &measured.cuts[from..]);
        let room = most.saturating_sub(measured.samples.len() - even);
        let Doubts { height_mm, depth_mm, mut places } =
            doubts(surfaces, (&Job { samples: part, ..*job }, &ways, edges), here, wanted, room + 1)?;
        if places.is_empty() || round == ROUNDS {
            height = height.max(height_mm);
            depth = depth.max(depth_mm);
            // Of more places than there is room for not all were found.
            if places.len() <= room {
                settled[from..].fill(true);
                places.iter().for_each(|p| settled[from + p.0] = false);
            }
            break;
        }
        let all = places.len() <= room;
        if !all {
            out.left_out = places.len() - room;
            places.sort_by(|a, b| b.2.total_cmp(&a.2));
            places.truncate(room);
            places.sort_by_key(|p| p.0);
        }
        let first = measured.samples.len();
        for of_one in places.chunk_by(|a, b| a.0 == b.0) {
            measured.divide(surfaces, from + of_one[0].0, of_one.iter().map(|p| p.1));
        }
        settled[from..].fill(all);
        settled.resize(measured.samples.len(), false);
        let samples = &measured.samples[first..];
        measured.cuts.extend(cut_by(&Job { samples, ..*job }, &ways)?);
        let new = first..measured.samples.len();
        let gouge_mm = wanted.gouge_mm;
        if let Some(edges) = edges {
            edges.measure(&measured.samples[first..], &mut measured.cuts[first..], gouge_mm);
        }
        let exceeds = |c: &Cut| c.standoff_mm > wanted.enough_mm || -c.standoff_mm > gouge_mm;
        if !all || measured.cuts[new].iter().any(exceeds) {
            // There are to be no more of them, or the verdict is known.
            height = height.max(height_mm);
            depth = depth.max(depth_mm);
            break;
        }
        // Cells that keep the limits are not looked at again: all that is known of them is that they do.
        height = height.max(height_mm.min(wanted.enough_mm));
        depth = depth.max(depth_mm.min(gouge_mm));
        from = first;
    }
    out.added = measured.samples.len() - even;
    let (mut seen, mut dug) = (0.0f64, 0.0f64);
    let all = Job { samples: &measured.samples, ..*job };
    for (k, cut) in measured.cuts.iter().enumerate() {
        dug = dug.max(-cut.standoff_mm);
        if judged(&all, &measured.cuts, wanted.uncut_mm, k) {
            seen = seen.max(cut.standoff_mm);
        }
    }
    out.hidden = Hidden { scallop_mm: (height - seen).max(0.0), gouge_mm: (depth - dug).max(0.0) };
    Ok((out, settled))
}
