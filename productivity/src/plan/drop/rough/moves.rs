//! The moves of a roughing: along lines as far as they take something, between them, and through the air above what stands.
//!
//! Stock is kept as the moves before have left it: where it is taken already a line is not run, rapids go as low over it as it is known to
//! stand, and the feed is that of the section that the tool moves into.

use super::been::Been;
use super::columns::Columns;
use super::grid::Disc;
use super::layer::{Cut, Layer, Sheet};
use super::pace::{Fed, Pace, thinned};
use super::site::Site;
use super::task::{Entry, Sizes};
use crate::plan::{Linked, Links};
use osculate_tools::Pose;
use osculate_tools::cl::Motion;
use std::ops::Range;

/// Lines are looked at in steps of this part of the tool's radius.
pub(super) const STATION: f64 = 0.4;
/// A stretch that takes nothing is run all the same where it is shorter than this, of the tool's radius.
const BRIDGE: f64 = 2.0;
/// The next line is gone on to through the material where it begins within this many distances of lines.
const BESIDE: f64 = 2.5;
/// Pieces of a path stray from it by this share of the chord tolerance.
const STRAY: f64 = 0.5;
/// What takes nothing is gone along at the feed of the air where it is no shorter than this, of the tool's radius: less would all be
/// speeding up and slowing down.
const AIR: f64 = 1.0;
/// Share of the disc under the tool in which material may stand above the layer: slivers that are left on purpose.
const STANDS: f64 = 0.12;
/// Above the layer nothing stands higher than this share of its depth.
const ABOVE: f64 = 0.3;

/// How the moves are made.
#[derive(Clone, Copy)]
pub(super) struct Manner<'a> {
    pub sizes: &'a Sizes,
    pub links: &'a Links,
    pub entry: Entry,
    /// Whether the tool may go straight down into material.
    pub plunges: bool,
    /// Distance of lines, mm.
    pub apart_mm: f64,
    /// Height along the axis above everything, mm.
    pub safe: f64,
}

/// Moves under way.
pub(super) struct Moves<'a> {
    pub(super) site: &'a Site<'a>,
    pub(super) columns: Columns,
    pub(super) pace: Pace,
    pub(super) manner: Manner<'a>,
    pub(super) linked: Linked,
    pub(super) passes: Vec<Vec<[f64; 3]>>,
    pub(super) here: Option<[f64; 3]>,
    pub(super) taken_mm3: f64,
    pub(super) shut_mm3: f64,
    pub(super) been: Been,
    /// Discs under the tool, the tool as rapids keep off, and the holder.
    pub(super) under: Disc,
    pub(super) wide: Disc,
    held: Vec<(Disc, f64)>,
}

/// What the moves came to.
pub(super) struct Moved {
    pub linked: Linked,
    pub passes: Vec<Vec<[f64; 3]>>,
    pub taken_mm3: f64,
    pub shut_mm3: f64,
    /// Where more is left of what is to go than may stand, mm2 across the axis.
    pub high_mm2: f64,
}

/// A stretch of a line that is run.
struct Run {
    stations: Vec<[f64; 3]>,
    closed: bool,
}

pub(super) fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

pub(super) fn between(a: [f64; 3], b: [f64; 3], f: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * f)
}

/// A line with places no further apart than a step.
pub(super) fn stations(places: &[[f64; 3]], closed: bool, step: f64) -> Vec<[f64; 3]> {
    let mut out: Vec<[f64; 3]> = places.first().copied().into_iter().collect();
    let ends = places.windows(2).map(|w| [w[0], w[1]]);
    let last = places.first().zip(places.last()).filter(|_| closed).map(|(a, b)| [*b, *a]);
    for [a, b] in ends.chain(last) {
        let steps = (apart(a, b) / step).ceil().max(1.0) as usize;
        out.extend((1..=steps).map(|s| between(a, b, s as f64 / steps as f64)));
    }
    out
}

