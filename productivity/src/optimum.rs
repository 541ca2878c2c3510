//! The posture of greatest productivity at a point: tool, direction of feed, lead, tilt and split of the tolerance.
//!
//! What is made greatest is the area per minute of [`Rate`]: the exact strip ([`strip::exact`]) times the feed that tooth
//! marks ([`strip::mark`]), cutter and machine allow. To leading order the strip is widest across the eigenvector of Q's
//! larger eigenvalue, and wider the nearer Q comes to losing its definiteness; there the leading order fails and the
//! exact strip takes over, with two contacts on hollow places [M86, 5C]: where the tool would dip below the part by more
//! than is accepted it is lifted by the rest.
//!
//! The search ranks a grid of postures by their leading order, measures the best of each neighbourhood exactly and
//! settles the best few by coordinate searches. It is a heuristic with a measured miss, not a proof.

use crate::closed_form::{Section, leading_order_swept, width_37};
use crate::rate::{Caps, CapsError, Rate, Share};
use crate::split::leading_share;
use osculate_geom::{Degenerate, Forms, Relative, Surface, SymEigen, Unit3, Uv, Vec3};
use osculate_tools::strip::{self, StripError};
use osculate_tools::{Contact, Cutter, FeedLine, Lean};
use std::f64::consts::{PI, TAU};

/// A range of an angle, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least.
    pub least_rad: f64,
    /// Greatest.
    pub most_rad: f64,
}

impl Range {
    /// The single value.
    #[must_use]
    pub const fn only(value_rad: f64) -> Self {
        Self { least_rad: value_rad, most_rad: value_rad }
    }

    fn clamp(self, x: f64) -> f64 {
        x.clamp(self.least_rad, self.most_rad)
    }

    fn width(self) -> f64 {
        self.most_rad - self.least_rad
    }

    fn valid(self) -> bool {
        self.least_rad.is_finite() && self.most_rad.is_finite() && self.least_rad <= self.most_rad
    }
}

/// Directions that the tool axis may take: a cone that keeps the holder off its surroundings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisCone {
    /// Its middle.
    pub middle: Unit3,
    /// Half angle, rad.
    pub half_angle_rad: f64,
}

/// What a posture must keep to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Height of material that may be left, mm.
    pub scallop_mm: f64,
    /// Deepest undercut accepted, mm.
    pub gouge_mm: f64,
    /// Lead.
    pub lead: Range,
    /// Tilt.
    pub tilt: Range,
    /// Axis directions; None: all.
    pub axis: Option<AxisCone>,
    /// Feed and spindle.
    pub caps: Caps,
}

/// What keeps the best posture from being better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Nothing but the surface and the tool: the maximum lies inside all ranges.
    Inside,
    /// The least lead.
    LeadLeast,
    /// The greatest lead.
    LeadMost,
    /// An end of the tilt's range.
    Tilt,
    /// The accepted undercut: the tool dips between two contacts.
    Gouge,
    /// The cone of axis directions.
    AxisCone,
}

/// The best posture found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimum {
    /// Index of the tool in the list.
    pub tool: usize,
    /// Feed direction from S_u towards S_v, rad.
    pub direction_rad: f64,
    /// Lead and tilt.
    pub lean: Lean,
    /// Height of the tool above contact along n, mm: above zero where it would dip too deep.
    pub lift_mm: f64,
    /// Share of the tolerance for tooth marks.
    pub share: Share,
    /// Feed, strip and area per minute.
    pub rate: Rate,
    /// Undercut after the lift, mm.
    pub undercut_mm: f64,
    /// What binds the posture.
    pub binding: Binding,
    /// Exact postures measured.
    pub evaluations: u32,
}

