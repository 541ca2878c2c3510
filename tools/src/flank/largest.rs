//! The largest radius that holds a tolerance at rules: what D98 proposes its setting for.
//!
//! The deviation of a setting grows with the radius. From a radius that holds the tolerance it is doubled until the tolerance,
//! the hollow of the surface or the lack of a root ends it, and closed in on by bisection. Were the deviation not to grow
//! somewhere, the answer would be the end of the first range that holds.

use super::ruled::RuledStrip;
use super::section::Stations;
use super::setting::{Setting, Verdict, place};
use super::tool::SideTool;
use super::touch::PlaceError;

/// What to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiusSearch {
    /// Greatest |delta|, mm.
    pub tolerance_mm: f64,
    /// Radii from here on count, mm.
    pub least_mm: f64,
    /// Radii beyond do not, mm.
    pub most_mm: f64,
    /// Relative accuracy of the radius.
    pub relative: f64,
    /// Samples of the deviation along a rule.
    pub samples: usize,
}

/// What a larger radius fails by.
#[derive(Clone, Debug, PartialEq)]
pub enum RadiusLimit {
    /// Nothing: the largest radius asked for holds.
    Asked,
    /// The deviation at the rule at u.
    Tolerance {
        /// The rule.
        u: f64,
        /// delta with the greatest size at the radius that fails, mm.
        deviation_mm: f64,
    },
    /// A contact off the face, at the rule at u.
    ContactOutside {
        /// The rule.
        u: f64,
    },
    /// A section across the rule at u that is too hollow.
    Hollow {
        /// The rule.
        u: f64,
        /// Largest radius that fits there, mm.
        largest_mm: f64,
    },
    /// The setting does not exist.
    NoPosition(PlaceError),
}

/// The largest radius.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LargestRadius {
    /// The radius, mm; None where the least one asked for fails already.
    pub radius_mm: Option<f64>,
    /// What the next larger one fails by.
    pub limit: RadiusLimit,
}

/// Bounds that are none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "radii from {least_mm} to {most_mm} mm within {tolerance_mm} mm: all must be positive and finite, and ascending"
)]
#[non_exhaustive]
pub struct RadiusSearchError {
    /// Least radius, mm.
    pub least_mm: f64,
    /// Greatest, mm.
    pub most_mm: f64,
    /// Tolerance, mm.
    pub tolerance_mm: f64,
}

/// Why a radius fails at one of the rules, None where it holds.
fn fails(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    rules: &[f64],
    setting: Setting,
    radius_mm: f64,
    how: &RadiusSearch,
) -> Option<RadiusLimit> {
    let tool = SideTool::cylinder(radius_mm).expect("radii between positive bounds");
    rules.iter().find_map(|&u| {
        let judged = place(strip, stations, u, tool, setting).and_then(|placed| {
            let profile = placed.profile(strip, stations, &tool, how.samples);
            Ok(placed.verdict(strip, &tool, &profile, how.tolerance_mm)?)
        });
        match judged {
            Ok(Verdict::Valid) => None,
            Ok(Verdict::ContactOutside { .. }) => Some(RadiusLimit::ContactOutside { u }),
            Ok(Verdict::DoesNotFit { largest_mm }) => Some(RadiusLimit::Hollow { u, largest_mm }),
            Ok(Verdict::Gouge { depth_mm }) => Some(RadiusLimit::Tolerance { u, deviation_mm: -depth_mm }),
            Ok(Verdict::Left { height_mm }) => Some(RadiusLimit::Tolerance { u, deviation_mm: height_mm }),
            Err(PlaceError::TooLarge { u, largest_mm, .. }) => Some(RadiusLimit::Hollow { u, largest_mm }),
            Err(why) => Some(RadiusLimit::NoPosition(why)),
        }
    })
}

/// The largest radius of a cylinder that holds a tolerance at all the given rules.
///
/// ```
/// use osculate_geom::{Point3, Side, analytic::Line};
/// use osculate_tools::flank::{RadiusLimit, RadiusSearch, RuledStrip, Setting, Stations, largest_radius};
/// // Along a rule with an angle of 60 degrees between its end normals a cylinder gouges by R (1 - cos 30 deg).
/// let line = |z: f64, turn: f64| {
///     let (s, c) = turn.to_radians().sin_cos();
///     Line::segment(Point3::new(-40.0 * c, -40.0 * s, z), Point3::new(40.0 * c, 40.0 * s, z))
/// };
/// let strip = RuledStrip::new(line(0.0, 30.0)?, line(80.0, -30.0)?, Side::Along, 1.0)?;
/// let how = RadiusSearch { tolerance_mm: 0.1, least_mm: 0.1, most_mm: 10.0, relative: 1e-9, samples: 65 };
/// let found = largest_radius(&strip, &Stations::new(&strip, 48), &[0.5], Setting::Distributed, &how)?;
/// let want = 0.1 / (1.0 - 30f64.to_radians().cos());
/// assert!((found.radius_mm.ok_or("none fits")? - want).abs() < 1e-6);
/// assert!(matches!(found.limit, RadiusLimit::Tolerance { .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RadiusSearchError`].
pub fn largest_radius(
    strip: &RuledStrip<'_>,
    stations: &Stations,
    rules: &[f64],
    setting: Setting,
    how: &RadiusSearch,
) -> Result<LargestRadius, RadiusSearchError> {
    let RadiusSearch { tolerance_mm, least_mm, most_mm, relative, .. } = *how;
    let good = |x: f64| x > 0.0 && x.is_finite();
    if !(good(least_mm) && good(most_mm) && good(tolerance_mm) && least_mm <= most_mm) {
        return Err(RadiusSearchError { least_mm, most_mm, tolerance_mm });
    }
    let test = |r: f64| fails(strip, stations, rules, setting, r, how);
    if let Some(limit) = test(least_mm) {
        return Ok(LargestRadius { radius_mm: None, limit });
    }
    let mut holds = least_mm;
    let (mut over, mut limit) = loop {
        if holds >= most_mm {
            return Ok(LargestRadius { radius_mm: Some(most_mm), limit: RadiusLimit::Asked });
        }
        let next = (2.0 * holds).min(most_mm);
        match test(next) {
            None => holds = next,
            Some(limit) => break (next, limit),
        }
    };
    // Fifty halvings exhaust a double whatever was asked for.
    for _ in 0..50 {
        if over - holds <= relative.max(f64::EPSILON) * over {
            break;
        }
        let middle = 0.5 * (holds + over);
        match test(middle) {
            None => holds = middle,
            Some(why) => (over, limit) = (middle, why),
        }
    }
    Ok(LargestRadius { radius_mm: Some(holds), limit })
}