impl<'a> Moves<'a> {
    pub fn new(site: &'a Site<'a>, pace: Pace, manner: Manner<'a>) -> Self {
        let cell = site.grid.cell;
        let wide = Disc::new(site.tool.bare.radius_mm + site.blur_mm + cell, cell);
        let held =
            site.tool.holder.iter().map(|[radius, above]| (Disc::new(*radius, cell), *above)).collect();
        Self {
            site,
            columns: site.columns.clone(),
            pace,
            manner,
            linked: Linked::default(),
            passes: Vec::new(),
            here: None,
            taken_mm3: 0.0,
            shut_mm3: 0.0,
            been: Been::nowhere(site.grid.len()),
            under: site.disc.clone(),
            wide,
            held,
        }
    }

    /// Where the tool is.
    pub const fn here(&self) -> Option<[f64; 3]> {
        self.here
    }

    /// The path, led out to the safe height.
    pub fn done(mut self) -> Moved {
        if let Some([x, y, _]) = self.here {
            self.rapid([x, y, self.manner.safe]);
        }
        let high_mm2 = self.high_mm2();
        let Self { linked, passes, taken_mm3, shut_mm3, .. } = self;
        Moved { linked, passes, taken_mm3, shut_mm3, high_mm2 }
    }

    fn high_mm2(&self) -> f64 {
        let (tops, least) = (self.columns.tops(), &self.site.least);
        let stands_mm = self.manner.sizes.stands_mm;
        let count = tops.iter().zip(least).filter(|(top, least)| **top > **least + stands_mm).count();
        count as f64 * self.site.grid.cell.powi(2)
    }

    fn go(&mut self, at: [f64; 3], motion: Motion, pass: Option<u32>) {
        let frame = &self.site.ground.frame;
        self.linked.go(Pose { tip: frame.point(at), axis: frame.axis }, motion, pass);
        self.here = Some(at);
    }

    pub(super) fn rapid(&mut self, at: [f64; 3]) {
        self.go(at, Motion::Rapid, None);
    }

    /// Goes along places at the feed of passes, faster where nothing is taken.
    pub(super) fn go_on(&mut self, way: &[[f64; 3]], pass: Option<u32>) {
        let links = self.manner.links;
        self.fed(way, (links.feed_mm_min, links.air_mm_min), pass);
    }

    /// Goes along places at the feed of plunges.
    pub(super) fn go_down(&mut self, way: &[[f64; 3]]) {
        let feed = self.manner.links.plunge_mm_min;
        self.fed(way, (feed, feed), None);
    }

    /// Goes along places at a feed that is not exceeded in what stands there, and one through the air.
    fn fed(&mut self, way: &[[f64; 3]], (most_mm_min, air_mm_min): (f64, f64), pass: Option<u32>) {
        let Some(mut here) = self.here else { return };
        let step = STATION * self.site.tool.bare.radius_mm;
        let mut fed: Vec<Fed> = vec![(here, 0.0)];
        let mut air = vec![false];
        let (site, mut before) = (self.site, None);
        for to in way {
            let steps = (apart(here, *to) / step).ceil() as usize;
            let from = here;
            for s in 1..=steps {
                let next = between(from, *to, s as f64 / steps as f64);
                let mut feed = most_mm_min;
                if self.pace.is_capped() {
                    let way = [0, 1, 2].map(|k| next[k] - here[k]);
                    let section = |at: [f64; 3]| self.pace.section_mm2((&self.columns, &site.grid), at, way);
                    let (begin, end) = (section(here), section(next));
                    feed = self.pace.feed_mm_min(begin.max(end).max(before.unwrap_or(0.0)), most_mm_min);
                    before = Some(end);
                }
                let taken_mm3 = self.columns.cut(&site.grid, &site.tool.bare, [here, next]);
                self.taken_mm3 += taken_mm3;
                air.push(taken_mm3 == 0.0);
                if let Some(k) = site.grid.near([next[0], next[1]]) {
                    self.been.at(k, next);
                }
                fed.push((next, feed));
                here = next;
            }
        }
        if air_mm_min > most_mm_min {
            for run in runs_of_air(&fed, &air, AIR * site.tool.bare.radius_mm) {
                fed[run].iter_mut().for_each(|(_, feed)| *feed = air_mm_min);
            }
        }
        for (at, feed) in thinned(&fed, STRAY * self.manner.sizes.chord_mm).into_iter().skip(1) {
            self.go(at, Motion::Feed(feed), pass);
        }
        self.here = Some(here);
    }