/// Why there is no posture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OptimumError {
    /// No tools to choose from.
    #[error("the list of tools is empty")]
    NoTools,
    /// A limit that is none.
    #[error("{what} must be finite, with the least not above the most, got {least} and {most}")]
    Range {
        /// Which.
        what: &'static str,
        /// Least.
        least: f64,
        /// Most.
        most: f64,
    },
    /// Unusable caps.
    #[error(transparent)]
    Caps(#[from] CapsError),
    /// No tangent plane.
    #[error(transparent)]
    Degenerate(#[from] Degenerate),
    /// No posture of any tool leaves a strip; the last reason.
    #[error("no posture of any tool leaves a strip at u = {}, v = {}: {last}", at.u, at.v)]
    None {
        /// Where.
        at: Uv,
        /// Why the last posture tried has none.
        last: StripError,
    },
}

/// One posture measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Height above contact, mm.
    pub lift_mm: f64,
    /// Undercut after the lift, mm.
    pub undercut_mm: f64,
    /// Share of the tolerance.
    pub share: Share,
    /// Productivity.
    pub rate: Rate,
}

/// A direction of feed and a lean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posture {
    /// Feed direction from S_u towards S_v, rad.
    pub direction_rad: f64,
    /// Lead and tilt.
    pub lean: Lean,
}

/// The exact productivity of one posture within the limits; the lift makes the undercut acceptable.
///
/// # Errors
/// [`StripError`] where the posture leaves no strip within the tolerance.
pub fn measure(
    surface: &dyn Surface,
    at: Uv,
    cutter: &Cutter,
    posture: Posture,
    limits: &Limits,
) -> Result<Measured, StripError> {
    let contact = Contact::new(surface, at, cutter, FeedLine::Angle(posture.direction_rad), posture.lean)?;
    let (cap, _) = limits.caps.greatest_per_tooth();
    let share = share_of(&contact, cap, limits.scallop_mm, |c, h| strip::mark(c, h).map(|m| m.length_mm()))?;
    measure_contact(&contact, share, limits)
}

/// As [`measure`] with the planar closed form of the tooth mark: what the search compares.
fn compare(
    surface: &dyn Surface,
    at: Uv,
    cutter: &Cutter,
    posture: Posture,
    limits: &Limits,
) -> Result<Measured, StripError> {
    let contact = Contact::new(surface, at, cutter, FeedLine::Angle(posture.direction_rad), posture.lean)?;
    let along = contact.relative().along(&contact.frame.tangent);
    if !(along > 0.0 && along.is_finite()) {
        return measure(surface, at, cutter, posture, limits);
    }
    let (cap, _) = limits.caps.greatest_per_tooth();
    let part_per_mm = contact.forms.normal_curvature(&contact.frame.tangent);
    let planar = |_: &Contact<'_>, scallop_mm: f64| {
        let section = Section { part_per_mm, tool_per_mm: along - part_per_mm, scallop_mm };
        Ok(width_37(section).unwrap_or_else(|_| 2.0 * (2.0 * scallop_mm / along).sqrt()))
    };
    let share = share_of(&contact, cap, limits.scallop_mm, planar)?;
    measure_contact(&contact, share, limits)
}

fn measure_contact(
    contact: &Contact<'_>,
    (share, mark_mm): (Share, f64),
    limits: &Limits,
) -> Result<Measured, StripError> {
    let mut lift_mm = 0.0;
    let mut strip = strip::exact(contact, share.across_mm())?;
    if strip.undercut_mm > limits.gouge_mm {
        // The lift moves along one normal, the dip is a little off it: once more takes out what is left.
        for _ in 0..2 {
            lift_mm += strip.undercut_mm - limits.gouge_mm;
            strip = strip::exact(&contact.lifted(lift_mm), share.across_mm())?;
            if strip.undercut_mm <= limits.gouge_mm * (1.0 + 1e-3) {
                break;
            }
        }
    }
    let rate = limits.caps.rate(strip.width_mm, mark_mm);
    Ok(Measured { lift_mm, undercut_mm: strip.undercut_mm, share, rate })
}

