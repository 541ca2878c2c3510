//! One cell of the parameter rectangle, and which way passes run.

/// One cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    /// Values of the field on what lies inside the face; empty (low above high) where nothing does.
    pub low: f64,
    pub high: f64,
    /// Whether all of it lies inside.
    pub full: bool,
    /// Reaches of passes above and below as differences of the field: of those with the uphill side to the left, and of those
    /// that run the other way.
    pub up: [f64; 2],
    pub down: [f64; 2],
    /// Slope of the field, 1/mm.
    pub slope_per_mm: f64,
    /// Where the way up from here ends inside the face, and the way down: beyond these levels no pass lies near.
    pub peak: f64,
    pub floor: f64,
}

impl Cell {
    /// How far passes may lie apart that run to and fro, as a difference of the field: the lesser of both kinds of ridges.
    pub fn spacing(&self) -> f64 {
        (self.down[0] + self.up[1]).min(self.down[1] + self.up[0])
    }

    /// Width of strips, mm.
    pub fn width_mm(&self) -> f64 {
        0.5 * (self.up[0] + self.up[1] + self.down[0] + self.down[1]) / self.slope_per_mm
    }

    pub fn inside(&self) -> bool {
        self.low <= self.high
    }

    /// Whether the field has an extreme of the face here.
    pub fn at_extreme(&self) -> bool {
        self.floor == self.low || self.peak == self.high
    }
}

/// Which way passes run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ways {
    /// Either way on any level: what holds both ways is counted on.
    Either,
    /// To and fro by level; the first with the uphill side to the left, or the other way.
    ToAndFro { first_reversed: bool },
}

impl Ways {
    /// Whether the passes on a level are reversed, where that is settled.
    pub fn reversed(self, level: usize) -> Option<bool> {
        match self {
            Self::Either => None,
            Self::ToAndFro { first_reversed } => Some(first_reversed ^ (level % 2 == 1)),
        }
    }

    /// Which of a cell's reaches count below and above a ridge: those of the level before, and those of this one.
    pub fn around(self, level: usize) -> [usize; 2] {
        self.reversed(level).map_or([0, 0], |r| [usize::from(!r), usize::from(r)])
    }
}
