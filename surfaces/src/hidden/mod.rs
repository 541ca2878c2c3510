//! Faces that lie inside the material of another body of the part.
//!
//! Solids that overlap (blades that run into a hub, a post that stands in a plate) leave parts of their faces within each other.
//! No tool reaches them, and none needs to: they are no surface of the part.
//!
//! Faces that close around material are bodies ([`crate::sides`] says which hang together). A face of a body whose box meets that of
//! another one is cut along the lines in which it meets the other's faces. Lines are marched on both surfaces exactly, from seeds
//! that triangles of both give, to where they leave either face. A piece of border or line is kept where the face is hidden on
//! one side of it at most; what is kept closes to the loops of what is left.
//!
//! A place is hidden where it is inside by more than 1e-5 of the size of the smaller body. Faces that lie on each other are not
//! hidden: nothing says which of them is the surface. What is left is held against rays all over the face; where they do not agree,
//! or a line cannot be followed, the face stays whole and the finding names both faces. Loops of hidden places that are smaller
//! than what triangles of 2e-4 of the size see are not found: they stay surface.

mod bodies;
mod border;
mod cut;
mod inside;
mod pieces;
mod seeds;
mod sheet;
mod soup;
mod trace;

use crate::part::Face;
use crate::trimmed::TrimmedSurface;
use bodies::{Body, bodies, deep};
use cut::{Left, Scale, Stuck, cut, triangles_mm};
use inside::{Solid, Wall};
use osculate_geom::Box3;
use rayon::prelude::*;
use std::sync::Arc;

/// A face of which something is hidden.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct HiddenFace {
    /// Its number.
    pub face: usize,
    /// The area within other bodies, mm2.
    pub hidden_mm2: f64,
    /// The bodies that hide it, each by the numbers of its faces, ascending.
    pub within: Vec<Vec<usize>>,
    /// What is left of it; none where all of it is hidden.
    pub visible: Option<Arc<TrimmedSurface>>,
}

/// A face that may be hidden in part and stays whole, since the lines in which it meets another one were not found.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct HiddenUnknown {
    /// Numbers of the face and of the other one.
    pub faces: [usize; 2],
    /// What went wrong.
    pub why: &'static str,
}

/// What bodies hide of each other's faces.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Hidden {
    /// Faces of which something is hidden, ascending.
    pub faces: Vec<HiddenFace>,
    /// Faces that stay whole, ascending.
    pub unknown: Vec<HiddenUnknown>,
}

/// Finds what of the faces is inside other bodies of the part. `known` says of which faces the present normal points out of the
/// material: walls of voids are told by it. The answer is the same for any number of threads.
#[must_use]
pub fn hidden(faces: &[&Face], known: &[bool], uncertainty_mm: Option<f64>) -> Hidden {
    let bodies = bodies(faces, known, uncertainty_mm);
    let mut out = Hidden::default();
    let pairs: Vec<(usize, usize)> = (0..bodies.len())
        .flat_map(|a| (0..bodies.len()).map(move |b| (a, b)))
        .filter(|(a, b)| a != b && deep(&bodies[*a].around, &bodies[*b].around))
        .collect();
    if pairs.is_empty() {
        return out;
    }
    let solids: Vec<Option<Solid<'_>>> = (0..bodies.len())
        .into_par_iter()
        .map(|b| pairs.iter().any(|p| p.1 == b).then(|| solid(faces, &bodies[b])))
        .collect();
    let jobs: Vec<(usize, usize)> =
        bodies.iter().enumerate().flat_map(|(a, b)| b.faces.iter().map(move |(f, _)| (a, *f))).collect();
    let found: Vec<(Option<HiddenFace>, Vec<HiddenUnknown>)> = jobs
        .par_iter()
        .map(|(a, f)| {
            let others = pairs.iter().filter(|p| p.0 == *a);
            let others = others.filter_map(|(_, b)| Some((&bodies[*b], solids[*b].as_ref()?)));
            one(*f, faces[*f], &bodies[*a], others)
        })
        .collect();
    for (face, unknown) in found {
        out.faces.extend(face);
        out.unknown.extend(unknown);
    }
    out.faces.sort_by_key(|f| f.face);
    out.unknown.sort_by_key(|u| u.faces);
    out
}

fn solid<'a>(faces: &[&'a Face], body: &Body) -> Solid<'a> {
    let walls = body.faces.iter().chain(&body.voids);
    let walls = walls.map(|(f, side)| Wall { face: *f, surface: &faces[*f].surface, side: *side });
    Solid::new(walls.collect(), triangles_mm(body.around.diagonal_mm()))
}

/// What other bodies leave of a face, one after the other.
fn one<'a>(
    number: usize,
    face: &Face,
    body: &Body,
    others: impl Iterator<Item = (&'a Body, &'a Solid<'a>)>,
) -> (Option<HiddenFace>, Vec<HiddenUnknown>) {
    let around: Box3 = face.surface.bbox(1);
    let (mut within, mut unknown) = (Vec::new(), Vec::new());
    let mut visible = Some(face.surface.clone());
    for (other, solid) in others {
        let Some(rest) = &visible else { break };
        let size_mm = body.around.diagonal_mm().min(other.around.diagonal_mm());
        if !soup::overlap(&around.grown(triangles_mm(size_mm)), &solid.around) {
            continue;
        }
        match cut(rest, solid, Scale { size_mm }) {
            Ok(Left::All) => continue,
            Ok(Left::Nothing) => visible = None,
            Ok(Left::Part(part)) => visible = Some(Arc::new(*part)),
            Err(Stuck { other, why }) => {
                unknown.push(HiddenUnknown { faces: [number, other], why });
                continue;
            }
        }
        within.push(other.faces.iter().map(|f| f.0).collect());
    }
    if within.is_empty() {
        return (None, unknown);
    }
    let left_mm2 = visible.as_ref().map_or(0.0, |v| v.area_mm2());
    let hidden_mm2 = (face.surface.area_mm2() - left_mm2).max(0.0);
    (Some(HiddenFace { face: number, hidden_mm2, within, visible }), unknown)
}
