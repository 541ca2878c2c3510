//! Where a tool touches at a rule, and why it cannot be put there.

use super::rule::RuleError;
use osculate_geom::Point3;

/// Why a tool cannot be put against a rule in this way.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaceError {
    /// The rule has no frame.
    #[error(transparent)]
    Rule(#[from] RuleError),
    /// No root of the equations of three tangencies, or none with contacts from outside on both sides of the rule.
    #[error(
        "no position with three tangencies at u = {u}: residual {residual_mm:.3e} mm after {iterations} steps; the root was followed up to a radius of {reached_mm:.4} mm"
    )]
    NoRoot {
        /// The rule.
        u: f64,
        /// Least residual of the attempts, mm.
        residual_mm: f64,
        /// Steps taken.
        iterations: u32,
        /// Largest radius up to which a root was followed, mm; 0 where none was found.
        reached_mm: f64,
    },
    /// A section across the rule is too hollow.
    #[error(
        "a radius of {radius_mm} mm does not fit into the hollow along the rule at u = {u}: at most {largest_mm:.4} mm does"
    )]
    TooLarge {
        /// The rule.
        u: f64,
        /// Radius of the tool, mm.
        radius_mm: f64,
        /// Largest that fits, mm.
        largest_mm: f64,
    },
    /// The construction names no axis: a normal is missing or two points coincide.
    #[error("the construction at u = {u} gives no axis")]
    NoAxis {
        /// The rule.
        u: f64,
    },
    /// A setting that is told for cylinders only.
    #[error("the double point offset is told for cylinders only")]
    CylinderOnly,
    /// A fraction outside its range.
    #[error("the fraction of the double point offset is {fraction}; it must be at least 0 and below 1/2")]
    Fraction {
        /// The value given.
        fraction: f64,
    },
    /// No fraction of the double point offset leaves as much as it gouges.
    #[error(
        "no double point offset at u = {u} leaves as much at the ends of the rule as it gouges on it: left less gouged is {first_mm:.3e} mm with both points at the ends, {last_mm:.3e} mm with both near the middle"
    )]
    NoBalance {
        /// The rule.
        u: f64,
        /// Greatest deviation at the ends plus the lowest along the rule for the fraction 0, mm.
        first_mm: f64,
        /// The same for the largest fraction looked at, mm.
        last_mm: f64,
    },
    /// The search for the least greatest deviation did not settle.
    #[error("the least greatest deviation at u = {u} did not settle: {}", last_step(*.step_mm, *.iterations))]
    NotConverged {
        /// The rule.
        u: f64,
        /// Size of the last step, mm; infinite where none could be made.
        step_mm: f64,
        /// Rounds.
        iterations: u32,
    },
}

fn last_step(step_mm: f64, iterations: u32) -> String {
    match step_mm.is_finite() {
        true => format!("last step {step_mm:.3e} mm after {iterations} rounds"),
        false => "no step could be made from where it began".to_owned(),
    }
}

/// A place of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Parameter along the directrices; outside the strip's range where the contact lies off the face.
    pub u: f64,
    /// Parameter along the rule.
    pub v: f64,
    /// The point, mm.
    pub point: Point3,
}
