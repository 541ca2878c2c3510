//! Widths of R97 in the plane across the feed: part and tool as arcs of constant curvature.
//!
//! With the arcs' half angle sigma on the part, `S = 2 R_P sigma` [R97, eq. 37]. Written with curvatures and the half
//! angle formula nothing cancels: `S = 2 x asin(y) / y`, `y = k_P x / 2`,
//! `x^2 = h (2 - h k_T) / ((k_P + k_T)(1 + k_P h))`, valid for convex, flat and hollow parts and for flat tools.
//! [R97, eqs. 39, 40, 43, 44, 46] print `[h] sgn R_P`; with it no hollow part has a real width, so h stands alone here.

use super::{DomainError, check_tolerance};

/// The two arcs in the plane across the feed, and the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Normal curvature of the part across the feed, 1/mm, convex positive.
    pub part_per_mm: f64,
    /// Normal curvature of the tool in the same plane, 1/mm, convex positive; zero for a plane.
    pub tool_per_mm: f64,
    /// Tolerance h, mm.
    pub scallop_mm: f64,
}

impl Section {
    fn check(self) -> Result<(f64, f64, f64), DomainError> {
        let Self { part_per_mm: kp, tool_per_mm: kt, scallop_mm: h } = self;
        check_tolerance(h)?;
        for (what, got) in [("the part's curvature", kp), ("the tool's curvature", kt)] {
            if !got.is_finite() {
                return Err(DomainError::Value { what, need: "finite", got });
            }
        }
        if kp + kt <= 0.0 {
            return Err(DomainError::DoesNotFit { part_per_mm: kp, tool_per_mm: kt, sum_per_mm: kp + kt });
        }
        Ok((kp, kt, h))
    }

    fn too_tall(self) -> DomainError {
        DomainError::TooTall {
            scallop_mm: self.scallop_mm,
            part_per_mm: self.part_per_mm,
            tool_per_mm: self.tool_per_mm,
        }
    }

    /// `x` and `y = k_P x / 2` of the module's formula with the numerator `h (2 - c h k_T)`.
    fn xy(self, c: f64) -> Result<(f64, f64), DomainError> {
        let (kp, kt, h) = self.check()?;
        let (top, bottom) = (h * (2.0 - c * h * kt), (kp + kt) * (1.0 + kp * h));
        if top <= 0.0 || bottom <= 0.0 {
            return Err(self.too_tall());
        }
        let x = (top / bottom).sqrt();
        let y = 0.5 * kp * x;
        if y.abs() > 1.0 { Err(self.too_tall()) } else { Ok((x, y)) }
    }
}

/// `asin(y) / y`, by its series where the quotient would be 0/0.
fn asinc(y: f64) -> f64 {
    // The next term, 15 y^6 / 336, is below rounding.
    if y.abs() < 1e-3 { 1.0 + y * y * (1.0 / 6.0 + y * y * (3.0 / 40.0)) } else { y.asin() / y }
}

/// Strip width of two arcs, exact for arcs [R97, eq. 37], in the form without cancellation.
///
/// Against the exact strip of a general contact the relative error is of first order in h.
///
/// ```
/// use osculate_productivity::closed_form::{Section, width_37};
///
/// // On a flat part the strip is the chord of the ball's circle at the height of the scallop: 2 sqrt(h (2 R - h)).
/// let (radius_mm, scallop_mm) = (10.0, 0.05);
/// let width_mm = width_37(Section { part_per_mm: 0.0, tool_per_mm: 1.0 / radius_mm, scallop_mm })?;
/// assert!((width_mm - 2.0 * f64::sqrt(scallop_mm * (2.0 * radius_mm - scallop_mm))).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DomainError`].
pub fn width_37(section: Section) -> Result<f64, DomainError> {
    let (x, y) = section.xy(1.0)?;
    Ok(2.0 * x * asinc(y))
}

