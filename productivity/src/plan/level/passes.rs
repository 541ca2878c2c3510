//! Passes along the level lines: which stretches of them the face needs, in what order, and their contact points.

use super::cells::{Cells, MOST_TURNS};
use super::field::Face;
use super::trace::{Node, Traced, trace};
use crate::plan::cover::union;
use crate::plan::fits::fits;
use crate::plan::line::PassLine;
use crate::plan::march::Grid;
use crate::plan::resample::{contact_points, resample};
use crate::plan::seat::Seat;
use crate::plan::{Pass, PlanError};
use osculate_geom::{Point3, Uv, uv};
use rayon::prelude::*;

/// Rows across a strip in which trims are looked for.
const ROWS: usize = 12;
/// Steps along a strip's width in which they are looked for.
const STEPS: f64 = 4.0;
/// Looks reach so many widths of the strip to both sides.
const BESIDE: f64 = 1.5;
/// Fewest and most looks along a line, about.
const FEWEST_LOOKS: f64 = 8.0;
const MOST_LOOKS: f64 = 20_000.0;
/// Stretches closer to each other than so many widths of the strip are one pass.
const NARROW: f64 = 0.875;
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
        let needed = |line: &Traced<'_>, t: f64| {
            let node = line.near(t);
            let at = line.between(t);
            let most = BESIDE * cells.width_mm(at);
            let by = |to: f64| {
                let d = ((to - level) / node.slope_per_mm).clamp(-most, most);
                uv(at.u + node.uphill.u * d, at.v + node.uphill.v * d)
            };
            cells.needed(at, at, 0) || cells.needed(by(below), by(above), ROWS)
        };
        let corners = corners(cells, &line, [below, above]);
        let marks = looks(cells, &line, &needed, &corners);
        let Some(gap) = marks.iter().find(|m| !m.1) else {
            let (range, whole_loop) = ([0.0, line.length()], line.closed);
            out.push(Stretch { line, range, whole_loop, level: k, reversed: cells.ways.reversed(k) });
            continue;
        };
        // A loop that is not needed all around begins where it is not.
        let (line, marks) = if line.closed {
            let start = line.nodes.partition_point(|n| n.s < gap.0);
            let start_s = line.nodes[start].s;
            let line = line.begun_at(start);
            let length = line.length();
            let corners: Vec<f64> = corners.iter().map(|t| (t - start_s).rem_euclid(length)).collect();
            let marks = looks(cells, &line, &needed, &corners);
            (line, marks)
        } else {
            (line, marks)
        };
        let length = line.length();
        let middle = cells.width_mm(line.near(0.5 * length).at);
        let runs = marks.chunk_by(|a, b| a.1 == b.1).filter(|run| run[0].1);
        let ends = runs.map(|run| {
            // The edge of a strip is cut a little before or after its middle.
            let half = |t: f64| 0.5 * cells.width_mm(line.between(t));
            let (from, to) = (run[0].0, run[run.len() - 1].0);
            [(from - half(from)).max(0.0), (to + half(to)).min(length)]
        });
        for range in union(ends.collect(), NARROW * middle) {
            let reversed = cells.ways.reversed(k);
            out.push(Stretch { line: line.clone(), range, whole_loop: false, level: k, reversed });
        }
    }
    out
}

/// Places along a line, closer where its strip is narrower, and whether the face needs the pass there.
fn looks<'a>(
    cells: &Cells<'a>,
    line: &Traced<'a>,
    needed: &dyn Fn(&Traced<'a>, f64) -> bool,
    corners: &[f64],
) -> Vec<(f64, bool)> {
    let length = line.length();
    let mut out = Vec::new();
    let mut t = 0.0;
    while t < length {
        out.push((t, needed(line, t)));
        let step = cells.width_mm(line.between(t)) / STEPS;
        t += step.min(length / FEWEST_LOOKS).max(length / MOST_LOOKS);
    }
    out.push((length, needed(line, length)));
    out.extend(corners.iter().map(|t| (*t, true)));
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    out
}

/// Where along a line corners of the face between two levels lie beside it: looks may miss what is narrow.
fn corners(cells: &Cells<'_>, line: &Traced<'_>, [below, above]: [f64; 2]) -> Vec<f64> {
    let face = &cells.face;
    let beside = |at: &Uv| {
        let (at, jet, phi) = face.at(*at)?;
        let (uphill, slope) = Face::ascent(&jet, &phi).ok()?;
        let width = cells.width_mm(at);
        let far = (line.level - phi.value).abs() / slope;
        if !(phi.value >= below && phi.value <= above && far <= BESIDE * width) {
            return None;
        }
        let foot = face.surface.point(face.settle(at, uphill, line.level).ok()?);
        let node = line
            .nodes
            .iter()
            .min_by(|a, b| (a.point - foot).norm_squared().total_cmp(&(b.point - foot).norm_squared()))?;
        let along = |a: &Node, b: &Node| {
            let way = b.point - a.point;
            let f = ((foot - a.point).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            ((a.point + way * f - foot).norm(), a.s + (b.s - a.s) * f)
        };
        let k = line.nodes.partition_point(|n| n.s < node.s);
        let near = &line.nodes[k.saturating_sub(1)..(k + 2).min(line.nodes.len())];
        let (d, t) = near.windows(2).map(|w| along(&w[0], &w[1])).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (d <= 0.5 * width).then_some(t)
    };
    face.surface.turns().iter().take(MOST_TURNS).filter_map(beside).collect()
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