/// The smallest share whose tooth mark reaches the cap, or the half that is best without a cap; and the mark.
fn share_of(
    contact: &Contact<'_>,
    cap_mm: f64,
    tolerance_mm: f64,
    mark_of: impl Fn(&Contact<'_>, f64) -> Result<f64, StripError>,
) -> Result<(Share, f64), StripError> {
    /// Least share looked at: below it the strip gains less than the fourth digit.
    const LEAST: f64 = 1e-4;
    /// Marks grow between the first power (a sharp edge) and the root of the height.
    const POWERS: u32 = 4;
    let along = contact.relative().along(&contact.frame.tangent);
    let start = if along.is_finite() { leading_share(along, cap_mm, tolerance_mm) } else { 0.25 };
    let mut share = Share { tolerance_mm, chi: start.clamp(LEAST, 0.5) };
    let mut mark = mark_of(contact, share.along_mm())?;
    for _ in 0..POWERS {
        let enough = mark >= cap_mm * (1.0 - 1e-6);
        let settled = if enough { mark <= cap_mm * 1.02 || share.chi <= LEAST } else { share.chi >= 0.5 };
        if settled {
            break;
        }
        let power = if along.is_finite() { 2.0 } else { 1.0 };
        // A touch more than the power law says, so that the next mark reaches the cap.
        share.chi = (share.chi * (cap_mm / mark).powf(power) * 1.01).clamp(LEAST, 0.5);
        mark = mark_of(contact, share.along_mm())?;
    }
    Ok((share, mark))
}

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

/// The best posture of the best tool at a point.
///
/// # Errors
/// [`OptimumError`].
pub fn at(surface: &dyn Surface, at: Uv, tools: &[Cutter], limits: &Limits) -> Result<Optimum, OptimumError> {
    check(tools, limits)?;
    let forms = surface.jet2(at).forms()?;
    let mut best: Option<Optimum> = None;
    let mut last = StripError::Tolerance { got: limits.scallop_mm };
    for (tool, cutter) in tools.iter().enumerate() {
        let mut search = Search { surface, at, cutter, limits, forms: &forms, evaluations: 0, last: None };
        if let Some((posture, m)) = search.run() {
            let better = best.is_none_or(|b| m.rate.area_mm2_min > b.rate.area_mm2_min);
            if better {
                best = Some(Optimum {
                    tool,
                    direction_rad: posture.direction_rad.rem_euclid(TAU),
                    lean: posture.lean,
                    lift_mm: m.lift_mm,
                    share: m.share,
                    rate: m.rate,
                    undercut_mm: m.undercut_mm,
                    binding: search.binding(&posture, &m),
                    evaluations: search.evaluations,
                });
            }
        }
        last = search.last.unwrap_or(last);
    }
    best.ok_or(OptimumError::None { at, last })
}

fn check(tools: &[Cutter], limits: &Limits) -> Result<(), OptimumError> {
    if tools.is_empty() {
        return Err(OptimumError::NoTools);
    }
    limits.caps.checked()?;
    for (what, r) in [("lead", limits.lead), ("tilt", limits.tilt)] {
        if !r.valid() {
            return Err(OptimumError::Range { what, least: r.least_rad, most: r.most_rad });
        }
    }
    for (what, x) in [("scallop_mm", limits.scallop_mm), ("gouge_mm", limits.gouge_mm)] {
        if !(x.is_finite() && x > 0.0) {
            return Err(OptimumError::Range { what, least: x, most: f64::INFINITY });
        }
    }
    Ok(())
}

struct Search<'a> {
    surface: &'a dyn Surface,
    at: Uv,
    cutter: &'a Cutter,
    limits: &'a Limits,
    forms: &'a Forms,
    evaluations: u32,
    last: Option<StripError>,
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

    fn run(&mut self) -> Option<Found> {
        let mut ranked = self.grid();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut tried: Vec<Posture> = Vec::with_capacity(6 * MEASURED);
        // At the least lead the strip is usually widest and the leading order fails: all of it is measured.
        let mut found: Vec<Found> =
            self.least_lead().into_iter().filter_map(|p| Some((p, self.measure(p)?))).collect();
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
    fn to_the_brink(&mut self, from: Posture, climbs: u32) -> Option<Found> {
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
            let brink = self.to_the_brink(pa, BRINK);
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

    fn binding(&self, p: &Posture, m: &Measured) -> Binding {
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
