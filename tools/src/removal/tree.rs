//! A tree over the pieces of all motions, grouped by place and axis, to reject many of them at once.
//!
//! A node knows the box of its tool tips and a mean axis from which none of its axes deviates by more than
//! `swing`. For a fixed axis the distance of a point c to the body, seen as a function of the tip, is convex;
//! a tangent at any tip of the box bounds it over the box. Turning the axis by `swing` about the tip moves
//! the body past c by at most `swing |c - tip|`.

use super::body::Body;
use super::job::{Job, JobError, Swept};
use super::piece::{Piece, moving, pieces};
use super::target::Target;
use crate::pose::Pose;
use osculate_geom::{Box3, Point3, Unit3, Vec3};
use std::ops::Range;

/// Pieces in a leaf: few next to the hundred or so that come near a group of samples.
const LEAF: usize = 4;
/// How far up the tool, in radii of the cutter, a point moves by what a turn of the axis counts for when motions are grouped. Passes to
/// and fro that lean to two sides are told apart from this many radii on; 1 and 16 make more nodes to be looked at.
const ARM_RADII: f64 = 4.0;

struct Node {
    tips: Box3,
    axis: Unit3,
    /// Largest angle between an axis of the node and `axis`, rad.
    swing: f64,
    /// Whether any of its motions is a rapid.
    rapid: bool,
    /// Range of `order` in a leaf.
    leaf: Option<Range<usize>>,
    /// The node that follows this one's whole subtree.
    next: usize,
}

/// All motions in pieces, and the tree over them.
pub(super) struct Ways {
    pub pieces: Vec<Piece>,
    /// The motions of each tool.
    trees: Vec<Tree>,
}

