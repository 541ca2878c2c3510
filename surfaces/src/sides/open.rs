//! Open rims: where a face ends and no other one of the part goes on or stands.

use super::link::Grid;
use super::rim::{Bit, Traced};
use crate::closest::FaceSearch;
use crate::part::Face;
use osculate_geom::{Box3, Uv};
use rayon::prelude::*;
use std::sync::OnceLock;

/// What boxes around faces may be short by, of their size.
const LOOSE: f64 = 0.02;

/// A piece of a face's open rim.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OpenRim {
    /// The face's number.
    pub face: usize,
    /// The piece as a polyline in the face's parameters.
    pub points: Vec<Uv>,
}

/// The pieces of the rims of faces along which no other face lies, by the numbers of the faces: neither one that shares the edge nor one
/// that the rim stands on. A face that closes upon itself has none there, so that of a closed body nothing is open. `uncertainty_mm` is what
/// the file says of its own exactness.
#[must_use]
pub fn open_rims(faces: &[&Face], uncertainty_mm: Option<f64>) -> Vec<OpenRim> {
    let Some((boxes, size_mm)) = super::sized(faces) else { return Vec::new() };
    // Boxes are as near as samples on faces tell: a rim that stands on a face must not be missed.
    let boxes: Vec<Box3> = boxes.iter().map(|b| b.grown(LOOSE * b.diagonal_mm())).collect();
    let (traced, slack_mm) = super::traced_rims(faces, size_mm, uncertainty_mm);
    let bits: Vec<Bit> = traced.iter().map(|t| t.0).collect();
    let grid = Grid::new(&bits, slack_mm);
    let searches: Vec<OnceLock<FaceSearch<'_>>> = faces.iter().map(|_| OnceLock::new()).collect();
    let stands = |b: &Bit| {
        let middle = &b.points[1];
        let is_in = |b: Box3| (0..3).all(|i| b.min[i] <= middle[i] && middle[i] <= b.max[i]);
        let near = (0..faces.len()).filter(|k| *k != b.face && is_in(boxes[*k].grown(slack_mm[1])));
        let mut near = near.map(|k| searches[k].get_or_init(|| FaceSearch::new(&faces[k].surface, None)));
        // What cannot be searched may be there.
        near.any(|s| s.closest(middle, None).map_or(true, |foot| foot.distance_mm <= slack_mm[1]))
    };
    let is_open = |t: &Traced| !grid.is_met(&t.0, slack_mm) && !stands(&t.0);
    let open: Vec<bool> = traced.par_iter().with_min_len(64).map(is_open).collect();
    let kept = traced.into_iter().zip(open).filter(|(_, open)| *open);
    kept.map(|((bit, points), _)| OpenRim { face: bit.face, points }).collect()
}
