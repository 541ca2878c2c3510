//! What verification measured of a contender.

use serde::{Deserialize, Serialize};

/// What verification measured of a contender.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Measured {
    /// Highest material left, mm.
    pub scallop_max_mm: f64,
    /// Median, mm.
    pub scallop_median_mm: f64,
    /// Deepest gouge, mm.
    pub gouge_max_mm: f64,
    /// Area left standing, mm2.
    pub uncut_area_mm2: f64,
    /// Whether it is within tolerance.
    pub within_tolerance: bool,
    /// Area per minute at its places, least and greatest, mm2/min.
    pub instantaneous_mm2_min: [f64; 2],
    /// Mean over the passes, mm2/min.
    pub regional_mm2_min: f64,
    /// Area over time, mm2/min.
    pub global_mm2_min: f64,
}
