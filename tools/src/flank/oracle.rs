//! A conic solver that shares no code with ours, to hold them against in tests.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

/// Digits that are asked of it.
const TOLERANCE: f64 = 1e-11;

/// Least value of `1/2 x' H x + c' x` under `a . x <= b` for each row, H by its rows up to the diagonal; None where there is none.
pub(super) fn least(h: &[Vec<f64>], c: &[f64], rows: &[(Vec<f64>, f64)]) -> Option<f64> {
    let n = c.len();
    let sparse = |m: usize, entries: Vec<(usize, usize, f64)>| {
        let (i, (j, v)) = entries.into_iter().map(|(i, j, v)| (i, (j, v))).unzip();
        CscMatrix::new_from_triplets(m, n, i, j, v)
    };
    // The solver takes the upper half.
    let curvature = (0..n).flat_map(|i| (0..=i).map(move |j| (j, i))).map(|(j, i)| (j, i, h[i][j]));
    let all =
        rows.iter().enumerate().flat_map(|(k, (a, _))| a.iter().enumerate().map(move |(j, v)| (k, j, *v)));
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(TOLERANCE)
        .tol_gap_rel(TOLERANCE)
        .tol_feas(TOLERANCE)
        .build()
        .expect("settings");
    let limits: Vec<f64> = rows.iter().map(|(_, b)| *b).collect();
    let (curvature, all) = (sparse(n, curvature.collect()), sparse(rows.len(), all.collect()));
    let cones = [NonnegativeConeT(rows.len())];
    let mut solver = DefaultSolver::new(&curvature, c, &all, &limits, &cones, settings).expect("sizes fit");
    solver.solve();
    let found = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    found.then_some(solver.solution.obj_val)
}
