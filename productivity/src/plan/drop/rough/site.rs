//! Everything that is known before layers along one axis are laid out: how low the tool comes, what stands there, and what is to go.

use super::super::frame::Frame;
use super::super::ground::Ground;
use super::columns::{Columns, extent};
use super::grid::{Disc, Grid};
use super::material::Material;
use super::relief::{Points, Relief, Rougher};
use super::straights::Straights;
use super::task::Places;
use osculate_geom::Unit3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Nodes stand this part of the tool's radius apart ...
pub(super) const CELL: f64 = 1.0 / 7.0;
/// ... but no more of them are looked at.
const MOST_NODES: f64 = 4e5;
/// Beside what is to go the tool may come from this many of its radii away.
const BESIDE: f64 = 2.0;
/// Steps in which a column is asked which place it belongs to, of the tool's radius.
const CLAIM_STEP: f64 = 0.25;

/// What is less steep than this is cut as a floor is.
const SHALLOW: f64 = 0.25;

/// How steep a field is at a node; no number at the border and where it is none.
pub(super) fn slope(grid: &Grid, field: &[f64], k: usize) -> f64 {
    let ([i, j], [ni, nj]) = (grid.place(k), grid.n);
    if i == 0 || j == 0 || i + 1 == ni || j + 1 == nj {
        return f64::NAN;
    }
    let across = (field[k + 1] - field[k - 1]).hypot(field[k + ni] - field[k - ni]);
    across / (2.0 * grid.cell)
}

/// A place to rough along one axis.
pub(super) struct Site<'a> {
    pub ground: &'a Ground<'a>,
    pub tool: &'a Rougher,
    pub grid: Grid,
    /// How low the tip comes at each node: minus infinity where nothing is below, infinity where it is not to go, no number where
    /// nothing is known.
    pub tip: Vec<f64>,
    /// How low the holder lets it come.
    pub holder: Vec<f64>,
    /// Whether the tip goes over the faces nearly level there: what stands on them is cut as on a floor.
    pub shallow: Vec<bool>,
    pub columns: Columns,
    /// The least height of what is to go at each node; infinite where nothing is.
    pub least: Vec<f64>,
    /// The nodes under the bare tool.
    pub disc: Disc,
    /// How well the ends of columns are known, mm.
    pub blur_mm: f64,
    pub straights: Straights,
}

/// What is to be seen along an axis.
pub(super) struct Sight {
    relief: Relief,
    /// The least height of what is to go, as in [`Site`].
    least: Vec<f64>,
}

/// The frame, the least and greatest places of material in it with room for the tool around, and the distance of nodes.
pub(super) fn view(
    material: &Material<'_>,
    (axis, feed): (Unit3, &osculate_geom::Vec3),
    tool: &Rougher,
    part: f64,
) -> (Frame, [[f64; 2]; 2], f64) {
    let frame = Frame::new(axis, feed);
    let [lo, hi] = extent(material.bounds(), &frame);
    let room = (BESIDE + 1.0) * tool.grown.radius_mm;
    let area = [[lo[0] - room, lo[1] - room], [hi[0] + room, hi[1] + room]];
    let size = (area[1][0] - area[0][0]) * (area[1][1] - area[0][1]);
    let cell = (part * tool.bare.radius_mm).max((size / MOST_NODES).sqrt());
    (frame, area, cell)
}

impl Sight {
    /// What is to go along an axis, thicker than `thin_mm`, in the place that is planned.
    pub fn of(
        points: &Points,
        material: &Material<'_>,
        (axis, feed): (Unit3, &osculate_geom::Vec3),
        (tool, places, thin_mm): (&Rougher, Option<&Places>, f64),
    ) -> Self {
        let (frame, area, cell) = view(material, (axis, feed), tool, CELL);
        let relief = Relief::of(points, (frame, material.bounds()), tool, (area, cell));
        let grid = &relief.grid;
        let columns =
            Columns::of(material, &frame, grid, |k| relief.wanted[k] && relief.reached[k].is_finite());
        let mut least = thick(grid, &columns, &relief.reached, (thin_mm, tool.bare.radius_mm));
        if let Some(places) = places {
            claim(&relief, &columns, &mut least, (places, CLAIM_STEP * tool.bare.radius_mm));
        }
        Self { relief, least }
    }

