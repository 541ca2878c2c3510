//! By how much the standard setting deviates more than three tangencies, over the radius: figures 9 and 10 of D98 for a rule of
//! one's own.
//!
//! The ratio is that of the greatest |delta| along the rule. *Exact* is by the settings on the face itself; the rest by the
//! closed form of the middle rule of a hyperbolic paraboloid of the same length and twist, whose directrices are straight
//! ([`MiddleRule::three_tangent`]). A curve ends at the first radius without three tangencies.

use super::methods::Study;
use osculate_tools::flank::closed::MiddleRule;
use osculate_tools::flank::{RuleError, Setting, SideTool, Stations, place};
use rayon::prelude::*;
use serde::Serialize;

/// Radii of a curve.
const RADII: usize = 48;
/// The largest radius: in rules' lengths, as far as the figures of the paper go, and in radii of the cutter.
const MOST: [f64; 2] = [1.0, 1.25];
/// Lengths and twists beside the rule's own, as parts of it: those of figure 9.
const FACTORS: [f64; 5] = [0.25, 0.5, 1.0, 1.5, 2.0];
/// Larger half twists are not drawn: the end normals are nearly opposite, and no cutter touches three times.
const MOST_DEG: f64 = 85.0;
/// Samples along a rule; extremes are closed in on between them.
const SAMPLES: usize = 65;
/// Stations of a directrix between two breaks.
const STATIONS: usize = 64;
/// Halvings of the last step before a curve ends: a hundred thousandth of it.
const HALVINGS: usize = 17;
/// Radii that close in on the end of a curve, each halfway from the one before.
const CLOSER: i32 = 8;
/// Deviations below are rounding, and so is their ratio, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Why there is no ratio.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoRatio {
    /// The figures are of cylinders.
    #[error("the ratio of the errors over the radius is told for cylinders only")]
    NoCylinder,
    /// The rule has no frame.
    #[error(transparent)]
    Rule(#[from] RuleError),
    /// The end normals are parallel: no setting deviates.
    #[error(
        "the end normals of the rule enclose {twist_deg:.4} degrees: no setting deviates, and there is no ratio"
    )]
    NoTwist {
        /// Between the end normals, degrees.
        twist_deg: f64,
    },
}

/// The ratio over the radius for one length and twist.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Curve {
    /// Length of the rule, mm.
    pub rule_mm: f64,
    /// Half the angle between the end normals, degrees.
    pub half_twist_deg: f64,
    /// Rising, mm.
    pub radius_mm: Vec<f64>,
    /// Standard over three tangencies at each.
    pub ratio: Vec<f64>,
    /// The least of these radii with a contact off the face, mm; None where all contacts lie on it.
    pub off_face_from_mm: Option<f64>,
    /// The radius at which the curve ends, mm; None where it goes on.
    pub ends_at_mm: Option<f64>,
    /// Why it ends, empty where it goes on.
    pub ends_by: String,
}

/// Exact beside approximate at the cutter's own radius.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AtRadius {
    /// R, mm.
    pub radius_mm: f64,
    /// By the settings on the face; None without three tangencies.
    pub exact: Option<f64>,
    /// By the closed form; None without three tangencies.
    pub closed: Option<f64>,
    /// Closed against exact, per cent of the exact.
    pub difference_percent: Option<f64>,
}

/// The ratios around a rule.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Ratios {
    /// At the cutter's radius.
    pub own: AtRadius,
    /// On the rule itself, by the settings.
    pub exact: Curve,
    /// The closed form of its length and twist.
    pub closed: Curve,
    /// The closed form for other lengths, the twist kept: figure 9.
    pub lengths: Vec<Curve>,
    /// The closed form for other twists, the length kept: figure 10.
    pub twists: Vec<Curve>,
}

/// A ratio, and whether all contacts lie on the face; None where rounding hides it.
type Found = Result<Option<(f64, bool)>, String>;

/// The curve of what is found at each radius, up to where nothing is.
fn curve(rule_mm: f64, half_twist_deg: f64, radii: &[f64], found: impl Fn(f64) -> Found + Sync) -> Curve {
    let all: Vec<Found> = radii.par_iter().map(|r| found(*r)).collect();
    let mut points: Vec<(f64, (f64, bool))> = Vec::new();
    let mut holds = 0.0;
    let mut end = None;
    for (radius, one) in radii.iter().zip(all) {
        match one {
            Ok(value) => {
                points.extend(value.map(|v| (*radius, v)));
                holds = *radius;
            }
            Err(why) => {
                end = Some((*radius, why));
                break;
            }
        }
    }
    let end = end.map(|(mut over, mut why)| {
        let before = points.last().map_or(0.0, |p| p.0);
        let mut last = None;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (holds + over);
            match found(middle) {
                Ok(value) => (holds, last) = (middle, value),
                Err(reason) => (over, why) = (middle, reason),
            }
        }
        points.extend(last.map(|v| (holds, v)));
        // The ratio falls steeply before three tangencies end.
        let from = if before < holds { before } else { points.iter().rev().nth(1).map_or(0.0, |p| p.0) };
        let closer = (1..=CLOSER).map(|j| holds - (holds - from) * 0.5_f64.powi(j));
        points.extend(closer.filter_map(|r| Some((r, found(r).ok()??))).collect::<Vec<_>>());
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        (holds, why)
    });
    let (ends_at_mm, ends_by) = end.map_or_else(|| (None, String::new()), |(at, why)| (Some(at), why));
    Curve {
        rule_mm,
        half_twist_deg,
        radius_mm: points.iter().map(|p| p.0).collect(),
        ratio: points.iter().map(|p| p.1.0).collect(),
        off_face_from_mm: points.iter().find(|p| !p.1.1).map(|p| p.0),
        ends_at_mm,
        ends_by,
    }
}

