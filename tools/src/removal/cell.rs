//! Bounds on what stands above one cell: see [`hidden`](super::hidden()).

use super::body::Body;
use super::deepest::Passage;
use super::edges::Edges;
use super::job::{Cut, Job};
use super::piece::{Approach, Passes, Piece};
use super::sampling::Patch;
use super::target::Target;
use super::tree::{Ways, Which};
use crate::cutter::Line;
use osculate_geom::{Point3, Surface, Unit3};

/// Motions around a cell that are tried.
const MOST_MOTIONS: usize = 8;
/// Bounds are expected within this multiple of the highest standoff seen.
const MOST_SEEN: f64 = 3.0;
/// Height at which a motion counts as met, mm: bounds are above the truth by more.
const MET: f64 = 1e-9;
/// Accuracy of the instant, of the motion: an instant that is off gives a bound that is higher.
const INSTANT: f64 = 1e-7;

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

/// Whether a sample is judged by the height that was left: one that something cut, of a machined face.
pub(super) fn judged(job: &Job<'_>, cuts: &[Cut], uncut_mm: f64, k: usize) -> bool {
    !job.samples[k].check_only && cuts[k].by.is_some() && cuts[k].standoff_mm <= uncut_mm
}

/// Motions and what was left at samples.
pub(super) struct World<'a> {
    pub job: &'a Job<'a>,
    pub bodies: Vec<Body<'a>>,
    pub ways: &'a Ways,
    pub edges: Option<&'a Edges<'a>>,
    /// The highest standoff at a sample: bounds below need not be sharper.
    pub seen: f64,
}

impl<'a> World<'a> {
    pub fn new(
        (job, ways): (&'a Job<'a>, &'a Ways),
        edges: Option<&'a Edges<'a>>,
        cuts: &[Cut],
        uncut_mm: f64,
    ) -> Self {
        let judged = (0..cuts.len()).filter(|k| judged(job, cuts, uncut_mm, *k));
        let seen = judged.map(|k| cuts[k].standoff_mm).fold(0.0, f64::max);
        World { job, bodies: Body::all(job), ways, edges, seen }
    }
}

/// The cell of one sample.
pub(super) struct Cell<'a> {
    pub surface: &'a dyn Surface,
    pub world: &'a World<'a>,
    pub patch: Patch,
    /// The motion that cut the sample.
    pub own: u32,
    /// Motions that cut the samples around.
    pub beside: Vec<u32>,
    /// Those of all that leave least above its middle, where they were looked for.
    pub around: Option<Vec<u32>>,
}

/// What of a cutter comes near a box, to be asked about boxes in it.
pub(super) struct Near<'a> {
    found: Vec<(u32, Body<'a>, Approach)>,
}

impl<'a> Near<'a> {
    pub fn of(world: &'a World<'a>, target: &Target) -> Self {
        let World { job, bodies, ways, .. } = world;
        let mut found = Vec::new();
        ways.near(bodies, target, Which::Cutting, |k, body, _| {
            let piece = &ways.pieces[k as usize];
            let swept = &job.motions[piece.motion as usize];
            let approach = Approach::new(swept, piece);
            if !swept.rapid && approach.passes(body, target, 0.0) != Passes::Clear {
                found.push((piece.motion, *body, approach));
            }
        });
        Self { found }
    }

    /// The motions of the cutter that leave least above the middle of a cell, of those that come near what is above it.
    pub fn least(&self, cell: &Cell<'_>, level: &Level, target: &Target) -> Vec<u32> {
        let comes = |f: &&(u32, Body<'_>, Approach)| f.2.passes(&f.1, target, 0.0) != Passes::Clear;
        let mut motions: Vec<u32> = self.found.iter().filter(comes).map(|f| f.0).collect();
        motions.sort_unstable();
        motions.dedup();
        let above =
            |m: u32| cell.height(m, level.middle, level.normal, f64::INFINITY).unwrap_or(f64::INFINITY);
        let mut ranked: Vec<(f64, u32)> = motions.into_iter().map(|m| (above(m), m)).collect();
        ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        ranked.truncate(MOST_MOTIONS);
        ranked.into_iter().map(|r| r.1).collect()
    }
}

/// What the motions tried so far leave above one patch.
pub(super) struct Level {
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
    pub best: f64,
    pair: [u32; 2],
    tried: Vec<(u32, [f64; 4])>,
}

impl Level {
    /// Nothing tried yet; none where the patch has no tangent plane in its middle.
    pub fn new(cell: &Cell<'_>, patch: &Patch) -> Option<Self> {
        let jet = cell.surface.jet2(patch.middle());
        let points = patch.corners().map(|c| cell.surface.point(c));
        let radius = points.iter().map(|p| (p - jet.point).norm()).fold(0.0, f64::max);
        let normal = jet.normal().ok()?;
        let bend = patch.bend(cell.surface, &normal, radius);
        // Nothing stands higher than the stock, and what does stand higher than this gets the allowance of first order.
        let most = (MOST_SEEN * cell.world.seen).min(cell.world.job.stock_mm);
        let wide = stretched(points, jet.point, most * bend);
        let radius_wide = wide.iter().map(|p| (p - jet.point).norm()).fold(0.0, f64::max);
        Some(Self {
            points,
            middle: jet.point,
            normal,
            wide,
            slack: 0.5 * patch.hollow(bend, radius_wide) * radius_wide,
            most,
            first: 1.0 / (1.0 - bend.min(0.5)),
            second: 1.0 / (1.0 - (3.0 * bend * bend).min(0.5)),
            best: f64::INFINITY,
            pair: [cell.own; 2],
            tried: Vec::new(),
        })
    }

    /// The patch and what is above it, up to the bound or to the raw material.
    pub fn target(&self, stock_mm: f64) -> Target {
        let raised = self.normal.into_inner() * self.best.min(stock_mm);
        Target::around(self.points.into_iter().flat_map(|p| [p, p + raised]), &self.normal)
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
    pub fn bound(&self, enough: f64, divisions: u32, above: &mut Vec<(Patch, f64)>) -> f64 {
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
        self.try_known(level, enough) || self.try_around(level, enough)
    }

    /// The same with the motions that cut the sample and those around.
    pub fn try_known(&self, level: &mut Level, enough: f64) -> bool {
        level.with(self, self.own) <= enough
            || self.beside.iter().filter(|m| **m != self.own).any(|m| level.with(self, *m) <= enough)
    }

    /// The same with others, those that were looked for or those that come near the cell.
    pub fn try_around(&self, level: &mut Level, enough: f64) -> bool {
        let alone = || {
            let target = level.target(self.world.job.stock_mm);
            Near::of(self.world, &target).least(self, level, &target)
        };
        let around = self.around.clone().unwrap_or_else(alone);
        let other = |m: &&u32| **m != self.own && !self.beside.contains(m);
        around.iter().filter(other).any(|m| level.with(self, *m) <= enough)
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
