//! B-spline basis functions: values and derivatives, their polynomial pieces, and blossoms.
//!
//! All three come from one triangle, the Cox-de Boor recurrence on a span `[t_k, t_(k+1)]`: with `N_(i,d)`
//! the function of degree d of pole i, which lives on `[t_i, t_(i+d+1)]`,
//!
//! ```text
//! N_(i,d) (t) = (t - t_i) / (t_(i+d) - t_i) N_(i,d-1) + (t_(i+d+1) - t) / (t_(i+d+1) - t_(i+1)) N_(i+1,d-1)
//! ```
//!
//! Feeding a different argument into every degree gives the blossom instead of the value, and polynomials in
//! place of numbers give the pieces. Source: [Piegl & Tiller, The NURBS Book, 2.3 to 2.5; Ramshaw, Blossoms
//! are polar forms].

use crate::knots::{Knots, MAX_DEGREE};
use osculate_geom::MAX_ORDER;

/// Room for the functions that act on one span.
const WIDTH: usize = MAX_DEGREE + 1;

/// The basis functions that act on a span at one parameter, with two derivatives; entry r belongs to pole
/// `first + r`.
pub(crate) struct Basis {
    /// First pole that acts.
    pub(crate) first: usize,
    /// Values, first and second derivatives.
    pub(crate) order: [[f64; WIDTH]; 3],
}

/// The basis functions that act on a span with their Taylor coefficients about one parameter.
pub(crate) struct BasisTaylor {
    /// First pole that acts.
    pub(crate) first: usize,
    /// Coefficients of order 0, 1, ...; zero above the order asked for.
    pub(crate) order: [[f64; WIDTH]; MAX_ORDER + 1],
}

impl Knots {
    /// Values with the argument `x(d)` in the step to degree d: the basis functions where `x` is constant,
    /// the weights of a blossom elsewhere. `seen(d, values)` gets the values of degree d - 1 before the step.
    #[inline]
    fn triangle(
        &self,
        k: usize,
        x: impl Fn(usize) -> f64,
        mut seen: impl FnMut(usize, &[f64; WIDTH]),
    ) -> [f64; WIDTH] {
        let t = self.as_slice();
        let mut n = [0.0; WIDTH];
        n[0] = 1.0;
        for d in 1..=self.degree() {
            seen(d, &n);
            let (x, mut risen) = (x(d), 0.0);
            for (r, value) in n[..d].iter_mut().enumerate() {
                // Entry r of degree d - 1 is the function of pole i, with support [t_i, t_(i+d)].
                let i = k + 1 + r - d;
                let share = *value / (t[i + d] - t[i]);
                *value = risen + (t[i + d] - x) * share;
                risen = (x - t[i]) * share;
            }
            n[d] = risen;
        }
        n
    }

    /// Derivatives of the functions of degree d from those of degree d - 1.
    #[inline]
    fn differentiate(&self, k: usize, d: usize, low: &[f64; WIDTH]) -> [f64; WIDTH] {
        let t = self.as_slice();
        let (mut out, mut before) = ([0.0; WIDTH], 0.0);
        for r in 0..d {
            let i = k + 1 + r - d;
            let share = d as f64 * low[r] / (t[i + d] - t[i]);
            out[r] = before - share;
            before = share;
        }
        out[d] = before;
        out
    }

    /// The basis functions on a span at `t`, with two derivatives. The span's polynomials are continued
    /// outside it.
    pub(crate) fn basis(&self, span: usize, t: f64) -> Basis {
        let (k, p) = (self.knot_index(span), self.degree());
        let (mut one_below, mut two_below) = ([0.0; WIDTH], [0.0; WIDTH]);
        let value = self.triangle(
            k,
            |_| t,
            |d, n| {
                if d == p {
                    one_below = *n;
                } else if d + 1 == p {
                    two_below = *n;
                }
            },
        );
        let first = self.differentiate(k, p, &one_below);
        let second = if p > 1 {
            self.differentiate(k, p, &self.differentiate(k, p - 1, &two_below))
        } else {
            [0.0; WIDTH]
        };
        Basis { first: k - p, order: [value, first, second] }
    }

    /// Taylor coefficients of the basis functions on a span about `t` to `order`: derivative k over k!.
    pub(crate) fn basis_taylor(&self, span: usize, t: f64, order: usize) -> BasisTaylor {
        let (k, p) = (self.knot_index(span), self.degree());
        let highest = order.min(p).min(MAX_ORDER);
        // Entry m: the functions of degree p - m, from which m differentiations lead to degree p.
        let mut below = [[0.0; WIDTH]; MAX_ORDER + 1];
        let values = self.triangle(
            k,
            |_| t,
            |d, n| {
                // Seen before the step to degree d: degree d - 1.
                if p + 1 - d <= highest {
                    below[p + 1 - d] = *n;
                }
            },
        );
        below[0] = values;
        let mut factor = 1.0;
        for (m, row) in below.iter_mut().enumerate().take(highest + 1).skip(1) {
            factor /= m as f64;
            for d in p - m + 1..=p {
                *row = self.differentiate(k, d, row);
            }
            for x in row.iter_mut() {
                *x *= factor;
            }
        }
        BasisTaylor { first: k - p, order: below }
    }

    /// Values of the basis functions alone, and the first pole that acts.
    pub(crate) fn basis_values(&self, span: usize, t: f64) -> (usize, [f64; WIDTH]) {
        let k = self.knot_index(span);
        (k - self.degree(), self.triangle(k, |_| t, |_, _| ()))
    }

