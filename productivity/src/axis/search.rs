//! The axes at the nodes that take the least time: started from the axis that most places can share, then moved node by node.
//!
//! The time is the strips' `dA / (w f)` and, along the passes, what the joints take longer for a turn than the feed does for the way;
//! a share of it for each turn keeps the field smooth, and another keeps axes off the rim of what is possible. A node moves to whichever
//! of a few axes around its own takes least, with steps that halve; an axis that is not possible is never taken. What a
//! machine takes for a turn near its poles is great for small turns: the field goes around them by itself.

use super::joints::Joints;
use super::lattice::{Edge, Lattice, Node};
use super::rim::Rim;
use crate::width::planar_width_mm;
use osculate_geom::{Unit3, Vec3, any_perpendicular};
use osculate_tools::reach::{Bits, Directions, Place};
use osculate_tools::{Cutter, Lean};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Steps of the rim: directions nearer to what is not possible than so many cost more.
const RIM: u8 = 3;
/// Share of a place's time that each step nearer to the rim costs.
const AT_RIM: f64 = 0.03;
/// The narrowest strip of a pass decides how near the next one lies: the time of a place grows by this power of what its strip might be
/// over what it is, up to so many times, more than by one over its width.
const NARROW: f64 = 6.0;
const NARROWEST: f64 = 4.0;
/// Length of a step of the rim next to the normal, rad: tuned on a toroidal end on the third surface of [M86] and on a propeller's blade,
/// where a strip is widest with the least lean and a quarter of a degree more takes a third of it.
const MARGIN_RAD: f64 = 0.002;
/// Share of the whole time that a turn by a radian over a square face costs beyond what the joints take.
const TURN: f64 = 0.1;
/// Ways of the contact on the tool from node to node, of its core and squared, go free up to here: they turn with the face. Beyond that
/// they count by their square so many times what they take at the feed: what flips tears passes.
const FREE: f64 = 0.5;
const SWING: f64 = 1.0;
/// What joints take for a turn with a ball counts so many times: controls brake them from block to block, and another axis costs a ball no strip.
/// (Tuned on blades of an impeller by the time on LinuxCNC, a sixth less; on fields of toroidal ends it changes nothing.)
const BRAKED: f64 = 8.0;
/// For a ball a turn counts, for smoothness, as what a joint of this speed makes while the joints take it, rad/s: near a pole small turns
/// are great ones there, and controls brake them. (Tuned on an impeller's hub by the time on LinuxCNC: 8.3 min become 5.1 along its walls and
/// 10.3 become 7.2 across them; from 6 to 20 it is the same within a fiftieth, with 4 nothing moves.)
const JOINT_RAD_S: f64 = 8.0;
/// What a turn out of reach counts at most, rad.
const FARTHEST_RAD: f64 = 2.0 * PI;
/// How many times as much turns cost at first: a field that is stiff has no walls between parts that lean to different sides.
const STIFF: [f64; 2] = [30.0, 1.0];
/// Starts that places share, the least angle between two of them, rad, and ways to lean least that are others.
const STARTS: usize = 8;
const WAYS_BEGUN: usize = 8;
const APART: f64 = 0.35;
/// Steps of nodes, rad, and most sweeps with one of them.
const STEPS: [f64; 8] = [0.16, 0.08, 0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125];
/// As many of them as a ball needs.
const OF_BALLS: usize = 6;
/// Steps after which only the best start goes on; sweeps after which the best few do, and how many these are.
const COARSE: usize = 2;
const SWEEPS: usize = 16;
const FEW: usize = 2;
const MOST: usize = 3;
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
    /// Whether a tool is clear that touches a place with an axis.
    pub clear: &'a (dyn Fn(&Place, &Unit3) -> bool + Sync),
    /// Whether the joints reach but a line of axes, on which all stay.
    pub on_line: bool,
}

/// The possible axes of a node.
#[derive(Default)]
pub(super) struct Possible {
    /// For each direction how far from the rim it is, zero where it is not possible; empty where none is asked for.
    depths: Vec<u8>,
    /// What decides next to the normal.
    rim: Option<Rim>,
}

impl Possible {
    pub fn new(directions: &Directions, bits: &Bits, rim: Option<Rim>) -> Self {
        Self { depths: depths(directions, bits), rim }
    }

    /// Whether axes next to the normal are told apart.
    pub const fn has_rim(&self) -> bool {
        self.rim.is_some()
    }

