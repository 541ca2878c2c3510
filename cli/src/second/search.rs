//! The deepest and the lowest over all poses of a path, by frozen poses that lie as close as it takes.
//!
//! Over a stretch of a move its middle pose is frozen. The tool is convex: it lies behind the plane at its place nearest to a point,
//! with the normal `G` to that point, and at every pose behind this plane carried along. With `d` from the middle's tip to the
//! point, a pose with the tip off by `e` and the axis `b` instead of `a` is nearer to the point than the middle one by
//!
//! ```text
//! G . e + (a x b) . (d x G)  and a remainder of |a - b| |e| + |a - b|^2 (|d| + |e|) / 2
//! ```
//!
//! at most. It is linear in `e` and `b`, so that of the poses of a stretch its ends bound it, with `(tip'' + |d| axis'') w^2 / 32`
//! for what the way leaves its chords by, `w` the stretch's share of the move. A point that cannot get deeper than the deepest so far
//! by more than the slack is dropped. So is one over which no pose gets lower than the lowest so far by more: there the plane is
//! taken at the place at that height, and what lies below is farther from it. For all that are left the stretch is halved, until the
//! tool moves by less than the slack in it. A corner of radius r that goes straight needs poses `s` apart where
//! `r - sqrt(r^2 - s^2 / 4)`, the ridge that frozen poses leave, is the slack: some `sqrt(8 r slack)`.
//!
//! A first look at the middles of all moves finds most of the depths and heights, so that little has to be halved in the second.
//! Chunks of moves are looked at by themselves and merged in their order, a batch at a time, so that threads do not matter.

use rayon::prelude::*;

use super::kinematics::Pose;
use super::moves::{Bend, Move, Shop};
use super::points::{Cell, Cloud};
use super::tool::{Bodies, Near};
use super::vector::{V, ahead, cross, dot, norm, sub};

/// Moves of a chunk, and chunks between two merges: what one batch has found saves work in the next.
const CHUNK: usize = 256;
const BATCH: usize = 16;

/// A stretch of this share of a move is not halved any more: a move of a metre is a nanometre there.
const NARROWEST: f64 = 1e-9;

/// What is looked for, and how finely.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub stock_mm: f64,
    pub slack_mm: f64,
    pub most_poses: usize,
}

/// The deepest so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deepest {
    pub mm: f64,
    pub point: usize,
    pub line: usize,
    /// No deeper than this in stretches that were not halved for want of poses.
    pub open_mm: f64,
}

const NONE: Deepest = Deepest { mm: f64::NEG_INFINITY, point: 0, line: 0, open_mm: f64::NEG_INFINITY };

impl Deepest {
    fn merge(&mut self, other: &Self) {
        let open_mm = self.open_mm.max(other.open_mm);
        if other.mm > self.mm {
            *self = *other;
        }
        self.open_mm = open_mm;
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub gouge: Deepest,
    pub rapid: Deepest,
    pub holder: Deepest,
    /// Lowest height over each point to which a pose came, and what no pose can have come below.
    pub heights: Vec<f64>,
    pub bounds: Vec<f64>,
    pub poses: usize,
    /// Way of the tip between the closest neighbours.
    pub closest_mm: f64,
}

/// Everything that is asked.
pub(super) struct World<'a> {
    pub moves: &'a [Move],
    pub shop: &'a Shop,
    pub bodies: &'a Bodies,
    pub cloud: &'a Cloud,
    pub wanted: Wanted,
}

