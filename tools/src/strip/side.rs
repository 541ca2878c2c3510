//! The walk across the strip: from the contact to where the standoff exceeds the tolerance, on both sides.

use super::StripError;
use super::knotted::Knotted;
use super::local::{Near, Pace, deepest};
use super::passages::Passages;
use super::undercut::{Place, Undercut};
use crate::contact::Contact;
use crate::cutter::Line;
use crate::sweep::{Reach, SweptMotion};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::roots::{End, RootError, bracketed};
use osculate_geom::{Degenerate, Uv};

/// Crests of the profile that come up to this share of the tolerance are looked at between places.
const SUSPECT: f64 = 0.7;
/// Crossings of two passages between places that are lower than this share of the tolerance do not come up to it.
const LOW: f64 = 0.25;
/// Least way between instants of different passages beyond the way across, of the tool's radius: the first step of the search for the
/// deepest instant.
pub(super) const JUMP: f64 = 0.05;
/// Halvings of a step towards a crossing: what it rises in what is left is a millionth of what it rises in the step.
const HALVINGS: u32 = 20;
/// Most steps of the walk: strips that conform far better than the leading order says are still found.
const MAX_STEPS: u32 = 4000;
/// Rounding in the standoff at the contact itself, relative to the tolerance.
const CLOSED_BAND: f64 = 1e-6;
/// Accuracy of the strip's edge relative to the half width.
const EDGE_TOLERANCE: f64 = 1e-13;
/// What each source of error may have of the error that is accepted.
pub(super) const SHARE: f64 = 0.1;
/// Height above the deepest instant that counts as none, of the tool's radius.
const SETTLED: f64 = 1e-15;

/// What both halves of a strip are walked with.
pub(super) struct Side<'a, M> {
    pub contact: &'a Contact<'a>,
    pub part: &'a Knotted<'a>,
    pub motion: &'a M,
    pub t0: f64,
    pub t_step: f64,
    pub h: f64,
    pub step: f64,
    /// Where the tool comes over the strip more than once.
    pub passages: Option<&'a Passages>,
    /// Error of the width that may be left, of the width.
    pub relative: f64,
}

/// One half of a strip.
pub(super) struct HalfStrip {
    pub edge: f64,
    /// The normal of the part there, and the instant of the contact's own passage.
    at: Line,
    t: f64,
    pub undercut: f64,
    pub error: f64,
    pub at_edge: bool,
}

impl<'a, M: SweptMotion> Side<'a, M> {
    /// Both halves, left first.
    pub fn both(&self) -> Result<[HalfStrip; 2], StripError> {
        Ok([self.walk(1.0)?, self.walk(-1.0)?])
    }

    /// Both halves, by the contact's own passage; None where the tool at another instant comes near the contact or an edge.
    pub fn once(&self, passages: &Passages) -> Result<Option<[HalfStrip; 2]>, StripError> {
        let matter = |line: &Line, t: f64| passages.matter(self.contact.cutter, line, t, self.h);
        let here = Line { origin: self.contact.frame.point, direction: self.contact.frame.normal };
        let first = self.both();
        let again = match &first {
            Ok(sides) => matter(&here, self.t0) || sides.iter().any(|s| matter(&s.at, s.t)),
            Err(StripError::AboveTolerance { .. }) => matter(&here, self.t0),
            Err(_) => false,
        };
        if again { Ok(None) } else { first.map(Some) }
    }

    fn normal(&self, at: Uv) -> Result<Line, Degenerate> {
        let jet = self.contact.surface.jet2(at);
        Ok(Line { origin: jet.point, direction: jet.normal()? })
    }

    pub fn standoff(&self, at: Uv, near: Near) -> Result<Option<(Reach, Near)>, Degenerate> {
        let line = self.normal(at)?;
        let cutter = self.contact.cutter;
        let settled_mm = (SETTLED * cutter.radius_mm()).max(SHARE * self.relative * self.h);
        let pace = Pace { step: self.t_step, settled_mm };
        let found = deepest(cutter, &line, self.motion, near, pace);
        let Some(passages) = self.passages else { return Ok(found) };
        let bound = found.map_or((f64::INFINITY, f64::INFINITY), |f| (f.0.at_mm, f.0.t));
        // The next place is looked at from the contact's own passage on, and from all others.
        let from = found.map_or(near, |f| f.1);
        Ok(passages.deepest(cutter, &line, self.motion, bound).map(|other| (other, from)).or(found))
    }

