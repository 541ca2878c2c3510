//! Cholesky within the band: time `n width^2`, memory `n width`.

use super::{NotDefinite, Symmetric};
use osculate_geom::lanes::{LANES, Lanes};

/// Pivots below this part of their diagonal are rounding.
const LOST: f64 = 1e-14;

/// The factor L of `A = L L'`: entry (i, j), `j <= i < j + width`, at `i * width + (i - j)`.
pub(crate) struct Factor {
    n: usize,
    width: usize,
    entries: Vec<f64>,
}

/// The scalar product: eight sums side by side, then over these in order, the same on every processor.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<LANES>(), y.as_chunks::<LANES>());
    let mut sums = Lanes::splat(0.0);
    for (p, q) in x.iter().zip(y) {
        sums = sums + Lanes(*p) * Lanes(*q);
    }
    let rest = x_rest.iter().zip(y_rest).map(|(p, q)| p * q).sum::<f64>();
    sums.0.iter().sum::<f64>() + rest
}

impl Factor {
    /// The factor of a matrix.
    pub fn new(matrix: &Symmetric) -> Result<Self, NotDefinite> {
        let (n, w) = (matrix.rows.len(), matrix.width());
        let mut entries = vec![0.0; n * w];
        for (i, row) in matrix.rows.iter().enumerate() {
            for (j, value) in row {
                entries[i * w + i - j] = *value;
            }
        }
        for i in 0..n {
            let first = (i + 1).saturating_sub(w);
            for j in first..=i {
                let from = first.max((j + 1).saturating_sub(w));
                // Over k in from..j of L(i, k) L(j, k), both rows stored backwards.
                let (a, b) = (i * w + i, j * w + j);
                let e = entries[a - j]
                    - dot(&entries[a + 1 - j..a + 1 - from], &entries[b + 1 - j..b + 1 - from]);
                entries[a - j] = if j < i {
                    e / entries[j * w]
                } else {
                    if e.is_nan() || e <= LOST * entries[a - j].abs() {
                        return Err(NotDefinite);
                    }
                    e.sqrt()
                };
            }
        }
        Ok(Self { n, width: w, entries })
    }

    /// The solution for a right side.
    pub fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let (w, l) = (self.width, &self.entries);
        for i in 0..self.n {
            for j in (i + 1).saturating_sub(w)..i {
                x[i] -= l[i * w + i - j] * x[j];
            }
            x[i] /= l[i * w];
        }
        for i in (0..self.n).rev() {
            x[i] /= l[i * w];
            for j in (i + 1).saturating_sub(w)..i {
                x[j] -= l[i * w + i - j] * x[i];
            }
        }
        x
    }
}