    /// Whether the tool takes something that is to go from a place.
    fn takes(&self, layer: Layer, at: [f64; 3], [floor, slope]: [f64; 2]) -> bool {
        let site = self.site;
        let Some(k) = site.grid.near([at[0], at[1]]) else { return false };
        let thin = if at[2] > layer.floor + 1e-9 && !site.shallow[k] { slope } else { floor };
        let (bare, tops) = (&site.tool.bare, self.columns.tops());
        for m in site.grid.disc(&self.under, k).flatten() {
            let top = tops[m];
            if top <= at[2] + thin || top <= site.least[m] + thin {
                continue;
            }
            if bare.is_flat() {
                return true;
            }
            let p = site.grid.at(m);
            let rho = (p[0] - at[0]).hypot(p[1] - at[1]).min(bare.radius_mm);
            if top > at[2] + bare.lift_mm(rho) + thin {
                return true;
            }
        }
        false
    }

    /// Whether the tool may not be at a place now: it would cut deeper than the layer, or its holder would meet what stands.
    fn is_barred(&self, sheet: &Sheet, at: [f64; 3]) -> bool {
        let site = self.site;
        let Some(k) = site.grid.near([at[0], at[1]]) else { return true };
        if !sheet.lets(site, [at[0], at[1]]) {
            return true;
        }
        let high = sheet.layer.ceiling + ABOVE * (sheet.layer.ceiling - sheet.layer.floor);
        let stands = site.grid.disc(&self.under, k).flatten().filter(|m| self.columns.tops()[*m] > high);
        if stands.count() as f64 > STANDS * self.under.count() as f64 {
            return true;
        }
        self.holder_stands_on(k) > at[2]
    }

    /// Whether part and material let the holder come so low over a node.
    pub(super) fn holder_lets(&self, k: usize, height: f64) -> bool {
        self.holder_stops(k) <= height
    }

    /// How low part and material let the holder come over a node.
    pub(super) fn holder_stops(&self, k: usize) -> f64 {
        self.holder_stands_on(k).max(self.site.holder[k])
    }

