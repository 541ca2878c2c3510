//! Passes along the level lines: which stretches of them the face needs, in what order, and their contact points.

use super::cells::Cells;
use super::trace::{Traced, trace};
use crate::plan::cover::union;
use crate::plan::fits::fits;
use crate::plan::line::PassLine;
use crate::plan::march::Grid;
use crate::plan::resample::{contact_points, resample};
use crate::plan::seat::Seat;
use crate::plan::{Pass, PlanError};
use osculate_geom::{Point3, uv};
use rayon::prelude::*;

/// Rows across a strip in which trims are looked for.
const ROWS: usize = 12;
/// Steps along a strip's width in which they are looked for.
const STEPS: f64 = 4.0;
/// Most looks along a line.
const MOST_LOOKS: f64 = 20_000.0;
/// A pass that begins within so many tool radii of the end of the one before is taken next.
const NEXT: f64 = 1.5;

/// A stretch of a level line that becomes a pass.
struct Stretch<'a> {
    line: Traced<'a>,
    range: [f64; 2],
    whole_loop: bool,
    level: usize,
    /// Whether it is run with the uphill side to the right, where that is settled.
    reversed: Option<bool>,
}

/// The passes on the levels, in the order of cutting.
pub(super) fn passes(seat: &Seat<'_>, cells: &Cells<'_>, levels: &[f64]) -> Result<Vec<Pass>, PlanError> {
    let task = seat.task();
    let (count, values) = cells.nodes();
    let grid = Grid { count, values: &values, closes: cells.face.rectangle.closes };
    let stretches: Vec<Stretch<'_>> =
        (0..levels.len()).into_par_iter().flat_map_iter(|k| stretches(cells, grid, levels, k)).collect();
    let ordered = in_order(stretches, NEXT * task.cutter.radius_mm());
    let done = std::sync::atomic::AtomicUsize::new(0);
    let total = ordered.len();
    let built: Vec<Result<Pass, PlanError>> = ordered
        .par_iter()
        .map(|s| {
            let pass = build(seat, cells, s);
            let n = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            (task.progress)(0.5 + 0.5 * n as f64 / total as f64);
            pass
        })
        .collect();
    built.into_iter().filter(|p| p.as_ref().map_or(true, |p| p.points.len() > 1)).collect()
}

/// The stretches of one level over which the face needs a pass.
fn stretches<'a>(cells: &Cells<'a>, grid: Grid<'_>, levels: &[f64], k: usize) -> Vec<Stretch<'a>> {
    let level = levels[k];
    let below = k.checked_sub(1).map_or(f64::NEG_INFINITY, |j| level - 0.75 * (level - levels[j]));
    let above = levels.get(k + 1).map_or(f64::INFINITY, |a| level + 0.75 * (a - level));
    let mut out = Vec::new();
    for line in trace(cells.face, grid, level) {
        let length = line.length();
        let middle = cells.width_mm(line.near(0.5 * length).at);
        let looks = (length / middle * STEPS).clamp(8.0, MOST_LOOKS).ceil();
        let needed = |line: &Traced<'_>, t: f64| {
            let node = line.near(t);
            let at = line.between(t);
            let most = 1.5 * cells.width_mm(at);
            let by = |to: f64| {
                let d = ((to - level) / node.slope_per_mm).clamp(-most, most);
                uv(at.u + node.uphill.u * d, at.v + node.uphill.v * d)
            };
            cells.needed(at, at, 0) || cells.needed(by(below), by(above), ROWS)
        };
        let at = |j: usize| length * j as f64 / looks;
        let marks: Vec<bool> = (0..=looks as usize).map(|j| needed(&line, at(j))).collect();
        if marks.iter().all(|m| *m) {
            let whole_loop = line.closed;
            out.push(Stretch {
                line,
                range: [0.0, length],
                whole_loop,
                level: k,
                reversed: cells.ways.reversed(k),
            });
            continue;
        }
        let Some(gap) = marks.iter().position(|m| !m) else { continue };
        // A loop that is not needed all around begins where it is not.
        let start = line.nodes.partition_point(|n| n.s < at(gap));
        let line = line.begun_at(start);
        let mut found = Vec::new();
        for j in 0..=looks as usize {
            let t = at(j);
            if needed(&line, t) {
                // The edge of a strip is cut a little before or after its middle.
                let half = 0.5 * cells.width_mm(line.between(t));
                found.push([(t - half).max(0.0), (t + half).min(length)]);
            }
        }
        for range in union(found, 1.5 * length / looks + 0.5 * middle) {
            let reversed = cells.ways.reversed(k);
            out.push(Stretch { line: line.clone(), range, whole_loop: false, level: k, reversed });
        }
    }
    out
}

