//! Caps and limits of the postures that are looked for.

use osculate_productivity::optimum::{Limits, Range};
use osculate_productivity::rate::Caps;

pub const CAPS: Caps = Caps { spindle_rpm: 10_000.0, teeth: 2, feed_mm_min: 2000.0, feed_per_tooth_mm: 0.1 };

pub fn limits() -> Limits {
    Limits {
        scallop_mm: 0.01,
        gouge_mm: 0.002,
        lead: Range { least_rad: 0.05, most_rad: 0.6 },
        tilt: Range { least_rad: -0.3, most_rad: 0.3 },
        axis: None,
        caps: CAPS,
    }
}
