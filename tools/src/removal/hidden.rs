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

use super::body::Body;
use super::cluster::clusters;
use super::deepest::Passage;
use super::density::Hidden;
use super::digs::{DIVISIONS, Depth, Digs};
use super::edges::Edges;
use super::job::{Cut, Job, JobError};
use super::piece::{Approach, Passes, Piece};
use super::sampling::Patch;
use super::target::Target;
use super::tree::{Ways, Which};
use crate::cutter::Line;
use osculate_geom::{Point3, Surface, Unit3, uv};
use rayon::prelude::*;
use std::collections::HashSet;

/// Motions around a cell that are tried.
const MOST_MOTIONS: usize = 8;
/// Bounds are expected within this multiple of the highest standoff seen.
const MOST_SEEN: f64 = 3.0;
/// Cells that are divided before the highest bound is looked at again.
const TOGETHER: usize = 256;
/// Height at which a motion counts as met, mm: bounds are above the truth by more.
const MET: f64 = 1e-9;
/// Depth that is asked for at least, mm: a path that is to dig in nowhere touches the part.
const LEAST_DEPTH: f64 = 1e-6;
/// Accuracy of the instant, of the motion: an instant that is off gives a bound that is higher.
const INSTANT: f64 = 1e-7;

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

/// A cell that is not divided, with its bounds.
struct Bounded<'a> {
    cell: Cell<'a>,
    sample: usize,
    /// What nothing in it stands above, mm.
    height_mm: f64,
}

/// Whether a sample is judged by the height that was left: one that something cut, of a machined face.
pub(super) fn judged(job: &Job<'_>, cuts: &[Cut], uncut_mm: f64, k: usize) -> bool {
    !job.samples[k].check_only && cuts[k].by.is_some() && cuts[k].standoff_mm <= uncut_mm
}

struct World<'a> {
    job: &'a Job<'a>,
    bodies: Vec<Body<'a>>,
    ways: &'a Ways,
    edges: Option<&'a Edges<'a>>,
    /// The highest standoff at a sample: bounds below need not be sharper.
    seen: f64,
}

/// Samples around a cell whose motions are tried first.
const BESIDE: usize = 10;

impl<'a> World<'a> {
    fn new(
        (job, ways): (&'a Job<'a>, &'a Ways),
        edges: Option<&'a Edges<'a>>,
        cuts: &[Cut],
        uncut_mm: f64,
    ) -> Self {
        let judged = (0..cuts.len()).filter(|k| judged(job, cuts, uncut_mm, *k));
        let seen = judged.map(|k| cuts[k].standoff_mm).fold(0.0, f64::max);
        World { job, bodies: Body::all(job), ways, edges, seen }
    }

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
        let groups = clusters(self.job.samples)?;
        let cell = |k: usize, members: &[u32]| -> Option<Bounded<'a>> {
            let patch = patches[k].filter(|_| judged(self.job, cuts, wanted.uncut_mm, k))?;
            let surface = surfaces[self.job.samples[k].face as usize];
            let own = cuts[k].by.map_or(0, |by| by.motion);
            let cell = Cell { surface, world: self, patch, own, beside: self.beside(k, members, cuts) };
            let height_mm = cell.bound(self.seen, 0, &mut Vec::new());
            Some(Bounded { cell, sample: k, height_mm })
        };
        let of =
            |members: &[u32]| members.iter().filter_map(|k| cell(*k as usize, members)).collect::<Vec<_>>();
        Ok(groups.par_iter().flat_map_iter(|group| of(&group.members)).collect())
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

/// The corners of a cell that is wider by `margin` on every side, stretched from its middle; at most twice as wide.
fn stretched(corners: [Point3; 4], middle: Point3, margin: f64) -> [Point3; 4] {
    let side = |k: usize| {
        let (a, b) = (corners[k] - middle, corners[(k + 1) % 4] - middle);
        let along = b - a;
        // From the middle to the line through the side, or to the corner where the side is none.
        along.try_normalize(0.0).map_or(a.norm(), |e| (a - e * a.dot(&e)).norm())
    };
    let inner = (0..4).map(side).fold(f64::INFINITY, f64::min);
    let by = if inner > 0.0 { (margin / inner).min(1.0) } else { 1.0 };
    corners.map(|p| p + (p - middle) * by)
}

/// The cell of one sample.
struct Cell<'a> {
    surface: &'a dyn Surface,
    world: &'a World<'a>,
    patch: Patch,
    /// The motion that cut the sample.
    own: u32,
    /// Motions that cut the samples around.
    beside: Vec<u32>,
}

