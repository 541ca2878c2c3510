//! How part and tool bend at a contact along every tangent: radii along and across the feed, Dupin's indicatrices and that of conformity.

use osculate_geom::indicatrix::{Conformity, DupinKind, dupin_kind};
use osculate_geom::{ToolCurvature, Vec3};
use osculate_tools::Contact;
use serde::Serialize;

/// Directions of the indicatrices over a whole turn.
const DIRECTIONS: u32 = 120;
/// Curvatures that are smaller than this part of the sum of all four count as none.
const FLAT: f64 = 1e-9;

/// Curvatures of part and tool in one direction, 1/mm: convex positive. Radii are their reciprocals.
#[derive(Clone, Copy, Debug, Serialize)]
#[non_exhaustive]
pub struct Bends {
    /// Of the part [R97, eqs. 55, 57, 59 and 61].
    pub part_per_mm: f64,
    /// Of the tool [R97, eqs. 56, 58, 60 and 62]; absent across a sharp edge, whose curvature is infinite.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_per_mm: Option<f64>,
}

/// What Dupin's indicatrix is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Dupin {
    /// Bent to one side all around.
    Ellipse,
    /// Bent to both sides: a saddle.
    Hyperbolas,
    /// Straight in one direction.
    ParallelLines,
    /// Straight in all.
    Flat,
    /// A sharp edge.
    Edge,
}

impl Dupin {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Ellipse => "ellipse",
            Self::Hyperbolas => "hyperbolas",
            Self::ParallelLines => "parallel lines",
            Self::Flat => "flat: none",
            Self::Edge => "edge: none",
        }
    }
}

/// The indicatrices in directions around the normal, and what R97 reads off them. Angles from `S_u` towards `S_v` in the tangent plane.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Turns {
    /// Along the feed.
    pub along_feed: Bends,
    /// Across it.
    pub across_feed: Bends,
    /// The shape of Dupin's indicatrix of the part.
    pub dupin_part: Dupin,
    /// Of the tool.
    pub dupin_tool: Dupin,
    /// The feed's direction, degrees.
    pub feed_deg: f64,
    /// Feed that the smallest radius of conformity asks for, degrees [R97, after eq. 63]; absent where part or tool has no radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claimed_direction_deg: Option<f64>,
    /// Angle between it and the feed of the widest strip, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claimed_off_deg: Option<f64>,
    /// Directions, degrees.
    pub angle_deg: Vec<f64>,
    /// Dupin's indicatrix of the part, root mm [R97, eqs. 51 and 53]: negative where it is hollow, null where it is straight.
    pub dupin_part_root_mm: Vec<Option<f64>>,
    /// That of the tool [R97, eqs. 52 and 54].
    pub dupin_tool_root_mm: Vec<Option<f64>>,
    /// The indicatrix of conformity [R97, eq. 63].
    pub conformity_root_mm: Vec<Option<f64>>,
}

/// The tangent frame in which angles are told: `S_u`'s direction, and the one a right angle from it towards `S_v`.
pub(super) fn frame(contact: &Contact<'_>) -> [Vec3; 2] {
    let side = contact.surface.jet2(contact.at).side.sign();
    [contact.forms.frame[0].into_inner(), contact.forms.frame[1].into_inner() * side]
}

/// The angle of a line with a direction, degrees in (-90, 90].
pub(super) fn line_deg([e1, e2]: &[Vec3; 2], direction: &Vec3) -> f64 {
    let angle = direction.dot(e2).atan2(direction.dot(e1)).to_degrees();
    if angle > 90.0 {
        angle - 180.0
    } else if angle <= -90.0 {
        angle + 180.0
    } else {
        angle
    }
}

/// The tool's curvature along a tangent.
fn tool_per_mm(tool: &ToolCurvature, across: &Vec3, direction: &Vec3) -> f64 {
    let (c, s) = (direction.dot(&tool.direction), direction.dot(across));
    // A sharp edge is bent along itself alone.
    let along = if c == 0.0 { 0.0 } else { tool.along * c * c };
    along + tool.across * s * s
}

fn shape(kind: DupinKind) -> Dupin {
    match kind {
        DupinKind::Ellipse => Dupin::Ellipse,
        DupinKind::Hyperbolas => Dupin::Hyperbolas,
        DupinKind::ParallelLines => Dupin::ParallelLines,
        _ => Dupin::Flat,
    }
}

impl Turns {
    /// Of a contact.
    #[must_use]
    pub fn of(contact: &Contact<'_>) -> Self {
        let (forms, normal) = (&contact.forms, contact.forms.normal);
        let tool = contact.lean.tool_curvature(contact.cutter, &contact.frame);
        let side = normal.cross(&tool.direction);
        let own = frame(contact);
        let bends = |d: &Vec3| {
            let tool = tool_per_mm(&tool, &side, d);
            Bends { part_per_mm: forms.normal_curvature(d), tool_per_mm: tool.is_finite().then_some(tool) }
        };
        let part = forms.principal();
        let sum = [part.k_max, part.k_min, tool.along, tool.across].iter().map(|k| k.abs()).sum::<f64>();
        let flat = if sum.is_finite() { FLAT * sum } else { FLAT * tool.across.abs() };
        let dupin_tool = if tool.along.is_finite() {
            let mut k = part;
            (k.k_max, k.k_min) = (tool.along, tool.across);
            shape(dupin_kind(&k, flat))
        } else {
            Dupin::Edge
        };
        let root = |k: f64| (k.is_finite() && k.abs() > flat).then(|| k.signum() / k.abs().sqrt());
        let conformity = Conformity::new(*forms, tool);
        let angle_deg: Vec<f64> =
            (0..DIRECTIONS).map(|k| 360.0 * f64::from(k) / f64::from(DIRECTIONS)).collect();
        let over = |f: &dyn Fn(&Vec3) -> Option<f64>| -> Vec<Option<f64>> {
            let tangent = |deg: &f64| {
                let (s, c) = deg.to_radians().sin_cos();
                own[0] * c + own[1] * s
            };
            angle_deg.iter().map(|deg| f(&tangent(deg))).collect()
        };
        let part_root = |d: &Vec3| root(forms.normal_curvature(d));
        let tool_root = |d: &Vec3| root(tool_per_mm(&tool, &side, d));
        let claim = conformity.claim();
        let claimed = claim.radius_root_mm.is_finite();
        Self {
            along_feed: bends(&contact.frame.tangent),
            across_feed: bends(&contact.frame.left),
            dupin_part: shape(dupin_kind(&part, flat)),
            dupin_tool,
            feed_deg: line_deg(&own, &contact.frame.tangent),
            claimed_direction_deg: claimed.then(|| line_deg(&own, &normal.cross(&claim.across))),
            claimed_off_deg: claimed.then(|| claim.off_rad.to_degrees()),
            dupin_part_root_mm: over(&part_root),
            dupin_tool_root_mm: over(&tool_root),
            conformity_root_mm: over(&|d| part_root(d).and(tool_root(d)).map(|_| conformity.root_mm(d))),
            angle_deg,
        }
    }
}
