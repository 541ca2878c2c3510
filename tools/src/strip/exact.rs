//! Exact strip width at one contact.

use super::ContactMotion;
use super::local::{LocalMotion, Near, Pace, deepest};
use super::passages::Passages;
use super::traced::Traced;
use super::undercut::{Place, Undercut};
use crate::contact::{Contact, ContactError, ContactLine};
use crate::cutter::{Cutter, Line};
use crate::sweep::{Reach, SweptMotion, reach_from};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::line::SurfaceLine;
use osculate_geom::roots::{End, RootError, bracketed};
use osculate_geom::{Axis, Degenerate, Surface, Uv};

/// The strip left at a contact. Lengths are arc lengths on the part across the feed, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// `left_mm + right_mm`.
    pub width_mm: f64,
    /// From the contact to the edge on the left of the feed (towards `n x t`).
    pub left_mm: f64,
    /// From the contact to the edge on the right of the feed.
    pub right_mm: f64,
    /// How deep the swept tool goes below the part inside the strip; zero where it does not.
    pub undercut_mm: f64,
    /// Estimate of the numerical error of `width_mm`: root brackets, integration of the cross line, rounding of
    /// coordinates.
    pub error_mm: f64,
    /// Whether the strip ends at an edge of the surface rather than at the tolerance: `[left, right]`.
    pub at_edge: [bool; 2],
}

/// Why there is no strip.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StripError {
    /// The contact itself is not possible.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A tolerance that is not positive and finite.
    #[error("scallop_mm must be positive and finite, got {got}")]
    Tolerance {
        /// The value, mm.
        got: f64,
    },
    /// The tool stands off by more than the tolerance at the contact itself.
    #[error(
        "at the contact the tool stands {standoff_mm} mm above the part, more than the tolerance {scallop_mm} mm: lower lift_mm"
    )]
    AboveTolerance {
        /// Standoff at the contact, mm; infinite where the tool does not pass over it.
        standoff_mm: f64,
        /// The tolerance, mm.
        scallop_mm: f64,
    },
    /// The tool, elsewhere on its way, comes over the contact too deep.
    #[error(
        "the tool's far side goes {dip_mm:.4} mm below the part at the contact, more than the {deepest_mm:.4} mm \
         accepted: use a larger lead or a smaller tool"
    )]
    TooDeep {
        /// Depth, mm.
        dip_mm: f64,
        /// Greatest depth accepted, mm.
        deepest_mm: f64,
    },
    /// The cross line could not be followed.
    #[error(transparent)]
    Degenerate(#[from] Degenerate),
    /// The edge of the strip did not converge.
    #[error("the edge of the strip did not converge: {0}")]
    Edge(#[from] RootError),
}

/// Height of the swept tool above a surface point along its outward normal, mm (negative: below), and the motion
/// parameter at which the tool is deepest there, searched from `guess` outward in steps of `step`.
///
/// None where the tool does not pass over the point.
///
/// # Errors
/// [`Degenerate`] where the point has no normal.
pub fn standoff(
    cutter: &Cutter,
    surface: &dyn Surface,
    at: Uv,
    motion: &impl SweptMotion,
    guess: f64,
    step: f64,
) -> Result<Option<Reach>, Degenerate> {
    let jet = surface.jet2(at);
    let line = Line { origin: jet.point, direction: jet.normal()? };
    Ok(reach_from(cutter, &line, motion, guess, step))
}

/// Steps in which a side of the strip is walked before its edge is bracketed; the profile between the contact and
/// the edge is watched for undercut at these places.
const STEPS_PER_SIDE: f64 = 6.0;
/// Instants, a twentieth of the tool's radius apart, that are looked at to each side of the contact.
const NEARBY: i32 = 20;
/// Crests of the profile that come up to this share of the tolerance are looked at between places.
const SUSPECT: f64 = 0.7;
/// Most steps of the walk: strips that conform far better than the leading order says are still found.
const MAX_STEPS: u32 = 4000;
/// Rounding in the standoff at the contact itself, relative to the tolerance.
const CLOSED_BAND: f64 = 1e-6;
/// Knots that a step may meet one after the other.
const MOST_KNOTS: u32 = 4;
/// How near a knot a state is taken to be on it, of the step: what a kink that near does is of its cube.
const KNOT_FOUND: f64 = 1e-6;
const KNOT_SLACK: f64 = 1e-5;
/// Cuts of a step of the cross line over a knot that is not found: the error falls with their cube.
const CUTS: u32 = 16;
/// Accuracy of the strip's edge relative to the half width.
const EDGE_TOLERANCE: f64 = 1e-13;

/// What each source of error may have of the error that is accepted.
pub(super) const SHARE: f64 = 0.1;
/// Height above the deepest instant that counts as none, of the tool's radius.
const SETTLED: f64 = 1e-15;
/// Half the length of a piece of motion that is fitted at once, in leading-order half widths.
const MOTION_PIECE: f64 = 1.0;
/// Disagreement accepted of a fitted piece, relative to the tolerance: the strip's edge moves by half as much,
/// relative to its width.
const MOTION_TOLERANCE: f64 = 2e-9;

/// The exact strip at a contact for the tolerance `scallop_mm`.
///
/// The tool may undercut (Q need not be definite): then `undercut_mm` says how deep.
///
/// # Errors
/// [`StripError`].
pub fn exact(contact: &Contact<'_>, scallop_mm: f64) -> Result<Strip, StripError> {
    exact_to(contact, scallop_mm, Demand { deepest_mm: f64::INFINITY, relative: 0.0 })
}

/// How much is asked of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Where another passage of the tool goes deeper than this below the contact there is no answer, mm.
    pub deepest_mm: f64,
    /// Error of the width that may be left, of the width; zero: down to rounding.
    pub relative: f64,
}

