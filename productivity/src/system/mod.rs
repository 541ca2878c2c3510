//! Symmetric positive definite systems with few entries a row, as least squares over splines give them.
//!
//! Two ways to the same solution: Cholesky within the band ([`band`]), which small systems are solved faster by, and a sparse
//! factor in an order that keeps it sparse ([`sparse`]), whose time grows with `n^1.5` where that of the band grows with `n^2`.
//! [`Symmetric::factor`] takes the faster one; a property test holds them together.

mod band;
mod sparse;

/// Above so many multiplications, `n width^2`, the sparse factor is the faster: `measured` below.
const BAND_MULTIPLICATIONS: f64 = 1e8;

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

    /// Most places from the diagonal to an entry, the diagonal counted.
    fn width(&self) -> usize {
        let far = |(i, row): (usize, &Vec<(usize, f64)>)| row.first().map_or(0, |(j, _)| i - j);
        1 + self.rows.iter().enumerate().map(far).max().unwrap_or(0)
    }

    /// The Cholesky factor.
    pub fn factor(&self) -> Result<Factor, NotDefinite> {
        let multiplications = self.rows.len() as f64 * (self.width() as f64).powi(2);
        if multiplications > BAND_MULTIPLICATIONS {
            sparse::Factor::new(self).map(Factor::Sparse)
        } else {
            band::Factor::new(self).map(Factor::Band)
        }
    }
}

/// The factor L of `A = L L'`.
pub(crate) enum Factor {
    /// Within the band.
    Band(band::Factor),
    /// In an order of its own.
    Sparse(sparse::Factor),
}

impl Factor {
    /// The solution for a right side.
    pub fn solve(&self, right: Vec<f64>) -> Vec<f64> {
        match self {
            Self::Band(f) => f.solve(right),
            Self::Sparse(f) => f.solve(right),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The pattern of bicubic splines, `rows` by `columns`, with a diagonal that outweighs what `entry` gives beside it.
    fn spline_like([rows, columns]: [usize; 2], entry: impl Fn(usize, usize) -> f64) -> Symmetric {
        let mut a = Symmetric::zeros(rows * columns);
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let here = i * columns + j;
            let far = |k: usize, n: usize| k.saturating_sub(3)..(k + 4).min(n);
            for there in far(i, rows).flat_map(|p| far(j, columns).map(move |q| p * columns + q)) {
                if there < here {
                    a.add(here, there, entry(here, there));
                }
            }
            a.add(here, here, 50.0);
        }
        a
    }

    fn times(a: &Symmetric, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        for (i, row) in a.rows.iter().enumerate() {
            for (j, value) in row {
                out[i] += value * x[*j];
                if i != *j {
                    out[*j] += value * x[i];
                }
            }
        }
        out
    }

    fn farthest(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).fold(0.0, |m, (p, q)| m.max((p - q).abs()))
    }

    proptest! {
        #[test]
        fn both_factors_solve_what_was_multiplied(
            shape in [1usize..24, 1usize..24], values in proptest::collection::vec(-1.0..1.0f64, 997),
        ) {
            let a = spline_like(shape, |i, j| values[(31 * i + 7 * j) % values.len()]);
            let x: Vec<f64> = (0..shape[0] * shape[1]).map(|k| values[k % values.len()]).collect();
            let right = times(&a, &x);
            let by_band = band::Factor::new(&a).unwrap().solve(right.clone());
            let by_sparse = sparse::Factor::new(&a).unwrap().solve(right);
            prop_assert!(farthest(&by_band, &x) < 1e-12, "band: {:e}", farthest(&by_band, &x));
            prop_assert!(farthest(&by_sparse, &x) < 1e-12, "sparse: {:e}", farthest(&by_sparse, &x));
        }
    }

    #[test]
    fn a_matrix_that_is_not_definite_is_refused_by_both() {
        for (corner, name) in [(1.0, "singular"), (0.5, "indefinite"), (f64::NAN, "not a number")] {
            let mut a = Symmetric::zeros(2);
            for (i, j, value) in [(0, 0, 1.0), (1, 0, 1.0), (1, 1, corner)] {
                a.add(i, j, value);
            }
            assert_eq!(band::Factor::new(&a).err(), Some(NotDefinite), "{name}, band");
            assert_eq!(sparse::Factor::new(&a).err(), Some(NotDefinite), "{name}, sparse");
        }
    }

    /// `cargo test --release -p osculate-productivity --lib system::tests::measured -- --ignored --nocapture`
    #[test]
    #[ignore = "a measurement, for a release build on a quiet machine"]
    fn measured() {
        println!("      n  width  n width2     band  sparse, ms: factor and one solution, best of five");
        for shape in [[60, 12], [67, 36], [40, 40], [60, 40], [75, 50], [200, 40], [120, 80], [300, 80]] {
            let a = spline_like(shape, |i, j| ((i * 7 + j) as f64).sin());
            let n = shape[0] * shape[1];
            let right = vec![1.0; n];
            let best = |solve: &dyn Fn() -> Vec<f64>| {
                (0..5)
                    .map(|_| {
                        let start = std::time::Instant::now();
                        let x = solve();
                        assert!(farthest(&times(&a, &x), &right) < 1e-9);
                        1e3 * start.elapsed().as_secs_f64()
                    })
                    .fold(f64::INFINITY, f64::min)
            };
            let by_band = best(&|| band::Factor::new(&a).unwrap().solve(right.clone()));
            let by_sparse = best(&|| sparse::Factor::new(&a).unwrap().solve(right.clone()));
            let w = a.width();
            println!("{n:7} {w:6} {:9.1e} {by_band:8.2} {by_sparse:7.2}", n as f64 * (w * w) as f64);
        }
    }
}