    /// The cross line `x` further on.
    pub fn advance(&self, here: &GeodesicState, x: f64) -> Result<GeodesicState, Degenerate> {
        self.part.advance(here, x)
    }

    /// Walks from the contact to the left (`sign = 1`) or right until the standoff exceeds the tolerance.
    fn walk(&self, sign: f64) -> Result<HalfStrip, StripError> {
        let surface = self.contact.surface;
        let domain = surface.domain();
        let direction = self.contact.frame.left.into_inner() * sign;
        let mut here = GeodesicState::start(surface, self.contact.at, &direction)?;
        let mut t = Near { t: self.t0, bend: None };
        let mut q = 0.0;
        let first = self.standoff(here.at, t)?;
        let height = first.map_or(f64::INFINITY, |(r, _)| r.at_mm);
        t = first.map_or(t, |(_, near)| near);
        // A tool lifted by just the tolerance still counts: the band is closed.
        if height > self.h * (1.0 + CLOSED_BAND) {
            return Err(StripError::AboveTolerance { standoff_mm: height, scallop_mm: self.h });
        }
        let deepest = first.map_or(self.t0, |(r, _)| r.t);
        let mut undercut = Undercut::new(Place { state: here, t, height, deepest });
        for _ in 0..MAX_STEPS {
            let next = self.advance(&here, self.step)?;
            if !domain.contains(next.at) {
                return self.to_domain_edge(here, q, t, undercut);
            }
            let reach = self.standoff(next.at, t)?;
            match reach {
                Some((r, near)) if r.at_mm <= self.h => {
                    let top = match self.crossing(&undercut, r)? {
                        None => self.crest(&undercut, r.at_mm)?,
                        found => found,
                    };
                    if let Some((from, step, f_out)) = top {
                        let behind = if from.state.at == here.at { 0.0 } else { self.step };
                        let to_crest = Side { step, ..*self };
                        return to_crest.edge(from.state, q - behind, from.t, f_out, undercut);
                    }
                    (t, here, q) = (near, next, q + self.step);
                    undercut.see(Place { state: here, t, height: r.at_mm, deepest: r.t });
                }
                outside => {
                    let f_out = outside.map_or(self.contact.cutter.radius_mm(), |(r, _)| r.at_mm - self.h);
                    return self.edge(here, q, t, f_out, undercut);
                }
            }
        }
        Err(StripError::Edge(RootError::NotConverged { evaluations: MAX_STEPS, residual: q }))
    }