/// Looks at the whole path.
pub(super) fn search(world: &World<'_>) -> Found {
    let count = world.cloud.points.len();
    let stock = world.wanted.stock_mm;
    let mut found = Found {
        gouge: NONE,
        rapid: NONE,
        holder: NONE,
        heights: vec![stock; count],
        bounds: vec![stock; count],
        poses: 0,
        closest_mm: f64::INFINITY,
    };
    let chunks: Vec<&[Move]> = world.moves.chunks(CHUNK).collect();
    let budget = (world.wanted.most_poses / chunks.len().max(1)).max(1);
    let looks =
        chunks.chunks(BATCH).map(|batch| (true, batch)).chain(chunks.chunks(BATCH).map(|b| (false, b)));
    for (first, batch) in looks {
        let before = &found;
        // Nothing over a cell is higher than this any more.
        let highest = |c: &Cell| before.heights[c.range[0]..c.range[1]].iter().copied().fold(0.0, f64::max);
        let margins: Vec<f64> =
            world.cloud.cells.iter().map(|c| if c.machined { highest(c) } else { 0.0 }).collect();
        let all: Vec<Found> = batch
            .par_iter()
            .map(|moves| {
                let found = Found { poses: 0, ..before.clone() };
                let (ends, list, margins) = (Vec::new(), Vec::new(), &margins);
                let mut look = Look { world, budget, first, margins, found, ends, list };
                look.chunk(moves);
                look.found
            })
            .collect();
        for one in all {
            found.gouge.merge(&one.gouge);
            found.rapid.merge(&one.rapid);
            found.holder.merge(&one.holder);
            found.poses += one.poses;
            found.closest_mm = found.closest_mm.min(one.closest_mm);
            for (to, from) in found.heights.iter_mut().zip(&one.heights) {
                *to = to.min(*from);
            }
            for (to, from) in found.bounds.iter_mut().zip(&one.bounds) {
                *to = to.min(*from);
            }
        }
    }
    found
}

/// How far the tool may be from a frozen pose: the tip, and per mm above it.
#[derive(Clone, Copy, Debug, Default)]
struct Range {
    tip: f64,
    per_mm: f64,
}

impl Range {
    fn take(&mut self, middle: &Pose, pose: &Pose) {
        self.tip = self.tip.max(norm(sub(pose.tip, middle.tip)));
        self.per_mm = self.per_mm.max(norm(sub(pose.axis, middle.axis)));
    }

    fn with(self, bend: Bend, share: f64) -> Self {
        Self { tip: self.tip + share * bend.tip, per_mm: self.per_mm + share * bend.per_mm }
    }

    fn at(&self, lever: f64) -> f64 {
        self.tip + lever * self.per_mm
    }
}

/// A move with its ends.
struct Ends {
    poses: [Pose; 2],
    bend: Bend,
}

/// A stretch of a move.
struct Stretch<'a> {
    this: &'a Move,
    bend: Bend,
    share: [f64; 2],
    ends: [Pose; 2],
}

struct Look<'a> {
    world: &'a World<'a>,
    budget: usize,
    /// Only middles of moves.
    first: bool,
    /// By cell, from how high over its points a pose counts.
    margins: &'a [f64],
    found: Found,
    ends: Vec<Ends>,
    /// Cells, then points, that are still asked about: a stack of lists.
    list: Vec<u32>,
}