/// As [`exact`], only as far and as well as is asked for.
///
/// # Errors
/// [`StripError`], with [`StripError::TooDeep`] at once where the demand says so.
pub fn exact_to(contact: &Contact<'_>, scallop_mm: f64, demand: Demand) -> Result<Strip, StripError> {
    if !(scallop_mm > 0.0 && scallop_mm.is_finite()) {
        return Err(StripError::Tolerance { got: scallop_mm });
    }
    let (feed_line, t0) = contact.line()?;
    let traced = match &feed_line {
        ContactLine::Geodesic(line) => Some(Traced::new(contact, line)?),
        ContactLine::Iso(_) => None,
    };
    let motion = ContactMotion {
        line: traced.as_ref().map_or(&feed_line as &dyn SurfaceLine, |t| t),
        cutter: contact.cutter,
        lean: contact.lean,
        lift_mm: contact.lift_mm,
    };
    let radius = contact.cutter.radius_mm();
    let speed = motion.at(t0).map_or(1.0, |m| m.tip_rate.norm().max(1e-12));
    let across = contact.relative().along(&contact.frame.left);
    let h = scallop_mm;
    // Leading-order half width where Q allows it, a fraction of the tool elsewhere.
    let half = if across.is_finite() && across > 0.0 { (2.0 * h / across).sqrt() } else { 0.1 * radius };
    let contact_speed = speed_of_contact(&motion, t0, speed);
    let misfit = MOTION_TOLERANCE.max(SHARE * demand.relative) * h;
    let reach = [radius, misfit + 8.0 * f64::EPSILON * contact.frame.point.coords.amax()];
    let local = LocalMotion::new(&motion, t0, MOTION_PIECE * half.min(radius) / contact_speed, reach);
    let side = Side {
        contact,
        motion: &local,
        t0,
        t_step: 0.05 * radius / contact_speed,
        h,
        step: (half.min(radius) / STEPS_PER_SIDE).min(4.0 * contact.step_mm()),
        breaks: [contact.surface.breaks(Axis::U), contact.surface.breaks(Axis::V)],
        passages: None,
        relative: demand.relative,
    };
    let passages = |fine: bool| Passages::new(contact, &motion, (t0, contact_speed), fine);
    let seldom = passages(false);
    let here = Line { origin: contact.frame.point, direction: contact.frame.normal };
    let dip_mm = -seldom.lowest_mm(contact.cutter, &here);
    if dip_mm > demand.deepest_mm {
        return Err(StripError::TooDeep { dip_mm, deepest_mm: demand.deepest_mm });
    }
    let [left, right] = match side.once(&seldom)? {
        Some(sides) => sides,
        None => Side { passages: Some(&passages(true)), ..side }.both()?,
    };
    // Heights carry the rounding of coordinates; near its edge the profile rises by 2 h over the half width.
    let size = contact.frame.point.coords.amax() + radius;
    let height_error = 4.0 * f64::EPSILON * size + local.error_mm();
    let rounding = height_error * (left.edge + right.edge) / (2.0 * h);
    Ok(Strip {
        width_mm: left.edge + right.edge,
        left_mm: left.edge,
        right_mm: right.edge,
        undercut_mm: left.undercut.max(right.undercut),
        error_mm: left.error + right.error + rounding,
        at_edge: [left.at_edge, right.at_edge],
    })
}

