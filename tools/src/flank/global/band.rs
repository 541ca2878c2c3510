//! Symmetric positive definite systems with a band and one bordering row: `[B w; w' c] [x; y] = [f; g]`.
//!
//! The normal equations of a spline fit couple only poles of a common span; the bound of a minimax problem couples to
//! all of them. B is factored by Cholesky inside its band, in time `n (half width)^2`; the border by its Schur complement.
//! Near the end of an interior point method the weights span more than the digits hold: a pivot that is lost to rounding is
//! taken as without end, which leaves its unknown where it is for that step.

/// The matrix, lower half of the band by rows: entry (i, j) at `i * width + (j + width - 1 - i)`.
pub(super) struct Bordered {
    n: usize,
    width: usize,
    band: Vec<f64>,
    /// The bordering row.
    pub border: Vec<f64>,
    /// The corner.
    pub corner: f64,
}

/// Pivots below this part of their diagonal are rounding.
const LOST: f64 = 1e-15;
/// What stands for them; its square is still finite.
const ENDLESS: f64 = 1e100;

/// The matrix is not positive definite to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NotDefinite;

impl Bordered {
    /// Zeros; `width` entries of each row from the diagonal to the left.
    pub fn zeros(n: usize, width: usize) -> Self {
        Self { n, width, band: vec![0.0; n * width], border: vec![0.0; n], corner: 0.0 }
    }

    pub fn clear(&mut self) {
        self.band.fill(0.0);
        self.border.fill(0.0);
        self.corner = 0.0;
    }

    /// Adds to entry (i, j), j <= i < j + width.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.band[i * self.width + j + self.width - 1 - i] += value;
    }

    /// Adds `weight row row'`, the row's values standing from `first` on.
    pub fn add_square(&mut self, first: usize, row: &[f64], weight: f64) {
        for (a, x) in row.iter().enumerate() {
            let i = first + a;
            let start = i * self.width + first + self.width - 1 - i;
            let scaled = weight * x;
            for (slot, y) in self.band[start..=start + a].iter_mut().zip(row) {
                *slot += scaled * y;
            }
        }
    }

    /// The product with a vector, border excluded.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.n];
        for i in 0..self.n {
            for j in (i + 1).saturating_sub(self.width)..=i {
                let v = self.band[i * self.width + j + self.width - 1 - i];
                out[i] += v * x[j];
                if i != j {
                    out[j] += v * x[i];
                }
            }
        }
        out
    }

    /// Adds a multiple of another band of the same shape.
    pub fn add_band(&mut self, other: &Self, by: f64) {
        self.band.iter_mut().zip(&other.band).for_each(|(a, b)| *a += b * by);
    }

    /// Factors in place.
    pub fn factor(mut self) -> Result<Factored, NotDefinite> {
        let w = self.width;
        for i in 0..self.n {
            let first = (i + 1).saturating_sub(w);
            for j in first..=i {
                let low = first.max((j + 1).saturating_sub(w));
                let (ri, rj) = (i * w + w - 1 - i, j * w + w - 1 - j);
                let dot: f64 = (low..j).map(|k| self.band[ri + k] * self.band[rj + k]).sum();
                let whole = self.band[ri + j];
                let v = whole - dot;
                self.band[ri + j] = if i == j {
                    if !(whole > 0.0 && v.is_finite()) {
                        return Err(NotDefinite);
                    }
                    if v > LOST * whole { v.sqrt() } else { ENDLESS }
                } else {
                    v / self.band[rj + j]
                };
            }
        }
        let mut f = Factored { m: self, reduced: Vec::new(), schur: 0.0 };
        f.reduced = f.inner(f.m.border.clone());
        f.schur = f.m.corner - f.m.border.iter().zip(&f.reduced).map(|(a, b)| a * b).sum::<f64>();
        if !(f.m.corner > 0.0 && f.schur.is_finite()) {
            return Err(NotDefinite);
        }
        if f.schur <= LOST * f.m.corner {
            f.schur = ENDLESS;
        }
        Ok(f)
    }
}

/// A factored matrix.
pub(super) struct Factored {
    m: Bordered,
    /// B^-1 border.
    reduced: Vec<f64>,
    schur: f64,
}

impl Factored {
    /// B^-1 f.
    fn inner(&self, mut x: Vec<f64>) -> Vec<f64> {
        let (n, w, l) = (self.m.n, self.m.width, &self.m.band);
        for i in 0..n {
            let r = i * w + w - 1 - i;
            let dot: f64 = ((i + 1).saturating_sub(w)..i).map(|k| l[r + k] * x[k]).sum();
            x[i] = (x[i] - dot) / l[r + i];
        }
        for i in (0..n).rev() {
            let r = i * w + w - 1 - i;
            x[i] /= l[r + i];
            for k in (i + 1).saturating_sub(w)..i {
                x[k] -= l[r + k] * x[i];
            }
        }
        x
    }

    /// The solution for a right hand side with the border's part last.
    pub fn solve(&self, f: &[f64], g: f64) -> (Vec<f64>, f64) {
        let mut x = self.inner(f.to_vec());
        let y = (g - self.reduced.iter().zip(f).map(|(a, b)| a * b).sum::<f64>()) / self.schur;
        x.iter_mut().zip(&self.reduced).for_each(|(x, r)| *x -= r * y);
        (x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_it_was_given() {
        let (n, w) = (9, 4);
        let mut m = Bordered::zeros(n, w);
        for k in 0..n {
            m.add(k, k, 1.0 + 0.1 * k as f64);
        }
        for first in 0..=n - w {
            let row: Vec<f64> = (0..w).map(|k| ((first * 5 + k * 3) % 7) as f64 - 2.0).collect();
            m.add_square(first, &row, 0.3);
        }
        m.border = (0..n).map(|k| (k as f64).sin()).collect();
        m.corner = 20.0;
        let x: Vec<f64> = (0..n).map(|k| 1.0 - 0.3 * k as f64).collect();
        let y = 0.7;
        let mut f = m.times(&x);
        f.iter_mut().zip(&m.border).for_each(|(f, b)| *f += b * y);
        let g = m.border.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>() + 20.0 * y;
        let (got, last) = m.factor().unwrap().solve(&f, g);
        assert!((last - y).abs() < 1e-12);
        assert!(got.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(Bordered::zeros(2, 2).factor().is_err());
    }
}
