//! Convex quadratic programs with short rows and one shared bound, by a primal-dual interior point method.
//!
//! ```text
//! minimise  1/2 x' H x + f' x + e t   with   sign_k (g_k . x) - c_k t <= b_k,   |x_i| <= box
//! ```
//!
//! Mehrotra's predictor and corrector from a strictly feasible start; the normal equations have a band and one border
//! ([`super::band`]), so that a step costs `rows * stencil^2`. Where the rows are those of a linearised minimax problem, the
//! multipliers make a lower bound, see [`lower_bound`].

use super::band::Bordered;

/// Gap, relative to the value, at which the method has converged.
const GAP: f64 = 1e-9;
/// Most steps; a dozen or two is usual.
const MAX_STEPS: usize = 80;
/// Part of the way to the border of the feasible set that a step may go.
const TO_BORDER: f64 = 0.995;

/// Rows of equal length, each from its first variable on.
#[derive(Default)]
pub(super) struct Rows {
    pub length: usize,
    pub first: Vec<u32>,
    pub values: Vec<f64>,
}

impl Rows {
    fn row(&self, k: usize) -> (usize, &[f64]) {
        (self.first[k] as usize, &self.values[k * self.length..(k + 1) * self.length])
    }

    /// The rows that constraints name, which then name them by their new places.
    pub fn only(&self, constraints: &mut [Constraint]) -> Self {
        let mut out = Self { length: self.length, ..Self::default() };
        let mut last = None;
        for c in constraints {
            if last != Some(c.row) {
                last = Some(c.row);
                let (first, row) = self.row(c.row as usize);
                out.first.push(first as u32);
                out.values.extend_from_slice(row);
            }
            c.row = out.first.len() as u32 - 1;
        }
        out
    }

    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        (0..self.first.len())
            .map(|k| {
                let (first, row) = self.row(k);
                row.iter().zip(&x[first..]).map(|(a, b)| a * b).sum()
            })
            .collect()
    }

    /// Adds the transpose times `y`.
    pub fn add_transposed(&self, y: &[f64], out: &mut [f64]) {
        for (k, y) in y.iter().enumerate() {
            let (first, row) = self.row(k);
            row.iter().zip(&mut out[first..]).for_each(|(a, o)| *o += a * y);
        }
    }
}

/// `sign (g . x) - share t <= limit`.
#[derive(Clone, Copy)]
pub(super) struct Constraint {
    pub row: u32,
    pub sign: f64,
    pub share: f64,
    pub limit: f64,
}

pub(super) struct Program<'a> {
    pub rows: &'a Rows,
    pub constraints: &'a [Constraint],
    /// H, whose border and corner are those of t.
    pub curvature: &'a Bordered,
    pub linear: &'a [f64],
    /// Cost of t.
    pub cost: f64,
    pub limit: f64,
}

pub(super) struct Answer {
    pub x: Vec<f64>,
    #[cfg(test)]
    pub t: f64,
    /// Multipliers of the constraints.
    pub multipliers: Vec<f64>,
}

/// Slacks and multipliers: the constraints, then the upper and the lower sides of the box.
struct Point {
    x: Vec<f64>,
    t: f64,
    s: Vec<f64>,
    l: Vec<f64>,
}

