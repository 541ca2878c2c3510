//! Which places the courses laid so far take in, and where the next one is to start.

use super::course::{Course, from_piece};
use super::wants::Want;

/// The next course goes through a place that is nearly as far off the last ones as both reach together.
const FRONTIER: f64 = 1.9;
/// What lies between places is allowed for by this part of half their distance: lines that come together leave pointed peaks.
const BETWEEN: f64 = 0.5;
/// Bins along one side, at most.
const MOST_BINS: usize = 2048;

/// The wants by their positions, each with its distance from the nearest course over its reach.
pub(super) struct Laid<'a> {
    wants: &'a [Want],
    /// At most 1 where a course takes the place in.
    ratio: Vec<f64>,
    bins: Vec<Vec<u32>>,
    lo: [f64; 2],
    cell: f64,
    n: [usize; 2],
    furthest: f64,
}

/// An open place beside a piece of a course: how far along the piece, 0 to 1.
pub(super) struct Beside<'a> {
    pub want: &'a Want,
    pub along: f64,
}

/// How far a course may be off a place.
fn reach(w: &Want) -> f64 {
    (w.reach - BETWEEN * w.widest()).max(0.5 * w.reach)
}

impl<'a> Laid<'a> {
    pub(super) fn new(wants: &'a [Want]) -> Self {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for w in wants {
            for k in 0..2 {
                lo[k] = lo[k].min(w.at[k]);
                hi[k] = hi[k].max(w.at[k]);
            }
        }
        let furthest = wants.iter().map(|w| w.reach).fold(0.0, f64::max);
        let extent = [hi[0] - lo[0], hi[1] - lo[1]].map(|e| e.max(0.0));
        let cell = furthest.max(extent[0].max(extent[1]) / MOST_BINS as f64).max(f64::MIN_POSITIVE);
        // At most one more than the most bins.
        let n = extent.map(|e| (e / cell) as usize + 1);
        let mut bins = vec![Vec::new(); n[0] * n[1]];
        for (k, w) in (0_u32..).zip(wants) {
            let b = |i: usize| (((w.at[i] - lo[i]) / cell) as usize).min(n[i] - 1);
            bins[b(1) * n[0] + b(0)].push(k);
        }
        Self { wants, ratio: vec![f64::INFINITY; wants.len()], bins, lo, cell, n, furthest }
    }

    fn around(&self, a: [f64; 2], b: [f64; 2], by: f64) -> impl Iterator<Item = usize> {
        let range = |k: usize| {
            let (lo, hi) = (a[k].min(b[k]) - by - self.lo[k], a[k].max(b[k]) + by - self.lo[k]);
            // Negative values saturate at zero.
            let last = if hi < 0.0 { 0 } else { ((hi / self.cell) as usize + 1).min(self.n[k]) };
            (lo / self.cell) as usize..last
        };
        let (across, rows) = (range(0), range(1));
        rows.flat_map(move |j| across.clone().map(move |i| j * self.n[0] + i))
            .flat_map(|b| self.bins[b].iter().map(|k| *k as usize))
    }

    /// The open places that a piece of a course takes in, abreast of it.
    pub(super) fn open(&self, a: [f64; 2], b: [f64; 2]) -> impl Iterator<Item = Beside<'_>> {
        self.around(a, b, self.furthest).filter(|k| self.ratio[*k] > 1.0).filter_map(move |k| {
            let want = &self.wants[k];
            let (d, along) = from_piece(want.at, a, b);
            (d <= reach(want) && along > 0.0 && along < 1.0).then_some(Beside { want, along })
        })
    }

    /// Adds a course.
    pub(super) fn add(&mut self, course: &Course) {
        for w in course.nodes().windows(2) {
            let near: Vec<usize> = self.around(w[0], w[1], FRONTIER * self.furthest).collect();
            for k in near {
                let (d, _) = from_piece(self.wants[k].at, w[0], w[1]);
                self.ratio[k] = self.ratio[k].min(d / reach(&self.wants[k]));
            }
        }
    }

    /// How far places are off the nearest course, of the reach that they are taken in with; infinite far from all.
    pub(super) fn into_shares(self) -> Vec<f64> {
        self.ratio
    }

    /// Counts a place as taken in, whether it is or not.
    pub(super) fn give_up(&mut self, k: usize) {
        self.ratio[k] = 0.0;
    }

    /// The place through which the next course goes: the furthest that leaves no gap beside the last ones, or any.
    pub(super) fn next(&self) -> Option<usize> {
        let mut best: Option<(bool, f64, usize)> = None;
        for (k, r) in self.ratio.iter().enumerate() {
            if *r <= 1.0 {
                continue;
            }
            let here = (*r <= FRONTIER, if *r <= FRONTIER { *r } else { 0.0 }, k);
            if best.is_none_or(|b| (here.0, here.1) > (b.0, b.1)) {
                best = Some(here);
            }
        }
        best.map(|b| b.2)
    }
}
