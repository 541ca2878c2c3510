//! The rays of one tile while they are carved.
//!
//! A motion goes through sieves that grow finer: the tree, the box of what is left in the tile, the boxes of sixteen parts
//! of it, each cut down to the box that the body fills during the piece, and the single rays. Most of what a path does at a
//! tile happens in a small part of it.

use super::glide::{Glide, View};
use super::lattice::{Across, Lattice, SIDE, TILE, Tile};
use super::report::Bite;
use super::world::World;
use crate::pose::Pose;
use crate::removal::Swept;
use crate::removal::body::Body as Moved;
use crate::removal::piece::{Approach, Passes, Piece, SAGITTA_MM, moving};
use crate::removal::target::Target;
use crate::removal::tree::Which;
use osculate_geom::Box3;

/// Rays along each side of a part of a tile.
const PART: usize = 4;
/// Parts along each side of a tile.
const PARTS: usize = SIDE / PART;

pub(super) struct Rays<'a> {
    world: &'a World<'a>,
    lattice: &'a Lattice,
    spans: Vec<Vec<[f64; 2]>>,
    places: Vec<Option<Across>>,
    /// What is left in the tile, and in its parts; empty where nothing is.
    whole: Box3,
    parts: [Box3; PARTS * PARTS],
    covered: Vec<[f64; 2]>,
}

/// A piece of a motion with one body, looked at from the middle.
struct Pass<'a> {
    moved: Moved<'a>,
    piece: Piece,
    approach: Approach,
    /// Contains the body throughout the piece.
    extent: Box3,
}

impl<'a> Rays<'a> {
    pub fn new(world: &'a World<'a>, lattice: &'a Lattice, tile: &Tile, index: usize) -> Self {
        let mut places = vec![None; TILE];
        lattice.each_ray(index, |ray, at| places[ray] = Some(at));
        let spans = (0..TILE).map(|ray| tile.of(ray).to_vec()).collect();
        let (whole, parts) = (Box3::empty(), [Box3::empty(); PARTS * PARTS]);
        let mut rays = Self { world, lattice, spans, places, whole, parts, covered: Vec::new() };
        for part in 0..rays.parts.len() {
            rays.parts[part] = rays.left(part);
            rays.whole = rays.whole.union(&rays.parts[part]);
        }
        rays
    }

    fn rays_of(part: usize) -> impl Iterator<Item = usize> + use<> {
        let corner = (part / PARTS) * PART * SIDE + (part % PARTS) * PART;
        (0..PART * PART).map(move |k| corner + (k / PART) * SIDE + k % PART)
    }

    /// The box of what is left in a part.
    fn left(&self, part: usize) -> Box3 {
        let along = self.lattice.axis;
        let [b, c] = self.lattice.others();
        let mut left = Box3::empty();
        for ray in Self::rays_of(part) {
            let (Some(at), Some(first), Some(last)) =
                (self.places[ray], self.spans[ray].first(), self.spans[ray].last())
            else {
                continue;
            };
            for (axis, from, to) in [(along, first[0], last[1]), (b, at[0], at[0]), (c, at[1], at[1])] {
                left.min[axis] = left.min[axis].min(from);
                left.max[axis] = left.max[axis].max(to);
            }
        }
        left
    }

