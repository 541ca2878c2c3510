//! The deviation to first order in the displacements of an axis surface's poles, and the motion's unevenness.
//!
//! Each pole moves across the axis it began with (two directions), and for cutters that are not cylinders along it too, both
//! guiding points together.

use super::band::Bordered;
use super::qp::Rows;
use super::sampling::Judged;
use crate::flank::axes::{AxisSurface, ORDER, basis};
use osculate_geom::{Unit3, Vec3, any_perpendicular};
use rayon::prelude::*;

/// Directions in which the poles move.
pub(super) struct Moves {
    /// Per pole: two across the axis, one along.
    pub frames: Vec<[Vec3; 3]>,
    /// Unknowns of a pole: 4, or 5 with the slide along the axis.
    pub each: usize,
}

impl Moves {
    pub fn new(axes: &AxisSurface, slides: bool) -> Self {
        let (lower, upper) = axes.poles();
        let frames = lower
            .iter()
            .zip(upper)
            .map(|(a, b)| {
                let d = Unit3::new_normalize(b - a);
                let x = any_perpendicular(&d).into_inner();
                [x, d.cross(&x), d.into_inner()]
            })
            .collect();
        Self { frames, each: if slides { 5 } else { 4 } }
    }

    pub fn unknowns(&self) -> usize {
        self.frames.len() * self.each
    }

    pub fn apply(&self, axes: &AxisSurface, x: &[f64]) -> AxisSurface {
        let mut out = axes.clone();
        let (lower, upper) = out.poles_mut();
        for (j, f) in self.frames.iter().enumerate() {
            let x = &x[j * self.each..(j + 1) * self.each];
            let slide = if self.each == 5 { f[2] * x[4] } else { Vec3::zeros() };
            lower[j] += f[0] * x[0] + f[1] * x[1] + slide;
            upper[j] += f[0] * x[2] + f[1] * x[3] + slide;
        }
        out
    }
}

/// Derivatives of the deviation by the unknowns, a row for each place.
pub(super) fn derivatives(axes: &AxisSurface, judged: &Judged, moves: &Moves) -> Rows {
    let length = ORDER * moves.each;
    let each: Vec<(u32, Vec<f64>)> = judged
        .nearest
        .par_iter()
        .map(|n| {
            let (span, t) = axes.locate(n.tau);
            let (b, _) = basis(t);
            let j = axes.jet(n.tau);
            let s = n.foot_mm / j.length;
            // Turning moves the foot only across the axis: its distance from Q0 stays.
            let across = n.normal - j.direction * n.normal.dot(&j.direction);
            let (lower, upper) = (across * s - n.normal, across * -s);
            let mut row = Vec::with_capacity(length);
            for (k, w) in b.iter().enumerate() {
                let f = &moves.frames[span + k];
                row.extend(
                    [lower.dot(&f[0]), lower.dot(&f[1]), upper.dot(&f[0]), upper.dot(&f[1])].map(|x| w * x),
                );
                if moves.each == 5 {
                    row.push(-w * n.normal.dot(&f[2]));
                }
            }
            ((span * moves.each) as u32, row)
        })
        .collect();
    let mut rows = Rows {
        length,
        first: Vec::with_capacity(each.len()),
        values: Vec::with_capacity(each.len() * length),
    };
    for (first, row) in each {
        rows.first.push(first);
        rows.values.extend(row);
    }
    rows
}

/// Sum of squared third differences of the poles, to second order in the unknowns: gradient and matrix.
pub(super) struct Unevenness {
    pub gradient: Vec<f64>,
    pub matrix: Bordered,
}

const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

pub(super) fn unevenness(axes: &AxisSurface, moves: &Moves) -> Unevenness {
    let n = moves.unknowns();
    let mut out = Unevenness { gradient: vec![0.0; n], matrix: Bordered::zeros(n, ORDER * moves.each) };
    let (lower, upper) = axes.poles();
    let each = moves.each;
    for j in 0..lower.len() - 3 {
        for (side, poles) in [lower, upper].into_iter().enumerate() {
            let third = poles[j + 3] - poles[j + 2] * 3.0 + poles[j + 1] * 3.0 - poles[j];
            // Derivatives of the difference by the unknowns of four poles.
            let mut columns: Vec<(usize, Vec3)> = Vec::with_capacity(12);
            for (k, w) in THIRD.into_iter().enumerate() {
                let pole = j + k;
                let f = &moves.frames[pole];
                columns.extend([0, 1].map(|c| (pole * each + 2 * side + c, f[c] * w)));
                if each == 5 {
                    columns.push((pole * each + 4, f[2] * w));
                }
            }
            for (a, va) in &columns {
                out.gradient[*a] += 2.0 * third.dot(va);
                for (b, vb) in &columns {
                    if b <= a {
                        out.matrix.add(*a, *b, 2.0 * va.dot(vb));
                    }
                }
            }
        }
    }
    out
}

/// Sum of squared third differences of the poles, mm^2.
pub(super) fn unevenness_mm2(axes: &AxisSurface) -> f64 {
    let (lower, upper) = axes.poles();
    let third =
        |p: &[Vec3]| p.windows(4).map(|w| (w[3] - w[0] + (w[1] - w[2]) * 3.0).norm_squared()).sum::<f64>();
    third(lower) + third(upper)
}