    /// The frame of the axis.
    pub const fn frame(&self) -> Frame {
        self.relief.frame
    }
}

/// The least height of material that is reached and thicker than `thin_mm` there or close by; infinite where there is none.
fn thick(grid: &Grid, columns: &Columns, reached: &[f64], (thin_mm, radius_mm): (f64, f64)) -> Vec<f64> {
    let half = 0.5 * thin_mm;
    let around = Disc::new(half, grid.cell);
    let core: Vec<f64> = (0..grid.len())
        .into_par_iter()
        .map(|k| {
            let holds = |m: usize, z: f64| {
                z >= reached[m] && columns.of_node(m).iter().any(|[a, b]| (*a..=*b).contains(&z))
            };
            let is_core = columns.of_node(k).iter().any(|[a, b]| {
                let (lo, hi) = (a.max(reached[k]) + half, b - half);
                let steps = if hi >= lo { ((hi - lo) / half.max(grid.cell)) as usize + 1 } else { 0 };
                (0..steps).any(|s| {
                    let z = lo + (hi - lo) * s as f64 / (steps - 1).max(1) as f64;
                    grid.disc(&around, k).flatten().all(|m| holds(m, z))
                })
            });
            if is_core { 1.0 } else { 0.0 }
        })
        .collect();
    let near = grid.highest(&core, &Disc::new(radius_mm, grid.cell));
    let is_any = |k: usize| near[k] > 0.0 && columns.tops()[k] > reached[k];
    (0..grid.len()).map(|k| if is_any(k) { reached[k] } else { f64::INFINITY }).collect()
}

/// Leaves to other places what they reach too, and lies nearer to the middle of what they take.
fn claim(relief: &Relief, columns: &Columns, least: &mut [f64], (places, step): (&Places, f64)) {
    let (grid, frame) = (&relief.grid, &relief.frame);
    let wants: Vec<usize> = (0..grid.len()).filter(|k| least[*k].is_finite()).collect();
    let point = |k: usize, z: f64| frame.point([grid.at(k)[0], grid.at(k)[1], z]);
    // The middle of all that is reached, by angle.
    let mut sum = [0.0; 2];
    for &k in &wants {
        for [a, b] in columns.of_node(k) {
            let a = a.max(least[k]);
            let angle = places.angle_rad(&point(k, 0.5 * (a + b)));
            let w = (b - a).max(0.0);
            (sum[0], sum[1]) = (sum[0] + w * angle.cos(), sum[1] + w * angle.sin());
        }
    }
    let middle = sum[1].atan2(sum[0]);
    let off = |p: &osculate_geom::Point3| (places.angle_rad(p) - middle + PI).rem_euclid(TAU) - PI;
    let back: Vec<_> = places.turns().iter().skip(1).map(nalgebra::Isometry3::inverse).collect();
    let own = |p: &osculate_geom::Point3| {
        let here = off(p).abs();
        back.iter().all(|turn| {
            let q = turn * p;
            let there = off(&q);
            // Of two as far off the one to the left has it.
            let farther = there.abs() > here + 1e-9 || ((there.abs() - here).abs() <= 1e-9 && there <= 0.0);
            farther || !relief.takes(&q)
        })
    };
    let found: Vec<f64> = wants
        .par_iter()
        .map(|&k| {
            let spans = columns.of_node(k).iter().map(|[a, b]| [a.max(least[k]), *b]).filter(|[a, b]| a < b);
            for [a, b] in spans {
                let steps = ((b - a) / step).ceil().max(1.0) as usize;
                for s in 0..steps {
                    let z = a + (b - a) * (s as f64 + 0.5) / steps as f64;
                    if own(&point(k, z)) {
                        // All above goes too.
                        return a + (b - a) * s as f64 / steps as f64;
                    }
                }
            }
            f64::INFINITY
        })
        .collect();
    for (k, z) in wants.into_iter().zip(found) {
        least[k] = z;
    }
}

