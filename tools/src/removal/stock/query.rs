//! Where there is material: points asked of the rays that run next to them.

use super::lattice::{Lattice, SIDE, Tile};
use super::{Field, Stock};
use osculate_geom::Point3;

impl Lattice {
    /// The cell of a ray across, by its place along both other axes; outside of all the nearest.
    fn cell_of(&self, p: &Point3) -> [usize; 2] {
        let across = self.others();
        [0, 1].map(|k| {
            let at = ((p[across[k]] - self.origin[across[k]]) / self.cell[k]).floor().max(0.0);
            (at as usize).min(self.count[k] - 1)
        })
    }
}

impl Field {
    /// The stretches of the ray through the cell of a point.
    pub(super) fn ray(&self, p: &Point3) -> &[[f64; 2]] {
        let [i, j] = self.lattice.cell_of(p);
        let wide = self.lattice.count[0].div_ceil(SIDE);
        let tile: &Tile = &self.tiles[(j / SIDE) * wide + i / SIDE];
        tile.of((j % SIDE) * SIDE + i % SIDE)
    }
}

impl Stock {
    /// Whether there is material at a point, as most of the rays through its cell say; its boundary is good to a cell.
    #[must_use]
    pub fn is_material(&self, p: &Point3) -> bool {
        if !(0..3).all(|k| (self.bounds.min[k]..=self.bounds.max[k]).contains(&p[k])) {
            return false;
        }
        let held = |f: &&Field| {
            let s = p[f.lattice.axis];
            f.ray(p).iter().any(|[a, b]| (*a..=*b).contains(&s))
        };
        2 * self.fields.iter().filter(held).count() > self.fields.len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Blank, Resolution};
    use super::*;
    use osculate_geom::Box3;

    /// A box is known to its faces; what lies outside of it is none.
    #[test]
    fn a_box_is_known_to_its_faces() {
        let b = Box3 { min: Point3::new(-3.0, 0.0, 1.0), max: Point3::new(5.0, 2.5, 4.0) };
        for tri in [true, false] {
            let resolution = Resolution { cell_mm: 0.3, tri, budget_bytes: 1 << 24 };
            let stock = Stock::fill(&Blank::Box(b), &resolution).unwrap().stock;
            for k in 0..1000 {
                let share = |n: f64| (0.5 + n * f64::from(k)).fract();
                let at = [0.618_034, 0.754_878, 0.569_840].map(share);
                let p = Point3::new(-4.0 + 10.0 * at[0], -1.0 + 5.0 * at[1], 5.0 * at[2]);
                let inside = (0..3).all(|k| (b.min[k]..=b.max[k]).contains(&p[k]));
                assert_eq!(stock.is_material(&p), inside, "{p}");
            }
        }
    }
}
