//! How a parameter of a face is stretched so that nodes stand closer where the face bends faster.
//!
//! The stretched parameter grows by a density that is linear between equally spaced places, so that it has a slope without jumps and an
//! inverse in closed form. It runs over the same interval as the parameter itself.

use crate::rectangle::{AXES, Rectangle, lengths};
use osculate_geom::{Axis, Interval, Surface, Unit3, Uv};
use rayon::prelude::*;

/// Places along a parameter at which the face is looked at, and lines of them.
const PLACES: usize = 384;
const LINES: usize = 8;
/// Turn of the normal from node to node, rad.
const TURN_RAD: f64 = 0.1;
/// How many times closer nodes may stand than where they stand farthest, and over how many places that changes.
const CLOSER: f64 = 40.0;
const SPREAD: usize = 6;

/// A stretched parameter.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    interval: Interval,
    /// The density at equally spaced places, and the stretched parameter there.
    density: Vec<f64>,
    grown: Vec<f64>,
}

impl Pace {
    /// The parameter itself.
    pub fn even(interval: Interval) -> Self {
        Self { interval, density: vec![1.0; 2], grown: vec![interval.lo, interval.hi] }
    }

    /// Densities at equally spaced places, of any unit.
    fn of(interval: Interval, density: Vec<f64>) -> Self {
        let step = interval.length() / (density.len() - 1) as f64;
        let mut grown = vec![0.0];
        grown.extend(density.windows(2).scan(0.0, |sum, d| {
            *sum += 0.5 * (d[0] + d[1]) * step;
            Some(*sum)
        }));
        let scale = interval.length() / grown[grown.len() - 1];
        let density = density.into_iter().map(|d| d * scale).collect();
        let grown = grown.into_iter().map(|g| interval.lo + g * scale).collect();
        Self { interval, density, grown }
    }

    /// The step between places.
    fn step(&self) -> f64 {
        self.interval.length() / (self.density.len() - 1) as f64
    }

    /// The stretched parameter at a parameter of the interval, and its slope.
    pub fn at(&self, t: f64) -> (f64, f64) {
        let step = self.step();
        let x = (t - self.interval.lo) / step;
        // Places are few: a whole number within the table.
        let k = x.floor().clamp(0.0, self.density.len() as f64 - 2.0) as usize;
        let (a, b, f) = (self.density[k], self.density[k + 1], x - k as f64);
        (self.grown[k] + (a + 0.5 * (b - a) * f) * f * step, a + (b - a) * f)
    }

    /// The parameter of a stretched one.
    pub fn back(&self, s: f64) -> f64 {
        let step = self.step();
        let k = self.grown.partition_point(|g| *g <= s).clamp(1, self.grown.len() - 1) - 1;
        let (a, b) = (self.density[k], self.density[k + 1]);
        let rest = (s - self.grown[k]) / step;
        // The root of a f + (b - a) f^2 / 2 = rest without cancellation.
        let f = 2.0 * rest / (a + (a * a + 2.0 * (b - a) * rest).max(0.0).sqrt());
        self.interval.lo + (k as f64 + f) * step
    }
}

/// The paces of both parameters of a face for nodes no further apart than `side_mm` and a turn of its normal, and how many spans that
/// makes along each.
pub(super) fn paces(surface: &dyn Surface, rectangle: &Rectangle, side_mm: f64) -> ([Pace; 2], [f64; 2]) {
    let long = lengths(surface, rectangle);
    let both = AXES.map(|axis| {
        let turned = turns(surface, rectangle, axis);
        let mean = long[usize::from(axis == Axis::V)] / side_mm / turned.len() as f64;
        // Spans from place to place.
        let wanted: Vec<f64> = turned.iter().map(|t| mean.max(t / TURN_RAD)).collect();
        let most = wanted.iter().copied().fold(0.0, f64::max);
        let held: Vec<f64> = wanted.iter().map(|w| w.max(most / CLOSER)).collect();
        let smooth = smoothed(&held, rectangle.closes(axis));
        let spans = smooth.windows(2).map(|d| 0.5 * (d[0] + d[1])).sum();
        (Pace::of(rectangle.domain.get(axis), smooth), spans)
    });
    let [(u, along_u), (v, along_v)] = both;
    ([u, v], [along_u, along_v])
}

/// By how much the normal turns from place to place along a parameter, on the line where that is most, rad.
fn turns(surface: &dyn Surface, rectangle: &Rectangle, axis: Axis) -> Vec<f64> {
    let [i, across] = [rectangle.domain.get(axis), rectangle.domain.get(axis.other())];
    let line = |l: usize| -> Vec<f64> {
        let g = across.at((l as f64 + 0.5) / LINES as f64);
        let normal = |k: usize| -> Option<Unit3> {
            let at = Uv::from_axis(axis, i.at(k as f64 / PLACES as f64), g);
            surface.contains(at).then(|| surface.jet2(at).normal().ok()).flatten()
        };
        let normals: Vec<Option<Unit3>> = (0..=PLACES).map(normal).collect();
        let turn = |w: &[Option<Unit3>]| w[0].zip(w[1]).map_or(0.0, |(a, b)| a.angle(&b));
        normals.windows(2).map(turn).collect()
    };
    let lines: Vec<Vec<f64>> = (0..LINES).into_par_iter().map(line).collect();
    (0..PLACES).map(|k| lines.iter().map(|l| l[k]).fold(0.0, f64::max)).collect()
}

/// The greatest of what stands around each border of a place, then its mean.
fn smoothed(values: &[f64], closes: bool) -> Vec<f64> {
    let n = values.len() as i64;
    let value = |all: &[f64], k: i64| {
        let k = if closes { k.rem_euclid(all.len() as i64) } else { k.clamp(0, all.len() as i64 - 1) };
        all[k as usize]
    };
    let spread = SPREAD as i64;
    let around = |k: i64| (k - spread..k + spread).map(move |j| value(values, j));
    let greatest: Vec<f64> = (0..n).map(|k| around(k).fold(0.0, f64::max)).collect();
    let mean =
        |k: i64| (k - spread..k + spread).map(|j| value(&greatest, j)).sum::<f64>() / (2 * spread) as f64;
    (0..=n).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_and_its_inverse_agree_and_the_slope_is_that_of_the_pace() {
        let interval = Interval::new(-1.0, 3.0);
        let density: Vec<f64> =
            (0..=20).map(|k| 1.0 + 8.0 * (-f64::from((k - 13) * (k - 13)) / 4.0).exp()).collect();
        let pace = Pace::of(interval, density);
        for k in 0..=400 {
            let t = interval.at(f64::from(k) / 400.0);
            let (s, slope) = pace.at(t);
            assert!((pace.back(s) - t).abs() < 1e-12, "{t}: {}", pace.back(s));
            let (d, e) = (1e-6, pace.at((t + 1e-6).min(3.0)));
            if t + d < 3.0 {
                assert!(((e.0 - s) / d - slope).abs() < 1e-4);
            }
        }
        assert!((pace.at(-1.0).0 + 1.0).abs() < 1e-14 && (pace.at(3.0).0 - 3.0).abs() < 1e-12);
        let even = Pace::even(interval);
        assert_eq!(even.at(0.5), (0.5, 1.0));
    }
}
