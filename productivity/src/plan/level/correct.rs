//! How wide exact strips are along the level lines of a field that was made with closed forms.
//!
//! The closed form sees the section across the feed; the exact motion also has the part and the tool bend along a strip that
//! is wide against the tool, and in a hollow the closed form has no bound. Along lines that are nearly where they shall be
//! measured widths vary slowly over a face, so that a field made once more with them is even to the accuracy of the cells.

use super::cells::Cells;
use crate::plan::seat::Seat;

/// Root mean square of the spacing that passes may have, about its mean, below which a field is even enough.
const EVEN: f64 = 0.015;
/// Strips are not counted on to be wider than this, of the tool's radius.
const WIDEST: f64 = 2.0;
/// Rounds of averages over neighbouring cells.
const ROUNDS: u32 = 2;

impl Cells<'_> {
    /// For each cell how far passes may lie apart, smoothed, mm; None where passes have the same spacing in the field all over the
    /// face already.
    pub fn measured_widths(&self, seat: &Seat<'_>) -> Option<Vec<f64>> {
        let widest = WIDEST * seat.task().cutter.radius_mm();
        // Where strips are cut short by an extreme of the field they say nothing.
        let whole = |k: &usize| self.cells[*k].full && !self.cells[*k].at_extreme();
        let width = |k: usize| {
            Some(self.cells[k].spacing() / self.cells[k].slope_per_mm).filter(|w| w.is_finite() && whole(&k))
        };
        let mut widths = self
            .spread((0..self.cells.len()).map(|k| width(k).map_or(f64::NAN, |w| w.min(widest))).collect());
        if widths.iter().any(|w| w.is_nan()) {
            return None;
        }
        for _ in 0..ROUNDS {
            let mean = |k: usize| {
                let (sum, count) = self
                    .neighbours(k)
                    .fold((widths[k], 1.0), |(sum, count), m| (sum + widths[m], count + 1.0));
                sum / count
            };
            widths = (0..widths.len()).map(mean).collect();
        }
        let spacing = || (0..self.cells.len()).filter(whole).map(|k| self.cells[k].spacing());
        let count = spacing().count() as f64;
        let mean = spacing().sum::<f64>() / count;
        let square = spacing().map(|s| (s / mean - 1.0).powi(2)).sum::<f64>() / count;
        (square.sqrt() > EVEN).then_some(widths)
    }
}
