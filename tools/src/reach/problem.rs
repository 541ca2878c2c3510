//! What is asked: a tool, what it must keep out of, and how near it may come.

use super::bits::Bits;
use super::directions::Directions;
use super::obstacles::{ObstacleKind, Obstacles};
use super::tool::{Member, Mounted, Tool};
use crate::cutter::Cutter;
use osculate_geom::{Point3, Unit3};
use std::f64::consts::FRAC_PI_2;

/// How near a tool may come, and how it may lean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachLimits {
    /// How deep the cutter may go into points of the part, mm.
    pub gouge_mm: f64,
    /// How far everything above the cutter stays from all points, and the cutter from those of the surroundings, mm.
    pub clearance_mm: f64,
    /// How far everything above the cutter stays from points of stock that the cutter may take, mm.
    pub stock_mm: f64,
    /// Least angle between axis and normal, rad: zero but for flat and toroidal ends.
    pub least_lean_rad: f64,
    /// Greatest angle between axis and normal, rad, a right angle at most.
    pub most_lean_rad: f64,
}

/// A place where the cutter is to touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The point of contact, mm.
    pub point: Point3,
    /// The part's outward normal there.
    pub normal: Unit3,
}

/// Why a reach cannot be found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReachError {
    /// A length that is negative or not finite.
    #[error("{what} must be finite and not negative, got {got_mm} mm")]
    Length {
        /// Which length.
        what: &'static str,
        /// Its value, mm.
        got_mm: f64,
    },
    /// Leans out of order.
    #[error("the lean must lie between 0 and 90 degrees, got {least_deg} to {most_deg} degrees")]
    Lean {
        /// Least lean, degrees.
        least_deg: f64,
        /// Greatest lean, degrees.
        most_deg: f64,
    },
    /// The mask of allowed directions belongs to another set.
    #[error("the mask of allowed directions has {mask} bits, but there are {directions} directions")]
    Mask {
        /// Bits of the mask.
        mask: usize,
        /// Directions.
        directions: usize,
    },
}

impl ReachLimits {
    fn checked(self) -> Result<Self, ReachError> {
        let lengths =
            [("gouge_mm", self.gouge_mm), ("clearance_mm", self.clearance_mm), ("stock_mm", self.stock_mm)];
        for (what, got_mm) in lengths {
            if !(got_mm.is_finite() && got_mm >= 0.0) {
                return Err(ReachError::Length { what, got_mm });
            }
        }
        let (least, most) = (self.least_lean_rad, self.most_lean_rad);
        if least >= 0.0 && least <= most && most <= FRAC_PI_2 {
            Ok(self)
        } else {
            Err(ReachError::Lean { least_deg: least.to_degrees(), most_deg: most.to_degrees() })
        }
    }
}

/// What a [`Reach`] is made of.
#[derive(Clone, Copy, Debug)]
pub struct ReachProblem<'a> {
    /// What is moved.
    pub tool: &'a Tool,
    /// How near it may come.
    pub limits: ReachLimits,
    /// What it must keep out of.
    pub obstacles: &'a Obstacles,
    /// The directions among which its axis is chosen.
    pub directions: &'a Directions,
    /// Those that the machine's joints allow; all where not given.
    pub allowed: Option<&'a Bits>,
}

/// A body of the tool with its limits.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub member: Member,
    pub shape: Cutter,
    /// Height of its lower end above the tip, mm.
    pub base_mm: f64,
    /// Least distance from points of each kind, mm; minus infinity where there is none to keep.
    limits_mm: [f64; 3],
}

impl Solid {
    /// Least distance from points of a kind, mm.
    pub const fn limit_mm(&self, kind: ObstacleKind) -> f64 {
        self.limits_mm[kind as usize]
    }

    /// Distance from the tip beyond which all points keep their limits, mm.
    fn extent_mm(&self, beside_mm: f64) -> f64 {
        let apart = self.limits_mm.into_iter().fold(0.0, f64::max);
        let (wide, high) = (self.shape.radius_mm() + beside_mm, self.base_mm + self.shape.length_mm());
        (wide + apart).hypot(high + apart)
    }
}