/// The closed form of a length and a twist.
fn closed(model: MiddleRule, reach_mm: f64) -> Found {
    let three = model.three_tangent().ok_or_else(|| {
        format!(
            "no three tangencies at a rule of {:.4} mm with end normals at {:.4} degrees from its middle's",
            model.height_mm,
            model.half_twist_rad.to_degrees()
        )
    })?;
    Ok(Some((model.standard_depth_mm() / three.depth_mm, three.contact_mm <= reach_mm)))
}

impl Study<'_> {
    /// The ratio by the settings on the face, up to the largest radius that its hollow takes.
    fn exact_ratio(&self, stations: &Stations, largest_mm: f64, radius_mm: f64) -> Found {
        if radius_mm > largest_mm {
            return Err(format!("at most R = {largest_mm:.4} mm fits into the hollow along the rule"));
        }
        let tool = SideTool::cylinder(radius_mm).map_err(|e| e.to_string())?;
        let worst = |setting: Setting| {
            let placed = place(self.strip, stations, self.at_u, tool, setting).map_err(|e| e.to_string())?;
            let on_face = placed.touches.iter().all(|t| self.strip.u_domain().contains(t.u));
            Ok::<_, String>((placed.profile(self.strip, stations, &tool, SAMPLES).max_abs_mm(), on_face))
        };
        let (standard, (three, on_face)) = (worst(Setting::Distributed)?.0, worst(Setting::ThreeTangent)?);
        Ok((three >= ROUNDING_MM).then_some((standard / three, on_face)))
    }

    /// The ratios around the rule of the study.
    ///
    /// # Errors
    /// [`NoRatio`].
    pub fn ratios(&self) -> Result<Ratios, NoRatio> {
        if !self.is_cylinder() {
            return Err(NoRatio::NoCylinder);
        }
        let rule = self.strip.rule(self.at_u)?;
        let (height_mm, half) = (rule.length_mm, 0.5 * rule.twist_rad().abs());
        // Of 1e-3 degrees both errors of the closed form are beyond rounding for any mill.
        if half.to_degrees() < 1e-3 {
            return Err(NoRatio::NoTwist { twist_deg: 2.0 * half.to_degrees() });
        }
        let own_mm = self.cutter.radius_mm();
        let most = (MOST[0] * height_mm).max(MOST[1] * own_mm);
        let mut radii: Vec<f64> = (1..=RADII).map(|k| most * k as f64 / RADII as f64).collect();
        radii.push(own_mm);
        radii.sort_by(f64::total_cmp);
        radii.dedup();
        // The closed form's contacts lie as far on either side; the nearest end of a directrix is first reached.
        let u = self.strip.u_domain();
        let reach_mm = [0, 1]
            .into_iter()
            .flat_map(|end: usize| {
                [u.lo, u.hi].map(|u| (self.strip.point_at(u, end as f64) - rule.ends[end].point).norm())
            })
            .fold(f64::INFINITY, f64::min);
        let model = MiddleRule { height_mm, half_twist_rad: half, radius_mm: own_mm };
        let by_form = |m: MiddleRule| {
            curve(m.height_mm, m.half_twist_rad.to_degrees(), &radii, |radius_mm| {
                closed(MiddleRule { radius_mm, ..m }, reach_mm)
            })
        };
        let stations = Stations::beyond(self.strip, STATIONS, self.beyond);
        let largest_mm = rule.largest_fit_mm();
        let exact =
            curve(height_mm, half.to_degrees(), &radii, |r| self.exact_ratio(&stations, largest_mm, r));
        let own = {
            let exact = self.exact_ratio(&stations, largest_mm, own_mm).ok().flatten().map(|f| f.0);
            let closed = closed(model, reach_mm).ok().flatten().map(|f| f.0);
            let difference_percent = exact.zip(closed).map(|(e, c)| 100.0 * (c - e) / e);
            AtRadius { radius_mm: own_mm, exact, closed, difference_percent }
        };
        let twists =
            FACTORS.map(|f| f * half).into_iter().filter(|a| *a == half || a.to_degrees() < MOST_DEG);
        Ok(Ratios {
            own,
            exact,
            closed: by_form(model),
            lengths: FACTORS.map(|f| by_form(MiddleRule { height_mm: f * height_mm, ..model })).to_vec(),
            twists: twists.map(|half_twist_rad| by_form(MiddleRule { half_twist_rad, ..model })).collect(),
        })
    }
}
