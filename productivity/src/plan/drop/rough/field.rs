//! Distances of the nodes of a lattice to lines.

use super::contour::Line;
use super::grid::Grid;

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
                    if piece != u32::MAX
                        && piece != nearest[k].1
                        && nearest[m].0 < nearest[k].0 + 2.0 * grid.cell
                    {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_polygon() {
        let grid = Grid::over([[-8.0, -5.0], [8.0, 5.0]], 0.25);
        let square = vec![[-3.0, -2.0], [3.1, -2.0], [3.1, 2.0], [-3.0, 2.0]];
        let line = Line { points: square.clone(), closed: true };
        let found = distances(&grid, &[line]);
        for (k, far) in found.iter().enumerate() {
            let p = grid.at(k);
            let [dx, dy] = [(-3.0 - p[0]).max(p[0] - 3.1), (-2.0 - p[1]).max(p[1] - 2.0)];
            let want = if dx > 0.0 && dy > 0.0 { dx.hypot(dy) } else { dx.max(dy).abs() };
            assert!((far - want).abs() < 0.05, "{p:?} {far} {want}");
        }
        assert!(distances(&grid, &[]).iter().all(|d| *d == f64::INFINITY));
    }
}
