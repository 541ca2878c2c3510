//! The way through the air from where the tool is to where it goes on: over what stands in rapid, low over it at the feed of the air, or around it,
//! whichever is faster.
//!
//! A rapid goes from rest to rest three times, keeps the approach distance off what stands and is fed from there down; a way at the feed
//! goes as low as nothing is taken, and down to its end at once. So the next line is gone on to past a wall, and what lies far is
//! flown to.

use super::moves::{Moves, apart};
use crate::plan::link::Step;

/// A way of the tip with its time.
struct Flight {
    places: Vec<[f64; 3]>,
    min: f64,
}

impl Moves<'_> {
    /// How low the tool may go over a straight way in rapid.
    fn clear_over(&self, from: [f64; 2], to: [f64; 2]) -> f64 {
        let (site, long) = (self.site, (to[0] - from[0]).hypot(to[1] - from[1]));
        let steps = (long / (2.0 * site.grid.cell)).ceil().max(1.0) as usize;
        let mut out = f64::NEG_INFINITY;
        for s in 0..=steps {
            let f = s as f64 / steps as f64;
            let Some(k) = site.grid.near([0, 1].map(|a| from[a] + (to[a] - from[a]) * f)) else {
                return self.manner.safe;
            };
            let stands = self.columns.top_in(&site.grid, &self.wide, k);
            out = out.max(stands).max(self.holder_stops(k)).max(self.part_stops(k));
        }
        out
    }

    /// How low the tool may go over a straight way at the feed, where it takes nothing; None beyond what is known.
    fn takes_nothing_over(&self, from: [f64; 2], to: [f64; 2]) -> Option<f64> {
        let (site, long) = (self.site, (to[0] - from[0]).hypot(to[1] - from[1]));
        let (cell, radius) = (site.grid.cell, site.tool.bare.radius_mm);
        let steps = (long / cell).ceil().max(1.0) as usize;
        let mut out = f64::NEG_INFINITY;
        for s in 0..=steps {
            let f = s as f64 / steps as f64;
            let (all, _) = site.grid.around([0, 1].map(|a| from[a] + (to[a] - from[a]) * f))?;
            for k in all {
                // Where only the material says how high the part is, it is known to its cells.
                let is_known = site.tip[k] < f64::INFINITY;
                let disc = if is_known { &self.under } else { &self.wide };
                let stands = self.columns.top_in(&site.grid, disc, k);
                out = out.max(stands).max(self.holder_stops(k)).max(self.part_stops(k));
            }
        }
        // Between nodes the part stands higher than at them by what a tool's radius bends over half a cell aslant.
        Some(out + cell * cell / (4.0 * radius))
    }

    /// How low the part, with what is to be left on it, lets the tip come over a node.
    fn part_stops(&self, k: usize) -> f64 {
        let tip = self.site.tip[k];
        if tip < f64::INFINITY { tip } else { f64::NEG_INFINITY }
    }

    /// Over to a place in rapid, and down to where something stands there.
    fn above(&self, at: [f64; 3], stands: f64) -> Flight {
        let (safe, approach) = (self.manner.safe, self.manner.links.approach_mm);
        let mut places = Vec::with_capacity(3);
        let high = match self.here() {
            Some(from) => {
                let clear = self.clear_over([from[0], from[1]], [at[0], at[1]]) + approach;
                let high = clear.max(at[2] + approach).max(from[2]).min(safe);
                places.push([from[0], from[1], high]);
                high
            }
            None => safe,
        };
        places.push([at[0], at[1], high]);
        places.push([at[0], at[1], (stands.max(at[2]) + approach).min(high)]);
        let rates = &self.manner.links.rates;
        let mut min = 0.0;
        let mut last = self.here().unwrap_or(places[0]);
        for p in &places {
            min += rates.rapid_min(Step { length_mm: apart(last, *p), turn_rad: 0.0 });
            last = *p;
        }
        Flight { places, min }
    }

    /// Time of a way from where the tool is at the feed of the air.
    fn air_min(&self, places: &[[f64; 3]]) -> f64 {
        let links = self.manner.links;
        let (mut min, mut last) = (0.0, self.here());
        for p in places {
            let step = Step { length_mm: last.map_or(0.0, |l| apart(l, *p)), turn_rad: 0.0 };
            min += links.rates.air_min(step, links.air_mm_min);
            last = Some(*p);
        }
        min
    }

    /// Over to above a place at the feed of the air, no higher than what stands between asks for.
    fn low_over(&self, at: [f64; 3]) -> Option<Flight> {
        let here = self.here()?;
        let least = self.takes_nothing_over([here[0], here[1]], [at[0], at[1]])?;
        let high = least.max(here[2]).max(at[2]);
        if high > self.manner.safe {
            return None;
        }
        let places = vec![[here[0], here[1], high], [at[0], at[1], high]];
        let min = self.air_min(&[places[0], places[1], at]);
        Some(Flight { places, min })
    }

    /// Comes to a place through the air or around what stands, down to it where nothing thicker than `thin` stands, else at the feed of
    /// plunges. `stands` is how low a rapid may go there.
    fn come_to(&mut self, at: [f64; 3], stands: f64, thin: f64) {
        let links = self.manner.links;
        let in_air = self.stands_at([at[0], at[1]]) <= at[2] + thin;
        let down = if in_air { links.air_mm_min } else { links.plunge_mm_min };
        let rapid = self.above(at, stands);
        let last = rapid.places.last().copied().unwrap_or(at);
        let mut least =
            rapid.min + links.rates.air_min(Step { length_mm: apart(last, at), turn_rad: 0.0 }, down);
        let mut way = None;
        if in_air {
            if let Some(low) = self.low_over(at).filter(|low| low.min < least) {
                (least, way) = (low.min, Some(low.places));
            }
            let around = self.around(at, thin, least * links.air_mm_min);
            let whole = |places: &Vec<[f64; 3]>| [&places[..], &[at]].concat();
            way = around.filter(|places| self.air_min(&whole(places)) < least).or(way);
        }
        match way {
            Some(places) => self.go_on(&places, None),
            None => rapid.places.into_iter().for_each(|p| self.rapid(p)),
        }
        if in_air { self.go_on(&[at], None) } else { self.go_down(&[at]) }
    }

    /// Over to a place where the tool has been, and down.
    pub(super) fn back_to(&mut self, at: [f64; 3], thin: f64) {
        self.come_to(at, at[2], thin);
    }

    /// Over to a place and straight down; through what stands there at the feed of plunges.
    pub(super) fn drop_to(&mut self, at: [f64; 3], thin: f64) {
        let stands = self.clear_over([at[0], at[1]], [at[0], at[1]]);
        self.come_to(at, stands, thin);
    }
}
