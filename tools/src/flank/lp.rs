//! Small linear programs: few unknowns, many inequalities.
//!
//! ```text
//! min c . x   subject to   a_i . x <= b_i
//! ```
//!
//! Mehrotra's predictor-corrector interior point method [Wright, Primal-Dual Interior-Point Methods, chapter 10]: each round
//! costs one pass over the rows and one factorisation of an N x N matrix. The multipliers come with the solution: they
//! certify it, since `-b . y` is a lower bound of the least value for every `y >= 0` with `A^T y = -c`.

use nalgebra::{SMatrix, SVector};

/// Rows of inequalities `a . x <= b`.
pub(super) struct Rows<const N: usize> {
    pub a: Vec<SVector<f64, N>>,
    pub b: Vec<f64>,
}

/// A solution with its certificate.
pub(super) struct Solved<const N: usize> {
    pub x: SVector<f64, N>,
    /// One multiplier a row, not negative.
    #[cfg(test)]
    pub y: Vec<f64>,
    /// Difference between the value and the bound that the multipliers give.
    pub gap: f64,
}

/// Rounds at most; fifteen to twenty-five are usual.
const MAX_ROUNDS: u32 = 60;
/// Share of the way to the border that a step takes.
const SHARE: f64 = 0.995;

/// Solves from a strictly feasible start. None where the problem is unbounded or the numbers give out before `gap` is met
/// to a thousandfold.
pub(super) fn solve<const N: usize>(
    c: &SVector<f64, N>,
    rows: &Rows<N>,
    start: SVector<f64, N>,
    gap: f64,
) -> Option<Solved<N>> {
    let m = rows.b.len();
    let mut x = start;
    let mut s: Vec<f64> = rows.a.iter().zip(&rows.b).map(|(a, b)| b - a.dot(&x)).collect();
    if s.iter().any(|s| *s <= 0.0 || s.is_nan()) {
        return None;
    }
    let scale = s.iter().fold(0.0, |m: f64, s| m.max(*s));
    let mut y: Vec<f64> = s.iter().map(|s| c.norm() * scale / (s * m as f64)).collect();
    let mut rounds = 0;
    loop {
        let mu = s.iter().zip(&y).map(|(s, y)| s * y).sum::<f64>() / m as f64;
        let dual = rows.a.iter().zip(&y).fold(*c, |r, (a, y)| r + a * *y);
        let total = mu * m as f64;
        if total <= gap && dual.amax() <= 1e-9 * c.amax() || rounds == MAX_ROUNDS {
            let good = total <= 1e3 * gap && dual.amax() <= 1e-6 * c.amax();
            return good.then_some(Solved {
                x,
                #[cfg(test)]
                y,
                gap: total,
            });
        }
        rounds += 1;
        let mut normal = SMatrix::<f64, N, N>::zeros();
        for ((a, s), y) in rows.a.iter().zip(&s).zip(&y) {
            normal += a * a.transpose() * (y / s);
        }
        // Slacks at the border dwarf the rest: a breath of the largest entry keeps the factorisation going.
        normal += SMatrix::<f64, N, N>::identity() * (normal.amax() * 1e-18);
        let factor = normal.cholesky()?;
        // For complementarity targets r_i: ds = -A dx, dy = (r - y ds) / s.
        let step = |target: &dyn Fn(usize) -> f64| {
            let right = rows.a.iter().enumerate().fold(-dual, |r, (i, a)| r - a * (target(i) / s[i]));
            let dx = factor.solve(&right);
            let ds: Vec<f64> = rows.a.iter().map(|a| -a.dot(&dx)).collect();
            let dy: Vec<f64> = (0..m).map(|i| (target(i) - y[i] * ds[i]) / s[i]).collect();
            (dx, ds, dy)
        };
        let longest = |v: &[f64], d: &[f64]| {
            v.iter().zip(d).fold(1.0, |t: f64, (v, d)| if *d < 0.0 { t.min(-v / d) } else { t })
        };
        let (_, ds, dy) = step(&|i| -s[i] * y[i]);
        let (p, q) = (longest(&s, &ds), longest(&y, &dy));
        let ahead: f64 = (0..m).map(|i| (s[i] + p * ds[i]) * (y[i] + q * dy[i])).sum::<f64>() / m as f64;
        let centre = (ahead / mu).powi(3) * mu;
        let (dx, ds2, dy2) = step(&|i| centre - s[i] * y[i] - ds[i] * dy[i]);
        let (p, q) = ((SHARE * longest(&s, &ds2)).min(1.0), (SHARE * longest(&y, &dy2)).min(1.0));
        x += dx * p;
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        for i in 0..m {
            s[i] += p * ds2[i];
            y[i] += q * dy2[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flank::oracle;
    use nalgebra::{Vector2, Vector3};
    use proptest::prelude::*;

    proptest! {
        /// Half spaces around the origin and a box, so that there is a least value: another solver finds the same.
        #[test]
        fn another_solver_finds_the_same_value(
            c in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0],
            planes in prop::collection::vec(([-1.0..1.0f64, -1.0..1.0, -1.0..1.0], 0.01..2.0f64), 0..60),
        ) {
            let sides = (0..6).map(|k| (Vector3::ith(k / 2, if k % 2 == 0 { 1.0 } else { -1.0 }), 3.0));
            let all = planes.into_iter().map(|(a, b)| (Vector3::from(a), b)).chain(sides);
            let (a, b): (Vec<_>, Vec<_>) = all.unzip();
            let c = Vector3::from(c);
            let rows: Vec<_> = a.iter().zip(&b).map(|(a, b)| (a.as_slice().to_vec(), *b)).collect();
            let want = oracle::least(&vec![vec![0.0; 3]; 3], c.as_slice(), &rows).expect("bounded");
            let got = solve(&c, &Rows { a, b }, Vector3::zeros(), 1e-12).expect("a feasible start");
            prop_assert!((c.dot(&got.x) - want).abs() < 1e-8, "{} and {want}", c.dot(&got.x));
        }
    }

    /// The best line through |x|: |x| - (a + b x) on [-1, 1] alternates with 1/2, at -1, 0 and 1.
    #[test]
    fn the_best_constant_and_a_vertex() {
        let mut rows = Rows { a: vec![], b: vec![] };
        for k in 0..=40 {
            let x = f64::from(k) / 20.0 - 1.0;
            // | |x| - a | <= t in the unknowns (a, t).
            rows.a.push(Vector2::new(-1.0, -1.0));
            rows.b.push(-x.abs());
            rows.a.push(Vector2::new(1.0, -1.0));
            rows.b.push(x.abs());
        }
        let got = solve(&Vector2::new(0.0, 1.0), &rows, Vector2::new(0.2, 5.0), 1e-13).unwrap();
        assert!((got.x - Vector2::new(0.5, 0.5)).norm() < 1e-10 && got.gap < 1e-12);
        // The certificate: -b . y is the same value from below.
        let bound: f64 = -rows.b.iter().zip(&got.y).map(|(b, y)| b * y).sum::<f64>();
        assert!((bound - 0.5).abs() < 1e-8 && got.y.iter().all(|y| *y >= 0.0));
    }

    #[test]
    fn an_infeasible_start_and_an_endless_problem_are_refused() {
        let rows = Rows { a: vec![Vector2::new(1.0, 0.0)], b: vec![1.0] };
        assert!(solve(&Vector2::new(0.0, 1.0), &rows, Vector2::new(2.0, 0.0), 1e-12).is_none());
        assert!(solve(&Vector2::new(0.0, 1.0), &rows, Vector2::new(0.0, 0.0), 1e-12).is_none());
    }
}
