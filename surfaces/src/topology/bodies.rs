//! Faces that hang together, and whether they enclose something.

use super::loops::loops;
use super::shared::Topology;
use crate::part::Face;
use osculate_geom::{Point3, Surface};

/// Faces joined by edges.
pub(crate) struct Body {
    /// Their numbers, ascending.
    pub(crate) faces: Vec<usize>,
    /// Whether every edge has a face on both sides, turned alike.
    pub(crate) closed: bool,
    /// Whether they close with the material inside. The wall of a void closes, and is no body by itself.
    pub(crate) solid: bool,
}

/// The bodies that faces make, in the order of their first faces.
pub(crate) fn bodies(faces: &[Face], topology: &Topology) -> Vec<Body> {
    let made = groups(topology, faces.len()).into_iter().map(|group| {
        let closed = closes(faces, topology, &group);
        let solid = closed && volume(faces, &group) > 0.0;
        Body { faces: group, closed, solid }
    });
    made.collect()
}

/// Faces that hang together by edges, each group ascending.
fn groups(topology: &Topology, count: usize) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..count).collect();
    fn root(group: &mut [usize], mut k: usize) -> usize {
        while group[k] != k {
            group[k] = group[group[k]];
            k = group[k];
        }
        k
    }
    for e in &topology.edges {
        for w in e.uses.windows(2) {
            let (a, b) = (root(&mut group, w[0]), root(&mut group, w[1]));
            group[a.max(b)] = a.min(b);
        }
    }
    let mut out: Vec<Vec<usize>> = vec![Vec::new(); count];
    for k in 0..count {
        let r = root(&mut group, k);
        out[r].push(k);
    }
    out.retain(|g| !g.is_empty());
    out
}

/// Whether every edge of the faces is walked once in either sense.
fn closes(faces: &[Face], topology: &Topology, group: &[usize]) -> bool {
    let mut walked = vec![[0_usize; 2]; topology.edges.len()];
    for f in group {
        for s in loops(&faces[*f], &topology.faces[*f]).iter().flatten() {
            walked[s.edge][usize::from(s.forward)] += 1;
        }
    }
    walked.iter().all(|w| *w == [0, 0] || *w == [1, 1])
}

/// Volume behind the faces, mm3, by the divergence theorem.
fn volume(faces: &[Face], group: &[usize]) -> f64 {
    let Some(first) = group.first().map(|f| &faces[*f]) else { return 0.0 };
    // Relative to a point nearby, so that far-away bodies do not cancel.
    let origin = first.point(first.domain().at(0.5, 0.5));
    let flux = |p: &Point3, n: &osculate_geom::Unit3| (p - origin).dot(n) / 3.0;
    group
        .iter()
        .map(|f| faces[*f].surface.integrate(1e-3, &|jet| jet.normal().map_or(0.0, |n| flux(&jet.point, &n))))
        .sum()
}
