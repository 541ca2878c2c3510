//! Feeds of CL data, as they are said.

/// A feed: per revolution it waits for the spindle's speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feed {
    pub mm: f64,
    pub per_turn: bool,
    pub line: usize,
}

/// Feeds that a control can be given, mm/min or mm per revolution.
pub(super) const FEEDS: std::ops::RangeInclusive<f64> = 1e-6..=1e9;
