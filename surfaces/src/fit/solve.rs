//! The linear equations of a fit: few entries a row, near the diagonal or wrapped around it, and several
//! right-hand sides.
//!
//! Gaussian elimination over sparse rows with partial pivoting. A row of degree p has p + 1 neighbouring
//! entries, so that rows stay short: the work grows with the number of unknowns and the square of the degree,
//! for closed splines too, whose last rows are carried along. Rows are grouped by their first entry, which
//! makes the rows that a column concerns known without a search.

use super::FitError;
use nalgebra::DMatrix;

/// One equation: the unknowns that act and their factors, in any order, none twice.
pub(super) type Row = Vec<(usize, f64)>;

/// A pivot below this fraction of the largest entry is rounding.
const RELATIVE_PIVOT: f64 = 16.0 * f64::EPSILON;

/// The solution of as many equations as unknowns.
pub(super) fn solve(rows: &[Row], rhs: &DMatrix<f64>) -> Result<DMatrix<f64>, FitError> {
    let n = rows.len();
    let singular = FitError::Singular { unknowns: n };
    let mut rows: Vec<Row> = rows
        .iter()
        .map(|r| {
            let mut r: Row = r.iter().copied().filter(|(_, x)| *x != 0.0).collect();
            r.sort_unstable_by_key(|(i, _)| *i);
            r
        })
        .collect();
    let largest = rows.iter().flatten().fold(0.0_f64, |m, (_, x)| m.max(x.abs()));
    let mut x = rhs.clone();
    // For each column the rows that begin there.
    let mut heads: Vec<Vec<usize>> = vec![Vec::new(); n];
    for (k, row) in rows.iter().enumerate() {
        heads[row.first().ok_or(singular)?.0].push(k);
    }
    let mut pivots = Vec::with_capacity(n);
    for column in 0..n {
        let lead = |k: usize| rows[k][0].1.abs();
        let pivot = heads[column]
            .iter()
            .copied()
            .reduce(|a, b| if lead(b) > lead(a) { b } else { a })
            .filter(|k| lead(*k) > RELATIVE_PIVOT * largest)
            .ok_or(singular)?;
        pivots.push(pivot);
        for k in std::mem::take(&mut heads[column]) {
            if k == pivot {
                continue;
            }
            let factor = rows[k][0].1 / rows[pivot][0].1;
            rows[k] = minus(&rows[k][1..], &rows[pivot][1..], factor);
            for c in 0..x.ncols() {
                x[(k, c)] -= factor * x[(pivot, c)];
            }
            heads[rows[k].first().ok_or(singular)?.0].push(k);
        }
    }
    let mut solution = DMatrix::zeros(n, rhs.ncols());
    for (column, pivot) in pivots.into_iter().enumerate().rev() {
        let row = &rows[pivot];
        for c in 0..rhs.ncols() {
            let known: f64 = row[1..].iter().map(|(i, f)| f * solution[(*i, c)]).sum();
            solution[(column, c)] = (x[(pivot, c)] - known) / row[0].1;
        }
    }
    if solution.iter().all(|x| x.is_finite()) { Ok(solution) } else { Err(singular) }
}

/// `a - factor b` of two sorted rows.
fn minus(a: &[(usize, f64)], b: &[(usize, f64)], factor: f64) -> Row {
    let mut out = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let (ca, cb) = (a.get(i).map_or(usize::MAX, |e| e.0), b.get(j).map_or(usize::MAX, |e| e.0));
        let column = ca.min(cb);
        let mut sum = 0.0;
        if ca == column {
            sum = a[i].1;
            i += 1;
        }
        if cb == column {
            sum -= factor * b[j].1;
            j += 1;
        }
        if sum != 0.0 {
            out.push((column, sum));
        }
    }
    out
}

/// The solution of more equations than unknowns with the least sum of squared residuals, by the normal
/// equations. Their condition is the square of the basis's, which is small for the degrees used: a cubic
/// keeps some twelve digits.
pub(super) fn least_squares(
    rows: &[Row],
    unknowns: usize,
    rhs: &DMatrix<f64>,
) -> Result<DMatrix<f64>, FitError> {
    let mut normal = vec![std::collections::BTreeMap::<usize, f64>::new(); unknowns];
    let mut right = DMatrix::zeros(unknowns, rhs.ncols());
    for (k, row) in rows.iter().enumerate() {
        for (i, x) in row {
            for (j, y) in row {
                *normal[*i].entry(*j).or_default() += x * y;
            }
            for c in 0..rhs.ncols() {
                right[(*i, c)] += x * rhs[(k, c)];
            }
        }
    }
    let rows: Vec<Row> = normal.into_iter().map(|r| r.into_iter().collect()).collect();
    solve(&rows, &right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_a_dense_elimination(
            n in 5usize..40, closed in any::<bool>(), x in proptest::collection::vec(-1.0f64..1.0, 40 * 8),
        ) {
            // Bands of three beside a heavy diagonal, wrapped or not, in shuffled rows.
            let entry = |i: usize, d: usize| ((i + d) % n, x[8 * i + d] + if d == 1 { 3.0 } else { 0.0 });
            let rows: Vec<Row> = (0..n)
                .map(|k| (k * 7 + 3) % n)
                .map(|i| (0..3).map(|d| entry(i, d)).filter(|(c, _)| closed || c.abs_diff(i) < 3).collect())
                .collect();
            prop_assume!(n % 7 != 0);
            let rhs = DMatrix::from_fn(n, 2, |i, c| x[8 * i + 4 + c]);
            let mut dense = DMatrix::zeros(n, n);
            for (k, row) in rows.iter().enumerate() {
                for (i, x) in row {
                    dense[(k, *i)] = *x;
                }
            }
            let want = dense.clone().lu().solve(&rhs);
            match (solve(&rows, &rhs), want) {
                (Ok(got), Some(_)) => {
                    // The residual of a backward stable elimination.
                    let size = got.amax().max(1.0);
                    prop_assert!((&dense * &got - &rhs).amax() <= 1e-13 * size * n as f64);
                }
                (Err(FitError::Singular { unknowns }), _) => {
                    prop_assert_eq!(unknowns, n);
                    prop_assert!(dense.singular_values().min() < 1e-9);
                }
                (got, want) => prop_assert!(false, "{got:?} {want:?}"),
            }
        }
    }

    #[test]
    fn equal_equations_are_refused() {
        let rows = vec![vec![(0, 1.0), (1, 2.0)], vec![(0, 2.0), (1, 4.0)]];
        let refused = solve(&rows, &DMatrix::zeros(2, 1)).unwrap_err();
        assert_eq!(refused, FitError::Singular { unknowns: 2 });
        let empty = vec![vec![(0, 1.0)], Vec::new()];
        assert!(solve(&empty, &DMatrix::zeros(2, 1)).is_err());
    }
}
