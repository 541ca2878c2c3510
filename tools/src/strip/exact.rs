//! Exact strip width at one contact.

use super::ContactMotion;
use super::local::{LocalMotion, Near, deepest};
use crate::contact::{Contact, ContactError};
use crate::cutter::{Cutter, Line};
use crate::sweep::{Reach, SweptMotion, reach_from};
use osculate_geom::geodesic::GeodesicState;
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
/// Cuts of a step of the cross line over a knot: the error falls with their cube.
const CUTS: u32 = 16;
/// Accuracy of the strip's edge relative to the half width.
const EDGE_TOLERANCE: f64 = 1e-13;

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
    let motion = ContactMotion {
        line: &feed_line,
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
        Ok(deepest(self.contact.cutter, &line, self.motion, near, self.t_step))
    }

    /// The cross line `x` further on. A step over a knot, where the line's own equation has a kink, is cut small.
    fn advance(&self, here: &GeodesicState, x: f64) -> Result<GeodesicState, Degenerate> {
        let surface = self.contact.surface;
        let whole = here.step(surface, x)?;
        let crosses = [Axis::U, Axis::V].iter().zip(&self.breaks).any(|(axis, breaks)| {
            let (a, b) = (here.at.get(*axis), whole.at.get(*axis));
            let (lo, hi) = (a.min(b), a.max(b));
            breaks.get(breaks.partition_point(|t| *t <= lo)).is_some_and(|t| *t < hi)
        });
        if !crosses {
            return Ok(whole);
        }
        let mut state = *here;
        for _ in 0..CUTS {
            state = state.step(surface, x / f64::from(CUTS))?;
        }
        Ok(state)
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
        const RATIO: f64 = 0.618_033_988_749_894_9;
        let Some(a) = self.before_lowest else { return Ok((-self.lowest).max(0.0)) };
        let height = |x: f64| -> Result<f64, Degenerate> {
            let at = side.advance(&a.state, x)?.at;
            Ok(side.standoff(at, a.t)?.map_or(f64::INFINITY, |(r, _)| r.at_mm))
        };
        let (mut lo, mut hi) = (0.0, 2.0 * side.step);
        let mut lowest = self.lowest;
        // A minimum's height is settled once its place is known to half of double precision's digits.
        for _ in 0..40 {
            let (x, y) = (hi - RATIO * (hi - lo), lo + RATIO * (hi - lo));
            let (fx, fy) = (height(x)?, height(y)?);
            lowest = lowest.min(fx).min(fy);
            if fx < fy { hi = y } else { lo = x }
        }
        Ok((-lowest).max(0.0))
    }
}
