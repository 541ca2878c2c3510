//! The contact motion on a chart, and the walk across the strip.

use super::asked::ChartError;
use super::{Chart, Ray};
use crate::contact::Lean;
use crate::cutter::{Cutter, Line};
use crate::meridian::Arc;
use crate::pose::Pose;
use crate::strip::local::{Near, Pace, deepest};
use crate::strip::passages::{dip, minima};
use crate::sweep::{Moving, SweptMotion};
use osculate_geom::roots::{End, bracketed};
use osculate_geom::{Unit3, Vec3};
use std::cell::{Cell, OnceCell};

/// The contact motion along a line of the chart.
pub(super) struct ChartMotion<'a> {
    pub chart: &'a Chart<'a>,
    pub feed: Ray,
    pub lean: Lean,
    pub arc: Arc,
    /// Set when an instant outside the chart was asked for.
    pub beyond: Cell<bool>,
}

impl SweptMotion for ChartMotion<'_> {
    fn at(&self, t: f64) -> Option<Moving> {
        if t.abs() > self.chart.reach && self.goes(t) {
            self.beyond.set(true);
            return None;
        }
        self.moving(t)
    }
}

impl ChartMotion<'_> {
    /// Whether the feed has not ended with the surface, as that of an exact contact does.
    fn goes(&self, t: f64) -> bool {
        t.abs() <= self.feed.inside()[usize::from(t > 0.0)]
    }

    /// Whether the part has turned by less than a right angle from the place on.
    fn faces(&self, t: f64) -> bool {
        let v = self.feed.values(t / self.chart.radius);
        1.0 + self.chart.forms.normal.dot(&Vec3::new(v[3], v[4], v[5])) > 0.0
    }

    /// The motion as far as its line goes, where the chart is no longer good too.
    pub(super) fn moving(&self, t: f64) -> Option<Moving> {
        if !self.goes(t) {
            return None;
        }
        if t.abs() > self.feed.reach()[usize::from(t > 0.0)] {
            return None;
        }
        let x = t / self.chart.radius;
        let (p, d, dd) = self.feed.moving(x);
        let rate = self.chart.size[1] as f64 / self.chart.radius;
        let point = self.chart.centre + Vec3::new(p[0], p[1], p[2]);
        let velocity = Vec3::new(d[0], d[1], d[2]) * rate;
        let speed = velocity.norm();
        let tangent = velocity / speed;
        let bend = Vec3::new(dd[0], dd[1], dd[2]) * (rate * rate / speed);
        let tangent_rate = bend - tangent * tangent.dot(&bend);
        let raw = self.chart.forms.normal.into_inner() + Vec3::new(p[3], p[4], p[5]);
        let length = raw.norm();
        let n = raw / length;
        let turn = Vec3::new(d[3], d[4], d[5]) * (rate / length);
        let n_rate = turn - n * n.dot(&turn);
        let (left, left_rate) = (n.cross(&tangent), n_rate.cross(&tangent) + n.cross(&tangent_rate));
        let (s, c) = self.lean.tilt_rad.sin_cos();
        let (heading, heading_rate) = (tangent * c + left * s, tangent_rate * c + left_rate * s);
        let (s, c) = self.lean.lead_rad.sin_cos();
        let (axis, axis_rate) = (n * c + heading * s, n_rate * c + heading_rate * s);
        let sign = if s < 0.0 { -1.0 } else { 1.0 };
        let (low, low_rate) = ((heading * c - n * s) * sign, (heading_rate * c - n_rate * s) * sign);
        let Arc { radius_mm, centre_rho_mm, centre_z_mm, .. } = self.arc;
        let tip = point + n * radius_mm - low * centre_rho_mm - axis * centre_z_mm;
        let tip_rate = velocity + n_rate * radius_mm - low_rate * centre_rho_mm - axis_rate * centre_z_mm;
        Some(Moving {
            pose: Pose { tip, axis: Unit3::new_normalize(axis) },
            tip_rate,
            turn: axis.cross(&axis_rate),
        })
    }
}

/// The motion where the chart is no longer good too: other passages than the contact's own are looked at as far as there are lines.
struct Far<'a>(&'a ChartMotion<'a>);

impl SweptMotion for Far<'_> {
    fn at(&self, t: f64) -> Option<Moving> {
        self.0.moving(t)
    }
}

/// Crests of the profile that come up to this share of the tolerance are looked at between places.
const SUSPECT: f64 = 0.5;
/// Chords drawn before the edge of a strip is bracketed.
const CHORDS: u32 = 3;
/// Most places of a profile, and for how many there is room at once.
const PLACES: usize = 120;
const ROOM: usize = 24;

