//! How far material goes from a point, as far as its rays tell.

use super::Stock;
use super::lattice::SIDE;
use osculate_geom::{Point3, Unit3};

/// Places a cell apart that are looked at along a direction, of a cell.
const STEP: f64 = 0.5;

impl Stock {
    /// Whether a point lies in material: as most of the rays through its cells say.
    #[must_use]
    pub fn holds(&self, p: &Point3) -> bool {
        let inside = |f: &&super::Field| {
            let lattice = &f.lattice;
            let across = lattice.others();
            let mut at = [0; 2];
            for k in 0..2 {
                let cell = (p[across[k]] - lattice.origin[across[k]]) / lattice.cell[k];
                if !(cell >= 0.0 && cell < lattice.count[k] as f64) {
                    return false;
                }
                at[k] = cell as usize;
            }
            let wide = lattice.count[0].div_ceil(SIDE);
            let tile = &f.tiles[(at[1] / SIDE) * wide + at[0] / SIDE];
            let s = p[lattice.axis];
            tile.of((at[1] % SIDE) * SIDE + at[0] % SIDE).iter().any(|[a, b]| (*a..=*b).contains(&s))
        };
        2 * self.fields.iter().filter(inside).count() > self.fields.len()
    }

    /// How far material goes from a point along a direction at most, mm, to a cell; zero where there is none.
    #[must_use]
    pub fn beyond_mm(&self, from: &Point3, along: &Unit3) -> f64 {
        let step = STEP * self.cell;
        let reach = self.bounds.diagonal_mm() + (from - self.bounds.centre()).norm();
        // The diagonal of a box over its cell is a number of steps that memory has room for.
        let steps = (reach / step) as usize;
        let at = |k: usize| from + along.into_inner() * (k as f64 * step);
        let last = (0..=steps).rev().find(|k| self.holds(&at(*k)));
        last.map_or(0.0, |k| (k + 1) as f64 * step)
    }
}

#[cfg(test)]
mod tests {
    use crate::removal::stock::{Blank, Resolution, Stock};
    use osculate_geom::{Box3, Point3, Unit3, Vec3};

    /// From within a box along any direction: to where the direction leaves it, to two steps.
    #[test]
    fn material_ends_where_its_box_does() {
        let bounds = Box3 { min: Point3::new(-5.0, -4.0, -3.0), max: Point3::new(5.0, 4.0, 2.0) };
        let resolution = Resolution { cell_mm: 0.1, tri: true, budget_bytes: 1 << 30 };
        let stock = Stock::fill(&Blank::Box(bounds), &resolution).unwrap().stock;
        let from = Point3::new(1.0, -1.0, 0.5);
        for (way, wanted) in
            [([0.0, 0.0, 1.0], 1.5), ([-1.0, 0.0, 0.0], 6.0), ([1.0, 1.0, 0.0], 4.0 * 2f64.sqrt())]
        {
            let got = stock.beyond_mm(&from, &Unit3::new_normalize(Vec3::from(way)));
            assert!((got - wanted).abs() < 0.11, "{way:?}: {got} {wanted}");
        }
        assert_eq!(stock.beyond_mm(&Point3::new(0.0, 0.0, 3.0), &Vec3::z_axis()), 0.0);
        assert!(stock.holds(&from) && !stock.holds(&Point3::new(5.2, 0.0, 0.0)));
    }
}
