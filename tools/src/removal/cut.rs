//! The removal itself: every group of samples against the motions that come near it.

use super::body::Body as Moved;
use super::cluster::{Cluster, clusters};
use super::deepest::{EXACT, Passage};
use super::job::{Body, By, Cut, Job, JobError, Sample, Touch};
use super::piece::{Approach, FINE_MM, Passes, Piece, pieces};
use super::target::Target;
use super::tree::Tree;
use crate::cutter::Line;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Heights, and what made them, for all samples of a job, in their order.
///
/// `progress` gets the fraction done, from whichever thread does the work and not always in ascending order.
/// The result does not depend on the number of threads.
///
/// # Errors
/// [`JobError`] for numbers that are not finite and axes that turn over.
pub fn cut(job: &Job<'_>, progress: &(dyn Fn(f64) + Sync)) -> Result<Vec<Cut>, JobError> {
    if !(job.stock_mm >= 0.0 && job.stock_mm.is_finite()) {
        return Err(JobError::Stock { got: job.stock_mm });
    }
    if !(job.depth_mm > 0.0 && job.depth_mm.is_finite()) {
        return Err(JobError::Depth { got: job.depth_mm });
    }
    let mut bodies = vec![Moved { cutter: job.cutter, above_mm: 0.0 }];
    bodies.extend(job.holder.map(|cutter| Moved { cutter, above_mm: job.cutter.length_mm() }));
    let reach = bodies
        .iter()
        .map(|b| (b.above_mm + b.cutter.length_mm()).hypot(b.cutter.radius_mm()))
        .fold(0.0, f64::max);
    let pieces = pieces(job.motions, reach)?;
    let tree = Tree::new(job.motions, &pieces, job.cutter.radius_mm());
    let world = World { job, bodies, tree, pieces };
    let groups = clusters(job.samples)?;
    let done = AtomicUsize::new(0);
    let cuts: Vec<Vec<Cut>> = groups
        .par_iter()
        .map(|group| {
            let cuts = world.cut_group(group);
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            // A thousand reports are enough for any display.
            if count == groups.len() || count.is_multiple_of(groups.len() / 1000 + 1) {
                progress(count as f64 / groups.len() as f64);
            }
            cuts
        })
        .collect();
    let blank = Cut { standoff_mm: job.stock_mm, by: None, rapid: None, holder: None };
    let mut out = vec![blank; job.samples.len()];
    for (group, cuts) in groups.iter().zip(cuts) {
        for (k, cut) in group.members.iter().zip(cuts) {
            out[*k as usize] = cut;
        }
    }
    Ok(out)
}

struct World<'a> {
    job: &'a Job<'a>,
    bodies: Vec<Moved<'a>>,
    tree: Tree,
    pieces: Vec<Piece>,
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
    fn candidates(&self, target: &Target) -> Vec<Candidate> {
        let mut found = Vec::new();
        self.tree.near(&self.bodies, target, |k, body, index| {
            let piece = &self.pieces[k as usize];
            let swept = &self.job.motions[piece.motion as usize];
            let approach = Approach::new(swept, piece);
            if let Passes::Near { distance, .. } = approach.passes(body, target) {
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

    fn cut_group(&self, group: &Cluster) -> Vec<Cut> {
        let samples = self.job.samples;
        let mut work: Vec<Work<'_>> =
            group.members.iter().map(|k| Work::new(self, &samples[*k as usize])).collect();
        let target = |work: &[Work<'_>]| group.target(samples, |k| work[k].cut.standoff_mm);
        let in_order = {
            let mut all = self.candidates(&target(&work));
            // Within a motion, which may have several pieces, the cutter before the holder.
            all.sort_unstable_by_key(|c| (self.pieces[c.piece as usize].motion, c.body, c.piece));
            all
        };
        // Material is not supposed to meet these: what they take depends on what was cut before them.
        let intruders: Vec<&Candidate> = in_order.iter().filter(|c| c.rapid || c.body != 0).collect();
        for one in &mut work {
            one.in_order = intruders.iter().any(|c| one.lowered_by(c).is_some());
            if one.in_order {
                for c in &in_order {
                    one.take(c);
                }
            }
        }
        // Elsewhere the height is a minimum, whatever the order: the deepest first spares most of the others.
        let mut rest: Vec<&Candidate> = in_order.iter().filter(|c| !c.rapid && c.body == 0).collect();
        rest.sort_by(|a, b| a.nearest.total_cmp(&b.nearest).then(a.piece.cmp(&b.piece)));
        while !rest.is_empty() {
            let (now, later) = rest.split_at(rest.len().min(FIRST));
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
            let target = target(&work);
            rest = later
                .iter()
                .filter(|c| c.approach.passes(&self.bodies[c.body], &target) != Passes::Clear)
                .copied()
                .collect();
        }
        work.into_iter().map(|one| one.cut).collect()
    }
}

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
    fn new(world: &'a World<'a>, sample: &Sample) -> Self {
        let standoff_mm = if sample.check_only { 0.0 } else { world.job.stock_mm };
        let line = Line { origin: sample.point, direction: sample.normal };
        Self { world, line, cut: Cut { standoff_mm, by: None, rapid: None, holder: None }, in_order: false }
    }

    /// The height to which a candidate would cut, where that is lower than it is now.
    fn lowered_by(&self, c: &Candidate) -> Option<f64> {
        let piece = self.world.pieces[c.piece as usize];
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
        match approach.passes(body, &Target::segment(self.line.point(middle), &self.line.direction, radius)) {
            Passes::Clear => None,
            Passes::Near { sagitta, .. } if sagitta <= FINE_MM => {
                Passage { body: *body, swept, piece: *piece, line: self.line, instant: EXACT }
                    .height(height, depth)
            }
            Passes::Near { .. } => piece.halves().iter().fold(None, |lower, half| {
                let height = lower.unwrap_or(height);
                self.lowered(body, half, &Approach::new(swept, half), height).or(lower)
            }),
        }
    }

    /// Cuts by a candidate; whether that lowered the height.
    fn take(&mut self, c: &Candidate) -> bool {
        let Some(height) = self.lowered_by(c) else { return false };
        let motion = self.world.pieces[c.piece as usize].motion;
        let block = self.world.job.motions[motion as usize].block;
        let body = if c.body == 0 { Body::Cutter } else { Body::Holder };
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
