//! Level lines of values on a grid: marching squares, the pieces chained, across seams where the grid closes.

use std::collections::{HashMap, HashSet};

/// Values at the nodes of a grid, `(count[0] + 1) x (count[1] + 1)` in rows of the second index.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a> {
    /// Cells along each index.
    pub count: [usize; 2],
    /// NaN where there is no value.
    pub values: &'a [f64],
    /// Whether the last node along an index is the first again, with the same value to the last bit.
    pub closes: [bool; 2],
}

/// A chain of fractional node indices, running on past a seam, and whether it closes.
pub(super) type Chain = (Vec<[f64; 2]>, bool);

/// An edge of the grid: the node it starts from and whether it runs along the second index.
type Edge = (usize, usize, bool);

impl Grid<'_> {
    fn value(&self, i: usize, j: usize) -> f64 {
        self.values[i * (self.count[1] + 1) + j]
    }

    fn crossing(&self, (i, j, second): Edge, level: f64) -> Option<[f64; 2]> {
        let (i2, j2) = if second { (i, j + 1) } else { (i + 1, j) };
        let (a, b) = (self.value(i, j) - level, self.value(i2, j2) - level);
        if (a < 0.0) == (b < 0.0) || a.is_nan() || b.is_nan() {
            return None;
        }
        let t = a / (a - b);
        Some(if second { [i as f64, j as f64 + t] } else { [i as f64 + t, j as f64] })
    }

    /// The same edge under one name on both sides of a seam.
    fn named(&self, (i, j, second): Edge) -> Edge {
        let round = |k: usize, axis: usize| if self.closes[axis] && k == self.count[axis] { 0 } else { k };
        (round(i, 0), round(j, 1), second)
    }

    /// The lines on which the values are `level`, in the cells that `inside` allows.
    pub(super) fn lines(&self, level: f64, inside: impl Fn(usize, usize) -> bool) -> Vec<Chain> {
        let mut at: HashMap<Edge, [f64; 2]> = HashMap::new();
        let mut links: HashMap<Edge, Vec<Edge>> = HashMap::new();
        let mut order: Vec<Edge> = Vec::new();
        for i in 0..self.count[0] {
            for j in 0..self.count[1] {
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| self.value(i + a, j + b) - level);
                let below = corners.iter().filter(|c| **c < 0.0).count();
                if below == 0 || below == 4 || !inside(i, j) {
                    continue;
                }
                let sides: [Edge; 4] = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
                let hit: Vec<(Edge, [f64; 2])> = sides
                    .iter()
                    .filter_map(|e| self.crossing(*e, level).map(|p| (self.named(*e), p)))
                    .collect();
                let pairs: &[[usize; 2]] = match hit.len() {
                    2 => &[[0, 1]],
                    // A saddle: the middle decides which corners the level line cuts off.
                    4 if (corners.iter().sum::<f64>() < 0.0) == (corners[0] < 0.0) => &[[0, 1], [2, 3]],
                    4 => &[[0, 3], [1, 2]],
                    _ => &[],
                };
                for [a, b] in pairs {
                    let ((ea, pa), (eb, pb)) = (hit[*a], hit[*b]);
                    for (e, p) in [(ea, pa), (eb, pb)] {
                        if at.insert(e, p).is_none() {
                            order.push(e);
                        }
                    }
                    links.entry(ea).or_default().push(eb);
                    links.entry(eb).or_default().push(ea);
                }
            }
        }
        self.chain(&order, &at, &links)
    }

    /// Walks the links: open chains from their ends first, then what closes.
    fn chain(
        &self,
        order: &[Edge],
        at: &HashMap<Edge, [f64; 2]>,
        links: &HashMap<Edge, Vec<Edge>>,
    ) -> Vec<Chain> {
        let mut used: HashSet<Edge> = HashSet::new();
        let mut out = Vec::new();
        let degree = |e: &Edge| links.get(e).map_or(0, Vec::len);
        let starts = order.iter().filter(|e| degree(e) == 1).chain(order.iter().filter(|e| degree(e) != 1));
        for start in starts {
            if used.contains(start) {
                continue;
            }
            let mut line = vec![*start];
            used.insert(*start);
            while let Some(next) =
                line.last().and_then(|e| links.get(e)).and_then(|l| l.iter().find(|n| !used.contains(*n)))
            {
                used.insert(*next);
                line.push(*next);
            }
            let closed =
                line.len() > 2 && line.last().and_then(|e| links.get(e)).is_some_and(|l| l.contains(start));
            let mut points: Vec<[f64; 2]> = line.iter().map(|e| at[e]).collect();
            if closed {
                points.push(points[0]);
            }
            if points.len() >= 2 {
                self.unroll(&mut points);
                out.push((points, closed));
            }
        }
        out
    }

    /// Lets a chain run on past a seam instead of jumping back.
    fn unroll(&self, points: &mut [[f64; 2]]) {
        for axis in 0..2 {
            let n = self.count[axis] as f64;
            if self.closes[axis] {
                for k in 1..points.len() {
                    points[k][axis] -= ((points[k][axis] - points[k - 1][axis]) / n).round() * n;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(count: [usize; 2], f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let node = |k: usize| (k / (count[1] + 1), k % (count[1] + 1));
        (0..(count[0] + 1) * (count[1] + 1)).map(node).map(|(i, j)| f(i as f64, j as f64)).collect()
    }

    #[test]
    fn a_circle_closes_and_a_slanted_line_ends_at_the_border() {
        let count = [20, 20];
        let round = values(count, |x, y| (x - 10.3).hypot(y - 9.8));
        let grid = Grid { count, values: &round, closes: [false; 2] };
        let lines = grid.lines(6.0, |_, _| true);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].1);
        assert!(lines[0].0.iter().all(|p| ((p[0] - 10.3).hypot(p[1] - 9.8) - 6.0).abs() < 0.05));
        let slanted = values(count, |x, y| x + 0.3 * y);
        let grid = Grid { count, values: &slanted, closes: [false; 2] };
        let lines = grid.lines(10.0, |_, _| true);
        assert_eq!((lines.len(), lines[0].1), (1, false));
        assert_eq!((lines[0].0[0][1] - lines[0].0.last().unwrap()[1]).abs(), 20.0);
    }

    #[test]
    fn a_line_around_a_tube_closes_over_the_seam() {
        let count = [12, 8];
        let wave = values(count, |x, y| y + ((x % 12.0) * std::f64::consts::TAU / 12.0).sin());
        let grid = Grid { count, values: &wave, closes: [true, false] };
        let lines = grid.lines(4.0, |_, _| true);
        assert_eq!((lines.len(), lines[0].1), (1, true));
        let (first, last) = (lines[0].0[0], *lines[0].0.last().unwrap());
        assert_eq!((first[0] - last[0]).abs(), 12.0, "{:?}", lines[0].0);
    }
}