/// What the motions tried so far leave above one patch.
struct Level {
    points: [Point3; 4],
    middle: Point3,
    normal: Unit3,
    /// Corners of the patch that is wider by what turning normals need.
    wide: [Point3; 4],
    slack: f64,
    /// Above this the allowance is of first order.
    most: f64,
    first: f64,
    second: f64,
    /// The least bound, and the motions whose mean it is.
    best: f64,
    pair: [u32; 2],
    tried: Vec<(u32, [f64; 4])>,
}

impl Level {
    /// Nothing tried yet; none where the patch has no tangent plane in its middle.
    fn new(cell: &Cell<'_>, patch: &Patch) -> Option<Self> {
        let [[u0, u1], [v0, v1]] = [patch.u, patch.v];
        let jet = cell.surface.jet2(patch.middle());
        let points = [uv(u0, v0), uv(u1, v0), uv(u1, v1), uv(u0, v1)].map(|c| cell.surface.point(c));
        let radius = points.iter().map(|p| (p - jet.point).norm()).fold(0.0, f64::max);
        let normal = jet.normal().ok()?;
        let bend = patch.concave_per_mm.max(patch.convex_per_mm) * radius;
        // Nothing stands higher than the stock, and what does stand higher than this gets the allowance of first order.
        let most = (MOST_SEEN * cell.world.seen).min(cell.world.job.stock_mm);
        let wide = stretched(points, jet.point, most * bend);
        let radius_wide = wide.iter().map(|p| (p - jet.point).norm()).fold(0.0, f64::max);
        Some(Self {
            points,
            middle: jet.point,
            normal,
            wide,
            slack: 0.5 * patch.concave_per_mm * radius_wide * radius_wide,
            most,
            first: 1.0 / (1.0 - bend.min(0.5)),
            second: 1.0 / (1.0 - (3.0 * bend * bend).min(0.5)),
            best: f64::INFINITY,
            pair: [cell.own; 2],
            tried: Vec::new(),
        })
    }

    /// Bound from heights at the corners, no higher at any of them.
    fn upper(&self, heights: [f64; 4]) -> f64 {
        let top = heights.into_iter().fold(f64::NEG_INFINITY, f64::max) + self.slack;
        let bound = top * self.second;
        if bound <= self.most { bound } else { bound.max(top * self.first) }
    }

    /// The bound with one motion more, alone and in the mean with those before.
    fn with(&mut self, cell: &Cell<'_>, motion: u32) -> f64 {
        let other: [f64; 4] = std::array::from_fn(|c| {
            // From here on no mean with a motion tried before is lower than the best.
            let lowest = self.tried.iter().map(|(_, h)| h[c]).fold(f64::INFINITY, f64::min);
            let useful = if lowest < self.best { 2.0 * self.best - lowest } else { f64::INFINITY };
            cell.height(motion, self.wide[c], self.normal, useful).unwrap_or(f64::INFINITY)
        });
        self.tried.push((motion, other));
        for (one, heights) in &self.tried {
            let bound = self.upper(std::array::from_fn(|c| 0.5 * (heights[c] + other[c])));
            if bound < self.best {
                (self.best, self.pair) = (bound, [*one, motion]);
            }
        }
        self.best
    }

    /// Motions for a part of the patch: those of the bound, and the two that leave least at each corner.
    fn likely(&self) -> Vec<u32> {
        let mut motions = self.pair.to_vec();
        for c in 0..4 {
            let mut lowest = [(f64::INFINITY, None); 2];
            for (motion, heights) in &self.tried {
                let this = (heights[c], Some(*motion));
                if this.0 < lowest[0].0 {
                    lowest = [this, lowest[0]];
                } else if this.0 < lowest[1].0 {
                    lowest[1] = this;
                }
            }
            motions.extend(lowest.into_iter().filter_map(|l| l.1));
        }
        let mut once = Vec::with_capacity(motions.len());
        for motion in motions {
            if !once.contains(&motion) {
                once.push(motion);
            }
        }
        once
    }
}

