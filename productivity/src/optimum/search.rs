//! The search for the best posture: a ranked grid, the brink of two contacts, coordinate searches.
//!
//! Postures are compared on a [`Chart`] of the place, which costs some microseconds each; where a strip reaches beyond the chart the exact
//! strip is taken. The best are measured exactly, until none of the others can be better, so that the chart's error costs quality
//! but never truth.
//!
//! Over waves of the part a strip ends at a crest that it meets in one direction and passes in the next: there are as many
//! basins as waves within the strip, and directions are looked at twice as closely.

use super::posture::{Binding, Limits, Measured, Posture, Range, compare, measure, planar_mark_mm, share_by};
use crate::closed_form::leading_order_swept;
use osculate_geom::{Degenerate, Relative, Surface, SymEigen, Uv, Vec3};
use osculate_tools::strip::{Chart, ChartError, StripError, Within};
use osculate_tools::{Cutter, Lean};
use std::cmp::Ordering;
use std::f64::consts::{PI, TAU};

/// Directions, leads and tilts of the grid that is ranked.
pub(super) const GRID: [usize; 3] = [24, 7, 5];
/// Directions measured at the least lead, and where lines of the chart are traced: places next to edges, and over waves.
const DIRECTIONS: [usize; 2] = [36, 72];
/// Postures of the grid above the least lead that are measured, of which the leading order says less there; how many of
/// all enter the rounds of settling, and how many come through the first.
const MEASURED: [usize; 2] = [12, 36];
const ENTERED: usize = 6;
const SETTLED: usize = 3;
/// Leads tried above an impossible one in the first look.
const CLIMBS: u32 = 5;
/// Rounds of coordinate searches.
const ROUNDS: i32 = 3;
/// How much less than the best exact one is level with it on a chart without error. An exact strip that is narrower by a factor has
/// met what the chart did not show, and is settled once more.
const LEVEL: f64 = 1e-3;
const SHORT: f64 = 0.98;
/// Most postures measured exactly at the end.
const ANSWERS: usize = 8;
/// Radius of the chart, in the cutter's radius: strips are hardly ever wider.
const REACH: f64 = 1.2;
/// Misfit of the chart that is accepted, of the tolerance.
const MISFIT: f64 = 0.01;
/// Postures that the chart's error may have cut short, which are measured exactly; and by how much they must promise to be better.
const PROMISING: usize = 4;
const PROMISE: f64 = 1.02;

/// A search at one place with one tool.
pub(super) struct Search<'a> {
    pub surface: &'a dyn Surface,
    pub at: Uv,
    pub cutter: &'a Cutter,
    pub limits: &'a Limits,
    pub chart: Chart<'a>,
    pub side: f64,
    /// Whether postures are measured by the exact strip.
    exactly: bool,
    /// The strip with the chart's error more, over the strip, of the posture measured last.
    promise: f64,
    pub evaluations: u32,
    pub exact: u32,
    pub last: Option<StripError>,
}

pub(super) type Found = (Posture, Measured);

impl<'a> Search<'a> {
    pub(super) fn new(
        surface: &'a dyn Surface,
        at: Uv,
        cutter: &'a Cutter,
        limits: &'a Limits,
    ) -> Result<Self, Degenerate> {
        let chart = Chart::new(surface, at, REACH * cutter.radius_mm(), MISFIT * limits.scallop_mm)?;
        let side = surface.jet2(at).side.sign();
        Ok(Self {
            surface,
            at,
            cutter,
            limits,
            chart,
            side,
            exactly: false,
            promise: 1.0,
            evaluations: 0,
            exact: 0,
            last: None,
        })
    }

    /// The tool axis of a posture, as `Contact` makes it.
    fn axis(&self, p: &Posture) -> Vec3 {
        let tangent = self.tangent(p.direction_rad);
        let normal = self.chart.forms.normal;
        let left = normal.cross(&tangent);
        let (s, c) = p.lean.tilt_rad.sin_cos();
        let heading = tangent * c + left * s;
        let (s, c) = p.lean.lead_rad.sin_cos();
        normal.into_inner() * c + heading * s
    }

    fn tangent(&self, direction_rad: f64) -> Vec3 {
        let (s, c) = direction_rad.sin_cos();
        let frame = &self.chart.forms.frame;
        frame[0].into_inner() * c + frame[1].into_inner() * (s * self.side)
    }

    fn allowed(&self, p: &Posture) -> bool {
        self.limits.axis.is_none_or(|cone| {
            let axis = self.axis(p);
            // The angle by its half: acos loses digits near zero.
            2.0 * (0.5 * (axis - cone.middle.into_inner()).norm()).min(1.0).asin() <= cone.half_angle_rad
        })
    }

