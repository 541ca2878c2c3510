//! Directions that cover the sphere evenly: a subdivided icosahedron.
//!
//! Level 0 is the 12 corners of the icosahedron; each level halves the edges of the one before and puts the new points
//! on the sphere: `10 * 4^level + 2` directions. Those of a lower level come first. The triangles stay close to
//! equilateral, so that they are the Delaunay triangulation of the directions, and a walk from neighbour to nearer
//! neighbour ends at the nearest of all.

use super::cones::ConeTree;
use osculate_geom::{Unit3, Vec3};
use std::collections::HashMap;

/// Highest level: 655,362 directions, a quarter of a degree apart. More would not fit into memory at many places.
const MOST_LEVEL: u32 = 8;
/// Directions of level 1, among which a walk begins.
const COARSE: usize = 42;

/// Why there are no such directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DirectionsError {
    /// The level is too high.
    #[error("a sphere of level {level} is too fine: the highest level is {most}")]
    Level {
        /// The level that was asked for.
        level: u32,
        /// The highest.
        most: u32,
    },
    /// A row of no directions.
    #[error("a row of directions needs one at least")]
    Row,
}

/// A fixed even set of directions, each with its neighbours.
///
/// ```
/// use osculate_tools::reach::Directions;
/// let directions = Directions::icosphere(4)?;
/// assert_eq!(directions.all().len(), 2562);
/// assert!(directions.spacing_rad() < 4.8f64.to_radians());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Directions {
    all: Vec<Unit3>,
    /// Six of each at most, ascending; places that are not needed are empty at the end.
    neighbours: Vec<[u32; 6]>,
    spacing_rad: f64,
    /// How many of the first a walk begins among.
    coarse: usize,
    pub(super) tree: ConeTree,
}

impl Directions {
    /// The icosahedron subdivided `level` times: 162 directions at level 2, 642 at 3, 2562 at 4, 10242 at 5.
    ///
    /// # Errors
    /// [`DirectionsError::Level`] above level 8.
    pub fn icosphere(level: u32) -> Result<Self, DirectionsError> {
        if level > MOST_LEVEL {
            return Err(DirectionsError::Level { level, most: MOST_LEVEL });
        }
        let (mut all, mut triangles) = icosahedron();
        for _ in 0..level {
            let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum = all[a as usize].into_inner() + all[b as usize].into_inner();
                    all.push(Unit3::new_normalize(sum));
                    all.len() as u32 - 1
                })
            };
            triangles = triangles
                .iter()
                .flat_map(|&[a, b, c]| {
                    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                    [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
                })
                .collect();
        }
        let neighbours = neighbours(all.len(), &triangles);
        let chord = |k: usize, j: u32| (all[k].into_inner() - all[j as usize].into_inner()).norm();
        let longest = neighbours.iter().enumerate().flat_map(|(k, of)| of.iter().map(move |&j| (k, j)));
        let longest = longest.filter(|(_, j)| *j != NONE).map(|(k, j)| chord(k, j)).fold(0.0, f64::max);
        let tree = ConeTree::new(&all);
        Ok(Self { all, neighbours, spacing_rad: 2.0 * (0.5 * longest).asin(), coarse: COARSE, tree })
    }

    /// Directions in a row, each next to the one before and the one after: those of a machine with one rotary joint, or none.
    ///
    /// # Errors
    /// [`DirectionsError::Row`] without any.
    pub fn row(all: Vec<Unit3>) -> Result<Self, DirectionsError> {
        if all.is_empty() {
            return Err(DirectionsError::Row);
        }
        let last = all.len() - 1;
        let neighbours = (0..=last).map(|k| {
            let mut of = [NONE; 6];
            let near = [k.checked_sub(1), (k < last).then_some(k + 1)];
            for (place, k) in of.iter_mut().zip(near.into_iter().flatten()) {
                *place = k as u32;
            }
            of
        });
        let neighbours = neighbours.collect();
        let spacing_rad = all.windows(2).map(|w| w[0].angle(&w[1])).fold(0.0, f64::max);
        // Both ends of a row may be near: all of it is looked at.
        let (tree, coarse) = (ConeTree::new(&all), all.len());
        Ok(Self { all, neighbours, spacing_rad, coarse, tree })
    }

    /// The directions.
    #[must_use]
    pub fn all(&self) -> &[Unit3] {
        &self.all
    }

    /// The directions next to one, five or six in a sphere and two at most in a row, ascending.
    ///
    /// # Panics
    /// For an index that is none.
    #[must_use]
    pub fn neighbours(&self, k: usize) -> &[u32] {
        let of = &self.neighbours[k];
        &of[..of.iter().position(|k| *k == NONE).unwrap_or(of.len())]
    }

    /// The direction nearest to an axis; of several equally near ones any.
    ///
    /// ```
    /// use osculate_geom::{Unit3, Vec3};
    /// use osculate_tools::reach::Directions;
    /// let directions = Directions::icosphere(3)?;
    /// let axis = Unit3::new_normalize(Vec3::new(1.0, 2.0, 3.0));
    /// let nearest = &directions.all()[directions.nearest(&axis)];
    /// assert!(nearest.angle(&axis) < 0.6 * directions.spacing_rad());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn nearest(&self, axis: &Unit3) -> usize {
        let closer = |(best, most): (usize, f64), k: usize| {
            let dot = self.all[k].dot(axis);
            if dot > most { (k, dot) } else { (best, most) }
        };
        let mut at = (0..self.coarse.min(self.all.len())).fold((0, f64::NEG_INFINITY), closer);
        loop {
            let next = self.neighbours(at.0).iter().map(|&k| k as usize).fold(at, closer);
            if next.0 == at.0 {
                return at.0;
            }
            at = next;
        }
    }

    /// Greatest angle between neighbours, rad. No axis is farther from the nearest direction than 0.6 of it.
    #[must_use]
    pub const fn spacing_rad(&self) -> f64 {
        self.spacing_rad
    }
}

/// In place of a sixth neighbour.
const NONE: u32 = u32::MAX;

fn neighbours(count: usize, triangles: &[[u32; 3]]) -> Vec<[u32; 6]> {
    let mut all = vec![[NONE; 6]; count];
    // Every edge stands in two triangles, once in each sense.
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if let Some(free) = all[from as usize].iter_mut().find(|k| **k == NONE) {
                *free = to;
            }
        }
    }
    all.iter_mut().for_each(|of| of.sort_unstable());
    all
}

fn icosahedron() -> (Vec<Unit3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let corner = |a: f64, b: f64| {
        [Vec3::new(0.0, a, b * golden), Vec3::new(a, b * golden, 0.0), Vec3::new(b * golden, 0.0, a)]
    };
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corners: Vec<Vec3> = signs.iter().flat_map(|&(a, b)| corner(a, b)).collect();
    // Edges have length 2; the next longer distance is 2 golden.
    let is_edge = |i: usize, j: usize| (corners[i] - corners[j]).norm() < 2.5;
    let mut triangles = Vec::with_capacity(20);
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if is_edge(i, j) && is_edge(j, k) && is_edge(k, i) {
                    let outwards = corners[i].dot(&corners[j].cross(&corners[k])) > 0.0;
                    let [j, k] = if outwards { [j, k] } else { [k, j] };
                    triangles.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    (corners.iter().map(|c| Unit3::new_normalize(*c)).collect(), triangles)
}
