//! Which faces hang together along their rims, and whether their normals are on the same side of the part.
//!
//! Two faces that bound one body run along their common edge in opposite senses when each has its face on the left, whatever the
//! angle between them. Walked along `w` with the normal `n` a face lies towards `n x w`; turning the normal over turns `w` over.

use super::rim::Bit;
use osculate_geom::Point3;
#[cfg(test)]
use osculate_geom::Vec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};

/// Cosine above which two rims may be one edge.
const PARALLEL: f64 = 0.9;
/// Cosine above which two faces leave their edge the same way: folded onto each other, which may be two faces of one body or the
/// same face twice.
const FOLDED: f64 = 0.995;
/// Other faces this many times as far as the nearest one are not meant.
const NEXT: f64 = 3.0;
/// Share of the common edge that has to say the same.
const CLEAR: f64 = 0.9;

/// What two faces say of each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Link {
    /// Numbers of the faces, the smaller one first.
    pub(super) faces: [usize; 2],
    /// Whether their normals agree.
    pub(super) agree: bool,
    /// Length of edge that says so, less that which says otherwise, mm.
    pub(super) weight_mm: f64,
}

/// The links between faces.
#[derive(Debug, Default)]
pub(super) struct Links {
    pub(super) clear: Vec<Link>,
    /// Pairs whose common edges say both, with their common length, mm.
    pub(super) mixed: Vec<([usize; 2], f64)>,
    /// The rim of each face.
    pub(super) rims: Vec<Met>,
}

/// How a rim is met, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Met {
    /// Length that one other face goes on from.
    pub(crate) by_one_mm: f64,
    /// Length that runs along several others at once.
    pub(crate) by_several_mm: f64,
    /// All of it.
    pub(crate) whole_mm: f64,
}

impl std::iter::Sum for Met {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self {
            by_one_mm: a.by_one_mm + b.by_one_mm,
            by_several_mm: a.by_several_mm + b.by_several_mm,
            whole_mm: a.whole_mm + b.whole_mm,
        })
    }
}

/// Whether the normals of two faces along a common edge are on the same side of the part; none where the faces are folded onto
/// each other or the rims are not one edge.
pub(super) fn agree(a: &Bit, b: &Bit) -> Option<bool> {
    let along = a.along.dot(&b.along);
    if along.abs() < PARALLEL || a.inward().dot(&b.inward()) > FOLDED {
        return None;
    }
    Some(along < 0.0)
}

/// Cells of rims' middles.
pub(super) struct Grid<'a> {
    bits: &'a [Bit],
    cell_mm: f64,
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl<'a> Grid<'a> {
    /// The pieces of rims, of which one edge has those within the second of these slacks.
    pub(super) fn new(bits: &'a [Bit], slack_mm: [f64; 2]) -> Self {
        let longest = bits.iter().map(|b| b.length_mm).fold(0.0, f64::max);
        let cell_mm = (longest + slack_mm[1]).max(f64::MIN_POSITIVE);
        let mut grid = Self { bits, cell_mm, cells: HashMap::new() };
        for (k, b) in bits.iter().enumerate() {
            grid.cells.entry(grid.cell(&b.points[1])).or_default().push(k);
        }
        grid
    }

    fn cell(&self, p: &Point3) -> [i64; 3] {
        [p.x, p.y, p.z].map(|c| (c / self.cell_mm).floor() as i64)
    }

    /// The nearest pieces of the faces that share the edge with a piece of a rim, one of each face.
    fn others(&self, of: &Bit, slack_mm: [f64; 2]) -> Vec<&'a Bit> {
        // The nearest piece of each face near by.
        let mut near: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
        for other in self.around(&of.points[1]) {
            let b = &self.bits[other];
            if b.face == of.face || of.along.dot(&b.along).abs() < PARALLEL {
                continue;
            }
            let d = b.distance_mm(&of.points[1]);
            if d <= slack_mm[1] && near.get(&b.face).is_none_or(|n| (d, other) < *n) {
                near.insert(b.face, (d, other));
            }
        }
        let least = near.values().map(|n| n.0).fold(f64::INFINITY, f64::min);
        let limit = slack_mm[0].max(NEXT * least);
        near.into_values().filter(|n| n.0 <= limit).map(|n| &self.bits[n.1]).collect()
    }

    /// Whether the rim of any face runs along a piece within the second slack: another one's, or its own the other way, as where a face
    /// closes upon itself.
    pub(super) fn is_met(&self, of: &Bit, slack_mm: [f64; 2]) -> bool {
        if !self.others(of, slack_mm).is_empty() {
            return true;
        }
        self.around(&of.points[1]).any(|k| {
            let b = &self.bits[k];
            b.face == of.face
                && of.along.dot(&b.along) < -PARALLEL
                && b.distance_mm(&of.points[1]) <= slack_mm[1]
        })
    }

    /// The pieces in the cells around a place.
    fn around(&self, p: &Point3) -> impl Iterator<Item = usize> {
        let home = self.cell(p);
        (0..27).flat_map(move |k| {
            let at = [home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1];
            self.cells.get(&at).map_or(&[][..], Vec::as_slice).iter().copied()
        })
    }

    /// The nearest piece of the face that shares the edge with a piece of a rim. None where there is no such face, or more than one.
    pub(super) fn partner(&self, of: &Bit, slack_mm: [f64; 2]) -> Option<&'a Bit> {
        match self.others(of, slack_mm)[..] {
            [one] => Some(one),
            _ => None,
        }
    }
}

