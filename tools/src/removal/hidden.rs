//! What can hide between samples, cell by cell.
//!
//! Over the cell of a sample take the lines along the sample's normal n. Seen along n, the lower side of one straight
//! motion's swept body is a convex function F of the place x across, and what stands above the part is F(x) - z(x), z
//! being the part's own height along n. On a convex part -z is convex too; on a concave one of curvature k it lies above
//! its chords by at most `k r^2 / 2`, r half the diagonal of the cell. A convex function is greatest at the corners of the
//! cell. The true height is the least over all motions, so that any one of them gives a bound, and so does any mixture of
//! two: at a cusp one of them rises where the other falls, and their mean is level:
//!
//! `height <= min over motions i, j of max over corners c of (h_i(c) + h_j(c)) / 2 + k r^2 / 2`.
//!
//! At a cusp this is above the truth by a term in r^2 only, where one motion alone has one in r. The motions tried are the
//! one that cut the sample, those that cut the samples around, and the lowest of all that come near the cell. Cells whose
//! bound is above what the samples have shown are divided, parts that lie outside the trims left aside, up to
//! [`DIVISIONS`] times.
//!
//! *Normals that turn.* The normal at another place of the cell deviates from n by an angle within `a = k r`, k the greatest
//! normal curvature. A point s up that normal stands `s cos a` up along n and `s sin a` aside, where the part is higher by
//! at most `s sin a tan a`: with the bound taken over a cell that is wider by `s sin a` all around, s is at most the bound
//! times `cos a / cos 2a`. Wider cells are stretched from their middle, which leaves the part by less than `s a^2`; all three
//! are of second order and within `1 / (1 - 3 a^2)`. The whole therefore closes in with the square of the spacing. It holds
//! to leading order in the curvature's change over a cell and in the sagitta of turning motions.
//!
//! *Gouges* are looked for in [`digs`](super::digs).

use super::cell::{Cell, Level, Near, World, judged};
use super::cluster::clusters;
use super::density::Hidden;
use super::digs::{DIVISIONS, Depth, Digs};
use super::edges::Edges;
use super::job::{Cut, Job, JobError};
use super::sampling::Patch;
use super::target::Target;
use super::tree::Ways;
use osculate_geom::Surface;
use rayon::prelude::*;
use std::collections::HashSet;

/// Cells that are divided before the highest bound is looked at again.
const TOGETHER: usize = 256;
/// Depth that is asked for at least, mm: a path that is to dig in nowhere touches the part.
const LEAST_DEPTH: f64 = 1e-6;

/// What is asked of the bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Samples that stand higher have not been cut.
    pub uncut_mm: f64,
    /// Bounds on the height that are no higher need not be sharper, such as the tolerance; 0 for the sharpest.
    pub enough_mm: f64,
    /// Bounds on the depth of gouges, of what holder and rapids do to the part, and of what anything does to faces that are only
    /// checked, need not be sharper than this, such as their tolerance.
    pub gouge_mm: f64,
}

/// Bounds on what may hide between samples on the faces of a job, in the order of the samples.
///
/// `surfaces` are the faces by number, `patches` the cells of the job's samples; samples without a cell (on a trim) have
/// none of their own and are left aside. Those that nothing cut and those above what counts as uncut are left aside where heights
/// are asked for. A gouge may be as deep as the job follows it where one deeper than [`Wanted::gouge_mm`] cannot be ruled out.
///
/// # Errors
/// [`JobError`] for samples that are not finite, and for a [`Wanted::gouge_mm`] that is negative or not finite.
pub fn hidden(
    surfaces: &[&dyn Surface],
    job: &Job<'_>,
    (patches, cuts): (&[Option<Patch>], &[Cut]),
    wanted: Wanted,
) -> Result<Hidden, JobError> {
    let ways = Ways::of_job(job)?;
    let world = World::new((job, &ways), None, cuts, wanted.uncut_mm);
    let seen = world.seen;
    let cells = world.cells(surfaces, (patches, cuts), wanted)?;
    let highest = highest(&cells, seen, wanted.enough_mm, 0, &mut Vec::new());
    let depths = world.digs(wanted.gouge_mm)?.depths(surfaces, (patches, cuts))?;
    let dug = cuts.iter().map(|c| -c.standoff_mm).fold(0.0, f64::max);
    let deepest = depths.iter().map(|d| d.most_mm).fold(dug, f64::max);
    Ok(Hidden { scallop_mm: highest - seen, gouge_mm: deepest - dug })
}