    /// How many directions of the set are possible.
    pub fn count(&self) -> usize {
        self.depths.iter().filter(|d| **d > 0).count()
    }

    /// Whether some axis is possible, of the set or next to the normal.
    pub fn is_any(&self) -> bool {
        self.rim.as_ref().is_some_and(|rim| !rim.is_empty()) || self.count() > 0
    }

    /// Whether nothing is asked for.
    fn is_free(&self) -> bool {
        self.depths.is_empty()
    }

    /// How far from the rim an axis is, in steps of it; zero where it is not possible.
    fn depth(&self, directions: &Directions, axis: &Unit3, clear: &dyn Fn(&Unit3) -> bool) -> f64 {
        match self.rim.as_ref().and_then(|rim| Some(rim.margin_rad(&rim.spot(axis)?))) {
            Some([least, _]) if least >= 0.0 => (1.0 + least / MARGIN_RAD).min(f64::from(RIM)),
            // Between two ways the least lean may be far less than both say.
            Some([_, most]) if most > 0.0 && clear(axis) => 1.0,
            Some(_) => 0.0,
            None => f64::from(self.depths[directions.nearest(axis)]),
        }
    }
}

/// How far each possible direction is from the rim of the possible ones, up to [`RIM`].
fn depths(directions: &Directions, bits: &Bits) -> Vec<u8> {
    let all = directions.all().len();
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
    possible: &'a [Possible],
    /// Time that a turn costs, by the square of its angle, min.
    turn_min: f64,
    /// How many times as much turns and swings cost now.
    stiffness: f64,
    /// Widths by which passes over edges are counted, mm.
    width_mm: f64,
    /// For each node the widest strip that it has next to the normal, mm; where it has none the median of all.
    widest_mm: Vec<f64>,
}

impl<'a> Search<'a> {
    pub fn new(asked: &'a Asked<'a>, lattice: &'a Lattice, possible: &'a [Possible]) -> Self {
        let widths: Vec<f64> = lattice
            .nodes
            .iter()
            .filter(|n| n.area_mm2 > 0.0)
            .filter_map(|n| Some(width_mm(asked, n, &leant(&n.normal?))))
            .collect();
        let width_mm = widths.iter().sum::<f64>() / widths.len().max(1) as f64;
        let area: f64 = lattice.nodes.iter().map(|n| n.area_mm2).sum();
        let turn_min = TURN * area / (width_mm * asked.feed_mm_min);
        let widest = |(node, possible): (&Node, &Possible)| {
            let ways = possible.rim.iter().flat_map(|rim| rim.axes(MARGIN_RAD));
            ways.map(|(_, axis)| self::width_mm(asked, node, &axis)).max_by(f64::total_cmp)
        };
        let widest: Vec<Option<f64>> = lattice.nodes.par_iter().zip(possible).map(widest).collect();
        let on_face = lattice.nodes.iter().zip(&widest).filter(|(n, _)| n.area_mm2 > 0.0);
        let mut usual: Vec<f64> = on_face.filter_map(|(_, w)| *w).collect();
        usual.sort_by(f64::total_cmp);
        let usual_mm = usual.get(usual.len() / 2).copied().unwrap_or(width_mm);
        let widest_mm = widest.into_iter().map(|w| w.unwrap_or(usual_mm)).collect();
        Self { asked, lattice, possible, turn_min, stiffness: 1.0, width_mm, widest_mm }
    }

    fn depth(&self, node: usize, axis: &Unit3) -> f64 {
        let n = &self.lattice.nodes[node];
        let clear = |a: &Unit3| {
            n.normal.is_some_and(|normal| (self.asked.clear)(&Place { point: n.point, normal }, a))
        };
        self.possible[node].depth(self.asked.directions, axis, &clear)
    }

    /// The nearest possible direction, or the one itself where nothing is asked.
    fn nearest(&self, node: usize, axis: &Unit3) -> Unit3 {
        let possible = &self.possible[node];
        if possible.is_free() || self.depth(node, axis) > 0.0 {
            return *axis;
        }
        let all = self.asked.directions.all();
        let far = |a: &&Unit3| possible.rim.as_ref().is_none_or(|rim| rim.spot(a).is_none());
        let ways = possible.rim.iter().flat_map(|rim| rim.axes(MARGIN_RAD));
        // Next to a way with no least lean what is said to be one may be none.
        let next = ways.map(|(_, a)| a);
        let next = next.filter(|a| self.asked.joints.reaches(a) && self.depth(node, a) > 0.0);
        let set = possible.depths.iter().zip(all).filter(|(d, _)| **d > 0).map(|(_, a)| a).filter(far);
        let found = set.copied().chain(next).fold((f64::NEG_INFINITY, *axis), |best, a| {
            let cosine = a.dot(axis);
            if cosine > best.0 { (cosine, a) } else { best }
        });
        found.1
    }

