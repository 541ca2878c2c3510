//! Many convex bodies as one, under a tree of balls: how far two such crowds are apart.

use nalgebra::Isometry3;

use super::{Apart, Convex};
use crate::point::{Box3, Point3, Vec3};

/// Convex bodies that belong together, and the tree over them.
#[derive(Clone, Debug)]
pub struct Crowd {
    members: Vec<Convex>,
    /// Nodes of the tree, the root first.
    nodes: Vec<Node>,
    bounds: Box3,
}

/// No bodies, or one that is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CrowdError {
    /// There is no body.
    #[error("there is no body")]
    Empty,
    /// A body has a coordinate that is not finite.
    #[error("body {0} has a coordinate or a size that is not finite")]
    NotFinite(usize),
}

#[derive(Clone, Copy, Debug)]
struct Node {
    centre: Point3,
    radius_mm: f64,
    /// The two nodes below, or the first member and how many.
    below: Below,
}

#[derive(Clone, Copy, Debug)]
enum Below {
    Nodes(usize, usize),
    Members(usize, usize),
}

/// Members of a leaf at most.
const LEAF: usize = 4;

impl Crowd {
    /// A crowd of bodies.
    ///
    /// # Errors
    /// [`CrowdError`].
    pub fn new(members: Vec<Convex>) -> Result<Self, CrowdError> {
        if members.is_empty() {
            return Err(CrowdError::Empty);
        }
        let mut boxed = Vec::with_capacity(members.len());
        for (k, member) in members.into_iter().enumerate() {
            if !member.is_finite() {
                return Err(CrowdError::NotFinite(k));
            }
            boxed.push((member.bounds(), member));
        }
        let bounds = boxed.iter().fold(Box3::empty(), |all, (one, _)| all.union(one));
        let mut nodes = Vec::with_capacity(boxed.len());
        grow(&mut boxed, 0, &mut nodes);
        Ok(Self { members: boxed.into_iter().map(|b| b.1).collect(), nodes, bounds })
    }

    /// The box around all of them.
    #[must_use]
    pub const fn bounds(&self) -> &Box3 {
        &self.bounds
    }

    /// The bodies, in no order of theirs.
    #[must_use]
    pub fn members(&self) -> &[Convex] {
        &self.members
    }

    /// How far another crowd is away that stands at `place` in the frame of this one. The bounds are within about `share` of each other,
    /// or the lower one is above `enough_mm`.
    ///
    /// ```
    /// use osculate_geom::{Box3, Point3, convex::{Convex, Crowd}, nalgebra::Isometry3};
    /// let cube = |x: f64| {
    ///     Convex::cuboid(&Box3::around(&[Point3::new(x, 0.0, 0.0), Point3::new(x + 10.0, 10.0, 10.0)]))
    /// };
    /// // Two cubes with 20 mm between them, and one 3 mm above the second.
    /// let (two, one) = (Crowd::new(vec![cube(0.0), cube(30.0)])?, Crowd::new(vec![cube(0.0)])?);
    /// let d = two.apart(&one, &Isometry3::translation(30.0, 0.0, 13.0), 1e-6, f64::INFINITY);
    /// assert!((d.least_mm - 3.0).abs() < 1e-5 && (d.most_mm - 3.0).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn apart(&self, other: &Self, place: &Isometry3<f64>, share: f64, enough_mm: f64) -> Apart {
        let mut search = Search {
            crowds: [self, other],
            place,
            share,
            enough_mm,
            found: Apart { least_mm: f64::INFINITY, most_mm: f64::INFINITY },
        };
        search.between(0, 0);
        search.found
    }
}

/// Makes the node over the members from `first` on, and all below it; its place among the nodes.
fn grow(members: &mut [(Box3, Convex)], first: usize, nodes: &mut Vec<Node>) -> usize {
    let bounds = members.iter().fold(Box3::empty(), |all, (one, _)| all.union(one));
    let place = nodes.len();
    let (centre, radius_mm) = (bounds.centre(), 0.5 * bounds.diagonal_mm());
    nodes.push(Node { centre, radius_mm, below: Below::Members(first, members.len()) });
    if members.len() > LEAF {
        let size = bounds.max - bounds.min;
        let axis = size.imax();
        let middle = members.len() / 2;
        let key = |m: &(Box3, Convex)| m.0.min[axis] + m.0.max[axis];
        members.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        let (low, high) = members.split_at_mut(middle);
        let left = grow(low, first, nodes);
        let right = grow(high, first + middle, nodes);
        nodes[place].below = Below::Nodes(left, right);
    }
    place
}

struct Search<'a> {
    crowds: [&'a Crowd; 2],
    place: &'a Isometry3<f64>,
    share: f64,
    enough_mm: f64,
    found: Apart,
}

impl Search<'_> {
    /// The least that two nodes can be apart.
    fn gap(&self, a: &Node, b: &Node) -> f64 {
        let way: Vec3 = self.place * b.centre - a.centre;
        way.norm() - a.radius_mm - b.radius_mm
    }

    fn between(&mut self, a: usize, b: usize) {
        let [own, other] = self.crowds;
        let (m, n) = (&own.nodes[a], &other.nodes[b]);
        let gap = self.gap(m, n);
        // What is no nearer than the best, but for the share that nobody asks for, needs no look.
        if gap >= self.enough_mm || gap >= (1.0 - self.share) * self.found.most_mm {
            self.found.least_mm = self.found.least_mm.min(gap.max(0.0));
            self.found.most_mm = self.found.most_mm.min(gap + 2.0 * (m.radius_mm + n.radius_mm));
            return;
        }
        let pairs = match (m.below, n.below) {
            (Below::Members(i, many), Below::Members(j, more)) => {
                for p in &own.members[i..i + many] {
                    for q in &other.members[j..j + more] {
                        let one = p.apart(q, self.place, self.share, self.enough_mm);
                        self.found.least_mm = self.found.least_mm.min(one.least_mm);
                        self.found.most_mm = self.found.most_mm.min(one.most_mm);
                    }
                }
                return;
            }
            (Below::Nodes(l, r), Below::Members(..)) => [(l, b), (r, b)],
            (Below::Members(..), Below::Nodes(l, r)) => [(a, l), (a, r)],
            (Below::Nodes(l, r), Below::Nodes(..)) if m.radius_mm >= n.radius_mm => [(l, b), (r, b)],
            (Below::Nodes(..), Below::Nodes(l, r)) => [(a, l), (a, r)],
        };
        let gaps = pairs.map(|(i, j)| self.gap(&own.nodes[i], &other.nodes[j]));
        let order = if gaps[1] < gaps[0] { [1, 0] } else { [0, 1] };
        for k in order {
            self.between(pairs[k].0, pairs[k].1);
        }
    }
}
