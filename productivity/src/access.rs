//! From where a tool reaches faces: how much of them along which axes, and which axes together reach the most.
//!
//! Places stand for equal shares of the faces. An axis reaches a place where the tool touches it there and keeps out of all other places
//! and of the whole part, as [`osculate_tools::reach`] has it; a tool that keeps its axis then comes to that place when it is let down.
//! Axes are taken from an even set, some nine degrees apart, and from the part's own six.

use crate::axis::{Around, Surroundings};
use crate::plan::Named;
use crate::plan::samples::{Wanted, samples};
use osculate_geom::{Unit3, Vec3, quadrature};
use osculate_tools::Holder;
use osculate_tools::reach::{
    Bits, Directions, DirectionsError, Place, Reach, ReachError, ReachLimits, ReachProblem, Tool,
};
use osculate_tools::removal::{Sample, SamplingError};

/// Fewest places of a face.
const FEWEST: usize = 9;
/// Level of the even set: 642 directions.
const LEVEL: u32 = 3;
/// A place that is seen at a glance counts so much of one that is seen along its normal: of axes that reach the same the upright one is
/// better, since passes on walls are close.
const GLANCE: f64 = 0.3;
/// An axis of the part's own counts as the best one where it reaches no less than this part of what that reaches.
const AS_GOOD: f64 = 0.97;
/// An axis is taken that reaches this share of the faces, which none before it reached.
const WORTH: f64 = 2e-3;

/// Where it is looked.
#[derive(Clone, Copy)]
#[non_exhaustive]
pub enum At<'a> {
    /// About so many places all over the faces to machine.
    About(usize),
    /// These places, whose faces are told by their place among the faces to machine.
    Places(&'a [Sample]),
}

/// What is asked.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// The faces, and what the tool's end must keep out of.
    pub around: Around<'a>,
    /// What holds the tool.
    pub holder: Option<&'a Holder>,
    /// Where it is looked.
    pub at: At<'a>,
    /// Least and greatest angle between axis and normal, rad.
    pub lean_rad: [f64; 2],
    /// The only axis that is asked for, where it is given.
    pub axis: Option<Unit3>,
}

