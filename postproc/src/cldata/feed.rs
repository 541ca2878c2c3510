//! Feeds of CL data, as they are said.

/// A feed: per revolution it waits for the spindle's speed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feed {
    pub mm: f64,
    pub per_turn: bool,
    pub line: usize,
}
