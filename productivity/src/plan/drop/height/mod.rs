//! How low a tool with a fixed axis can stand at a place: the drop of a cutter onto surfaces, not onto triangles.
//!
//! Over a place c of the plane across the axis the tip may come down to `max F`, `F(u, v) = z(u, v) - g(rho(u, v))`: the
//! height of the surface less the height of the cutter's lower side over its tip at that distance from its axis.
//! Samples of the faces find the neighbourhoods of the maximum; there F is climbed with exact derivatives, so that the
//! answer is that of the surface. What lies lower than the samples and narrower than their spacing is not seen.

use super::circle::{Circle, highest};
use super::frame::Frame;
use osculate_geom::{Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_tools::{Cutter, Line, Pose};
use std::ops::Range;

/// Samples to a bin side: a bin holds few, and a cutter's disc covers many bins.
const BINS_PER_RADIUS: f64 = 4.0;
/// Bins along one side, at most.
const MOST_BINS: usize = 4096;
/// Bins along one side of a block: a disc covers few blocks, and most of them are seen to be lower as a whole.
const BLOCK: usize = 4;
/// Places from which a climb starts, at most.
const CLIMBS: usize = 4;
/// The highest of the seeds around a top is nearer to it than this many of their distances: half their diagonal, and as much
/// again for parts that are hollow below a flat end.
const NEAR: f64 = 1.5;
/// Steps of one climb.
const STEPS: usize = 16;
/// Entries of the table of the cutter's lower side.
const TABLE: usize = 512;
/// From this entry on the side rises too steeply for a table, which is off by 1.2e-5 radii of a ball there.
const STEEP: usize = TABLE * 15 / 16;

/// A place of a face that the tool may rest on.
#[derive(Clone, Copy)]
pub(super) struct Seed {
    /// Position in the frame: along the feed, across it, height.
    pub at: [f64; 3],
    pub uv: Uv,
    pub face: u32,
    /// On a rim, the way to the next seed on it, all of which the tool may rest on; zero elsewhere.
    pub along: [f64; 3],
}

impl Seed {
    /// The place of a rim's piece that is nearest to the axis over `c`: where a side that rises steeply is met.
    fn nearest(&self, c: [f64; 2]) -> [f64; 3] {
        let d = self.along;
        let long = d[0] * d[0] + d[1] * d[1];
        if long == 0.0 {
            return self.at;
        }
        let t = ((c[0] - self.at[0]) * d[0] + (c[1] - self.at[1]) * d[1]) / long;
        let t = t.clamp(0.0, 1.0);
        [0, 1, 2].map(|k| self.at[k] + t * d[k])
    }

    /// The place of a rim's piece that is nearest to a point.
    pub(super) fn nearest_of(&self, p: [f64; 3]) -> [f64; 3] {
        let (from, d) = (Vec3::from(self.at), Vec3::from(self.along));
        let long = d.norm_squared();
        let t = if long > 0.0 { (d.dot(&(Vec3::from(p) - from)) / long).clamp(0.0, 1.0) } else { 0.0 };
        (from + d * t).into()
    }

    fn is_rim(&self) -> bool {
        self.along != [0.0; 3]
    }
}

/// The way from one seed to another.
pub(super) fn way(a: &Seed, b: &Seed) -> [f64; 3] {
    [0, 1, 2].map(|i| b.at[i] - a.at[i])
}

/// Where the tool rests.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// Height of the tip along the axis, mm.
    pub tip: f64,
    pub uv: Uv,
    pub face: u32,
    pub point: Point3,
}

/// Faces ready to drop a cutter on.
pub(super) struct Drops<'a> {
    surfaces: &'a [&'a dyn Surface],
    cutter: &'a Cutter,
    frame: Frame,
    seeds: Vec<Seed>,
    /// Seeds of bin k are `seeds[first[k]..first[k + 1]]`.
    first: Vec<u32>,
    /// Highest place of the seeds of each bin, and how far pieces of rims that begin in it reach.
    top: Vec<[f64; 2]>,
    /// The same of blocks of bins.
    top_of_blocks: Vec<[f64; 2]>,
    lo: [f64; 2],
    cell: f64,
    n: [usize; 2],
    /// Height of the lower side over the tip at `k / TABLE` radii.
    lower: Vec<f64>,
    spacing: f64,
}

