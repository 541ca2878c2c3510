//! Straight ways between two places on a layer, over the faces where these are higher.
//!
//! Where such a way goes is asked of the faces once: it is the same whatever stands there, and many trials ask for it.

use super::layer::{Sheet, along_faces};
use super::moves::Moves;
use super::site::Site;

/// A way that rises more than so many nodes' distances from one node to the next goes up a wall.
const WALL: f64 = 3.0;

impl Sheet {
    /// Whether the tool may be next to a place: a line along a wall lies between nodes where it may and such where it may not.
    pub(super) fn lets(&self, site: &Site<'_>, at: [f64; 2]) -> bool {
        let around = site.grid.around(at);
        around.is_some_and(|(all, _)| all.iter().any(|k| !self.masks.height[*k].is_nan()))
    }

    /// The straight way between two places without its end; None where the tool may not be, and up walls.
    fn straight(&self, site: &Site<'_>, [from, to]: [[f64; 2]; 2]) -> Option<Vec<[f64; 3]>> {
        let floor = self.layer.floor;
        let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) / site.grid.cell).ceil().max(1.0) as usize;
        let (mut flat, mut last) = (true, None::<f64>);
        for s in 0..=steps {
            let p = [0, 1].map(|k| from[k] + (to[k] - from[k]) * s as f64 / steps as f64);
            let (all, _) = site.grid.around(p)?;
            flat &= all.iter().all(|k| self.masks.flat[*k]);
            if !self.lets(site, p) {
                return None;
            }
            // What the nodes next to it say rules most walls out.
            let height = site.grid.near(p).map(|k| self.masks.height[k]).filter(|h| !h.is_nan());
            if let (Some(a), Some(b)) = (last, height)
                && (b - a).abs() > WALL * site.grid.cell
            {
                return None;
            }
            last = height;
        }
        if flat {
            return Some(Vec::new());
        }
        let way = along_faces(site, floor, &[from, to]);
        let steep = way.windows(2).any(|w| {
            let across = (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
            (w[1][2] - w[0][2]).abs() > site.grid.cell.max(across)
        });
        let high = way.iter().any(|p| p[2] >= self.layer.ceiling);
        (!steep && !high).then_some(way)
    }
}

impl Moves<'_> {
    /// The straight way between two places on a layer, on the faces where these are higher; None where the tool may not be, up walls, and
    /// down into material.
    pub(super) fn straight(&self, sheet: &Sheet, from: [f64; 3], to: [f64; 3]) -> Option<Vec<[f64; 3]>> {
        let key = [sheet.layer.floor, from[0], from[1], to[0], to[1]].map(f64::to_bits);
        let ends = [from, to].map(|p| [p[0], p[1]]);
        let mut way = self.site.straights.of(key, || sheet.straight(self.site, ends))?;
        way.push(to);
        let all: Vec<[f64; 3]> = std::iter::once(from).chain(way.iter().copied()).collect();
        let dives = all.windows(2).any(|w| self.dives(sheet, [w[0], w[1]]));
        (!dives).then_some(way)
    }
}
