//! What the tool makes at the instant in which it passes a contact: area of the part a minute, layer a minute, chips of its teeth.

use osculate_geom::quadrature::gauss;
use osculate_geom::{Surface, Uv, uv};
use osculate_productivity::engagement::{Fineness, Outline};
use osculate_productivity::finish::{Across, Place, RateError, area_rate_mm2_min};
use osculate_productivity::given::Given;
use osculate_productivity::rough::{LayerError, layer_rate_mm3_min};
use osculate_surfaces::closest_near;
use osculate_tools::Contact;
use osculate_tools::strip::Strip;
use serde::Serialize;
use std::f64::consts::TAU;

/// Panels of the quadratures across a strip.
const PANELS: usize = 8;
/// Halvings until the edge of a strip is found among parameters: half of double precision's digits.
const HALVINGS: u32 = 50;
/// Meridians of the cutter, and its step for a layer, mm: a share of the layer, and no finer than this of the tool's radius.
const MERIDIANS: usize = 180;
const STEP_OF_LAYER: f64 = 0.1;
const LEAST_STEP: f64 = 0.005;
/// Places of the teeth in a turn from tooth to tooth.
const PHASES: u32 = 90;

/// Productivity as the tool passes the contact at the job's feed.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Instant {
    /// The feed of the contact over the part, mm/min.
    pub feed_mm_min: f64,
    /// Area of the strip passed a minute, its sides running parallel in the parameters [R97, eqs. 20, 21 and 34], mm2/min.
    pub area_mm2_min: f64,
    /// Width of the strip times the feed, mm2/min [R97, eq. 2].
    pub width_times_feed_mm2_min: f64,
    /// Thickness of the layer that stands on the part, mm: raw material declared, or what is taken for it.
    pub layer_mm: f64,
    /// Volume of the layer over the strip passed a minute, mm3/min [R97, eq. 22]; absent where normals of the part cross in the layer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layer_mm3_min: Option<f64>,
    /// What the cutter takes out of that layer; absent where the nearest point of the part is not found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engagement: Option<Engaged>,
}

/// A cutter in a layer that nobody cut before, next to it or ahead.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Engaged {
    /// Material taken a minute, mm3/min [R97, eqs. 23, 24, 27 and 28].
    pub mm3_min: f64,
    /// The angle about the axis over which the cutter is in material, degrees.
    pub arc_deg: f64,
    /// With teeth: what they take as they turn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub teeth: Option<Teeth>,
}

/// Edges in cut.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Teeth {
    /// Edges of the tool.
    pub count: u32,
    /// How many of them are in cut: fewest and most over a turn [R97, eq. 30].
    pub in_cut: [u32; 2],
    /// The least and the most that all of them take, mm3/min [R97, eq. 30]: edges without helix.
    pub mm3_min: [f64; 2],
    /// The most that one of them takes, mm3/min [R97, eq. 29].
    pub one_most_mm3_min: f64,
}

/// The end of a strip on the straight line of parameters across the feed: its distance there as the contact measures it.
fn end(surface: &dyn Surface, at: Uv, rate: Uv, arc_mm: f64) -> f64 {
    let speed = |w: f64| {
        let jet = surface.jet2(uv(at.u + rate.u * w, at.v + rate.v * w));
        (jet.du * rate.u + jet.dv * rate.v).norm()
    };
    let length = |w: f64| gauss(0.0, w, PANELS, speed).abs();
    let mut far = arc_mm;
    for _ in 0..HALVINGS {
        if length(far) >= arc_mm.abs() {
            break;
        }
        far *= 1.5;
    }
    let mut near = 0.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (near + far);
        if length(middle) < arc_mm.abs() { near = middle } else { far = middle }
    }
    0.5 * (near + far)
}

impl Instant {
    /// Of a contact and its strip, at a feed, in a layer; with teeth what they do.
    ///
    /// # Errors
    /// [`RateError`]: where the strip's sides fold.
    pub fn of(
        contact: &Contact<'_>,
        strip: &Strip,
        (feed_mm_min, layer_mm, teeth): (f64, f64, Option<u32>),
    ) -> Result<Self, RateError> {
        let (surface, at) = (contact.surface, contact.at);
        let jet = surface.jet2(at);
        let along = contact.forms.rate(&jet, &contact.frame.tangent);
        let across = contact.forms.rate(&jet, &contact.frame.left);
        let place = |w: f64| Place {
            at: uv(at.u + across.u * w, at.v + across.v * w),
            by_time: uv(along.u * feed_mm_min, along.v * feed_mm_min),
            by_across: across,
        };
        let sides = Across {
            from: end(surface, at, across, -strip.right_mm),
            to: end(surface, at, across, strip.left_mm),
            panels: PANELS,
        };
        let area_mm2_min = area_rate_mm2_min(surface, sides, place)?;
        let thickness = Given::uniform(layer_mm).ok();
        let layer_mm3_min = match thickness.map(|s| layer_rate_mm3_min(surface, &s, sides, place)) {
            Some(Err(LayerError::Rate(e))) => return Err(e),
            Some(found) => found.ok(),
            None => None,
        };
        Ok(Self {
            feed_mm_min,
            area_mm2_min,
            width_times_feed_mm2_min: strip.width_mm * feed_mm_min,
            layer_mm,
            layer_mm3_min,
            engagement: engaged(contact, (feed_mm_min, layer_mm, teeth)),
        })
    }
}

fn engaged(contact: &Contact<'_>, (feed, layer_mm, teeth): (f64, f64, Option<u32>)) -> Option<Engaged> {
    let cutter = contact.cutter;
    let step_mm = (STEP_OF_LAYER * layer_mm).max(LEAST_STEP * cutter.radius_mm());
    let outline = Outline::new(cutter, Fineness { meridians: MERIDIANS, step_mm });
    let moving = contact.lean.moving(cutter, &contact.frame, contact.lift_mm, (feed, [0.0; 2]));
    let mut lost = false;
    let found = outline.engaged(&moving, |p| {
        let Ok(foot) = closest_near(contact.surface, p, contact.at) else {
            lost = true;
            return -layer_mm;
        };
        let height =
            contact.surface.jet2(foot.uv).normal().map_or(foot.distance_mm, |n| (p - foot.point).dot(&n));
        // Beside the face nothing stands.
        if foot.distance_mm > height.abs() + 1e-3 * layer_mm { -layer_mm } else { layer_mm - height }
    });
    if lost {
        return None;
    }
    let of_teeth = |count: u32| {
        let pitch = TAU / f64::from(count);
        let phases = (0..PHASES).map(|k| pitch * f64::from(k) / f64::from(PHASES));
        let mut out =
            Teeth { count, in_cut: [count, 0], mm3_min: [f64::INFINITY, 0.0], one_most_mm3_min: 0.0 };
        for phase in phases {
            let all = found.rate_of_teeth(count, phase);
            out.mm3_min = [out.mm3_min[0].min(all), out.mm3_min[1].max(all)];
            let each =
                (0..count).map(|j| found.rate_of_teeth(1, phase + pitch * f64::from(j)) / f64::from(count));
            out.one_most_mm3_min = each.fold(out.one_most_mm3_min, f64::max);
            let cutting = found.teeth_in_cut(count, phase);
            out.in_cut = [out.in_cut[0].min(cutting), out.in_cut[1].max(cutting)];
        }
        out
    };
    Some(Engaged {
        mm3_min: found.rate(),
        arc_deg: found.arc_rad().to_degrees(),
        teeth: teeth.filter(|z| *z > 0).map(of_teeth),
    })
}