    fn node_min(&self, k: usize, axis: &Unit3) -> f64 {
        let node = &self.lattice.nodes[k];
        let possible = &self.possible[k];
        if possible.is_free() {
            return 0.0;
        }
        let depth = self.depth(k, axis);
        if depth <= 0.0 || (possible.rim.is_some() && !self.asked.joints.reaches(axis)) {
            return f64::INFINITY;
        }
        let width = width_mm(self.asked, node, axis);
        let time = node.weight_mm2 / (width * self.asked.feed_mm_min)
            * (self.widest_mm[k] / width).min(NARROWEST).powf(NARROW);
        time * (1.0 + AT_RIM * (f64::from(RIM) - depth))
    }

    /// What it costs that the contact lies on another side of the tool at the next node: the tool moves on by so much more, and where
    /// the lean passes through none it cannot at all.
    fn swing_min(&self, edge: &Edge, a: &Unit3, b: &Unit3) -> f64 {
        let core_mm = self.asked.cutter.core_mm();
        let [n, m] = edge.ends.map(|k| self.lattice.nodes[k].normal);
        let (Some(n), Some(m)) = (n, m) else { return 0.0 };
        if core_mm <= 0.0 {
            return 0.0;
        }
        let apart = toward(&n, a) - toward(&m, b);
        let beyond = (apart.norm_squared() - FREE).max(0.0);
        SWING * core_mm * beyond * beyond * edge.across_mm / (self.width_mm * self.asked.feed_mm_min)
    }

    fn edge_min(&self, edge: &Edge, a: &Unit3, b: &Unit3) -> f64 {
        let ratio = (edge.across_mm / edge.length_mm.max(f64::MIN_POSITIVE)).min(LONGEST);
        let is_ball = self.asked.cutter.is_ball();
        let asked = is_ball || edge.along > 0.0;
        let turn_s = if asked { self.asked.joints.turn_s(a, b) } else { 0.0 };
        let joints_rad = if is_ball { (JOINT_RAD_S * turn_s).min(FARTHEST_RAD) } else { 0.0 };
        let angle = a.angle(b).max(joints_rad);
        let smooth = self.stiffness * (self.turn_min * ratio * angle * angle + self.swing_min(edge, a, b));
        if edge.along == 0.0 {
            return smooth;
        }
        let feed_min = edge.length_mm / self.asked.feed_mm_min;
        let times = if is_ball { BRAKED } else { 1.0 };
        let late = times * turn_s / 60.0 - feed_min;
        if late <= 0.0 {
            return smooth;
        }
        // No more than what a rewind may take: an axis out of reach is refused by the node.
        smooth + edge.along * edge.across_mm / self.width_mm * late.min(1.0)
    }

    /// The time around a node with an axis, or some that is no less than `enough`.
    fn around_min(&self, k: usize, axis: &Unit3, axes: &[Unit3], enough: f64) -> f64 {
        let mut sum = self.node_min(k, axis);
        for e in &self.lattice.of_node[k] {
            if sum >= enough {
                break;
            }
            let e = &self.lattice.edges[*e as usize];
            sum += if e.ends[0] == k {
                self.edge_min(e, axis, &axes[e.ends[1]])
            } else {
                self.edge_min(e, &axes[e.ends[0]], axis)
            };
        }
        sum
    }

    /// What a node counts for at most: a search that leaves a few with no possible axis may still be the best one.
    fn most_min(&self, k: usize) -> f64 {
        let strip_min = self.lattice.nodes[k].weight_mm2 / (self.widest_mm[k] * self.asked.feed_mm_min);
        strip_min * NARROWEST.powf(NARROW + 1.0) * (1.0 + AT_RIM * f64::from(RIM))
    }

    fn total_min(&self, axes: &[Unit3]) -> f64 {
        let nodes: f64 = (0..axes.len()).map(|k| self.node_min(k, &axes[k]).min(self.most_min(k))).sum();
        let edges = self.lattice.edges.iter().map(|e| self.edge_min(e, &axes[e.ends[0]], &axes[e.ends[1]]));
        nodes + edges.sum::<f64>()
    }

