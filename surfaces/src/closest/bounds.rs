//! Proven bounds for the derivatives of a piece of a NURBS surface over a sub-rectangle.
//!
//! Around the middle of the sub-rectangle, in parameters s and t that run over `[-1, 1]`, a polynomial is
//! bounded by the sum of the magnitudes of its coefficients, and so are its derivatives. For a rational piece
//! `S = A / w`, Leibniz's rule for `A = w S` gives, with `|.|` a bound over the sub-rectangle and `w_min` the
//! least weight,
//!
//! ```text
//! |S_ij| <= ( |A_ij| + sum over (k, l) != (0, 0) of C(i, k) C(j, l) |w_kl| |S_(i-k, j-l)| ) / w_min
//! ```
//!
//! with S and A relative to the surface's point in the middle, so that the bounds shrink with the rectangle.

use nalgebra::Vector4;
use osculate_geom::Vec3;

/// Derivatives bounded, by s and t: up to the third.
const ORDERS: usize = 4;

/// Guards against the rounding of the sums themselves.
const GUARD: f64 = 1.0 + 1e-9;

/// Bounds over a sub-rectangle: `|S_ss|, |S_st|, |S_tt|` and `|S_sss|, |S_sst|, |S_stt|, |S_ttt|`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) second: [f64; 3],
    pub(super) third: [f64; 4],
}

impl Bounds {
    /// With those of the second derivatives by Taylor's theorem from the middle, where they are better: the
    /// derivatives there, by ss, st and tt, and how much the third ones let them change.
    pub(super) fn tightened(mut self, bends: &[Vec3; 3]) -> Self {
        let [t0, t1, t2, t3] = self.third;
        let changes = [t0 + t1, t1 + t2, t2 + t3];
        for ((bound, bend), change) in self.second.iter_mut().zip(bends).zip(changes) {
            *bound = bound.min((bend.norm() + change) * GUARD);
        }
        self
    }
}

/// The same polynomial in powers of s and t, with `x = x0 + hx s`, `y = y0 + hy t`.
pub(super) fn moved(
    c: &[Vector4<f64>],
    terms: [usize; 2],
    middle: [f64; 2],
    half: [f64; 2],
) -> Vec<Vector4<f64>> {
    let [n, m] = terms;
    let mut c = c.to_vec();
    // Horner's scheme repeated: after round k the coefficient of power k is final.
    for row in c.chunks_exact_mut(m) {
        for k in 0..m {
            for b in (k..m - 1).rev() {
                let above = row[b + 1];
                row[b] += above * middle[1];
            }
        }
    }
    for b in 0..m {
        for k in 0..n {
            for a in (k..n - 1).rev() {
                let above = c[(a + 1) * m + b];
                c[a * m + b] += above * middle[0];
            }
        }
    }
    let mut pa = 1.0;
    for row in c.chunks_exact_mut(m) {
        let mut p = pa;
        for x in row {
            *x *= p;
            p *= half[1];
        }
        pa *= half[0];
    }
    c
}

/// Bounds from the coefficients in s and t; `least_weight` is a lower bound of the denominator.
pub(super) fn bounds(c: &[Vector4<f64>], terms: [usize; 2], least_weight: f64) -> Bounds {
    let [n, m] = terms;
    let centre: Vec3 = c[0].xyz() / c[0].w;
    let (mut a, mut w) = ([[0.0; ORDERS]; ORDERS], [[0.0; ORDERS]; ORDERS]);
    let mut spread = 0.0;
    for i in 0..n {
        for j in 0..m {
            let k = &c[i * m + j];
            let (top, bottom) = ((k.xyz() - centre * k.w).norm(), k.w.abs());
            if i + j > 0 {
                spread += bottom;
            }
            for p in 0..ORDERS.min(i + 1) {
                for q in 0..(ORDERS - p).min(j + 1) {
                    let factor = falling(i, p) * falling(j, q);
                    a[p][q] += factor * top;
                    w[p][q] += factor * bottom;
                }
            }
        }
    }
    let w_min = least_weight.max(c[0].w - spread);
    let mut s = [[0.0; ORDERS]; ORDERS];
    for order in 0..ORDERS {
        for p in 0..=order {
            let q = order - p;
            let mut sum = a[p][q];
            for k in 0..=p {
                for l in 0..=q {
                    if k + l > 0 {
                        sum += BINOMIAL[p][k] * BINOMIAL[q][l] * w[k][l] * s[p - k][q - l];
                    }
                }
            }
            s[p][q] = sum / w_min * GUARD;
        }
    }
    Bounds { second: [s[2][0], s[1][1], s[0][2]], third: [s[3][0], s[2][1], s[1][2], s[0][3]] }
}

const BINOMIAL: [[f64; ORDERS]; ORDERS] =
    [[1.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [1.0, 2.0, 1.0, 0.0], [1.0, 3.0, 3.0, 1.0]];

/// `n (n - 1) ... (n - k + 1)`, what k derivatives make of the power n.
fn falling(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64).product()
}
