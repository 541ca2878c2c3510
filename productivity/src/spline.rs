//! Fields of numbers or vectors as uniform bicubic splines over the parameter rectangle, closed where the face closes.

use crate::rectangle::Rectangle;
use osculate_geom::{Axis, Interval, Uv};
use std::ops::{Add, Mul};

/// A field's value and derivatives by the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct FieldJet {
    pub value: f64,
    /// By u and v.
    pub slope: [f64; 2],
    /// By uu, uv and vv.
    pub bend: [f64; 3],
}

/// Uniform cubic B-splines over an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Basis {
    interval: Interval,
    pub spans: usize,
    closed: bool,
}

/// The four splines that do not vanish at a parameter: their indices, values, and first and second derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Four {
    pub index: [usize; 4],
    pub value: [f64; 4],
    pub first: [f64; 4],
    pub second: [f64; 4],
}

impl Basis {
    /// How many splines.
    pub fn count(&self) -> usize {
        if self.closed { self.spans } else { self.spans + 3 }
    }

    pub fn at(&self, t: f64) -> Four {
        let h = self.interval.length() / self.spans as f64;
        let x = (t - self.interval.lo) / h;
        let k = x.floor().clamp(0.0, self.spans as f64 - 1.0);
        let (f, k) = (x - k, k as usize);
        let g = 1.0 - f;
        let index = [0, 1, 2, 3].map(|j| if self.closed { (k + j) % self.spans } else { k + j });
        Four {
            index,
            value: [
                g * g * g / 6.0,
                (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0,
                (4.0 - 6.0 * g * g + 3.0 * g * g * g) / 6.0,
                f * f * f / 6.0,
            ],
            first: [-0.5 * g * g, (1.5 * f - 2.0) * f, (2.0 - 1.5 * g) * g, 0.5 * f * f].map(|b| b / h),
            second: [g, 3.0 * f - 2.0, 3.0 * g - 2.0, f].map(|b| b / (h * h)),
        }
    }
}

/// The field.
#[derive(Clone, Debug)]
pub(crate) struct Spline<T = f64> {
    pub bases: [Basis; 2],
    /// In rows of v for each u.
    pub poles: Vec<T>,
}

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> Spline<T> {
    /// The same everywhere.
    pub fn constant(rectangle: &Rectangle, spans: [usize; 2], value: T) -> Self {
        let basis = |axis: Axis, spans: usize| Basis {
            interval: rectangle.domain.get(axis),
            spans: spans.max(4),
            closed: rectangle.closes(axis),
        };
        let bases = [basis(Axis::U, spans[0]), basis(Axis::V, spans[1])];
        Self { bases, poles: vec![value; bases[0].count() * bases[1].count()] }
    }

    pub fn index(&self, i: usize, j: usize) -> usize {
        i * self.bases[1].count() + j
    }

    /// The value, and the gradient by the parameters, from bases at hand.
    pub fn first(&self, u: &Four, v: &Four) -> (T, [T; 2]) {
        let first = self.poles[self.index(u.index[0], v.index[0])];
        let mut out = [
            first * (u.value[0] * v.value[0]),
            first * (u.first[0] * v.value[0]),
            first * (u.value[0] * v.first[0]),
        ];
        for (a, b) in (1..16).map(|k| (k / 4, k % 4)) {
            let c = self.poles[self.index(u.index[a], v.index[b])];
            out[0] = out[0] + c * (u.value[a] * v.value[b]);
            out[1] = out[1] + c * (u.first[a] * v.value[b]);
            out[2] = out[2] + c * (u.value[a] * v.first[b]);
        }
        (out[0], [out[1], out[2]])
    }
}

impl Spline {
    /// Value and derivatives.
    pub fn jet(&self, at: Uv) -> FieldJet {
        let (u, v) = (self.bases[0].at(at.u), self.bases[1].at(at.v));
        let mut out = FieldJet::default();
        for a in 0..4 {
            for b in 0..4 {
                let c = self.poles[self.index(u.index[a], v.index[b])];
                out.value += c * u.value[a] * v.value[b];
                out.slope[0] += c * u.first[a] * v.value[b];
                out.slope[1] += c * u.value[a] * v.first[b];
                out.bend[0] += c * u.second[a] * v.value[b];
                out.bend[1] += c * u.first[a] * v.first[b];
                out.bend[2] += c * u.value[a] * v.second[b];
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_sum_to_one_reproduce_lines_and_meet_their_differences() {
        let closed = [false, true];
        for closed in closed {
            let basis = Basis { interval: Interval::new(2.0, 5.0), spans: 7, closed };
            for t in [2.0, 2.31, 3.7, 4.99] {
                let four = basis.at(t);
                assert!((four.value.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                let (d, e) = (1e-5, basis.at(t + 1e-5));
                if e.index == four.index {
                    for k in 0..4 {
                        assert!(((e.value[k] - four.value[k]) / d - four.first[k]).abs() < 1e-3);
                        assert!(((e.first[k] - four.first[k]) / d - four.second[k]).abs() < 1e-2);
                    }
                }
                if !closed {
                    // Poles at the splines' middles make the parameter itself.
                    let middle = |k: usize| 2.0 + 3.0 * (k as f64 - 1.0) / 7.0;
                    let line: f64 = (0..4).map(|k| four.value[k] * middle(four.index[k])).sum();
                    assert!((line - t).abs() < 1e-13);
                }
            }
        }
    }
}
