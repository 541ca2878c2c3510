//! Truncated power series in two variables: the arithmetic behind exact derivatives of any order.
//!
//! A [`Series`] is the Taylor polynomial of a function of (u, v) about a place, in the steps from there:
//!
//! ```text
//! f(u + x, v + y) = sum over i + j <= order of c_ij x^i y^j,   c_ij = f_(u^i v^j) / (i! j!)
//! ```
//!
//! Sums, products and the elementary functions below are exact to the order kept, but for rounding: the result is
//! the Taylor polynomial of the result. Nothing is allocated. Source: [Griewank & Walther, Evaluating Derivatives,
//! chapter 13].

use crate::point::Axis;
use std::ops::{Add, Mul, Neg, Sub};

/// Highest order kept: an offset needs one order more than it gives, the curvatures at a pole need four.
pub const MAX_ORDER: usize = 6;

/// Coefficients of a series of the highest order.
const TERMS: usize = (MAX_ORDER + 1) * (MAX_ORDER + 2) / 2;

/// A function of two variables to a given order about a place.
///
/// ```
/// use osculate_geom::{Axis, Series};
/// // x^2 y about (3, 5) to second order.
/// let (x, y) = (Series::variable(Axis::U, 3.0, 2), Series::variable(Axis::V, 5.0, 2));
/// let f = x * x * y;
/// assert_eq!((f.value(), f.derivative(1, 0), f.derivative(1, 1)), (45.0, 30.0, 6.0));
/// // The third derivative was not asked for, and is not said to be zero.
/// assert!(f.derivative(2, 1).is_nan());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series {
    order: usize,
    /// By total degree: 1; x, y; x^2, x y, y^2; ...
    c: [f64; TERMS],
}

/// Place of `x^i y^j` among the coefficients.
const fn place(i: usize, j: usize) -> usize {
    let n = i + j;
    n * (n + 1) / 2 + j
}

/// `n!`, exact for the orders that occur.
pub(crate) fn factorial(n: usize) -> f64 {
    (2..=n).map(|k| k as f64).product()
}

impl Series {
    /// The constant function. Orders above [`MAX_ORDER`] are cut to it.
    #[must_use]
    pub fn constant(value: f64, order: usize) -> Self {
        let mut c = [0.0; TERMS];
        c[0] = value;
        Self { order: order.min(MAX_ORDER), c }
    }

    /// One of the two variables, about the value `at`.
    #[must_use]
    pub fn variable(axis: Axis, at: f64, order: usize) -> Self {
        Self::along(axis, &[at, 1.0], order)
    }

    /// A function of one variable alone, from its Taylor coefficients `f_k = f^(k) / k!`; missing ones are zero.
    #[must_use]
    pub fn along(axis: Axis, coefficients: &[f64], order: usize) -> Self {
        let mut s = Self::constant(0.0, order);
        for (k, f) in coefficients.iter().enumerate().take(s.order + 1) {
            s.c[if axis == Axis::U { place(k, 0) } else { place(0, k) }] = *f;
        }
        s
    }

    /// The series whose coefficient of `x^i y^j` is `f(i, j)`.
    pub fn from_coefficients(order: usize, mut f: impl FnMut(usize, usize) -> f64) -> Self {
        let mut s = Self::constant(0.0, order);
        for n in 0..=s.order {
            for j in 0..=n {
                s.c[place(n - j, j)] = f(n - j, j);
            }
        }
        s
    }

