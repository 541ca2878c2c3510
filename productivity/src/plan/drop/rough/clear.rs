//! The order of a roughing: the parts of layers one below the other, and in each the lines that lead through it.
//!
//! A part of a layer hangs together. It comes after those above it, and before another one is begun all that lies below it comes: so the
//! tool stays in a pocket until that is empty. What a line takes is asked of the material as the moves before have left it, and its
//! stretches that take nothing are left out. Rows may lead through each part another way: those that look quickest are tried out there, moves and all.

use super::grid::{Disc, Grid};
use super::layer::{Cut, Sheet};
use super::moves::{Moves, apart};
use super::trial::Tried;
use std::collections::BTreeMap;

/// Lines of lesser order within this many distances of lines come first.
const NEAR: f64 = 1.6;
/// Places of a line that are looked at for what lies near it, in distances of lines.
const LOOK: f64 = 1.0;

/// A way of rows that takes less than this share of what the given one takes is none.
pub(super) const ALL: f64 = 0.999;
/// Ways of rows that are tried out in a part besides the first one: those that look quickest; on the channels of
/// `examples/impeller-whole` all five took 3 % more off the path, ...
const TRIED: usize = 2;
/// ... where going on to the next row counts as so much of a way, in radii of the tool.
const NEXT: f64 = 4.0;

/// The lines of a layer, or of a part of one.
#[derive(Clone, Default)]
pub(super) struct Lines {
    /// The rows along each way that is tried.
    pub rows: Vec<Vec<Cut>>,
    /// The lines along walls.
    pub walls: Vec<Cut>,
}

impl Lines {
    /// Rows along a way, and lines along walls.
    fn of(&self, way: usize) -> Vec<Cut> {
        self.rows[way].iter().chain(&self.walls).cloned().collect()
    }
}

/// Which way rows lead through parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pick {
    /// The first one through all.
    Given,
    /// Through each the one that takes the least time for what it takes.
    Own,
}

/// A part of a layer.
pub(super) struct Part {
    pub layer: usize,
    nodes: Vec<u32>,
    lines: Lines,
    /// How many parts lie above it, and which below.
    above: usize,
    below: Vec<usize>,
}

impl Part {
    /// How far the nearest end of its lines is across the axis; endless where it has none.
    fn away_mm(&self, pick: Pick, here: [f64; 3]) -> f64 {
        let rows = match pick {
            Pick::Given => &self.lines.rows[..1],
            Pick::Own => &self.lines.rows[..],
        };
        let cuts = rows.iter().flatten().chain(&self.lines.walls);
        let ends = cuts.flat_map(|c| c.places.first().into_iter().chain(c.places.last()));
        ends.map(|p| (p[0] - here[0]).hypot(p[1] - here[1])).fold(f64::INFINITY, f64::min)
    }
}

/// The parts of all layers, from the top, each knowing those below it.
pub(super) fn parts(
    grid: &Grid,
    sheets: &[Sheet],
    lines: Vec<Lines>,
    (apart_mm, radius_mm): (f64, f64),
) -> Vec<Part> {
    let mut out: Vec<Part> = Vec::new();
    // The last part over each node.
    let mut over: Vec<u32> = vec![Grid::NONE; grid.len()];
    let reach = Disc::new(radius_mm, grid.cell);
    for (n, (sheet, lines)) in sheets.iter().zip(lines).enumerate() {
        let (part, count) = sheet.masks.parts(grid, 2.0 * apart_mm);
        let first = out.len();
        out.extend((0..count).map(|_| Part {
            layer: n,
            nodes: Vec::new(),
            lines: Lines { rows: vec![Vec::new(); lines.rows.len()], walls: Vec::new() },
            above: 0,
            below: Vec::new(),
        }));
        for k in (0..grid.len()).filter(|k| part[*k] != Grid::NONE) {
            out[first + part[k] as usize].nodes.push(k as u32);
        }
        // A line may go through several parts: each has its stretches.
        for (way, rows) in lines.rows.into_iter().enumerate() {
            for (own, cut) in rows.into_iter().flat_map(|cut| parted(grid, &part, cut)) {
                out[first + own].lines.rows[way].push(cut);
            }
        }
        for (own, cut) in lines.walls.into_iter().flat_map(|cut| parted(grid, &part, cut)) {
            out[first + own].lines.walls.push(cut);
        }
        for p in first..out.len() {
            let mut above: Vec<u32> = Vec::new();
            for k in &out[p].nodes {
                for m in grid.disc(&reach, *k as usize).flatten() {
                    if over[m] != Grid::NONE && above.last() != Some(&over[m]) {
                        above.push(over[m]);
                    }
                }
                if above.len() > 64 {
                    above.sort_unstable();
                    above.dedup();
                }
            }
            above.sort_unstable();
            above.dedup();
            out[p].above = above.len();
            for a in above {
                out[a as usize].below.push(p);
            }
        }
        for (p, part) in out.iter_mut().enumerate().skip(first) {
            for k in std::mem::take(&mut part.nodes) {
                over[k as usize] = p as u32;
            }
        }
    }
    out
}

