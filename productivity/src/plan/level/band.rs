//! Symmetric positive definite systems whose unknowns couple only within a band, by Cholesky inside it.
//!
//! The unknowns of a spline over a rectangle couple to the three rows before and after: with at most a few dozen rows the band
//! is as fast as a general sparse factor. Time `n width^2`, memory `n width`.

/// The lower half of the band: entry (i, j), `j <= i < j + width`, at `i * width + (i - j)`.
pub(super) struct Band {
    n: usize,
    width: usize,
    entries: Vec<f64>,
}

/// The matrix is not positive definite to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NotDefinite;

/// Pivots below this part of their diagonal are rounding.
const LOST: f64 = 1e-14;

impl Band {
    /// Zeros; `width` counts the diagonal.
    pub fn zeros(n: usize, width: usize) -> Self {
        Self { n, width, entries: vec![0.0; n * width] }
    }

    /// Adds to the entries (i, j) and (j, i).
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (i, j) = (i.max(j), i.min(j));
        self.entries[i * self.width + i - j] += value;
    }

    /// The Cholesky factor in place of the matrix.
    pub fn factor(mut self) -> Result<Factor, NotDefinite> {
        let w = self.width;
        for i in 0..self.n {
            let first = (i + 1).saturating_sub(w);
            for j in first..=i {
                let from = first.max((j + 1).saturating_sub(w));
                // Sum over k in from..j of L(i, k) L(j, k), both rows stored backwards.
                let (a, b) = (i * w + i, j * w + j);
                let sum: f64 = {
                    let x = &self.entries[a + 1 - j..a + 1 - from];
                    let y = &self.entries[b + 1 - j..b + 1 - from];
                    x.iter().zip(y).map(|(p, q)| p * q).sum()
                };
                let e = self.entries[a - j] - sum;
                self.entries[a - j] = if j < i {
                    e / self.entries[j * w]
                } else {
                    if e.is_nan() || e <= LOST * self.entries[a - j].abs() {
                        return Err(NotDefinite);
                    }
                    e.sqrt()
                };
            }
        }
        Ok(Factor(self))
    }
}

/// The factor L of `A = L L'`.
pub(super) struct Factor(Band);

impl Factor {
    /// The solution for a right side.
    pub fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let (w, l) = (self.0.width, &self.0.entries);
        for i in 0..self.0.n {
            for j in (i + 1).saturating_sub(w)..i {
                x[i] -= l[i * w + i - j] * x[j];
            }
            x[i] /= l[i * w];
        }
        for i in (0..self.0.n).rev() {
            x[i] /= l[i * w];
            for j in (i + 1).saturating_sub(w)..i {
                x[j] -= l[i * w + i - j] * x[i];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_was_multiplied() {
        let (n, width) = (23, 6);
        let entry = |i: usize, j: usize| {
            let d = i.abs_diff(j);
            if d == 0 {
                8.0 + (i as f64).sin()
            } else if d < width {
                1.0 / (1.0 + (i + 2 * j.min(i)) as f64)
            } else {
                0.0
            }
        };
        let symmetric = |i: usize, j: usize| entry(i.max(j), i.min(j));
        let mut a = Band::zeros(n, width);
        for i in 0..n {
            for j in (i + 1).saturating_sub(width)..=i {
                a.add(i, j, symmetric(i, j));
            }
        }
        let x: Vec<f64> = (0..n).map(|k| (k as f64 * 0.7).cos()).collect();
        let b = (0..n).map(|i| (0..n).map(|j| symmetric(i, j) * x[j]).sum()).collect();
        let got = a.factor().unwrap().solve(b);
        assert!(got.iter().zip(&x).all(|(p, q)| (p - q).abs() < 1e-12));
        let mut flat = Band::zeros(2, 2);
        for (i, j) in [(0, 0), (1, 0), (1, 1)] {
            flat.add(i, j, 1.0);
        }
        assert!(flat.factor().is_err());
    }
}
