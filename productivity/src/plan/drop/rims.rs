//! Rims of what is free for a tool at a height: the lines of constant height of the dropped tool's tip.
//!
//! Heights are taken once on a grid over the places around which a tool may go. At each height the grid's edges on which free and
//! held places meet are halved down to the tool's own rim, and so are chords of it that stray; what is on the line is on the free
//! side. Channels and posts narrower than the grid's cells are not seen.

use super::ground::Ground;
use super::wants::Want;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Cells of the grid are this part of the tool's radius wide.
const CELL: f64 = 0.25;
/// Most nodes of a grid.
const MOST_NODES: f64 = 4e6;
/// A place is on a rim when it is within this part of the chord tolerance of it.
const ON: f64 = 0.1;
/// Chords are not halved below this part of a cell.
const SHORTEST: f64 = 0.02;
/// Halvings of one search: of a cell down to less than anybody's tolerance.
const HALVINGS: usize = 40;

/// A rim: its nodes, held places on the right.
pub(super) struct Rim {
    pub nodes: Vec<[f64; 2]>,
    pub closed: bool,
}

/// Heights of the dropped tool on a grid.
pub(super) struct Rims {
    lo: [f64; 2],
    cell: f64,
    n: [usize; 2],
    /// Of nodes: NaN where nobody asks, -inf where nothing is below.
    height: Vec<f64>,
    /// Cells of which all corners are known, with their lowest and highest.
    cells: Vec<(u32, [f64; 2])>,
}

/// An edge of the grid: from a node along the first or second direction.
type Edge = (u32, bool);

impl Rims {
    /// Heights around wants.
    ///
    /// # Errors
    /// Why a grid would be too large.
    pub(super) fn around(ground: &Ground<'_>, wants: &[Want]) -> Result<Self, String> {
        let cell = CELL * ground.task.cutter.radius_mm();
        let pad = |w: &Want| w.reach + 2.0 * w.widest() + 2.0 * cell;
        let by = |k: usize, sign: f64| {
            wants.iter().map(|w| sign * w.at[k] + pad(w)).fold(f64::NEG_INFINITY, f64::max) * sign
        };
        let (lo, hi) = ([by(0, -1.0), by(1, -1.0)], [by(0, 1.0), by(1, 1.0)]);
        let count = [0, 1].map(|k| ((hi[k] - lo[k]) / cell).ceil() + 2.0);
        if count[0] * count[1] > MOST_NODES {
            return Err(format!(
                "its waterlines need a grid of {:.0} x {:.0} places; split the faces, or use a larger tool",
                count[0], count[1]
            ));
        }
        // Within the limit.
        let n = count.map(|c| c as usize);
        let mut asked = vec![false; n[0] * n[1]];
        for w in wants {
            let range = |k: usize| {
                let at = |x: f64| ((x - lo[k]) / cell).clamp(0.0, (n[k] - 1) as f64);
                at(w.at[k] - pad(w)) as usize..=at(w.at[k] + pad(w)).ceil() as usize
            };
            for j in range(1) {
                asked[j * n[0]..][range(0)].fill(true);
            }
        }
        let at = |k: usize| [0, 1].map(|i| lo[i] + cell * [k % n[0], k / n[0]][i] as f64);
        let height: Vec<f64> = asked
            .par_iter()
            .enumerate()
            .map(|(k, asked)| if *asked { free_from(ground, at(k)) } else { f64::NAN })
            .collect();
        let corners = |k: usize| [k, k + 1, k + n[0] + 1, k + n[0]].map(|k| height[k]);
        let cells = (0..n[0] * (n[1] - 1))
            .filter(|k| k % n[0] + 1 < n[0])
            .map(|k| (k, corners(k)))
            .filter(|(_, c)| c.iter().all(|z| !z.is_nan()))
            .map(|(k, c)| {
                (
                    k,
                    [
                        c.iter().copied().fold(f64::INFINITY, f64::min),
                        c.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                    ],
                )
            })
            // A node fits: the grid has fewer than the most.
            .map(|(k, range)| (k as u32, range))
            .collect();
        Ok(Self { lo, cell, n, height, cells })
    }

    /// Width of a cell, mm.
    pub(super) fn cell_mm(&self) -> f64 {
        self.cell
    }

    fn node(&self, k: u32) -> [f64; 2] {
        let k = k as usize;
        [0, 1].map(|i| self.lo[i] + self.cell * [k % self.n[0], k / self.n[0]][i] as f64)
    }

    /// The rims at a height, as far as they are `wanted`.
    pub(super) fn at(&self, ground: &Ground<'_>, z: f64, wanted: &dyn Fn([f64; 2]) -> bool) -> Vec<Rim> {
        // From an edge of a cell to the next on the same rim.
        let mut next: BTreeMap<Edge, Edge> = BTreeMap::new();
        for (k, [least, most]) in &self.cells {
            if !(*least <= z && z < *most) {
                continue;
            }
            let middle = self.node(*k).map(|x| x + 0.5 * self.cell);
            if wanted(middle) {
                self.through(*k, z, || free_from(ground, middle) > z, &mut next);
            }
        }
        let mut out = Vec::new();
        let ends: BTreeSet<Edge> = next.values().copied().collect();
        let mut starts: Vec<Edge> = next.keys().filter(|e| !ends.contains(e)).copied().collect();
        starts.reverse();
        while let Some(start) = starts.pop().or_else(|| next.keys().next().copied()) {
            let mut edges = vec![start];
            while let Some(to) = edges.last().and_then(|e| next.remove(e)) {
                edges.push(to);
            }
            let closed = edges.len() > 2 && edges.first() == edges.last();
            if closed {
                edges.pop();
            }
            let nodes: Vec<[f64; 2]> = edges.iter().map(|e| self.on_edge(ground, *e, z)).collect();
            out.push(Rim { nodes: self.smooth(ground, &nodes, z, closed), closed });
        }
        out
    }

