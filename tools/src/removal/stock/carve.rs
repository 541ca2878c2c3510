//! Carving: every tile of rays against the motions that come near what is left in it.

use super::lattice::{Across, Lattice, SIDE, TILE, Tile};
use super::report::{Bite, Carved, Collision, Work};
use super::{ENDS_MM, Stock, TURNING_MM};
use crate::cutter::{Cutter, Line};
use crate::removal::body::Body as Moved;
use crate::removal::deepest::Passage;
use crate::removal::piece::{Approach, Passes, Piece, moving, pieces};
use crate::removal::target::Target;
use crate::removal::tree::{Tree, Which};
use crate::removal::{Body, JobError, Swept};
use osculate_geom::roots::{End, bracketed};
use osculate_geom::{Point3, Unit3, Vec3, any_perpendicular};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A body above the cutter: a shank or a holder.
#[derive(Clone, Copy, Debug)]
pub struct Upper<'a> {
    /// Its shape.
    pub body: &'a Cutter,
    /// How far its lower end is above the tool tip, mm.
    pub above_mm: f64,
    /// Which it is.
    pub kind: Body,
}

/// What carves.
#[derive(Clone, Copy, Debug)]
pub struct StockJob<'a> {
    /// The cutter. Its whole length cuts.
    pub cutter: &'a Cutter,
    /// Bodies above it, which must not meet material.
    pub uppers: &'a [Upper<'a>],
    /// The motions in the order in which they happen.
    pub motions: &'a [Swept],
    /// Longest stretch that a rapid, shank or holder may take from a ray before it is a collision, mm.
    pub touch_mm: f64,
}

/// Accuracy of the deepest instant relative to a piece: 1e-7 mm for pieces of 100 mm.
const INSTANT: f64 = 1e-9;
/// Accuracy of the instant at which material was met, of the motion: far below a sector's width.
const MET: f64 = 1e-4;
/// Tiles carved at a time, before what they found is put together: bounds memory.
const AT_ONCE: usize = 256;
/// Sectors around the axis in which material is noted.
const SECTORS: f64 = 64.0;

/// Tile or part of one, for rejecting: rays from a corner on, `side` each way.
const PART: usize = 4;

impl Stock {
    /// Moves the tool through the whole path. `progress` gets the fraction done. The result does not depend on the
    /// number of threads.
    ///
    /// # Errors
    /// [`JobError`] for numbers that are not finite and axes that turn over.
    pub fn carve(&mut self, job: &StockJob<'_>, progress: &(dyn Fn(f64) + Sync)) -> Result<Carved, JobError> {
        let mut bodies = vec![Moved { cutter: job.cutter, above_mm: 0.0 }];
        bodies.extend(job.uppers.iter().map(|u| Moved { cutter: u.body, above_mm: u.above_mm }));
        let reach = bodies
            .iter()
            .map(|b| (b.above_mm + b.cutter.length_mm()).hypot(b.cutter.radius_mm()))
            .fold(0.0, f64::max);
        let pieces = pieces(job.motions, reach)?;
        let tree = Tree::new(job.motions, &pieces, job.cutter.radius_mm());
        let world = World { job, bodies, tree, pieces };
        let all: usize = self.fields.iter().map(|f| f.tiles.len()).sum();
        let done = AtomicUsize::new(0);
        let share = 1.0 / self.fields.len() as f64;
        let mut found: HashMap<(u32, u8), Bite> = HashMap::new();
        for field in &mut self.fields {
            let lattice = &field.lattice;
            for (chunk, tiles) in field.tiles.chunks_mut(AT_ONCE).enumerate() {
                let bites: Vec<Vec<Bite>> = tiles
                    .par_iter_mut()
                    .enumerate()
                    .map(|(k, tile)| {
                        let bites = Rays::new(&world, lattice, tile, chunk * AT_ONCE + k).carve(tile);
                        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
                        progress(count as f64 / all as f64);
                        bites
                    })
                    .collect();
                for bite in bites.into_iter().flatten() {
                    let bite = Bite { volume: bite.volume * lattice.area() * share, ..bite };
                    let sum =
                        found.entry((bite.motion, bite.body)).or_insert(Bite::none(bite.motion, bite.body));
                    sum.merge(&bite);
                }
            }
        }
        let mut found: Vec<Bite> = found.into_values().collect();
        found.sort_unstable_by_key(|b| (b.motion, b.body));
        Ok(world.sum_up(&found))
    }
}

struct World<'a> {
    job: &'a StockJob<'a>,
    bodies: Vec<Moved<'a>>,
    tree: Tree,
    pieces: Vec<Piece>,
}