/// What nothing in the cells stands above: at least what was seen, and no sharper than `enough_mm`. Parts of cells whose bounds are
/// above `enough_mm` are put into `places`, up to `room` and a little more, with their share of it.
fn highest(cells: &[Bounded<'_>], seen: f64, enough_mm: f64, room: usize, places: &mut Vec<Place>) -> f64 {
    // The highest first: what they come to need not be undercut by the others.
    let mut order: Vec<&Bounded<'_>> = cells.iter().collect();
    order.sort_by(|a, b| b.height_mm.total_cmp(&a.height_mm));
    let mut highest = seen;
    for group in order.chunks(TOGETHER) {
        let collects = places.len() < room;
        let enough = if collects { enough_mm } else { highest.max(enough_mm) };
        let first = group[0].height_mm;
        if first <= enough {
            return highest.max(first);
        }
        let bounds: Vec<(f64, Vec<_>)> = group
            .par_iter()
            .map(|c| {
                let mut parts = Vec::new();
                let height = c.cell.bound(enough, DIVISIONS, &mut parts);
                (height, parts.into_iter().map(|(part, bound)| (c.sample, part, bound / enough_mm)).collect())
            })
            .collect();
        for (height, parts) in bounds {
            highest = highest.max(height);
            if collects {
                places.extend::<Vec<_>>(parts);
            }
        }
    }
    highest
}

/// A sample, a part of its cell that may hold more than a limit, and the bound over that limit.
pub(super) type Place = (usize, Patch, f64);

/// Bounds over the cells of samples, and where these are above limits.
pub(super) struct Doubts {
    /// What nothing in the cells stands above, mm, or [`Wanted::enough_mm`] where that is higher.
    pub height_mm: f64,
    /// What no gouge in the cells is deeper than, mm.
    pub depth_mm: f64,
    /// Parts of cells that may hold more than the limits.
    pub places: Vec<Place>,
}

/// Where gouges deeper than [`Wanted::gouge_mm`] or heights above [`Wanted::enough_mm`] may hide: of the latter a little more than
/// `room` at most, those with the highest bounds.
pub(super) fn doubts(
    surfaces: &[&dyn Surface],
    (job, ways, edges): (&Job<'_>, &Ways, Option<&Edges<'_>>),
    (patches, cuts): (&[Option<Patch>], &[Cut]),
    wanted: Wanted,
    room: usize,
) -> Result<Doubts, JobError> {
    let world = World::new((job, ways), edges, cuts, wanted.uncut_mm);
    let cells = world.cells(surfaces, (patches, cuts), wanted)?;
    let mut places = Vec::new();
    let height_mm = highest(&cells, world.seen, wanted.enough_mm, room, &mut places);
    let depths = world.digs(wanted.gouge_mm)?.depths(surfaces, (patches, cuts))?;
    let depth_mm = depths.iter().map(|d| d.most_mm).fold(0.0, f64::max);
    // Where both may hide there is one sample for both.
    let key = |k: usize, p: &Patch| (k, p.u.map(f64::to_bits), p.v.map(f64::to_bits));
    let known: HashSet<_> = places.iter().map(|p| key(p.0, &p.1)).collect();
    for Depth { sample, most_mm, parts } in depths {
        let share = most_mm / wanted.gouge_mm;
        let new = parts.into_iter().filter(|part| !known.contains(&key(sample, part)));
        places.extend(new.map(|part| (sample, part, share)));
    }
    // In the order of the samples, the parts of one together.
    places.sort_by_key(|p| p.0);
    Ok(Doubts { height_mm, depth_mm, places })
}

/// Of samples those in whose cells something higher than [`Wanted::enough_mm`] may hide.
pub(super) fn doubtful(
    surfaces: &[&dyn Surface],
    (job, ways): (&Job<'_>, &Ways),
    (patches, cuts): (&[Option<Patch>], &[Cut]),
    wanted: Wanted,
) -> Result<Vec<usize>, JobError> {
    let world = World::new((job, ways), None, cuts, wanted.uncut_mm);
    let cells = world.cells(surfaces, (patches, cuts), wanted)?;
    let is_high = |c: &&Bounded<'_>| {
        c.height_mm > wanted.enough_mm
            && c.cell.bound(wanted.enough_mm, DIVISIONS, &mut Vec::new()) > wanted.enough_mm
    };
    Ok(cells.par_iter().filter(is_high).map(|c| c.sample).collect())
}

/// A cell that is not divided, with its bounds.
struct Bounded<'a> {
    cell: Cell<'a>,
    sample: usize,
    /// What nothing in it stands above, mm.
    height_mm: f64,
}