/// Why nothing is found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AccessError {
    /// A face that cannot be sampled.
    #[error("face {face}: {why}")]
    Face {
        /// Its name.
        face: String,
        /// Why not.
        why: SamplingError,
    },
    /// Limits that cannot be.
    #[error(transparent)]
    Reach(#[from] ReachError),
    /// A set of directions that cannot be.
    #[error(transparent)]
    Directions(#[from] DirectionsError),
}

/// An axis with what it reaches.
#[derive(Clone, Debug, PartialEq)]
pub struct From {
    /// The axis, from the tip to the holder.
    pub axis: Unit3,
    /// The area that it reaches, mm2.
    pub area_mm2: f64,
    /// That of each face, by its place among the faces to machine, mm2.
    pub of_faces_mm2: Vec<f64>,
}

/// Which axes reach which places.
pub struct Access {
    axes: Vec<Unit3>,
    places: Vec<Sample>,
    /// Of each place.
    bits: Vec<Bits>,
    /// Areas of the faces to machine, mm2.
    areas_mm2: Vec<f64>,
}

impl Access {
    /// Looks from where the tool reaches places all over the faces to machine.
    ///
    /// # Errors
    /// [`AccessError`].
    pub fn of(asked: &Asked<'_>) -> Result<Self, AccessError> {
        let face = |(face, why)| AccessError::Face { face, why };
        let surroundings = Surroundings::of(&asked.around).map_err(face)?;
        let places = match asked.at {
            At::About(count) => places(asked.around.faces, count)?,
            At::Places(all) => all.to_vec(),
        };
        let mut areas_mm2 = vec![0.0; asked.around.faces.len()];
        for s in &places {
            areas_mm2[s.face as usize] += s.area_mm2;
        }
        let own = Directions::row(asked.axis.map_or_else(own_axes, |axis| vec![axis]))?;
        let even = if asked.axis.is_some() { None } else { Some(Directions::icosphere(LEVEL)?) };
        let tool = Tool::new(*asked.around.cutter, asked.holder);
        let limits = ReachLimits {
            gouge_mm: 0.0,
            clearance_mm: surroundings.keep_mm,
            stock_mm: 0.0,
            least_lean_rad: asked.lean_rad[0],
            most_lean_rad: asked.lean_rad[1],
        };
        let at: Vec<Place> = places.iter().map(|s| Place { point: s.point, normal: s.normal }).collect();
        let map = |directions: &Directions| -> Result<Vec<Bits>, ReachError> {
            let problem = ReachProblem {
                tool: &tool,
                limits,
                obstacles: &surroundings.obstacles,
                directions,
                allowed: None,
            };
            Ok(Reach::new(problem)?.map(&at))
        };
        let mut axes = own.all().to_vec();
        let mut bits = map(&own)?;
        if let Some(even) = &even {
            let n = axes.len();
            for (own, more) in bits.iter_mut().zip(map(even)?) {
                *own =
                    Bits::of(n + more.len(), |k| if k < n { own.contains(k) } else { more.contains(k - n) });
            }
            axes.extend(even.all());
        }
        Ok(Self { axes, places, bits, areas_mm2 })
    }

    /// Area of the faces to machine, mm2.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        self.areas_mm2.iter().sum()
    }

    /// The places, and whether any of the allowed axes reaches each.
    pub fn reached(&self, allowed: &dyn Fn(&Unit3) -> bool) -> impl Iterator<Item = (&Sample, bool)> {
        let allowed: Vec<bool> = self.axes.iter().map(allowed).collect();
        let any = move |bits: &Bits| (0..allowed.len()).any(|a| allowed[a] && bits.contains(a));
        self.places.iter().zip(&self.bits).map(move |(place, bits)| (place, any(bits)))
    }

    fn of_faces(&self, holds: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut out = vec![0.0; self.areas_mm2.len()];
        for (_, s) in self.places.iter().enumerate().filter(|(k, _)| holds(*k)) {
            out[s.face as usize] += s.area_mm2;
        }
        out
    }

    /// What one axis reaches of the places that are still open: their area, and that with what is seen at a glance counted less.
    fn gain_mm2(&self, axis: usize, open: &[bool]) -> [f64; 2] {
        let of = self.places.iter().zip(&self.bits).zip(open);
        of.filter(|((_, bits), open)| **open && bits.contains(axis)).fold([0.0; 2], |sum, ((s, _), _)| {
            let upright = s.normal.dot(&self.axes[axis]).max(0.0);
            [sum[0] + s.area_mm2, sum[1] + s.area_mm2 * (GLANCE + (1.0 - GLANCE) * upright)]
        })
    }

    /// What these axes reach, each place by the most upright of them and counted less where it is seen at a glance, mm2.
    #[must_use]
    pub fn worth_mm2(&self, from: &[From]) -> f64 {
        let used = self.used(from);
        let of = |(s, bits): (&Sample, &Bits)| {
            let upright = |a: &usize| s.normal.dot(&self.axes[*a]).max(0.0);
            let best = used.iter().filter(|a| bits.contains(**a)).map(upright).reduce(f64::max);
            best.map_or(0.0, |c| s.area_mm2 * (GLANCE + (1.0 - GLANCE) * c))
        };
        self.places.iter().zip(&self.bits).map(of).sum()
    }

    fn used(&self, from: &[From]) -> Vec<usize> {
        let taken = |axis: &Unit3| from.iter().any(|f| f.axis == *axis);
        (0..self.axes.len()).filter(|k| taken(&self.axes[*k])).collect()
    }

    /// The axes, `most` of them at most and all of them allowed, that together reach the most: each takes what the ones before it leave.
    /// None takes less than a few thousandths of the faces.
    #[must_use]
    pub fn axes(&self, most: usize, allowed: &dyn Fn(&Unit3) -> bool) -> Vec<From> {
        // The part's own axes come first.
        let own = own_axes().len().min(self.axes.len());
        let allowed: Vec<bool> = self.axes.iter().map(allowed).collect();
        let mut open = vec![true; self.places.len()];
        let mut out = Vec::new();
        while out.len() < most {
            let gain = |a: usize| if allowed[a] { self.gain_mm2(a, &open) } else { [0.0; 2] };
            let gains: Vec<[f64; 2]> = (0..self.axes.len()).map(gain).collect();
            let best_of = |range: std::ops::Range<usize>| {
                range.max_by(|a, b| gains[*a][1].total_cmp(&gains[*b][1]).then(b.cmp(a))).unwrap_or(0)
            };
            let (plain, any) = (best_of(0..own), best_of(0..self.axes.len()));
            let best = if gains[plain][1] >= AS_GOOD * gains[any][1] { plain } else { any };
            if gains[best][0] <= WORTH * self.area_mm2() {
                break;
            }
            for (open, bits) in open.iter_mut().zip(&self.bits) {
                *open &= !bits.contains(best);
            }
            let of_faces_mm2 = self.of_faces(|k| self.bits[k].contains(best));
            out.push(From { axis: self.axes[best], area_mm2: of_faces_mm2.iter().sum(), of_faces_mm2 });
        }
        out
    }

    /// The area of each face that none of these axes reaches, mm2.
    #[must_use]
    pub fn left_mm2(&self, from: &[From]) -> Vec<f64> {
        let used = self.used(from);
        self.of_faces(|k| !used.iter().any(|a| self.bits[k].contains(*a)))
    }
}

/// The part's own axes, up first.
fn own_axes() -> Vec<Unit3> {
    let each = [Vec3::z(), -Vec3::z(), Vec3::y(), -Vec3::y(), Vec3::x(), -Vec3::x()];
    each.map(Unit3::new_unchecked).to_vec()
}

/// About so many places all over faces, and some on each of them.
///
/// # Errors
/// [`AccessError::Face`].
pub fn places(faces: &[Named<'_>], count: usize) -> Result<Vec<Sample>, AccessError> {
    let most = count as f64;
    let areas = faces.iter().map(|f| quadrature::area(f.surface, 1e-2).value);
    let wanted = Wanted { spacing_mm: (areas.sum::<f64>() / most).sqrt(), most, fewest: FEWEST };
    let found = samples(&faces.iter().collect::<Vec<_>>(), wanted);
    let found = found.map_err(|(face, why)| AccessError::Face { face, why })?;
    Ok(found.into_iter().flat_map(|f| f.samples).collect())
}
