//! Regional productivity as a map over a face: area and time of each of its cells.

use super::{FinishedPlace, Finishing};
use osculate_geom::{Domain, Surface, Uv};

/// The cells into which the parameter rectangle of a face is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// The face, by its number.
    pub face: u32,
    /// Its rectangle.
    pub domain: Domain,
    /// Cells along u.
    pub along_u: usize,
    /// Cells along v.
    pub along_v: usize,
}

impl Cells {
    /// About `most` cells over the whole rectangle of a face, about as long as wide in space.
    ///
    /// ```
    /// use osculate_geom::{Domain, Interval, analytic::Plane};
    /// use osculate_productivity::real_time::Cells;
    ///
    /// let plane = Plane::new(Domain { u: Interval::new(0.0, 40.0), v: Interval::new(0.0, 10.0) });
    /// let cells = Cells::over(&plane, 0, 400);
    /// assert_eq!((cells.along_u, cells.along_v), (40, 10));
    /// ```
    #[must_use]
    pub fn over(surface: &dyn Surface, face: u32, most: usize) -> Self {
        let domain = surface.domain();
        // Lengths of the rectangle in space, as means over nine places.
        let (mut long, mut wide) = (0.0, 0.0);
        for k in 0..9u32 {
            let at = domain.at(f64::from(k % 3 + 1) / 4.0, f64::from(k / 3 + 1) / 4.0);
            let jet = surface.jet2(at);
            long += jet.du.norm() * domain.u.length();
            wide += jet.dv.norm() * domain.v.length();
        }
        let most = most.max(1);
        let along = (most as f64 * long / wide).sqrt().round();
        let along_u = if along.is_finite() { (along as usize).clamp(1, most) } else { 1 };
        Self { face, domain, along_u, along_v: (most / along_u).max(1) }
    }

    /// How many they are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.along_u.max(1) * self.along_v.max(1)
    }

    /// The cell of a place, the nearest one of a place beyond the rectangle; they stand in rows of u.
    #[must_use]
    pub fn of(&self, at: Uv) -> usize {
        let cell = |x: f64, n: usize| ((x * n as f64).floor().max(0.0) as usize).min(n - 1);
        let u = cell((at.u - self.domain.u.lo) / self.domain.u.length(), self.along_u.max(1));
        let v = cell((at.v - self.domain.v.lo) / self.domain.v.length(), self.along_v.max(1));
        u * self.along_v.max(1) + v
    }
}

/// Regional productivity: what each cell of a face takes. Cells stand in rows of u: that of cell i along u, j along v is at
/// `i * v.len() + j`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Region {
    /// Middles of the cells along u.
    pub u: Vec<f64>,
    /// Middles of the cells along v.
    pub v: Vec<f64>,
    /// Area finished in each cell, mm2.
    pub area_mm2: Vec<f64>,
    /// The time of that, min: `int dF / E_F` over the cell.
    pub time_min: Vec<f64>,
}

impl Region {
    /// Of places with what finished them; those of other faces are left out. A stretch's time is shared among its places by area.
    #[must_use]
    pub fn of(places: &[FinishedPlace], finishing: &Finishing, cells: Cells) -> Self {
        let Cells { face, domain, along_u, along_v } = cells;
        let (rows, columns) = (along_u.max(1), along_v.max(1));
        let middles = |n: usize, at: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..n).map(|k| at((k as f64 + 0.5) / n as f64)).collect()
        };
        let mut area_mm2 = vec![0.0; cells.count()];
        let mut time_min = area_mm2.clone();
        for (k, p) in places.iter().enumerate().filter(|(_, p)| p.face == face) {
            let Some(stretch) = finishing.stretch(k) else { continue };
            let at = cells.of(p.at);
            area_mm2[at] += p.area_mm2;
            time_min[at] += p.area_mm2 / stretch.amount * stretch.time_min;
        }
        Self {
            u: middles(rows, &|x| domain.u.at(x)),
            v: middles(columns, &|x| domain.v.at(x)),
            area_mm2,
            time_min,
        }
    }

    /// Productivity of each cell, area over time, mm2/min; not a number where nothing was finished.
    #[must_use]
    pub fn mm2_min(&self) -> Vec<f64> {
        self.area_mm2.iter().zip(&self.time_min).map(|(area, time)| area / time).collect()
    }

    /// The integral of the productivity over the time, mm2.
    #[must_use]
    pub fn integral_mm2(&self) -> f64 {
        let each = self.mm2_min().into_iter().zip(&self.time_min);
        each.filter(|(rate, _)| rate.is_finite()).fold(0.0, |sum, (rate, time)| sum + rate * time)
    }
}
