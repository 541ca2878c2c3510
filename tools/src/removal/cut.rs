//! The removal itself: every group of samples against the motions that come near it, tool by tool.

use super::body::Body as Moved;
use super::cluster::{Cluster, clusters};
use super::deepest::{EXACT, Passage};
use super::job::{Body, By, Cut, Job, JobError, Sample, Swept, Touch};
use super::piece::{Approach, FINE_MM, Passes, Piece};
use super::target::Target;
use super::tree::{Ways, Which};
use crate::cutter::Line;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Heights, and what made them, for all samples of a job, in their order.
///
/// `progress` gets the fraction done, from whichever thread does the work and not always in ascending order.
/// The result does not depend on the number of threads.
///
/// # Errors
/// [`JobError`] for numbers that are not finite and axes that turn over.
pub fn cut(job: &Job<'_>, progress: &(dyn Fn(f64) + Sync)) -> Result<Vec<Cut>, JobError> {
    cut_on(job, job.before_any(), progress)
}

/// The same on what motions before have left at the samples. Those of this job are counted from 0.
///
/// # Errors
/// As [`cut`], and where what was left is not that of the job's samples.
pub fn cut_on(
    job: &Job<'_>,
    before: Vec<Cut>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<Cut>, JobError> {
    if !(job.stock_mm >= 0.0 && job.stock_mm.is_finite()) {
        return Err(JobError::Stock { got: job.stock_mm });
    }
    if !(job.depth_mm > 0.0 && job.depth_mm.is_finite()) {
        return Err(JobError::Depth { got: job.depth_mm });
    }
    if before.len() != job.samples.len() {
        return Err(JobError::Before { samples: job.samples.len(), before: before.len() });
    }
    let mut cuts = before;
    let ways = Ways::of_job(job)?;
    Cutting::new(job, &ways)?.go(0..ways.tools(), &mut cuts, progress);
    Ok(cuts)
}

/// As [`cut`], by the ways of the job's motions.
pub(super) fn cut_by(job: &Job<'_>, ways: &Ways) -> Result<Vec<Cut>, JobError> {
    let mut cuts = job.before_any();
    Cutting::new(job, ways)?.go(0..ways.tools(), &mut cuts, &|_| {});
    Ok(cuts)
}

/// A job whose tools can be taken one after the other.
pub(super) struct Cutting<'a> {
    world: World<'a>,
    groups: Vec<Cluster>,
}

impl<'a> Cutting<'a> {
    /// Of a job with the ways of its motions.
    pub fn new(job: &'a Job<'a>, ways: &'a Ways) -> Result<Self, JobError> {
        Ok(Self { world: World { job, bodies: Moved::all(job), ways }, groups: clusters(job.samples)? })
    }

    /// Goes on with the motions of some of the tools, which follow those that have left the samples so.
    pub fn go(&self, tools: Range<usize>, cuts: &mut [Cut], progress: &(dyn Fn(f64) + Sync)) {
        let (done, count) = (AtomicUsize::new(0), self.groups.len());
        let before = &*cuts;
        let after: Vec<Vec<Cut>> = self
            .groups
            .par_iter()
            .map(|group| {
                let cuts = self.world.cut_group(group, tools.clone(), before);
                let now = done.fetch_add(1, Ordering::Relaxed) + 1;
                // A thousand reports are enough for any display.
                if now == count || now.is_multiple_of(count / 1000 + 1) {
                    progress(now as f64 / count as f64);
                }
                cuts
            })
            .collect();
        for (group, after) in self.groups.iter().zip(after) {
            for (k, cut) in group.members.iter().zip(after) {
                cuts[*k as usize] = cut;
            }
        }
    }
}

struct World<'a> {
    job: &'a Job<'a>,
    bodies: Vec<Moved<'a>>,
    ways: &'a Ways,
}

/// A piece that comes near a group, with one body.
struct Candidate {
    piece: u32,
    body: usize,
    rapid: bool,
    approach: Approach,
    /// How near it was seen to come, mm.
    nearest: f64,
}