impl Ways {
    /// Of tools one after the other, which take over at the motions `firsts`; the bodies in their order, of each the cutter first.
    pub fn of(
        motions: &[Swept],
        bodies: &[Body<'_>],
        firsts: impl Iterator<Item = usize>,
    ) -> Result<Self, JobError> {
        let reach =
            |body: &Body<'_>| (body.above_mm + body.cutter.length_mm()).hypot(body.cutter.radius_mm());
        let pieces = pieces(motions, bodies.iter().map(reach).fold(0.0, f64::max))?;
        let mut starts = vec![0];
        for first in firsts {
            if starts.last().is_some_and(|before| *before > first) {
                return Err(JobError::Changes { tool: starts.len(), first });
            }
            starts.push(first);
        }
        let mut trees = Vec::with_capacity(starts.len());
        for (tool, start) in starts.iter().enumerate() {
            let own = bodies.partition_point(|b| b.tool < tool)..bodies.partition_point(|b| b.tool <= tool);
            let end = starts.get(tool + 1).copied().unwrap_or(usize::MAX);
            let at = |motion: usize| pieces.partition_point(|p| (p.motion as usize) < motion);
            let radius_mm = bodies.get(own.start).map_or(0.0, |b| b.cutter.radius_mm());
            trees.push(Tree::new(motions, &pieces, at(*start)..at(end), own, ARM_RADII * radius_mm));
        }
        Ok(Self { pieces, trees })
    }

    /// Of a job.
    pub fn of_job(job: &Job<'_>) -> Result<Self, JobError> {
        Self::of(job.motions, &Body::all(job), job.changes.iter().map(|c| c.first))
    }

    /// How many tools there are, one after the other.
    pub fn tools(&self) -> usize {
        self.trees.len()
    }

    /// Calls `found` with every piece that may bring a body of its tool to the target, with the body and its place among `bodies`,
    /// which are those of all tools.
    pub fn near<'b>(
        &self,
        bodies: &[Body<'b>],
        target: &Target,
        which: Which,
        mut found: impl FnMut(u32, &Body<'b>, usize),
    ) {
        for tree in &self.trees {
            tree.near(bodies, target, which, &mut found);
        }
    }

    /// The same of one of the tools.
    pub fn near_of<'b>(
        &self,
        tool: usize,
        bodies: &[Body<'b>],
        (target, which): (&Target, Which),
        mut found: impl FnMut(u32, &Body<'b>, usize),
    ) {
        self.trees[tool].near(bodies, target, which, &mut found);
    }
}

/// The tree over the motions of a tool, nodes in preorder.
struct Tree {
    /// Its bodies among those of all tools.
    own: Range<usize>,
    nodes: Vec<Node>,
    /// Indices of pieces, leaf by leaf.
    order: Vec<u32>,
}

/// The poses of the pieces while the tree is built.
struct Poses {
    ends: Vec<[Pose; 2]>,
    /// Middles of tips and axes; the axes scaled by `arm_mm` to compare with the tips.
    middles: Vec<[f64; 6]>,
    rapid: Vec<bool>,
}

/// Which pieces are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// Every one.
    All,
    /// The cutter's in feed motions.
    Cutting,
    /// Rapids, and bodies that intrude in any motion; a leaf with one of them gives the others as well.
    Intruding,
}

impl Tree {
    /// The tree over a range of pieces; turning an axis counts as much as moving a tip by the turn times `arm_mm`.
    fn new(motions: &[Swept], pieces: &[Piece], range: Range<usize>, own: Range<usize>, arm_mm: f64) -> Self {
        let (first, pieces) = (range.start as u32, &pieces[range]);
        let ends: Vec<[Pose; 2]> =
            pieces.iter().map(|p| p.range.map(|t| moving(&motions[p.motion as usize], t).pose)).collect();
        let middle = |[a, b]: &[Pose; 2]| {
            let tip = 0.5 * (a.tip.coords + b.tip.coords);
            let axis = 0.5 * arm_mm * (a.axis.into_inner() + b.axis.into_inner());
            [tip.x, tip.y, tip.z, axis.x, axis.y, axis.z]
        };
        let rapid = pieces.iter().map(|p| motions[p.motion as usize].rapid).collect();
        let poses = Poses { middles: ends.iter().map(middle).collect(), ends, rapid };
        // There are fewer pieces than u32 counts: `pieces` refuses more.
        let mut order: Vec<u32> = (0..pieces.len() as u32).collect();
        let mut nodes = Vec::with_capacity(pieces.len() / LEAF * 4 + 1);
        if !order.is_empty() {
            add(&mut nodes, &poses, &mut order, 0);
        }
        order.iter_mut().for_each(|k| *k += first);
        Self { own, nodes, order }
    }

    /// Calls `found` with every piece that may bring a body to the target, and with the body, leaf by leaf.
    fn near<'b>(
        &self,
        bodies: &[Body<'b>],
        target: &Target,
        which: Which,
        found: &mut impl FnMut(u32, &Body<'b>, usize),
    ) {
        let mut k = 0;
        while let Some(node) = self.nodes.get(k) {
            let mut any = false;
            for index in self.own.clone() {
                let body = &bodies[index];
                let asked = match which {
                    Which::All => true,
                    Which::Cutting => body.cuts(),
                    Which::Intruding => body.intrudes || node.rapid,
                };
                if !asked || node.rejects(body, target) {
                    continue;
                }
                any = true;
                for piece in &self.order[node.leaf.clone().unwrap_or(0..0)] {
                    found(*piece, body, index);
                }
            }
            k = if any { k + 1 } else { node.next };
        }
    }
}

/// Adds the subtree of the pieces in `order`, which begins at `start` of the whole order; the box of its axes.
fn add(nodes: &mut Vec<Node>, poses: &Poses, order: &mut [u32], start: usize) -> Box3 {
    let me = nodes.len();
    let leaf = (order.len() <= LEAF).then(|| start..start + order.len());
    nodes.push(Node {
        tips: Box3::empty(),
        axis: Vec3::z_axis(),
        swing: 0.0,
        rapid: false,
        leaf: leaf.clone(),
        next: 0,
    });
    let (rapid, tips, axes) = if leaf.is_some() {
        let ends = || order.iter().flat_map(|k| &poses.ends[*k as usize]);
        let rapid = order.iter().any(|k| poses.rapid[*k as usize]);
        let axes: Vec<Point3> = ends().map(|p| Point3::from(p.axis.into_inner())).collect();
        (rapid, Box3::around(ends().map(|p| &p.tip)), Box3::around(&axes))
    } else {
        let middle = order.len() / 2;
        let widest = widest(poses, order);
        let key = |k: &u32| poses.middles[*k as usize][widest];
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let (low, high) = order.split_at_mut(middle);
        let low = add(nodes, poses, low, start);
        let after = nodes.len();
        let high = add(nodes, poses, high, start + middle);
        let (a, b) = (&nodes[me + 1], &nodes[after]);
        (a.rapid || b.rapid, a.tips.union(&b.tips), low.union(&high))
    };
    let ends = || order.iter().flat_map(|k| &poses.ends[*k as usize]).map(|p| p.axis);
    // Passes to and fro lean to two sides, and of either there may be more: the middle between both is what no axis is far from.
    // Axes that cancel: any of them; the swing tells.
    let axis =
        Unit3::try_new(axes.centre().coords, 1e-3).or_else(|| ends().next()).unwrap_or_else(Vec3::z_axis);
    // From the axes themselves: bounds from those of the parts would add up over the levels.
    let square = ends().map(|a| (a.into_inner() - axis.into_inner()).norm_squared()).fold(0.0, f64::max);
    // Angle from the chord: no cancellation near zero. Rounded up by more than asin's error.
    let mut swing = 2.0 * (0.5 * square.sqrt()).min(1.0).asin() + 1e-15;
    // Between two axes the interpolated one stays in the cap around both only below a right angle.
    if swing > std::f64::consts::FRAC_PI_2 {
        swing = std::f64::consts::PI;
    }
    let next = nodes.len();
    let node = &mut nodes[me];
    (node.tips, node.axis, node.swing, node.next) = (tips, axis, swing, next);
    node.rapid = rapid;
    axes
}

/// The coordinate of the middles with the widest range.
fn widest(poses: &Poses, order: &[u32]) -> usize {
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 6];
    for k in order {
        for (r, x) in range.iter_mut().zip(poses.middles[*k as usize]) {
            *r = [r[0].min(x), r[1].max(x)];
        }
    }
    let width = |k: &usize| range[*k][1] - range[*k][0];
    (0..6).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0)
}

impl Node {
    fn rejects(&self, body: &Body<'_>, target: &Target) -> bool {
        let centre = target.centre;
        let middle = self.tips.centre();
        let half = (self.tips.max - self.tips.min) * 0.5;
        let farthest = (centre - middle).norm() + half.norm() + target.radius;
        let need = self.swing * farthest + 1e-12 * (1.0 + farthest);
        // The tip next to the point is the best guess for tools that work with their end; the middle for the
        // rest.
        let beside = Point3::from(centre.coords.sup(&self.tips.min.coords).inf(&self.tips.max.coords));
        [beside, middle].iter().any(|tip| {
            let near = body.near(&(centre - tip), &self.axis);
            let g = near.gradient;
            let fall = g.dot(&(middle - tip)) + g.abs().dot(&half) + target.fall(&g);
            near.distance - fall > need
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, CutterSpec};

    /// Passes to and fro that lean to either side, 0.5 mm apart.
    fn passes(count: u32) -> Vec<Swept> {
        let pose = |x: f64, y: f64, lean: f64| Pose {
            tip: Point3::new(x, y, 0.002 * x * x - 0.001 * y * y),
            axis: Unit3::new_normalize(Vec3::new(lean, 0.1, 1.0)),
        };
        let pass = |k: u32| {
            let (y, lean) = (0.5 * f64::from(k), if k.is_multiple_of(2) { 0.25 } else { -0.25 });
            let at = move |i: u32| 0.25 * f64::from(if k.is_multiple_of(2) { i } else { 4 * count - i });
            (0..4 * count).map(move |i| Swept {
                from: pose(at(i), y, lean),
                to: pose(at(i + 1), y, lean * (1.0 + 0.01 * f64::from(i % 3))),
                rapid: i % 50 == 49,
                block: k,
            })
        };
        (0..2 * count).flat_map(pass).collect()
    }

    fn cutter(diameter_mm: f64, corner_radius_mm: f64) -> Cutter {
        Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 30.0 }).unwrap()
    }