/// The stretches of a line in each part that it goes through.
fn parted(grid: &Grid, part: &[u32], cut: Cut) -> Vec<(usize, Cut)> {
    let own = |p: &[f64; 3]| grid.near([p[0], p[1]]).map_or(Grid::NONE, |k| part[k]);
    let mut all: Vec<u32> = cut.places.iter().map(&own).filter(|p| *p != Grid::NONE).collect();
    all.sort_unstable();
    all.dedup();
    match all[..] {
        [] => Vec::new(),
        [one] => vec![(one as usize, cut)],
        _ => {
            let mut out: BTreeMap<u32, Vec<Vec<[f64; 3]>>> = BTreeMap::new();
            // A line that closes is begun where it changes parts.
            let n = cut.places.len();
            let start = if cut.closed {
                (0..n).find(|k| own(&cut.places[*k]) != own(&cut.places[(k + n - 1) % n])).unwrap_or(0)
            } else {
                0
            };
            let mut last = Grid::NONE;
            for k in 0..n {
                let p = cut.places[(start + k) % n];
                let here = own(&p);
                if here != Grid::NONE {
                    let runs = out.entry(here).or_default();
                    if here != last {
                        runs.push(Vec::new());
                    }
                    if let Some(run) = runs.last_mut() {
                        run.push(p);
                    }
                }
                last = here;
            }
            let stretch = |(own, runs): (u32, Vec<Vec<[f64; 3]>>)| {
                runs.into_iter().map(move |places| (own as usize, places))
            };
            out.into_iter()
                .flat_map(stretch)
                .filter(|(_, places)| places.len() > 1)
                .map(|(own, places)| (own, Cut { places, closed: false, ..cut.clone() }))
                .collect()
        }
    }
}

/// Cuts all parts, each after those above it; how many passes rows along each way have, comes back.
pub(super) fn clear(
    parts: &[Part],
    sheets: &[Sheet],
    moves: &mut Moves<'_>,
    (apart_mm, pick): (f64, Pick),
) -> Vec<usize> {
    let mut passes = vec![0; parts.first().map_or(0, |p| p.lines.rows.len())];
    let mut ready: Vec<Vec<usize>> = vec![(0..parts.len()).filter(|p| parts[*p].above == 0).collect()];
    let mut left: Vec<usize> = parts.iter().map(|p| p.above).collect();
    // What lies below the part that was cut last comes next, the nearest of it first: the list is a stack.
    while let Some(group) = ready.last_mut() {
        let here = moves.here();
        let away = |p: &usize| here.map_or(0.0, |h| parts[*p].away_mm(pick, h));
        let nearest = (0..group.len()).min_by(|a, b| away(&group[*a]).total_cmp(&away(&group[*b])));
        let Some(p) = nearest.map(|k| group.remove(k)) else {
            ready.pop();
            continue;
        };
        let (sheet, lines) = (&sheets[parts[p].layer], &parts[p].lines);
        let way = match pick {
            Pick::Given => 0,
            Pick::Own => quickest(moves, sheet, lines, apart_mm),
        };
        let before = moves.passes.len();
        cut_part(moves, sheet, lines.of(way), apart_mm);
        passes[way] += moves.passes.len() - before;
        let mut next = Vec::new();
        for b in &parts[p].below {
            left[*b] -= 1;
            if left[*b] == 0 {
                next.push(*b);
            }
        }
        ready.push(next);
    }
    passes
}

