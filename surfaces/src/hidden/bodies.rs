//! The bodies of a part, as far as they may overlap: faces that close around material.

use super::soup::overlap;
use crate::part::Face;
use crate::sides::{CLOSED, Met, hanging, volume_sign};
use osculate_geom::{Box3, Side};
use rayon::prelude::*;
use std::collections::HashMap;

/// Boxes overlap where they have this much in common in every direction, as a part of the smaller one: bodies that only touch
/// are never asked.
const DEEP: f64 = 1e-5;

/// Faces that close around material.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Numbers of the faces, ascending, each with its outer side relative to its present normal.
    pub(super) faces: Vec<(usize, Side)>,
    /// Walls of voids within it, likewise.
    pub(super) voids: Vec<(usize, Side)>,
    /// Around the faces.
    pub(super) around: Box3,
}

/// The bodies of a part whose boxes overlap; none where there is nothing to look at. `known` says of which faces the present
/// normal is the outer one.
pub(super) fn bodies(faces: &[&Face], known: &[bool], uncertainty_mm: Option<f64>) -> Vec<Body> {
    if faces.len() < 2 || one_by_keys(faces) {
        return Vec::new();
    }
    let boxes: Vec<Box3> = faces.par_iter().map(|f| f.surface.bbox(1)).collect();
    let around = |of: &[usize]| of.iter().fold(Box3::empty(), |b, f| b.union(&boxes[*f]));
    let size_mm = around(&(0..faces.len()).collect::<Vec<_>>()).diagonal_mm();
    if !(size_mm.is_finite() && size_mm > 0.0) {
        return Vec::new();
    }
    let (groups, rims, _) = hanging(faces, size_mm, uncertainty_mm);
    let closes = |of: &[usize]| {
        let rim: Met = of.iter().map(|f| rims[*f]).sum();
        rim.by_one_mm >= CLOSED * rim.whole_mm
    };
    let closed: Vec<_> =
        groups.into_iter().filter(|g| closes(&g.faces)).map(|g| (around(&g.faces), g)).collect();
    let meets = |k: usize| (0..closed.len()).any(|j| j != k && deep(&closed[k].0, &closed[j].0));
    let (mut solids, mut voids) = (Vec::new(), Vec::new());
    for (k, (around, group)) in closed.iter().enumerate() {
        if !meets(k) {
            continue;
        }
        let of: Vec<(&Face, Side)> =
            group.faces.iter().zip(&group.sides).map(|(f, s)| (faces[*f], *s)).collect();
        let Some(sign) = volume_sign(&of) else { continue };
        let turn = if sign < 0.0 { Side::Against } else { Side::Along };
        let outer = group.faces.iter().zip(&group.sides).map(|(f, s)| (*f, s.seen(turn)));
        let outer: Vec<(usize, Side)> = outer.collect();
        // The wall of a void closes with its normals inward.
        let is_void = outer.iter().any(|(f, s)| known.get(*f) == Some(&true) && *s == Side::Against);
        if is_void {
            let wall = outer.into_iter().map(|(f, s)| (f, s.flipped())).collect();
            voids.push((*around, wall));
        } else {
            solids.push(Body { faces: outer, voids: Vec::new(), around: *around });
        }
    }
    for (around, wall) in voids {
        let holds = |b: &&mut Body| {
            (0..3).all(|k| b.around.min[k] <= around.min[k] && b.around.max[k] >= around.max[k])
        };
        let size = |b: &Body| b.around.diagonal_mm();
        let home = solids.iter_mut().filter(holds).min_by(|a, b| size(a).total_cmp(&size(b)));
        if let Some(body) = home {
            let wall: Vec<(usize, Side)> = wall;
            body.voids.extend(wall);
        }
    }
    if solids.len() < 2 { Vec::new() } else { solids }
}

/// Whether two boxes have more than a hair in common.
pub(super) fn deep(a: &Box3, b: &Box3) -> bool {
    let hair_mm = DEEP * a.diagonal_mm().min(b.diagonal_mm());
    overlap(&a.grown(-hair_mm), b)
}

/// Whether the file itself says that all faces hang together.
fn one_by_keys(faces: &[&Face]) -> bool {
    let mut class: Vec<usize> = (0..faces.len()).collect();
    fn root(class: &mut [usize], mut k: usize) -> usize {
        while class[k] != k {
            class[k] = class[class[k]];
            k = class[k];
        }
        k
    }
    let mut first: HashMap<u64, usize> = HashMap::new();
    for (k, f) in faces.iter().enumerate() {
        for key in f.surface.edges().iter().filter_map(|e| e.key) {
            let other = *first.entry(key).or_insert(k);
            let (a, b) = (root(&mut class, k), root(&mut class, other));
            class[a.max(b)] = a.min(b);
        }
    }
    (0..faces.len()).all(|k| root(&mut class, k) == 0)
}
