//! Faces that belong together: what a person would name in one breath, a blade or a hole, though the file has it in pieces.
//!
//! A face looks like one of a few things by its curvatures: flat, of a constant radius inwards or outwards, or neither. Faces that look
//! alike and go on smoothly into each other are a group. What is round inwards and goes all around its axis is a hole; what does
//! not is a fillet.

use crate::part::{Face, FaceKind};
use crate::sides::Meeting;
use osculate_geom::{Axis, Surface, Vec3};
use rayon::prelude::*;
use std::fmt;

/// A face is flat that bends by less than this over its own size, rad.
const FLAT_RAD: f64 = 1e-3;
/// A group that turns inwards by less than this over its size, rad, does so by rounding.
const ROUNDING_RAD: f64 = 1e-6;
/// Curvatures that differ by no more than this share are constant.
const CONSTANT: f64 = 0.02;
/// The other curvature of something round is so many times as small at least.
const SLENDER: f64 = 0.999;
/// Normals that go around leave no more than this share of their sum.
const AROUND: f64 = 0.3;
/// Samples of a face along each side, about.
const SAMPLES: usize = 12;
/// Share of the samples at either end of the curvatures that does not count: what is degenerate at an edge or a pole.
const ENDS: f64 = 0.02;
/// Groups are alike whose areas differ by no more than this share.
const ALIKE: f64 = 2e-3;

/// What a group of faces looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Look {
    /// Neither flat nor round: what is formed.
    Formed,
    /// Flat.
    Flat,
    /// Round outwards, all around or a rounded edge.
    Round,
    /// Round inwards, between other faces.
    Fillet,
    /// Round inwards, all around.
    Hole,
}

impl fmt::Display for Look {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Formed => "formed",
            Self::Flat => "flat",
            Self::Round => "round",
            Self::Fillet => "fillet",
            Self::Hole => "hole",
        })
    }
}

/// Faces that look alike and go on smoothly into each other.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FaceGroup {
    /// What it looks like.
    pub look: Look,
    /// Numbers of the faces, ascending.
    pub faces: Vec<usize>,
    /// Their area, mm2.
    pub area_mm2: f64,
    /// The smallest radius inwards, mm; infinite where it is nowhere hollow. The worst fiftieth of its samples does not count.
    pub hollow_mm: f64,
    /// How many groups of the part are like it, itself counted.
    pub alike: usize,
}

/// What samples say of a face.
struct Sampled {
    area_mm2: f64,
    /// Least and greatest principal curvature, without the ends, 1/mm.
    curvature: [f64; 2],
    /// The curvature of a face of constant radius, 1/mm.
    round: Option<f64>,
    flat: bool,
    /// Sum of the normals over their number.
    mean: Vec3,
}

impl Sampled {
    fn of(face: &Face) -> Self {
        let surface = &face.surface;
        let (mut least, mut most, mut mean) = (Vec::new(), Vec::new(), Vec3::zeros());
        let spans = surface.breaks(Axis::U).len().max(surface.breaks(Axis::V).len()) - 1;
        let all = surface.samples(SAMPLES.div_ceil(spans.max(1)));
        for (at, _) in &all {
            let jet = surface.jet2(*at);
            let (Ok(forms), Ok(normal)) = (jet.forms(), jet.normal()) else { continue };
            let k = forms.principal();
            least.push(k.k_min);
            most.push(k.k_max);
            mean += normal.into_inner();
        }
        let count = least.len();
        let area_mm2 = surface.area_mm2();
        let mut sampled =
            Self { area_mm2, curvature: [0.0; 2], round: None, flat: face.kind == FaceKind::Plane, mean };
        if count == 0 {
            return sampled;
        }
        sampled.mean /= count as f64;
        least.sort_by(f64::total_cmp);
        most.sort_by(f64::total_cmp);
        let cut = (ENDS * count as f64).floor() as usize;
        let range = |k: &[f64]| [k[cut], k[count - 1 - cut]];
        let (low, high) = (range(&least), range(&most));
        sampled.curvature = [low[0], high[1]];
        let size_mm = surface.bbox(1).diagonal_mm();
        sampled.flat |= low[0].abs().max(high[1].abs()) * size_mm < FLAT_RAD;
        let constant = |[a, b]: [f64; 2]| (b - a).abs() <= CONSTANT * a.abs().max(b.abs());
        // The tighter of both radii is that of something round: the other one is of the way that it takes.
        if constant(high) && high[0] > 0.0 && -low[0] <= SLENDER * high[0] {
            sampled.round = Some(high[1]);
        } else if constant(low) && low[1] < 0.0 && high[1] <= -SLENDER * low[1] {
            sampled.round = Some(low[0]);
        }
        sampled
    }

    fn look(&self) -> Look {
        match self.round {
            _ if self.flat => Look::Flat,
            Some(k) if k < 0.0 => Look::Fillet,
            Some(_) => Look::Round,
            None => Look::Formed,
        }
    }
}

/// The class of a number.
fn root(class: &mut [usize], mut k: usize) -> usize {
    while class[k] != k {
        class[k] = class[class[k]];
        k = class[k];
    }
    k
}

/// The groups of faces by how they look and [meet](crate::sides::meetings), those of the largest area first. The sides of the faces are to be settled.
#[must_use]
pub fn groups(faces: &[&Face], meetings: &[Meeting]) -> Vec<FaceGroup> {
    let sampled: Vec<Sampled> = faces.par_iter().map(|f| Sampled::of(f)).collect();
    let mut class: Vec<usize> = (0..faces.len()).collect();
    for m in meetings.iter().filter(|m| m.smooth) {
        let [a, b] = m.faces;
        if sampled[a].look() == sampled[b].look() {
            let (a, b) = (root(&mut class, a), root(&mut class, b));
            class[a.max(b)] = a.min(b);
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); faces.len()];
    for k in 0..faces.len() {
        let of = root(&mut class, k);
        members[of].push(k);
    }
    let mut out: Vec<FaceGroup> =
        members.into_iter().filter(|m| !m.is_empty()).map(|m| group(m, &sampled)).collect();
    out.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2).then(a.faces.cmp(&b.faces)));
    let like = |a: &FaceGroup, b: &FaceGroup| {
        let largest = a.area_mm2.max(b.area_mm2);
        a.look == b.look
            && a.faces.len() == b.faces.len()
            && (a.area_mm2 - b.area_mm2).abs() <= ALIKE * largest
    };
    let alike: Vec<usize> = out.iter().map(|a| out.iter().filter(|b| like(a, b)).count()).collect();
    out.iter_mut().zip(alike).for_each(|(g, n)| g.alike = n);
    out
}

fn group(faces: Vec<usize>, sampled: &[Sampled]) -> FaceGroup {
    let area_mm2: f64 = faces.iter().map(|f| sampled[*f].area_mm2).sum();
    let least = faces.iter().map(|f| sampled[*f].curvature[0]).fold(0.0, f64::min);
    let sum = faces.iter().fold(Vec3::zeros(), |s, f| s + sampled[*f].mean * sampled[*f].area_mm2);
    let around = sum.norm() <= AROUND * area_mm2;
    let look = match sampled[faces[0]].look() {
        Look::Fillet if around => Look::Hole,
        look => look,
    };
    let hollow = look != Look::Flat && -least * area_mm2.sqrt() > ROUNDING_RAD;
    let hollow_mm = if hollow { -1.0 / least } else { f64::INFINITY };
    FaceGroup { look, faces, area_mm2, hollow_mm, alike: 1 }
}