/// Millimetres per unit of the motion parameter, from a finite step: the tip itself may stand still.
fn speed_of_contact(motion: &ContactMotion<'_>, t0: f64, fallback: f64) -> f64 {
    motion.line.frame(t0).map_or(fallback, |(_, speed)| speed.abs().max(1e-12))
}

pub(super) struct Side<'a, M> {
    contact: &'a Contact<'a>,
    motion: &'a M,
    t0: f64,
    t_step: f64,
    h: f64,
    pub step: f64,
    /// Where the surface is less smooth, along u and along v.
    breaks: [Vec<f64>; 2],
    /// Where the tool comes over the strip more than once.
    passages: Option<&'a Passages>,
    /// Error of the width that may be left, of the width.
    pub relative: f64,
}

/// The state on a knot within a step of length `x`, and the way there; None where Newton's method does not find it.
fn on_knot(
    surface: &dyn Surface,
    from: &GeodesicState,
    (axis, knot): (Axis, f64),
    x: f64,
) -> Result<Option<(GeodesicState, f64)>, Degenerate> {
    let mut way = (knot - from.at.get(axis)) / from.rate.get(axis);
    for _ in 0..4 {
        if !(way / x > 0.0 && way / x < 1.0) {
            return Ok(None);
        }
        let state = from.step(surface, way)?;
        let off = (knot - state.at.get(axis)) / state.rate.get(axis);
        if off.abs() <= KNOT_FOUND * x.abs() {
            return Ok(Some((state, way)));
        }
        way += off;
    }
    Ok(None)
}

struct HalfStrip {
    edge: f64,
    /// The normal of the part there, and the instant of the contact's own passage.
    at: Line,
    t: f64,
    undercut: f64,
    error: f64,
    at_edge: bool,
}

impl<'a, M: SweptMotion> Side<'a, M> {
    /// Both halves, left first.
    fn both(&self) -> Result<[HalfStrip; 2], StripError> {
        Ok([self.walk(1.0)?, self.walk(-1.0)?])
    }

    /// Both halves, by the contact's own passage; None where the tool at another instant comes near the contact or an edge.
    fn once(&self, passages: &Passages) -> Result<Option<[HalfStrip; 2]>, StripError> {
        let matter = |line: &Line, t: f64| {
            passages.matter(self.contact.cutter, line, self.h) || self.comes_again(line, t)
        };
        let here = Line { origin: self.contact.frame.point, direction: self.contact.frame.normal };
        let first = self.both();
        let again = match &first {
            Ok(sides) => matter(&here, self.t0) || sides.iter().any(|s| matter(&s.at, s.t)),
            Err(StripError::AboveTolerance { .. }) => matter(&here, self.t0),
            Err(_) => false,
        };
        if again { Ok(None) } else { first.map(Some) }
    }

    /// Whether within a radius of the contact the tool comes down to the tolerance over a line at another instant than `t`.
    fn comes_again(&self, line: &Line, t: f64) -> bool {
        let entry = |k: i32| {
            let pose = self.motion.at(self.t0 + f64::from(k) * self.t_step)?.pose;
            Some(self.contact.cutter.entry(&pose, line)?.at_mm)
        };
        let mut before = [f64::INFINITY; 2];
        for k in -NEARBY..=NEARBY {
            let now = entry(k).unwrap_or(f64::INFINITY);
            let other = (self.t0 + f64::from(k - 1) * self.t_step - t).abs() > 2.0 * self.t_step.abs();
            if other && before[1] <= self.h && before[1] < before[0] && before[1] <= now {
                return true;
            }
            before = [before[1], now];
        }
        false
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
        let bound = found.map_or(f64::INFINITY, |f| f.0.at_mm);
        // The next place is looked at from the contact's own passage on, and from all others.
        let from = found.map_or(near, |f| f.1);
        Ok(passages.deepest(cutter, &line, self.motion, bound).map(|other| (other, from)).or(found))
    }

