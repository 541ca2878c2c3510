//! The way on one height from where the tool is to where it goes on, around what stands between.
//!
//! Rows end at walls, and past a wall that bulges the next one is not gone on to straight, nor over the wall without going up. Over what
//! is cleared the tool comes there all the same. Between its ends such a way leads over nodes where the tool takes nothing, and is pulled
//! tight; how it leaves and how it arrives is asked of the faces.

use super::grid::Disc;
use super::layer::along_faces;
use super::moves::Moves;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::f64::consts::SQRT_2;

/// Ways leave and arrive over a node within this many radii of the tool, ...
const ENDS: f64 = 1.0;
/// ... one of the nearest ones, and so many are tried.
const MOST_ENDS: usize = 4;
/// A way that is not found is looked for so many steps down higher up.
const LIFTS: u32 = 2;
/// No more nodes are looked at.
const MOST_NODES: usize = 20_000;

/// What is known of nodes at one height.
struct Level<'a, 'b> {
    moves: &'a Moves<'b>,
    height: f64,
    /// Material that stands no higher than this is none.
    most: f64,
    free: BTreeMap<usize, bool>,
}

impl Level<'_, '_> {
    /// Whether the tool takes nothing at a node that stands thicker than it may.
    fn is_cleared(&self, k: usize) -> bool {
        self.moves.columns.top_in(&self.moves.site.grid, &self.moves.under, k) <= self.most
            && self.moves.holder_stops(k) <= self.height
    }

    /// Whether it may be there too.
    fn is_free(&mut self, k: usize) -> bool {
        if let Some(known) = self.free.get(&k) {
            return *known;
        }
        let free = self.moves.tip_stops(k) <= self.height && self.is_cleared(k);
        self.free.insert(k, free);
        free
    }

    /// Places along a straight way.
    fn along([from, to]: [[f64; 2]; 2], step: f64) -> impl Iterator<Item = [f64; 2]> {
        let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) / step).ceil().max(1.0) as usize;
        (0..=steps).map(move |s| [0, 1].map(|a| from[a] + (to[a] - from[a]) * s as f64 / steps as f64))
    }

    /// Whether all nodes around a straight way are free.
    fn is_open(&mut self, ends: [[f64; 2]; 2]) -> bool {
        let grid = &self.moves.site.grid;
        Self::along(ends, grid.cell)
            .all(|p| grid.around(p).is_some_and(|(all, _)| all.into_iter().all(|k| self.is_free(k))))
    }

    /// The nearest free node to a place from which it goes straight there.
    fn end(&mut self, at: [f64; 2]) -> Option<usize> {
        let (site, near) = (self.moves.site, ENDS * self.moves.site.tool.bare.radius_mm);
        let away = |m: usize| {
            let p = site.grid.at(m);
            (p[0] - at[0]).hypot(p[1] - at[1])
        };
        let around = Disc::new(near, site.grid.cell);
        let mut nodes: Vec<usize> = site.grid.disc(&around, site.grid.near(at)?).flatten().collect();
        nodes.sort_by(|a, b| away(*a).total_cmp(&away(*b)).then(a.cmp(b)));
        nodes.retain(|m| self.is_free(*m));
        nodes.into_iter().take(MOST_ENDS).find(|m| {
            let ends = [at, site.grid.at(*m)];
            let cleared = |p: [f64; 2]| site.grid.near(p).is_some_and(|k| self.is_cleared(k));
            Self::along(ends, site.grid.cell).all(cleared)
                && along_faces(site, self.height, &ends).iter().all(|p| p[2] <= self.height)
        })
    }

    /// The shortest way from node to node, no longer than `most_mm`.
    fn nodes(&mut self, [from, to]: [usize; 2], most_mm: f64) -> Option<Vec<usize>> {
        let grid = &self.moves.site.grid;
        let goal = grid.at(to);
        let rest = |k: usize| {
            let p = grid.at(k);
            (p[0] - goal[0]).hypot(p[1] - goal[1])
        };
        // Lengths are not negative: their bits are in their order.
        let mut open = BinaryHeap::from([Reverse((rest(from).to_bits(), from))]);
        let mut gone: BTreeMap<usize, (f64, usize)> = BTreeMap::from([(from, (0.0, from))]);
        while let Some(Reverse((_, k))) = open.pop() {
            if k == to {
                let mut out = vec![to];
                let mut last = to;
                while last != from {
                    last = gone[&last].1;
                    out.push(last);
                }
                out.reverse();
                return Some(out);
            }
            if gone.len() > MOST_NODES {
                return None;
            }
            let (here, [i, j]) = (gone[&k].0, grid.place(k));
            for m in grid.beside(k, true) {
                let [a, b] = grid.place(m);
                let aslant = a != i && b != j;
                let corners = [b * grid.n[0] + i, j * grid.n[0] + a];
                let long = here + if aslant { SQRT_2 } else { 1.0 } * grid.cell;
                let whole = long + rest(m);
                if whole > most_mm
                    || gone.get(&m).is_some_and(|(known, _)| long >= *known)
                    || !self.is_free(m)
                    || (aslant && !corners.into_iter().all(|c| self.is_free(c)))
                {
                    continue;
                }
                gone.insert(m, (long, k));
                open.push(Reverse((whole.to_bits(), m)));
            }
        }
        None
    }

    /// Corners of a way over nodes that is pulled tight.
    fn tight(&mut self, nodes: &[usize]) -> Vec<[f64; 2]> {
        let places: Vec<[f64; 2]> = nodes.iter().map(|k| self.moves.site.grid.at(*k)).collect();
        let mut out: Vec<[f64; 2]> = places.first().copied().into_iter().collect();
        let mut k = 0;
        while k + 1 < places.len() {
            let mut next = k + 1;
            while next + 1 < places.len() && self.is_open([places[k], places[next + 1]]) {
                next += 1;
            }
            out.push(places[next]);
            k = next;
        }
        out
    }
}

