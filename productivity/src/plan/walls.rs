//! Faces that are not machined, as points from which the tool keeps a clearance on its way from pass to pass.
//!
//! A signed distance changes by no more than the way to another point: a tool that is `c + d` off every sample is `c` off a
//! face whose points have a sample within `d`. Samples lie in rows, half a spacing or less off the corners of their cells, so
//! that `d` is 0.71 of the spacing, and a little more where the face bends.
//!
//! *Limits.* Where a pass ends nearer to a wall than the clearance the way to the next must not come nearer than that.

use super::Named;
use osculate_geom::{Point3, Surface, quadrature};
use osculate_tools::removal::{Sampling, SamplingError, sample_surface};
use osculate_tools::{Cutter, Pose};

/// Spacing of samples, of the clearance, and what it adds to the clearance at the samples, of itself.
const SPACING: f64 = 0.5;
const ADDED: f64 = 0.75;
/// Most points over all faces, and fewest of one: with more room between them the clearance at the samples grows.
const MOST: f64 = 2e5;
const FEWEST: usize = 400;
/// Slivers on which no sample lies are sampled this many times as densely, so often.
const DENSER: f64 = 4.0;
const TRIES: u32 = 4;
/// Points in a group.
const GROUP: usize = 48;

#[derive(Clone, Debug, PartialEq)]
struct Group {
    middle: Point3,
    reach_mm: f64,
    /// What the tool keeps from the points, mm.
    keep_mm: f64,
    points: Vec<Point3>,
}

/// Points of faces from which the tool keeps a distance in hops.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Walls {
    groups: Vec<Group>,
}

/// Samples of a face however narrow it is.
pub(super) fn sampled(
    surface: &dyn Surface,
    face: u32,
    spacing_mm: f64,
    most: usize,
) -> Result<Sampling, SamplingError> {
    let mut found = sample_surface(surface, face, spacing_mm, most);
    for k in 1..TRIES {
        if !matches!(found, Err(SamplingError::Nothing { .. })) {
            break;
        }
        found = sample_surface(surface, face, spacing_mm / DENSER.powi(k as i32), most);
    }
    found
}

impl Walls {
    /// Points of faces from which hops keep `clearance_mm`.
    ///
    /// # Errors
    /// A clearance that is not positive and finite ([`SamplingError::Spacing`]), or faces that cannot be sampled.
    pub fn of(faces: &[Named<'_>], clearance_mm: f64) -> Result<Self, SamplingError> {
        let areas: Vec<f64> = faces.iter().map(|f| quadrature::area(f.surface, 1e-2).value).collect();
        let all: f64 = areas.iter().sum();
        let mut groups = Vec::new();
        for (k, (face, area)) in faces.iter().zip(&areas).enumerate() {
            // A share of what may be no number goes to the sampling, which says so.
            let share = if all > 0.0 { area / all } else { 1.0 };
            let most = ((MOST * share) as usize).max(FEWEST);
            let found = sampled(face.surface, k as u32, SPACING * clearance_mm, most)?;
            let keep_mm = clearance_mm + ADDED * found.density.spacing_mm;
            groups.extend(found.samples.chunks(GROUP).map(|chunk| {
                let points: Vec<Point3> = chunk.iter().map(|s| s.point).collect();
                let middle = points[points.len() / 2];
                let reach_mm = points.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
                Group { middle, reach_mm, keep_mm, points }
            }));
        }
        Ok(Self { groups })
    }

    /// Whether a body at a pose keeps its clearance, or is no nearer to any point than at the nearer one of two other poses.
    pub(super) fn cleared_by(&self, body: &Cutter, pose: &Pose, ends: &[Pose; 2], slack_mm: f64) -> bool {
        self.groups.iter().all(|g| {
            if body.distance(pose, &g.middle) - g.reach_mm >= g.keep_mm {
                return true;
            }
            g.points.iter().all(|p| {
                let off = body.distance(pose, p);
                off >= g.keep_mm || ends.iter().any(|end| off >= body.distance(end, p) - slack_mm)
            })
        })
    }
}
