//! One layer: where the tool may be on it, where that takes something, and the lines that it goes along.

use super::super::course::Course;
use super::super::trace;
use super::contour::{self, Line};
use super::field;
use super::grid::{Disc, Grid};
use super::site::Site;

/// What is thinner than this share of the step down is not worth a move, ...
pub(super) const THIN: f64 = 0.02;
/// ... and on a slope beside the layer's floor this share of what may stand: there a wall is left in steps.
const STEPS: f64 = 0.5;
/// Halvings of the way between two nodes on which a wall is looked for: a 64th of it.
const HALVINGS: usize = 6;
/// A way is over the faces all along where it is but for this, of the tool's radius.
const NO_GAP: f64 = 1e-8;
/// Share of the chord tolerance that a line around keeps off the wall.
const OFF_WALL: f64 = 1.0;

/// A layer from one height down to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    pub ceiling: f64,
    pub floor: f64,
}

/// A line that the tool's tip goes along.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    pub places: Vec<[f64; 3]>,
    pub closed: bool,
    /// Of lines next to each other the lesser ones come first.
    pub order: f64,
    /// What stands less high above it is not worth a move, mm: on the layer's floor, and on slopes.
    pub thin: [f64; 2],
}

/// The nodes of a layer.
pub(super) struct Masks {
    /// Height of the tip where the tool may be; no number elsewhere.
    pub height: Vec<f64>,
    /// Whether the tool stands on the layer's floor there, or in air.
    pub flat: Vec<bool>,
    /// Whether it takes something that is to go.
    pub useful: Vec<bool>,
}

/// The greatest height at each node that has material between two heights, no higher than the upper one.
fn highest(site: &Site<'_>, ceiling: f64, least: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..site.grid.len())
        .map(|k| {
            let least = least(k);
            let spans = site.columns.of_node(k).iter().rev();
            let top = spans.filter(|[a, b]| *a < ceiling && *b > least).map(|[_, b]| b.min(ceiling)).next();
            top.filter(|t| *t > least).unwrap_or(f64::NEG_INFINITY)
        })
        .collect()
}

impl Layer {
    /// What is not worth a move on the floor, and on slopes that are left in steps, mm.
    pub fn thin(&self, stands_mm: f64) -> [f64; 2] {
        let deep = self.ceiling - self.floor;
        [THIN * deep, (STEPS * stands_mm).clamp(THIN * deep, 0.5 * deep)]
    }
}

impl Masks {
    /// The nodes of a layer, with what is not worth a move on its floor and on slopes.
    pub fn of(site: &Site<'_>, layer: Layer, [thin, slope]: [f64; 2]) -> Self {
        let Layer { ceiling, floor } = layer;
        let over = |least: &dyn Fn(usize) -> f64| {
            let heights = highest(site, ceiling, least);
            if site.tool.bare.is_flat() {
                site.grid.highest(&heights, &site.disc)
            } else {
                site.grid.raised(&heights, site.tool.bare.radius_mm, |rho| site.tool.bare.lift_mm(rho))
            }
        };
        let wanted = over(&|k| site.least[k].max(floor) + thin);
        let height: Vec<f64> = (0..site.grid.len())
            .map(|k| {
                let height = site.tip[k].max(floor);
                // No number compares as less.
                if site.tip[k] < ceiling - thin && site.holder[k] <= height { height } else { f64::NAN }
            })
            .collect();
        let flat = (0..height.len()).map(|k| height[k] == floor).collect();
        let takes = |over: &[f64], k: usize, by: f64| over[k] > height[k] + by;
        let useful = (0..height.len())
            .map(|k| takes(&wanted, k, if height[k] == floor || site.shallow[k] { thin } else { slope }))
            .collect();
        Self { height, flat, useful }
    }

    /// Parts of what is useful that hang together, over gaps of no more than `apart_mm`; the parts' number for each node.
    pub fn parts(&self, grid: &Grid, apart_mm: f64) -> (Vec<u32>, usize) {
        let own: Vec<f64> = self.useful.iter().map(|u| if *u { 1.0 } else { 0.0 }).collect();
        let near = grid.highest(&own, &Disc::new(0.5 * apart_mm, grid.cell));
        let inside: Vec<bool> = near.iter().zip(&self.height).map(|(n, h)| *n > 0.0 && !h.is_nan()).collect();
        grid.parts(&inside)
    }
}

/// How far nodes lie from the walls of a layer, with the lines along these.
pub(super) struct Walls {
    pub lines: Vec<Line>,
    /// Distance from the nearest wall, mm: positive where the tool stands on the floor; no number where it may not be.
    pub depth: Vec<f64>,
}