/// The links between `count` faces by the pieces of their rims. Within the first slack rims are one edge, up to the second one where nothing is nearer.
pub(super) fn links(count: usize, bits: &[Bit], slack_mm: [f64; 2]) -> Links {
    let grid = Grid::new(bits, slack_mm);
    let others = |b: &Bit| {
        let all = grid.others(b, slack_mm);
        let one = if let [p] = all[..] { agree(b, p).map(|same| (p.face, same)) } else { None };
        (one, all.len() > 1)
    };
    let found: Vec<(Option<(usize, bool)>, bool)> = bits.par_iter().with_min_len(256).map(others).collect();
    let mut votes: BTreeMap<[usize; 2], [f64; 2]> = BTreeMap::new();
    let mut out = Links { rims: vec![Met::default(); count], ..Links::default() };
    for (b, (one, several)) in bits.iter().zip(found) {
        let rim = &mut out.rims[b.face];
        rim.whole_mm += b.length_mm;
        if several {
            rim.by_several_mm += b.length_mm;
        }
        if let Some((other, same)) = one {
            rim.by_one_mm += b.length_mm;
            let pair = [b.face.min(other), b.face.max(other)];
            // Either face votes for the edge once.
            votes.entry(pair).or_default()[usize::from(same)] += 0.5 * b.length_mm;
        }
    }
    for (faces, [against, with]) in votes {
        let (agree, most) = (with > against, with.max(against));
        if most >= CLEAR * (with + against) {
            out.clear.push(Link { faces, agree, weight_mm: (with - against).abs() });
        } else {
            out.mixed.push((faces, with + against));
        }
    }
    out
}

/// A piece of a rim in the plane of `along` and `inward`, for tests of the rule.
#[cfg(test)]
pub(super) fn bit(along: Vec3, inward: Vec3) -> Bit {
    let points = [-0.5, 0.0, 0.5].map(|t| Point3::origin() + along * t);
    Bit { face: 0, points, along, normal: along.cross(&inward), length_mm: 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Unit3;

    /// The wedge of two planes: its normals agree at any angle, convex or hollow, and one turned over does not.
    #[test]
    fn two_planes_agree_at_every_angle_between_them() {
        let axis = Unit3::new_normalize(Vec3::new(0.3, -0.7, 0.5)).into_inner();
        let e = Unit3::new_normalize(axis.cross(&Vec3::x())).into_inner();
        let f = axis.cross(&e);
        for degrees in (6..355).step_by(7) {
            let angle = f64::from(degrees).to_radians();
            // The material fills the angle from the first face to the second one.
            let (d1, d2) = (e, e * angle.cos() + f * angle.sin());
            let (n1, n2) = (-f, axis.cross(&d2));
            for sense in [1.0, -1.0] {
                let walk = |n: &Vec3, d: &Vec3| d.cross(n);
                let made = |n: Vec3, d: Vec3| bit(walk(&n, &d), d);
                let (a, b) = (made(n1 * sense, d1), made(n2 * sense, d2));
                assert!((a.normal - n1 * sense).norm() < 1e-12 && (b.inward() - d2).norm() < 1e-12);
                assert_eq!(agree(&a, &b), Some(true), "{degrees}");
                assert_eq!(agree(&a, &made(-n2 * sense, d2)), Some(false), "{degrees}");
            }
        }
    }

    #[test]
    fn folds_and_crossing_rims_say_nothing() {
        let a = bit(Vec3::z(), Vec3::x());
        let slightly = Unit3::new_normalize(Vec3::new(1.0, 0.05, 0.0)).into_inner();
        assert_eq!(agree(&a, &bit(Vec3::z(), slightly)), None);
        assert_eq!(agree(&a, &bit(Vec3::y(), -Vec3::x())), None);
    }
}
