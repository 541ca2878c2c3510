//! The search for the best posture: a ranked grid, the brink of two contacts, coordinate searches.

use super::{Binding, Limits, Measured, Posture, Range, compare, measure};
use crate::closed_form::leading_order_swept;
use osculate_geom::{Forms, Relative, Surface, SymEigen, Unit3, Uv, Vec3};
use osculate_tools::strip::StripError;
use osculate_tools::{Cutter, Lean};
use std::f64::consts::{PI, TAU};

/// Directions, leads and tilts of the grid that is ranked.
const GRID: [usize; 3] = [16, 7, 5];
/// Postures of the grid above the least lead that are measured exactly, and how many of all are settled.
const MEASURED: usize = 6;
const SETTLED: usize = 2;
/// Leads tried above an impossible one in the first look, and in each round of settling.
const CLIMBS: u32 = 6;
const BRINK: u32 = 7;
/// Rounds of coordinate searches; steps shrink in each.
const ROUNDS: u32 = 4;
const SHRINK: f64 = 0.35;

/// A search at one place with one tool.
pub(super) struct Search<'a> {
    pub surface: &'a dyn Surface,
    pub at: Uv,
    pub cutter: &'a Cutter,
    pub limits: &'a Limits,
    pub forms: &'a Forms,
    pub evaluations: u32,
    pub last: Option<StripError>,
}

type Found = (Posture, Measured);