impl Walls {
    pub fn of(site: &Site<'_>, layer: Layer, masks: &Masks, chord_mm: f64) -> Self {
        let grid = &site.grid;
        // Parts without a floor have their own border.
        let free: Vec<bool> = masks.height.iter().map(|h| !h.is_nan()).collect();
        let (part, count) = grid.parts(&free);
        let mut has_floor = vec![false; count];
        for k in (0..grid.len()).filter(|k| masks.flat[*k]) {
            if let Some(has) = has_floor.get_mut(part[k] as usize) {
                *has = true;
            }
        }
        let on_slope = |k: usize| has_floor.get(part[k] as usize).is_some_and(|has| !has);
        let inside = |k: usize| (!site.tip[k].is_nan()).then(|| masks.flat[k] || on_slope(k));
        let lines = contour::lines(grid, inside, |a, b| {
            let level = if masks.flat[a] { layer.floor } else { layer.ceiling };
            let (p, q) = (grid.at(a), grid.at(b));
            let at = |f: f64| [0, 1].map(|k| p[k] + (q[k] - p[k]) * f);
            // The holder, and what is not to go, are known at nodes.
            let by_faces = site.tip[b] > level && site.tip[b].is_finite();
            let (mut lo, mut hi) = (0.0, if by_faces { 1.0 } else { 0.25 });
            for _ in 0..if by_faces { HALVINGS } else { 0 } {
                let middle = 0.5 * (lo + hi);
                if site.rests(at(middle)) <= level { lo = middle } else { hi = middle }
            }
            at((lo - OFF_WALL * chord_mm / grid.cell).max(0.0))
        });
        let away = field::distances(grid, &lines);
        let depth = (0..grid.len())
            .map(|k| match () {
                () if !free[k] => f64::NAN,
                () if masks.flat[k] || on_slope(k) => away[k],
                () => -away[k],
            })
            .collect();
        Self { lines, depth }
    }
}

/// A layer with everything that is known of it.
pub(super) struct Sheet {
    pub layer: Layer,
    pub masks: Masks,
    pub walls: Walls,
}

/// A line at the height of a layer, or on the faces where these are higher. One along a wall may be on the floor with a node beside it that
/// is not; others are there where all nodes around are.
pub(super) fn lifted(
    site: &Site<'_>,
    layer: Layer,
    masks: &Masks,
    (line, at_wall): (&Line, bool),
) -> Vec<[f64; 3]> {
    let next_to_floor = |p: &[f64; 2]| {
        let flat = |k: &usize| masks.flat[*k];
        let all = site.grid.around(*p);
        all.is_some_and(|(all, _)| {
            all.iter().all(flat) || (at_wall && all.iter().any(flat) && site.rests(*p) <= layer.floor)
        })
    };
    let on_floor: Vec<bool> = line.points.iter().map(next_to_floor).collect();
    let mut out: Vec<[f64; 3]> = Vec::with_capacity(line.points.len());
    let mut k = 0;
    while k < line.points.len() {
        let p = line.points[k];
        if on_floor[k] {
            out.push([p[0], p[1], layer.floor]);
            k += 1;
            continue;
        }
        // From the last place on the floor to the next one the faces say how high it goes.
        let end = (k..line.points.len()).find(|j| on_floor[*j]).unwrap_or(line.points.len());
        let from = k.saturating_sub(1);
        out.extend(along_faces(site, layer.floor, &line.points[from..(end + 1).min(line.points.len())]));
        k = end;
    }
    out
}

/// A way over the faces, no lower than a floor: exact to the chord tolerance. Where nothing is below the tool it goes on along the way's own
/// places, on the floor.
pub(super) fn along_faces(site: &Site<'_>, floor: f64, way: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let Some(course) = Course::through(way.iter().copied()) else {
        return way.iter().map(|p| [p[0], p[1], site.rests(*p).max(floor)]).collect();
    };
    let frame = &site.ground.frame;
    let mut out: Vec<[f64; 3]> = Vec::new();
    let on_floor = |[x, y]: [f64; 2]| [x, y, floor];
    let whole = course.lengths().last().copied().unwrap_or_default();
    // Where runs begin is known to this.
    let none = NO_GAP * site.tool.bare.radius_mm;
    let mut last = 0.0;
    for (run, [from, to]) in trace::runs(site.ground, &course) {
        if from - last > none {
            // Up to where something is below the tool nothing is.
            out.push(on_floor(course.at(last)));
            out.extend(course.nodes_between([last, from]).iter().copied().map(on_floor));
            out.push(on_floor(course.at(from)));
        }
        let places = run.points.iter().map(|p| frame.of(&p.pose.tip));
        out.extend(places.map(|[x, y, z]| [x, y, (z + site.tool.allowance_mm).max(floor)]));
        last = to;
    }
    if whole - last > none {
        out.push(on_floor(course.at(last)));
        out.extend(course.nodes_between([last, whole]).iter().copied().map(on_floor));
        out.push(on_floor(course.at(whole)));
    }
    out
}
