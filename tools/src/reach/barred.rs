//! Why a direction is not possible at a place.

use super::gap::Met;
use super::problem::{Place, Reach};
use super::stance::Stance;

/// What keeps the tool from a direction: the first of these that does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Barred {
    /// The axis leans off the normal by more than the greatest lean, or by less than the least.
    Lean,
    /// The machine does not allow the direction.
    Machine,
    /// The tool comes too near to something. Of all such points it is the one that lies lowest along the axis: what stands in the way first, as
    /// seen from the tip, which need not be what the tool goes into deepest.
    Meets(Met),
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
        let lowest = Stance::new(self, place, axis).lowest(self);
        lowest.map(|found| Barred::Meets(self.met(found)))
    }
}
