//! Symmetric positive definite systems with few entries a row, as least squares over splines give them: sparse Cholesky in an order
//! that keeps the factor sparse. Time grows with `n^1.5`.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

/// The matrix is not positive definite to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotDefinite;

/// A matrix that is added up entry by entry.
#[derive(Clone, Debug)]
pub(crate) struct Symmetric {
    /// Of each row the entries up to the diagonal, by column.
    rows: Vec<Vec<(usize, f64)>>,
}

impl Symmetric {
    /// Zeros.
    pub fn zeros(n: usize) -> Self {
        Self { rows: vec![Vec::new(); n] }
    }

    /// Adds to the entries (i, j) and (j, i).
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (i, j) = (i.max(j), i.min(j));
        let row = &mut self.rows[i];
        match row.binary_search_by_key(&j, |e| e.0) {
            Ok(k) => row[k].1 += value,
            Err(k) => row.insert(k, (j, value)),
        }
    }

    /// The Cholesky factor. It is made by one thread, so that it is the same for any number of them.
    pub fn factor(&self) -> Result<Factor, NotDefinite> {
        let n = self.rows.len();
        let rows = self.rows.iter().enumerate();
        let entries: Vec<Triplet<usize, usize, f64>> =
            rows.flat_map(|(i, row)| row.iter().map(move |(j, value)| Triplet::new(i, *j, *value))).collect();
        if entries.iter().any(|e| !e.val.is_finite()) {
            return Err(NotDefinite);
        }
        let lower = SparseColMat::try_new_from_triplets(n, n, &entries).map_err(|_| NotDefinite)?;
        let symbolic = SymbolicLlt::try_new(lower.symbolic(), Side::Lower).map_err(|_| NotDefinite)?;
        let llt = Llt::try_new_with_symbolic(symbolic, lower.as_ref(), Side::Lower);
        llt.map(Factor).map_err(|_| NotDefinite)
    }
}

/// The factor L of `P A P' = L L'`, P the order of elimination.
pub(crate) struct Factor(Llt<usize, f64>);

impl Factor {
    /// The solution for a right side.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        self.0.solve(Col::from_fn(right.len(), |i| right[i])).iter().copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    /// The pattern of bicubic splines, `rows` by `columns`.
    fn spline_like([rows, columns]: [usize; 2], entry: impl Fn(usize, usize) -> f64) -> Symmetric {
        let mut a = Symmetric::zeros(rows * columns);
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let here = i * columns + j;
            let far = |k: usize, n: usize| k.saturating_sub(3)..(k + 4).min(n);
            for there in far(i, rows).flat_map(|p| far(j, columns).map(move |q| p * columns + q)) {
                if there <= here {
                    a.add(here, there, entry(here, there));
                }
            }
        }
        a
    }

    proptest! {
        #[test]
        fn dense_elimination_solves_the_same(
            shape in [1usize..16, 1usize..16], values in prop::collection::vec(-1.0..1.0f64, 997),
        ) {
            let number = |k: usize| values[k % values.len()];
            // The diagonal outweighs the 48 entries beside it.
            let a = spline_like(shape, |i, j| if i == j { 50.0 } else { number(31 * i + 7 * j) });
            let n = shape[0] * shape[1];
            let mut dense = DMatrix::zeros(n, n);
            for (i, (j, value)) in a.rows.iter().enumerate().flat_map(|(i, row)| row.iter().map(move |e| (i, *e))) {
                (dense[(i, j)], dense[(j, i)]) = (value, value);
            }
            let right = DVector::from_fn(n, |k, _| number(3 * k));
            let want = dense.lu().solve(&right).unwrap();
            let got = a.factor().unwrap().solve(right.as_slice());
            let worst = got.iter().zip(&want).fold(0.0, |m: f64, (p, q)| m.max((p - q).abs()));
            prop_assert!(worst < 1e-14, "{worst:e}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_definite_is_refused() {
        for corner in [1.0, 0.5, f64::NAN, f64::INFINITY] {
            let mut a = Symmetric::zeros(2);
            for (i, j, value) in [(0, 0, 1.0), (1, 0, 1.0), (1, 1, corner)] {
                a.add(i, j, value);
            }
            assert_eq!(a.factor().err(), Some(NotDefinite), "{corner}");
        }
    }
}