impl World<'_> {
    fn candidates(&self, tool: usize, target: &Target, which: Which) -> Vec<Candidate> {
        let mut found = Vec::new();
        self.ways.near_of(tool, &self.bodies, (target, which), |k, body, index| {
            let piece = &self.ways.pieces[k as usize];
            let swept = &self.job.motions[piece.motion as usize];
            match which {
                Which::Cutting if swept.rapid => return,
                Which::Intruding if !body.intrudes && !swept.rapid => return,
                _ => {}
            }
            let approach = Approach::new(swept, piece);
            if let Passes::Near { distance, .. } = approach.passes(body, target, 0.0) {
                found.push(Candidate {
                    piece: k,
                    body: index,
                    rapid: swept.rapid,
                    approach,
                    nearest: distance,
                });
            }
        });
        found
    }

    /// What some of the tools, one after the other, make of what was left at all samples: at those of a group.
    fn cut_group(&self, group: &Cluster, tools: Range<usize>, before: &[Cut]) -> Vec<Cut> {
        let work = |k: &u32| Work::new(self, &self.job.samples[*k as usize], before[*k as usize]);
        let mut work: Vec<Work<'_>> = group.members.iter().map(work).collect();
        for tool in tools {
            self.cut_by_tool(group, tool, &mut work);
        }
        work.into_iter().map(|one| one.cut).collect()
    }

    fn cut_by_tool(&self, group: &Cluster, tool: usize, work: &mut [Work<'_>]) {
        let samples = self.job.samples;
        let target = |work: &[Work<'_>]| group.target(samples, |k| work[k].cut.standoff_mm);
        // Material is not supposed to meet these: what they take depends on what was cut before them.
        let intruders = self.candidates(tool, &target(work), Which::Intruding);
        for one in work.iter_mut() {
            one.in_order = intruders.iter().any(|c| one.lowered_by(c).is_some());
        }
        if work.iter().any(|one| one.in_order) {
            let mut all = self.candidates(tool, &target(work), Which::All);
            // Within a motion, which may have several pieces, the cutter before the holder.
            all.sort_unstable_by_key(|c| (self.ways.pieces[c.piece as usize].motion, c.body, c.piece));
            for one in work.iter_mut().filter(|one| one.in_order) {
                for c in &all {
                    one.take(c);
                }
            }
        }
        // Elsewhere the height is a minimum, whatever the order. What comes near the lowest layer alone settles most
        // samples, and there is much less of it than of what comes near all material.
        let thin = self.job.stock_mm * THIN;
        let layer = group.target(samples, |k| work[k].cut.standoff_mm.min(thin));
        let near = self.candidates(tool, &layer, Which::Cutting);
        self.lower(group, work, near);
        if work.iter().any(|one| !one.in_order && one.cut.standoff_mm > thin) {
            let near = self.candidates(tool, &target(work), Which::Cutting);
            self.lower(group, work, near);
        }
    }

    /// Cuts those samples of a group for which the order of motions does not matter.
    fn lower(&self, group: &Cluster, work: &mut [Work<'_>], mut found: Vec<Candidate>) {
        // The deepest first spares most of the others.
        found.sort_unstable_by(|a, b| a.nearest.total_cmp(&b.nearest).then(a.piece.cmp(&b.piece)));
        let mut rest: Vec<&Candidate> = found.iter().collect();
        let mut count = FIRST;
        // At their greatest depth samples are done, however many motions still pass there.
        let open = |one: &Work<'_>| !one.in_order && one.cut.standoff_mm > -self.job.depth_mm;
        while !rest.is_empty() && work.iter().any(open) {
            let (now, later) = rest.split_at(rest.len().min(count));
            // Looked at again after ever longer stretches, so that many that all come near do not cost their square.
            count *= 2;
            // What cut the sample before most likely cuts its neighbour.
            let mut likely = 0;
            for one in work.iter_mut().filter(|one| !one.in_order) {
                one.take(now[likely]);
                let first = likely;
                for (k, c) in now.iter().enumerate().filter(|(k, _)| *k != first) {
                    if one.take(c) {
                        likely = k;
                    }
                }
            }
            // What is left of the material is thinner now.
            let target = group.target(self.job.samples, |k| work[k].cut.standoff_mm);
            rest = later
                .iter()
                .filter(|c| c.approach.passes(&self.bodies[c.body], &target, 0.0) != Passes::Clear)
                .copied()
                .collect();
        }
    }
}

/// Share of the stock's height that is looked at first.
const THIN: f64 = 0.0625;
/// Candidates tried on a group before the others are looked at again.
const FIRST: usize = 8;

/// One sample while it is cut.
struct Work<'a> {
    world: &'a World<'a>,
    line: Line,
    cut: Cut,
    /// Whether a rapid or the holder reaches its material, so that the order of motions matters.
    in_order: bool,
}

impl<'a> Work<'a> {
    fn new(world: &'a World<'a>, sample: &Sample, cut: Cut) -> Self {
        let line = Line { origin: sample.point, direction: sample.normal };
        Self { world, line, cut, in_order: false }
    }

    /// The height to which a candidate would cut, where that is lower than it is now.
    fn lowered_by(&self, c: &Candidate) -> Option<f64> {
        let piece = self.world.ways.pieces[c.piece as usize];
        self.lowered(&self.world.bodies[c.body], &piece, &c.approach, self.cut.standoff_mm)
    }

    /// To lower a height h >= 0 a body must have a point on the line between 0 and h, to deepen a gouge h < 0
    /// it must contain the gouge's bottom.
    fn lowered(&self, body: &Moved<'_>, piece: &Piece, approach: &Approach, height: f64) -> Option<f64> {
        let depth = self.world.job.depth_mm;
        if height <= -depth {
            return None;
        }
        let (middle, radius) = if height > 0.0 { (0.5 * height, 0.5 * height) } else { (height, 0.0) };
        let swept = &self.world.job.motions[piece.motion as usize];
        let target = Target::segment(self.line.point(middle), &self.line.direction, radius);
        let Passes::Near { sagitta, .. } = approach.passes(body, &target, 0.0) else { return None };
        let passage =
            Passage { body: *body, swept, piece: *piece, line: self.line, instant: EXACT, met: 0.0 };
        let first = passage.height(height, depth);
        if sagitta <= FINE_MM {
            return first;
        }
        // That was one deepest instant. Whether there is a deeper one is asked half by half, which mostly is no.
        self.deeper(body, swept, piece, first.unwrap_or(height)).or(first)
    }

    /// The height to which the halves of a piece lower it further, by more than [`FINE_MM`].
    fn deeper(&self, body: &Moved<'_>, swept: &Swept, piece: &Piece, height: f64) -> Option<f64> {
        let depth = self.world.job.depth_mm;
        let mut lower = None;
        for half in piece.halves() {
            let height = lower.unwrap_or(height);
            if height <= -depth {
                break;
            }
            let (middle, radius) = if height > 0.0 { (0.5 * height, 0.5 * height) } else { (height, 0.0) };
            let target = Target::segment(self.line.point(middle), &self.line.direction, radius);
            match Approach::new(swept, &half).passes(body, &target, FINE_MM) {
                Passes::Clear => {}
                Passes::Near { sagitta, .. } if sagitta <= FINE_MM => {
                    let passage = Passage {
                        body: *body,
                        swept,
                        piece: half,
                        line: self.line,
                        instant: EXACT,
                        met: 0.0,
                    };
                    lower = passage.height(height, depth).or(lower);
                }
                Passes::Near { .. } => lower = self.deeper(body, swept, &half, height).or(lower),
            }
        }
        lower
    }

    /// Cuts by a candidate; whether that lowered the height.
    fn take(&mut self, c: &Candidate) -> bool {
        let Some(height) = self.lowered_by(c) else { return false };
        let motion = self.world.ways.pieces[c.piece as usize].motion;
        let block = self.world.job.motions[motion as usize].block;
        let body = if self.world.bodies[c.body].cuts() { Body::Cutter } else { Body::Holder };
        let touch = Touch { removed_mm: self.cut.standoff_mm - height, motion, block };
        let worse = |old: Option<Touch>| match old {
            Some(old) if old.removed_mm >= touch.removed_mm => Some(old),
            _ => Some(touch),
        };
        if body == Body::Holder {
            self.cut.holder = worse(self.cut.holder);
        } else if c.rapid {
            self.cut.rapid = worse(self.cut.rapid);
        }
        self.cut.standoff_mm = height;
        self.cut.by = Some(By { motion, block, body, rapid: c.rapid });
        true
    }
}
