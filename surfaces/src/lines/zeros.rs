//! Zeros of a plane vector field over a chart, with their rotation numbers.
//!
//! Each cell is sampled at nine points. With the linear model of the samples and twice its greatest misfit as the
//! allowance for what lies between them, a cell is excluded where a component of the field, or of the field
//! multiplied by the inverse of its matrix, cannot vanish; it is settled by Newton's method where the misfit is so
//! small that there can be but one zero; else it is cut in four. Cells that stay open at the greatest depth are
//! degenerate zeros or lines of zeros. The rotation of the field around each zero is counted by following its angle.
//!
//! Nothing here trusts the count: the sum of the rotations is to be compared with [`boundary_rotation`].

use super::chart::Chart;
use super::near::Near;
use osculate_geom::solve::general;
use osculate_geom::{Axis, Interval, Uv, uv};
use rayon::prelude::*;
use std::collections::{HashMap, VecDeque};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// A plane vector field; `None` where it has no value.
pub(crate) type Plane<'f> = &'f (dyn Fn(Uv) -> Option<[f64; 2]> + Sync);

/// An isolated zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zero {
    /// Where.
    pub at: Uv,
    /// Turns of the field around it, counter-clockwise in (u, v); `None` where they could not be counted.
    pub rotation: Option<i32>,
    /// Whether the field's matrix there is regular.
    pub simple: bool,
}

/// What a search found.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Zeros {
    /// Isolated zeros, by rising u, then v.
    pub points: Vec<Zero>,
    /// Middles of small cells along each line of zeros.
    pub lines: Vec<Vec<Uv>>,
    /// Middles of whole cells in which the field is below the floor.
    pub flat: Vec<Uv>,
    /// Cells in which the field has no value everywhere.
    pub undefined: usize,
    /// Cells whose halving ended sooner than elsewhere since the whole face is full of zeros.
    pub coarse: usize,
}

/// Cells are halved at most this often: to a thousandth of a cell of the chart.
const DEPTH: u32 = 10;
/// Open pieces of one cell at which halving ends: a line of zeros, not a point.
const MOST_OPEN: usize = 120;
/// Open pieces of all cells together. A face full of zeros, whose field is noise, has that many; its cells get fewer pieces each, and
/// what lies in them is a line of zeros all the same.
const MOST_OPEN_IN_ALL: usize = 60_000;
/// Fewest pieces that a cell is cut into before halving ends.
const FEWEST_OPEN: usize = 4;
/// Twice the misfit of the samples stands for what lies between them.
const BETWEEN: f64 = 2.0;
/// Open pieces that reach over more than this part of a cell are a line.
const POINT_EXTENT: f64 = 0.05;

#[derive(Clone, Copy)]
struct Cell {
    middle: Uv,
    half: [f64; 2],
    depth: u32,
}

enum Verdict {
    Empty,
    Zero(Uv),
    Flat,
    Open,
    Undefined,
}

