//! A few numbers side by side: arithmetic lane by lane, in plain loops that the compiler turns into vector
//! instructions.
//!
//! Every lane is rounded as a single `f64` would be (no fused multiply-add, no reordering), so that a formula
//! written once over lanes gives the same bits for one number and for eight, on every processor.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Places that a batch works on at once: one AVX-512 register, two of AVX2, four of SSE2.
pub const LANES: usize = 8;

/// N numbers.
///
/// ```
/// use osculate_geom::lanes::{Lanes, dot};
/// let (x, y) = (Lanes([3.0, 5.0]), Lanes([4.0, 12.0]));
/// let v = [x, y, Lanes::splat(0.0)];
/// assert_eq!(dot(&v, &v).sqrt(), Lanes([5.0, 13.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
// Whole registers: a load that straddles two cache lines costs as much as the arithmetic.
#[repr(align(64))]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Lanes<N> {
    /// The same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(x: f64) -> Self {
        Self([x; N])
    }

    /// These numbers.
    #[inline(always)]
    #[must_use]
    pub fn from_array(numbers: [f64; N]) -> Self {
        Self(numbers)
    }

    /// Square roots.
    #[inline(always)]
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self(from_fn(|k| self.0[k].sqrt()))
    }

    /// `f` of every lane.
    #[inline(always)]
    #[must_use]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(from_fn(|k| f(self.0[k])))
    }

    /// `f` of both lanes.
    #[inline(always)]
    #[must_use]
    pub fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(from_fn(|k| f(self.0[k], other.0[k])))
    }
}

impl<const N: usize> Default for Lanes<N> {
    #[inline(always)]
    fn default() -> Self {
        Self([0.0; N])
    }
}

macro_rules! lane_by_lane {
    ($($name:ident $method:ident $op:tt),*) => {$(
        impl<const N: usize> $name for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|k| self.0[k] $op other.0[k]))
            }
        }
    )*};
}
lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(from_fn(|k| -self.0[k]))
    }
}

/// Three components, each with its lanes.
pub type Lanes3<const N: usize> = [Lanes<N>; 3];

/// Scalar product lane by lane.
#[inline(always)]
#[must_use]
pub fn dot<const N: usize>(a: &Lanes3<N>, b: &Lanes3<N>) -> Lanes<N> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product lane by lane.
#[inline(always)]
#[must_use]
pub fn cross<const N: usize>(a: &Lanes3<N>, b: &Lanes3<N>) -> Lanes3<N> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A vector times a number lane by lane.
#[inline(always)]
#[must_use]
pub fn times<const N: usize>(a: &Lanes3<N>, s: Lanes<N>) -> Lanes3<N> {
    [a[0] * s, a[1] * s, a[2] * s]
}