impl Moves<'_> {
    /// How low the part lets the tip come to a node; endless where it may not be.
    fn tip_stops(&self, k: usize) -> f64 {
        let tip = self.site.tip[k];
        if tip.is_nan() { f64::INFINITY } else { tip }
    }

    /// A way from where the tool is to above a place, no longer than `most_mm`, on which nothing thicker than `thin` is taken: on the
    /// height of the higher one of these two, or some steps above it.
    pub(super) fn around(&self, to: [f64; 3], thin: f64, most_mm: f64) -> Option<Vec<[f64; 3]>> {
        let here = self.here()?;
        let (low, step) = (here[2].max(to[2]), self.manner.sizes.stepdown_mm);
        let heights = (0..=LIFTS).map(|n| low + f64::from(n) * step).filter(|h| *h <= self.manner.safe);
        heights.into_iter().find_map(|h| self.around_at(here, to, (h, thin), most_mm))
    }

    fn around_at(
        &self,
        here: [f64; 3],
        to: [f64; 3],
        (height, thin): (f64, f64),
        most_mm: f64,
    ) -> Option<Vec<[f64; 3]>> {
        // Up, over and down.
        let most_mm = most_mm - (height - here[2]) - (height - to[2]);
        if (to[0] - here[0]).hypot(to[1] - here[1]) > most_mm {
            return None;
        }
        let mut level = Level { moves: self, height, most: height + thin, free: BTreeMap::new() };
        let ends = [here, to].map(|p| [p[0], p[1]]);
        let nodes = [level.end(ends[0])?, level.end(ends[1])?];
        let nodes = level.nodes(nodes, most_mm)?;
        let mut way = vec![ends[0]];
        way.extend(level.tight(&nodes));
        way.push(ends[1]);
        Some(way.into_iter().map(|[x, y]| [x, y, height]).collect())
    }
}