/// The zeros of `field` over the chart; values below `floor` count as zero.
pub(crate) fn zeros(chart: &Chart, field: Plane, floor: f64) -> Zeros {
    let mut cells = Vec::new();
    for u in chart.borders(Axis::U).windows(2) {
        for v in chart.borders(Axis::V).windows(2) {
            let middle = uv(0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
            cells.push(Cell { middle, half: [0.5 * (u[1] - u[0]), 0.5 * (v[1] - v[0])], depth: 0 });
        }
    }
    let first: Vec<Verdict> = cells.par_iter().map(|c| judge(chart, field, floor, c)).collect();
    let many = first.iter().filter(|v| matches!(v, Verdict::Open | Verdict::Undefined)).count();
    let most_open = (MOST_OPEN_IN_ALL / many.max(1)).clamp(FEWEST_OPEN, MOST_OPEN);
    let found: Vec<Findings> = cells
        .par_iter()
        .zip(first)
        .map(|(c, first)| search(chart, field, floor, Root { cell: *c, first, most_open }))
        .collect();
    let mut out = Zeros::default();
    let mut simple: Vec<Uv> = Vec::new();
    let mut known = Near::new(chart);
    let mut open: Vec<Cell> = Vec::new();
    for f in found {
        out.flat.extend(f.flat);
        out.undefined += f.undefined;
        out.coarse += usize::from(f.coarse);
        for at in f.zeros {
            if !known.reaches(at) {
                known.add(at, SAME);
                simple.push(at);
            }
        }
        open.extend(f.open);
    }
    // Flat cells spoil the pieces at their rim: what touches one belongs to it.
    if !(open.is_empty() && simple.is_empty()) {
        let flat = Near::of(chart, out.flat.iter().copied(), BESIDE_FLAT);
        open.retain(|c| !flat.reaches(c.middle));
        simple.retain(|z| !flat.reaches(*z));
    }
    let known = Near::of(chart, simple.iter().copied(), 2.0 * POINT_EXTENT + SAME);
    let mut singular = Vec::new();
    for cluster in clusters(chart, &open) {
        let extent = extent(chart, &cluster);
        if extent > POINT_EXTENT {
            out.lines.push(cluster.iter().map(|c| c.middle).collect());
        } else {
            let middle = best(field, &cluster);
            if !known.around(middle).any(|z| z.1 <= 2.0 * extent + SAME) {
                singular.push((middle, extent));
            }
        }
    }
    // A simple zero on a line of zeros is a point of that line.
    let lines = Near::of(chart, out.lines.iter().flatten().copied(), 4.0 * POINT_EXTENT);
    simple.retain(|z| !lines.reaches(*z));
    let all = Near::of(chart, simple.iter().copied().chain(singular.iter().map(|s| s.0)), CIRCLE);
    let around = |at: Uv, least: f64| {
        // Half the way to the next zero, in cells, and at most a quarter of a cell.
        let next = all.around(at).filter(|z| z.0 != at).map(|z| z.1).fold(CIRCLE, f64::min);
        circle_rotation(chart, field, at, (0.5 * next).max(least))
    };
    out.points.extend(simple.iter().map(|at| Zero { at: *at, rotation: around(*at, 0.0), simple: true }));
    for (at, extent) in &singular {
        out.points.push(Zero { at: *at, rotation: around(*at, 3.0 * extent), simple: false });
    }
    out.points.sort_by(|a, b| a.at.u.total_cmp(&b.at.u).then(a.at.v.total_cmp(&b.at.v)));
    out
}

/// Two zeros nearer than this, in half cells, are one: Newton's last step is far below.
const SAME: f64 = 1e-6;
/// What is within this many half cells of the middle of a flat cell touches it: its own half, a cell's, and a tenth for rounding.
const BESIDE_FLAT: f64 = 2.2;
/// Diameter of the circle along which turns around a zero are counted, in half cells, where no other zero is nearer.
const CIRCLE: f64 = 0.5;

#[derive(Default)]
struct Findings {
    zeros: Vec<Uv>,
    flat: Option<Uv>,
    open: Vec<Cell>,
    undefined: usize,
    coarse: bool,
}

/// A cell of the chart with what is found of it as a whole, and the open pieces at which its halving ends.
struct Root {
    cell: Cell,
    first: Verdict,
    most_open: usize,
}

fn search(chart: &Chart, field: Plane, floor: f64, root: Root) -> Findings {
    let mut out = Findings::default();
    let mut queue = VecDeque::from([root.cell]);
    let mut first = Some(root.first);
    while let Some(cell) = queue.pop_front() {
        match first.take().unwrap_or_else(|| judge(chart, field, floor, &cell)) {
            Verdict::Empty => {}
            Verdict::Zero(at) => out.zeros.push(at),
            Verdict::Flat if cell.depth == 0 => out.flat = Some(cell.middle),
            Verdict::Undefined if cell.depth >= 3 => out.undefined += 1,
            Verdict::Flat => out.open.push(cell),
            Verdict::Open | Verdict::Undefined => {
                if cell.depth >= DEPTH || out.coarse || queue.len() > root.most_open {
                    // On a face full of zeros for good: else pieces go on to be cut as others are taken from the queue.
                    out.coarse |= cell.depth < DEPTH && root.most_open < MOST_OPEN;
                    out.open.push(cell);
                    continue;
                }
                let half = cell.half.map(|h| 0.5 * h);
                for (su, sv) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                    let middle = uv(cell.middle.u + su * half[0], cell.middle.v + sv * half[1]);
                    queue.push_back(Cell { middle, half, depth: cell.depth + 1 });
                }
            }
        }
    }
    out
}