/// [R97, eq. 37] as printed, through the arc cosine. It loses all digits for flat parts; kept to show that.
///
/// # Errors
/// [`DomainError`].
pub fn acos_37(section: Section) -> Result<f64, DomainError> {
    let (kp, kt, h) = section.check()?;
    let (rp, rt) = (1.0 / kp, 1.0 / kt);
    let c = (rp * (rp + rt) + h * (rp + 0.5 * h)) / ((rp + rt) * (rp + h));
    if c.abs() <= 1.0 { Ok(2.0 * (rp * c.acos()).abs()) } else { Err(section.too_tall()) }
}

/// Chord for arc [R97, eq. 38]: `S = 2 R_P sqrt(1 - c^2)`, below [`width_37`] by a relative `y^2 2/3`.
///
/// # Errors
/// [`DomainError`].
pub fn chord_38(section: Section) -> Result<f64, DomainError> {
    let (x, y) = section.xy(1.0)?;
    Ok(2.0 * x * (1.0 - y * y).sqrt())
}

/// Without the term in h squared [R97, eq. 40], above [`width_37`] by a relative `h k_T / 4`.
///
/// # Errors
/// [`DomainError`].
pub fn linear_40(section: Section) -> Result<f64, DomainError> {
    let (x, y) = section.xy(0.0)?;
    Ok(2.0 * x * asinc(y))
}

/// `2 sqrt(2 h / (k_P + k_T))`: what all the forms above tend to as h -> 0.
///
/// ```
/// use osculate_productivity::closed_form::{Section, leading_order};
///
/// // Four times the tolerance, or a fourth of the curvatures: twice the width.
/// let section = Section { part_per_mm: 0.02, tool_per_mm: 0.1, scallop_mm: 0.01 };
/// let width_mm = leading_order(section)?;
/// let coarser = leading_order(Section { scallop_mm: 0.04, ..section })?;
/// let flatter = leading_order(Section { part_per_mm: 0.005, tool_per_mm: 0.025, ..section })?;
/// assert!((coarser - 2.0 * width_mm).abs() < 1e-12 && (flatter - 2.0 * width_mm).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DomainError`].
pub fn leading_order(section: Section) -> Result<f64, DomainError> {
    let (kp, kt, h) = section.check()?;
    Ok(2.0 * (2.0 * h / (kp + kt)).sqrt())
}