    /// Moves every node once; what that saves, min.
    fn sweep(&self, axes: &mut [Unit3], step: f64) -> f64 {
        let mut saved = 0.0;
        for k in 0..axes.len() {
            let own = axes[k];
            let now = self.around_min(k, &own, axes, f64::INFINITY);
            let mut best = (now, own);
            let mut offer = |axis: Unit3| {
                let axis = if self.asked.on_line { self.asked.joints.nearest(&axis) } else { axis };
                let time = self.around_min(k, &axis, axes, best.0);
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
            if let Some(rim) = &self.possible[k].rim
                && let Some(spot) = rim.spot(&own)
            {
                for way in spot.ways {
                    let least = rim.least_rad(way);
                    if least.is_finite() {
                        offer(rim.axis(way, least + MARGIN_RAD));
                        offer(rim.axis(way, least));
                    }
                }
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

    fn relax(&self, axes: &mut [Unit3], steps: &[f64], sweeps: usize) {
        for step in steps {
            for _ in 0..sweeps {
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
        for (node, possible) in self.lattice.nodes.iter().zip(self.possible) {
            for (sum, depth) in shared.iter_mut().zip(&possible.depths) {
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

    /// The axis of a node to begin with.
    fn begun(&self, node: usize, start: &Start) -> Unit3 {
        let axis = match start {
            Start::Shared(axis) => *axis,
            Start::Way(k) => {
                let way = k * Rim::ways() / WAYS_BEGUN;
                let rim = self.possible[node].rim.as_ref();
                let axis = rim.and_then(|rim| rim.axes(MARGIN_RAD).find(|(w, _)| *w == way));
                match (axis, self.lattice.nodes[node].normal) {
                    (Some((_, axis)), _) => axis,
                    (None, Some(normal)) => normal,
                    (None, None) => Vec3::z_axis(),
                }
            }
        };
        self.nearest(node, &axis)
    }

    /// The same search where turns cost so many times as much.
    fn stiffer(&self, times: f64) -> Self {
        Self { stiffness: self.stiffness * times, widest_mm: self.widest_mm.clone(), ..*self }
    }

    /// The best axes found; None where no place has any.
    pub fn best(&self) -> Option<Vec<Unit3>> {
        let shared = self.starts();
        let near = self.possible.iter().any(|p| p.rim.is_some());
        let ways = if near { 0..WAYS_BEGUN } else { 0..0 };
        let starts: Vec<Start> = shared.into_iter().map(Start::Shared).chain(ways.map(Start::Way)).collect();
        let mut begun: Vec<(f64, Vec<Unit3>)> = starts
            .par_iter()
            .map(|start| {
                let mut axes: Vec<Unit3> = (0..self.possible.len()).map(|k| self.begun(k, start)).collect();
                for stiffness in STIFF {
                    self.stiffer(stiffness).relax(&mut axes, &STEPS[..COARSE], FEW);
                }
                (self.total_min(&axes), axes)
            })
            .collect();
        begun.sort_by(|a, b| a.0.total_cmp(&b.0));
        begun.truncate(MOST);
        let relaxed = begun.into_par_iter().map(|(_, mut axes)| {
            self.relax(&mut axes, &STEPS[..COARSE], SWEEPS);
            (self.total_min(&axes), axes)
        });
        let relaxed: Vec<(f64, Vec<Unit3>)> = relaxed.collect();
        let (_, mut axes) = relaxed.into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a })?;
        // A ball's strip says nothing of the last ones.
        let last = if self.asked.cutter.is_ball() { OF_BALLS } else { STEPS.len() };
        self.relax(&mut axes, &STEPS[COARSE..last], SWEEPS);
        Some(axes)
    }
}

/// What a search begins with.
enum Start {
    /// An axis that places share.
    Shared(Unit3),
    /// The least lean in one of a few ways.
    Way(usize),
}

/// An axis that leans off a normal a little, whatever way: a flat bottom has no strip without.
fn leant(normal: &Unit3) -> Unit3 {
    Unit3::new_normalize(normal.into_inner() + any_perpendicular(normal).into_inner() * 0.1)
}

/// The way from the tool's axis to the contact: the unit vector at right angles to the axis, towards the normal; none where they agree.
fn toward(normal: &Unit3, axis: &Unit3) -> Vec3 {
    let across = normal.into_inner() - axis.into_inner() * normal.dot(axis);
    let length = across.norm();
    if length > 0.0 { across / length } else { Vec3::zeros() }
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
