//! Levels for contours: round numbers, a dozen over a field's range.

use crate::report::legend::nice_step;

/// Multiples of a round step strictly between `lo` and `hi`: between 0.6 and 1.6 times `count` of them.
pub fn nice_levels(lo: f64, hi: f64, count: usize) -> Vec<f64> {
    let range = hi - lo;
    if !(range > 0.0 && range.is_finite()) || count == 0 {
        return Vec::new();
    }
    // Round steps are up to 2.5 times apart: rounding up from below keeps the count around what is asked for.
    let step = nice_step(range / (1.6 * count as f64));
    let (first, last) = ((lo / step).ceil() as i64, (hi / step).floor() as i64);
    // The ends themselves are points or borders, not lines.
    let inside = |l: &f64| *l > lo + 1e-9 * range && *l < hi - 1e-9 * range;
    // Powers of ten below one have no exact step: dividing by the whole number has.
    let at = |k: i64| if step < 1.0 { k as f64 / (1.0 / step).round() } else { k as f64 * step };
    let exact = ((1.0 / step).round() * step - 1.0).abs() < 1e-9 || step >= 1.0;
    (first..=last).map(|k| if exact { at(k) } else { k as f64 * step }).filter(inside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_round_and_inside() {
        assert_eq!(nice_levels(0.0, 10.0, 4), [2.0, 4.0, 6.0, 8.0]);
        assert_eq!(nice_levels(-0.05, 0.05, 7), [-0.04, -0.03, -0.02, -0.01, 0.0, 0.01, 0.02, 0.03, 0.04]);
        assert!(nice_levels(1.0, 1.0, 5).is_empty() && nice_levels(0.0, f64::NAN, 5).is_empty());
    }
}