    /// Moves all bodies through all motions that come near, in their order; what they took.
    pub fn carve(mut self, tile: &mut Tile) -> Vec<Bite> {
        let mut bites: Vec<Bite> = Vec::new();
        if self.whole.is_empty() {
            return bites;
        }
        let world = self.world;
        let mut near: Vec<(u32, u8, u32)> = Vec::new();
        world.ways.near(&world.bodies, &upright(&self.whole), Which::All, |k, _, body| {
            // Few bodies: cutter, shank, holder.
            near.push((world.ways.pieces[k as usize].motion, body as u8, k));
        });
        // Within a motion, which may have several pieces, the cutter before what is above it.
        near.sort_unstable();
        let mut pieces = Vec::new();
        for (motion, body, k) in near {
            if self.whole.is_empty() {
                break;
            }
            let mut bite = Bite::none(motion, body);
            pieces.push(world.ways.pieces[k as usize]);
            while let Some(piece) = pieces.pop() {
                if self.pass(piece, &mut bite) {
                    let [first, second] = piece.halves();
                    pieces.extend([second, first]);
                }
            }
            if bite.volume > 0.0 {
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

    /// Takes what one piece covers, or nothing and true: it turns too much here and is to be halved.
    fn pass(&mut self, piece: Piece, bite: &mut Bite) -> bool {
        let world = self.world;
        let swept = &world.job.motions[piece.motion as usize];
        let moved = world.bodies[usize::from(bite.body)];
        let turns = swept.from.axis != swept.to.axis;
        let mut extent = Box3::empty();
        for t in piece.range {
            extent = extent.union(&filled(&moved, &moving(swept, t).pose));
        }
        let extent = extent.grown(if turns { SAGITTA_MM } else { 0.0 });
        let Some(near) = common(&self.whole, &extent) else { return false };
        let approach = Approach::new(swept, &piece);
        match approach.passes(&moved, &upright(&near), 0.0) {
            Passes::Clear => return false,
            Passes::Near { sagitta, .. } if 0.5 * sagitta > world.stray_mm => return true,
            Passes::Near { .. } => {}
        }
        let glide = Glide::new(moved, &approach, &self.view(swept));
        let pass = Pass { moved, piece, approach, extent };
        let before = bite.volume;
        for part in 0..self.parts.len() {
            let Some(near) = common(&self.parts[part], &pass.extent) else { continue };
            if pass.approach.passes(&moved, &upright(&near), 0.0) == Passes::Clear {
                continue;
            }
            let before = bite.volume;
            let mut guess = 0.0;
            for ray in Self::rays_of(part) {
                self.bite(ray, bite, (&pass, &glide), &mut guess);
            }
            if bite.volume > before {
                self.parts[part] = self.left(part);
            }
        }
        if bite.volume > before {
            self.whole = self.parts.iter().fold(Box3::empty(), |all, part| all.union(part));
        }
        false
    }

    fn view(&self, swept: &Swept) -> View {
        let way = swept.to.tip - swept.from.tip;
        View { axis: self.lattice.axis, way, stray_mm: self.world.stray_mm }
    }

    /// Takes from one ray what a piece covers.
    fn bite(&mut self, ray: usize, bite: &mut Bite, (pass, glide): (&Pass<'_>, &Glide<'_>), guess: &mut f64) {
        let Some(at) = self.places[ray] else { return };
        let [b, c] = self.lattice.others();
        let Pass { extent, .. } = pass;
        if at[0] < extent.min[b] || at[0] > extent.max[b] || at[1] < extent.min[c] || at[1] > extent.max[c] {
            return;
        }
        let along = self.lattice.axis;
        let near = |&[lo, hi]: &[f64; 2]| {
            let near = [lo.max(extent.min[along]), hi.min(extent.max[along])];
            (near[0] < near[1]).then_some(near)
        };
        if !self.spans[ray].iter().any(|span| near(span).is_some()) {
            return;
        }
        let line = glide.ray(&self.lattice.point(at, 0.0));
        let mut covered = std::mem::take(&mut self.covered);
        covered.clear();
        for near in self.spans[ray].iter().filter_map(near) {
            if let Some(found) = glide.covered(&line, near, guess) {
                if found.whole {
                    covered.push([found.from, found.to]);
                } else {
                    self.with_gaps(pass, at, [found.from, found.to], &mut covered);
                }
            }
        }
        let lattice = self.lattice;
        for &taken in &covered {
            subtract(&mut self.spans[ray], taken, |[from, to]| {
                let middle = 0.5 * (from + to);
                bite.note(to - from, || lattice.point(at, middle), &glide.met(&line, middle));
            });
        }
        self.covered = covered;
    }

    /// Adds what a piece covers between two points of a ray where it may leave gaps: half by half.
    fn with_gaps(&self, pass: &Pass<'_>, at: Across, near: [f64; 2], out: &mut Vec<[f64; 2]>) {
        let swept = &self.world.job.motions[pass.piece.motion as usize];
        let mut pieces = Vec::from(pass.piece.halves());
        while let Some(piece) = pieces.pop() {
            let glide = Glide::new(pass.moved, &Approach::new(swept, &piece), &self.view(swept));
            let line = glide.ray(&self.lattice.point(at, 0.0));
            match glide.covered(&line, near, &mut 0.0) {
                Some(found) if found.whole => out.push([found.from, found.to]),
                // Halves turn half as much: that comes to an end.
                Some(_) => pieces.extend(piece.halves()),
                None => {}
            }
        }
    }
}

fn upright(near: &Box3) -> Target {
    Target::upright(near.centre(), &((near.max - near.min) * 0.5))
}

/// What two boxes have in common.
fn common(a: &Box3, b: &Box3) -> Option<Box3> {
    let both = Box3 { min: a.min.sup(&b.min), max: a.max.inf(&b.max) };
    (0..3).all(|k| both.min[k] <= both.max[k]).then_some(both)
}

/// The box that a body fills in a pose.
fn filled(moved: &Moved<'_>, pose: &Pose) -> Box3 {
    let axis = pose.axis.into_inner();
    let low = pose.tip + axis * moved.above_mm;
    let high = low + axis * moved.cutter.length_mm();
    // How far a disc across the axis reaches along each coordinate.
    let disc = axis.map(|a| moved.cutter.radius_mm() * (1.0 - a * a).max(0.0).sqrt());
    Box3 { min: low.inf(&high) - disc, max: low.sup(&high) + disc }
}

/// Takes an interval from stretches, ascending and apart, telling every stretch that was taken.
fn subtract(spans: &mut Vec<[f64; 2]>, [a, b]: [f64; 2], mut taken: impl FnMut([f64; 2])) {
    let mut k = 0;
    while k < spans.len() {
        let [lo, hi] = spans[k];
        let (from, to) = (lo.max(a), hi.min(b));
        if to <= from {
            k += 1;
            continue;
        }
        taken([from, to]);
        match (from > lo, to < hi) {
            (true, true) => {
                spans[k] = [lo, from];
                spans.insert(k + 1, [to, hi]);
                return;
            }
            (true, false) => {
                spans[k] = [lo, from];
                k += 1;
            }
            (false, true) => {
                spans[k] = [to, hi];
                k += 1;
            }
            (false, false) => {
                spans.remove(k);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_without_an_interval() {
        let whole = vec![[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]];
        for (cut, left, gone) in [
            ([0.5, 4.5], vec![[0.0, 0.5], [4.5, 5.0]], 2.0),
            ([2.2, 2.7], vec![[0.0, 1.0], [2.0, 2.2], [2.7, 3.0], [4.0, 5.0]], 0.5),
            ([-1.0, 2.0], vec![[2.0, 3.0], [4.0, 5.0]], 1.0),
            ([2.5, 9.0], vec![[0.0, 1.0], [2.0, 2.5]], 1.5),
            ([1.0, 2.0], whole.clone(), 0.0),
        ] {
            let (mut spans, mut sum) = (whole.clone(), 0.0);
            subtract(&mut spans, cut, |[a, b]| sum += b - a);
            assert_eq!(spans, left);
            assert!((sum - gone).abs() < 1e-12);
        }
    }
}
