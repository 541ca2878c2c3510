//! The axes at the nodes that take the least time: started from the axis that most places can share, then moved node by node.
//!
//! The time is the strips' `dA / (w f)` and, along the passes, what the joints take longer for a turn than the feed does for the way;
//! a share of it for each turn keeps the field smooth, and another keeps axes off the rim of what is possible. A node moves to whichever
//! of a few axes around its own takes least, with steps that halve; an axis that is not possible is never taken. What a
//! machine takes for a turn near its poles is great for small turns: the field goes around them by itself.

use super::joints::Joints;
use super::lattice::{Edge, Lattice, Node};
use crate::width::planar_width_mm;
use osculate_geom::{Unit3, Vec3, any_perpendicular};
use osculate_tools::reach::{Bits, Directions};
use osculate_tools::{Cutter, Lean};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Steps of the rim: directions nearer to what is not possible than so many cost more.
const RIM: u8 = 3;
/// Share of a place's time that each step nearer to the rim costs.
const AT_RIM: f64 = 0.03;
/// Share of the whole time that a turn by a radian over a square face costs beyond what the joints take.
const TURN: f64 = 0.1;
/// Starts that are tried, and the least angle between two of them, rad.
const STARTS: usize = 8;
const APART: f64 = 0.35;
/// Steps of nodes, rad, and most sweeps with one of them.
const STEPS: [f64; 6] = [0.16, 0.08, 0.04, 0.02, 0.01, 0.005];
/// Steps after which only the best start goes on.
const COARSE: usize = 2;
const SWEEPS: usize = 16;
/// Axes tried around a node's own.
const AROUND: usize = 6;
/// A sweep that saves no more than this share of the time is the last with its step.
const SETTLED: f64 = 1e-5;
/// Edges of cells that are much longer one way than the other count as so long at most.
const LONGEST: f64 = 10.0;

/// What a search goes by.
pub(super) struct Asked<'a> {
    pub cutter: &'a Cutter,
    pub scallop_mm: f64,
    pub feed_mm_min: f64,
    pub directions: &'a Directions,
    pub joints: &'a dyn Joints,
    /// Whether the joints reach but a line of axes, on which all stay.
    pub on_line: bool,
}

/// The possible axes of a node, each with how far from the rim it is; empty where none is, or none is asked for.
pub(super) type Depths = Vec<u8>;

/// How far each possible direction is from the rim of the possible ones, up to [`RIM`].
pub(super) fn depths(directions: &Directions, bits: &Bits) -> Depths {
    let all = directions.all().len();
    if bits.is_empty() {
        return Vec::new();
    }
    let mut out: Vec<u8> = (0..all).map(|k| u8::from(bits.contains(k))).collect();
    for step in 1..RIM {
        let deeper: Vec<usize> = (0..all)
            .filter(|k| out[*k] == step && directions.neighbours(*k).iter().all(|n| out[*n as usize] >= step))
            .collect();
        for k in deeper {
            out[k] = step + 1;
        }
    }
    out
}

/// The search over a lattice.
pub(super) struct Search<'a> {
    asked: &'a Asked<'a>,
    lattice: &'a Lattice,
    depths: &'a [Depths],
    /// Time that a turn costs, by the square of its angle, min.
    turn_min: f64,
    /// Widths by which passes over edges are counted, mm.
    width_mm: f64,
}

impl<'a> Search<'a> {
    pub fn new(asked: &'a Asked<'a>, lattice: &'a Lattice, depths: &'a [Depths]) -> Self {
        let widths: Vec<f64> = lattice
            .nodes
            .iter()
            .filter(|n| n.area_mm2 > 0.0)
            .filter_map(|n| Some(width_mm(asked, n, &leant(&n.normal?))))
            .collect();
        let width_mm = widths.iter().sum::<f64>() / widths.len().max(1) as f64;
        let area: f64 = lattice.nodes.iter().map(|n| n.area_mm2).sum();
        let turn_min = TURN * area / (width_mm * asked.feed_mm_min);
        Self { asked, lattice, depths, turn_min, width_mm }
    }

    /// The nearest possible direction, or the one itself where nothing is asked.
    fn nearest(&self, node: usize, axis: &Unit3) -> Unit3 {
        let depths = &self.depths[node];
        let all = self.asked.directions.all();
        let possible = depths.iter().zip(all).filter(|(d, _)| **d > 0);
        let found = possible.fold((f64::NEG_INFINITY, *axis), |best, (_, a)| {
            let cosine = a.dot(axis);
            if cosine > best.0 { (cosine, *a) } else { best }
        });
        found.1
    }

    fn node_min(&self, k: usize, axis: &Unit3) -> f64 {
        let node = &self.lattice.nodes[k];
        let depths = &self.depths[k];
        if depths.is_empty() {
            return 0.0;
        }
        let depth = depths[self.asked.directions.nearest(axis)];
        if depth == 0 {
            return f64::INFINITY;
        }
        let time = node.area_mm2 / (width_mm(self.asked, node, axis) * self.asked.feed_mm_min);
        time * (1.0 + AT_RIM * f64::from(RIM - depth))
    }