impl Look<'_> {
    fn chunk(&mut self, moves: &[Move]) {
        let shop = self.world.shop;
        let ends = |m: &Move| Ends { poses: [m.pose(shop, 0.0), m.pose(shop, 1.0)], bend: m.bend(shop) };
        self.ends = moves.iter().map(ends).collect();
        // The cloud has refused what does not fit.
        self.list = (0..self.world.cloud.cells.len()).filter_map(|k| u32::try_from(k).ok()).collect();
        let all = [0, self.list.len()];
        self.block(moves, [0, moves.len()], all);
    }

    /// Moves `of[0]..of[1]` against cells of the list.
    fn block(&mut self, moves: &[Move], of: [usize; 2], cells: [usize; 2]) {
        let [from, to] = of;
        let middle = (from + to) / 2;
        let single = to - from == 1;
        let shop = self.world.shop;
        let pose = if single { moves[from].pose(shop, 0.5) } else { self.ends[middle].poses[0] };
        let (mut range, mut bend) = (Range::default(), Bend::default());
        for e in &self.ends[from..to] {
            e.poses.iter().for_each(|p| range.take(&pose, p));
            bend = Bend { tip: bend.tip.max(e.bend.tip), per_mm: bend.per_mm.max(e.bend.per_mm) };
        }
        // One move is seen from its own middle, of several all may leave their chords.
        let range = range.with(bend, if single { 1.0 / 32.0 } else { 1.0 / 8.0 });
        let all_rapid = moves[from..to].iter().all(|m| m.rapid);
        let begin = self.list.len();
        for k in cells[0]..cells[1] {
            let at = self.list[k];
            let cell = &self.world.cloud.cells[at as usize];
            let (rho, z, _, _) = local(&pose, cell.centre);
            let near = self.world.bodies.cutter(rho, z).min(self.world.bodies.holder(rho, z));
            let margin = if all_rapid { 0.0 } else { self.margins[at as usize] };
            let lever = rho.hypot(z) + cell.radius;
            if near <= cell.radius + range.at(lever) + margin {
                if single {
                    // Points where there were cells.
                    let [first, end] = cell.range;
                    self.list.extend((first..end).filter_map(|p| u32::try_from(p).ok()));
                } else {
                    self.list.push(at);
                }
            }
        }
        let kept = [begin, self.list.len()];
        if kept[1] > kept[0] {
            if single {
                let (bend, ends) = (self.ends[from].bend, self.ends[from].poses);
                self.stretch(&Stretch { this: &moves[from], bend, share: [0.0, 1.0], ends }, kept);
            } else {
                self.block(moves, [from, middle], kept);
                self.block(moves, [middle, to], kept);
            }
        }
        self.list.truncate(begin);
    }

    /// A stretch of a move against points of the list.
    fn stretch(&mut self, s: &Stretch<'_>, points: [usize; 2]) {
        let share = 0.5 * (s.share[0] + s.share[1]);
        let pose = s.this.pose(self.world.shop, share);
        let width = s.share[1] - s.share[0];
        let around = Around::of(pose, &s.ends, s.bend, width * width / 32.0);
        if around.range.tip > 0.0 {
            // From the middle of a stretch to that of the next.
            self.found.closest_mm = self.found.closest_mm.min(2.0 * around.range.tip);
        }
        let more = self.found.poses < self.budget && width > NARROWEST;
        self.found.poses += 1;
        let begin = self.list.len();
        for k in points[0]..points[1] {
            let point = self.list[k];
            if self.ask(s.this, &around, more, point as usize) {
                self.list.push(point);
            }
        }
        if self.first {
            self.list.truncate(begin);
            return;
        }
        let kept = [begin, self.list.len()];
        if kept[1] > kept[0] {
            let Stretch { this, bend, .. } = *s;
            let halves = [([s.share[0], share], [s.ends[0], pose]), ([share, s.share[1]], [pose, s.ends[1]])];
            for (share, ends) in halves {
                self.stretch(&Stretch { this, bend, share, ends }, kept);
            }
        }
        self.list.truncate(begin);
    }

    /// Asks about a point at a frozen pose; true where poses nearby have to be asked too.
    fn ask(&mut self, this: &Move, around: &Around, more: bool, index: usize) -> bool {
        let (bodies, wanted) = (self.world.bodies, &self.world.wanted);
        let (p, pose) = (&self.world.cloud.points[index], &around.pose);
        let (rho, z, across, away) = local(pose, p.at);
        let half = around.range.at(rho.hypot(z));
        let (near, holder) = (bodies.near(rho, z), bodies.holder(rho, z));
        let found = &mut self.found;
        let mut again = false;
        let own = if this.rapid { &mut found.rapid } else { &mut found.gouge };
        for (worst, distance, with_plane) in [(own, near.distance, true), (&mut found.holder, holder, false)]
        {
            if -distance > worst.mm {
                (worst.mm, worst.point, worst.line) = (-distance, index, this.line);
            }
            let enough = worst.mm.max(0.0) + wanted.slack_mm + distance;
            if half <= enough || self.first {
                continue;
            }
            let nearer =
                if with_plane { around.nearer(sub(p.at, pose.tip), across, rho, &near) } else { half };
            if nearer > enough {
                again |= more;
                if !more {
                    worst.open_mm = worst.open_mm.max(nearer - distance);
                }
            }
        }
        if this.rapid || !p.machined {
            return again;
        }
        let lowest = &mut found.heights[index];
        // The distance is a lower bound of the height.
        if near.distance - half >= *lowest {
            return again;
        }
        let along = dot(p.normal, pose.axis);
        let way = [along, (1.0 - along * along).max(0.0)];
        let slope = dot(across, p.normal);
        let entry = |grown: f64, limit: f64| bodies.entry([z, away], way, slope, (grown, limit));
        if near.distance < *lowest
            && let Some(height) = entry(0.0, *lowest)
        {
            *lowest = height;
        }
        let limit = *lowest - wanted.slack_mm;
        if self.first || limit <= 0.0 {
            return again;
        }
        // The plane at the height that would have to be undercut; what lies lower must not be nearer to it.
        let at = ahead(p.at, limit, p.normal);
        let (rho, z, across, _) = local(pose, at);
        let high = bodies.near(rho, z);
        let towards = if rho > 0.0 { dot(across, p.normal) / rho } else { 0.0 };
        if high.by_rho * towards + high.by_z * along <= 0.0 {
            let nearer = around.nearer(sub(at, pose.tip), across, rho, &high) + around.range.per_mm * limit;
            if nearer <= high.distance {
                return again;
            }
        }
        if half > wanted.slack_mm && more {
            return true;
        }
        // A tool moved by the slack is as good as this one.
        if let Some(height) = entry(half, limit) {
            found.bounds[index] = found.bounds[index].min(height);
        }
        again
    }
}

