//! Parameters of points and the knots that go with them.

use super::FitError;
use nalgebra::Point;

/// How the parameter runs from point to point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Spacing {
    /// Equal steps, whatever the distances: for points that are spaced evenly.
    Uniform,
    /// Steps like the distances: speed near one, overshoots at sharp turns.
    Chord,
    /// Steps like the roots of the distances (Lee): calmer where distances change or the points turn sharply.
    #[default]
    Centripetal,
}

impl Spacing {
    /// The step over a distance.
    fn step(self, distance: f64) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Chord => distance,
            Self::Centripetal => distance.sqrt(),
        }
    }
}

/// Parameters from 0 to 1 of the points, one more at the end for a closed row.
pub(super) fn parameters<const D: usize>(
    points: &[Point<f64, D>],
    spacing: Spacing,
    closed: bool,
) -> Result<Vec<f64>, FitError> {
    let count = points.len();
    let ends = (1..count + usize::from(closed)).map(|k| [k - 1, k % count]);
    let mut sums = vec![0.0];
    for [a, b] in ends {
        let distance = (points[b] - points[a]).norm();
        if distance == 0.0 {
            return Err(FitError::Coincident { index: a });
        }
        sums.push(sums[sums.len() - 1] + spacing.step(distance));
    }
    let total = sums[sums.len() - 1];
    let last = sums.len() - 1;
    Ok(sums.iter().enumerate().map(|(k, s)| if k == last { 1.0 } else { s / total }).collect())
}

/// The mean of several rows of parameters.
pub(super) fn mean(rows: &[Vec<f64>]) -> Vec<f64> {
    let mut sum = vec![0.0; rows[0].len()];
    for row in rows {
        for (s, t) in sum.iter_mut().zip(row) {
            *s += t / rows.len() as f64;
        }
    }
    let last = sum.len() - 1;
    sum[last] = 1.0;
    sum
}

/// Clamped knots for as many poles as parameters: means of `degree` neighbours [The NURBS Book, eq. 9.8].
pub(super) fn averaged(degree: usize, parameters: &[f64]) -> Vec<f64> {
    let n = parameters.len();
    let inner = (1..n - degree).map(|j| parameters[j..j + degree].iter().sum::<f64>() / degree as f64);
    clamped(degree, inner)
}

/// Clamped knots for `poles` poles so that every span holds parameters [The NURBS Book, eq. 9.68, 9.69].
pub(super) fn spread(degree: usize, poles: usize, parameters: &[f64]) -> Vec<f64> {
    let d = parameters.len() as f64 / (poles - degree) as f64;
    let inner = (1..poles - degree).map(|j| {
        let at = j as f64 * d;
        let i = at as usize;
        let part = at - i as f64;
        (1.0 - part) * parameters[i - 1] + part * parameters[i]
    });
    clamped(degree, inner)
}

fn clamped(degree: usize, inner: impl Iterator<Item = f64>) -> Vec<f64> {
    let end = |t: f64| std::iter::repeat_n(t, degree + 1);
    end(0.0).chain(inner).chain(end(1.0)).collect()
}

/// Knots of a closed spline with the given breaks over one turn `[first, first + 1]`, continued periodically by
/// `degree` steps on both sides.
pub(super) fn periodic(degree: usize, breaks: &[f64]) -> Vec<f64> {
    let n = breaks.len() - 1;
    let at = |k: isize| {
        let turns = k.div_euclid(n as isize);
        breaks[k.rem_euclid(n as isize) as usize] + turns as f64
    };
    (-(degree as isize)..=(n + degree) as isize)
        .map(|k| if k == n as isize { breaks[n] } else { at(k) })
        .collect()
}

/// Breaks of a closed spline with `poles` poles that spread the parameters (the last one is the first again).
pub(super) fn spread_closed(poles: usize, parameters: &[f64]) -> Vec<f64> {
    let m = parameters.len() - 1;
    (0..=poles)
        .map(|j| {
            let at = j as f64 * m as f64 / poles as f64;
            let i = (at as usize).min(m - 1);
            let part = at - i as f64;
            (1.0 - part) * parameters[i] + part * parameters[i + 1]
        })
        .collect()
}

/// Breaks of a closed interpolating spline: the parameters themselves for an odd degree, the middles between
/// them for an even one, where knots at the points would leave an even number of them undetermined.
pub(super) fn closed_breaks(degree: usize, parameters: &[f64]) -> Vec<f64> {
    if degree % 2 == 1 {
        return parameters.to_vec();
    }
    let mut middles: Vec<f64> = parameters.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    middles.push(middles[0] + 1.0);
    middles
}