/// Samples around a cell whose motions are tried first.
const BESIDE: usize = 10;

impl<'a> World<'a> {
    /// What looks for gouges deeper than this.
    fn digs(&'a self, depth_mm: f64) -> Result<Digs<'a>, JobError> {
        if !(depth_mm >= 0.0 && depth_mm.is_finite()) {
            return Err(JobError::Depth { got: depth_mm });
        }
        let (job, ways, edges) = (self.job, self.ways, self.edges);
        Ok(Digs { job, ways, depth_mm: depth_mm.max(LEAST_DEPTH), edges })
    }

    /// The cells of the samples that are judged.
    fn cells(
        &'a self,
        surfaces: &[&'a dyn Surface],
        (patches, cuts): (&[Option<Patch>], &[Cut]),
        wanted: Wanted,
    ) -> Result<Vec<Bounded<'a>>, JobError> {
        let cell = |k: usize, members: &[u32]| -> Option<(usize, Cell<'a>)> {
            let patch = patches[k].filter(|_| judged(self.job, cuts, wanted.uncut_mm, k))?;
            let surface = surfaces[self.job.samples[k].face as usize];
            let own = cuts[k].by.map_or(0, |by| by.motion);
            Some((
                k,
                Cell {
                    surface,
                    world: self,
                    patch,
                    own,
                    beside: self.beside(k, members, cuts),
                    around: None,
                },
            ))
        };
        let of = |members: &[u32]| {
            self.bounded(members.iter().filter_map(|k| cell(*k as usize, members)).collect())
        };
        let groups = clusters(self.job.samples)?;
        Ok(groups.par_iter().flat_map_iter(|group| of(&group.members)).collect())
    }

    /// Cells next to each other with their bounds. What comes near those for which the motions that cut the samples around do not do is
    /// looked for once.
    fn bounded(&'a self, cells: Vec<(usize, Cell<'a>)>) -> Vec<Bounded<'a>> {
        let (mut bounded, mut open) = (Vec::with_capacity(cells.len()), Vec::new());
        for (sample, cell) in cells {
            // Without a tangent plane in its middle nothing is said of a cell.
            let mut height_mm = self.seen;
            if let Some(mut level) = Level::new(&cell, &cell.patch) {
                let holds = cell.try_known(&mut level, self.seen);
                height_mm = level.best;
                if !holds {
                    open.push((bounded.len(), level.target(self.job.stock_mm), level));
                }
            }
            bounded.push(Bounded { cell, sample, height_mm });
        }
        let Some((first, ..)) = open.first() else { return bounded };
        let normal = self.job.samples[bounded[*first].sample].normal;
        let whole = Target::around(open.iter().flat_map(|(_, target, _)| target.corners()), &normal);
        let near = Near::of(self, &whole);
        for (k, target, mut level) in open {
            let Bounded { cell, height_mm, .. } = &mut bounded[k];
            cell.around = Some(near.least(cell, &level, &target));
            cell.try_around(&mut level, self.seen);
            *height_mm = level.best;
        }
        bounded
    }

    /// The motions that cut the samples nearest to sample `k` among `members`: at a cusp they are the other side.
    fn beside(&self, k: usize, members: &[u32], cuts: &[Cut]) -> Vec<u32> {
        let here = self.job.samples[k].point;
        // Kept sorted by distance; few enough that insertion is quickest.
        let mut nearest: Vec<(f64, u32)> = Vec::with_capacity(BESIDE + 1);
        for m in members {
            let Some(by) = cuts[*m as usize].by else { continue };
            let away = (self.job.samples[*m as usize].point - here).norm_squared();
            if nearest.len() < BESIDE || nearest.last().is_some_and(|l| away < l.0) {
                nearest.insert(nearest.partition_point(|n| n.0 <= away), (away, by.motion));
                nearest.truncate(BESIDE);
            }
        }
        let mut motions: Vec<u32> = Vec::with_capacity(BESIDE);
        for (_, motion) in nearest {
            if !motions.contains(&motion) {
                motions.push(motion);
            }
        }
        motions
    }
}