/// Places of the samples in a cell, the middle first, then right, left, top, bottom and the corners.
const PLACES: [[f64; 2]; 9] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, 1.0],
    [0.0, -1.0],
    [-1.0, -1.0],
    [-1.0, 1.0],
    [1.0, -1.0],
    [1.0, 1.0],
];

fn judge(chart: &Chart, field: Plane, floor: f64, cell: &Cell) -> Verdict {
    let mut g = [[0.0; 2]; 9];
    for (g, p) in g.iter_mut().zip(PLACES) {
        let at = uv(cell.middle.u + p[0] * cell.half[0], cell.middle.v + p[1] * cell.half[1]);
        match field(at) {
            Some(x) if x[0].is_finite() && x[1].is_finite() => *g = x,
            _ => return Verdict::Undefined,
        }
    }
    if g.iter().all(|x| x[0].hypot(x[1]) <= floor) {
        return Verdict::Flat;
    }
    // The matrix in half cells.
    let j = [0, 1].map(|k| [0.5 * (g[1][k] - g[2][k]), 0.5 * (g[3][k] - g[4][k])]);
    let misfit: [[f64; 2]; 9] = std::array::from_fn(|i| {
        [0, 1].map(|k| g[i][k] - g[0][k] - j[k][0] * PLACES[i][0] - j[k][1] * PLACES[i][1])
    });
    let worst = |of: &dyn Fn([f64; 2]) -> f64| misfit.iter().map(|m| of(*m).abs()).fold(0.0, f64::max);
    for k in 0..2 {
        if g[0][k].abs() > j[k][0].abs() + j[k][1].abs() + BETWEEN * worst(&|m| m[k]) + floor {
            return Verdict::Empty;
        }
    }
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    let size = j.iter().flatten().map(|x| x * x).sum::<f64>();
    // Below this the inverse has no digits.
    if det.abs() <= 1e-10 * size {
        return Verdict::Open;
    }
    let solve = |b: [f64; 2]| general(j, b);
    let bend = BETWEEN * worst(&|m| solve(m)[0]).max(worst(&|m| solve(m)[1]));
    let p = solve(g[0]);
    if p[0].abs().max(p[1].abs()) > 1.0 + bend {
        return Verdict::Empty;
    }
    if bend > 0.5 {
        return Verdict::Open;
    }
    let start = uv(cell.middle.u - p[0] * cell.half[0], cell.middle.v - p[1] * cell.half[1]);
    // A jump of the field between samples is no zero: what is left there must be small beside its change.
    let left = |at: Uv| field(at).map_or(f64::INFINITY, |g| g[0].hypot(g[1])) <= 1e-5 * size.sqrt() + floor;
    match newton(chart, field, start, cell.half).filter(|at| left(*at)) {
        Some(at) => {
            let d = chart.between(cell.middle, at);
            // A zero on the border is found from both sides and counted once.
            let inside = |d: f64, half: f64| d.abs() <= half * (1.0 + 1e-6);
            if inside(d.u, cell.half[0]) && inside(d.v, cell.half[1]) {
                Verdict::Zero(at)
            } else {
                Verdict::Empty
            }
        }
        None => Verdict::Open,
    }
}