    /// Joins the edges of a cell on which its rims go in and out, held places on the right.
    fn through(&self, k: u32, z: f64, held_in_middle: impl Fn() -> bool, next: &mut BTreeMap<Edge, Edge>) {
        // A number of nodes along one side fits.
        let row = self.n[0] as u32;
        let corners = [k, k + 1, k + row + 1, k + row];
        let edges: [Edge; 4] = [(k, false), (k + 1, true), (k + row, false), (k, true)];
        let held = corners.map(|c| self.height[c as usize] > z);
        // Around the cell: where it gets held a rim comes in, where it gets free one goes out.
        let turns = |from: bool| (0..4).filter(move |e| held[*e] == from && held[(e + 1) % 4] != from);
        let (ins, outs): (Vec<usize>, Vec<usize>) = (turns(false).collect(), turns(true).collect());
        let joined = ins.len() == 2 && held_in_middle();
        for e in ins {
            let after = outs.iter().position(|o| *o > e).unwrap_or(0);
            let out = if joined { outs[(after + 1) % 2] } else { outs[after] };
            next.insert(edges[e], edges[out]);
        }
    }

    /// The place of a rim on an edge, on its free side.
    fn on_edge(&self, ground: &Ground<'_>, (k, second): Edge, z: f64) -> [f64; 2] {
        // As above.
        let other = if second { k + self.n[0] as u32 } else { k + 1 };
        let (a, b) = (self.node(k), self.node(other));
        if self.height[k as usize] > z { brink(ground, b, a, z) } else { brink(ground, a, b, z) }
    }

    /// Nodes between those given, so that chords stray no more than half their tolerance.
    fn smooth(&self, ground: &Ground<'_>, nodes: &[[f64; 2]], z: f64, closed: bool) -> Vec<[f64; 2]> {
        let off = 0.5 * ground.task.tolerance.chord_mm;
        let mut out: Vec<[f64; 2]> = vec![nodes[0]];
        let ends = if closed { &nodes[..1] } else { &[] };
        for to in nodes[1..].iter().chain(ends) {
            let mut stack = vec![*to];
            let mut last = *out.last().unwrap_or(to);
            // Each halving is bounded by the shortest chord.
            while let Some(next) = stack.pop() {
                let d = [next[0] - last[0], next[1] - last[1]];
                let long = d[0].hypot(d[1]);
                let strays = if long > SHORTEST * self.cell {
                    self.strays(ground, last, d, [long, off, z])
                } else {
                    None
                };
                match strays {
                    Some(mid) => stack.extend([next, mid]),
                    None => {
                        out.push(next);
                        last = next;
                    }
                }
            }
        }
        if closed {
            out.pop();
        }
        out
    }

    /// The rim's place beside the middle of a chord where that is off by more than `off`.
    fn strays(
        &self,
        ground: &Ground<'_>,
        from: [f64; 2],
        d: [f64; 2],
        [long, off, z]: [f64; 3],
    ) -> Option<[f64; 2]> {
        // Held places are on the right.
        let right = [d[1] / long, -d[0] / long];
        let at = |s: f64| [0, 1].map(|i| from[i] + 0.5 * d[i] + s * right[i]);
        let held = |s: f64| free_from(ground, at(s)) > z;
        let side = if held(-off) {
            -1.0
        } else if held(off) {
            return None;
        } else {
            1.0
        };
        // Out from the chord, up to where the other kind of place begins.
        let mut near = side * off;
        let most = 0.75 * long;
        while near.abs() < most {
            let far = 2.0 * near;
            if held(far) == (side > 0.0) {
                let (free, held) = if side > 0.0 { (near, far) } else { (far, near) };
                return Some(brink(ground, at(free), at(held), z));
            }
            near = far;
        }
        None
    }
}

/// The height of the tip over a place; -inf where nothing is below.
fn free_from(ground: &Ground<'_>, c: [f64; 2]) -> f64 {
    ground.drops.rest(c).map_or(f64::NEG_INFINITY, |r| r.tip)
}

/// The last free place on the way from a free one to one that is held at a height.
fn brink(ground: &Ground<'_>, mut free: [f64; 2], mut held: [f64; 2], z: f64) -> [f64; 2] {
    let on = ON * ground.task.tolerance.chord_mm;
    for _ in 0..HALVINGS {
        if (held[0] - free[0]).hypot(held[1] - free[1]) <= on {
            break;
        }
        let mid = [0, 1].map(|i| 0.5 * (free[i] + held[i]));
        if free_from(ground, mid) > z { held = mid } else { free = mid }
    }
    free
}