    /// Weights of the poles `first + r` in the blossom of a span's polynomial at `args[0], args[1], ..` (as
    /// many as the degree).
    pub(crate) fn blossom(&self, span: usize, args: &[f64]) -> (usize, [f64; WIDTH]) {
        let k = self.knot_index(span);
        (k - self.degree(), self.triangle(k, |d| args[d - 1], |_, _| ()))
    }

    /// The polynomials of the basis functions on a span in powers of `x = (2 t - lo - hi) / (hi - lo)`, which
    /// runs over `[-1, 1]`: row r belongs to the pole `first + r`.
    ///
    /// Powers about the middle of the span lose about degree bits to the basis, half as many as about its
    /// end.
    pub(crate) fn span_powers(&self, span: usize) -> Vec<Vec<f64>> {
        let (t, k) = (self.as_slice(), self.knot_index(span));
        let half = 0.5 * (t[k + 1] - t[k]);
        let mid = t[k] + half;
        let mut rows = vec![vec![1.0]];
        for d in 1..=self.degree() {
            let mut next = vec![vec![0.0; d + 1]; d + 1];
            for (r, row) in rows.iter().enumerate() {
                let i = k + 1 + r - d;
                let width = t[i + d] - t[i];
                let (rise, fall, slope) = ((mid - t[i]) / width, (t[i + d] - mid) / width, half / width);
                for (a, c) in row.iter().enumerate() {
                    next[r][a] += c * fall;
                    next[r][a + 1] -= c * slope;
                    next[r + 1][a] += c * rise;
                    next[r + 1][a + 1] += c * slope;
                }
            }
            rows = next;
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A knot vector of the given degree from positive and zero steps, clamped or not.
    fn any_knots() -> impl Strategy<Value = Knots> {
        (1usize..8, 0usize..6, any::<bool>(), proptest::collection::vec(0.05f64..1.0, 40)).prop_map(
            |(p, extra, clamped, steps)| {
                let n = p + 1 + extra;
                let mut t = 0.0;
                let mut knots = Vec::new();
                for (i, step) in (0..n + p + 1).zip(steps) {
                    let inside = i > p && i <= n;
                    if !clamped || inside {
                        let double = step < 0.3 && p > 1 && i % 2 == 0 && i > p + 1 && i < n;
                        t += if double { 0.0 } else { step };
                    }
                    knots.push(t);
                }
                Knots::new(p, n, knots).expect("steps make a knot vector")
            },
        )
    }

    #[test]
    fn quadratic_by_hand() {
        // [The NURBS Book, example 2.3]: p = 2, u = 5/2.
        let k = Knots::new(2, 8, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0]).unwrap();
        let (first, n) = k.basis_values(k.find(2.5), 2.5);
        assert_eq!(first, 2);
        assert!((n[0] - 0.125).abs() < 1e-15 && (n[1] - 0.75).abs() < 1e-15 && (n[2] - 0.125).abs() < 1e-15);
        let b = k.basis(k.find(2.5), 2.5);
        assert_eq!(b.order[1][..3], [-0.5, 0.0, 0.5]);
        assert_eq!(b.order[2][..3], [1.0, -2.0, 1.0]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn partition_of_unity_and_pieces(knots in any_knots(), f in 0.0f64..=1.0) {
            let [lo, hi] = knots.domain();
            let t = lo + f * (hi - lo);
            let span = knots.find(t);
            let p = knots.degree();
            let b = knots.basis(span, t);
            let pieces = knots.span_powers(span);
            let ends = &knots.breaks()[span..span + 2];
            let x = ((t - ends[0]) - (ends[1] - t)) / (ends[1] - ends[0]);
            // Sums of p + 1 numbers: the values are at most 1, the derivatives at most p / step and p^2 /
            // step^2 with steps above 0.05; 100 roundings.
            let step = 0.05f64;
            let sizes = [1.0, p as f64 / step, (p * p) as f64 / (step * step)];
            for (order, size) in sizes.iter().enumerate() {
                let sum: f64 = b.order[order][..=p].iter().sum();
                let want = if order == 0 { 1.0 } else { 0.0 };
                prop_assert!((sum - want).abs() <= 2e-14 * size, "order {order}: {sum}");
            }
            let (first, values) = knots.basis_values(span, t);
            prop_assert_eq!(first, b.first);
            for r in 0..=p {
                prop_assert!(values[r] >= 0.0 && values[r] == b.order[0][r]);
                let horner = pieces[r].iter().rev().fold(0.0, |s, c| s * x + c);
                // The powers lose at most p bits: 2^7 * 2.2e-16 * a few.
                prop_assert!((horner - values[r]).abs() < 1e-12, "{horner} {}", values[r]);
            }
            // Derivatives by differences inside the span, on the polynomial continued outside.
            let h = 1e-4 * (ends[1] - ends[0]);
            let (up, down) = (knots.basis(span, t + h), knots.basis(span, t - h));
            for r in 0..=p {
                for order in 0..2 {
                    let d = (up.order[order][r] - down.order[order][r]) / (2.0 * h);
                    // Third derivatives are at most (2p / step)^3, times h^2 / 6.
                    prop_assert!((d - b.order[order + 1][r]).abs() <= 1e-5 * sizes[order + 1] * p as f64);
                }
            }
            // The blossom with all arguments equal is the value.
            let same = vec![t; p];
            prop_assert_eq!(knots.blossom(span, &same).1, values);
        }
    }
}
