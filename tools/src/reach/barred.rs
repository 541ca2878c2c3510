//! Why a direction is not possible at a place.

use super::gap::{Gap, Met};
use super::problem::{Place, Reach};

/// What keeps the tool from a direction: the first of these that does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Barred {
    /// The axis leans off the normal by more than the greatest lean, or by less than the least.
    Lean,
    /// The machine does not allow the direction.
    Machine,
    /// The tool comes too near to something, by as much as the spare is below zero; what is nearest, measured from its limit, is named.
    Near(Gap),
}

impl Barred {
    /// What the tool comes too near to, and with which body.
    #[must_use]
    pub const fn met(&self) -> Option<Met> {
        match self {
            Self::Near(gap) => gap.met,
            Self::Lean | Self::Machine => None,
        }
    }
}

impl Reach<'_> {
    /// What keeps the tool from a direction of the set at a place; None exactly where [`Reach::bits`] has the direction.
    ///
    /// # Panics
    /// For an index that is no direction's.
    #[must_use]
    pub fn barred(&self, place: &Place, direction: usize) -> Option<Barred> {
        let axis = &self.directions.all()[direction];
        if !self.leans_within_limits(place, axis) {
            return Some(Barred::Lean);
        }
        if !self.allows(place, direction) {
            return Some(Barred::Machine);
        }
        (!self.is_clear(place, axis)).then(|| Barred::Near(self.gap(place, axis)))
    }
}