    /// The cross line `x` further on. A step over knots, where the line's own equation has a kink, is taken from knot to
    /// knot, and cut small where these are not found.
    pub fn advance(&self, here: &GeodesicState, x: f64) -> Result<GeodesicState, Degenerate> {
        let surface = self.contact.surface;
        let (mut state, mut left) = (*here, x);
        for _ in 0..MOST_KNOTS {
            let whole = state.step(surface, left)?;
            let Some((axis, knot)) = self.first_knot(&state, &whole) else { return Ok(whole) };
            let Some((at, way)) = on_knot(surface, &state, (axis, knot), left)? else { break };
            (state, left) = (at, left - way);
        }
        for _ in 0..CUTS {
            state = state.step(surface, left / f64::from(CUTS))?;
        }
        Ok(state)
    }

    /// The knot that a step meets first, by the share of the way in its parameter.
    fn first_knot(&self, from: &GeodesicState, to: &GeodesicState) -> Option<(Axis, f64)> {
        let mut first: Option<(f64, Axis, f64)> = None;
        for (axis, breaks) in [Axis::U, Axis::V].into_iter().zip(&self.breaks) {
            let (a, b) = (from.at.get(axis), to.at.get(axis));
            // A start on the knot itself, to rounding, has passed it.
            let slack = KNOT_SLACK * (b - a).abs();
            let knot = if b > a {
                breaks.get(breaks.partition_point(|t| *t <= a + slack)).filter(|t| **t < b)
            } else {
                let below = breaks.partition_point(|t| *t < a - slack);
                below.checked_sub(1).map(|k| &breaks[k]).filter(|t| **t > b)
            };
            if let Some(t) = knot {
                let share = (t - a) / (b - a);
                if first.is_none_or(|f| share < f.0) {
                    first = Some((share, axis, *t));
                }
            }
        }
        first.map(|f| (f.1, f.2))
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
        let mut undercut = Undercut::new(here, t, height);
        for _ in 0..MAX_STEPS {
            let next = self.advance(&here, self.step)?;
            if !domain.contains(next.at) {
                return self.to_domain_edge(here, q, t, undercut);
            }
            let reach = self.standoff(next.at, t)?;
            match reach {
                Some((r, near)) if r.at_mm <= self.h => {
                    if let Some((from, step, f_out)) = self.crest(&undercut, r.at_mm)? {
                        let behind = if from.state.at == here.at { 0.0 } else { self.step };
                        let to_crest = Side { step, breaks: self.breaks.clone(), ..*self };
                        return to_crest.edge(from.state, q - behind, from.t, f_out, undercut);
                    }
                    (t, here, q) = (near, next, q + self.step);
                    undercut.see(here, t, r.at_mm);
                }
                outside => {
                    let f_out = outside.map_or(self.contact.cutter.radius_mm(), |(r, _)| r.at_mm - self.h);
                    return self.edge(here, q, t, f_out, undercut);
                }
            }
        }
        Err(StripError::Edge(RootError::NotConverged { evaluations: MAX_STEPS, residual: q }))
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
        let excess = |x: f64| -> f64 {
            let Ok(s) = self.advance(&here, x) else { return f64::NAN };
            match self.standoff(s.at, t) {
                Ok(Some((r, _))) => r.at_mm - self.h,
                Ok(None) => self.contact.cutter.radius_mm(),
                Err(_) => f64::NAN,
            }
        };
        let root = bracketed(
            End { x: 0.0, f: excess(0.0).min(0.0) },
            End { x: self.step, f: f_out },
            EDGE_TOLERANCE.max(SHARE * self.relative) * (q + self.step),
            excess,
        )?;
        Ok(HalfStrip {
            edge: q + root.x,
            at: self.normal(self.advance(&here, root.x)?.at)?,
            t: t.t,
            undercut: undercut.deepest(self)?,
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
                    undercut: undercut.deepest(self)?,
                    error,
                    at_edge: true,
                })
            }
            outside => {
                let f_out = outside.map_or(self.contact.cutter.radius_mm(), |(r, _)| r.at_mm - self.h);
                let shorter = Side { step: lo, breaks: self.breaks.clone(), ..*self };
                shorter.edge(here, q, t, f_out, undercut)
            }
        }
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
