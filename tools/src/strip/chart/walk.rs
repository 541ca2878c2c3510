//! The contact motion on a chart, and the walk across the strip.

use super::posture::ChartError;
use super::{Chart, Ray};
use crate::contact::Lean;
use crate::cutter::{Cutter, Line};
use crate::meridian::Arc;
use crate::pose::Pose;
use crate::strip::local::{Near, Pace, deepest};
use crate::strip::passages::dip;
use crate::sweep::{Moving, SweptMotion};
use osculate_geom::roots::{End, bracketed};
use osculate_geom::{Unit3, Vec3};
use std::cell::Cell;
use std::rc::Rc;

/// The contact motion along a line of the chart.
pub(super) struct ChartMotion<'a> {
    pub chart: &'a Chart<'a>,
    pub feed: Rc<Ray>,
    pub lean: Lean,
    pub arc: Arc,
    /// Set when an instant outside the chart was asked for.
    pub beyond: Cell<bool>,
}

impl SweptMotion for ChartMotion<'_> {
    fn at(&self, t: f64) -> Option<Moving> {
        let x = t / self.chart.radius;
        if t.abs() > self.chart.reach {
            self.beyond.set(true);
            return None;
        }
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

/// Crests of the profile that come up to this share of the tolerance are looked at between places.
const SUSPECT: f64 = 0.5;
/// Chords drawn before the edge of a strip is bracketed.
const CHORDS: u32 = 3;
/// Most places of a profile.
const PLACES: usize = 40;

/// Heights along one side, until they exceed the tolerance; the ray runs to the left, `sign` says to which side.
pub(super) struct Profile {
    ray: Rc<Ray>,
    sign: f64,
    places: [(f64, f64, Near); PLACES],
    count: usize,
    at_edge: bool,
}

impl Profile {
    pub(super) fn new(ray: Rc<Ray>, sign: f64) -> Self {
        let places = [(0.0, 0.0, Near { t: 0.0, bend: None }); PLACES];
        Self { ray, sign, places, count: 0, at_edge: false }
    }

    /// The normal of the part at the distance `q` from the contact.
    fn line(&self, chart: &Chart<'_>, q: f64) -> Line {
        chart.line(&self.ray, self.sign * q)
    }

    /// The normal of the part at the last place.
    pub(super) fn end(&self, chart: &Chart<'_>) -> Line {
        self.line(chart, self.seen().last().map_or(0.0, |p| p.0))
    }

    fn seen(&self) -> &[(f64, f64, Near)] {
        &self.places[..self.count]
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
    /// Whether every place takes the deepest of all passages within a radius of the contact.
    pub everywhere: bool,
}

/// Instants, a twentieth of the tool's radius apart, that are looked at to each side of the contact.
const NEARBY: i32 = 20;

impl Side<'_> {
    fn height(&self, profile: &Profile, q: f64, near: Near) -> (f64, Near) {
        let line = profile.line(self.motion.chart, q);
        // A tool that does not pass over the place stands above it by more than any tolerance.
        let (own, near) = deepest(self.cutter, &line, self.motion, near, self.pace)
            .map_or((self.cutter.radius_mm(), near), |(reach, near)| (reach.at_mm, near));
        (if self.everywhere { self.lowest(&line, None).min(own) } else { own }, near)
    }

    /// The lowest entry of the line within a radius of the contact, at instants away from `but`, by parabolas.
    fn lowest(&self, line: &Line, but: Option<f64>) -> f64 {
        let entry = |k: i32| {
            let t = f64::from(k) * self.pace.step;
            // Beyond the chart there is nothing to ask.
            let pose = if t.abs() < self.motion.chart.reach { self.motion.at(t)?.pose } else { return None };
            Some(self.cutter.entry(&pose, line)?.at_mm)
        };
        let mut lowest = f64::INFINITY;
        let mut before = [f64::INFINITY; 2];
        for k in -NEARBY..=NEARBY {
            let now = entry(k).unwrap_or(f64::INFINITY);
            let [a, b] = before;
            let other =
                but.is_none_or(|t| (f64::from(k - 1) * self.pace.step - t).abs() > 2.0 * self.pace.step);
            if other && b < a && b <= now {
                lowest = lowest.min(b - dip([a, b, now]));
            }
            before = [b, now];
        }
        lowest
    }

    /// Whether the tool at another instant than the profile's own comes down to the tolerance over its end.
    pub(super) fn comes_again(&self, profile: &Profile) -> bool {
        profile
            .seen()
            .last()
            .is_some_and(|(_, _, near)| self.lowest(&profile.end(self.motion.chart), Some(near.t)) <= self.h)
    }

    pub(super) fn walk(&self, profile: &mut Profile) -> Result<(), ChartError> {
        let chart = self.motion.chart;
        let (mut q, mut near, mut step) = (0.0, Near { t: 0.0, bend: None }, self.step);
        while profile.count < PLACES {
            // A tool that fits touches where it is.
            let touches = profile.count == 0 && self.fits;
            let (f, found) = if touches { (0.0, near) } else { self.height(profile, q, near) };
            if self.motion.beyond.get() {
                return Err(ChartError::Beyond { radius_mm: chart.reach });
            }
            near = found;
            profile.places[profile.count] = (q, f, near);
            profile.count += 1;
            if profile.count == 1 && f > self.h {
                return Err(ChartError::Above { standoff_mm: f });
            }
            if f > self.h || profile.at_edge {
                return Ok(());
            }
            if self.crest(profile) {
                return Ok(());
            }
            if q + step > chart.reach {
                return Err(ChartError::Beyond { radius_mm: chart.reach });
            }
            if !chart.inside(&profile.ray, profile.sign * (q + step)) {
                // Bisection to a thousandth of the step.
                let (mut lo, mut hi) = (0.0, step);
                for _ in 0..10 {
                    let m = 0.5 * (lo + hi);
                    if chart.inside(&profile.ray, profile.sign * (q + m)) { lo = m } else { hi = m }
                }
                step = lo;
                profile.at_edge = true;
            }
            q += step;
        }
        Err(ChartError::Beyond { radius_mm: chart.reach })
    }

    /// Whether the profile exceeds the tolerance at the crest of the parabola through its last three places, which then ends
    /// it.
    fn crest(&self, profile: &mut Profile) -> bool {
        let [.., a, b, c] = profile.seen() else { return false };
        let (bend, slope) = (0.5 * (a.1 + c.1) - b.1, 0.5 * (c.1 - a.1));
        let at = -0.5 * slope / bend;
        if !(bend < 0.0 && at.abs() < 1.0 && b.1 + 0.5 * slope * at > SUSPECT * self.h) {
            return false;
        }
        let q = b.0 + at * self.step;
        let (f, near) = self.height(profile, q, b.2);
        if f > self.h {
            // In the order of their distance: the crest lies before the last place, or before the last but one.
            profile.count -= if at < 0.0 { 2 } else { 1 };
            profile.places[profile.count] = (q, f, near);
            profile.count += 1;
        }
        f > self.h
    }

    /// Depth below the part: the lowest place, and the parabola through it and its neighbours.
    pub(super) fn undercut(&self, profile: &Profile) -> f64 {
        let seen = profile.seen();
        let Some((k, _)) = seen.iter().enumerate().min_by(|a, b| a.1.1.total_cmp(&b.1.1)) else { return 0.0 };
        let mut lowest = seen[k].1;
        if k > 0 && k + 1 < seen.len() {
            let [mut a, mut b, mut c] = [seen[k - 1], seen[k], seen[k + 1]];
            for _ in 0..3 {
                let (da, dc) = (b.0 - a.0, b.0 - c.0);
                let (fa, fc) = (b.1 - a.1, b.1 - c.1);
                let bottom = da * fc - dc * fa;
                if bottom == 0.0 {
                    break;
                }
                let x = b.0 - 0.5 * (da * da * fc - dc * dc * fa) / bottom;
                if !(x > a.0 && x < c.0) || (x - b.0).abs() < 1e-3 * self.step {
                    break;
                }
                let (f, near) = self.height(profile, x, b.2);
                lowest = lowest.min(f);
                let new = (x, f, near);
                if f < b.1 {
                    if x > b.0 {
                        a = b
                    } else {
                        c = b
                    }
                    b = new;
                } else if x > b.0 {
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
        let seen = profile.seen();
        let last = seen.last().map_or(0.0, |p| p.0);
        let Some(k) = seen.iter().position(|p| p.1 > height) else { return Ok([last; 2]) };
        if k == 0 {
            return Err(ChartError::Above { standoff_mm: seen[0].1 + self.h - height });
        }
        let edge = self.edge(profile, k, height);
        let higher = match seen.iter().position(|p| p.1 > height + more) {
            None => last,
            Some(j) => {
                let from = if j == k { (edge, height) } else { (seen[j - 1].0, seen[j - 1].1) };
                let share = (height + more - from.1) / (seen[j].1 - from.1);
                from.0 + share.clamp(0.0, 1.0) * (seen[j].0 - from.0)
            }
        };
        Ok([edge, higher])
    }

    /// Where the profile exceeds the height between the places before and at `k`, to a ten-thousandth of the way.
    fn edge(&self, profile: &Profile, k: usize, height: f64) -> f64 {
        let (from, to) = (profile.seen()[k - 1], profile.seen()[k]);
        // Profiles are nearly parabolas: their root is nearly straight, and chords find where it passes that of the height.
        let straight = |f: f64| f.abs().sqrt().copysign(f) - height.sqrt();
        let (mut a, mut b) = (End { x: from.0, f: straight(from.1) }, End { x: to.0, f: straight(to.1) });
        let tolerance = 1e-4 * to.0;
        for _ in 0..CHORDS {
            let slope = (b.f - a.f) / (b.x - a.x);
            let x = a.x - a.f / slope;
            let f = straight(self.height(profile, x, from.2).0);
            if f.abs() <= tolerance * slope {
                return (x - f / slope).clamp(a.x, b.x);
            }
            *(if f > 0.0 { &mut b } else { &mut a }) = End { x, f };
        }
        bracketed(a, b, tolerance, |q| straight(self.height(profile, q, from.2).0)).map_or(a.x, |r| r.x)
    }
}