    /// Where the profile exceeds the tolerance between the last place and the next, over which another passage of the tool is the
    /// deepest: at the edge in which the two meet. The place before it, the way there, and the excess.
    fn crossing(&self, seen: &Undercut, next: Reach) -> Result<Option<(Place, f64, f64)>, Degenerate> {
        let Some(a) = seen.last[1] else { return Ok(None) };
        // The instant of one passage moves by about the way across, `t_step` being JUMP of the tool's radius.
        let least = JUMP * self.contact.cutter.radius_mm();
        let jumps = |from: f64, to: f64, way: f64| (to - from).abs() > self.t_step * (1.0 + way / least);
        let high = a.height.max(next.at_mm) > LOW * self.h;
        if self.passages.is_none() || !high || !jumps(a.deepest, next.t, self.step) {
            return Ok(None);
        }
        let (mut near, mut far) = ((0.0, a.deepest), (self.step, next.t));
        for _ in 0..HALVINGS {
            let x = 0.5 * (near.0 + far.0);
            let place = self.advance(&a.state, x)?.at;
            let Some((r, _)) = self.standoff(place, a.t)? else { return Ok(None) };
            if r.at_mm > self.h {
                return Ok(Some((a, x, r.at_mm - self.h)));
            }
            *(if (r.t - near.1).abs() < (far.1 - r.t).abs() { &mut near } else { &mut far }) = (x, r.t);
            if !jumps(near.1, far.1, far.0 - near.0) {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// Where the profile exceeds the tolerance between places that do not: the crest of the parabola through the last two
    /// and the next. The place before it, the way there, and the excess.
    fn crest(&self, seen: &Undercut, next: f64) -> Result<Option<(Place, f64, f64)>, Degenerate> {
        let [Some(a), Some(b)] = seen.last else { return Ok(None) };
        let (bend, slope) = (0.5 * (a.height + next) - b.height, 0.5 * (next - a.height));
        let at = -0.5 * slope / bend;
        let top = b.height + 0.5 * slope * at;
        if !(bend < 0.0 && at.abs() < 1.0 && top > SUSPECT * self.h) {
            return Ok(None);
        }
        let (from, step) = if at < 0.0 { (a, (1.0 + at) * self.step) } else { (b, at * self.step) };
        let place = self.advance(&from.state, step)?.at;
        let height = self.standoff(place, from.t)?.map_or(f64::INFINITY, |(r, _)| r.at_mm);
        let f_out = (height - self.h).min(self.contact.cutter.radius_mm());
        Ok((f_out > 0.0).then_some((from, step, f_out)))
    }

    /// The edge of the strip between `here` (inside, at arc length `q`) and one step further (outside).
    fn edge(
        &self,
        here: GeodesicState,
        q: f64,
        t: Near,
        f_out: f64,
        undercut: Undercut,
    ) -> Result<HalfStrip, StripError> {
        // The profile is nearly a parabola: its root less that of the tolerance is nearly straight. Taken as a quotient, so that
        // nothing cancels at the edge.
        let straight = |excess: f64| {
            let (root, f) = (self.h.sqrt(), excess + self.h);
            if f > 0.0 { excess / (f.sqrt() + root) } else { -(-f).sqrt() - root }
        };
        let excess = |x: f64| -> f64 {
            let Ok(s) = self.advance(&here, x) else { return f64::NAN };
            match self.standoff(s.at, t) {
                Ok(Some((r, _))) => straight(r.at_mm - self.h),
                Ok(None) => straight(self.contact.cutter.radius_mm()),
                Err(_) => f64::NAN,
            }
        };
        let root = bracketed(
            End { x: 0.0, f: excess(0.0).min(0.0) },
            End { x: self.step, f: straight(f_out) },
            EDGE_TOLERANCE.max(SHARE * self.relative) * (q + self.step),
            excess,
        )?;
        Ok(HalfStrip {
            edge: q + root.x,
            at: self.normal(self.advance(&here, root.x)?.at)?,
            t: t.t,
            undercut: self.deepest(&undercut)?,
            error: root.error + self.integration_error(here, q + root.x)?,
            at_edge: false,
        })
    }

    /// The strip goes on to the edge of the surface's rectangle.
    fn to_domain_edge(
        &self,
        here: GeodesicState,
        q: f64,
        t: Near,
        undercut: Undercut,
    ) -> Result<HalfStrip, StripError> {
        let surface = self.contact.surface;
        let domain = surface.domain();
        let (mut lo, mut hi) = (0.0, self.step);
        // Bisection of a yes-or-no question to the last bits of the step.
        for _ in 0..50 {
            let mid = 0.5 * (lo + hi);
            if domain.contains(self.advance(&here, mid)?.at) { lo = mid } else { hi = mid }
        }
        let end = self.advance(&here, lo)?;
        match self.standoff(end.at, t)? {
            Some((r, _)) if r.at_mm <= self.h => {
                let mut undercut = undercut;
                undercut.lowest = undercut.lowest.min(r.at_mm);
                let error = hi - lo + self.integration_error(here, q + lo)?;
                let at = self.normal(end.at)?;
                Ok(HalfStrip {
                    edge: q + lo,
                    at,
                    t: t.t,
                    undercut: self.deepest(&undercut)?,
                    error,
                    at_edge: true,
                })
            }
            outside => {
                let f_out = outside.map_or(self.contact.cutter.radius_mm(), |(r, _)| r.at_mm - self.h);
                let shorter = Side { step: lo, ..*self };
                shorter.edge(here, q, t, f_out, undercut)
            }
        }
    }

    /// Depth below the part of what a walk has seen.
    fn deepest(&self, seen: &Undercut) -> Result<f64, Degenerate> {
        seen.deepest(self.step, SHARE * self.relative.sqrt(), |from, x| {
            let at = self.advance(&from.state, x)?.at;
            Ok(self.standoff(at, from.t)?.map_or(f64::INFINITY, |(r, _)| r.at_mm))
        })
    }

    /// Integration error of the cross line after `q`: the last step whole against two halves, for every step walked.
    fn integration_error(&self, here: GeodesicState, q: f64) -> Result<f64, Degenerate> {
        let surface = self.contact.surface;
        let one = self.advance(&here, self.step)?;
        let middle = self.advance(&here, 0.5 * self.step)?;
        let two = self.advance(&middle, 0.5 * self.step)?;
        let jet = surface.jet2(one.at);
        let off = (jet.tangent(Uv { u: one.at.u - two.at.u, v: one.at.v - two.at.v })).norm();
        Ok(off * (1.0 + q / self.step))
    }
}
