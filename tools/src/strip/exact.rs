//! Exact strip width at one contact.

use super::ContactMotion;
use super::asked::{Demand, Strip, StripError};
use super::knotted::Knotted;
use super::local::LocalMotion;
use super::passages::{self, Passages};
use super::side::{JUMP, SHARE, Side};
use super::traced::Traced;
use crate::contact::{Contact, ContactError, ContactLine};
use crate::cutter::{Cutter, Line};
use crate::sweep::{Reach, SweptMotion, reach_from};
use osculate_geom::line::SurfaceLine;
use osculate_geom::{Degenerate, Surface, Unit3, Uv};

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
/// Most of them, for a part with waves finer than that.
const FINE_STEPS: f64 = 24.0;
/// Steps between two knots.
const OF_PITCH: f64 = 0.5;
/// Half the length of a piece of motion that is fitted at once, in leading-order half widths.
const MOTION_PIECE: f64 = 1.0;
/// Disagreement accepted of a fitted piece, relative to the tolerance: the strip's edge moves by half as much,
/// relative to its width.
const MOTION_TOLERANCE: f64 = 2e-9;

/// The exact strip at a contact for the tolerance `scallop_mm`.
///
/// ```
/// use osculate_geom::{Axis, Interval, analytic::Cylinder, uv};
/// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
/// // A ball of radius 5 along a shaft of radius 20: the strip ends where its circle is h off the shaft's. The centres lie 25 mm
/// // apart, so that the law of cosines has the angle there, and the strip is measured on the shaft.
/// let (shaft_mm, ball_mm, h) = (20.0, 5.0, 0.01_f64);
/// let shaft = Cylinder::new(shaft_mm, Interval::new(0.0, 80.0))?;
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * ball_mm, length_mm: 60.0 })?;
/// let contact = Contact::new(&shaft, uv(0.0, 40.0), &ball, FeedLine::Iso(Axis::V), Lean::default())?;
/// let got = strip::exact(&contact, h)?;
/// let (apart, high) = (shaft_mm + ball_mm, shaft_mm + h);
/// let angle = ((apart * apart + high * high - ball_mm * ball_mm) / (2.0 * apart * high)).acos();
/// assert!((got.width_mm - 2.0 * shaft_mm * angle).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The tool may undercut (Q need not be definite): then `undercut_mm` says how deep.
///
/// # Errors
/// [`StripError`].
pub fn exact(contact: &Contact<'_>, scallop_mm: f64) -> Result<Strip, StripError> {
    exact_to(contact, scallop_mm, Demand { deepest_mm: f64::INFINITY, relative: 0.0 })
}

/// As [`exact`], only as far and as well as is asked for.
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, analytic::Plane, uv};
/// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};
/// // To a thousandth of the width, which is that of a ball on a plane.
/// let range = Interval::new(0.0, 50.0);
/// let plane = Plane::new(Domain { u: range, v: range });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
/// let contact = Contact::new(&plane, uv(25.0, 25.0), &ball, FeedLine::Iso(Axis::V), Lean::default())?;
/// let demand = strip::Demand { deepest_mm: f64::INFINITY, relative: 1e-3 };
/// let (h, width_mm) = (0.01_f64, strip::exact_to(&contact, 0.01, demand)?.width_mm);
/// assert!((width_mm / (2.0 * (h * (10.0 - h)).sqrt()) - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`StripError`], with [`StripError::TooDeep`] at once where the demand says so.
pub fn exact_to(contact: &Contact<'_>, scallop_mm: f64, demand: Demand) -> Result<Strip, StripError> {
    if !(scallop_mm > 0.0 && scallop_mm.is_finite()) {
        return Err(StripError::Tolerance { got: scallop_mm });
    }
    let (feed_line, t0) = contact.line()?;
    let part = Knotted::new(contact.surface);
    let jet = contact.surface.jet2(contact.at);
    let radius = contact.cutter.radius_mm();
    let across = contact.relative().along(&contact.frame.left);
    let h = scallop_mm;
    // Leading-order half width where Q allows it, a fraction of the tool elsewhere.
    let half = if across.is_finite() && across > 0.0 { (2.0 * h / across).sqrt() } else { 0.1 * radius };
    let pitch = |direction: &Unit3, reach_mm: f64| {
        part.pitch_mm(contact.at, contact.forms.rate(&jet, direction), reach_mm)
    };
    let along_mm = pitch(&contact.frame.tangent, passages::bottom_mm(contact.cutter));
    let traced = match &feed_line {
        ContactLine::Geodesic(line) => Some(Traced::new(contact, &part, line, along_mm)?),
        ContactLine::Iso(_) => None,
    };
    let motion = ContactMotion {
        line: traced.as_ref().map_or(&feed_line as &dyn SurfaceLine, |t| t),
        cutter: contact.cutter,
        lean: contact.lean,
        lift_mm: contact.lift_mm,
    };
    let (_, rate) = motion.line.frame(t0).map_err(ContactError::from)?;
    let contact_speed = rate.abs().max(1e-12);
    let passages =
        Passages::new(contact, &motion, (t0, contact_speed), (passages::reach(contact, rate), along_mm));
    let here = Line { origin: contact.frame.point, direction: contact.frame.normal };
    let dip_mm = -passages.lowest_mm(contact.cutter, &here, -demand.deepest_mm);
    if dip_mm > demand.deepest_mm {
        return Err(StripError::TooDeep { dip_mm, deepest_mm: demand.deepest_mm });
    }
    let misfit = MOTION_TOLERANCE.max(SHARE * demand.relative) * h;
    let arms = [radius, misfit + 8.0 * f64::EPSILON * contact.frame.point.coords.amax()];
    let local = LocalMotion::new(&motion, t0, MOTION_PIECE * half.min(radius) / contact_speed, arms);
    let half = half.min(radius);
    let across_mm = pitch(&contact.frame.left, half);
    let side = Side {
        contact,
        part: &part,
        motion: &local,
        t0,
        t_step: JUMP * radius / contact_speed,
        h,
        step: (half / STEPS_PER_SIDE)
            .min(4.0 * contact.step_mm())
            .min((OF_PITCH * across_mm).max(half / FINE_STEPS)),
        passages: None,
        relative: demand.relative,
    };
    let [left, right] = match side.once(&passages)? {
        Some(sides) => sides,
        None => Side { passages: Some(&passages), ..side }.both()?,
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
