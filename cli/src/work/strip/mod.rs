//! What one contact leaves: the strip, exact and by every closed form, how part and tool bend there, and how the tolerance is shared.

mod instant;
mod sharing;
mod turns;

pub use instant::{Engaged, Instant, Teeth};
pub use sharing::{BestShare, Cap, Sharing};
pub use turns::{Bends, Dupin, Turns};

use crate::job::Job;
use osculate_productivity::closed_form::{self, DomainError, Section};
use osculate_productivity::rate::Caps;
use osculate_tools::Contact;
use osculate_tools::strip::{self, StripError};
use serde::Serialize;
use std::collections::BTreeMap;

/// The exact strip; arc lengths on the part, mm.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Exact {
    /// From edge to edge.
    pub width_mm: f64,
    /// To the left of the feed.
    pub left_mm: f64,
    /// To its right.
    pub right_mm: f64,
    /// How deep the tool goes into the part beside the contact.
    pub undercut_mm: f64,
    /// Estimate of the numerical error of the width.
    pub error_mm: f64,
    /// Whether the strip ends at an edge of the face: left, right.
    pub ends_at_edge: [bool; 2],
}

/// A closed form's value, or why it has none.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Form {
    /// Width, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width_mm: Option<f64>,
    /// Why the form has no value here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why_not: Option<String>,
    /// The lead that the form goes with, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead_deg: Option<f64>,
}

/// Closed forms by name.
pub type Forms = BTreeMap<&'static str, Form>;

/// A range of curvatures, 1/mm.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct MinMax {
    /// The least.
    pub min: f64,
    /// The greatest; absent for a sharp edge, whose curvature is infinite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
}

/// The mark of one tooth along the feed at the whole tolerance: the longest feed per tooth.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Marks {
    /// The exact mark, mm; absent where it has no end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact_mm: Option<f64>,
    /// Closed forms [R97, eqs. 41, 42 and 44].
    pub closed_forms: Forms,
}

/// What `strip` tells of a contact.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Answer {
    /// The strip.
    pub exact: Exact,
    /// Closed forms of its width.
    pub closed_forms: Forms,
    /// The least and the greatest curvature of tool against part.
    pub relative_curvature_per_mm: MinMax,
    /// Why the tool digs in next to the contact, with what would fit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub does_not_fit: Option<String>,
    /// Feed of the widest strip, degrees from `S_u` towards `S_v`.
    pub widest_direction_deg: f64,
    /// The longest feed per tooth by [R97, eq. 41], mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_feed_per_tooth_mm: Option<f64>,
    /// The mark of one tooth.
    pub feed_per_tooth: Marks,
    /// Curvatures in directions.
    #[serde(flatten)]
    pub turns: Turns,
    /// Productivity over the share of marks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sharing: Option<Sharing>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_sharing: Option<String>,
    /// Productivity as the tool passes; absent where the sides of the strip fold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub instant: Option<Instant>,
}

/// What a job says besides the contact.
#[derive(Clone, Copy, Debug)]
pub struct Passing {
    /// Tolerance, mm.
    pub scallop_mm: f64,
    /// Caps of the feed, where a spindle speed is given.
    pub caps: Option<Caps>,
    /// Feed, mm/min.
    pub feed_mm_min: f64,
    /// Layer on the part, mm.
    pub layer_mm: f64,
    /// Edges of the tool.
    pub teeth: Option<u32>,
}

impl Passing {
    /// As a job says it.
    #[must_use]
    pub fn of(job: &Job) -> Self {
        Self {
            scallop_mm: job.tolerance().scallop_mm,
            caps: job.caps(),
            feed_mm_min: job.feed_mm_min(),
            layer_mm: job.layer_mm(),
            teeth: job.tool().teeth(),
        }
    }
}

fn form(value: Result<f64, DomainError>, lead_deg: Option<f64>) -> Form {
    match value {
        Ok(w) => Form { width_mm: Some(w), why_not: None, lead_deg },
        Err(e) => Form { width_mm: None, why_not: Some(e.to_string()), lead_deg: None },
    }
}

