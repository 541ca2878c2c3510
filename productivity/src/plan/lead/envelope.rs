//! The least field above given values whose slope over the nodes of a grid is bounded:
//! `L(p) = max over q of (need(q) - slope * dist(p, q))`, dist along the grid's edges and diagonals.
//!
//! The maximum over all q is that of a front that starts from the greatest need and loses slope times length on every edge, so
//! that one pass over the nodes in the order of their values finds it (Dijkstra).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Nodes in rows of the second index, with the way to go from each to its neighbours.
pub(in crate::plan) trait Network {
    /// Calls `see` with every neighbour of a node and its distance, mm.
    fn around(&self, node: usize, see: &mut dyn FnMut(usize, f64));
}

/// A node with its value, the greatest first, then the first.
#[derive(PartialEq)]
struct Front {
    value: f64,
    node: usize,
}

impl Eq for Front {}

impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        self.value.total_cmp(&other.value).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Raises values to their envelope of at most `slope` per mm.
pub(in crate::plan) fn raise(values: &mut [f64], network: &dyn Network, slope: f64) {
    let mut front: BinaryHeap<Front> =
        values.iter().enumerate().map(|(node, value)| Front { value: *value, node }).collect();
    while let Some(Front { value, node }) = front.pop() {
        // Raised since.
        if value < values[node] {
            continue;
        }
        network.around(node, &mut |next, length_mm| {
            let passed = value - slope * length_mm;
            if passed > values[next] {
                values[next] = passed;
                front.push(Front { value: passed, node: next });
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid with unequal steps.
    struct Grid {
        side: usize,
        step: [f64; 2],
    }

    impl Network for Grid {
        fn around(&self, node: usize, see: &mut dyn FnMut(usize, f64)) {
            let (i, j) = ((node / self.side) as i32, (node % self.side) as i32);
            for a in -1..=1 {
                for b in -1..=1 {
                    let (x, y, n) = (i + a, j + b, self.side as i32);
                    if (a, b) != (0, 0) && x >= 0 && y >= 0 && x < n && y < n {
                        let length = (f64::from(a) * self.step[0]).hypot(f64::from(b) * self.step[1]);
                        see((x * n + y) as usize, length);
                    }
                }
            }
        }
    }

    /// Shortest ways from one node to all by relaxing until nothing changes.
    fn ways(grid: &Grid, from: usize) -> Vec<f64> {
        let mut out = vec![f64::INFINITY; grid.side * grid.side];
        out[from] = 0.0;
        loop {
            let before = out.clone();
            for k in 0..out.len() {
                let here = out[k];
                grid.around(k, &mut |m, d| out[m] = out[m].min(here + d));
            }
            if out == before {
                return out;
            }
        }
    }

    #[test]
    fn the_envelope_is_the_maximum_over_all_nodes() {
        let grid = Grid { side: 9, step: [0.7, 1.3] };
        // Any scattered needs.
        let need: Vec<f64> = (0..grid.side * grid.side).map(|k| (k as f64 * 12.9898).sin() * 8.0).collect();
        let all: Vec<Vec<f64>> = (0..grid.side * grid.side).map(|k| ways(&grid, k)).collect();
        for slope in [0.3, 2.0, 50.0] {
            let mut got = need.clone();
            raise(&mut got, &grid, slope);
            for (p, value) in got.iter().enumerate() {
                let want =
                    (0..need.len()).map(|q| need[q] - slope * all[q][p]).fold(f64::NEG_INFINITY, f64::max);
                // Sums of at most a dozen lengths.
                assert!((value - want).abs() < 1e-12, "{slope} {p}: {value} against {want}");
            }
        }
    }
}
