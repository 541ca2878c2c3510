//! The largest cylinder that holds the tolerance, setting by setting: what D98 proposes its own for.

use super::methods::{SAMPLES, Study, setting_of};
use osculate_tools::flank::{RadiusLimit, RadiusSearch, RadiusSearchError, Stations, largest_radius};
use serde::Serialize;

/// The settings at a rule, by the names of the methods.
const SETTINGS: [&str; 6] =
    ["standard_a", "standard_b", "double_point_offset", "double_point_balanced", "optimum", "static_minimax"];
/// Radii that are looked at, mm: from finer than any mill to more than any.
const RADII_MM: [f64; 2] = [0.01, 500.0];
/// Relative accuracy of a radius.
const RELATIVE: f64 = 1e-7;
/// Rules of a span.
const RULES: usize = 33;

/// A radius with what keeps it from being larger.
#[derive(Debug, Clone, Serialize)]
pub struct Radius {
    /// The largest, mm; None where not even the least that is looked at holds.
    pub radius_mm: Option<f64>,
    /// What ends it, in words.
    pub limited_by: String,
}

/// The largest radii of a setting.
#[derive(Debug, Clone, Serialize)]
pub struct Largest {
    /// The setting, by the name of its method.
    pub name: &'static str,
    /// At the rule that is asked for.
    pub at_rule: Radius,
    /// Of one cylinder at all rules of the span.
    pub over_span: Radius,
}

fn words(limit: &RadiusLimit) -> String {
    match limit {
        RadiusLimit::Asked => format!("nothing up to {} mm", RADII_MM[1]),
        RadiusLimit::Tolerance { u, deviation_mm } if *deviation_mm < 0.0 => {
            format!("a gouge of {:.4} mm at u = {u:.4}", -deviation_mm)
        }
        RadiusLimit::Tolerance { u, deviation_mm } => format!("{deviation_mm:.4} mm left at u = {u:.4}"),
        RadiusLimit::ContactOutside { u } => format!("a contact off the face at u = {u:.4}"),
        RadiusLimit::Hollow { u, largest_mm } => {
            format!("a hollow at u = {u:.4}, which {largest_mm:.4} mm fill")
        }
        RadiusLimit::NoPosition(why) => why.to_string(),
    }
}

impl Study<'_> {
    /// The largest cylinders whose static deviation at rules stays within the smaller of the tolerances above and below the face. The
    /// cutter of the study does not matter.
    ///
    /// # Errors
    /// [`RadiusSearchError`] where the tolerances are no bounds.
    pub fn largest(&self) -> Result<Vec<Largest>, RadiusSearchError> {
        let stations = self.stations();
        let how = RadiusSearch {
            tolerance_mm: self.tolerance[0].min(self.tolerance[1]),
            least_mm: RADII_MM[0],
            most_mm: RADII_MM[1],
            relative: RELATIVE,
            samples: SAMPLES,
        };
        let rules: Vec<f64> = (0..RULES).map(|k| self.span.at(k as f64 / (RULES - 1) as f64)).collect();
        let one = |name: &'static str| {
            let setting = setting_of(name).expect("a setting at a rule");
            let of = |rules: &[f64], stations: &Stations| {
                let found = largest_radius(self.strip, stations, rules, setting, &how)?;
                Ok(Radius { radius_mm: found.radius_mm, limited_by: words(&found.limit) })
            };
            Ok(Largest { name, at_rule: of(&[self.at_u], &stations)?, over_span: of(&rules, &stations)? })
        };
        SETTINGS.into_iter().map(one).collect()
    }
}