impl Answer {
    /// Of a contact.
    ///
    /// # Errors
    /// [`StripError`]: there is no strip.
    pub fn of(contact: &Contact<'_>, passing: Passing) -> Result<Self, StripError> {
        let Passing { scallop_mm, caps, feed_mm_min, layer_mm, teeth } = passing;
        let exact = strip::exact(contact, scallop_mm)?;
        let q = contact.relative();
        let (left, tangent) = (contact.frame.left.into_inner(), contact.frame.tangent.into_inner());
        let [part_across, part_along] = [left, tangent].map(|d| contact.forms.normal_curvature(&d));
        let section =
            |part_per_mm: f64, d| Section { part_per_mm, tool_per_mm: q.along(d) - part_per_mm, scallop_mm };
        let (across, lengthwise) = (section(part_across, &left), section(part_along, &tangent));
        let mut closed_forms = Forms::from([
            ("r97_37", form(closed_form::width_37(across), None)),
            ("r97_38", form(closed_form::chord_38(across), None)),
            ("r97_40", form(closed_form::linear_40(across), None)),
            ("leading_order", form(closed_form::leading_order(across), None)),
            ("leading_order_swept", form(closed_form::leading_order_swept(&q, &left, scallop_mm), None)),
        ]);
        let cutter = contact.cutter;
        if cutter.is_ball() {
            let width = closed_form::two_axis_ball(cutter.radius_mm(), scallop_mm);
            closed_forms.insert("m86_2cl", form(width, None));
        } else {
            let (arc, lead) = (cutter.touching(contact.lean.lead_rad), contact.lean.lead_rad);
            let (core, corner) = (arc.centre_rho_mm, arc.radius_mm);
            let three = closed_form::three_axis_toroidal(core, corner, lead, part_across, scallop_mm);
            closed_forms.insert("m86_3c", form(three, None));
            let five = closed_form::five_axis_flat(core, corner, part_along, part_across, scallop_mm);
            let lead = five.as_ref().ok().map(|f| f.lead_rad.to_degrees());
            closed_forms.insert("m86_5c", form(five.map(|f| f.width_mm), lead));
        }
        // The tool of a sharp edge has no arc along the feed.
        let round = lengthwise.tool_per_mm.is_finite();
        let along = |width: Result<f64, DomainError>| form(width, None);
        let marks = if round {
            Forms::from([
                ("r97_41", along(closed_form::width_37(lengthwise))),
                ("r97_42", along(closed_form::chord_38(lengthwise))),
                ("r97_44", along(closed_form::linear_40(lengthwise))),
                ("leading_order", along(closed_form::leading_order(lengthwise))),
            ])
        } else {
            Forms::new()
        };
        let sharing = Sharing::of(contact, scallop_mm, caps);
        // The feed lies across the eigenvector of Q's smaller eigenvalue.
        let widest = contact.forms.normal.cross(&q.d_min);
        Ok(Self {
            exact: Exact {
                width_mm: exact.width_mm,
                left_mm: exact.left_mm,
                right_mm: exact.right_mm,
                undercut_mm: exact.undercut_mm,
                error_mm: exact.error_mm,
                ends_at_edge: exact.at_edge,
            },
            closed_forms,
            relative_curvature_per_mm: MinMax { min: q.min, max: q.max.is_finite().then_some(q.max) },
            does_not_fit: contact.fits().err().map(|e| e.to_string()),
            widest_direction_deg: turns::line_deg(&turns::frame(contact), &widest),
            max_feed_per_tooth_mm: marks.get("r97_41").and_then(|f| f.width_mm),
            feed_per_tooth: Marks {
                exact_mm: strip::mark(contact, scallop_mm).ok().map(|m| m.length_mm()),
                closed_forms: marks,
            },
            turns: Turns::of(contact),
            no_sharing: sharing.as_ref().err().map(ToString::to_string),
            sharing: sharing.ok(),
            instant: Instant::of(contact, &exact, (feed_mm_min, layer_mm, teeth)).ok(),
        })
    }
}
