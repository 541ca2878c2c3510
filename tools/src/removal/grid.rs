//! One direction of a sampling grid: cells of equal weight, the weight being arc length in units of the
//! wanted spacing, more where the line bends.

use osculate_geom::{Interval, Jet2, Unit3, Vec3};

/// The spacing follows curvature so that the normal turns by about this much from sample to sample, rad ...
const TURN_RAD: f64 = 0.2;
/// ... but the spacing is never reduced to less than this share of what was asked for.
const DENSEST: f64 = 0.25;
/// Least number of steps in the table of a whole line; between its steps the line's speed is taken to vary
/// slowly.
const TABLE_STEPS: usize = 48;
/// Weight below which a line is a point: a pole.
const POINT: f64 = 1e-6;

/// A cell of the grid with its sample's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub lo: f64,
    pub at: f64,
    pub hi: f64,
}

/// Samples per unit of parameter along a line with derivative `rate` and second derivative `bend`.
pub(super) fn weight(rate: &Vec3, bend: &Vec3, normal: Option<&Unit3>, spacing_mm: f64) -> f64 {
    let speed = rate.norm();
    let plain = speed / spacing_mm;
    // Normal curvature is |n . bend| / speed^2, times the length per parameter.
    let turning = normal.map_or(0.0, |n| n.dot(bend).abs() / (speed * TURN_RAD));
    if turning.is_finite() { plain.max(turning.min(plain / DENSEST)) } else { plain }
}

/// The outward normal where there is one, from the first derivatives alone.
pub(super) fn normal(jet: &Jet2) -> Option<Unit3> {
    Unit3::try_new(jet.du.cross(&jet.dv), 0.0)
}

/// Cumulated weight along one direction.
pub(super) struct Table {
    interval: Interval,
    at: Vec<f64>,
    sum: Vec<f64>,
}

impl Table {
    /// The table of `density` (samples per parameter) over the spans between `breaks`.
    pub fn new(interval: Interval, breaks: &[f64], density: impl Fn(f64) -> f64) -> Self {
        let spans = breaks.len().saturating_sub(1).max(1);
        let steps = TABLE_STEPS.div_ceil(spans).max(2);
        let mut at = vec![interval.lo];
        for pair in breaks.windows(2) {
            let (lo, hi) = (pair[0].max(interval.lo), pair[1].min(interval.hi));
            if hi > lo {
                at.extend((1..=steps).map(|k| lo + (hi - lo) * k as f64 / steps as f64));
            }
        }
        let mut sum = vec![0.0];
        let mut total = 0.0;
        for pair in at.windows(2) {
            // Midpoints: a pole at the end of the line is not evaluated.
            total += (pair[1] - pair[0]) * density(0.5 * (pair[0] + pair[1]));
            sum.push(total);
        }
        Self { interval, at, sum }
    }

    /// The number of samples wanted along the line.
    pub fn total(&self) -> f64 {
        *self.sum.last().expect("a table has at least one entry")
    }

    /// The number of cells.
    pub fn count(&self) -> f64 {
        let total = self.total();
        if total < POINT {
            1.0
        } else if self.interval.periodic {
            total.ceil().max(3.0)
        } else {
            total.ceil() + 1.0
        }
    }

    /// The parameter at which the cumulated weight is the given share of the total.
    fn place(&self, share: f64) -> f64 {
        let wanted = share * self.total();
        let k = self.sum.partition_point(|s| *s < wanted).clamp(1, self.sum.len() - 1);
        let (s0, s1) = (self.sum[k - 1], self.sum[k]);
        let f = if s1 > s0 { ((wanted - s0) / (s1 - s0)).clamp(0.0, 1.0) } else { 0.0 };
        self.at[k - 1] + f * (self.at[k] - self.at[k - 1])
    }

    /// The cells. Where the line ends, its ends are samples with half a cell each; where it closes, none is.
    pub fn cells(&self) -> Vec<Cell> {
        let count = self.count();
        let Interval { lo, hi, periodic } = self.interval;
        if count == 1.0 || self.at.len() < 2 {
            return vec![Cell { lo, at: 0.5 * (lo + hi), hi }];
        }
        let n = count as usize;
        let edge = |x: f64| {
            if x <= 0.0 {
                lo
            } else if x >= 1.0 {
                hi
            } else {
                self.place(x)
            }
        };
        (0..n)
            .map(|k| {
                let k = k as f64;
                if periodic {
                    Cell { lo: edge(k / count), at: edge((k + 0.5) / count), hi: edge((k + 1.0) / count) }
                } else {
                    let m = count - 1.0;
                    Cell { lo: edge((k - 0.5) / m), at: edge(k / m), hi: edge((k + 0.5) / m) }
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_tile_the_line() {
        for periodic in [false, true] {
            let interval = Interval { lo: -1.0, hi: 3.0, periodic };
            // Weight 10 (2 + sin t), integral 10 (8 + cos(-1) - cos 3).
            let table = Table::new(interval, &[-1.0, 0.5, 3.0], |t| 10.0 * (2.0 + t.sin()));
            let want = 10.0 * (8.0 + 1f64.cos() - 3f64.cos());
            // Midpoint rule, steps of at most 0.105: error below 4 * 0.105^2 / 24 * 10 = 0.02.
            assert!((table.total() - want).abs() < 0.02, "{} {want}", table.total());
            let cells = table.cells();
            assert_eq!(cells[0].lo, -1.0);
            assert_eq!(cells[cells.len() - 1].hi, 3.0);
            for pair in cells.windows(2) {
                assert_eq!(pair[0].hi, pair[1].lo);
            }
            for c in &cells {
                assert!(c.lo <= c.at && c.at <= c.hi && c.lo < c.hi);
            }
            assert_eq!(cells[0].at == -1.0, !periodic);
            assert_eq!(cells[cells.len() - 1].at == 3.0, !periodic);
        }
    }

    #[test]
    fn a_pole_is_one_cell() {
        let table = Table::new(Interval::periodic(0.0, 6.0), &[0.0, 6.0], |_| 0.0);
        let cells = table.cells();
        assert!(cells.len() == 1 && cells[0].lo == 0.0 && cells[0].hi == 6.0);
    }
}