    /// How low the material lets the holder come over a node.
    fn holder_stands_on(&self, k: usize) -> f64 {
        let stands =
            self.held.iter().map(|(disc, above)| self.columns.top_in(&self.site.grid, disc, k) - above);
        stands.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Goes straight on to a place through the layer where that is near and free all the way.
    fn beside(&mut self, sheet: &Sheet, at: [f64; 3]) -> bool {
        let Some(here) = self.here else { return false };
        let long = (at[0] - here[0]).hypot(at[1] - here[1]);
        if here[2] > sheet.layer.ceiling || long > BESIDE * self.manner.apart_mm {
            return false;
        }
        let Some(way) = self.straight(sheet, here, at) else { return false };
        if way.iter().any(|p| self.is_barred(sheet, *p)) {
            return false;
        }
        self.go_on(&way, None);
        true
    }

    /// The stretches of a line that take something now.
    fn runs(&self, sheet: &Sheet, cut: &Cut) -> Vec<Run> {
        let radius = self.site.tool.bare.radius_mm;
        let mut all = stations(&cut.places, cut.closed, STATION * radius);
        let n = all.len();
        let barred: Vec<bool> = all.iter().map(|p| self.is_barred(sheet, *p)).collect();
        let mut wanted: Vec<bool> =
            (0..n).map(|k| !barred[k] && self.takes(sheet.layer, all[k], cut.thin)).collect();
        if !wanted.contains(&true) {
            return Vec::new();
        }
        if cut.closed && wanted.iter().all(|w| *w) {
            return vec![Run { stations: all, closed: true }];
        }
        if cut.closed {
            // Begun where it takes nothing; its last station is its first.
            let start = wanted.iter().position(|w| !w).unwrap_or(0);
            all.pop();
            let wants: Vec<bool> = (0..n - 1).map(|k| wanted[(start + k) % (n - 1)]).collect();
            let bars: Vec<bool> = (0..n - 1).map(|k| barred[(start + k) % (n - 1)]).collect();
            all.rotate_left(start % (n - 1));
            all.push(all[0]);
            wanted = wants.iter().copied().chain([wants[0]]).collect();
            let barred: Vec<bool> = bars.iter().copied().chain([bars[0]]).collect();
            return stretches(&all, &wanted, &barred, BRIDGE * radius);
        }
        stretches(&all, &wanted, &barred, BRIDGE * radius)
    }

    /// Cuts along a line.
    pub fn cut(&mut self, sheet: &Sheet, cut: Cut) {
        let mut runs = self.runs(sheet, &cut);
        if !cut.closed {
            let d = |p: Option<&[f64; 3]>, h: [f64; 3]| {
                p.map_or(f64::INFINITY, |p| (p[0] - h[0]).hypot(p[1] - h[1]))
            };
            let ends =
                (runs.first().and_then(|r| r.stations.first()), runs.last().and_then(|r| r.stations.last()));
            if let Some(h) = self.here
                && d(ends.1, h) < d(ends.0, h)
            {
                runs.reverse();
                runs.iter_mut().for_each(|r| r.stations.reverse());
            }
        }
        for mut run in runs {
            if run.closed {
                self.begin_near(&mut run.stations);
            }
            for stretch in self.climbing(sheet, run.stations) {
                self.run(sheet, &stretch);
            }
        }
    }

    /// Turns a closed line so that it begins nearest to the tool.
    fn begin_near(&self, stations: &mut Vec<[f64; 3]>) {
        let Some(h) = self.here else { return };
        let away = |p: &[f64; 3]| (p[0] - h[0]).hypot(p[1] - h[1]);
        stations.pop();
        let nearest = (0..stations.len()).min_by(|a, b| away(&stations[*a]).total_cmp(&away(&stations[*b])));
        stations.rotate_left(nearest.unwrap_or(0));
        stations.extend(stations.first().copied());
    }

    fn run(&mut self, sheet: &Sheet, stations: &[[f64; 3]]) {
        let Some(start) = stations.first().copied() else { return };
        if !self.beside(sheet, start) && !self.come_in(sheet, stations) {
            let long: f64 = stations.windows(2).map(|w| apart(w[0], w[1])).sum();
            self.shut_mm3 += long * self.manner.apart_mm * (sheet.layer.ceiling - start[2]).max(0.0);
            return;
        }
        let pass = self.passes.len() as u32;
        self.go_on(&stations[1..], Some(pass));
        self.passes.push(stations.to_vec());
    }
}

/// The ends of pieces of a way that lead through the air, where these are together no shorter than so much.
fn runs_of_air(way: &[Fed], air: &[bool], least_mm: f64) -> Vec<Range<usize>> {
    let mut out = Vec::new();
    let mut k = 0;
    while k < way.len() {
        let end = (k..way.len()).find(|i| air[*i] != air[k]).unwrap_or(way.len());
        let long: f64 = (k..end).map(|i| if i == 0 { 0.0 } else { apart(way[i - 1].0, way[i].0) }).sum();
        if air[k] && long >= least_mm {
            out.push(k..end);
        }
        k = end;
    }
    out
}

/// The parts of a line that are wanted, with short ways between them and one station more at each end.
fn stretches(all: &[[f64; 3]], wanted: &[bool], barred: &[bool], bridge_mm: f64) -> Vec<Run> {
    let n = all.len();
    let mut found: Vec<[usize; 2]> = Vec::new();
    let mut k = 0;
    while k < n {
        if !wanted[k] {
            k += 1;
            continue;
        }
        let from = k;
        while k + 1 < n && wanted[k + 1] {
            k += 1;
        }
        let joins = found.last().filter(|[_, end]| {
            let way: f64 = (*end..from).map(|j| apart(all[j], all[j + 1])).sum();
            way <= bridge_mm && !barred[*end..from].contains(&true)
        });
        match joins {
            Some(_) => {
                if let Some(last) = found.last_mut() {
                    last[1] = k;
                }
            }
            None => found.push([from, k]),
        }
        k += 1;
    }
    found
        .into_iter()
        .map(|[from, to]| {
            let from = if from > 0 && !barred[from - 1] { from - 1 } else { from };
            let to = if to + 1 < n && !barred[to + 1] { to + 1 } else { to };
            Run { stations: all[from..=to].to_vec(), closed: false }
        })
        .filter(|r| r.stations.len() > 1)
        .collect()
}