    pub(super) fn measure(&mut self, p: Posture) -> Option<Measured> {
        if !self.allowed(&p) {
            return None;
        }
        self.evaluations += 1;
        self.promise = 1.0;
        let on_chart =
            if self.exactly { Err(ChartError::Beyond { radius_mm: 0.0 }) } else { self.on_chart(&p) };
        let measured = match on_chart {
            Err(ChartError::Beyond { .. }) => {
                self.exact += 1;
                compare(self.surface, self.at, self.cutter, (p, self.chart.is_traced()), self.limits)
            }
            Err(ChartError::Above { standoff_mm }) => {
                Err(StripError::AboveTolerance { standoff_mm, scallop_mm: self.limits.scallop_mm })
            }
            Err(ChartError::Contact(e)) => Err(e.into()),
            Ok((m, promise)) => {
                self.promise = promise;
                Ok(m)
            }
        };
        match measured {
            Ok(m) => Some(m),
            Err(e) => {
                self.last = Some(e);
                None
            }
        }
    }

    /// A posture on the chart, and how much wider the strip were with the chart's error more.
    fn on_chart(&self, p: &Posture) -> Result<(Measured, f64), ChartError> {
        let (limits, cutter) = (self.limits, self.cutter);
        let (cap, _) = limits.caps.greatest_per_tooth();
        let tangent = self.tangent(p.direction_rad);
        let along = self.chart.relative(cutter, p.direction_rad, p.lean).along(&tangent);
        // Waves bend the part within a mark, and a strip that ends at one of them jumps by little more in height.
        let planar = along > 0.0 && along.is_finite() && !self.chart.is_traced();
        let part_per_mm = self.chart.forms.normal_curvature(&tangent);
        let (share, mark) = share_by(along, cap, limits.scallop_mm, |height_mm| {
            if planar {
                Ok(planar_mark_mm(part_per_mm, along, height_mm))
            } else {
                self.chart.mark_mm(cutter, p.direction_rad, p.lean, height_mm)
            }
        })?;
        let within = Within { scallop_mm: share.across_mm(), gouge_mm: limits.gouge_mm };
        let strip = self.chart.strip(cutter, p.direction_rad, p.lean, within)?;
        let rate = limits.caps.rate(strip.width_mm, mark);
        let measured = Measured { lift_mm: strip.lift_mm, undercut_mm: strip.undercut_mm, share, rate };
        Ok((measured, strip.most_mm / strip.width_mm))
    }

    /// Leading order of the productivity: the smaller Q's eigenvalue, the better, to where two contacts begin.
    fn rank(&self, p: &Posture) -> f64 {
        let limits = self.limits;
        let tangent = self.tangent(p.direction_rad);
        let left = self.chart.forms.normal.cross(&tangent);
        let q = self.chart.relative(self.cutter, p.direction_rad, p.lean);
        // Where the part is hollower than the tool the strip saturates near the tool's own size.
        let floor = limits.scallop_mm / (self.cutter.radius_mm() * self.cutter.radius_mm());
        let dip = (-q.min).max(0.0);
        let eased = Relative { min: q.min.max(floor), ..q };
        let width = leading_order_swept(&eased, &left, limits.scallop_mm).unwrap_or(0.0);
        let along = q.along(&tangent).max(floor);
        let mark = if along.is_finite() { 2.0 * (limits.scallop_mm / along).sqrt() } else { f64::INFINITY };
        let (cap, _) = limits.caps.greatest_per_tooth();
        width.min(2.0 * self.cutter.radius_mm()) * mark.min(cap)
            / (1.0 + dip * self.cutter.radius_mm() * 20.0)
    }