impl Stretch<'_> {
    fn end(&self, k: usize) -> Point3 {
        self.line.near(self.range[k]).point
    }

    /// The nearest place at which the pass can begin: its distance, and the node of a loop or the end (0 or 1).
    fn nearest(&self, from: &Point3) -> (f64, usize) {
        let starts = match (self.whole_loop, self.reversed) {
            (true, _) => 0..self.line.nodes.len() - 1,
            (false, None) => 0..2,
            (false, Some(r)) => usize::from(r)..usize::from(r) + 1,
        };
        let at = |k: usize| if self.whole_loop { self.line.nodes[k].point } else { self.end(k) };
        starts
            .map(|k| ((at(k) - from).norm(), k))
            .fold((f64::INFINITY, 0), |a, b| if b.0 < a.0 { b } else { a })
    }
}

/// The order of cutting: the nearest pass next, else the lowest that is left; loops all the same way around.
fn in_order(stretches: Vec<Stretch<'_>>, reach_mm: f64) -> Vec<Stretch<'_>> {
    let mut open: Vec<Option<Stretch<'_>>> = stretches.into_iter().map(Some).collect();
    let mut out: Vec<Stretch<'_>> = Vec::with_capacity(open.len());
    let mut lowest = 0;
    let mut position: Option<Point3> = None;
    while let Some(first) = (lowest..open.len()).find(|k| open[*k].is_some()) {
        lowest = first;
        let first_way = open[first].as_ref().and_then(|s| s.reversed).unwrap_or(false);
        let mut chosen = (first, usize::from(first_way));
        if let Some(from) = position {
            let last = out.last().map_or(0, |s| s.level);
            let mut best = reach_mm;
            for (k, s) in open.iter().enumerate().skip(first) {
                let Some(s) = s else { continue };
                if s.level > last + 1 {
                    break;
                }
                let (d, start) = s.nearest(&from);
                if d < best {
                    (best, chosen) = (d, (k, start));
                }
            }
            if best == reach_mm
                && let Some(s) = &open[first]
            {
                chosen.1 = s.nearest(&from).1;
            }
        }
        let Some(mut s) = open[chosen.0].take() else { continue };
        if s.whole_loop {
            s.line = s.line.begun_at(chosen.1);
            s.line.reversed = s.reversed.unwrap_or(false);
            position = s.line.nodes.last().map(|n| n.point);
        } else {
            s.line.reversed = chosen.1 == 1;
            position = Some(s.end(1 - chosen.1));
        }
        out.push(s);
    }
    out
}

fn build(seat: &Seat<'_>, cells: &Cells<'_>, stretch: &Stretch<'_>) -> Result<Pass, PlanError> {
    let task = seat.task();
    let line = &stretch.line;
    let step = task.cutter.radius_mm();
    let [lo, hi] = stretch.range;
    let count = ((hi - lo) / step).ceil().max(1.0);
    let stops: Vec<f64> = (0..=count as usize).map(|k| lo + (hi - lo) * k as f64 / count).collect();
    fits(seat, line, &stops)?;
    let range = if line.reversed { [hi, lo] } else { [lo, hi] };
    let knots = resample(seat, task, line, range, &stops).map_err(|e| task.contact(e.into()))?;
    let mut points = contact_points(&knots, |t| line.uv(t));
    for p in &mut points {
        p.width_mm = cells.width_mm(p.uv);
    }
    Ok(Pass { points, closed: stretch.whole_loop })
}
