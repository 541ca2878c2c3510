//! How much wider exact strips are than the closed form that a field was made with.
//!
//! The closed form sees the section across the feed; the exact motion also has the part and the tool bend along a strip that
//! is wide against the tool. The quotient varies slowly over a face, so that a field made once more with corrected widths is
//! even to the accuracy of the cells.

use super::cells::{Cells, place};
use super::even::closed_width_mm;
use crate::plan::seat::Seat;

/// Root mean square of the spacing that passes may have, about its mean, below which a field is even enough.
const EVEN: f64 = 0.015;
/// The quotient is taken between these.
const BETWEEN: [f64; 2] = [0.5, 2.0];
/// Rounds of averages over neighbouring cells.
const ROUNDS: u32 = 2;

impl Cells<'_> {
    /// For each cell the exact width of strips over the closed form, smoothed; None where passes have the same spacing in the
    /// field all over the face already.
    pub fn correction(&self, seat: &Seat<'_>) -> Option<Vec<f64>> {
        let (task, n) = (seat.task(), self.count);
        let raw = (0..self.cells.len())
            .map(|k| {
                let c = &self.cells[k];
                let at = place(&self.face, n, (k / n[1]) as f64 + 0.5, (k % n[1]) as f64 + 0.5);
                let exact = (c.up + c.down) / c.slope_per_mm;
                // Where strips are cut short by an extreme of the field they say nothing.
                let whole = c.full && exact.is_finite();
                let closed = if whole { closed_width_mm(task, &self.face, at) } else { None };
                closed.map_or(f64::NAN, |w| (exact / w).clamp(BETWEEN[0], BETWEEN[1]))
            })
            .collect();
        let mut factors = self.spread(raw);
        for _ in 0..ROUNDS {
            let mean = |k: usize| {
                let (sum, count) = self
                    .neighbours(k)
                    .fold((factors[k], 1.0), |(sum, count), m| (sum + factors[m], count + 1.0));
                sum / count
            };
            factors = (0..factors.len()).map(mean).collect();
        }
        let spacing = || self.cells.iter().filter(|c| c.full && !c.at_extreme()).map(|c| c.up + c.down);
        let count = spacing().count() as f64;
        let mean = spacing().sum::<f64>() / count;
        let square = spacing().map(|s| (s / mean - 1.0).powi(2)).sum::<f64>() / count;
        (square.sqrt() > EVEN).then_some(factors)
    }
}