/// Heights along one side, until they exceed the tolerance; the ray runs to the left, `sign` says to which side.
pub(super) struct Profile {
    ray: Ray,
    sign: f64,
    places: Vec<Spot>,
    at_edge: bool,
    /// Whether every place takes the deepest of all passages on the chart.
    everywhere: bool,
}

/// A place of a profile.
#[derive(Clone, Copy)]
struct Spot {
    q: f64,
    height: f64,
    near: Near,
    /// The deepest instant.
    t: f64,
    /// How much higher the contact's own passage is than the lowest of the others, where these are asked for.
    gap: f64,
}

impl Spot {
    /// Whether another wave than at the place before is the deepest: its instant moves by no more than about the way across.
    fn jumps(&self, before: &Self, least: f64) -> bool {
        (self.t - before.t).abs() > (self.q - before.q).abs() + least
    }
}

impl Profile {
    pub(super) fn new(ray: Ray, sign: f64) -> Self {
        Self { ray, sign, places: Vec::with_capacity(ROOM), at_edge: false, everywhere: false }
    }

    /// The normal of the part at the distance `q` from the contact.
    fn line(&self, chart: &Chart<'_>, q: f64) -> Line {
        chart.line(&self.ray, self.sign * q)
    }

    /// The normal of the part at the last place.
    pub(super) fn last_line(&self, chart: &Chart<'_>) -> Line {
        self.line(chart, self.places.last().map_or(0.0, |p| p.q))
    }

    /// Where the profile nearly comes up to a height: by the chord of the roots before its last place, which is far beyond.
    pub(super) fn nearly_edge(&self, height: f64) -> f64 {
        match self.places[..] {
            [.., a, b] if a.height < height && height < b.height => {
                let [low, edge, high] = [a.height, height, b.height].map(|x| x.max(0.0).sqrt());
                a.q + (edge - low) / (high - low) * (b.q - a.q)
            }
            [.., last] => last.q,
            [] => 0.0,
        }
    }

    /// To be walked anew, by all passages.
    pub(super) fn begin_everywhere(&mut self) {
        self.places.clear();
        (self.at_edge, self.everywhere) = (false, true);
    }
}

pub(super) struct Side<'a> {
    pub motion: &'a ChartMotion<'a>,
    pub cutter: &'a Cutter,
    pub pace: Pace,
    pub h: f64,
    pub step: f64,
    /// Whether Q is positive definite.
    pub fits: bool,
    /// How far before and after the contact's instant the body can lie over it, mm of feed.
    pub over: [f64; 2],
    /// Poses of the tool along the feed, equally spaced, made when first asked for.
    pub nearby: OnceCell<Vec<(f64, Pose)>>,
}

/// Distance between the instants that are looked at for other passages, in the tool's radius, and of that between knots.
const APART: [f64; 2] = [0.02, 0.15];
const OF_PITCH: f64 = 1.0 / 3.0;
/// Other passages are told up to so many times the tolerance: where they cross the contact's own they are nearly as high.
const HEADROOM: f64 = 2.0;
/// Places looked at between two at which different passages are the deepest, at least, and at most while they still are; and how far
/// these lie apart at least, in the tool's radius.
const CROSSINGS: [u32; 2] = [3, 10];
const JUMP: f64 = 0.05;