/// Newton's method with a matrix of central differences over a ten-thousandth of the cell.
fn newton(chart: &Chart, field: Plane, start: Uv, half: [f64; 2]) -> Option<Uv> {
    let step = [1e-4 * half[0], 1e-4 * half[1]];
    let mut at = start;
    let mut last = f64::INFINITY;
    for _ in 0..40 {
        let g = field(at)?;
        let side = |du: f64, dv: f64| field(uv(at.u + du, at.v + dv));
        let (r, l) = (side(step[0], 0.0)?, side(-step[0], 0.0)?);
        let (t, b) = (side(0.0, step[1])?, side(0.0, -step[1])?);
        let j = [0, 1].map(|k| [0.5 * (r[k] - l[k]) / step[0], 0.5 * (t[k] - b[k]) / step[1]]);
        let [du, dv] = general(j, g);
        let d = uv(du, dv);
        if !(d.u.is_finite() && d.v.is_finite()) {
            return None;
        }
        let size = (d.u / half[0]).abs().max((d.v / half[1]).abs());
        if size > 4.0 {
            return None;
        }
        at = clamp_open(chart, uv(at.u - d.u, at.v - d.v));
        // Rounding is reached where steps stop shrinking.
        if size < 1e-15 || (size < 1e-8 && size >= 0.5 * last) {
            return Some(chart.domain().bring(at));
        }
        last = size;
    }
    (last < 1e-6).then(|| chart.domain().bring(at))
}

/// Parameters kept inside the directions that do not close.
fn clamp_open(chart: &Chart, at: Uv) -> Uv {
    let one = |i: Interval, t: f64| if i.periodic { t } else { t.clamp(i.lo, i.hi) };
    uv(one(chart.domain().u, at.u), one(chart.domain().v, at.v))
}

/// Pieces that touch, together. Pieces are compared with those of the same cell of the chart and of its neighbours
/// only.
fn clusters(chart: &Chart, open: &[Cell]) -> Vec<Vec<Cell>> {
    let counts = [Axis::U, Axis::V].map(|axis| chart.borders(axis).len() - 1);
    let key = |c: &Cell| [chart.column(Axis::U, c.middle.u), chart.column(Axis::V, c.middle.v)];
    let mut boxes: HashMap<[usize; 2], Vec<usize>> = HashMap::new();
    for (k, c) in open.iter().enumerate() {
        boxes.entry(key(c)).or_default().push(k);
    }
    let touches = |a: &Cell, b: &Cell| {
        let d = chart.between(a.middle, b.middle);
        d.u.abs() <= 1.01 * (a.half[0] + b.half[0]) && d.v.abs() <= 1.01 * (a.half[1] + b.half[1])
    };
    let mut seen = vec![false; open.len()];
    let mut out = Vec::new();
    for first in 0..open.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut cluster = vec![first];
        let mut k = 0;
        while k < cluster.len() {
            let here = &open[cluster[k]];
            let [i, j] = key(here);
            for (di, dj) in (0..9).map(|n| (n / 3, n % 3)) {
                // One back, one on, around where a parameter closes; the wrong neighbours of an open side are far.
                let near = [(i + counts[0] + di - 1) % counts[0], (j + counts[1] + dj - 1) % counts[1]];
                for n in boxes.get(&near).into_iter().flatten() {
                    if !seen[*n] && touches(here, &open[*n]) {
                        seen[*n] = true;
                        cluster.push(*n);
                    }
                }
            }
            k += 1;
        }
        out.push(cluster.into_iter().map(|k| open[k]).collect());
    }
    out
}

/// How far a cluster reaches, in half cells of the chart.
fn extent(chart: &Chart, cluster: &[Cell]) -> f64 {
    let first = cluster[0];
    let half = chart.half_cell(first.middle);
    let reach = |d: f64, own: f64, half: f64| (d.abs() + own) / half;
    cluster
        .iter()
        .map(|c| {
            let d = chart.between(first.middle, c.middle);
            reach(d.u, c.half[0], half[0]).max(reach(d.v, c.half[1], half[1]))
        })
        .fold(0.0, f64::max)
}

/// The middle with the smallest field.
fn best(field: Plane, cluster: &[Cell]) -> Uv {
    let size = |c: &Cell| field(c.middle).map_or(f64::INFINITY, |g| g[0].hypot(g[1]));
    let mut found = (f64::INFINITY, cluster[0].middle);
    for c in cluster {
        let s = size(c);
        if s < found.0 {
            found = (s, c.middle);
        }
    }
    found.1
}

/// Turns of the field along a closed way, given by a parameter from 0 to 1; `None` where the field vanishes or has
/// no value on it.
pub(crate) fn rotation(field: Plane, way: &dyn Fn(f64) -> Uv) -> Option<i32> {
    Some((turned(field, way)? / TAU).round() as i32)
}

