//! What tools keep off on their ways from pass to pass: the faces of the part, and whatever else stands around, as points.
//!
//! A signed distance changes by no more than the way to another point: a tool that is `c + d` off every sample is `c` off a
//! face whose points have a sample within `d`. Samples lie in rows, half a spacing or less off the corners of their cells, so
//! that `d` is 0.71 of the spacing, and a little more where the face bends. Where passes end nearer to a face than that the tool's own
//! roundness counts: between samples a cylinder of radius r comes deeper by a fourth of the square of their spacing over r at most,
//! and the rims of faces have samples of their own.
//!
//! *Limits.* Where a pass ends nearer to a face than the clearance the way to the next may come half as near to
//! that face: between two places next to a hollow wall it lies nearer than both.

use super::tree::{Dot, Dots};
use crate::plan::Named;
use crate::plan::samples::{Wanted, samples};
use osculate_geom::{Point3, Uv, quadrature, uv};
use osculate_tools::removal::{Sample, SamplingError, sample_boundary};
use osculate_tools::{Cutter, Pose};

/// Spacing of samples, of the clearance, and what it adds to the clearance at the samples, of itself.
const SPACING: f64 = 0.5;
const ADDED: f64 = 0.75;
/// The same where the way along an edge counts only.
const ADDED_AT_RIMS: f64 = 0.5;
/// What an edge of a tool may go into a face between points of it, of their spacing.
const AT_EDGES: f64 = 0.1;
/// What a round tool may go into an edge between points of it, of what ways may go into faces.
const OVER_EDGES: f64 = 0.25;
/// Share of what may be hidden between samples under a tool, of what ways may go into faces: together they are accepted.
const HIDDEN: f64 = 0.5;
/// Most points over all faces that are not machined, and fewest of one: with more room between them the clearance at the samples
/// grows.
const MOST: f64 = 3e5;
const FEWEST: usize = 400;
/// Share of what is kept from a face at the ends of a way that is kept along it, where that is less than the clearance.
const NEARER: f64 = 0.5;
/// Points over the faces that are machined: the contacts of passes are such points too.
const GROUND: f64 = 1e5;

/// How far tools keep off, and how finely that is looked at. Lengths mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keeping {
    /// What ways keep from faces that are not machined.
    pub clearance_mm: f64,
    /// How far ways may go into them, along their normals, where passes begin or end nearer than the clearance.
    pub accepted_mm: f64,
    /// Radius of the thinnest tool.
    pub radius_mm: f64,
}

impl Keeping {
    /// The greatest spacing of points along an edge of a face that is machined, no more than that of points on it: a tool that goes over
    /// the edge goes into it between them by its sagitta.
    fn along_edges_mm(&self, apart_mm: f64) -> f64 {
        let sagitta = OVER_EDGES * self.accepted_mm;
        if sagitta > 0.0 { apart_mm.min((8.0 * self.radius_mm * sagitta).sqrt()) } else { apart_mm }
    }

    /// The greatest spacing of samples at which no more is hidden under the tool than may be, and little of the clearance.
    #[must_use]
    pub fn spacing_mm(&self) -> f64 {
        let under_tool = (4.0 * self.radius_mm * HIDDEN * self.accepted_mm).sqrt();
        let of_clearance = SPACING * self.clearance_mm;
        // Ways that may go in by nothing are asked as finely as the clearance says.
        if under_tool > 0.0 { of_clearance.min(under_tool) } else { of_clearance }
    }
}

/// A face, or what else stands around.
#[derive(Clone, Debug, PartialEq)]
struct Wall {
    /// What the tool keeps from the points, mm, and what of that is for what lies between them.
    keep_mm: f64,
    between_mm: f64,
    dots: Dots,
}

/// Points from which the tool keeps a distance on its ways.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Walls {
    walls: Vec<Wall>,
    accepted_mm: f64,
    /// Of the faces that are machined, their rims apart.
    ground: Vec<Dots>,
    /// How far apart their points are, mm.
    ground_apart_mm: f64,
    stock: Vec<Point3>,
}

/// The rim of the rectangle of a face's parameters, where that is inside its trims.
fn rim(face: &Named<'_>, number: u32, spacing_mm: f64) -> Vec<Sample> {
    let domain = face.surface.domain();
    // Chords of sides, as many as a side that turns once around needs.
    const CHORDS: u32 = 64;
    let side = |k: u32| f64::from(k) / f64::from(CHORDS);
    let corners: [fn(f64) -> [f64; 2]; 4] =
        [|t| [t, 0.0], |t| [1.0, t], |t| [1.0 - t, 1.0], |t| [0.0, 1.0 - t]];
    let outline: Vec<Uv> = corners
        .iter()
        .flat_map(|at| (0..CHORDS).map(move |k| at(side(k))))
        .map(|[s, t]| uv(domain.u.at(s), domain.v.at(t)))
        .collect();
    let mut found = sample_boundary(face.surface, &outline, number, spacing_mm);
    found.retain(|s| face.surface.contains(s.uv));
    found
}