impl Program<'_> {
    fn n(&self) -> usize {
        self.linear.len()
    }

    /// A [x; t], box included.
    fn forward(&self, x: &[f64], t: f64) -> Vec<f64> {
        let gx = self.rows.times(x);
        let mut out: Vec<f64> =
            self.constraints.iter().map(|c| c.sign * gx[c.row as usize] - c.share * t).collect();
        out.extend(x.iter().copied());
        out.extend(x.iter().map(|x| -x));
        out
    }

    /// A' y.
    fn backward(&self, y: &[f64]) -> (Vec<f64>, f64) {
        let (m, n) = (self.constraints.len(), self.n());
        let mut by_row = vec![0.0; self.rows.first.len()];
        let mut t = 0.0;
        for (c, y) in self.constraints.iter().zip(y) {
            by_row[c.row as usize] += c.sign * y;
            t -= c.share * y;
        }
        let mut out: Vec<f64> = (0..n).map(|i| y[m + i] - y[m + n + i]).collect();
        self.rows.add_transposed(&by_row, &mut out);
        (out, t)
    }

    fn limits(&self) -> Vec<f64> {
        let mut b: Vec<f64> = self.constraints.iter().map(|c| c.limit).collect();
        b.resize(b.len() + 2 * self.n(), self.limit);
        b
    }

    /// The solution; None where the numbers give out.
    pub fn solve(&self) -> Option<Answer> {
        let (m, n) = (self.constraints.len(), self.n());
        let b = self.limits();
        // x = 0 is inside the box; a t above all needs makes it strictly feasible.
        let need =
            self.constraints.iter().filter(|c| c.share > 0.0).map(|c| -c.limit / c.share).fold(0.0, f64::max);
        let scale = self.constraints.iter().map(|c| c.limit.abs()).fold(1e-9, f64::max);
        let t = need + 0.1 * scale;
        let x = vec![0.0; n];
        let ax = self.forward(&x, t);
        let s: Vec<f64> = b.iter().zip(&ax).map(|(b, a)| b - a).collect();
        if s.iter().any(|s| s.is_nan() || *s <= 0.0) {
            return None;
        }
        let start = scale / s.len() as f64;
        let l: Vec<f64> = s.iter().map(|s| start / s).collect();
        let mut at = Point { x, t, s, l };
        let count = at.s.len() as f64;
        let mut system = Bordered::zeros(n, self.rows.length);
        for _ in 0..MAX_STEPS {
            let gap = at.s.iter().zip(&at.l).map(|(s, l)| s * l).sum::<f64>();
            let hx = self.curvature.times(&at.x);
            let (al, al_t) = self.backward(&at.l);
            let dual: Vec<f64> = (0..n).map(|i| -(hx[i] + self.linear[i] + al[i])).collect();
            let dual_t = -(self.curvature.corner * at.t + self.cost + al_t);
            let worst = dual.iter().fold(dual_t.abs(), |a, d| a.max(d.abs()));
            if gap < GAP * scale * self.cost.max(1e-3) && worst < 1e-9 {
                break;
            }
            self.assemble(&at, &mut system);
            let shape = Bordered::zeros(0, 1);
            let factored = std::mem::replace(&mut system, shape).factor().ok()?;
            system = Bordered::zeros(n, self.rows.length);
            let ax = self.forward(&at.x, at.t);
            let primal: Vec<f64> = (0..b.len()).map(|k| ax[k] + at.s[k] - b[k]).collect();
            let direction = |complement: &[f64]| {
                let y: Vec<f64> =
                    (0..b.len()).map(|k| (complement[k] - at.l[k] * primal[k]) / at.s[k]).collect();
                let (f, g) = self.backward(&y);
                let rhs: Vec<f64> = dual.iter().zip(&f).map(|(d, f)| d + f).collect();
                let (dx, dt) = factored.solve(&rhs, dual_t + g);
                let adx = self.forward(&dx, dt);
                let ds: Vec<f64> = (0..b.len()).map(|k| -primal[k] - adx[k]).collect();
                let dl: Vec<f64> =
                    (0..b.len()).map(|k| (-complement[k] - at.l[k] * ds[k]) / at.s[k]).collect();
                (dx, dt, ds, dl)
            };
            let plain: Vec<f64> = at.s.iter().zip(&at.l).map(|(s, l)| s * l).collect();
            let (_, _, ds, dl) = direction(&plain);
            let (p, d) = (reach(&at.s, &ds, 1.0), reach(&at.l, &dl, 1.0));
            let after: f64 = (0..b.len()).map(|k| (at.s[k] + p * ds[k]) * (at.l[k] + d * dl[k])).sum::<f64>();
            let centre = (after / gap).powi(3) * gap / count;
            let corrected: Vec<f64> = (0..b.len()).map(|k| plain[k] + ds[k] * dl[k] - centre).collect();
            let (dx, dt, ds, dl) = direction(&corrected);
            let step = reach(&at.s, &ds, TO_BORDER).min(reach(&at.l, &dl, TO_BORDER));
            if step.is_nan() || step < 1e-12 {
                break;
            }
            let go = |v: &mut [f64], d: &[f64]| v.iter_mut().zip(d).for_each(|(v, d)| *v += step * d);
            go(&mut at.x, &dx);
            go(&mut at.s, &ds);
            go(&mut at.l, &dl);
            at.t += step * dt;
        }
        at.l.truncate(m);
        at.x.iter().all(|x| x.is_finite()).then_some(Answer {
            x: at.x,
            #[cfg(test)]
            t: at.t,
            multipliers: at.l,
        })
    }

    /// H + A' (L / S) A.
    fn assemble(&self, at: &Point, system: &mut Bordered) {
        let (m, n) = (self.constraints.len(), self.n());
        system.clear();
        system.add_band(self.curvature, 1.0);
        system.corner = self.curvature.corner;
        let mut weight = vec![0.0; self.rows.first.len()];
        let mut cross = vec![0.0; self.rows.first.len()];
        for (k, c) in self.constraints.iter().enumerate() {
            let d = at.l[k] / at.s[k];
            weight[c.row as usize] += d;
            cross[c.row as usize] -= c.sign * c.share * d;
            system.corner += c.share * c.share * d;
        }
        for (k, w) in weight.iter().enumerate() {
            let (first, row) = self.rows.row(k);
            system.add_square(first, row, *w);
        }
        let mut border = vec![0.0; n];
        self.rows.add_transposed(&cross, &mut border);
        system.border = border;
        for i in 0..n {
            system.add(i, i, at.l[m + i] / at.s[m + i] + at.l[m + n + i] / at.s[m + n + i]);
        }
    }
}

/// The longest step, at most 1, that keeps `v + step d` at least `1 - part` of the way from zero.
fn reach(v: &[f64], d: &[f64], part: f64) -> f64 {
    v.iter().zip(d).filter(|(_, d)| **d < 0.0).map(|(v, d)| -part * v / d).fold(1.0, f64::min)
}