    pub fn run(&mut self) -> Option<Found> {
        // At the least lead the strip is usually widest and the leading order fails: all of it is measured.
        let postures = self.least_lead();
        let measured = MEASURED[usize::from(self.chart.is_traced())];
        let mut found = Vec::with_capacity(postures.len() + measured);
        let mut promises: Vec<(Found, f64)> = Vec::with_capacity(postures.len());
        for p in postures {
            match self.measure(p) {
                Some(m) => {
                    found.push((p, m));
                    promises.push(((p, m), self.promise * m.rate.area_mm2_min));
                }
                // The tool dips too deep: two contacts at the lead where it just does not.
                None => found.extend(self.brink_above(p, CLIMBS)),
            }
        }
        let mut ranked = self.grid();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut tried: Vec<Posture> = Vec::with_capacity(6 * measured);
        let enough = found.len() + measured;
        for (p, _) in ranked {
            if p.lean.lead_rad == self.limits.lead.least_rad {
                continue;
            }
            if found.len() >= enough || tried.len() >= 6 * measured {
                break;
            }
            // Not two postures of one neighbourhood.
            if tried.iter().any(|o| near(o, &p)) {
                continue;
            }
            tried.push(p);
            if let Some(m) = self.measure(p) {
                found.push((p, m));
            }
        }
        self.keep_promises(promises, &mut found);
        let entered = distinct(found, ENTERED);
        let first: Vec<Found> = entered.iter().map(|f| self.settle(*f, 0..1)).collect();
        let kept = distinct(first, SETTLED);
        let mut settled: Vec<Found> = kept.into_iter().map(|f| self.settle(f, 1..ROUNDS)).collect();
        // Settling may have led over a brink that lies elsewhere.
        settled.extend(entered);
        let (p, m) = self.best_exactly(settled)?;
        // The search compares planar tooth marks; the answer has the exact one.
        Some((p, measure(self.surface, self.at, self.cutter, p, self.limits).unwrap_or(m)))
    }

    /// The best of what was found on the chart, measured exactly until none of the others can be better.
    fn best_exactly(&mut self, mut found: Vec<Found>) -> Option<Found> {
        // The width's relative error is half the heights' over the tolerance.
        let level = 1.0 - LEVEL - self.chart.error_mm() / self.limits.scallop_mm;
        let mut best: Option<(Found, f64)> = None;
        self.exactly = true;
        found.sort_by(better_first);
        found.dedup_by(|a, b| same(&a.0, &b.0));
        for (p, on_chart) in found.into_iter().take(ANSWERS) {
            let promised = on_chart.rate.area_mm2_min;
            if best.is_some_and(|(b, _)| promised < level * b.1.rate.area_mm2_min) {
                break;
            }
            if let Some(m) = self.measure(p)
                && best.is_none_or(|(b, _)| m.rate.area_mm2_min > b.1.rate.area_mm2_min)
            {
                best = Some(((p, m), promised));
            }
        }
        let (found, promised) = best?;
        let short = found.1.rate.area_mm2_min < SHORT * promised;
        Some(if short { self.refine(found) } else { found })
    }

    /// Measures exactly what may be better than all that was found but for the chart's error.
    fn keep_promises(&mut self, mut promises: Vec<(Found, f64)>, found: &mut Vec<Found>) {
        let best = found.iter().map(|f| f.1.rate.area_mm2_min).fold(0.0, f64::max);
        promises.retain(|p| p.1 > PROMISE * best && p.1 > PROMISE * p.0.1.rate.area_mm2_min);
        promises.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut tried: Vec<Posture> = Vec::with_capacity(PROMISING);
        self.exactly = true;
        for ((p, _), _) in promises {
            if tried.len() < PROMISING && !tried.iter().any(|o| near(o, &p)) {
                tried.push(p);
                found.extend(self.measure(p).map(|m| (p, m)));
            }
        }
        self.exactly = false;
    }

    /// The least lead above an impossible posture that leaves a strip: widest where two contacts just hold.
    pub(super) fn brink_above(&mut self, from: Posture, climbs: u32) -> Option<Found> {
        let lead = self.limits.lead;
        let at_lead = |lead_rad: f64| Posture { lean: Lean { lead_rad, ..from.lean }, ..from };
        let (mut low, mut high) = (from.lean.lead_rad, None);
        // Doubling the climb finds a possible lead, halving the least one.
        let mut climb = 0.04 * lead.width();
        for _ in 0..climbs {
            let next = match high {
                None if low >= lead.most_rad => return None,
                None => lead.clamp(low + climb),
                Some((p, _)) => 0.5 * (low + posture_lead(&p)),
            };
            let p = at_lead(next);
            match self.measure(p) {
                Some(m) => high = Some((p, m)),
                None => low = next,
            }
            climb *= 2.0;
        }
        high
    }

    /// Directions and tilts at the least lead.
    fn least_lead(&self) -> Vec<Posture> {
        let tilt = self.limits.tilt;
        let tilts = if tilt.width() > 0.0 {
            vec![tilt.least_rad, 0.5 * (tilt.least_rad + tilt.most_rad), tilt.most_rad]
        } else {
            vec![tilt.least_rad]
        };
        let directions = DIRECTIONS[usize::from(self.chart.is_traced())];
        (0..directions)
            .flat_map(|k| {
                let direction_rad = TAU * k as f64 / directions as f64;
                let lead_rad = self.limits.lead.least_rad;
                tilts
                    .iter()
                    .map(|tilt_rad| Posture { direction_rad, lean: Lean { lead_rad, tilt_rad: *tilt_rad } })
                    .collect::<Vec<_>>()
            })
            .collect()
    }

