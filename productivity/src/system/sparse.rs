//! Cholesky in an order of least degree, which leaves out most of the zeros of the band.

use super::{NotDefinite, Symmetric};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

/// The factor L of `P A P' = L L'`.
pub(crate) struct Factor(Llt<usize, f64>);

impl Factor {
    /// The factor of a matrix.
    pub fn new(matrix: &Symmetric) -> Result<Self, NotDefinite> {
        let n = matrix.rows.len();
        let entries: Vec<Triplet<usize, usize, f64>> = matrix
            .rows
            .iter()
            .enumerate()
            .flat_map(|(i, row)| row.iter().map(move |(j, value)| Triplet::new(i, *j, *value)))
            .collect();
        let lower = SparseColMat::try_new_from_triplets(n, n, &entries).map_err(|_| NotDefinite)?;
        let symbolic = SymbolicLlt::try_new(lower.symbolic(), Side::Lower).map_err(|_| NotDefinite)?;
        let llt =
            Llt::try_new_with_symbolic(symbolic, lower.as_ref(), Side::Lower).map_err(|_| NotDefinite)?;
        Ok(Self(llt))
    }

    /// The solution for a right side.
    pub fn solve(&self, x: Vec<f64>) -> Vec<f64> {
        self.0.solve(Col::from_fn(x.len(), |i| x[i])).iter().copied().collect()
    }
}
