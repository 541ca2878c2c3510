//! How the tool comes into the material: from the air beside it, by a helix, down a ramp along the line, or straight down.

use super::grid::Disc;
use super::layer::Sheet;
use super::moves::{Moves, apart};
use super::task::Entry;
use std::f64::consts::TAU;

/// Corners of a turn of a helix.
const CORNERS: usize = 24;
/// Radius of a helix, of the tool's: more would leave a core.
const HELIX: f64 = 0.9;
/// A helix of a lesser radius than this, of the tool's, drills.
const LEAST_HELIX: f64 = 0.25;
/// No more places for a helix are tried.
const MOST_WIDE: usize = 6;
/// Air is looked for so far around a place, in radii of the tool.
const AROUND: f64 = 4.0;
/// Places in the air that are tried are so far apart, in its radii; ...
const AIR_APART: f64 = 0.5;
/// ... and no more than these.
const MOST_AIR: usize = 24;
/// The tool comes down where it has been, so far from a start, in its radii; ...
const BEEN: f64 = 2.5;
/// ... no more of such places are tried.
const MOST_BEEN: usize = 12;
/// A ramp uses no more of a line than this, in radii of the tool: longer ways to and fro clear less than the line does.
const LONG_RAMP: f64 = 12.0;
/// The way down into material goes slower from so far above it on, of the approach distance, and no less than it is known to.
const TOUCH: f64 = 0.125;
/// Most times that a ramp goes to and fro.
const MOST_TURNS: f64 = 40.0;

