//! Where the rays of one direction stand, and the tiles that they are kept in.

use osculate_geom::{Box3, Point3};

/// Rays along each side of a tile.
pub(super) const SIDE: usize = 16;
/// Rays of a tile.
pub(super) const TILE: usize = SIDE * SIDE;

/// The golden section: multiples of it fill the unit interval as evenly as any sequence does.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Rays along one axis over a rectangle of cells.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    /// Along which axis the rays run.
    pub axis: usize,
    /// Lower corner of the cells.
    pub origin: Point3,
    /// Sides of cells across, mm: the two other axes in cyclic order.
    pub cell: [f64; 2],
    /// Number of cells across.
    pub count: [usize; 2],
}

/// A ray's place across: coordinates along the two other axes.
pub(super) type Across = [f64; 2];

impl Lattice {
    /// Rays through a box, cells of at most `cell` that divide it evenly.
    pub fn over(bounds: &Box3, cell: f64, axis: usize) -> Self {
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let size = bounds.max - bounds.min;
        let count = others.map(|k| (size[k] / cell - 1e-9).ceil().max(1.0) as usize);
        let cell = [0, 1].map(|k| size[others[k]] / count[k] as f64);
        Self { axis, origin: bounds.min, cell, count }
    }

    pub const fn rays(&self) -> usize {
        self.count[0] * self.count[1]
    }

    pub fn area(&self) -> f64 {
        self.cell[0] * self.cell[1]
    }

    /// Axes across, cyclic.
    pub const fn others(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    fn tiles_across(&self) -> [usize; 2] {
        self.count.map(|n| n.div_ceil(SIDE))
    }

    pub fn tiles(&self) -> usize {
        let [a, b] = self.tiles_across();
        a * b
    }

    /// Place of the ray in cell (i, j): off the middle by a share of the cell that differs from row to row.
    fn across(&self, i: usize, j: usize) -> Across {
        let [b, c] = self.others();
        let share = |k: usize| (0.5 + GOLDEN * k as f64).fract();
        [
            self.origin[b] + self.cell[0] * (i as f64 + share(j)),
            self.origin[c] + self.cell[1] * (j as f64 + share(i)),
        ]
    }

    /// Calls `f` with the rays of a tile: index within the tile and place.
    pub fn each_ray(&self, tile: usize, mut f: impl FnMut(usize, Across)) {
        let wide = self.tiles_across()[0];
        let (ti, tj) = (tile % wide, tile / wide);
        for k in 0..TILE {
            let (i, j) = (ti * SIDE + k % SIDE, tj * SIDE + k / SIDE);
            if i < self.count[0] && j < self.count[1] {
                f(k, self.across(i, j));
            }
        }
    }

    /// The tiles whose cells a rectangle across touches.
    pub fn touching(&self, lo: Across, hi: Across) -> impl Iterator<Item = usize> + use<> {
        let [b, c] = self.others();
        let wide = self.tiles_across();
        let range = |k: usize, axis: usize| {
            let tile = self.cell[k] * SIDE as f64;
            let at = |x: f64| ((x - self.origin[axis]) / tile).floor();
            let most = wide[k] as f64 - 1.0;
            let (first, last) = (at(lo[k]).max(0.0), at(hi[k]).min(most));
            if first <= last { first as usize..last as usize + 1 } else { 0..0 }
        };
        let (rows, columns) = (range(1, c), range(0, b));
        rows.flat_map(move |j| columns.clone().map(move |i| j * wide[0] + i))
    }

    /// A point of a ray.
    pub fn point(&self, at: Across, s: f64) -> Point3 {
        let [b, c] = self.others();
        let mut p = Point3::origin();
        (p[self.axis], p[b], p[c]) = (s, at[0], at[1]);
        p
    }
}

/// The stretches of material of a tile's rays, ascending on each.
#[derive(Clone, Debug, PartialEq, Default)]
pub(super) struct Tile {
    spans: Vec<[f64; 2]>,
    /// Where each ray's stretches begin; one more at the end.
    starts: Vec<u32>,
}

impl Tile {
    pub fn pack(rays: &[Vec<[f64; 2]>]) -> Self {
        let mut tile = Self {
            spans: Vec::with_capacity(rays.iter().map(Vec::len).sum()),
            starts: Vec::with_capacity(rays.len() + 1),
        };
        for ray in rays {
            // A tile has few rays, and a ray no more stretches than motions.
            tile.starts.push(tile.spans.len() as u32);
            tile.spans.extend_from_slice(ray);
        }
        tile.starts.push(tile.spans.len() as u32);
        tile
    }

    pub fn of(&self, ray: usize) -> &[[f64; 2]] {
        match (self.starts.get(ray), self.starts.get(ray + 1)) {
            (Some(a), Some(b)) => &self.spans[*a as usize..*b as usize],
            _ => &[],
        }
    }

    pub fn length(&self) -> f64 {
        self.spans.iter().map(|[a, b]| b - a).fold(0.0, |sum, x| sum + x)
    }

    pub const fn bytes(&self) -> usize {
        self.spans.len() * size_of::<[f64; 2]>() + self.starts.len() * size_of::<u32>()
    }
}
