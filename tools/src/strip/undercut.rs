//! How deep the tool goes below the part on a walk across the strip.

use super::local::Near;
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::roots::try_minimum;

/// The lowest standoff seen on a walk, with the stretch in which the true minimum lies.
#[derive(Clone, Copy)]
pub(super) struct Undercut {
    /// The last two places, oldest first.
    pub last: [Option<Place>; 2],
    pub lowest: f64,
    /// The place before the lowest one, where a minimum stands between three places.
    before_lowest: Option<Place>,
}

/// One place of the walk.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub state: GeodesicState,
    pub t: Near,
    pub height: f64,
    /// The instant at which the tool is deepest over it, of all passages.
    pub deepest: f64,
}

impl Undercut {
    pub fn new(first: Place) -> Self {
        Self { last: [None, Some(first)], lowest: first.height, before_lowest: None }
    }

    pub fn see(&mut self, new: Place) {
        let height = new.height;
        if let [Some(a), Some(b)] = self.last
            && b.height <= a.height
            && b.height <= height
            && b.height <= self.lowest
        {
            self.before_lowest = Some(a);
        }
        self.lowest = self.lowest.min(height);
        self.last = [self.last[1], Some(new)];
    }

    /// Depth below the part, the minimum between places looked for over the two steps of `step` mm around it.
    ///
    /// `height` is asked for the standoff so far on from a place; `nearest` is how near in steps its place is asked for.
    pub fn deepest<E>(
        &self,
        step: f64,
        nearest: f64,
        height: impl Fn(&Place, f64) -> Result<f64, E>,
    ) -> Result<f64, E> {
        let Some(a) = self.before_lowest else { return Ok((-self.lowest).max(0.0)) };
        // A height is flat at its minimum: its place to half of double precision's digits is enough.
        let share = 0.5 * nearest.max(1e-7);
        let lowest = self.lowest.min(try_minimum([0.0, 2.0 * step], share, |x| height(&a, x))?.f);
        Ok((-lowest).max(0.0))
    }
}
