//! Edges of a face's loops, joined to closed chains of parameters.
//!
//! An edge used twice by the same face is a slit (the seam of a cylinder, the bridge to a hole): the inside is on both
//! of its sides, so it bounds nothing and is left out. What remains is joined end to end in space, and every edge is
//! shifted by whole periods to continue the one before.

use super::carrier::Carrier;
use super::pull::unwrap;
use super::region::Chain;
use osculate_geom::{Point3, Surface, Uv, uv};

/// An edge as one loop uses it.
#[derive(Clone, Debug)]
pub(crate) struct EdgeUse {
    /// Parameters along the loop's sense.
    pub(crate) points: Vec<Uv>,
    /// Ends in space, along the loop's sense.
    pub(crate) ends: [Point3; 2],
    /// The edge's identity in the file, where it has one.
    pub(crate) key: Option<u64>,
    /// The loop it belongs to.
    pub(crate) owner: usize,
    /// Whether the parameters are the file's own. Those jump by whole periods only; any other jump crosses a pole.
    pub(crate) own: bool,
}

/// Joined chains, the largest jump between consecutive ends, mm, and how many edges had to be turned round.
#[derive(Clone, Debug)]
pub(crate) struct Joined {
    pub(crate) chains: Vec<Chain>,
    pub(crate) jump_mm: f64,
    pub(crate) turned_edges: usize,
    /// Corners put in between sides of the surface that are one point.
    pub(crate) corners: usize,
}

/// Joins the edges of all loops of a face. Ends within `slack_mm` are the same vertex.
pub(crate) fn join(carrier: &Carrier, edges: Vec<EdgeUse>, slack_mm: f64) -> Joined {
    let mut kept = without_slits(edges);
    let mut turned_edges = 0;
    let mut used = vec![false; kept.len()];
    let mut chains = Vec::new();
    let mut jump_mm = 0.0_f64;
    let mut corners = 0;
    for first in 0..kept.len() {
        if used[first] {
            continue;
        }
        used[first] = true;
        let start = kept[first].ends[0];
        let mut last = first;
        let mut points = kept[first].points.clone();
        let mut own = kept[first].own;
        loop {
            let end = kept[last].ends[1];
            let gap = |k: usize| (kept[k].ends[0] - end).norm();
            let closing = (start - end).norm();
            // The next edge in the file where it continues; else the chain closes; else the nearest start.
            let following =
                (last + 1 < kept.len() && !used[last + 1] && kept[last + 1].owner == kept[last].owner)
                    .then_some(last + 1);
            // Back at the first vertex after a turn around a closing direction the chain is whole: what follows, the same
            // loop or not, has an inside of its own.
            let turned = closing <= slack_mm
                && points.first().zip(points.last()).is_some_and(|(a, b)| unwrap(carrier, *a, *b) != *a);
            let next = match following {
                Some(k) if gap(k) <= slack_mm && !turned => Some(k),
                _ if closing <= slack_mm => None,
                _ => (0..kept.len())
                    .filter(|k| !used[*k] && kept[*k].owner == kept[last].owner)
                    .min_by(|a, b| gap(*a).total_cmp(&gap(*b)))
                    .filter(|k| gap(*k) < closing),
            };
            let next = match next.filter(|k| gap(*k) <= slack_mm) {
                None if closing > slack_mm => {
                    // An edge that runs against its loop, for all that its ends say.
                    let mine = |k: &usize| !used[*k] && kept[*k].owner == kept[last].owner;
                    let against =
                        (0..kept.len()).filter(mine).find(|k| (kept[*k].ends[1] - end).norm() <= slack_mm);
                    if let Some(k) = against {
                        kept[k].ends.reverse();
                        kept[k].points.reverse();
                        turned_edges += 1;
                    }
                    against.or(next)
                }
                _ => next,
            };
            let Some(next) = next else {
                jump_mm = jump_mm.max(closing);
                break;
            };
            used[next] = true;
            jump_mm = jump_mm.max((kept[next].ends[0] - end).norm());
            own &= kept[next].own;
            corners += append(carrier, &mut points, &kept[next].points, own);
            last = next;
        }
        corners += close(carrier, &mut points, own);
        if points.len() > 1 {
            chains.push(Chain { points });
        }
    }
    Joined { chains, jump_mm, turned_edges, corners }
}

/// The edges that the face uses once (or an odd number of times).
fn without_slits(edges: Vec<EdgeUse>) -> Vec<EdgeUse> {
    let mut seen = std::collections::BTreeMap::<u64, usize>::new();
    for e in &edges {
        if let Some(key) = e.key {
            *seen.entry(key).or_default() += 1;
        }
    }
    edges.into_iter().filter(|e| e.key.is_none_or(|k| seen.get(&k).is_none_or(|n| n % 2 == 1))).collect()
}

/// Appends a piece, shifted by whole periods so that it begins near the end. The number of corners on the way to it.
fn append(carrier: &Carrier, points: &mut Vec<Uv>, piece: &[Uv], own: bool) -> usize {
    let (Some(end), Some(begin)) = (points.last().copied(), piece.first().copied()) else {
        points.extend_from_slice(piece);
        return 0;
    };
    let moved = continued(carrier, begin, end, own);
    let shift = uv(moved.u - begin.u, moved.v - begin.v);
    let meets = same_place(carrier, moved, end);
    let corners = carrier.corners_between(end, moved);
    points.extend_from_slice(&corners);
    for (k, p) in piece.iter().enumerate() {
        // Rounding between two edges at one vertex would leave a needle: the earlier edge's end stands.
        if !(k == 0 && meets) {
            points.push(uv(p.u + shift.u, p.v + shift.v));
        }
    }
    corners.len()
}

/// Ends a chain at its first point, shifted by the whole periods it winds. The number of corners on the way to it.
fn close(carrier: &Carrier, points: &mut Vec<Uv>, own: bool) -> usize {
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return 0;
    };
    let target = continued(carrier, first, last, own);
    if points.len() > 1 && same_place(carrier, target, last) {
        points.pop();
    }
    let corners = carrier.corners_between(last, target);
    points.extend_from_slice(&corners);
    points.push(target);
    corners.len()
}

/// `at` shifted by whole periods to continue at `near`; the file's own parameters only where that closes the jump.
fn continued(carrier: &Carrier, at: Uv, near: Uv, own: bool) -> Uv {
    /// Jumps that miss a whole number of periods by more than this fraction of one cross a pole.
    const WHOLE: f64 = 1e-3;
    let moved = unwrap(carrier, at, near);
    if !own {
        return moved;
    }
    let settle = |m: f64, t: f64, n: f64, length: f64| if (m - n).abs() <= WHOLE * length { m } else { t };
    let domain = carrier.domain;
    uv(settle(moved.u, at.u, near.u, domain.u.length()), settle(moved.v, at.v, near.v, domain.v.length()))
}

/// Whether two parameter pairs are the same but for rounding.
fn same_place(carrier: &Carrier, a: Uv, b: Uv) -> bool {
    let domain = carrier.surface.domain();
    let near = |d: f64, length: f64, scale: f64| {
        d.abs() <= 1e-9 * if length.is_finite() { length } else { scale.abs() + 1.0 }
    };
    near(a.u - b.u, domain.u.length(), a.u) && near(a.v - b.v, domain.v.length(), a.v)
}