impl Search<'_> {
    /// The tool axis of a posture, as `Contact` makes it.
    fn axis(&self, p: &Posture) -> Vec3 {
        let tangent = self.tangent(p.direction_rad);
        let left = self.forms.normal.cross(&tangent);
        let (s, c) = p.lean.tilt_rad.sin_cos();
        let heading = tangent * c + left * s;
        let (s, c) = p.lean.lead_rad.sin_cos();
        self.forms.normal.into_inner() * c + heading * s
    }

    fn tangent(&self, direction_rad: f64) -> Vec3 {
        let side = self.surface.jet2(self.at).side.sign();
        let (s, c) = direction_rad.sin_cos();
        self.forms.frame[0].into_inner() * c + self.forms.frame[1].into_inner() * (s * side)
    }

    fn allowed(&self, p: &Posture) -> bool {
        self.limits.axis.is_none_or(|cone| {
            let axis = self.axis(p);
            // The angle by its half: acos loses digits near zero.
            2.0 * (0.5 * (axis - cone.middle.into_inner()).norm()).min(1.0).asin() <= cone.half_angle_rad
        })
    }

    fn measure(&mut self, p: Posture) -> Option<Measured> {
        if !self.allowed(&p) {
            return None;
        }
        self.evaluations += 1;
        match compare(self.surface, self.at, self.cutter, p, self.limits) {
            Ok(m) => Some(m),
            Err(e) => {
                self.last = Some(e);
                None
            }
        }
    }

    /// Leading order of the productivity: the smaller Q's eigenvalue, the better, to where two contacts begin.
    fn rank(&self, p: &Posture) -> f64 {
        let limits = self.limits;
        let tangent = self.tangent(p.direction_rad);
        let left = Unit3::new_unchecked(self.forms.normal.cross(&tangent));
        let frame = osculate_geom::Darboux {
            point: osculate_geom::Point3::origin(),
            tangent: Unit3::new_unchecked(tangent),
            left,
            normal: self.forms.normal,
            turn: Vec3::zeros(),
        };
        let q = Relative::new(self.forms, &p.lean.tool_curvature(self.cutter, &frame));
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
        let mut ranked = self.grid();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut tried: Vec<Posture> = Vec::with_capacity(6 * MEASURED);
        // At the least lead the strip is usually widest and the leading order fails: all of it is measured.
        let mut found = Vec::with_capacity(4 * GRID[0]);
        for p in self.least_lead() {
            match self.measure(p) {
                Some(m) => found.push((p, m)),
                // The tool dips too deep: two contacts at the lead where it just does not.
                None => found.extend(self.brink_above(p, CLIMBS)),
            }
        }
        let enough = found.len() + MEASURED;
        for (p, _) in ranked {
            if p.lean.lead_rad == self.limits.lead.least_rad {
                continue;
            }
            if found.len() >= enough || tried.len() >= 6 * MEASURED {
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
        found.sort_by(|a, b| b.1.rate.area_mm2_min.total_cmp(&a.1.rate.area_mm2_min));
        found.truncate(SETTLED);
        found
            .into_iter()
            .map(|f| self.settle(f))
            .max_by(|a, b| a.1.rate.area_mm2_min.total_cmp(&b.1.rate.area_mm2_min))
            .and_then(|(p, _)| Some((p, measure(self.surface, self.at, self.cutter, p, self.limits).ok()?)))
    }

    /// The least lead above an impossible posture that leaves a strip: widest where two contacts just hold.
    fn brink_above(&mut self, from: Posture, climbs: u32) -> Option<Found> {
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
        let first = self.first_direction();
        (0..GRID[0])
            .flat_map(|k| {
                let direction_rad = first + TAU * k as f64 / GRID[0] as f64;
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
        let d = SymEigen::of(&self.forms.curvature).d_max;
        d[1].atan2(d[0]) * self.surface.jet2(self.at).side.sign()
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

    /// Coordinate searches with shrinking steps, a parabola through three values in each.
    fn settle(&mut self, from: Found) -> Found {
        let mut best = from;
        let limits = self.limits;
        let mut step = [
            0.5 * TAU / GRID[0] as f64,
            limits.lead.width() / (GRID[1] - 1) as f64,
            0.5 * limits.tilt.width() / (GRID[2] - 1) as f64,
        ];
        for _ in 0..ROUNDS {
            for (k, s) in step.iter().enumerate() {
                if *s > 0.0 {
                    best = self.along(best, k, *s);
                }
            }
            // Turning the feed under a tool that keeps its heading: the valley of the strip's width.
            if limits.tilt.width() > 0.0 {
                best = self.along(best, 3, step[0]);
            }
            step = step.map(|s| s * SHRINK);
        }
        best
    }

    fn moved(&self, p: &Posture, coordinate: usize, by: f64) -> Posture {
        let mut q = *p;
        match coordinate {
            0 => q.direction_rad += by,
            1 => q.lean.lead_rad = self.limits.lead.clamp(p.lean.lead_rad + by),
            2 => q.lean.tilt_rad = self.limits.tilt.clamp(p.lean.tilt_rad + by),
            _ => {
                q.lean.tilt_rad = self.limits.tilt.clamp(p.lean.tilt_rad - by);
                q.direction_rad += p.lean.tilt_rad - q.lean.tilt_rad;
            }
        }
        q
    }

    fn along(&mut self, from: Found, coordinate: usize, step: f64) -> Found {
        let value = |f: Option<Measured>| f.map_or(0.0, |m| m.rate.area_mm2_min);
        let better = |a: Found, p: Posture, m: Option<Measured>| match m {
            Some(m) if m.rate.area_mm2_min > a.1.rate.area_mm2_min => (p, m),
            _ => a,
        };
        let (pa, pb) = (self.moved(&from.0, coordinate, -step), self.moved(&from.0, coordinate, step));
        let (a, b) = (self.measure(pa), self.measure(pb));
        let mut best = better(better(from, pa, a), pb, b);
        if coordinate == 1 && a.is_none() {
            let brink = self.brink_above(pa, BRINK);
            best = brink.map_or(best, |(p, m)| better(best, p, Some(m)));
        }
        let (fa, f0, fb) = (value(a), from.1.rate.area_mm2_min, value(b));
        let bend = fa - 2.0 * f0 + fb;
        let to = if bend < 0.0 { 0.5 * step * (fa - fb) / bend } else { 0.0 };
        if to != 0.0 && to.abs() < 2.0 * step {
            let p = self.moved(&from.0, coordinate, to);
            let m = self.measure(p);
            best = better(best, p, m);
        }
        best
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

fn posture_lead(p: &Posture) -> f64 {
    p.lean.lead_rad
}

/// Whether two postures share a neighbourhood of the grid.
fn near(a: &Posture, b: &Posture) -> bool {
    let turn = (a.direction_rad - b.direction_rad).rem_euclid(TAU);
    let turn = turn.min(TAU - turn);
    turn < 0.9 * PI / 8.0
        && (a.lean.lead_rad - b.lean.lead_rad).abs() < 0.05
        && (a.lean.tilt_rad - b.lean.tilt_rad).abs() < 0.2
}
