//! What is asked of a strip on a chart, and what comes back.

use crate::contact::ContactError;

/// What is asked of a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Within {
    /// Height that may be left, mm.
    pub scallop_mm: f64,
    /// Undercut that may stay; where the tool would dip deeper it is lifted by the rest, mm.
    pub gouge_mm: f64,
}

/// A strip on a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearly {
    /// `left_mm + right_mm`.
    pub width_mm: f64,
    /// From the contact to the edge on the left of the feed (towards `n x t`), mm.
    pub left_mm: f64,
    /// From the contact to the edge on the right of the feed, mm.
    pub right_mm: f64,
    /// Nearly the width at a tolerance that is larger by the chart's error, mm: much more than `width_mm` where a wave of the part ends
    /// the strip by less than that.
    pub most_mm: f64,
    /// Undercut after the lift, mm, that of the cutter's far side over the contact and the strip's ends
    /// included.
    pub undercut_mm: f64,
    /// Lift, mm.
    pub lift_mm: f64,
}

/// Why a chart has no strip.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ChartError {
    /// The strip, or the instant at which the tool is deepest, lies outside the chart.
    #[error("the strip reaches beyond the chart's radius of {radius_mm} mm")]
    Beyond {
        /// The chart's radius.
        radius_mm: f64,
    },
    /// The tool stands above the tolerance at the contact.
    #[error("at the contact the tool stands {standoff_mm} mm above the part")]
    Above {
        /// Standoff, mm.
        standoff_mm: f64,
    },
    /// An impossible lean.
    #[error(transparent)]
    Contact(#[from] ContactError),
}