impl<'a> Site<'a> {
    /// The part of a sight where something is to go, asked of the faces themselves; None where nothing is.
    pub fn of(
        sight: &Sight,
        ground: &'a Ground<'a>,
        tool: &'a Rougher,
        material: &Material<'_>,
    ) -> Option<Self> {
        let (whole, radius) = (&sight.relief.grid, tool.grown.radius_mm);
        let wants: Vec<usize> = (0..whole.len()).filter(|k| sight.least[*k].is_finite()).collect();
        let nodes = (BESIDE * radius / whole.cell).ceil() as usize + 2;
        let [from, to] =
            wants.iter().map(|k| whole.place(*k)).fold([[usize::MAX; 2], [0; 2]], |[lo, hi], p| {
                [[0, 1].map(|a| lo[a].min(p[a])), [0, 1].map(|a| hi[a].max(p[a]))]
            });
        if wants.is_empty() {
            return None;
        }
        let from = from.map(|x| x.saturating_sub(nodes));
        let to = [0, 1].map(|a| (to[a] + nodes).min(whole.n[a] - 1));
        let first = from[1] * whole.n[0] + from[0];
        let grid =
            Grid { lo: whole.at(first), cell: whole.cell, n: [to[0] - from[0] + 1, to[1] - from[1] + 1] };
        let there: Vec<usize> = (0..grid.len())
            .map(|k| grid.place(k))
            .map(|[i, j]| (j + from[1]) * whole.n[0] + i + from[0])
            .collect();
        let take = |of: &[f64]| -> Vec<f64> { there.iter().map(|k| of[*k]).collect() };
        let (holder, least, coarse) =
            (take(&sight.relief.holder), take(&sight.least), take(&sight.relief.tip));
        let wanted: Vec<f64> = least.iter().map(|z| if z.is_finite() { 1.0 } else { 0.0 }).collect();
        let domain: Vec<bool> = grid
            .highest(&wanted, &Disc::new(BESIDE * radius, grid.cell))
            .into_iter()
            .map(|w| w > 0.0)
            .collect();
        let columns = Columns::of(material, &sight.relief.frame, &grid, |_| true);
        let disc = Disc::new(tool.bare.radius_mm, grid.cell);
        let in_air = grid.highest(columns.tops(), &disc);
        let tip: Vec<f64> = (0..grid.len())
            .into_par_iter()
            .map(|k| match () {
                () if !domain[k] => f64::NAN,
                () => match ground.drops.rest(grid.at(k)) {
                    Some(rest) => rest.tip + tool.allowance_mm,
                    None if in_air[k] == f64::NEG_INFINITY => f64::NEG_INFINITY,
                    // Beside the part the coarse view says how far down faces are near.
                    None if coarse[k].is_finite() => coarse[k],
                    None => f64::INFINITY,
                },
            })
            .collect();
        let shallow = (0..grid.len()).map(|k| slope(&grid, &tip, k) < SHALLOW).collect();
        Some(Self {
            ground,
            tool,
            grid,
            tip,
            shallow,
            holder,
            columns,
            least,
            disc,
            blur_mm: material.cell_mm(),
            straights: Straights::default(),
        })
    }

    /// How low the tip comes over a place, as the faces say; minus infinity where nothing is below.
    pub fn rests(&self, at: [f64; 2]) -> f64 {
        self.ground.drops.rest(at).map_or(f64::NEG_INFINITY, |r| r.tip + self.tool.allowance_mm)
    }

    /// The greatest height of what is to go, and the least that the tool comes down to for it.
    pub fn heights(&self) -> Option<[f64; 2]> {
        let wants = (0..self.grid.len()).filter(|k| self.columns.tops()[*k] > self.least[*k]);
        let (mut top, mut low) = (f64::NEG_INFINITY, f64::INFINITY);
        for k in wants {
            top = top.max(self.columns.tops()[k]);
            low = low.min(self.least[k]);
        }
        // Nothing lies lower than the lowest place that the tool comes to.
        let lowest = self.tip.iter().zip(&self.holder).map(|(t, h)| t.max(*h)).filter(|t| t.is_finite());
        let low = low.max(lowest.fold(f64::INFINITY, f64::min));
        (top > low && low.is_finite()).then_some([top, low])
    }
}
