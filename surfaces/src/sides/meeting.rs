//! How neighbouring faces meet along their common edges: smoothly, in an outer edge or in an inner one.
//!
//! Along an edge with the normals `n` and `m` the faces bend by the angle between these, positive where the first face falls away
//! behind the second one, as at an outer edge of a body.

use super::link::{Grid, agree};
use super::rim::Bit;
use crate::part::Face;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Faces that bend by no more than this are one smooth face to a cutter, rad: CAD systems join fillets to about a degree, and points that
/// are measured to a few.
pub const SMOOTH_RAD: f64 = 0.09;
/// Share of a common edge that has to be smooth, or bent one way.
const MOST_OF_IT: f64 = 0.9;

/// Two faces with a common edge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Meeting {
    /// Their numbers, the smaller one first.
    pub faces: [usize; 2],
    /// Length of the common edge, mm.
    pub length_mm: f64,
    /// The bend that half of the edge does not exceed, rad; positive at outer edges.
    pub bend_rad: f64,
    /// Whether the faces go on smoothly into each other.
    pub smooth: bool,
}

/// The bend from a face to another one at a piece of their rims; the other's normal is turned over where they do not agree.
fn bend_rad(of: &Bit, other: &Bit, same: bool) -> f64 {
    let normal = if same { other.normal } else { -other.normal };
    let angle = of.normal.cross(&normal).norm().atan2(of.normal.dot(&normal));
    if of.inward().dot(&normal) > 0.0 { -angle } else { angle }
}

/// The common edges of faces, by the numbers of the faces. `uncertainty_mm` is what the file says of its own exactness. The sides of
/// the faces are taken as they are: what bends outwards on one side bends inwards on the other.
///
/// ```
/// use osculate_surfaces::{patches, sides};
/// // A step down at a right angle: an outer edge 10 mm long, the second normal to +x.
/// let text = "2\n1 1\n0 0 0\n0 10 0\n10 0 0\n10 10 0\n1 1\n10 0 -10\n10 0 0\n10 10 -10\n10 10 0\n";
/// let part = patches::read(text.as_bytes())?;
/// let found = sides::meetings(&part.faces.iter().collect::<Vec<_>>(), None);
/// assert_eq!((found.len(), found[0].faces, found[0].smooth), (1, [0, 1], false));
/// assert!((found[0].length_mm - 10.0).abs() < 1e-6);
/// assert!((found[0].bend_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn meetings(faces: &[&Face], uncertainty_mm: Option<f64>) -> Vec<Meeting> {
    let Some((_, size_mm)) = super::sized(faces) else { return Vec::new() };
    let (bits, slack_mm) = super::rims(faces, size_mm, uncertainty_mm);
    let grid = Grid::new(&bits, slack_mm);
    let met = |b: &Bit| {
        let other = grid.partner(b, slack_mm)?;
        Some((other.face, bend_rad(b, other, agree(b, other)?)))
    };
    let found: Vec<Option<(usize, f64)>> = bits.par_iter().with_min_len(256).map(met).collect();
    let mut by: BTreeMap<[usize; 2], Vec<(f64, f64)>> = BTreeMap::new();
    for (b, found) in bits.iter().zip(found) {
        if let Some((other, bend)) = found {
            // Either face speaks for the edge once.
            let pair = [b.face.min(other), b.face.max(other)];
            by.entry(pair).or_default().push((bend, 0.5 * b.length_mm));
        }
    }
    by.into_iter().map(|(faces, bends)| meeting(faces, bends)).collect()
}

/// What the pieces of a common edge say, each with its bend and length.
fn meeting(faces: [usize; 2], mut bends: Vec<(f64, f64)>) -> Meeting {
    bends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let length_mm: f64 = bends.iter().map(|b| b.1).sum();
    let mut so_far = 0.0;
    let middle = bends.iter().find(|b| {
        so_far += b.1;
        so_far >= 0.5 * length_mm
    });
    let smooth_mm: f64 = bends.iter().filter(|b| b.0.abs() <= SMOOTH_RAD).map(|b| b.1).sum();
    let smooth = smooth_mm >= MOST_OF_IT * length_mm;
    Meeting { faces, length_mm, bend_rad: middle.map_or(0.0, |b| b.0), smooth }
}