/// Height of the cutter's lower side at a place beside its axis, and its slopes in the plane; None outside its radius.
fn lower_side(cutter: &Cutter, dx: f64, dy: f64) -> Option<(f64, [f64; 2])> {
    if cutter.is_end_mill() {
        let (rho, corner) = ((dx * dx + dy * dy).sqrt(), cutter.corner_mm());
        if rho > cutter.radius_mm() {
            return None;
        }
        let x = rho - cutter.core_mm();
        if x <= 0.0 || corner == 0.0 {
            return Some((0.0, [0.0; 2]));
        }
        // Height of the corner's centre over the side; none is left at the wall.
        let y = (corner * corner - x * x).max(0.0).sqrt();
        let slope = x / (y * rho);
        return (y > 0.0).then(|| (x * x / (corner + y), [slope * dx, slope * dy]));
    }
    let axis = Vec3::z_axis();
    let pose = Pose { tip: Point3::origin(), axis };
    let entry = cutter.entry(&pose, &Line { origin: Point3::new(dx, dy, 0.0), direction: axis })?;
    let normal = cutter.normal_at(&pose, &Point3::new(dx, dy, entry.at_mm), entry.part);
    // The side of a cylinder has no height over the tip: its contact is a wall.
    (normal.z < 0.0).then(|| (entry.at_mm, [-normal.x / normal.z, -normal.y / normal.z]))
}

/// A range of bins parted where blocks begin.
fn in_blocks(bins: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    (bins.start / BLOCK..bins.end.div_ceil(BLOCK))
        .map(move |b| (b * BLOCK).max(bins.start)..((b + 1) * BLOCK).min(bins.end))
}

