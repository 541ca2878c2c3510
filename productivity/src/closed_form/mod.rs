//! Closed forms of strip width and feed, each with its domain, its order and the exact form beside it.
//!
//! All widths are arc lengths on the part, mm, for a tolerance `scallop_mm` = h. Curvatures are convex positive.
//! The exact width they approximate is [`osculate_tools::strip::exact`]; every form here tends to it as h -> 0, with
//! a relative error of first order in h times the curvatures at hand unless it says otherwise.

mod batch;
mod marciniak;
mod radzevich;

pub use batch::{LengthError, Sections};
pub use marciniak::{
    FiveAxis, contour_per_mm, five_axis_flat, five_axis_refined, three_axis_flat, three_axis_toroidal,
    two_axis_ball,
};
pub use radzevich::{Section, acos_37, chord_38, leading_order, leading_order_swept, linear_40, width_37};

/// Why a closed form has no value.
///
/// ```
/// use osculate_productivity::closed_form::{DomainError, Section, width_37};
///
/// // A ball of 10 mm does not go into a hollow of 8 mm.
/// let section = Section { part_per_mm: -1.0 / 8.0, tool_per_mm: 1.0 / 10.0, scallop_mm: 0.01 };
/// assert!(matches!(width_37(section), Err(DomainError::DoesNotFit { .. })));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DomainError {
    /// The tolerance is not positive and finite.
    #[error("the tolerance must be positive and finite, got {got} mm")]
    Tolerance {
        /// The value, mm.
        got: f64,
    },
    /// A radius or curvature that the form cannot take.
    #[error("{what} must be {need}, got {got}")]
    Value {
        /// Which quantity.
        what: &'static str,
        /// The condition.
        need: &'static str,
        /// The value.
        got: f64,
    },
    /// The tool is not more curved than the part is hollow: it touches along a line or digs in.
    #[error(
        "the tool does not fit: part {part_per_mm} 1/mm and tool {tool_per_mm} 1/mm add up to {sum_per_mm} 1/mm, not above zero"
    )]
    DoesNotFit {
        /// Curvature of the part.
        part_per_mm: f64,
        /// Curvature of the tool.
        tool_per_mm: f64,
        /// Their sum.
        sum_per_mm: f64,
    },
    /// The tolerance is too large for the arcs: they do not meet at that height.
    #[error(
        "a tolerance of {scallop_mm} mm is beyond the arcs of curvature {part_per_mm} and {tool_per_mm} 1/mm"
    )]
    TooTall {
        /// The tolerance, mm.
        scallop_mm: f64,
        /// Curvature of the part.
        part_per_mm: f64,
        /// Curvature of the tool.
        tool_per_mm: f64,
    },
    /// A two-contact posture needs a part that is hollow enough across the feed.
    #[error(
        "no two-contact posture: the part's curvature across the feed is {got_per_mm} 1/mm and must be below {need_per_mm} 1/mm"
    )]
    NotHollow {
        /// Curvature across the feed.
        got_per_mm: f64,
        /// What it must stay below.
        need_per_mm: f64,
    },
}

fn check_tolerance(h: f64) -> Result<(), DomainError> {
    if h > 0.0 && h.is_finite() { Ok(()) } else { Err(DomainError::Tolerance { got: h }) }
}
