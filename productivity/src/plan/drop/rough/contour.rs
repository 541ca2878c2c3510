//! Lines between nodes that are inside and nodes that are not, with the inside on their left.

use super::grid::Grid;
use rayon::prelude::*;

/// A chain of places in the plane, mm.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    pub points: Vec<[f64; 2]>,
    /// Whether it goes on from its last point to its first.
    pub closed: bool,
}

const NONE: u32 = u32::MAX;

/// The lines around all nodes that are inside, through one place on every edge of the lattice between a node inside and one outside.
/// Cells with a node of which nothing is known end them. Nodes that touch aslant only are apart.
pub(super) fn lines(
    grid: &Grid,
    inside: impl Fn(usize) -> Option<bool>,
    cross: impl Fn(usize, usize) -> [f64; 2] + Sync,
) -> Vec<Line> {
    let [ni, nj] = grid.n;
    // An edge has the number of its first node, twice, and one more where it leads to the next row.
    let mut next = vec![NONE; 2 * grid.len()];
    let mut edges: Vec<(u32, usize, usize)> = Vec::new();
    let mut begun = vec![false; 2 * grid.len()];
    for j in 0..nj.saturating_sub(1) {
        for i in 0..ni.saturating_sub(1) {
            let k = j * ni + i;
            let nodes = [k, k + 1, k + ni + 1, k + ni];
            let [Some(a), Some(b), Some(c), Some(d)] = nodes.map(&inside) else { continue };
            let is = [a, b, c, d];
            if is == [is[0]; 4] {
                continue;
            }
            let edge = [2 * k, 2 * (k + 1) + 1, 2 * (k + ni), 2 * k + 1];
            // Around the cell from corner to corner: out where the inside ends, in where it begins. A line goes from where
            // it ends to where it began.
            let ends = (0..4).filter(|e| is[*e] && !is[(e + 1) % 4]);
            for e in ends {
                let begins = (1..4).map(|back| (e + 4 - back) % 4).find(|f| !is[*f] && is[(f + 1) % 4]);
                let Some(f) = begins else { continue };
                next[edge[e]] = edge[f] as u32;
                begun[edge[f]] = true;
                for (one, from, to) in [(e, e, (e + 1) % 4), (f, (f + 1) % 4, f)] {
                    edges.push((edge[one] as u32, nodes[from], nodes[to]));
                }
            }
        }
    }
    edges.sort_unstable();
    edges.dedup();
    let places: Vec<[f64; 2]> = edges.par_iter().map(|(_, a, b)| cross(*a, *b)).collect();
    let place = |edge: u32| {
        // Every edge of a line was listed.
        edges.binary_search_by_key(&edge, |e| e.0).map_or([f64::NAN; 2], |at| places[at])
    };
    let mut out = Vec::new();
    let mut done = vec![false; next.len()];
    let open = edges.iter().map(|e| e.0).filter(|e| !begun[*e as usize]);
    for start in open.chain(edges.iter().map(|e| e.0)) {
        if done[start as usize] {
            continue;
        }
        let (mut points, mut at) = (Vec::new(), start);
        while at != NONE && !done[at as usize] {
            done[at as usize] = true;
            points.push(place(at));
            at = next[at as usize];
        }
        let closed = at == start;
        if points.len() > 1 {
            out.push(Line { points, closed });
        }
    }
    out
}

/// The lines on which a field has a level, with what lies above it on their left; where the field is no number nothing is known.
#[cfg(test)]
fn level(grid: &Grid, field: &[f64], level: f64) -> Vec<Line> {
    let inside = |k: usize| (!field[k].is_nan()).then_some(field[k] > level);
    lines(grid, inside, |a, b| {
        let share = ((field[a] - level) / (field[a] - field[b])).clamp(0.0, 1.0);
        let (p, q) = (grid.at(a), grid.at(b));
        [0, 1].map(|k| p[k] + (q[k] - p[k]) * share)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(line: &Line) -> f64 {
        let n = line.points.len();
        (0..n)
            .map(|k| (line.points[k], line.points[(k + 1) % n]))
            .map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0]))
            .sum()
    }

    /// A ring: its outer line runs left round, its inner one right round, and both lie on their circles.
    #[test]
    fn a_ring_has_two_lines() {
        let grid = Grid::over([[-6.0; 2], [6.0; 2]], 0.25);
        let rho = |k: usize| grid.at(k)[0].hypot(grid.at(k)[1]);
        let field: Vec<f64> = (0..grid.len()).map(|k| 1.5 - (rho(k) - 3.5).abs()).collect();
        let mut found = level(&grid, &field, 0.0);
        found.sort_by(|a, b| area(a).total_cmp(&area(b)));
        assert_eq!(found.len(), 2);
        for (line, want) in found.iter().zip([-2.0f64, 5.0]) {
            assert!(line.closed);
            assert!((area(line) / (want.signum() * std::f64::consts::PI * want * want) - 1.0).abs() < 0.01);
            assert!(line.points.iter().all(|p| (p[0].hypot(p[1]) - want.abs()).abs() < 0.02));
        }
        // Where nothing is known lines end.
        let half: Vec<f64> =
            (0..grid.len()).map(|k| if grid.at(k)[0] < 0.0 { f64::NAN } else { field[k] }).collect();
        let open = level(&grid, &half, 0.0);
        assert_eq!(open.len(), 2);
        assert!(open.iter().all(|l| !l.closed && l.points.iter().all(|p| p[0] >= 0.0)));
    }

    /// Nodes that touch aslant are apart.
    #[test]
    fn a_saddle_is_parted() {
        let grid = Grid::over([[0.0; 2], [3.0; 2]], 1.0);
        let inside = |k: usize| Some([5, 10].contains(&k));
        let found = lines(&grid, inside, |a, b| {
            let (p, q) = (grid.at(a), grid.at(b));
            [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
        });
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|l| l.closed && l.points.len() == 4 && area(l) > 0.0));
    }
}
