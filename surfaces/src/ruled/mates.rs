//! Which point of one border belongs to which point of the other: the rules of a face, or the best there are.
//!
//! A rule from the parameter t on the first border to s on the second one is worth
//!
//! ```text
//! e(t, s) = max over points of the straight segment of their distance to the face
//! ```
//!
//! On a grid of t and s the rising chain `s(t)` of least sum of e^2 is found by dynamic programming; each mate is then closed
//! in on between its neighbours. What comes is the best among chains on the grid, refined: not proven the best of all.
//! Where rules need not reach the corners, the longest run of them within the tolerance is kept.

use super::asked::{Band, RulingError, RulingOptions, border};
use crate::closest::{ClosestError, closest_near};
use osculate_geom::roots::try_minimum;
use osculate_geom::{Point3, Surface, Uv};

/// One rule: where it begins and ends on the borders of a band, and how far it strays from the face.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Mate {
    /// Parameter of the face along the border at the low end of the band.
    pub at_low: f64,
    /// Parameter along the border at the high end.
    pub at_high: f64,
    /// Greatest distance of the segment between from the face, mm, at the places checked.
    pub error_mm: f64,
}

/// Distances from the face along segments between both borders.
pub(super) struct Segments<'a> {
    pub surface: &'a dyn Surface,
    pub band: Band,
    pub checks: usize,
}

impl Segments<'_> {
    fn ends(&self, t: f64, s: f64) -> [Point3; 2] {
        [border(self.surface, &self.band, 0, t), border(self.surface, &self.band, 1, s)]
    }

    /// e(t, s), both as shares of the range along the borders.
    pub fn error(&self, t: f64, s: f64) -> Result<f64, RulingError> {
        let [a, b] = self.ends(t, s);
        let along = self.surface.domain().get(self.band.along);
        let mut worst = 0.0f64;
        for k in 1..=self.checks {
            let share = k as f64 / (self.checks + 1) as f64;
            let hint =
                Uv::from_axis(self.band.along, along.at(t + (s - t) * share), self.band.across.at(share));
            let p = a + (b - a) * share;
            worst = worst.max(distance(self.surface, &p, hint)?);
        }
        Ok(worst)
    }
}

/// Distance of a point from the face near a hint, mm: never too small. A descent that stops short (points that all but lie
/// on the face have no offset to be perpendicular) has found a point of the face all the same.
pub(super) fn distance(surface: &dyn Surface, p: &Point3, hint: Uv) -> Result<f64, ClosestError> {
    match closest_near(surface, p, hint) {
        Ok(foot) => Ok(foot.distance_mm),
        Err(ClosestError::NotConverged { distance_mm, .. }) => Ok(distance_mm),
        Err(why) => Err(why),
    }
}

/// How far t and s may lie apart, as a share of the range: rules more oblique than that are not looked for.
const OBLIQUE: f64 = 0.5;

/// The best rising chain of mates at `count` values of t.
pub(super) fn chain(segments: &Segments<'_>, how: &RulingOptions) -> Result<Vec<Mate>, RulingError> {
    let n = how.rules.max(3) - 1;
    let fine = 2 * n;
    let (t, s) = (|i: usize| i as f64 / n as f64, |j: usize| j as f64 / fine as f64);
    // Least sum of squares of chains up to (i, j), and the mate before.
    let mut best: Vec<Vec<(f64, usize)>> = Vec::with_capacity(n + 1);
    for i in 0..=n {
        let mut row = vec![(f64::INFINITY, 0); fine + 1];
        // The best chain so far over all mates below j: rules must not meet on the border.
        let mut lower = (f64::INFINITY, 0);
        for j in 0..=fine {
            if let Some(last) = best.last()
                && j > 0
                && last[j - 1].0 < lower.0
            {
                lower = (last[j - 1].0, j - 1);
            }
            let corner = (i == 0 && j != 0) || (i == n && j != fine);
            if (s(j) - t(i)).abs() > OBLIQUE || (how.keep_corners && corner) {
                continue;
            }
            let before = if i == 0 { (0.0, 0) } else { lower };
            if before.0.is_finite() {
                let e = segments.error(t(i), s(j))?;
                row[j] = (e * e + before.0, before.1);
            }
        }
        best.push(row);
    }
    let mut j = (0..=fine).min_by(|a, b| best[n][*a].0.total_cmp(&best[n][*b].0)).unwrap_or(fine);
    let mut mates = vec![0.0; n + 1];
    for i in (0..=n).rev() {
        mates[i] = s(j);
        j = best[i][j].1;
    }
    refine(segments, how, &mut mates)?;
    let along = segments.surface.domain().get(segments.band.along);
    let all: Result<Vec<Mate>, RulingError> = (0..=n)
        .map(|i| {
            let error_mm = segments.error(t(i), mates[i])?;
            Ok(Mate { at_low: along.at(t(i)), at_high: along.at(mates[i]), error_mm })
        })
        .collect();
    let all = all?;
    Ok(if how.keep_corners { all } else { longest_run(all, how.tolerance_mm) })
}

/// Fewest rules that carry cubic directrices.
const FEWEST: usize = 4;

/// The longest run of rules within the tolerance; all of them where it is too short for directrices.
fn longest_run(all: Vec<Mate>, tolerance_mm: f64) -> Vec<Mate> {
    let runs = all.split(|m| m.error_mm > tolerance_mm);
    let longest = runs.max_by_key(|r| r.len()).map(<[Mate]>::to_vec).unwrap_or_default();
    if longest.len() >= FEWEST { longest } else { all }
}

/// Every mate moved to its least error between its neighbours, a few times over.
fn refine(segments: &Segments<'_>, how: &RulingOptions, mates: &mut [f64]) -> Result<(), RulingError> {
    const ROUNDS: usize = 2;
    /// Mates are found to this share of a cell.
    const SHARE: f64 = 1e-5;
    let n = mates.len() - 1;
    let cell = 1.0 / (2 * n) as f64;
    for round in 0..ROUNDS {
        let width = cell * 0.5f64.powi(round as i32);
        for i in 0..=n {
            if how.keep_corners && (i == 0 || i == n) {
                continue;
            }
            let low = if i == 0 { 0.0 } else { mates[i - 1] + 0.2 * cell };
            let high = if i == n { 1.0 } else { mates[i + 1] - 0.2 * cell };
            let (a, b) = ((mates[i] - width).max(low), (mates[i] + width).min(high));
            if b <= a {
                continue;
            }
            let t = i as f64 / n as f64;
            let found = try_minimum([a, b], SHARE, |x| segments.error(t, x))?;
            if found.f < segments.error(t, mates[i])? {
                mates[i] = found.x;
            }
        }
    }
    Ok(())
}