impl Moves<'_> {
    /// Comes to the start of a line from elsewhere; false, without a move, where no way in fits.
    pub(super) fn come_in(&mut self, sheet: &Sheet, stations: &[[f64; 3]]) -> bool {
        let Some(start) = stations.first().copied() else { return false };
        let thin = self.thin(sheet);
        let stands = self.stands_at([start[0], start[1]]);
        if stands <= start[2] + thin {
            self.drop_to(start, thin);
            return true;
        }
        // Where the tool has been it comes down, and from there it goes on through the layer.
        let been = self.been_near(start, sheet.layer.floor);
        let led = been.into_iter().find_map(|from| Some((from, self.straight(sheet, from, start)?)));
        if let Some((from, way)) = led {
            self.back_to(from, thin);
            self.go_on(&way, None);
            return true;
        }
        if let Some(air) = self.air_near(sheet, start) {
            self.drop_to(air, thin);
            if let Some(way) = self.straight(sheet, air, start) {
                self.go_on(&way, None);
                return true;
            }
        }
        match self.manner.entry {
            Entry::Outside => false,
            Entry::Helix => self.helix(sheet, start),
            Entry::Ramp => self.ramp(stations, stands),
            Entry::Auto => {
                self.helix(sheet, start) || self.ramp(stations, stands) || self.plunge(start, thin)
            }
        }
    }

    /// Whether the tool gets to a place on its layer from what is cleared.
    pub(super) fn gets_to(&self, sheet: &Sheet, at: [f64; 3]) -> bool {
        self.stands_at([at[0], at[1]]) <= at[2] + self.thin(sheet)
            || self
                .been_near(at, sheet.layer.floor)
                .into_iter()
                .any(|p| self.straight(sheet, p, at).is_some())
            || self.air_near(sheet, at).is_some()
    }

    /// Straight down; false where the tool may not.
    fn plunge(&mut self, start: [f64; 3], thin: f64) -> bool {
        if self.manner.plunges {
            self.drop_to(start, thin);
        }
        self.manner.plunges
    }

    /// How far above material the way down into it goes slower.
    fn touch_mm(&self) -> f64 {
        (TOUCH * self.manner.links.approach_mm).max(self.site.blur_mm)
    }

    fn thin(&self, sheet: &Sheet) -> f64 {
        super::layer::THIN * (sheet.layer.ceiling - sheet.layer.floor)
    }

    /// The upper end of what stands under the tool at a place.
    pub(super) fn stands_at(&self, at: [f64; 2]) -> f64 {
        let k = self.site.grid.near(at);
        k.map_or(f64::NEG_INFINITY, |k| self.columns.top_in(&self.site.grid, &self.under, k))
    }

    /// Places near one on a layer where the tool has been so low, or at the floor over those where it was lower; the nearest first.
    fn been_near(&self, start: [f64; 3], floor: f64) -> Vec<[f64; 3]> {
        let (site, near_mm) = (self.site, BEEN * self.site.tool.bare.radius_mm);
        let Some(k) = site.grid.near([start[0], start[1]]) else { return Vec::new() };
        let away = |p: &[f64; 3]| (p[0] - start[0]).hypot(p[1] - start[1]);
        let disc = Disc::new(near_mm, site.grid.cell);
        let all = site.grid.disc(&disc, k).flatten().filter_map(|m| self.been.of_node(m));
        let mut found: Vec<[f64; 3]> =
            all.map(|p| [p[0], p[1], p[2].max(floor)]).filter(|p| p[2] <= start[2]).collect();
        found.sort_by(|a, b| away(a).total_cmp(&away(b)));
        found.truncate(MOST_BEEN);
        found
    }

    /// The nearest place from which the tool comes to a start on its layer, and where it takes nothing on the way down.
    fn air_near(&self, sheet: &Sheet, start: [f64; 3]) -> Option<[f64; 3]> {
        let (site, floor) = (self.site, sheet.layer.floor);
        let k = site.grid.near([start[0], start[1]])?;
        let near = Disc::new(AROUND * site.tool.bare.radius_mm, site.grid.cell);
        let away = |m: usize| {
            let p = site.grid.at(m);
            (p[0] - start[0]).hypot(p[1] - start[1])
        };
        let mut free: Vec<usize> =
            site.grid.disc(&near, k).flatten().filter(|m| sheet.masks.flat[*m]).collect();
        free.sort_by(|a, b| away(*a).total_cmp(&away(*b)).then(a.cmp(b)));
        let is_air = |m: &usize| {
            self.columns.top_in(&site.grid, &self.under, *m) <= floor + self.thin(sheet)
                && self.holder_lets(*m, floor)
        };
        let place = |m: usize| {
            let p = site.grid.at(m);
            [p[0], p[1], floor]
        };
        // Where one place is shut off those next to it are as a rule.
        let mut shut: Vec<[f64; 3]> = Vec::with_capacity(MOST_AIR);
        for p in free.into_iter().filter(is_air).map(place) {
            let is_near = |q: &[f64; 3]| apart(*q, p) < AIR_APART * site.tool.bare.radius_mm;
            if shut.iter().any(is_near) {
                continue;
            }
            if self.straight(sheet, p, start).is_some() {
                return Some(p);
            }
            shut.push(p);
            if shut.len() == MOST_AIR {
                break;
            }
        }
        None
    }

    /// Down a helix near a place and on to it through the layer; false where none fits. The nearest wide place is taken.
    fn helix(&mut self, sheet: &Sheet, at: [f64; 3]) -> bool {
        let (site, floor) = (self.site, sheet.layer.floor);
        let Some(k) = site.grid.near([at[0], at[1]]) else { return false };
        let (most, least) = (HELIX * site.tool.bare.radius_mm, LEAST_HELIX * site.tool.bare.radius_mm);
        let near = Disc::new(AROUND * site.tool.bare.radius_mm, site.grid.cell);
        // How far off the walls a place lies; none where the tool may not be.
        let depth = |m: usize| sheet.walls.depth[m];
        let place = |m: usize| {
            let p = site.grid.at(m);
            [p[0], p[1], floor]
        };
        let away = |m: &usize| (place(*m)[0] - at[0]).hypot(place(*m)[1] - at[1]);
        let mut wide: Vec<usize> = site
            .grid
            .disc(&near, k)
            .flatten()
            .filter(|m| sheet.masks.flat[*m] && depth(*m) >= least)
            .collect();
        wide.sort_by(|a, b| {
            let short = |m: usize| (most - depth(m)).max(0.0);
            short(*a).total_cmp(&short(*b)).then(away(a).total_cmp(&away(b))).then(a.cmp(b))
        });
        wide.truncate(MOST_WIDE);
        for m in wide {
            let centre = place(m);
            let Some(way) = self.straight(sheet, centre, at) else { continue };
            if self.spiral(centre, depth(m).min(most)) {
                self.go_on(&way, None);
                return true;
            }
        }
        false
    }

    /// The turns of a helix down to a place; false where it would go below the faces.
    fn spiral(&mut self, at: [f64; 3], radius: f64) -> bool {
        let corner = |k: usize, z: f64| {
            let (s, c) = (TAU * k as f64 / CORNERS as f64).sin_cos();
            [at[0] + radius * c, at[1] + radius * s, z]
        };
        let near = |p: [f64; 3]| self.site.grid.near([p[0], p[1]]);
        let free = (0..CORNERS).map(|k| corner(k, at[2])).chain([at]).all(|p| {
            self.site.rests([p[0], p[1]]) <= at[2] && near(p).is_some_and(|k| self.holder_lets(k, at[2]))
        });
        if !free {
            return false;
        }
        let stands = (0..CORNERS).map(|k| corner(k, 0.0)).map(|p| self.stands_at([p[0], p[1]]));
        let top = stands.fold(self.stands_at([at[0], at[1]]), f64::max).max(at[2]);
        let pitch = TAU * radius * self.manner.sizes.ramp_rad.tan();
        let steps = ((top - at[2]) / pitch * CORNERS as f64).ceil() as usize;
        self.drop_to(corner(0, top + self.touch_mm()), 0.0);
        let down = (0..=steps).map(|k| corner(k, top + (at[2] - top) * k as f64 / steps.max(1) as f64));
        // Once more around, on the floor.
        let last = (1..=CORNERS).map(|k| corner(steps + k, at[2]));
        let way: Vec<[f64; 3]> = down.chain(last).chain([at]).collect();
        self.go_down(&way);
        true
    }

    /// Down a ramp to and fro along a line; false where the line is too short for it.
    fn ramp(&mut self, stations: &[[f64; 3]], stands: f64) -> bool {
        let most = LONG_RAMP * self.site.tool.bare.radius_mm;
        let mut along = vec![0.0];
        for w in stations.windows(2) {
            let step = (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
            along.push(along[along.len() - 1] + step);
        }
        // As far as the line lies lower than what stands.
        let count = along.iter().zip(stations).take_while(|(s, p)| **s <= most && p[2] < stands).count();
        let Some(long) = count.checked_sub(1).map(|k| along[k]).filter(|s| *s > 0.0) else { return false };
        let (start, drop) = (stations[0], stands - stations[0][2]);
        // To and fro: twice the way for each turn.
        let whole = drop / self.manner.sizes.ramp_rad.tan();
        let turns = (0.5 * whole / long).ceil().max(1.0);
        if turns.is_nan() || turns > MOST_TURNS {
            return false;
        }
        let far = (0.5 * whole / turns).min(long);
        self.drop_to([start[0], start[1], stands + self.touch_mm()], 0.0);
        let ends = along.iter().take_while(|s| **s < far).count();
        let Some(tip) = stations.get(ends) else { return false };
        let (a, b) = (along[ends - 1], along[ends.min(along.len() - 1)]);
        let f = if b > a { (far - a) / (b - a) } else { 0.0 };
        let last = [0, 1, 2].map(|k| stations[ends - 1][k] + (tip[k] - stations[ends - 1][k]) * f);
        let out: Vec<(f64, [f64; 3])> =
            along[..ends].iter().copied().zip(stations.iter().copied()).chain([(far, last)]).collect();
        let mut way = vec![[start[0], start[1], stands]];
        for turn in 0..turns as usize {
            let height = |gone: f64| stands - drop * gone / (2.0 * turns * far);
            let base = 2.0 * turn as f64 * far;
            way.extend(out.iter().map(|(s, p)| [p[0], p[1], height(base + s).max(p[2])]));
            way.extend(out.iter().rev().map(|(s, p)| [p[0], p[1], height(base + 2.0 * far - s).max(p[2])]));
        }
        self.go_down(&way);
        true
    }
}
