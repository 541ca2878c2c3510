//! Distances over the nodes of a lattice: to lines straight on, and from places by the shortest way that is free.

use super::contour::Line;
use super::grid::Grid;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Distances of all nodes to the nearest of some lines, mm; infinite where there is none. Where several are as near the nearest may be
/// missed by a small part of a cell.
pub(super) fn distances(grid: &Grid, lines: &[Line]) -> Vec<f64> {
    let mut pieces: Vec<[[f64; 2]; 2]> = Vec::new();
    for line in lines {
        pieces.extend(line.points.windows(2).map(|w| [w[0], w[1]]));
        if let (true, Some(first), Some(last)) = (line.closed, line.points.first(), line.points.last()) {
            pieces.push([*last, *first]);
        }
    }
    let away = |k: usize, piece: u32| {
        let [a, b] = pieces[piece as usize];
        let (p, d) = (grid.at(k), [b[0] - a[0], b[1] - a[1]]);
        let w = [p[0] - a[0], p[1] - a[1]];
        let long = d[0] * d[0] + d[1] * d[1];
        let t = if long > 0.0 { ((w[0] * d[0] + w[1] * d[1]) / long).clamp(0.0, 1.0) } else { 0.0 };
        (w[0] - t * d[0]).hypot(w[1] - t * d[1])
    };
    let mut nearest: Vec<(f64, u32)> = vec![(f64::INFINITY, u32::MAX); grid.len()];
    for (n, [a, b]) in pieces.iter().enumerate() {
        let steps = ((b[0] - a[0]).hypot(b[1] - a[1]) / grid.cell).ceil().max(1.0) as usize;
        for s in 0..=steps {
            let f = s as f64 / steps as f64;
            let p = [0, 1].map(|k| a[k] + (b[k] - a[k]) * f);
            for k in grid.around(p).into_iter().flat_map(|(all, _)| all) {
                let d = away(k, n as u32);
                if d < nearest[k].0 {
                    nearest[k] = (d, n as u32);
                }
            }
        }
    }
    // What is nearest to a node is nearest to one beside it as a rule: handed on in four sweeps, twice.
    let [ni, nj] = grid.n;
    for sweep in 0..8 {
        let (rows_back, columns_back) = (sweep % 4 >= 2, sweep % 2 == 1);
        for j in 0..nj {
            let j = if rows_back { nj - 1 - j } else { j };
            for i in 0..ni {
                let k = j * ni + if columns_back { ni - 1 - i } else { i };
                for m in grid.beside(k, true) {
                    let piece = nearest[m].1;
                    if piece != u32::MAX && piece != nearest[k].1 && nearest[m].0 < nearest[k].0 + 2.0 * grid.cell {
                        let d = away(k, piece);
                        if d < nearest[k].0 {
                            nearest[k] = (d, piece);
                        }
                    }
                }
            }
        }
    }
    nearest.into_iter().map(|n| n.0).collect()
}

/// A node that a front reaches, the nearest first.
struct Reached {
    at: f64,
    node: usize,
}

impl PartialEq for Reached {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Reached {}
impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.at.total_cmp(&self.at).then(other.node.cmp(&self.node))
    }
}

/// How far free nodes are from the sources by a way over free ones, mm; infinite where there is none, no number where a node is not
/// free. A front goes out from the sources, whose slope is one (fast marching): distances are good to a few parts of a hundred.
pub(super) fn ways(grid: &Grid, free: &[bool], sources: impl Iterator<Item = usize>) -> Vec<f64> {
    let mut out: Vec<f64> = free.iter().map(|f| if *f { f64::INFINITY } else { f64::NAN }).collect();
    let mut settled = vec![false; grid.len()];
    let mut heap = BinaryHeap::new();
    for node in sources.filter(|k| free[*k]) {
        out[node] = 0.0;
        heap.push(Reached { at: 0.0, node });
    }
    let [ni, nj] = grid.n;
    while let Some(Reached { at, node }) = heap.pop() {
        if settled[node] || at > out[node] {
            continue;
        }
        settled[node] = true;
        for k in grid.beside(node, false) {
            if !free[k] || settled[k] {
                continue;
            }
            let [i, j] = grid.place(k);
            let of = |is: bool, m: usize| if is && settled[m] { out[m] } else { f64::INFINITY };
            let a = of(i > 0, k.wrapping_sub(1)).min(of(i + 1 < ni, (k + 1).min(grid.len() - 1)));
            let b = of(j > 0, k.wrapping_sub(ni).min(grid.len() - 1)).min(of(j + 1 < nj, (k + ni).min(grid.len() - 1)));
            // (d - a)^2 + (d - b)^2 = cell^2 where both are near, else one cell on from the nearer.
            let h = grid.cell;
            let d = if (a - b).abs() < h {
                0.5 * (a + b + (2.0 * h * h - (a - b) * (a - b)).sqrt())
            } else {
                a.min(b) + h
            };
            if d < out[k] {
                out[k] = d;
                heap.push(Reached { at: d, node: k });
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_polygon() {
        let grid = Grid::over([[-8.0, -5.0], [8.0, 5.0]], 0.25);
        let square = vec![[-3.0, -2.0], [3.1, -2.0], [3.1, 2.0], [-3.0, 2.0]];
        let line = Line { points: square.clone(), closed: true };
        let found = distances(&grid, &[line]);
        for k in 0..grid.len() {
            let p = grid.at(k);
            let [dx, dy] = [(-3.0 - p[0]).max(p[0] - 3.1), (-2.0 - p[1]).max(p[1] - 2.0)];
            let want = if dx > 0.0 && dy > 0.0 { dx.hypot(dy) } else { dx.max(dy).abs() };
            assert!((found[k] - want).abs() < 0.05, "{p:?} {} {want}", found[k]);
        }
        assert!(distances(&grid, &[]).iter().all(|d| *d == f64::INFINITY));
    }

    /// Around the end of a wall: two straight ways.
    #[test]
    fn ways_go_around_a_wall() {
        let grid = Grid::over([[-5.0, 0.0], [5.0, 6.0]], 0.1);
        let free: Vec<bool> = (0..grid.len()).map(|k| grid.at(k)[0].abs() > 0.06 || grid.at(k)[1] > 4.0).collect();
        let source = grid.near([-3.0, 0.0]).unwrap();
        let found = ways(&grid, &free, std::iter::once(source));
        let at = |p: [f64; 2]| found[grid.near(p).unwrap()];
        for (p, want) in [([-3.0, 4.0], 4.0), ([-1.0, 2.0], 8f64.sqrt()), ([3.0, 0.0], 10.0)] {
            assert!((at(p) / want - 1.0).abs() < 0.04, "{p:?} {} {want}", at(p));
        }
        assert!(at([0.0, 1.0]).is_nan());
    }
}
