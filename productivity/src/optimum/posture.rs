//! A posture, what it must keep to, and what it yields by the exact strip.

use crate::closed_form::{Section, width_37};
use crate::rate::{Caps, CapsError, Rate, Share};
use crate::split::leading_share;
use osculate_geom::{Degenerate, Surface, Unit3, Uv};
use osculate_tools::strip::{self, Demand, StripError};
use osculate_tools::{Contact, Cutter, FeedLine, Lean};

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

    pub(super) fn clamp(self, x: f64) -> f64 {
        x.clamp(self.least_rad, self.most_rad)
    }

    pub(super) fn width(self) -> f64 {
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
#[non_exhaustive]
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
#[non_exhaustive]
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
    /// Postures measured.
    pub evaluations: u32,
    /// How many of them by the exact strip, the others on a chart.
    pub exact: u32,
}

/// Why there is no posture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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

/// Error of the widths that the search compares.
const COMPARED: f64 = 3e-4;

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

/// The exact productivity of one posture within the limits; the lift makes the undercut acceptable. A contact from which the
/// tool would have to be lifted by more than the tolerance is none.
///
/// ```
/// use osculate_geom::{analytic::Sphere, uv};
/// use osculate_productivity::{optimum::{Limits, Posture, Range, measure}, rate::Caps};
/// use osculate_tools::{Cutter, CutterSpec, Lean};
///
/// let sphere = Sphere::new(40.0)?;
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let caps = Caps::of_feed(1000.0);
/// let (lead, tilt) = (Range { least_rad: 0.0, most_rad: 1.0 }, Range::only(0.0));
/// let limits = Limits { scallop_mm: 0.01, gouge_mm: 0.001, lead, tilt, axis: None, caps };
/// // A ball on a sphere leaves the same strip whichever way it goes and leans.
/// let width = |direction_deg: f64, lead_deg: f64| {
///     let lean = Lean { lead_rad: lead_deg.to_radians(), tilt_rad: 0.0 };
///     let posture = Posture { direction_rad: direction_deg.to_radians(), lean };
///     measure(&sphere, uv(0.3, 0.2), &ball, posture, &limits).map(|m| m.rate.width_mm)
/// };
/// assert!((width(0.0, 10.0)? - width(75.0, 25.0)?).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    measure_contact(&contact, share, limits, 0.0)
}

/// As [`measure`], to [`COMPARED`], with the planar closed form of the tooth mark where the part has no waves: what the search
/// compares.
pub(super) fn compare(
    surface: &dyn Surface,
    at: Uv,
    cutter: &Cutter,
    (posture, waves): (Posture, bool),
    limits: &Limits,
) -> Result<Measured, StripError> {
    let contact = Contact::new(surface, at, cutter, FeedLine::Angle(posture.direction_rad), posture.lean)?;
    let along = contact.relative().along(&contact.frame.tangent);
    let (cap, _) = limits.caps.greatest_per_tooth();
    if waves || !(along > 0.0 && along.is_finite()) {
        let mark = |c: &Contact<'_>, h: f64| strip::mark(c, h).map(|m| m.length_mm());
        let share = share_of(&contact, cap, limits.scallop_mm, mark)?;
        return measure_contact(&contact, share, limits, COMPARED);
    }
    let part_per_mm = contact.forms.normal_curvature(&contact.frame.tangent);
    let planar = |_: &Contact<'_>, scallop_mm: f64| Ok(planar_mark_mm(part_per_mm, along, scallop_mm));
    let share = share_of(&contact, cap, limits.scallop_mm, planar)?;
    measure_contact(&contact, share, limits, COMPARED)
}

/// The closed form of the tooth mark, by its leading order where there is none.
pub(super) fn planar_mark_mm(part_per_mm: f64, along_per_mm: f64, scallop_mm: f64) -> f64 {
    let section = Section { part_per_mm, tool_per_mm: along_per_mm - part_per_mm, scallop_mm };
    width_37(section).unwrap_or_else(|_| 2.0 * (2.0 * scallop_mm / along_per_mm).sqrt())
}

fn measure_contact(
    contact: &Contact<'_>,
    (share, mark_mm): (Share, f64),
    limits: &Limits,
    relative: f64,
) -> Result<Measured, StripError> {
    let mut lift_mm = 0.0;
    let h = share.across_mm();
    // Lifted by more than the tolerance it would leave no strip.
    let mut strip = strip::exact_to(contact, h, Demand { deepest_mm: limits.gouge_mm + h, relative })?;
    if strip.undercut_mm > limits.gouge_mm {
        // The lift moves along one normal, the dip is a little off it: once more takes out what is left.
        for _ in 0..2 {
            lift_mm += strip.undercut_mm - limits.gouge_mm;
            strip =
                strip::exact_to(&contact.lifted(lift_mm), h, Demand { deepest_mm: f64::INFINITY, relative })?;
            if strip.undercut_mm <= limits.gouge_mm * (1.0 + 1e-3) {
                break;
            }
        }
    }
    // The tool at another instant may come over a contact from which it is lifted away: that is none.
    if lift_mm > h {
        return Err(StripError::AboveTolerance { standoff_mm: lift_mm, scallop_mm: h });
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
    let along = contact.relative().along(&contact.frame.tangent);
    share_by(along, cap_mm, tolerance_mm, |height| mark_of(contact, height))
}

/// As [`share_of`] with q(d) along the feed and the mark as a function of the height.
pub(super) fn share_by<E>(
    along_per_mm: f64,
    cap_mm: f64,
    tolerance_mm: f64,
    mark_of: impl Fn(f64) -> Result<f64, E>,
) -> Result<(Share, f64), E> {
    /// Least share looked at: below it the strip gains less than the fourth digit.
    const LEAST: f64 = 1e-4;
    /// Marks grow between the first power (a sharp edge) and the root of the height.
    const POWERS: u32 = 4;
    let smooth = along_per_mm.is_finite();
    let start = if smooth { leading_share(along_per_mm, cap_mm, tolerance_mm) } else { 0.25 };
    let mut share = Share { tolerance_mm, chi: start.clamp(LEAST, 0.5) };
    let mut mark = mark_of(share.along_mm())?;
    for _ in 0..POWERS {
        let enough = mark >= cap_mm * (1.0 - 1e-6);
        let settled = if enough { mark <= cap_mm * 1.02 || share.chi <= LEAST } else { share.chi >= 0.5 };
        if settled {
            break;
        }
        let power = if smooth { 2.0 } else { 1.0 };
        // A touch more than the power law says, so that the next mark reaches the cap.
        share.chi = (share.chi * (cap_mm / mark).powf(power) * 1.01).clamp(LEAST, 0.5);
        mark = mark_of(share.along_mm())?;
    }
    Ok((share, mark))
}

/// Refuses tools and limits that are none.
pub(crate) fn check(tools: &[Cutter], limits: &Limits) -> Result<(), OptimumError> {
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
