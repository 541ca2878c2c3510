//! Widths of M86 for the three kinds of machine, with the tool's radius kept (the paper sets it to one).
//!
//! The toroidal cutter touches where the flat end of its tube-centre radius touches the offset of the part by the corner
//! radius: offset curvatures are `k / (1 + r k)`, and widths between contacts on the offset divide by `1 + r k_across`. Heights
//! are not kept by the offset (the normals of part and tool part), so that in 3C the tool's own curvature is taken instead.

use super::{DomainError, check_tolerance};

fn positive(what: &'static str, got: f64) -> Result<f64, DomainError> {
    if got > 0.0 && got.is_finite() {
        Ok(got)
    } else {
        Err(DomainError::Value { what, need: "positive", got })
    }
}

/// 2CL: a ball of radius R leaves `2 sqrt(2 h R)`. Leading order for a part that is flat across the feed.
///
/// # Errors
/// [`DomainError`].
pub fn two_axis_ball(radius_mm: f64, scallop_mm: f64) -> Result<f64, DomainError> {
    check_tolerance(scallop_mm)?;
    Ok(2.0 * (2.0 * scallop_mm * positive("the radius", radius_mm)?).sqrt())
}

/// 3C: a flat end of radius R whose axis leans by `lead_rad` (the angle between normal and axis) leaves
/// `2 sqrt(2 h R / (sin lead + k R))`, `across_per_mm` = k the part's curvature across the feed. Leading order.
///
/// ```
/// use osculate_productivity::closed_form::{three_axis_flat, two_axis_ball};
///
/// // Leaning by a quarter of a turn on a flat part, a flat end cuts with its rim as a ball of the same radius does.
/// let ball_mm = two_axis_ball(8.0, 0.01)?;
/// assert!((three_axis_flat(8.0, std::f64::consts::FRAC_PI_2, 0.0, 0.01)? - ball_mm).abs() < 1e-12);
/// // The less it leans the wider it cuts: sin 30 deg = 1/2, and the strip grows with the root of its inverse.
/// let wider_mm = three_axis_flat(8.0, 30f64.to_radians(), 0.0, 0.01)?;
/// assert!((wider_mm / ball_mm - 2f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DomainError`]; [`DomainError::DoesNotFit`] where the place is undercut.
pub fn three_axis_flat(
    radius_mm: f64,
    lead_rad: f64,
    across_per_mm: f64,
    scallop_mm: f64,
) -> Result<f64, DomainError> {
    check_tolerance(scallop_mm)?;
    let radius = positive("the radius", radius_mm)?;
    let tool = lead_rad.sin().abs() / radius;
    let sum = tool + across_per_mm;
    if sum.is_nan() || sum <= 0.0 {
        return Err(DomainError::DoesNotFit {
            part_per_mm: across_per_mm,
            tool_per_mm: tool,
            sum_per_mm: sum,
        });
    }
    Ok(2.0 * (2.0 * scallop_mm / sum).sqrt())
}

/// 3C with a corner: a toroidal end whose disc has the radius `core_mm` and whose corner has the radius `corner_mm` is curved by
/// `sin(lead) / (core + corner sin(lead))` across the feed. Leading order.
///
/// The flat end on the offset part, with its width divided by `1 + r k`, is *not* this: it would be narrower or wider by the
/// factor `sqrt(core / ((1 + r k)(core + r sin(lead))))` for any tolerance.
///
/// # Errors
/// As [`three_axis_flat`].
pub fn three_axis_toroidal(
    core_mm: f64,
    corner_mm: f64,
    lead_rad: f64,
    across_per_mm: f64,
    scallop_mm: f64,
) -> Result<f64, DomainError> {
    let radius = positive("the radius of the bottom", core_mm)? + corner_mm * lead_rad.sin().abs();
    three_axis_flat(radius, lead_rad, across_per_mm, scallop_mm)
}

/// Curvature, 1/mm, convex positive, of the contour line (the section across the tool axis) through a place whose normal
/// leans by `lead_rad` from the axis and whose curvature across the feed is `across_per_mm`: Meusnier's `k / sin(lead)`.
///
/// A flat end of radius R cannot machine the place in 3C where this is below `-1 / R`: where a hollow contour line's
/// *radius* of curvature is smaller than the tool's ([`three_axis_flat`] then says [`DomainError::DoesNotFit`]). M86 prints
/// 'curvature smaller than 1/r'.
///
/// ```
/// use osculate_productivity::closed_form::contour_per_mm;
///
/// // A sphere of 50 mm: a contour line at 30 deg from its pole is a circle of 25 mm.
/// assert!((contour_per_mm(1.0 / 50.0, 30f64.to_radians())? - 1.0 / 25.0).abs() < 1e-15);
/// assert!(contour_per_mm(1.0 / 50.0, 0.0).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DomainError::Value`] without a lead: there is no contour line at a place that is level.
pub fn contour_per_mm(across_per_mm: f64, lead_rad: f64) -> Result<f64, DomainError> {
    Ok(across_per_mm / positive("the sine of the lead", lead_rad.sin().abs())?)
}

/// A two-contact posture of a flat or toroidal end on a hollow place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FiveAxis {
    /// Strip width between the outer zeros of the standoff, mm: after the lift the edges of the band [0, h].
    pub width_mm: f64,
    /// Lead that makes the tool dip by exactly h before the lift, rad.
    pub lead_rad: f64,
}