impl World<'_> {
    fn sum_up(&self, bites: &[Bite]) -> Carved {
        let mut out = Carved::default();
        for bite in bites {
            let swept = &self.job.motions[bite.motion as usize];
            let (motion, block, volume_mm3) = (bite.motion, swept.block, bite.volume);
            let kind = match bite.body {
                0 => Body::Cutter,
                k => self.job.uppers[usize::from(k) - 1].kind,
            };
            if kind != Body::Cutter || swept.rapid {
                if bite.deepest > self.job.touch_mm {
                    out.collisions.push(Collision {
                        motion,
                        block,
                        body: kind,
                        rapid: swept.rapid,
                        volume_mm3,
                        deepest_mm: bite.deepest,
                        at: bite.at,
                    });
                }
                continue;
            }
            let length = (swept.to.tip - swept.from.tip).norm();
            out.work.push(Work {
                motion,
                block,
                volume_mm3,
                section_mm2: if length > 0.0 { volume_mm3 / length } else { 0.0 },
                arc_rad: f64::from(bite.sectors.count_ones()) * std::f64::consts::TAU / SECTORS,
                height_mm: bite.height,
            });
        }
        out
    }
}

/// The rays of one tile while they are carved.
struct Rays<'a> {
    world: &'a World<'a>,
    lattice: &'a Lattice,
    spans: Vec<Vec<[f64; 2]>>,
    places: Vec<Option<Across>>,
    /// What is left in the tile, and in its parts.
    whole: Option<Target>,
    parts: Vec<Option<Target>>,
    covered: Vec<[f64; 2]>,
}

impl<'a> Rays<'a> {
    fn new(world: &'a World<'a>, lattice: &'a Lattice, tile: &Tile, index: usize) -> Self {
        let mut places = vec![None; TILE];
        lattice.each_ray(index, |ray, at| places[ray] = Some(at));
        let spans = (0..TILE).map(|ray| tile.of(ray).to_vec()).collect();
        let parts = vec![None; (SIDE / PART) * (SIDE / PART)];
        let mut rays = Self { world, lattice, spans, places, whole: None, parts, covered: Vec::new() };
        for part in 0..rays.parts.len() {
            rays.parts[part] = rays.target(Self::rays_of(part));
        }
        rays.whole = rays.target(0..TILE);
        rays
    }

    fn rays_of(part: usize) -> impl Iterator<Item = usize> + Clone + use<> {
        let across = SIDE / PART;
        let corner = (part / across) * PART * SIDE + (part % across) * PART;
        (0..PART * PART).map(move |k| corner + (k / PART) * SIDE + k % PART)
    }

    /// The box of what is left on some rays.
    fn target(&self, rays: impl Iterator<Item = usize>) -> Option<Target> {
        let [b, c] = self.lattice.others();
        let (mut lo, mut hi) = (Vec3::from_element(f64::INFINITY), Vec3::from_element(f64::NEG_INFINITY));
        for ray in rays {
            let (Some(at), Some(first), Some(last)) =
                (self.places[ray], self.spans[ray].first(), self.spans[ray].last())
            else {
                continue;
            };
            for (axis, from, to) in
                [(self.lattice.axis, first[0], last[1]), (b, at[0], at[0]), (c, at[1], at[1])]
            {
                (lo[axis], hi[axis]) = (lo[axis].min(from), hi[axis].max(to));
            }
        }
        (lo[b] <= hi[b]).then(|| Target::upright(Point3::from((lo + hi) * 0.5), &((hi - lo) * 0.5)))
    }

    fn carve(mut self, tile: &mut Tile) -> Vec<Bite> {
        let mut bites: Vec<Bite> = Vec::new();
        let Some(whole) = self.whole else { return bites };
        let world = self.world;
        let mut near: Vec<(u32, u8, u32)> = Vec::new();
        world.tree.near(&world.bodies, &whole, Which::All, |k, _, body| {
            // Few bodies: cutter, shank, holder.
            near.push((world.pieces[k as usize].motion, body as u8, k));
        });
        // Within a motion, which may have several pieces, the cutter before what is above it.
        near.sort_unstable();
        for (motion, body, k) in near {
            let Some(whole) = self.whole else { break };
            let piece = world.pieces[k as usize];
            let swept = &world.job.motions[motion as usize];
            let approach = Approach::new(swept, &piece);
            let moved = &world.bodies[usize::from(body)];
            if approach.passes(moved, &whole, 0.0) == Passes::Clear {
                continue;
            }
            let mut bite = Bite::none(motion, body);
            for part in 0..self.parts.len() {
                let Some(target) = self.parts[part] else { continue };
                if approach.passes(moved, &target, 0.0) == Passes::Clear {
                    continue;
                }
                let before = bite.volume;
                for ray in Self::rays_of(part) {
                    self.bite(ray, &mut bite, (moved, &piece, &approach));
                }
                if bite.volume > before {
                    self.parts[part] = self.target(Self::rays_of(part));
                }
            }
            if bite.volume > 0.0 {
                self.whole = self.target(0..TILE);
                match bites.last_mut() {
                    Some(last) if last.motion == motion && last.body == body => last.merge(&bite),
                    _ => bites.push(bite),
                }
            }
        }
        if !bites.is_empty() {
            *tile = Tile::pack(&self.spans);
        }
        bites
    }

