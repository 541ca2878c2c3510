//! Corners at the same place are one, and sides know which triangles they belong to.

use osculate_geom::{Facets, Point3, Vec3};
use std::collections::HashMap;

/// Triangles with numbered corners.
pub(super) struct Welded {
    pub(super) points: Vec<Point3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Triangles of the file that have no area, and are left out.
    pub(super) flat: usize,
}

/// A side of two triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seam {
    /// The triangles.
    pub(super) of: [u32; 2],
    /// Its ends.
    pub(super) ends: [u32; 2],
    /// Whether both run it the same way, so that one of them looks to the other side.
    pub(super) turned: bool,
}

/// How triangles meet.
pub(super) struct Seams {
    /// Sides of exactly two triangles.
    pub(super) seams: Vec<Seam>,
    /// Triangles with a side that no other has.
    pub(super) open: Vec<u32>,
    /// Sides of three triangles or more.
    pub(super) crowded: usize,
}

impl Welded {
    /// Joins corners with the same coordinates.
    pub(super) fn new(triangles: &[[Point3; 3]]) -> Self {
        let mut numbers: HashMap<[u64; 3], u32> = HashMap::new();
        let mut out = Self { points: Vec::new(), triangles: Vec::with_capacity(triangles.len()), flat: 0 };
        for t in triangles {
            let numbered = t.map(|p| {
                // Zero has two signs.
                let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
                *numbers.entry(key).or_insert_with(|| {
                    out.points.push(p);
                    (out.points.len() - 1) as u32
                })
            });
            if Facets::normal_of(t).is_some() { out.triangles.push(numbered) } else { out.flat += 1 }
        }
        out
    }

    /// Twice the area of a triangle along its normal, mm2.
    pub(super) fn cross(&self, t: &[u32; 3]) -> Vec3 {
        let [a, b, c] = t.map(|k| self.points[k as usize]);
        (b - a).cross(&(c - a))
    }

    /// How the triangles meet.
    pub(super) fn seams(&self) -> Seams {
        // The lesser end, the greater one, the triangle, and whether it runs from the lesser to the greater.
        let mut sides: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(3 * self.triangles.len());
        for (k, t) in self.triangles.iter().enumerate() {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                sides.push((a.min(b), a.max(b), k as u32, a < b));
            }
        }
        sides.sort_unstable();
        let mut out = Seams { seams: Vec::new(), open: Vec::new(), crowded: 0 };
        for side in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            match side {
                [one] => out.open.push(one.2),
                [a, b] => {
                    let seam = Seam { of: [a.2, b.2], ends: [a.0, a.1], turned: a.3 == b.3 };
                    out.seams.push(seam);
                }
                _ => out.crowded += 1,
            }
        }
        out
    }
}

/// Sets that are joined.
pub(super) struct Sets(Vec<u32>);

impl Sets {
    pub(super) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The first of the set of one.
    pub(super) fn first(&mut self, of: u32) -> u32 {
        let mut root = of;
        while self.0[root as usize] != root {
            root = self.0[root as usize];
        }
        let mut at = of;
        while self.0[at as usize] != root {
            at = std::mem::replace(&mut self.0[at as usize], root);
        }
        root
    }

    pub(super) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        // The lesser one leads, so that the order of joins does not matter.
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// The members of each set, sets in the order of their first members.
    pub(super) fn all(mut self) -> Vec<Vec<u32>> {
        let mut place = HashMap::new();
        let mut out: Vec<Vec<u32>> = Vec::new();
        for k in 0..self.0.len() as u32 {
            let at = *place.entry(self.first(k)).or_insert_with(|| {
                out.push(Vec::new());
                out.len() - 1
            });
            out[at].push(k);
        }
        out
    }
}
