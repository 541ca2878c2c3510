//! Where a part stands up beside a face: the places of its border beyond which a tool on it would meet what is there.
//!
//! Beyond the border a ball half as wide as the tool, that touches the face's tangent plane, comes to lie in whatever stands up there,
//! upright, leaning or rounded by no more than the tool's own radius; what goes on, falls away or rises gently it only touches. A wall that meets
//! the border at a right angle is met on this side of the border as well, and does not count.

use super::samples::{Wanted, samples};
use super::{Named, WallEdges};
use osculate_geom::{Surface, Unit3, Uv, Vec3, uv};
use osculate_tools::Cutter;
use osculate_tools::reach::{ObstacleKind, ObstaclePoint, Obstacles};
use osculate_tools::removal::{Sample, SamplingError, sample_boundary};

/// Spacing of places along the border, of the tool's radius.
const ALONG: f64 = 0.4;
/// The ball: its radius, how far it lies beyond the border, and how far on this side of it a wall across the border is looked for, of the tool's.
const BALL: f64 = 0.5;
const BEYOND: f64 = 0.35;
const BEFORE: f64 = 0.8;
/// What comes this much nearer to the middle of the ball than its surface, of its radius, is a wall: faces that rise by 9 degrees or more.
const INSIDE: f64 = 0.88;
/// How far from the border its outer side is told from its inner one, of the tool's radius.
const ASIDE: f64 = 0.05;
/// Points of the faces around stand so far apart, of the radius.
const APART: f64 = 0.15;
/// Most points over all faces around, and fewest of one.
const MOST: f64 = 4e5;
const FEWEST: usize = 60;
/// The places along the outlines of a face, closed polylines of its parameters, beyond which a tool meets one of the faces around.
///
/// # Errors
/// A face that cannot be sampled, by its name.
pub fn wall_edges(
    (surface, outlines): (&dyn Surface, &[Vec<Uv>]),
    others: &[Named<'_>],
    cutter: &Cutter,
) -> Result<WallEdges, (String, SamplingError)> {
    let radius_mm = cutter.radius_mm();
    let all: Vec<&Named<'_>> = others.iter().collect();
    let wanted = Wanted { spacing_mm: APART * radius_mm, most: MOST, fewest: FEWEST };
    let around = samples(&all, wanted)?;
    let points = around.iter().flat_map(|f| &f.samples).map(|s| ObstaclePoint {
        point: s.point,
        owner: s.face,
        kind: ObstacleKind::Part,
    });
    // Samples have finite coordinates, and there are far fewer than an index can hold.
    let around = Obstacles::new(points).unwrap_or_default();
    let mut points = Vec::new();
    for outline in outlines {
        let places = sample_boundary(surface, outline, 0, ALONG * radius_mm);
        let n = places.len();
        for (k, s) in places.iter().enumerate() {
            let way = places[(k + 1) % n].point - places[(k + n - 1) % n].point;
            let Some(out) = outward(surface, s, &way, ASIDE * radius_mm) else { continue };
            let met = |aside: f64| {
                let middle = s.point + (s.normal.scale(BALL) + out * aside) * radius_mm;
                around.is_near(&middle, INSIDE * BALL * radius_mm)
            };
            if met(BEYOND) && !met(-BEFORE) {
                points.push(s.point);
            }
        }
    }
    Ok(WallEdges { points })
}

/// The direction at right angles to a border that leaves the face; None where it is no border.
fn outward(surface: &dyn Surface, place: &Sample, way: &Vec3, by_mm: f64) -> Option<Vec3> {
    let jet = surface.jet2(place.uv);
    let forms = jet.forms().ok()?;
    let side = Unit3::try_new(place.normal.cross(way), f64::MIN_POSITIVE)?;
    let rate = forms.rate(&jet, &side);
    let is_in = |mm: f64| surface.contains(uv(place.uv.u + rate.u * mm, place.uv.v + rate.v * mm));
    match (is_in(by_mm), is_in(-by_mm)) {
        (false, true) => Some(side.into_inner()),
        (true, false) => Some(-side.into_inner()),
        _ => None,
    }
}