/// The leading order of the swept strip, `2 sqrt(2 h / q*)` with `q* = q_cc - q_lc^2 / q_ll` of the relative form Q in
/// the directions along (l) and across (c) the feed.
///
/// The tool passes over a point beside the contact at its lowest when it is not abreast of it unless the feed
/// is along an eigenvector of Q; then `q_lc = 0` and this is [`leading_order`].
///
/// # Errors
/// [`DomainError::DoesNotFit`] where Q is not positive definite.
pub fn leading_order_swept(
    relative: &osculate_geom::Relative,
    left: &osculate_geom::Vec3,
    scallop_mm: f64,
) -> Result<f64, DomainError> {
    check_tolerance(scallop_mm)?;
    if relative.min <= 0.0 {
        return Err(DomainError::DoesNotFit {
            part_per_mm: f64::NAN,
            tool_per_mm: f64::NAN,
            sum_per_mm: relative.min,
        });
    }
    // The inverse of Q in the direction across the feed is 1 / q*.
    let (c, s) = (left.dot(&relative.d_min), left.dot(&relative.d_max));
    let inverse = c * c / relative.min + s * s / relative.max;
    Ok(2.0 * (2.0 * scallop_mm * inverse).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn section(rp: f64, rt: f64, h: f64) -> Section {
        Section { part_per_mm: 1.0 / rp, tool_per_mm: 1.0 / rt, scallop_mm: h }
    }

    /// Values computed with 40 digits from (37).
    #[test]
    fn reference_values() {
        for (rp, rt, h, want) in [
            (100.0, 10.0, 0.01, 0.852_547_657_247_159_4),
            (-100.0, 10.0, 0.01, 0.942_621_314_501_686_6),
            (-100.0, 10.0, 0.1, 2.975_476_607_286_243_7),
            (50.0, -200.0, 0.05, 5.162_293_513_175_692),
            (-20.0, 8.0, 0.02, 1.460_491_844_093_912_6),
        ] {
            let got = width_37(section(rp, rt, h)).unwrap();
            assert!((got - want).abs() < 4e-15 * want, "{rp} {rt} {h}: {got} against {want}");
        }
    }

    #[test]
    fn printed_form_cancels_where_the_stable_one_does_not() {
        let flat = |rp: f64| section(rp, 10.0, 0.01);
        let limit = 2.0 * (0.01f64 * (2.0 - 0.001) * 10.0).sqrt();
        assert!((width_37(flat(1e9)).unwrap() - limit).abs() < 1e-7);
        assert!((width_37(flat(1e6)).unwrap() - 0.89420).abs() < 5e-6);
        assert!((acos_37(flat(1e6)).unwrap() - 0.89407).abs() < 5e-6);
        assert_eq!(acos_37(flat(1e9)).unwrap(), 0.0);
        // A part that is exactly flat, and a flat tool.
        let plane = Section { part_per_mm: 0.0, tool_per_mm: 0.1, scallop_mm: 0.01 };
        assert!((width_37(plane).unwrap() - limit).abs() < 1e-15);
        let disc = Section { part_per_mm: 0.1, tool_per_mm: 0.0, scallop_mm: 0.01 };
        assert!(width_37(disc).unwrap() > 0.0);
    }

    #[test]
    fn outside_the_domain_is_a_typed_error() {
        assert!(matches!(width_37(section(-5.0, 10.0, 0.01)), Err(DomainError::DoesNotFit { .. })));
        assert!(matches!(width_37(section(10.0, 10.0, 0.0)), Err(DomainError::Tolerance { .. })));
        assert!(matches!(width_37(section(10.0, 10.0, f64::NAN)), Err(DomainError::Tolerance { .. })));
        assert!(matches!(width_37(section(10.0, 1.0, 3.0)), Err(DomainError::TooTall { .. })));
        assert!(matches!(width_37(section(0.0, 1.0, 0.1)), Err(DomainError::Value { .. })));
    }

    proptest! {
        /// The half angle form is the arc cosine form wherever that has digits left.
        #[test]
        fn both_forms_of_37_agree(kp in -0.04..0.2f64, kt in 0.05..0.5f64, h in 1e-4..0.05f64) {
            prop_assume!(kp.abs() > 1e-3);
            let s = Section { part_per_mm: kp, tool_per_mm: kt, scallop_mm: h };
            let (a, b) = (width_37(s).unwrap(), acos_37(s).unwrap());
            // acos near one: an error of eps in the cosine is eps / sigma in the angle.
            let sigma = 0.5 * a * kp.abs();
            prop_assert!((a - b).abs() <= a * 40.0 * f64::EPSILON / (sigma * sigma), "{a} {b}");
        }

        /// The simplifications differ from (37) by their stated orders, with nothing of lower order left.
        #[test]
        fn simplifications_have_their_stated_order(kp in -0.04..0.2f64, kt in 0.05..0.5f64, h in 1e-6..1e-3f64) {
            let s = Section { part_per_mm: kp, tool_per_mm: kt, scallop_mm: h };
            let exact = width_37(s).unwrap();
            let (_, y) = s.xy(1.0).unwrap();
            let chord = chord_38(s).unwrap() / exact - 1.0 + y * y * 2.0 / 3.0;
            prop_assert!(chord.abs() <= y.powi(4) + 1e-14, "{chord}");
            let linear = linear_40(s).unwrap() / exact - 1.0 - 0.25 * h * kt;
            // The next terms: (h k_T)^2 and the arc's own curvature, y^2 h k_T.
            prop_assert!(linear.abs() <= (h * kt).powi(2) + y * y * h * kt + 1e-14, "{linear}");
            let lead = leading_order(s).unwrap() / exact - 1.0;
            prop_assert!(lead.abs() <= h * (kp.abs() + kt) + y * y, "{lead}");
        }
    }
}