impl Side<'_> {
    fn spot(&self, profile: &Profile, q: f64, near: Near) -> Spot {
        let line = profile.line(self.motion.chart, q);
        // A tool that does not pass over the place stands above it by more than any tolerance.
        let (own, near) = deepest(self.cutter, &line, self.motion, near, self.pace)
            .map_or((self.cutter.radius_mm(), near), |(reach, near)| (reach.at_mm, near));
        let (other, t) = if profile.everywhere {
            self.lowest(&line, near.t, HEADROOM * self.h)
        } else {
            (f64::INFINITY, near.t)
        };
        Spot { q, height: own.min(other), near, t: if other < own { t } else { near.t }, gap: own - other }
    }

    /// Distance between the poses looked at, mm.
    fn apart(&self) -> f64 {
        let radius = self.cutter.radius_mm();
        (OF_PITCH * self.motion.feed.pitch_mm()).clamp(APART[0] * radius, APART[1] * radius)
    }

    /// Poses as far as the feed goes, while the body can lie over the strip.
    fn poses(&self) -> &[(f64, Pose)] {
        self.nearby.get_or_init(|| {
            let apart = self.apart();
            let reach = self.motion.feed.reach();
            let [behind, ahead] = [0, 1].map(|k| (reach[k].min(self.over[k]) / apart) as i32);
            let at = |k: i32| f64::from(k) * apart;
            // Beyond a right angle the tool is on the part's other side.
            let faces = |k: &i32| self.motion.faces(at(*k));
            let back = (1..=behind).map(|k| -k).take_while(faces).count() as i32;
            let pose = |k: i32| self.motion.moving(at(k)).map(|m| (at(k), m.pose));
            (-back..=0).chain((1..=ahead).take_while(faces)).filter_map(pose).collect()
        })
    }

    /// The lowest entry of the line on the chart, at instants away from that of the contact's own passage, and its instant; infinite
    /// where none comes below a height.
    fn lowest(&self, line: &Line, own: f64, below_mm: f64) -> (f64, f64) {
        let apart = self.apart();
        let mut lowest = (f64::INFINITY, 0.0);
        let poses = self.poses();
        minima(self.cutter, line, (poses, below_mm), |k, heights| {
            let t = poses[k].0;
            if (t - own).abs() > 2.0 * apart {
                let found = self.bottom(line, heights, t);
                lowest = if found.0 < lowest.0 { found } else { lowest };
            }
        });
        lowest
    }

    /// What an entry falls to around an instant at which it is lower than at its neighbours, and when.
    fn bottom(&self, line: &Line, heights: [f64; 3], t: f64) -> (f64, f64) {
        let [a, b, c] = heights;
        let fall = |x: f64| if x.is_finite() { x - b } else { 0.0 };
        let by_parabola = (b - dip(heights), t);
        // How deep only matters near the tolerance, to which it may go on to fall as it fell before.
        if b - fall(a).max(fall(c)) > self.h {
            return by_parabola;
        }
        let apart = self.apart();
        let pace = Pace { step: 0.5 * apart, ..self.pace };
        deepest(self.cutter, line, &Far(self.motion), Near { t, bend: None }, pace)
            .filter(|(reach, _)| (reach.t - t).abs() <= apart)
            .map_or(by_parabola, |(reach, _)| (reach.at_mm, reach.t))
    }

    /// Whether the tool at another instant than that of the contact's own passage comes down to the tolerance over the place `q` from
    /// the contact.
    pub(super) fn comes_again(&self, profile: &Profile, q: f64) -> bool {
        let own = profile.places.iter().rfind(|p| p.q <= q).map_or(0.0, |p| p.near.t);
        self.lowest(&profile.line(self.motion.chart, q), own, self.h).0 <= self.h
    }

    pub(super) fn walk(&self, profile: &mut Profile) -> Result<(), ChartError> {
        let chart = self.motion.chart;
        let (mut q, mut near, mut step) = (0.0, Near { t: 0.0, bend: None }, self.step);
        let side = usize::from(profile.sign > 0.0);
        let reach = chart.reach.min(profile.ray.reach()[side]);
        let inside = profile.ray.inside()[side];
        while profile.places.len() < PLACES {
            // A tool that fits touches where it is.
            let touches = profile.places.is_empty() && self.fits && !profile.everywhere;
            let spot = if touches {
                Spot { q, height: 0.0, near, t: 0.0, gap: 0.0 }
            } else {
                self.spot(profile, q, near)
            };
            if self.motion.beyond.get() {
                return Err(ChartError::Beyond { radius_mm: chart.reach });
            }
            near = spot.near;
            profile.places.push(spot);
            if profile.places.len() == 1 && spot.height > self.h {
                return Err(ChartError::Above { standoff_mm: spot.height });
            }
            if self.crossing(profile) || spot.height > self.h || profile.at_edge || self.crest(profile) {
                return Ok(());
            }
            if q + step > inside && inside <= reach {
                step = inside - q;
                profile.at_edge = true;
            } else if q + step > reach {
                return Err(ChartError::Beyond { radius_mm: chart.reach });
            }
            q += step;
        }
        Err(ChartError::Beyond { radius_mm: chart.reach })
    }

    /// Whether the profile exceeds the tolerance where it changes from one passage to another before the last place, which then
    /// ends it there: a crest with an edge.
    fn crossing(&self, profile: &mut Profile) -> bool {
        let [before @ .., a, b] = &profile.places[..] else { return false };
        let (mut a, mut b) = (*a, *b);
        // Heights are nearly convex but where the passage changes: then they end below the line through the places before.
        let ahead =
            before.last().map_or(0.0, |p| a.height + (a.height - p.height) * (b.q - a.q) / (a.q - p.q));
        let bends = ahead > self.h && b.height <= self.h;
        if !self.motion.chart.is_traced() || !(bends || b.jumps(&a, JUMP * self.cutter.radius_mm())) {
            return false;
        }
        for tried in 0..CROSSINGS[1] {
            if tried >= CROSSINGS[0] && !b.jumps(&a, JUMP * self.cutter.radius_mm()) {
                break;
            }
            // Where both passages are as deep, by chords where both are known.
            let share = a.gap / (a.gap - b.gap);
            let share = if share > 0.05 && share < 0.95 { share } else { 0.5 };
            let top = self.spot(profile, a.q + share * (b.q - a.q), a.near);
            if top.height > self.h {
                profile.places.pop();
                profile.places.push(top);
                return true;
            }
            *(if (top.t - a.t).abs() < (b.t - top.t).abs() { &mut a } else { &mut b }) = top;
        }
        false
    }

    /// Whether the profile exceeds the tolerance at the crest of the parabola through its last three places, which then ends
    /// it.
    fn crest(&self, profile: &mut Profile) -> bool {
        let [.., a, b, c] = profile.places[..] else { return false };
        let (bend, slope) = (0.5 * (a.height + c.height) - b.height, 0.5 * (c.height - a.height));
        let at = -0.5 * slope / bend;
        if !(bend < 0.0 && at.abs() < 1.0 && b.height + 0.5 * slope * at > SUSPECT * self.h) {
            return false;
        }
        let top = self.spot(profile, b.q + at * self.step, b.near);
        if top.height > self.h {
            // In the order of their distance: the crest lies before the last place, or before the last but one.
            profile.places.truncate(profile.places.len() - if at < 0.0 { 2 } else { 1 });
            profile.places.push(top);
        }
        top.height > self.h
    }

    /// Depth below the part within the strip, which ends where the profile first exceeds a height: the lowest place, and the parabola
    /// through it and its neighbours.
    pub(super) fn undercut(&self, profile: &Profile, height: f64) -> f64 {
        // A walk goes on over crests that exceed it by less than the chart's error.
        let all = &profile.places[..];
        let seen = &all[..all.iter().position(|p| p.height > height).map_or(all.len(), |k| k + 1)];
        let least = seen.iter().enumerate().min_by(|a, b| a.1.height.total_cmp(&b.1.height));
        let Some((k, _)) = least else { return 0.0 };
        let mut lowest = seen[k].height;
        if k > 0 && k + 1 < seen.len() {
            let [mut a, mut b, mut c] = [seen[k - 1], seen[k], seen[k + 1]];
            for _ in 0..3 {
                let (da, dc) = (b.q - a.q, b.q - c.q);
                let (fa, fc) = (b.height - a.height, b.height - c.height);
                let bottom = da * fc - dc * fa;
                if bottom == 0.0 {
                    break;
                }
                let x = b.q - 0.5 * (da * da * fc - dc * dc * fa) / bottom;
                if !(x > a.q && x < c.q) || (x - b.q).abs() < 1e-3 * self.step {
                    break;
                }
                let new = self.spot(profile, x, b.near);
                lowest = lowest.min(new.height);
                if new.height < b.height {
                    if x > b.q {
                        a = b
                    } else {
                        c = b
                    }
                    b = new;
                } else if x > b.q {
                    c = new;
                } else {
                    a = new;
                }
            }
        }
        (-lowest).max(0.0)
    }

    /// Where the profile first exceeds the height, and nearly where it first exceeds one that is higher by `more`.
    pub(super) fn edges(&self, profile: &Profile, height: f64, more: f64) -> Result<[f64; 2], ChartError> {
        let seen = &profile.places[..];
        let last = seen.last().map_or(0.0, |p| p.q);
        let Some(k) = seen.iter().position(|p| p.height > height) else { return Ok([last; 2]) };
        if k == 0 {
            return Err(ChartError::Above { standoff_mm: seen[0].height + self.h - height });
        }
        let edge = self.edge(profile, k, height);
        let higher = match seen.iter().position(|p| p.height > height + more) {
            None => last,
            Some(j) => {
                let from = if j == k { (edge, height) } else { (seen[j - 1].q, seen[j - 1].height) };
                let share = (height + more - from.1) / (seen[j].height - from.1);
                from.0 + share.clamp(0.0, 1.0) * (seen[j].q - from.0)
            }
        };
        Ok([edge, higher])
    }

    /// Where the profile exceeds the height between the places before and at `k`, to a ten-thousandth of the way.
    fn edge(&self, profile: &Profile, k: usize, height: f64) -> f64 {
        let (from, to) = (profile.places[k - 1], profile.places[k]);
        // Profiles are nearly parabolas: their root is nearly straight, and chords find where it passes that of the height.
        let straight = |f: f64| f.abs().sqrt().copysign(f) - height.sqrt();
        let (mut a, mut b) =
            (End { x: from.q, f: straight(from.height) }, End { x: to.q, f: straight(to.height) });
        let tolerance = 1e-4 * to.q;
        for _ in 0..CHORDS {
            let slope = (b.f - a.f) / (b.x - a.x);
            let x = a.x - a.f / slope;
            let f = straight(self.spot(profile, x, from.near).height);
            if f.abs() <= tolerance * slope {
                return (x - f / slope).clamp(a.x, b.x);
            }
            *(if f > 0.0 { &mut b } else { &mut a }) = End { x, f };
        }
        bracketed(a, b, tolerance, |q| straight(self.spot(profile, q, from.near).height)).map_or(a.x, |r| r.x)
    }
}