impl<'a> Drops<'a> {
    /// Sorts seeds into bins. `spacing_mm` is how far seeds stand apart.
    pub(super) fn new(
        surfaces: &'a [&'a dyn Surface],
        cutter: &'a Cutter,
        frame: Frame,
        seeds: Vec<Seed>,
        spacing_mm: f64,
    ) -> Self {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for s in &seeds {
            for k in 0..2 {
                lo[k] = lo[k].min(s.at[k]);
                hi[k] = hi[k].max(s.at[k]);
            }
        }
        let extent = [hi[0] - lo[0], hi[1] - lo[1]];
        let cell = (cutter.radius_mm() / BINS_PER_RADIUS)
            .max(spacing_mm)
            .max(extent[0].max(extent[1]) / MOST_BINS as f64);
        let n = extent.map(|e| ((e.max(0.0) / cell) as usize + 1).min(MOST_BINS + 1));
        let bin = |s: &Seed| {
            let k = |i: usize| (((s.at[i] - lo[i]) / cell) as usize).min(n[i] - 1);
            k(1) * n[0] + k(0)
        };
        let mut first = vec![0_u32; n[0] * n[1] + 1];
        for s in &seeds {
            first[bin(s) + 1] += 1;
        }
        for k in 1..first.len() {
            first[k] += first[k - 1];
        }
        let mut top = vec![[f64::NEG_INFINITY, 0.0]; n[0] * n[1]];
        for s in &seeds {
            let [high, long] = &mut top[bin(s)];
            *high = high.max(s.at[2]).max(s.at[2] + s.along[2]);
            *long = long.max(s.along[0].hypot(s.along[1]));
        }
        let across = n[0].div_ceil(BLOCK);
        let mut top_of_blocks = vec![[f64::NEG_INFINITY, 0.0]; across * n[1].div_ceil(BLOCK)];
        for (k, [high, long]) in top.iter().enumerate() {
            let block = &mut top_of_blocks[k / n[0] / BLOCK * across + k % n[0] / BLOCK];
            *block = [block[0].max(*high), block[1].max(*long)];
        }
        let mut next = first.clone();
        let mut order = vec![0_u32; seeds.len()];
        for (k, s) in (0_u32..).zip(&seeds) {
            let b = bin(s);
            order[next[b] as usize] = k;
            next[b] += 1;
        }
        let seeds = order.iter().map(|k| seeds[*k as usize]).collect();
        let radius = cutter.radius_mm();
        let lower = (0..=TABLE)
            .map(|k| lower_side(cutter, radius * k as f64 / TABLE as f64, 0.0).map_or(f64::INFINITY, |l| l.0))
            .collect();
        Self {
            surfaces,
            cutter,
            frame,
            seeds,
            first,
            top,
            top_of_blocks,
            lo,
            cell,
            n,
            lower,
            spacing: spacing_mm,
        }
    }

    /// Bins along one side that a disc around `x` touches.
    fn bins(&self, side: usize, x: f64) -> Range<usize> {
        let radius = self.cutter.radius_mm();
        let k = |t: f64| ((t - self.lo[side]) / self.cell).floor();
        let last = k(x + radius);
        if last < 0.0 {
            return 0..0;
        }
        // Negative values saturate at zero.
        (k(x - radius) as usize).min(self.n[side])..(last as usize + 1).min(self.n[side])
    }

    /// Height that a seed holds the tip at, by the table where that is near enough.
    fn held(&self, s: &Seed, c: [f64; 2]) -> f64 {
        let radius = self.cutter.radius_mm();
        let at = s.nearest(c);
        let (dx, dy) = (at[0] - c[0], at[1] - c[1]);
        let q = (dx * dx + dy * dy).sqrt() / radius * TABLE as f64;
        if q >= TABLE as f64 {
            return f64::NEG_INFINITY;
        }
        let k = q as usize;
        if k >= STEEP {
            return lower_side(self.cutter, dx, dy).map_or(f64::NEG_INFINITY, |(g, _)| at[2] - g);
        }
        let f = q - k as f64;
        let (a, b) = (self.lower[k], self.lower[k + 1]);
        at[2] - (a + (b - a) * f)
    }

    /// Height that a piece of a rim holds the tip at. Pieces beside each other differ by less than the table knows of a side that is as
    /// good as upright.
    fn held_by_rim(&self, s: &Seed, c: [f64; 2]) -> f64 {
        let at = s.nearest(c);
        let side = lower_side(self.cutter, at[0] - c[0], at[1] - c[1]);
        side.map_or(f64::NEG_INFINITY, |(g, _)| at[2] - g)
    }

    /// Whether any seed holds the tip over `c` above a height; between seeds it may be held higher.
    pub(super) fn is_above(&self, c: [f64; 2], height: f64) -> bool {
        let (mut floor, mut above) = (height, false);
        self.each(c, &mut floor, |s, floor| {
            if !above && self.held(s, c) > height {
                // Nothing else needs to be looked at.
                (above, *floor) = (true, f64::INFINITY);
            }
        });
        above
    }

    /// The highest that the seeds of the bin at `c` hold the tip there. What stands below the axis is as a rule near the highest,
    /// and most other bins are then seen to be lower.
    fn below_axis(&self, c: [f64; 2]) -> f64 {
        let [Some(i), Some(j)] = [0, 1].map(|k| self.own_bin(k, c[k])) else { return f64::NEG_INFINITY };
        self.of_row(j, i..i + 1).iter().map(|s| self.held(s, c)).fold(f64::NEG_INFINITY, f64::max)
    }

    fn own_bin(&self, side: usize, x: f64) -> Option<usize> {
        let k = ((x - self.lo[side]) / self.cell).floor();
        // A number of bins fits.
        (k >= 0.0 && k < self.n[side] as f64).then_some(k as usize)
    }

    /// The seeds of neighbouring bins of a row.
    fn of_row(&self, j: usize, across: Range<usize>) -> &[Seed] {
        let row = j * self.n[0];
        &self.seeds[self.first[row + across.start] as usize..self.first[row + across.end] as usize]
    }

    /// How far bins lie beside `x`.
    fn beside(&self, side: usize, bins: &Range<usize>, x: f64) -> f64 {
        let [from, to] = [bins.start, bins.end].map(|k| self.lo[side] + k as f64 * self.cell);
        (from - x).max(x - to).max(0.0)
    }

    /// No seed of bins so far away, with this top, holds the tip higher than this.
    fn at_most(&self, [high, long]: [f64; 2], [dx, dy]: [f64; 2]) -> f64 {
        let near = ((dx * dx + dy * dy).sqrt() - long).max(0.0);
        let q = (near / self.cutter.radius_mm() * TABLE as f64) as usize;
        high - self.lower.get(q).copied().unwrap_or(f64::INFINITY)
    }

    /// Every seed that may hold the tip over `c` higher than `floor`, which may rise on the way.
    fn each<'s>(&'s self, c: [f64; 2], floor: &mut f64, mut f: impl FnMut(&'s Seed, &mut f64)) {
        let (across, rows) = (self.bins(0, c[0]), self.bins(1, c[1]));
        let blocks = self.n[0].div_ceil(BLOCK);
        for rows in in_blocks(rows) {
            let dy = self.beside(1, &rows, c[1]);
            for bins in in_blocks(across.clone()) {
                let top = self.top_of_blocks[rows.start / BLOCK * blocks + bins.start / BLOCK];
                if self.at_most(top, [self.beside(0, &bins, c[0]), dy]) < *floor {
                    continue;
                }
                for j in rows.clone() {
                    let dy = self.beside(1, &(j..j + 1), c[1]);
                    for i in bins.clone() {
                        let top = self.top[j * self.n[0] + i];
                        if self.at_most(top, [self.beside(0, &(i..i + 1), c[0]), dy]) >= *floor {
                            self.of_row(j, i..i + 1).iter().for_each(|s| f(s, floor));
                        }
                    }
                }
            }
        }
    }

    /// Where the tool rests over `c`; None where nothing is below it.
    pub(super) fn rest(&self, c: [f64; 2]) -> Option<Rest> {
        // Places that may still win once climbed: within what a seed can be off by half its spacing up a slope of one.
        let slack = self.spacing;
        let mut best = self.below_axis(c);
        let mut near: Vec<(f64, &Seed)> = Vec::with_capacity(128);
        self.each(c, &mut (best - slack), |s, least| {
            let h = if s.is_rim() { self.held_by_rim(s, c) } else { self.held(s, c) };
            if h >= *least && h > f64::NEG_INFINITY {
                near.push((h, s));
                best = best.max(h);
                *least = best - slack;
            }
        });
        near.retain(|(h, _)| *h >= best - slack);
        let mut won: Option<Rest> = None;
        for _ in 0..CLIMBS {
            // The first of the highest.
            let highest = near.iter().copied().reduce(|a, b| if b.0 > a.0 { b } else { a });
            let Some((_, s)) = highest else { break };
            let beaten = won.map_or(f64::NEG_INFINITY, |w| w.tip);
            let rest = if s.is_rim() { self.on_rim(s, c) } else { self.climb(s, c, beaten) };
            if let Some(rest) = rest
                && won.is_none_or(|w| rest.tip >= w.tip)
            {
                won = Some(rest);
            }
            // A rim may hold the tool where the face beside it does not.
            near.retain(|(_, o)| {
                o.face != s.face
                    || o.is_rim() != s.is_rim()
                    || (o.at[0] - s.at[0]).powi(2) + (o.at[1] - s.at[1]).powi(2)
                        > (4.0 * self.spacing).powi(2)
            });
        }
        won
    }

    /// The tool on the nearest place of a rim's piece, or higher up on the face beside it.
    fn on_rim(&self, s: &Seed, c: [f64; 2]) -> Option<Rest> {
        let at = s.nearest(c);
        let inside = self.climb(s, c, f64::NEG_INFINITY)?;
        Some(match lower_side(self.cutter, at[0] - c[0], at[1] - c[1]) {
            Some((g, _)) if at[2] - g > inside.tip => {
                Rest { tip: at[2] - g, point: self.frame.point(at), ..inside }
            }
            _ => inside,
        })
    }

    /// F and its gradient along S_u and S_v at a place of a face.
    fn value(&self, face: u32, at: Uv, c: [f64; 2]) -> Option<(f64, [f64; 2], [f64; 2])> {
        let surface = self.surfaces[face as usize];
        let jet = surface.jet2(at);
        let [x, y, z] = self.frame.of(&jet.point);
        let (g, slope) = lower_side(self.cutter, x - c[0], y - c[1])?;
        let along = |d: &Vec3| {
            let [dx, dy, dz] = self.frame.along(d);
            dz - slope[0] * dx - slope[1] * dy
        };
        Some((z - g, [along(&jet.du), along(&jet.dv)], [jet.du.norm(), jet.dv.norm()]))
    }

    /// Climbs F from a seed by quasi-Newton steps in mm along S_u and S_v. None where the top near the seed is seen from there
    /// to be lower than `beaten`.
    fn climb(&self, s: &Seed, c: [f64; 2], beaten: f64) -> Option<Rest> {
        let surface = self.surfaces[s.face as usize];
        let domain = surface.domain();
        let rest = |tip: f64, at: Uv| Rest { tip, uv: at, face: s.face, point: surface.point(at) };
        let Some((mut f, mut by, speed)) = self.value(s.face, s.uv, c) else {
            return Some(rest(self.held(s, c), s.uv));
        };
        let scale = speed.map(|v| 1.0 / v.max(f64::MIN_POSITIVE));
        if scale.iter().any(|k| *k > 1e300) {
            return Some(rest(f, s.uv));
        }
        // Where the tool is more curved than the part F is below its tangents.
        if f + NEAR * self.spacing * (by[0] * scale[0]).hypot(by[1] * scale[1]) < beaten {
            return None;
        }
        let mut at = s.uv;
        // The inverse of minus the Hessian: a curvature like the tool's to begin with.
        let radius = self.cutter.radius_mm();
        let mut inverse = [[radius, 0.0], [0.0, radius]];
        // A gain below this is none: 1e-9 of the tool.
        let enough = 1e-9 * radius;
        for _ in 0..STEPS {
            let g = [by[0] * scale[0], by[1] * scale[1]];
            let mut d =
                [inverse[0][0] * g[0] + inverse[0][1] * g[1], inverse[1][0] * g[0] + inverse[1][1] * g[1]];
            let gain = g[0] * d[0] + g[1] * d[1];
            if gain < enough {
                break;
            }
            // No further than a few seeds: beyond that another seed would have been the start.
            let long = d[0].hypot(d[1]);
            let most = 2.0 * self.spacing;
            if long > most {
                d = d.map(|x| x * most / long);
            }
            let mut found = None;
            for _ in 0..8 {
                let to = domain.bring(uv(at.u + d[0] * scale[0], at.v + d[1] * scale[1]));
                if surface.contains(to)
                    && let Some((nf, nby, _)) = self.value(s.face, to, c)
                    && nf >= f
                {
                    found = Some((to, nf, nby));
                    break;
                }
                d = d.map(|x| 0.35 * x);
            }
            let Some((to, nf, nby)) = found else { break };
            // BFGS for -F: y = -(change of gradient).
            let y = [-(nby[0] * scale[0] - g[0]), -(nby[1] * scale[1] - g[1])];
            update(&mut inverse, d, y);
            let won = nf - f;
            (at, f, by) = (to, nf, nby);
            if won < enough {
                break;
            }
        }
        // A sharp edge stops the climb where the face leaves the disc: on, along the edge.
        let circle = Circle { centre: c, radius_mm: radius };
        if self.cutter.corner_mm() == 0.0
            && let Some((on, tip)) = highest(surface, &self.frame, &circle, at)
            && tip > f
        {
            return Some(rest(tip, on));
        }
        Some(rest(f, at))
    }

    /// Normal of a face at a resting place, if it has one.
    pub(super) fn normal(&self, r: &Rest) -> Option<Unit3> {
        self.surfaces[r.face as usize].jet2(r.uv).normal().ok()
    }
}

/// The BFGS update of an inverse Hessian of size two, skipped where the curvature along the step is not positive.
fn update(h: &mut [[f64; 2]; 2], d: [f64; 2], y: [f64; 2]) {
    let dy = d[0] * y[0] + d[1] * y[1];
    if dy <= 0.0 {
        return;
    }
    let hy = [h[0][0] * y[0] + h[0][1] * y[1], h[1][0] * y[0] + h[1][1] * y[1]];
    let yhy = y[0] * hy[0] + y[1] * hy[1];
    for i in 0..2 {
        for j in 0..2 {
            h[i][j] += (1.0 + yhy / dy) * d[i] * d[j] / dy - (hy[i] * d[j] + d[i] * hy[j]) / dy;
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