/// The angle by which the field turns along a way; `None` where it cannot be followed.
fn turned(field: Plane, way: &dyn Fn(f64) -> Uv) -> Option<f64> {
    /// Pieces that the way is cut into at first: a field that turns four times and more is followed.
    const PIECES: u32 = 64;
    /// A piece is halved at most this often.
    const HALVINGS: u32 = 20;
    let angle = |t: f64| {
        let g = field(way(t))?;
        let size = g[0].hypot(g[1]);
        (size > 0.0 && size.is_finite()).then(|| g[1].atan2(g[0]))
    };
    let mut total = 0.0;
    let mut from = (0.0, angle(0.0)?);
    for k in 1..=PIECES {
        let mut goals = vec![(f64::from(k) / f64::from(PIECES), HALVINGS)];
        while let Some((t, halvings)) = goals.pop() {
            let (a, middle) = (angle(t)?, 0.5 * (from.0 + t));
            let half = turn(from.1, angle(middle)?);
            let rest = turn(from.1 + half, a);
            if half.abs() < FRAC_PI_4 && rest.abs() < FRAC_PI_4 {
                total += half + rest;
                from = (t, a);
            } else if halvings == 0 {
                return None;
            } else {
                goals.push((t, halvings - 1));
                goals.push((middle, halvings - 1));
            }
        }
    }
    Some(total)
}

/// The turn from one angle to another, in (-pi, pi].
fn turn(from: f64, to: f64) -> f64 {
    let d = (to - from).rem_euclid(TAU);
    if d > PI { d - TAU } else { d }
}

/// Rotation on a circle around `at`, its radius in half cells, shrunk where it leaves the rectangle or cannot be
/// followed.
fn circle_rotation(chart: &Chart, field: Plane, at: Uv, radius: f64) -> Option<i32> {
    let half = chart.half_cell(at);
    let mut r = radius.min(0.5);
    for _ in 0..12 {
        let on = |t: f64| {
            let (s, c) = (TAU * t).sin_cos();
            uv(at.u + r * half[0] * c, at.v + r * half[1] * s)
        };
        let fits = (0..16).all(|k| chart.domain().contains(on(f64::from(k) / 16.0)));
        if fits && let Some(n) = rotation(field, &on) {
            return Some(n);
        }
        r *= 0.5;
    }
    None
}

/// Turns of the field along the border of the rectangle searched, counter-clockwise: with both parameters closed
/// there is no border and no turn, with one closed it consists of two rings. `None` where the field vanishes on it.
pub(crate) fn boundary_rotation(chart: &Chart, field: Plane) -> Option<i32> {
    let d = *chart.domain();
    let ring = |axis: Axis, fixed: f64| {
        let along = d.get(axis);
        rotation(field, &|t| Uv::from_axis(axis, along.at(t), fixed))
    };
    match (d.u.periodic, d.v.periodic) {
        (true, true) => Some(0),
        (true, false) => Some(ring(Axis::U, d.v.lo)? - ring(Axis::U, d.v.hi)?),
        (false, true) => Some(ring(Axis::V, d.u.hi)? - ring(Axis::V, d.u.lo)?),
        (false, false) => rotation(field, &|t| {
            let s = 4.0 * t;
            match s {
                _ if s < 1.0 => d.at(s, 0.0),
                _ if s < 2.0 => d.at(1.0, s - 1.0),
                _ if s < 3.0 => d.at(3.0 - s, 1.0),
                _ => d.at(0.0, (4.0 - s).max(0.0)),
            }
        }),
    }
}

/// Turns of the field along the ring around a pole, in the sense in which the other parameter rises.
pub(crate) fn ring_rotation(chart: &Chart, field: Plane, axis: Axis, high: bool) -> Option<i32> {
    let i = chart.domain().get(axis);
    let along = chart.domain().get(axis.other());
    let fixed = if high { i.hi } else { i.lo };
    rotation(field, &|t| Uv::from_axis(axis.other(), along.at(t), fixed))
}