    /// A principal direction of the part: these are often the answer.
    fn first_direction(&self) -> f64 {
        let d = SymEigen::of(&self.chart.forms.curvature).d_max;
        d[1].atan2(d[0]) * self.side
    }

    fn grid(&self) -> Vec<(Posture, f64)> {
        let steps = |r: Range, n: usize| -> Vec<f64> {
            if r.width() <= 0.0 {
                vec![r.least_rad]
            } else {
                (0..n).map(|k| r.least_rad + r.width() * k as f64 / (n - 1) as f64).collect()
            }
        };
        // Leads crowd towards the small ones, where the strip is wide.
        let leads: Vec<f64> = steps(self.limits.lead, GRID[1])
            .into_iter()
            .map(|x| {
                let w = self.limits.lead.width();
                if w > 0.0 {
                    let f = (x - self.limits.lead.least_rad) / w;
                    self.limits.lead.least_rad + w * f * f
                } else {
                    x
                }
            })
            .collect();
        let tilts = steps(self.limits.tilt, GRID[2]);
        let mut out = Vec::with_capacity(GRID.iter().product());
        let first = self.first_direction();
        for k in 0..GRID[0] {
            let direction_rad = first + TAU * k as f64 / GRID[0] as f64;
            for lead_rad in &leads {
                for tilt_rad in &tilts {
                    let lean = Lean { lead_rad: *lead_rad, tilt_rad: *tilt_rad };
                    let p = Posture { direction_rad, lean };
                    if self.allowed(&p) {
                        out.push((p, self.rank(&p)));
                    }
                }
            }
        }
        out
    }

    pub fn binding(&self, p: &Posture, m: &Measured) -> Binding {
        let limits = self.limits;
        let close = |x: f64, y: f64, r: Range| (x - y).abs() <= 1e-3 * r.width().max(1e-9);
        let nudged = |by: f64| Posture { lean: Lean { lead_rad: p.lean.lead_rad + by, ..p.lean }, ..*p };
        if m.undercut_mm > 0.5 * limits.gouge_mm {
            Binding::Gouge
        } else if limits.axis.is_some() && !(self.allowed(&nudged(1e-2)) && self.allowed(&nudged(-1e-2))) {
            Binding::AxisCone
        } else if close(p.lean.lead_rad, limits.lead.least_rad, limits.lead) {
            Binding::LeadLeast
        } else if close(p.lean.lead_rad, limits.lead.most_rad, limits.lead) {
            Binding::LeadMost
        } else if limits.tilt.width() > 0.0
            && (close(p.lean.tilt_rad, limits.tilt.least_rad, limits.tilt)
                || close(p.lean.tilt_rad, limits.tilt.most_rad, limits.tilt))
        {
            Binding::Tilt
        } else {
            Binding::Inside
        }
    }
}

fn better_first(a: &Found, b: &Found) -> Ordering {
    b.1.rate.area_mm2_min.total_cmp(&a.1.rate.area_mm2_min)
}

/// The best of each neighbourhood, best first.
fn distinct(mut found: Vec<Found>, most: usize) -> Vec<Found> {
    found.sort_by(better_first);
    let mut best: Vec<Found> = Vec::with_capacity(most);
    for f in found {
        if best.len() < most && !best.iter().any(|b| near(&b.0, &f.0)) {
            best.push(f);
        }
    }
    best
}

fn posture_lead(p: &Posture) -> f64 {
    p.lean.lead_rad
}

/// Whether two postures differ by less than their strips do.
fn same(a: &Posture, b: &Posture) -> bool {
    let turn = (a.direction_rad - b.direction_rad).rem_euclid(TAU);
    turn.min(TAU - turn) < 0.02
        && (a.lean.lead_rad - b.lean.lead_rad).abs() < 5e-3
        && (a.lean.tilt_rad - b.lean.tilt_rad).abs() < 0.02
}

/// Whether two postures share a neighbourhood of the grid.
fn near(a: &Posture, b: &Posture) -> bool {
    let turn = (a.direction_rad - b.direction_rad).rem_euclid(TAU);
    let turn = turn.min(TAU - turn);
    turn < 0.9 * PI / 8.0
        && (a.lean.lead_rad - b.lean.lead_rad).abs() < 0.05
        && (a.lean.tilt_rad - b.lean.tilt_rad).abs() < 0.2
}
