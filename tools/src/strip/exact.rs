//! Exact strip width at one contact.

use super::ContactMotion;
use super::local::{LocalMotion, Near, Pace, deepest};
use super::traced::Traced;
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

/// Most steps towards the deepest place across.
const MOST_PARABOLAS: u32 = 30;
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
    let reach = [radius, MOTION_TOLERANCE * h + 8.0 * f64::EPSILON * contact.frame.point.coords.amax()];
    let local = LocalMotion::new(&motion, t0, MOTION_PIECE * half.min(radius) / contact_speed, reach);
    let side = Side {
        contact,
        motion: &local,
        t0,
        t_step: 0.05 * radius / contact_speed,
        h,
        step: (half.min(radius) / STEPS_PER_SIDE).min(4.0 * contact.step_mm()),
        breaks: [contact.surface.breaks(Axis::U), contact.surface.breaks(Axis::V)],
    };
    let left = side.walk(1.0)?;
    let right = side.walk(-1.0)?;
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

struct Side<'a, M> {
    contact: &'a Contact<'a>,
    motion: &'a M,
    t0: f64,
    t_step: f64,
    h: f64,
    step: f64,
    /// Where the surface is less smooth, along u and along v.
    breaks: [Vec<f64>; 2],
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
    undercut: f64,
    error: f64,
    at_edge: bool,
}

impl<M: SweptMotion> Side<'_, M> {
    fn standoff(&self, at: Uv, near: Near) -> Result<Option<(Reach, Near)>, Degenerate> {
        let jet = self.contact.surface.jet2(at);
        let line = Line { origin: jet.point, direction: jet.normal()? };
        let pace = Pace { step: self.t_step, settled_mm: SETTLED * self.contact.cutter.radius_mm() };
        Ok(deepest(self.contact.cutter, &line, self.motion, near, pace))
    }

    /// The cross line `x` further on. A step over knots, where the line's own equation has a kink, is taken from knot to
    /// knot, and cut small where these are not found.
    fn advance(&self, here: &GeodesicState, x: f64) -> Result<GeodesicState, Degenerate> {
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
            EDGE_TOLERANCE * (q + self.step),
            excess,
        )?;
        Ok(HalfStrip {
            edge: q + root.x,
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
                Ok(HalfStrip { edge: q + lo, undercut: undercut.deepest(self)?, error, at_edge: true })
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

/// The lowest standoff seen on a walk, with the stretch in which the true minimum lies.
#[derive(Clone, Copy)]
struct Undercut {
    /// The last two places, oldest first.
    last: [Option<Place>; 2],
    lowest: f64,
    /// The place before the lowest one, where a minimum stands between three places.
    before_lowest: Option<Place>,
}

/// One place of the walk.
#[derive(Clone, Copy)]
struct Place {
    state: GeodesicState,
    t: Near,
    height: f64,
}

impl Undercut {
    fn new(state: GeodesicState, t: Near, height: f64) -> Self {
        Self { last: [None, Some(Place { state, t, height })], lowest: height, before_lowest: None }
    }

    fn see(&mut self, state: GeodesicState, t: Near, height: f64) {
        let new = Place { state, t, height };
        if let [Some(a), Some(b)] = self.last
            && b.height <= a.height
            && b.height <= height
            && b.height <= self.lowest
        {
            self.before_lowest = Some(a);
        }
        self.lowest = self.lowest.min(height);
        self.last = [self.last[1], Some(new)];
    }

    /// Depth below the part, the minimum between places found by golden section over the two steps around it.
    fn deepest<M: SweptMotion>(&self, side: &Side<'_, M>) -> Result<f64, Degenerate> {
        let Some(a) = self.before_lowest else { return Ok((-self.lowest).max(0.0)) };
        let height = |x: f64| -> Result<f64, Degenerate> {
            let at = side.advance(&a.state, x)?.at;
            Ok(side.standoff(at, a.t)?.map_or(f64::INFINITY, |(r, _)| r.at_mm))
        };
        // Three places around the minimum, closed in on by parabolas, by halves where these stand still.
        let mut x = [0.0, side.step, 2.0 * side.step];
        let mut f = [a.height, height(x[1])?, height(x[2])?];
        for round in 0..MOST_PARABOLAS {
            let (da, dc) = (x[1] - x[0], x[1] - x[2]);
            let (fa, fc) = (f[1] - f[0], f[1] - f[2]);
            let bottom = da * fc - dc * fa;
            let by = 0.5 * (da * da * fc - dc * dc * fa) / bottom;
            let inside = bottom != 0.0 && x[1] - by > x[0] && x[1] - by < x[2];
            // Every third step halves the longer side.
            let new = if inside && round % 3 != 2 {
                x[1] - by
            } else if da > -dc {
                x[1] - 0.5 * da
            } else {
                x[1] - 0.5 * dc
            };
            // A height is flat at its minimum: its place to half of double precision's digits is enough.
            if (new - x[1]).abs() < 1e-7 * side.step {
                break;
            }
            let g = height(new)?;
            let above = new > x[1];
            if g < f[1] {
                if above {
                    (x[0], f[0]) = (x[1], f[1]);
                } else {
                    (x[2], f[2]) = (x[1], f[1]);
                }
                (x[1], f[1]) = (new, g);
            } else if above {
                (x[2], f[2]) = (new, g);
            } else {
                (x[0], f[0]) = (new, g);
            }
        }
        let lowest = self.lowest.min(f[1]);
        Ok((-lowest).max(0.0))
    }
}
