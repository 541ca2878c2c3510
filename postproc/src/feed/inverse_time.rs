//! Durations and their inverse, G93's F.

/// Time for a way of the tip at the wanted feed, min.
#[must_use]
pub fn duration_min(tip_length_mm: f64, feed_mm_min: f64) -> f64 {
    tip_length_mm / feed_mm_min
}

/// F of a block in G93, 1/min.
#[must_use]
pub fn inverse_time_per_min(duration_min: f64) -> f64 {
    1.0 / duration_min
}
