//! A tree over the pieces of all motions, grouped by place and axis, to reject many of them at once.
//!
//! A node knows the box of its tool tips and a mean axis from which none of its axes deviates by more than
//! `swing`. For a fixed axis the distance of a point c to the body, seen as a function of the tip, is convex;
//! a tangent at any tip of the box bounds it over the box. Turning the axis by `swing` about the tip moves
//! the body past c by at most `swing |c - tip|`.

use super::Swept;
use super::body::Body;
use super::piece::{Piece, moving};
use super::target::Target;
use crate::pose::Pose;
use osculate_geom::{Box3, Point3, Unit3, Vec3};

/// Pieces in a leaf: few next to the hundred or so that come near a group of samples.
const LEAF: usize = 4;

struct Node {
    tips: Box3,
    axis: Unit3,
    /// Largest angle between an axis of the node and `axis`, rad.
    swing: f64,
    /// Whether any of its motions is a rapid.
    rapid: bool,
    /// Range of `order` in a leaf.
    leaf: Option<std::ops::Range<usize>>,
    /// The node that follows this one's whole subtree.
    next: usize,
}

/// The tree, nodes in preorder.
pub(super) struct Tree {
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
    /// The first body's in feed motions.
    Cutting,
    /// Rapids, and bodies other than the first in any motion; a leaf with one of them gives the others as well.
    Intruding,
}

impl Tree {
    /// The tree; turning an axis counts as much as moving a tip by the turn times `arm_mm`.
    pub fn new(motions: &[Swept], pieces: &[Piece], arm_mm: f64) -> Self {
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
        Self { nodes, order }
    }

    /// Calls `found` with every piece that may bring a body to the target, and with the body, leaf by leaf.
    pub fn near<'b>(
        &self,
        bodies: &[Body<'b>],
        target: &Target,
        which: Which,
        mut found: impl FnMut(u32, &Body<'b>, usize),
    ) {
        let mut k = 0;
        while let Some(node) = self.nodes.get(k) {
            let mut any = false;
            for (index, body) in bodies.iter().enumerate() {
                let asked = match which {
                    Which::All => true,
                    Which::Cutting => index == 0,
                    Which::Intruding => index != 0 || node.rapid,
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

/// Adds the subtree of the pieces in `order`, which begins at `start` of the whole order.
fn add(nodes: &mut Vec<Node>, poses: &Poses, order: &mut [u32], start: usize) -> usize {
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
    let rapid;
    let (tips, axes): (Box3, Vec<(Unit3, f64)>) = if leaf.is_some() {
        rapid = order.iter().any(|k| poses.rapid[*k as usize]);
        let ends = || order.iter().flat_map(|k| &poses.ends[*k as usize]);
        (Box3::around(ends().map(|p| &p.tip)), ends().map(|p| (p.axis, 0.0)).collect())
    } else {
        let middle = order.len() / 2;
        let widest = widest(poses, order);
        let key = |k: &u32| poses.middles[*k as usize][widest];
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let (low, high) = order.split_at_mut(middle);
        let a = add(nodes, poses, low, start);
        let b = add(nodes, poses, high, start + middle);
        let (a, b) = (&nodes[a], &nodes[b]);
        rapid = a.rapid || b.rapid;
        (a.tips.union(&b.tips), vec![(a.axis, a.swing), (b.axis, b.swing)])
    };
    let sum: Vec3 = axes.iter().map(|(a, _)| a.into_inner()).sum();
    // Axes that cancel: any of them; the swing tells.
    let axis = Unit3::try_new(sum, 1e-3).unwrap_or(axes[0].0);
    let mut swing = 0.0f64;
    for (a, own) in &axes {
        // Angle from the chord: no cancellation near zero. Rounded up by more than asin's error.
        let chord = (a.into_inner() - axis.into_inner()).norm();
        swing = swing.max(own + 2.0 * (0.5 * chord).min(1.0).asin() + 1e-15);
    }
    // Between two axes the interpolated one stays in the cap around both only below a right angle.
    if swing > std::f64::consts::FRAC_PI_2 {
        swing = std::f64::consts::PI;
    }
    let next = nodes.len();
    let node = &mut nodes[me];
    (node.tips, node.axis, node.swing, node.next) = (tips, axis, swing, next);
    node.rapid = rapid;
    me
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
