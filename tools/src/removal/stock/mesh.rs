//! What is left as a closed mesh, for other programs and for pictures.
//!
//! Space is cut into cubes whose corners lie in material or not, as two of the three rays through a corner's cell say. A cube with
//! corners of both kinds has one vertex, in the middle of where its edges leave the material, and every edge that does has two
//! triangles between the vertices of the four cubes around it: so that the mesh is closed wherever it goes. Vertices are good to a
//! cell, flat faces to the part of a cell by which rays stand off the corners' middles times the slope; sharp edges are broken by half a
//! cell.

use super::Stock;
use osculate_geom::Point3;

/// A closed triangle mesh.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct Mesh {
    /// Vertices, mm.
    pub points: Vec<Point3>,
    /// Triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Triangles of a binary STL file before they begin, and bytes of each.
const HEADER: usize = 80;
const FACET: usize = 50;

impl Mesh {
    /// The volume inside, mm3.
    #[must_use]
    pub fn volume_mm3(&self) -> f64 {
        let p = |k: u32| self.points[k as usize].coords;
        self.triangles.iter().map(|t| p(t[0]).dot(&p(t[1]).cross(&p(t[2]))) / 6.0).sum()
    }

    /// A binary STL file, mm.
    #[must_use]
    pub fn stl(&self) -> Vec<u8> {
        let mut out = vec![0u8; HEADER];
        let name = b"material left, mm";
        out[..name.len()].copy_from_slice(name);
        out.reserve(4 + FACET * self.triangles.len());
        // More triangles than can be numbered do not fit in memory.
        out.extend((self.triangles.len() as u32).to_le_bytes());
        for t in &self.triangles {
            let [a, b, c] = t.map(|k| self.points[k as usize]);
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
            for x in normal.iter().chain(a.iter()).chain(b.iter()).chain(c.iter()) {
                out.extend((*x as f32).to_le_bytes());
            }
            out.extend([0u8; 2]);
        }
        out
    }

    /// A binary PLY file, mm.
    #[must_use]
    pub fn ply(&self) -> Vec<u8> {
        let mut out = format!(
            "ply\nformat binary_little_endian 1.0\ncomment material left, mm\nelement vertex {}\nproperty float x\nproperty float y\n\
             property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.points.len(),
            self.triangles.len()
        )
        .into_bytes();
        for x in self.points.iter().flat_map(|p| p.iter()) {
            out.extend((*x as f32).to_le_bytes());
        }
        for t in &self.triangles {
            out.push(3);
            for k in t {
                out.extend(k.to_le_bytes());
            }
        }
        out
    }
}

/// Corners of cubes with what the rays say of them.
struct Corners<'a> {
    stock: &'a Stock,
    /// Corners along x, y and z, one more on each side than there are cells.
    count: [usize; 3],
    side: [f64; 3],
    inside: Vec<bool>,
}

impl<'a> Corners<'a> {
    fn of(stock: &'a Stock, most: usize) -> Self {
        let size = stock.bounds.max - stock.bounds.min;
        let cell = stock.cell.max(size.amax() / most.max(1) as f64);
        let cells = [0, 1, 2].map(|k| ((size[k] / cell - 1e-9).ceil().max(1.0)) as usize);
        let count = cells.map(|n| n + 2);
        let side = [0, 1, 2].map(|k| size[k] / cells[k] as f64);
        let mut out = Self { stock, count, side, inside: vec![false; count[0] * count[1] * count[2]] };
        for k in 1..=cells[2] {
            for j in 1..=cells[1] {
                for i in 1..=cells[0] {
                    let at = out.index([i, j, k]);
                    out.inside[at] = out.is_inside([i, j, k]);
                }
            }
        }
        out
    }

    const fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.count[1] + j) * self.count[0] + i
    }

    fn point(&self, at: [usize; 3]) -> Point3 {
        let min = &self.stock.bounds.min;
        let x = |k: usize| min[k] + self.side[k] * (at[k] as f64 - 0.5);
        Point3::new(x(0), x(1), x(2))
    }

    fn is_inside(&self, at: [usize; 3]) -> bool {
        self.stock.is_material(&self.point(at))
    }

    /// Where the edge from a corner to the next along an axis leaves the material.
    fn crossing(&self, at: [usize; 3], axis: usize) -> Point3 {
        let mut p = self.point(at);
        let (from, to) = (p[axis], p[axis] + self.side[axis]);
        let own = (0..self.stock.fields.len()).find(|f| self.stock.fields[*f].lattice.axis == axis);
        // The material ends within the box, so that a ray through the next corner is one through this.
        let inner = self.point([0, 1, 2].map(|k| at[k].clamp(1, self.count[k] - 2)));
        let ends = own.into_iter().flat_map(|f| self.stock.fields[f].ray(&inner).iter().flatten());
        let middle = 0.5 * (from + to);
        let nearest = ends
            .filter(|s| (from..=to).contains(*s))
            .min_by(|a, b| (*a - middle).abs().total_cmp(&(*b - middle).abs()));
        p[axis] = nearest.copied().unwrap_or(middle);
        p
    }
}

/// No cube has a vertex here yet.
const NONE: u32 = u32::MAX;

impl Stock {
    /// What is left as a closed mesh of no more than `most` cubes along the longest side.
    #[must_use]
    pub fn mesh(&self, most: usize) -> Mesh {
        let corners = Corners::of(self, most);
        let count = corners.count;
        let steps = [1, count[0], count[0] * count[1]];
        // Sums of crossings of each cube's edges; a cube has the index of its lowest corner.
        let mut sums: Vec<(u32, [f64; 3])> = Vec::new();
        let mut cube = vec![NONE; corners.inside.len()];
        let mut quads: Vec<([usize; 4], bool)> = Vec::new();
        for k in 0..count[2] {
            for j in 0..count[1] {
                for i in 0..count[0] {
                    let (at, here) = ([i, j, k], corners.index([i, j, k]));
                    for axis in 0..3 {
                        if at[axis] + 1 >= count[axis]
                            || corners.inside[here] == corners.inside[here + steps[axis]]
                        {
                            continue;
                        }
                        let p = corners.crossing(at, axis);
                        // The outermost corners lie outside, so that four cubes are around every such edge.
                        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
                        let around = [here, here - steps[b], here - steps[b] - steps[c], here - steps[c]];
                        for one in around {
                            if cube[one] == NONE {
                                cube[one] = sums.len() as u32;
                                sums.push((0, [0.0; 3]));
                            }
                            let (n, sum) = &mut sums[cube[one] as usize];
                            *n += 1;
                            (0..3).for_each(|x| sum[x] += p[x]);
                        }
                        quads.push((around, corners.inside[here]));
                    }
                }
            }
        }
        let points = sums.iter().map(|(n, s)| Point3::from(s.map(|x| x / f64::from(*n)))).collect();
        let mut triangles = Vec::with_capacity(2 * quads.len());
        for (around, inside) in quads {
            let [p, q, r, s] = around.map(|one| cube[one]);
            let [q, s] = if inside { [q, s] } else { [s, q] };
            triangles.push([p, q, r]);
            triangles.push([p, r, s]);
        }
        Mesh { points, triangles }
    }
}