/// The question which axes are possible, ready to be answered at any place.
#[derive(Clone, Debug)]
pub struct Reach<'a> {
    pub(super) obstacles: &'a Obstacles,
    pub(super) directions: &'a Directions,
    pub(super) limits: ReachLimits,
    allowed: Option<&'a Bits>,
    /// Cosines of the greatest and of the least lean; the latter above 1 where the least is none.
    cosines: [f64; 2],
    /// The cutter first.
    pub(super) solids: Vec<Solid>,
    /// For each cone whether the machine allows a member of it.
    open_cones: Vec<bool>,
    /// Distance from the contact beyond which a point meets nothing, mm.
    pub(super) extent_mm: f64,
}

impl<'a> Reach<'a> {
    /// Checks a problem.
    ///
    /// # Errors
    /// [`ReachError`] for limits that are negative, out of order or not finite, and for a mask of another length than the
    /// set of directions.
    pub fn new(problem: ReachProblem<'a>) -> Result<Self, ReachError> {
        let ReachProblem { tool, obstacles, directions, allowed, .. } = problem;
        let limits = problem.limits.checked()?;
        if let Some(mask) = allowed.filter(|m| m.len() != directions.all().len()) {
            return Err(ReachError::Mask { mask: mask.len(), directions: directions.all().len() });
        }
        let (cutter, apart) = (*tool.cutter(), limits.clearance_mm);
        let mut solids = vec![Solid {
            member: Member::Cutter,
            shape: cutter,
            base_mm: 0.0,
            limits_mm: [-limits.gouge_mm, apart, f64::NEG_INFINITY],
        }];
        solids.extend(tool.mounted().iter().enumerate().map(|(k, &Mounted { body, height_mm })| Solid {
            member: Member::Mounted(k),
            shape: body,
            base_mm: height_mm,
            limits_mm: [apart, apart, limits.stock_mm],
        }));
        // Where a lean is out of a meridian's range, the arc that is taken does not reach its contact: by two of its radii.
        let arc = cutter.touching(FRAC_PI_2);
        let beside = if cutter.is_end_mill() { 0.0 } else { 2.0 * (arc.centre_rho_mm.abs() + arc.radius_mm) };
        let beside = cutter.radius_mm() + beside;
        let extent_mm = solids.iter().map(|s| s.extent_mm(beside)).fold(0.0, f64::max);
        let tree = &directions.tree;
        let is_open = |mask: &Bits, k: usize| {
            tree.order[tree.cones[k].members.clone()].iter().any(|&d| mask.contains(d as usize))
        };
        let open = |k: usize| allowed.is_none_or(|mask| is_open(mask, k));
        let least = if limits.least_lean_rad == 0.0 { f64::INFINITY } else { limits.least_lean_rad.cos() };
        Ok(Self {
            obstacles,
            directions,
            limits,
            allowed,
            cosines: [
                if limits.most_lean_rad == FRAC_PI_2 { 0.0 } else { limits.most_lean_rad.cos() },
                least,
            ],
            solids,
            open_cones: (0..tree.cones.len()).map(open).collect(),
            extent_mm,
        })
    }

    /// The directions among which axes are chosen.
    #[must_use]
    pub const fn directions(&self) -> &'a Directions {
        self.directions
    }

    /// Whether the lean of an axis at a place is within the limits.
    #[must_use]
    pub fn leans_within_limits(&self, place: &Place, axis: &Unit3) -> bool {
        let cosine = place.normal.dot(axis);
        cosine >= self.cosines[0] && cosine <= self.cosines[1]
    }

    /// Whether the machine and the limits of the lean allow a direction at a place.
    pub(super) fn allows(&self, place: &Place, direction: usize) -> bool {
        self.allowed.is_none_or(|mask| mask.contains(direction))
            && self.leans_within_limits(place, &self.directions.all()[direction])
    }

    /// Whether the machine allows a member of a cone.
    pub(super) fn is_open(&self, cone: usize) -> bool {
        self.open_cones[cone]
    }

    /// What computed distances at a place may be wrong by, mm: some hundred roundings of the coordinates.
    pub(super) fn rounding_mm(&self, place: &Place) -> f64 {
        1e-13 * (self.obstacles.size_mm() + place.point.coords.amax() + self.extent_mm)
    }
}