/// A lower bound of t over all x with `|x_i| <= box_mm` that satisfy the constraints, from any multipliers that are not
/// negative: `t >= (sum l_k (-b_k) - box |sum l_k sign_k g_k|_1) / sum l_k share_k`. It holds whether or not they are optimal.
pub(super) fn lower_bound(
    rows: &Rows,
    constraints: &[Constraint],
    multipliers: &[f64],
    n: usize,
    box_mm: f64,
) -> f64 {
    let mut by_row = vec![0.0; rows.first.len()];
    let (mut value, mut share) = (0.0, 0.0);
    for (c, l) in constraints.iter().zip(multipliers) {
        let l = l.max(0.0);
        by_row[c.row as usize] += c.sign * l;
        value -= l * c.limit;
        share += l * c.share;
    }
    let mut residual = vec![0.0; n];
    rows.add_transposed(&by_row, &mut residual);
    let lost = box_mm * residual.iter().map(|r| r.abs()).sum::<f64>();
    if share > 0.0 { (value - lost) / share } else { f64::NEG_INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flank::oracle;
    use proptest::prelude::*;

    proptest! {
        /// Rows of four neighbouring unknowns with one shared bound, as a linearised minimax problem over a spline has them.
        #[test]
        fn another_solver_finds_the_same_value(
            n in 4usize..9,
            values in prop::collection::vec(-1.0..1.0f64, 400),
            count in 5usize..40,
            weight in 0.01..1.0f64,
        ) {
            const LENGTH: usize = 4;
            let number = |k: usize| values[k % values.len()];
            let first: Vec<u32> = (0..count).map(|k| (k % (n - LENGTH + 1)) as u32).collect();
            let rows = Rows { length: LENGTH, first, values: (0..count * LENGTH).map(number).collect() };
            let both = (0..count).flat_map(|k| [1.0, -1.0].map(|sign| (k, sign)));
            let constraints: Vec<Constraint> = both
                .map(|(k, sign)| Constraint { row: k as u32, sign, share: 1.0, limit: sign * number(7 * k + 3) })
                .collect();
            let mut curvature = Bordered::zeros(n, LENGTH);
            (0..n).for_each(|i| curvature.add(i, i, weight));
            let linear: Vec<f64> = (0..n).map(|i| 0.1 * number(11 * i)).collect();
            let limit = 2.0;
            let p = Program { rows: &rows, constraints: &constraints, curvature: &curvature, linear: &linear, cost: 1.0, limit };
            let got = p.solve().expect("feasible");
            let value = got.x.iter().zip(&linear).map(|(x, f)| 0.5 * weight * x * x + f * x).sum::<f64>() + got.t;

            // The same in all unknowns, t the last of them.
            let mut all: Vec<(Vec<f64>, f64)> = constraints
                .iter()
                .map(|c| {
                    let (first, row) = rows.row(c.row as usize);
                    let mut a = vec![0.0; n + 1];
                    row.iter().zip(&mut a[first..]).for_each(|(g, a)| *a = c.sign * g);
                    a[n] = -c.share;
                    (a, c.limit)
                })
                .collect();
            all.extend((0..2 * n).map(|k| {
                let mut a = vec![0.0; n + 1];
                a[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
                (a, limit)
            }));
            let h: Vec<Vec<f64>> =
                (0..=n).map(|i| (0..=n).map(|j| if i == j && i < n { weight } else { 0.0 }).collect()).collect();
            let c: Vec<f64> = linear.iter().copied().chain([1.0]).collect();
            let want = oracle::least(&h, &c, &all).expect("bounded");
            prop_assert!((value - want).abs() < 1e-7, "{value} and {want}");
        }
    }

    /// Best constant and line in the maximum norm: the known answers of Chebyshev's problem for t^2 on [-1, 1].
    #[test]
    fn best_line_to_a_parabola() {
        let n = 201;
        let mut rows = Rows { length: 2, first: Vec::new(), values: Vec::new() };
        let mut constraints = Vec::new();
        for k in 0..n {
            let x = -1.0 + 2.0 * f64::from(k) / f64::from(n - 1);
            let row = rows.first.len() as u32;
            rows.first.push(0);
            rows.values.extend([1.0, x]);
            for sign in [1.0, -1.0] {
                constraints.push(Constraint { row, sign, share: 1.0, limit: sign * x * x });
            }
        }
        let mut curvature = Bordered::zeros(2, 2);
        for i in 0..2 {
            curvature.add(i, i, 1e-12);
        }
        let p = Program {
            rows: &rows,
            constraints: &constraints,
            curvature: &curvature,
            linear: &[0.0, 0.0],
            cost: 1.0,
            limit: 10.0,
        };
        let a = p.solve().unwrap();
        assert!((a.t - 0.5).abs() < 1e-8 && (a.x[0] - 0.5).abs() < 1e-8 && a.x[1].abs() < 1e-6);
        let bound = lower_bound(&rows, &constraints, &a.multipliers, 2, 10.0);
        assert!(bound <= 0.5 + 1e-15 && bound > 0.5 - 1e-6, "{bound}");
    }
}