    /// Takes from one ray what a piece covers.
    fn bite(
        &mut self,
        ray: usize,
        bite: &mut Bite,
        (moved, piece, approach): (&Moved<'_>, &Piece, &Approach),
    ) {
        let Some(at) = self.places[ray] else { return };
        self.covered.clear();
        let line = Line { origin: self.lattice.point(at, 0.0), direction: unit(self.lattice.axis) };
        let sweep = Sweep { world: self.world, moved, line };
        for span in &self.spans[ray] {
            sweep.covered(piece, approach, *span, &mut self.covered);
        }
        for &[a, b] in &self.covered {
            let mut taken = 0.0;
            let mut left = Vec::with_capacity(self.spans[ray].len() + 1);
            for &[lo, hi] in &self.spans[ray] {
                let (from, to) = (lo.max(a), hi.min(b));
                if to <= from {
                    left.push([lo, hi]);
                    continue;
                }
                taken += to - from;
                note(bite, (moved, &self.world.job.motions[piece.motion as usize]), &line, [from, to]);
                if from > lo {
                    left.push([lo, from]);
                }
                if hi > to {
                    left.push([to, hi]);
                }
            }
            if taken > 0.0 {
                bite.volume += taken;
                self.spans[ray] = left;
            }
        }
    }
}

fn unit(axis: usize) -> Unit3 {
    [Vec3::x_axis(), Vec3::y_axis(), Vec3::z_axis()][axis]
}

/// Notes where on the body a stretch was taken: where its middle was when the body's surface reached it.
fn note(bite: &mut Bite, (body, swept): (&Moved<'_>, &Swept), line: &Line, [from, to]: [f64; 2]) {
    let middle = line.point(0.5 * (from + to));
    if to - from > bite.deepest {
        (bite.deepest, bite.at) = (to - from, middle);
    }
    let way = swept.to.tip - swept.from.tip;
    let beside = (middle - swept.from.tip).dot(&way) / way.norm_squared();
    let beside = if beside.is_finite() { beside.clamp(0.0, 1.0) } else { 1.0 };
    let distance = |t: f64| {
        let pose = moving(swept, t).pose;
        body.near(&(middle - pose.tip), &pose.axis).distance
    };
    let ends = [0.0, beside].map(|x| End { x, f: distance(x) });
    // Inside from the start it was met there; where it is never inside beside the tool, beside it.
    let met = if ends[0].f <= 0.0 {
        0.0
    } else {
        bracketed(ends[0], ends[1], MET, distance).map_or(beside, |root| root.x)
    };
    let pose = moving(swept, met).pose;
    let w = middle - pose.tip;
    let z = w.dot(&pose.axis);
    bite.height = [bite.height[0].min(z), bite.height[1].max(z)];
    let ahead = way - pose.axis.into_inner() * way.dot(&pose.axis);
    let ahead = Unit3::try_new(ahead, 0.0).unwrap_or_else(|| any_perpendicular(&pose.axis));
    let left = pose.axis.cross(&ahead);
    let turn = w.dot(&left).atan2(w.dot(&ahead)) / std::f64::consts::TAU + 0.5;
    // A whole turn counts as none.
    bite.sectors |= 1u64 << ((turn * SECTORS) as u32).min(63);
}

/// One body on one ray.
struct Sweep<'a> {
    world: &'a World<'a>,
    moved: &'a Moved<'a>,
    line: Line,
}

impl Sweep<'_> {
    fn covered(&self, piece: &Piece, approach: &Approach, span: [f64; 2], out: &mut Vec<[f64; 2]>) {
        let [lo, hi] = span;
        let target = Target::segment(self.line.point(0.5 * (lo + hi)), &self.line.direction, 0.5 * (hi - lo));
        let swept = &self.world.job.motions[piece.motion as usize];
        match approach.passes(self.moved, &target, 0.0) {
            Passes::Clear => {}
            Passes::Near { sagitta, .. } if sagitta <= TURNING_MM => {
                let passage =
                    Passage { body: *self.moved, swept, piece: *piece, line: self.line, instant: INSTANT };
                out.extend(passage.covered(span, ENDS_MM));
            }
            Passes::Near { .. } => {
                for half in piece.halves() {
                    self.covered(&half, &Approach::new(swept, &half), span, out);
                }
            }
        }
    }
}