/// The way of rows that takes the least time for what it takes, of those that leave nothing high that the first one does not.
fn quickest(moves: &mut Moves<'_>, sheet: &Sheet, lines: &Lines, apart_mm: f64) -> usize {
    // By their looks: how long rows are, and how often the tool goes on to the next.
    let next_mm = NEXT * moves.site.tool.bare.radius_mm;
    let looks_mm = |way: &usize| lines.rows[*way].iter().map(|c| long(c) + next_mm).sum::<f64>();
    let mut ways: Vec<usize> = (1..lines.rows.len()).filter(|way| !lines.rows[*way].is_empty()).collect();
    ways.sort_by(|a, b| looks_mm(a).total_cmp(&looks_mm(b)).then(a.cmp(b)));
    ways.truncate(TRIED);
    let mut tried = |way: usize| {
        (way, moves.tried(sheet.layer.floor, |moves| cut_part(moves, sheet, lines.of(way), apart_mm)))
    };
    let (_, given) = tried(0);
    let fits = |t: &Tried| t.clears_all_of(&given) && t.taken_mm3 >= ALL * given.taken_mm3;
    let slow = |t: &Tried| t.min / t.taken_mm3;
    let others = ways.into_iter().map(tried).filter(|(_, t)| t.taken_mm3 > 0.0 && fits(t));
    let best =
        others.filter(|(_, t)| slow(t) < slow(&given)).min_by(|a, b| slow(&a.1).total_cmp(&slow(&b.1)));
    best.map_or(0, |b| b.0)
}

/// The length of a line, mm.
fn long(cut: &Cut) -> f64 {
    cut.places.windows(2).map(|w| apart(w[0], w[1])).sum()
}

fn cut_part(moves: &mut Moves<'_>, sheet: &Sheet, cuts: Vec<Cut>, apart_mm: f64) {
    let before = befores(&cuts, apart_mm);
    let mut waits: Vec<usize> = before.iter().map(|(count, _)| *count).collect();
    let mut open: Vec<Option<Cut>> = cuts.into_iter().map(Some).collect();
    let mut count = open.len();
    while count > 0 {
        let nearest = nearest(&open, &waits, moves.here());
        // Lines that wait for each other in a ring cannot be: their orders grow.
        let Some(k) = nearest else { return };
        let Some(cut) = open[k].take() else { return };
        count -= 1;
        moves.cut(sheet, cut);
        for b in &before[k].1 {
            waits[*b] = waits[*b].saturating_sub(1);
        }
    }
}

/// For each line how many come before it, and which come after.
fn befores(cuts: &[Cut], apart_mm: f64) -> Vec<(usize, Vec<usize>)> {
    let mut out: Vec<(usize, Vec<usize>)> = vec![(0, Vec::new()); cuts.len()];
    if cuts.iter().all(|c| c.order == cuts[0].order) {
        return out;
    }
    // Places of all lines in cells as wide as lines are near.
    let cell = NEAR * apart_mm;
    let bin = |p: &[f64; 3]| [0, 1].map(|k| (p[k] / cell).floor() as i64);
    let mut bins: BTreeMap<[i64; 2], Vec<u32>> = BTreeMap::new();
    for (k, cut) in cuts.iter().enumerate() {
        let mut last: Option<[f64; 3]> = None;
        for p in &cut.places {
            if last.is_none_or(|l| (p[0] - l[0]).hypot(p[1] - l[1]) >= LOOK * apart_mm) {
                last = Some(*p);
                let own = bins.entry(bin(p)).or_default();
                if own.last() != Some(&(k as u32)) {
                    own.push(k as u32);
                }
            }
        }
    }
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    for ([i, j], own) in &bins {
        for (di, dj) in (-1..=1).flat_map(|a| (-1..=1).map(move |b| (a, b))) {
            for other in bins.get(&[i + di, j + dj]).into_iter().flatten() {
                let less = |k: &&u32| cuts[**k as usize].order < cuts[*other as usize].order;
                pairs.extend(own.iter().filter(less).map(|k| (*k, *other)));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    for (first, then) in pairs {
        out[then as usize].0 += 1;
        out[first as usize].1.push(then as usize);
    }
    out
}

/// The line that begins nearest, of those that wait for none.
fn nearest(open: &[Option<Cut>], waits: &[usize], here: Option<[f64; 3]>) -> Option<usize> {
    let mut best: Option<(f64, usize)> = None;
    for (k, cut) in open.iter().enumerate().filter(|(k, _)| waits[*k] == 0) {
        let Some(cut) = cut else { continue };
        let Some(h) = here else { return Some(k) };
        let ends = cut.places.first().into_iter().chain(cut.places.last());
        // A line that closes may be begun anywhere.
        let places: Vec<&[f64; 3]> = if cut.closed { cut.places.iter().collect() } else { ends.collect() };
        for p in places {
            let d = (p[0] - h[0]).hypot(p[1] - h[1]);
            if best.is_none_or(|b| d < b.0) {
                best = Some((d, k));
            }
        }
    }
    best.map(|b| b.1)
}
