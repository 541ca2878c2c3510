//! Durations and their inverse, G93's F.

/// Time for a way of the tip at the wanted feed, min.
#[must_use]
pub fn duration_min(tip_length_mm: f64, feed_mm_min: f64) -> f64 {
    tip_length_mm / feed_mm_min
}

/// F of a block in G93, 1/min.
///
/// ```
/// use osculate_postproc::feed::{duration_min, inverse_time_per_min};
///
/// // 60 mm at 600 mm/min: a tenth of a minute, F10 in G93.
/// let time_min = duration_min(60.0, 600.0);
/// assert_eq!((time_min, inverse_time_per_min(time_min)), (0.1, 10.0));
/// ```
#[must_use]
pub fn inverse_time_per_min(duration_min: f64) -> f64 {
    1.0 / duration_min
}