    /// Every piece that holds a corner of the target at some of its instants is found, whatever is asked for.
    #[test]
    fn what_comes_near_is_found() {
        let motions = passes(12);
        let (tool, holder) = (cutter(6.0, 1.0), cutter(20.0, 0.0));
        let bodies = [
            Body { cutter: &tool, above_mm: 0.0, tool: 0, intrudes: false },
            Body { cutter: &holder, above_mm: tool.length_mm(), tool: 0, intrudes: true },
        ];
        let ways = Ways::of(&motions, &bodies, std::iter::empty()).unwrap();
        let mut met = [0; 3];
        for k in 0..60 {
            let (x, y) = (f64::from(k * 7 % 13), f64::from(k * 5 % 12));
            // From under the part up to the holder.
            let centre = Point3::new(x, y, -1.0 + 0.6 * f64::from(k));
            let target = Target::upright(centre, &Vec3::new(0.3, 0.2, 0.1));
            for (w, which) in [Which::All, Which::Cutting, Which::Intruding].into_iter().enumerate() {
                let mut found = Vec::new();
                ways.near(&bodies, &target, which, |piece, _, index| found.push((piece, index)));
                let every = ways.pieces.iter().zip(0u32..).flat_map(|p| [(p, 0), (p, 1)]);
                for ((piece, p), index) in every {
                    let rapid = motions[piece.motion as usize].rapid;
                    let asked = match which {
                        Which::All => true,
                        Which::Cutting => index == 0 && !rapid,
                        Which::Intruding => index == 1 || rapid,
                    };
                    let holds = |t: f64| {
                        let pose = moving(&motions[piece.motion as usize], t).pose;
                        let inside =
                            |c: &Point3| bodies[index].near(&(c - pose.tip), &pose.axis).distance <= 0.0;
                        target.corners().iter().any(inside)
                    };
                    let [lo, hi] = piece.range;
                    if asked && [lo, 0.5 * (lo + hi), hi].into_iter().any(holds) {
                        met[w] += 1;
                        assert!(found.contains(&(p, index)), "{which:?} {p} {index}");
                    }
                }
            }
        }
        assert!(met.iter().all(|m| *m > 100), "{met:?}");
    }

    /// How far axes swing is known as well of all motions as of few: it does not add up from level to level, and what a search
    /// looks at stays next to what it finds however long the path is.
    #[test]
    fn searches_of_long_paths_look_at_little() {
        let tool = cutter(6.0, 1.0);
        let bodies = [Body { cutter: &tool, above_mm: 0.0, tool: 0, intrudes: false }];
        // The path is sixteen times as long, what is around the target the same.
        let looked_at = |count: u32| {
            let ways = Ways::of(&passes(count), &bodies, std::iter::empty()).unwrap();
            let tree = &ways.trees[0];
            let widest = 0.26f64.atan2(1.0);
            assert!(tree.nodes.iter().all(|n| n.swing <= 1.1 * widest), "{}", tree.nodes[0].swing);
            let target = Target::upright(Point3::new(5.0, 5.0, 0.0), &Vec3::new(0.2, 0.2, 0.02));
            let (mut k, mut nodes) = (0, 0);
            while let Some(node) = tree.nodes.get(k) {
                nodes += 1;
                k = if node.rejects(&bodies[0], &target) { node.next } else { k + 1 };
            }
            nodes
        };
        let [short, long] = [20, 80].map(looked_at);
        assert!(long < short + short / 2, "{short} {long}");
    }
}
