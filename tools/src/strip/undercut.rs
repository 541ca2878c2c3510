//! How deep the tool goes below the part on a walk across the strip.

use super::local::Near;
use osculate_geom::geodesic::GeodesicState;

/// Most steps towards the deepest place across.
const MOST_PARABOLAS: u32 = 30;

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

    /// Depth below the part, the minimum between places found by parabolas over the two steps of `step` mm around it.
    ///
    /// `height` is asked for the standoff so far on from a place; `nearest` is how near in steps the parabolas come.
    pub fn deepest<E>(
        &self,
        step: f64,
        nearest: f64,
        height: impl Fn(&Place, f64) -> Result<f64, E>,
    ) -> Result<f64, E> {
        let Some(a) = self.before_lowest else { return Ok((-self.lowest).max(0.0)) };
        let height = |x: f64| height(&a, x);
        // Three places around the minimum, closed in on by parabolas, by halves where these stand still.
        let mut x = [0.0, step, 2.0 * step];
        let mut f = [a.height, height(x[1])?, height(x[2])?];
        for round in 0..MOST_PARABOLAS {
            let (da, dc) = (x[1] - x[0], x[1] - x[2]);
            let (fa, fc) = (f[1] - f[0], f[1] - f[2]);
            let bottom = da * fc - dc * fa;
            let by = 0.5 * (da * da * fc - dc * dc * fa) / bottom;
            let inside = bottom != 0.0 && x[1] - by > x[0] && x[1] - by < x[2];
            // Every third step halves the longer side.
            let new = if inside && round % 3 != 2 {
                x[1] - by
            } else if da > -dc {
                x[1] - 0.5 * da
            } else {
                x[1] - 0.5 * dc
            };
            // A height is flat at its minimum: its place to half of double precision's digits is enough.
            if (new - x[1]).abs() < 1e-7f64.max(nearest) * step {
                break;
            }
            let g = height(new)?;
            let above = new > x[1];
            if g < f[1] {
                if above {
                    (x[0], f[0]) = (x[1], f[1]);
                } else {
                    (x[2], f[2]) = (x[1], f[1]);
                }
                (x[1], f[1]) = (new, g);
            } else if above {
                (x[2], f[2]) = (new, g);
            } else {
                (x[0], f[0]) = (new, g);
            }
        }
        let lowest = self.lowest.min(f[1]);
        Ok((-lowest).max(0.0))
    }
}
