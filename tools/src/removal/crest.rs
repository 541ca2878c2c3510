//! Crests of what a path leaves: the ridges between passes.
//!
//! Material between two passes rises from one to a ridge and falls to the other, so that most of the area stands far below
//! the scallop: the median height over the area is a quarter of it for parabolic strips. How well passes use the tolerance
//! is told by the ridges alone. A sample is on one where none within a distance stands higher: uphill of every other sample
//! there is one. The highest of a stretch of ridge is counted, as sampled: below the true height by what the ridge falls
//! over half the spacing of the samples.

use super::job::{Cut, Sample};
use osculate_geom::Point3;
use rayon::prelude::*;
use std::collections::HashMap;

/// A cell of space.
type Key = [i64; 3];

fn key(p: &Point3, side_mm: f64) -> Key {
    // Faces are far smaller than 2^63 cells.
    [p.x, p.y, p.z].map(|x| (x / side_mm).floor() as i64)
}

/// Median over the machined samples that are higher than all others of their face within `around_mm`, of those that stand
/// above the part by no more than `uncut_mm`; zero where there are none.
#[must_use]
pub fn crests(samples: &[Sample], cuts: &[Cut], around_mm: f64, uncut_mm: f64) -> f64 {
    if !(around_mm > 0.0 && around_mm.is_finite()) {
        return 0.0;
    }
    let mut cells: HashMap<Key, Vec<usize>> = HashMap::new();
    for (k, s) in samples.iter().enumerate().filter(|(_, s)| !s.check_only) {
        cells.entry(key(&s.point, around_mm)).or_default().push(k);
    }
    let heights: Vec<f64> = samples.iter().zip(cuts).map(|(_, c)| c.standoff_mm).collect();
    let highest = |k: usize| {
        let (s, [x, y, z]) = (&samples[k], key(&samples[k].point, around_mm));
        let ahead = |m: usize| {
            let (o, near) =
                (&samples[m], (samples[m].point - s.point).norm_squared() < around_mm * around_mm);
            // Of equals the first counts.
            let higher = heights[m] > heights[k] || (heights[m] == heights[k] && m < k);
            higher && near && o.face == s.face
        };
        let around = (-1..=1).flat_map(|a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [a, b, c])));
        !around
            .filter_map(|[a, b, c]| cells.get(&[x + a, y + b, z + c]))
            .any(|cell| cell.iter().any(|m| ahead(*m)))
    };
    let counts = |k: &usize| {
        let above = heights[*k] > 0.0 && heights[*k] <= uncut_mm && cuts[*k].by.is_some();
        above && !samples[*k].check_only && highest(*k)
    };
    let mut found: Vec<f64> = (0..heights.len()).into_par_iter().filter(counts).map(|k| heights[k]).collect();
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied().unwrap_or(0.0)
}