impl Walls {
    /// Points of faces that are not machined, and of those that are: ways go no deeper into them than passes do where they end.
    ///
    /// # Errors
    /// A clearance or a radius that is not positive and finite ([`SamplingError::Spacing`]), or faces that cannot be sampled.
    pub fn of(check: &[Named<'_>], own: &[Named<'_>], keeping: &Keeping) -> Result<Self, SamplingError> {
        let spacing_mm = keeping.spacing_mm();
        let (mut walls, mut ground, mut ground_apart_mm) = (Vec::new(), Vec::new(), 0.0f64);
        for (faces, most, is_own) in [(check, MOST, false), (own, GROUND, true)] {
            let area: f64 = faces.iter().map(|f| quadrature::coarse_area(f.surface)).sum();
            let all: Vec<&Named<'_>> = faces.iter().collect();
            // Not finer than they can be all over: the same clearance everywhere.
            let spacing_mm = spacing_mm.max((area / most).sqrt());
            let wanted = Wanted { spacing_mm, most: 2.0 * most, fewest: FEWEST };
            let found = samples(&all, wanted).map_err(|(_, e)| e)?;
            for ((face, found), number) in faces.iter().zip(found).zip(0..) {
                let apart_mm = found.density.spacing_mm;
                let rims =
                    rim(face, number, if is_own { keeping.along_edges_mm(apart_mm) } else { apart_mm });
                let dots = found.samples.iter().chain(&rims).map(dot);
                if is_own {
                    ground_apart_mm = ground_apart_mm.max(apart_mm);
                    ground.extend(dots);
                } else {
                    walls.push(Wall::of(dots.collect(), ADDED * apart_mm, keeping.clearance_mm));
                }
            }
        }
        let ground = vec![Dots::new(ground)];
        Ok(Self { walls, accepted_mm: keeping.accepted_mm, ground, ground_apart_mm, stock: Vec::new() })
    }

    /// With what else stands around, such as fixtures and the rims of trimmed faces, as samples no farther apart than so much.
    #[must_use]
    pub fn with(mut self, samples: &[Sample], apart_mm: f64, clearance_mm: f64) -> Self {
        if !samples.is_empty() {
            let dots = samples.iter().map(dot).collect();
            self.walls.push(Wall::of(dots, ADDED_AT_RIMS * apart_mm, clearance_mm));
        }
        self
    }

    /// With more points of the faces that are machined: their rims.
    #[must_use]
    pub fn with_own(mut self, samples: &[Sample]) -> Self {
        self.ground.push(Dots::new(samples.iter().map(dot).collect()));
        self
    }

    /// With raw material that is left, as points of its surface: rapid moves go where none is any more.
    #[must_use]
    pub fn with_stock(mut self, points: Vec<Point3>) -> Self {
        self.stock = points;
        self
    }

    /// Whether raw material is known.
    #[must_use]
    pub const fn knows_stock(&self) -> bool {
        !self.stock.is_empty()
    }

    /// Points of raw material that is left.
    pub(super) fn stock(&self) -> &[Point3] {
        &self.stock
    }

    /// Points of the faces that are machined.
    pub(super) fn ground(&self) -> &[Dots] {
        &self.ground
    }

    /// How deep a tool may go into the faces that are machined between their points, where it touches none of them.
    pub(super) fn hidden_mm(&self, cutter: &Cutter) -> f64 {
        let apart = self.ground_apart_mm;
        // What is round comes as deep as its radius says, an edge as a part may bend.
        let round = 0.25 * apart * apart / cutter.corner_mm().max(f64::MIN_POSITIVE);
        round.min(AT_EDGES * apart)
    }

    /// How near a body comes to each wall at the ends of its way, where that is nearer than it should be anywhere.
    pub(super) fn nearest(&self, body: &Cutter, ends: &[Pose; 2]) -> Vec<f64> {
        let least = |w: &Wall| ends.iter().fold(w.keep_mm, |least, end| w.dots.least_mm(body, end, least));
        self.walls.iter().map(least).collect()
    }

    /// What a body keeps from the walls; None where it may touch one. From a wall that it comes nearer to at the ends of its way than it
    /// should it keeps a share of that.
    pub(super) fn room(&self, (body, pose): (&Cutter, &Pose), ends: &Ends<'_>, most_mm: f64) -> Option<Room> {
        let mut all = self.walls.iter().zip(ends.nearest_mm);
        all.try_fold(Room { share: 1.0, spare_mm: most_mm }, |least, (w, near)| {
            let enough =
                if *near >= w.keep_mm { w.keep_mm } else { (NEARER * near).min(near - ends.slack_mm) };
            let off = w.dots.least_mm(body, pose, enough.max(0.0) + least.spare_mm);
            if off < enough {
                let share = (off - w.between_mm) / (w.keep_mm - w.between_mm);
                return (share > 0.0).then_some(Room { share: least.share.min(share), spare_mm: 0.0 });
            }
            // The side of a tool that is hardly in an edge goes deep along the normal of its face.
            let sunk =
                |d: &Dot, _| body.distance(pose, &(d.at - d.normal.into_inner() * self.accepted_mm)) < 0.0;
            let deep = off < 0.0 && w.dots.any((body, pose), 0.0, &mut { sunk });
            (!deep).then_some(Room { spare_mm: least.spare_mm.min(off - enough), ..least })
        })
    }
}

/// How a body is at the ends of its way.
pub(super) struct Ends<'a> {
    /// How near to each wall, as [`Walls::nearest`] says, mm.
    pub nearest_mm: &'a [f64],
    /// Rounding, mm.
    pub slack_mm: f64,
}

/// What a body keeps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Of the clearance that it should, 1 at most.
    pub share: f64,
    /// How far it may go before it keeps less, mm.
    pub spare_mm: f64,
}

impl Wall {
    fn of(dots: Vec<Dot>, between_mm: f64, clearance_mm: f64) -> Self {
        Self { keep_mm: clearance_mm + between_mm, between_mm, dots: Dots::new(dots) }
    }
}

const fn dot(s: &Sample) -> Dot {
    Dot { at: s.point, normal: s.normal }
}