/// A frozen pose with those around that it stands for.
struct Around {
    pose: Pose,
    range: Range,
    /// Of both ends: from their tip to this one, and this axis crossed with theirs.
    ends: [(V, V); 2],
    bulge: Range,
}

impl Around {
    fn of(pose: Pose, ends: &[Pose; 2], bend: Bend, share: f64) -> Self {
        let mut range = Range::default();
        ends.iter().for_each(|p| range.take(&pose, p));
        let bulge = Range::default().with(bend, share);
        let ends = [ends[0], ends[1]].map(|e| (sub(e.tip, pose.tip), cross(pose.axis, e.axis)));
        Self { pose, range: range.with(bend, share), ends, bulge }
    }

    /// How much nearer the cutter can be at another pose to a point `d` from the tip, `across` the axis by `rho`.
    fn nearer(&self, d: V, across: V, rho: f64, near: &Near) -> f64 {
        let lever = norm(d);
        let sideways = if rho > 1e-12 { near.by_rho / rho } else { 0.0 };
        let g = ahead(across.map(|c| sideways * c), near.by_z, self.pose.axis);
        let moment = cross(d, g);
        let linear = self.ends.iter().map(|(e, u)| dot(g, *e) + dot(*u, moment)).fold(0.0, f64::max);
        let (e, b) = (self.range.tip, self.range.per_mm);
        linear + self.bulge.at(lever) + b * e + 0.5 * b * b * (lever + e)
    }
}

/// Distance from the axis, height above the tip, the way from the axis, and its square.
fn local(pose: &Pose, at: V) -> (f64, f64, V, f64) {
    let d = sub(at, pose.tip);
    let z = dot(d, pose.axis);
    let across = ahead(d, -z, pose.axis);
    let square = dot(across, across);
    (square.sqrt(), z, across, square)
}