    fn edge_min(&self, edge: &Edge, a: &Unit3, b: &Unit3) -> f64 {
        let ratio = (edge.across_mm / edge.length_mm.max(f64::MIN_POSITIVE)).min(LONGEST);
        let angle = a.angle(b);
        let smooth = self.turn_min * ratio * angle * angle;
        let feed_min = edge.length_mm / self.asked.feed_mm_min;
        let late = self.asked.joints.turn_s(a, b) / 60.0 - feed_min;
        if late <= 0.0 || edge.along == 0.0 {
            return smooth;
        }
        // No more than what a rewind may take: an axis out of reach is refused by the node.
        smooth + edge.along * edge.across_mm / self.width_mm * late.min(1.0)
    }

    /// The time around a node with an axis.
    fn around_min(&self, k: usize, axis: &Unit3, axes: &[Unit3]) -> f64 {
        let own = self.node_min(k, axis);
        if own == f64::INFINITY {
            return own;
        }
        let edges = self.lattice.of_node[k].iter().map(|e| &self.lattice.edges[*e as usize]);
        own + edges
            .map(|e| {
                let other = if e.ends[0] == k { e.ends[1] } else { e.ends[0] };
                self.edge_min(e, axis, &axes[other])
            })
            .sum::<f64>()
    }

    fn total_min(&self, axes: &[Unit3]) -> f64 {
        let nodes: f64 = (0..axes.len()).map(|k| self.node_min(k, &axes[k])).sum();
        let edges = self.lattice.edges.iter().map(|e| self.edge_min(e, &axes[e.ends[0]], &axes[e.ends[1]]));
        nodes + edges.sum::<f64>()
    }

    /// Moves every node once; what that saves, min.
    fn sweep(&self, axes: &mut [Unit3], step: f64) -> f64 {
        let mut saved = 0.0;
        for k in 0..axes.len() {
            let own = axes[k];
            let now = self.around_min(k, &own, axes);
            let mut best = (now, own);
            let mut offer = |axis: Unit3| {
                let axis = if self.asked.on_line { self.asked.joints.nearest(&axis) } else { axis };
                let time = self.around_min(k, &axis, axes);
                if time < best.0 {
                    best = (time, axis);
                }
            };
            let edges = self.lattice.of_node[k].iter().map(|e| &self.lattice.edges[*e as usize]);
            let mean = edges.fold(Vec3::zeros(), |sum, e| {
                sum + axes[if e.ends[0] == k { e.ends[1] } else { e.ends[0] }].into_inner()
            });
            if let Some(mean) = Unit3::try_new(mean, 1e-9) {
                offer(mean);
            }
            let x = any_perpendicular(&own);
            let y = own.cross(&x);
            for turn in 0..AROUND {
                let (s, c) = (2.0 * PI * turn as f64 / AROUND as f64).sin_cos();
                offer(Unit3::new_normalize(own.into_inner() + (x.into_inner() * c + y * s) * step));
            }
            if best.0 < now {
                saved += if now.is_finite() { now - best.0 } else { best.0 };
                axes[k] = best.1;
            }
        }
        saved
    }

    fn relax(&self, axes: &mut [Unit3], steps: &[f64]) {
        for step in steps {
            for _ in 0..SWEEPS {
                let before = self.total_min(axes);
                if self.sweep(axes, *step) <= SETTLED * before {
                    break;
                }
            }
        }
    }

    /// Directions that most of the area can share, far enough from each other.
    fn starts(&self) -> Vec<Unit3> {
        let all = self.asked.directions.all();
        let mut shared = vec![0.0; all.len()];
        for (node, depths) in self.lattice.nodes.iter().zip(self.depths) {
            for (sum, depth) in shared.iter_mut().zip(depths) {
                *sum += node.area_mm2 * f64::from(*depth);
            }
        }
        let mut order: Vec<usize> = (0..all.len()).filter(|k| shared[*k] > 0.0).collect();
        order.sort_by(|a, b| shared[*b].total_cmp(&shared[*a]).then(a.cmp(b)));
        let mut out: Vec<Unit3> = Vec::new();
        for k in order {
            if out.len() == STARTS {
                break;
            }
            if out.iter().all(|o| o.angle(&all[k]) > APART) {
                out.push(all[k]);
            }
        }
        out
    }

    /// The best axes found; None where no place has any.
    pub fn best(&self) -> Option<Vec<Unit3>> {
        let begun: Vec<(f64, Vec<Unit3>)> = self
            .starts()
            .par_iter()
            .map(|start| {
                let mut axes: Vec<Unit3> = (0..self.depths.len()).map(|k| self.nearest(k, start)).collect();
                self.relax(&mut axes, &STEPS[..COARSE]);
                (self.total_min(&axes), axes)
            })
            .collect();
        let (_, mut axes) = begun.into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        self.relax(&mut axes, &STEPS[COARSE..]);
        Some(axes)
    }
}

/// An axis that leans off a normal a little, whatever way: a flat bottom has no strip without.
fn leant(normal: &Unit3) -> Unit3 {
    Unit3::new_normalize(normal.into_inner() + any_perpendicular(normal).into_inner() * 0.1)
}

/// Width of the strip at a node with an axis, mm.
fn width_mm(asked: &Asked<'_>, node: &Node, axis: &Unit3) -> f64 {
    match &node.frame {
        Some((forms, frame)) => {
            let lean = Lean::of(axis, frame);
            planar_width_mm(forms, frame, (asked.cutter, lean), asked.scallop_mm).max(1e-3 * asked.scallop_mm)
        }
        None => asked.cutter.radius_mm(),
    }
}
