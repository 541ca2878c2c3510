//! The deepest and the lowest over all poses of a path, by frozen poses that lie as close as it takes.
//!
//! How deep a point is in the tool changes by no more than what the tool's place nearest to it moves. Over a stretch of a move
//! with its middle pose frozen, that is
//!
//! ```text
//! half = max |tip - middle tip| + lever max |axis - middle axis| + (tip'' + lever axis'') d^2 / 32
//! ```
//!
//! over both ends of the stretch, lever the point's distance from the tip; the last term is what the way between the poses leaves
//! its chord by, d the stretch's share of the move. A point less deep than the deepest so far by `half - slack` or more cannot
//! become the deepest by more than the slack, and is dropped. What stands over a point is cut no lower than by the tool grown by
//! `half`: where that comes no lower than the lowest so far less the slack, the point is dropped too. For all that are left the
//! stretch is halved. So near a pass of a corner of radius r poses end up some `2 slack` apart within `sqrt(2 r slack)` of the
//! contact, and frozen poses `s` apart with nothing between would leave the ridge `r - sqrt(r^2 - s^2 / 4)`.
//!
//! Chunks of moves are looked at by themselves and merged in their order, a batch at a time, so that threads do not matter.

use rayon::prelude::*;

use super::kinematics::Pose;
use super::moves::{Bend, Move, Shop};
use super::points::Cloud;
use super::tool::Bodies;
use super::vector::{V, ahead, dot, norm, sub};

/// Moves of a chunk, and chunks between two merges: what one batch has found saves work in the next.
const CHUNK: usize = 256;
const BATCH: usize = 16;

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
    for batch in chunks.chunks(BATCH) {
        let before = &found;
        let all: Vec<Found> = batch
            .par_iter()
            .map(|moves| {
                let start = Found { poses: 0, ..before.clone() };
                let mut look = Look { world, budget, found: start, ends: Vec::new(), list: Vec::new() };
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
            let margin = if cell.machined && !all_rapid { self.world.wanted.stock_mm } else { 0.0 };
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
        let mut range = Range::default();
        s.ends.iter().for_each(|p| range.take(&pose, p));
        self.found.closest_mm = self.found.closest_mm.min(range.tip);
        let width = s.share[1] - s.share[0];
        let range = range.with(s.bend, width * width / 32.0);
        let more = self.found.poses < self.budget;
        self.found.poses += 1;
        let begin = self.list.len();
        for k in points[0]..points[1] {
            let point = self.list[k];
            if self.ask(s.this, &pose, (range, more), point as usize) {
                self.list.push(point);
            }
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
    fn ask(&mut self, this: &Move, pose: &Pose, (range, more): (Range, bool), index: usize) -> bool {
        let (bodies, wanted) = (self.world.bodies, &self.world.wanted);
        let p = &self.world.cloud.points[index];
        let (rho, z, across, away) = local(pose, p.at);
        let half = range.at(rho.hypot(z));
        let (cutter, holder) = (bodies.cutter(rho, z), bodies.holder(rho, z));
        let found = &mut self.found;
        let mut again = false;
        let own = if this.rapid { &mut found.rapid } else { &mut found.gouge };
        for (worst, distance) in [(own, cutter), (&mut found.holder, holder)] {
            if -distance > worst.mm {
                (worst.mm, worst.point, worst.line) = (-distance, index, this.line);
            }
            if half - distance > worst.mm.max(0.0) + wanted.slack_mm {
                again |= more;
                if !more {
                    worst.open_mm = worst.open_mm.max(half - distance);
                }
            }
        }
        if this.rapid || !p.machined {
            return again;
        }
        let lowest = &mut found.heights[index];
        // The distance is a lower bound of the height.
        if cutter - half >= *lowest {
            return again;
        }
        let along = dot(p.normal, pose.axis);
        let way = [along, (1.0 - along * along).max(0.0)];
        let slope = dot(across, p.normal);
        let entry = |grown: f64, limit: f64| bodies.entry([z, away], way, slope, (grown, limit));
        if let Some(height) = entry(0.0, *lowest) {
            *lowest = height;
        }
        if let Some(height) = entry(half, *lowest - wanted.slack_mm) {
            // A tool moved by the slack is as good as this one.
            if half > wanted.slack_mm && more {
                return true;
            }
            found.bounds[index] = found.bounds[index].min(height);
        }
        again
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