/// 5C: the widest strip, `2 R sqrt(4 s - 4 s^2)`, `s = sqrt(2 (h/R) / (D R))`, D the difference of the part's principal
/// curvatures, for a disc of radius `core_mm` with a corner of `corner_mm` (zero: flat end), fed along the line of
/// greater (more convex) curvature `feed_per_mm` with the hollow curvature `across_per_mm` across.
///
/// The paper's form. Its relative error does not vanish with h: it takes D for `k_f cos^2(lead) - k_y + k_y^3 R^2` and
/// the chord for the arc, which costs about 1 % at leads of ten degrees; [`five_axis_refined`] has both. (The printed formula nests
/// its second term inside the inner root, which has no real value.)
///
/// # Errors
/// [`DomainError::NotHollow`] where the part is not hollow enough for two contacts.
pub fn five_axis_flat(
    core_mm: f64,
    corner_mm: f64,
    feed_per_mm: f64,
    across_per_mm: f64,
    scallop_mm: f64,
) -> Result<FiveAxis, DomainError> {
    check_tolerance(scallop_mm)?;
    let radius = positive("the radius of the bottom", core_mm)?;
    for (k, what) in [(feed_per_mm, "1 + r k along"), (across_per_mm, "1 + r k across")] {
        let scale = 1.0 + corner_mm * k;
        positive(what, scale)?;
    }
    let (kf, ky) =
        (feed_per_mm / (1.0 + corner_mm * feed_per_mm), across_per_mm / (1.0 + corner_mm * across_per_mm));
    let difference = (kf - ky) * radius;
    let dip = (2.0 * (scallop_mm / radius) * difference.max(0.0)).sqrt();
    let sin_lead = -ky * radius - dip;
    let s = (2.0 * (scallop_mm / radius) / difference).sqrt();
    if !(difference > 0.0 && sin_lead > 0.0 && sin_lead < 1.0 && s < 0.5) {
        return Err(DomainError::NotHollow { got_per_mm: ky, need_per_mm: -dip / radius });
    }
    let width = 2.0 * radius * (4.0 * s - 4.0 * s * s).sqrt();
    Ok(FiveAxis { width_mm: width / (1.0 + corner_mm * across_per_mm), lead_rad: sin_lead.asin() })
}

/// Rounds in which the lead of [`five_axis_refined`] settles: each multiplies its error by less than a tenth.
const LEADS: u32 = 24;

/// 5C as [`five_axis_flat`], with the terms of second order in the distance from the contact in full.
///
/// A point of the disc's edge at `c = 1 - cos(theta)` stands off by `f(c) = -delta c + (d / 2) c^2` in units of R, with
/// `d = k_f cos^2(lead) - k_y + k_y^3` (the last from the circle of the part's profile) and the half width `sqrt(2 c - c^2)`
/// as a chord of that circle. What is left falls with the root of h.
///
/// # Errors
/// [`DomainError::NotHollow`].
pub fn five_axis_refined(
    core_mm: f64,
    corner_mm: f64,
    feed_per_mm: f64,
    across_per_mm: f64,
    scallop_mm: f64,
) -> Result<FiveAxis, DomainError> {
    let start = five_axis_flat(core_mm, corner_mm, feed_per_mm, across_per_mm, scallop_mm)?;
    let on_offset = |k: f64| core_mm * k / (1.0 + corner_mm * k);
    let (kf, ky) = (on_offset(feed_per_mm), on_offset(across_per_mm));
    let height = 2.0 * scallop_mm / core_mm;
    let not_hollow = DomainError::NotHollow { got_per_mm: ky / core_mm, need_per_mm: 0.0 };
    let (mut sin_lead, mut d) = (start.lead_rad.sin(), 0.0);
    for _ in 0..LEADS {
        d = kf * (1.0 - sin_lead * sin_lead) - ky + ky * ky * ky;
        sin_lead = -ky - (height * d).sqrt();
        if !(d > 0.0 && sin_lead > 0.0 && sin_lead < 1.0) {
            return Err(not_hollow);
        }
    }
    let s = (height / d).sqrt();
    let half = (4.0 * s - 4.0 * s * s).sqrt();
    let arc = (ky.abs() * half).asin() / ky.abs();
    if s >= 0.5 || !arc.is_finite() {
        return Err(not_hollow);
    }
    let width = 2.0 * core_mm * arc / (1.0 + corner_mm * across_per_mm);
    Ok(FiveAxis { width_mm: width, lead_rad: sin_lead.asin() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formula's own values for a flat end R = 10 in a groove of profile radius 60 at 140 mm from the axis.
    #[test]
    fn reference_widths() {
        for (h, want) in [(1e-4, 3.81180), (1e-3, 6.71032), (1e-2, 11.54134)] {
            let got = five_axis_flat(10.0, 0.0, 1.0 / 140.0, -1.0 / 60.0, h).unwrap().width_mm;
            assert!((got - want).abs() < 1e-5, "{h}: {got} against {want}");
        }
        for (h, want) in [(1e-4, 0.0894), (1e-3, 0.2828), (1e-2, 0.8944)] {
            assert!((two_axis_ball(10.0, h).unwrap() - want).abs() < 5e-5);
        }
    }

    #[test]
    fn three_axis_is_the_ball_at_full_lead() {
        let a = three_axis_flat(5.0, std::f64::consts::FRAC_PI_2, 0.0, 0.01).unwrap();
        assert!((a - two_axis_ball(5.0, 0.01).unwrap()).abs() < 1e-15);
    }

    #[test]
    fn refuses_what_has_no_strip() {
        assert!(matches!(five_axis_flat(10.0, 0.0, 0.0, 0.01, 1e-3), Err(DomainError::NotHollow { .. })));
        assert!(matches!(three_axis_flat(10.0, 0.1, -0.02, 1e-3), Err(DomainError::DoesNotFit { .. })));
        assert!(matches!(two_axis_ball(-1.0, 1e-3), Err(DomainError::Value { .. })));
    }
}