impl Cell<'_> {
    /// Bound on the heights over the cell, divided so often; a bound that is not above `enough` need not be sharper. The last parts whose own bounds are above it are put into `above`.
    fn bound(&self, enough: f64, divisions: u32, above: &mut Vec<(Patch, f64)>) -> f64 {
        self.bound_of(&self.patch, None, enough, (divisions, above))
    }

    /// The same over a patch, from `motions` or, without, from all around.
    fn bound_of(
        &self,
        patch: &Patch,
        motions: Option<&[u32]>,
        enough: f64,
        (divisions, above): (u32, &mut Vec<(Patch, f64)>),
    ) -> f64 {
        let Some(mut level) = Level::new(self, patch) else { return enough };
        let holds = self.try_all(&mut level, motions, enough);
        if holds || divisions == 0 {
            if !holds {
                above.push((*patch, level.best));
            }
            return level.best;
        }
        let likely = level.likely();
        let mut divided = 0.0f64;
        for part in patch.parts() {
            if self.on_face(&part) {
                let below = (divisions - 1, &mut *above);
                divided = divided.max(self.bound_of(&part, Some(&likely), enough, below));
            }
        }
        level.best.min(divided)
    }

    /// Whether the motions, tried one after the other, bring the bound down to `enough`.
    fn try_all(&self, level: &mut Level, motions: Option<&[u32]>, enough: f64) -> bool {
        if let Some(motions) = motions {
            return motions.iter().any(|m| level.with(self, *m) <= enough);
        }
        if level.with(self, self.own) <= enough {
            return true;
        }
        let other = |m: &&u32| **m != self.own;
        if self.beside.iter().filter(other).any(|m| level.with(self, *m) <= enough) {
            return true;
        }
        let height = level.best.min(self.world.job.stock_mm);
        let around = self.around(level.points, level.middle, level.normal, height);
        around
            .iter()
            .filter(other)
            .filter(|m| !self.beside.contains(m))
            .any(|m| level.with(self, *m) <= enough)
    }

    /// The motions of the cutter that leave least above the middle of a cell, of those that come near what is up to
    /// `height` above it.
    fn around(&self, corners: [Point3; 4], middle: Point3, normal: Unit3, height: f64) -> Vec<u32> {
        let World { job, bodies, ways, .. } = self.world;
        let raised = normal.into_inner() * height;
        let target = Target::around(corners.into_iter().flat_map(|p| [p, p + raised]), &normal);
        let mut found = Vec::new();
        ways.near(bodies, &target, Which::Cutting, |k, body, _| {
            let piece = &ways.pieces[k as usize];
            let swept = &job.motions[piece.motion as usize];
            if !swept.rapid && Approach::new(swept, piece).passes(body, &target, 0.0) != Passes::Clear {
                found.push(piece.motion);
            }
        });
        found.sort_unstable();
        found.dedup();
        let above = |m: u32| self.height(m, middle, normal, f64::INFINITY).unwrap_or(f64::INFINITY);
        let mut ranked: Vec<(f64, u32)> = found.into_iter().map(|m| (above(m), m)).collect();
        ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        ranked.truncate(MOST_MOTIONS);
        ranked.into_iter().map(|r| r.1).collect()
    }

    /// Whether a raster of places of a patch meets the face.
    fn on_face(&self, patch: &Patch) -> bool {
        patch.raster().any(|place| self.surface.contains(place))
    }

    /// What one motion leaves above a point along a direction; none where that is not below `useful`.
    fn height(&self, motion: u32, origin: Point3, direction: Unit3, useful: f64) -> Option<f64> {
        let World { job, .. } = self.world;
        let body =
            Body { cutter: job.cutter_of(motion), above_mm: 0.0, tool: job.tool_of(motion), intrudes: false };
        let swept = &job.motions[motion as usize];
        let piece = Piece { motion, range: [0.0, 1.0] };
        let line = Line { origin, direction };
        let passage = Passage { body, swept, piece, line, instant: INSTANT, met: MET };
        passage.height(useful, job.depth_mm)
    }
}
