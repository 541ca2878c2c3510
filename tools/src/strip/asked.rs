//! What is asked of a strip, and what comes back.

use crate::contact::ContactError;
use osculate_geom::Degenerate;
use osculate_geom::roots::RootError;

/// The strip left at a contact. Lengths are arc lengths on the part across the feed, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, analytic::Plane, uv};
/// use osculate_tools::strip::{StripError, exact};
/// use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean};
/// // Lifted by 0.02 mm the tool leaves more than a tolerance of 0.01 mm right at the contact.
/// let range = Interval::new(0.0, 50.0);
/// let plane = Plane::new(Domain { u: range, v: range });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
/// let contact = Contact::new(&plane, uv(25.0, 25.0), &ball, FeedLine::Iso(Axis::U), Lean::default())?;
/// assert!(matches!(exact(&contact.lifted(0.02), 0.01), Err(StripError::AboveTolerance { .. })));
/// assert!(matches!(exact(&contact, 0.0), Err(StripError::Tolerance { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
    /// The tool, elsewhere on its way, comes over the contact too deep.
    #[error(
        "the tool's far side goes {dip_mm:.4} mm below the part at the contact, more than the {deepest_mm:.4} mm \
         accepted: use a larger lead or a smaller tool"
    )]
    TooDeep {
        /// Depth, mm.
        dip_mm: f64,
        /// Greatest depth accepted, mm.
        deepest_mm: f64,
    },
    /// The cross line could not be followed.
    #[error(transparent)]
    Degenerate(#[from] Degenerate),
    /// The edge of the strip did not converge.
    #[error("the edge of the strip did not converge: {0}")]
    Edge(#[from] RootError),
}

/// How much is asked of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Where another passage of the tool goes deeper than this below the contact there is no answer, mm.
    pub deepest_mm: f64,
    /// Error of the width that may be left, of the width; zero: down to rounding.
    pub relative: f64,
}
