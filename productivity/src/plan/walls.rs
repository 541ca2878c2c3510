//! Faces that are not machined, as points from which the tool keeps a clearance on its way from pass to pass.
//!
//! A signed distance changes by no more than the way to another point: a tool that is `c + d` off every sample is `c` off a
//! face whose points have a sample within `d`. Samples lie in rows, half a spacing or less off the corners of their cells, so
//! that `d` is 0.71 of the spacing, and a little more where the face bends.
//!
//! *Limits.* Where a pass ends nearer to a face than the clearance the way to the next may come half as near to
//! that face: between two places next to a hollow wall it lies nearer than both.

use super::Named;
use osculate_geom::{Point3, Surface, Unit3, quadrature};
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
/// Share of what is kept from a face at the ends of a way that is kept along it, where that is less than the clearance.
const NEARER: f64 = 0.5;
/// Points in a group.
const GROUP: usize = 48;
/// Points over the faces that are machined.
const GROUND: f64 = 2e4;

#[derive(Clone, Debug, PartialEq)]
struct Group {
    /// Number of the face.
    face: usize,
    middle: Point3,
    reach_mm: f64,
    /// What the tool keeps from the points, mm, and what of that is for what lies between them.
    keep_mm: f64,
    between_mm: f64,
    points: Vec<(Point3, Unit3)>,
}

/// Points of faces from which the tool keeps a distance in hops.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Walls {
    groups: Vec<Group>,
    faces: usize,
    accepted_mm: f64,
    ground: Vec<Point3>,
}

/// Samples of a face however narrow it is.
pub(crate) fn sampled(
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
    /// Points of faces from which hops keep `clearance_mm`, and into which they go by no more than `accepted_mm` along the normals where
    /// passes begin or end nearer than that.
    ///
    /// # Errors
    /// A clearance that is not positive and finite ([`SamplingError::Spacing`]), or faces that cannot be sampled.
    pub fn of(faces: &[Named<'_>], clearance_mm: f64, accepted_mm: f64) -> Result<Self, SamplingError> {
        let areas: Vec<f64> = faces.iter().map(|f| quadrature::area(f.surface, 1e-2).value).collect();
        let all: f64 = areas.iter().sum();
        let mut groups = Vec::new();
        for (k, (face, area)) in faces.iter().zip(&areas).enumerate() {
            // A share of what may be no number goes to the sampling, which says so.
            let share = if all > 0.0 { area / all } else { 1.0 };
            let most = ((MOST * share) as usize).max(FEWEST);
            let found = sampled(face.surface, k as u32, SPACING * clearance_mm, most)?;
            let between_mm = ADDED * found.density.spacing_mm;
            let keep_mm = clearance_mm + between_mm;
            groups.extend(found.samples.chunks(GROUP).map(|chunk| {
                let points: Vec<(Point3, Unit3)> = chunk.iter().map(|s| (s.point, s.normal)).collect();
                let middle = points[points.len() / 2].0;
                let reach_mm = points.iter().map(|p| (p.0 - middle).norm()).fold(0.0, f64::max);
                Group { face: k, middle, reach_mm, keep_mm, between_mm, points }
            }));
        }
        Ok(Self { groups, faces: faces.len(), accepted_mm, ground: Vec::new() })
    }

    /// The same, with points of faces that are machined: hops go no deeper into them than passes do where they end.
    ///
    /// # Errors
    /// Faces that cannot be sampled.
    pub fn over(self, faces: &[Named<'_>]) -> Result<Self, SamplingError> {
        let areas: Vec<f64> = faces.iter().map(|f| quadrature::area(f.surface, 1e-2).value).collect();
        let all: f64 = areas.iter().sum();
        let spacing_mm = (all / GROUND).sqrt();
        let mut ground = Vec::new();
        for (k, (face, area)) in faces.iter().zip(&areas).enumerate() {
            let most = ((2.0 * GROUND * area / all) as usize).max(FEWEST);
            let found = sampled(face.surface, k as u32, spacing_mm, most)?;
            ground.extend(found.samples.iter().map(|s| s.point));
        }
        Ok(Self { ground, ..self })
    }

    /// Points of the faces that are machined.
    pub(super) fn ground(&self) -> &[Point3] {
        &self.ground
    }

    /// How near a body comes to the faces at the ends of its way, by face, where that is nearer than it should be anywhere.
    pub(super) fn nearest(&self, body: &Cutter, ends: &[Pose; 2]) -> Vec<f64> {
        let mut nearest = vec![f64::INFINITY; self.faces];
        for g in &self.groups {
            let least = &mut nearest[g.face];
            for end in ends {
                if body.distance(end, &g.middle) - g.reach_mm < g.keep_mm.min(*least) {
                    *least = g.points.iter().map(|(p, _)| body.distance(end, p)).fold(*least, f64::min);
                }
            }
        }
        nearest
    }

    /// What a body keeps from the walls of what it should, 1 at most; None where it may touch one. From a face that it comes nearer to at
    /// the ends of its way than it should it keeps a share of that.
    pub(super) fn room(&self, body: &Cutter, pose: &Pose, nearest: &[f64], slack_mm: f64) -> Option<f64> {
        self.groups.iter().try_fold(1.0, |least: f64, g| {
            let enough = match nearest[g.face] {
                near if near >= g.keep_mm => g.keep_mm,
                near => (NEARER * near).min(near - slack_mm),
            };
            if body.distance(pose, &g.middle) - g.reach_mm >= g.keep_mm.min(enough.max(0.0)) {
                return Some(least);
            }
            g.points.iter().try_fold(least, |least, (p, normal)| {
                let off = body.distance(pose, p);
                // The side of a tool that is hardly in an edge goes deep along the normal of its face.
                let sunk = p - normal.into_inner() * self.accepted_mm;
                if off < 0.0 && body.distance(pose, &sunk) < 0.0 {
                    return None;
                }
                if off >= enough {
                    return Some(least);
                }
                let room = (off - g.between_mm) / (g.keep_mm - g.between_mm);
                (room > 0.0).then(|| least.min(room))
            })
        })
    }
}