    /// Orders of derivatives that are known.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.order
    }

    /// The value at the place itself.
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.c[0]
    }

    /// The coefficient of `x^i y^j`; NaN above the order, never a zero that nobody knows.
    #[must_use]
    pub fn coefficient(&self, i: usize, j: usize) -> f64 {
        if i + j <= self.order { self.c[place(i, j)] } else { f64::NAN }
    }

    /// The derivative i times by u and j times by v; NaN above the order.
    #[must_use]
    pub fn derivative(&self, i: usize, j: usize) -> f64 {
        self.coefficient(i, j) * factorial(i) * factorial(j)
    }

    /// The same to a lower order.
    #[must_use]
    pub fn truncated(mut self, order: usize) -> Self {
        self.order = self.order.min(order);
        self
    }

    /// The partial derivative by one variable, one order shorter (order zero stays, as an unknown).
    #[must_use]
    pub fn differentiated(&self, axis: Axis) -> Self {
        if self.order == 0 {
            return Self::constant(f64::NAN, 0);
        }
        Self::from_coefficients(self.order - 1, |i, j| match axis {
            Axis::U => (i + 1) as f64 * self.c[place(i + 1, j)],
            Axis::V => (j + 1) as f64 * self.c[place(i, j + 1)],
        })
    }

    /// `f(self)`, f given by its Taylor coefficients about [`Series::value`], as many as the order asks for.
    #[must_use]
    pub fn compose(&self, f: impl Fn(usize) -> f64) -> Self {
        // Horner's rule in the series without its constant term.
        let mut step = *self;
        step.c[0] = 0.0;
        let mut sum = Self::constant(f(self.order), self.order);
        for k in (0..self.order).rev() {
            sum = sum * step;
            sum.c[0] += f(k);
        }
        sum
    }

    /// Sine and cosine.
    #[must_use]
    pub fn sin_cos(&self) -> (Self, Self) {
        let (s, c) = self.value().sin_cos();
        let turn = [s, c, -s, -c];
        let wave = |shift: usize| self.compose(|k| turn[(k + shift) % 4] / factorial(k));
        (wave(0), wave(1))
    }

    /// `1 / self`; not finite where the value is zero.
    #[must_use]
    pub fn recip(&self) -> Self {
        let r = 1.0 / self.value();
        self.compose(|k| if k % 2 == 0 { r.powi(k as i32 + 1) } else { -r.powi(k as i32 + 1) })
    }

    /// The square root; not finite where the value is not positive.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        let (root, r) = (self.value().sqrt(), 1.0 / self.value());
        // Binomial coefficients of the exponent one half.
        self.compose(|k| (0..k).fold(root, |b, m| b * (0.5 - m as f64) / (m + 1) as f64 * r))
    }
}

impl Add for Series {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let mut s = self.truncated(b.order);
        for (x, y) in s.c.iter_mut().zip(b.c) {
            *x += y;
        }
        s
    }
}

impl Sub for Series {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Neg for Series {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul<f64> for Series {
    type Output = Self;
    fn mul(mut self, k: f64) -> Self {
        for x in &mut self.c {
            *x *= k;
        }
        self
    }
}

impl Mul for Series {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let mut s = Self::constant(0.0, self.order.min(b.order));
        for n in 0..=s.order {
            for m in 0..=s.order - n {
                // Terms of degree n of the one times terms of degree m of the other.
                for j in 0..=n {
                    let x = self.c[place(n - j, j)];
                    for k in 0..=m {
                        s.c[place(n + m - j - k, j + k)] += x * b.c[place(m - k, k)];
                    }
                }
            }
        }
        s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_functions_have_the_derivatives_of_the_book() {
        let (a, b) = (0.4, 1.3);
        let (u, v) = (Series::variable(Axis::U, a, 5), Series::variable(Axis::V, b, 5));
        // f = sin(u v): f_uuv = -2 v sin(uv) - u v^2 cos(uv).
        let f = (u * v).sin_cos().0;
        let (s, c) = (a * b).sin_cos();
        assert!((f.derivative(2, 1) - (-2.0 * b * s - a * b * b * c)).abs() < 1e-14);
        // f = 1 / (u + v^2): f_uuu = -6 / (u + v^2)^4.
        let w = a + b * b;
        let f = (u + v * v).recip();
        assert!((f.derivative(3, 0) + 6.0 / w.powi(4)).abs() < 1e-14);
        assert!((f.derivative(0, 2) - (8.0 * b * b / w.powi(3) - 2.0 / (w * w))).abs() < 1e-14);
        // The root squared is the function, to every order.
        let g = u * u + v * 3.0 + u * v;
        let back = g.sqrt() * g.sqrt();
        for n in 0..=5 {
            for j in 0..=n {
                assert!((back.coefficient(n - j, j) - g.coefficient(n - j, j)).abs() < 1e-14);
            }
        }
        assert_eq!(g.differentiated(Axis::U).derivative(1, 0), 2.0);
        assert_eq!(g.differentiated(Axis::U).order(), 4);
        // Sixth derivatives of a series of order five are not known.
        assert!(f.derivative(6, 0).is_nan() && f.truncated(2).derivative(3, 0).is_nan());
    }
}
