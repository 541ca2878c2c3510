//! A lattice of nodes in the plane across the tool's axis, and discs of nodes around each.
//!
//! Values at nodes are kept row by row. [`Grid::highest`] and [`Grid::lowest`] take the greatest or least value of a disc around
//! every node: for a flat bottom that is where it rests, and how low places below it are reached.

/// Nodes at even steps of a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grid {
    /// The first node, mm.
    pub lo: [f64; 2],
    /// Distance of nodes, mm.
    pub cell: f64,
    /// Nodes along both sides.
    pub n: [usize; 2],
}

/// Nodes within a distance of one: for each row beside it half the width there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Disc {
    rows: Vec<(isize, usize)>,
}

impl Disc {
    /// All nodes within a radius.
    pub fn new(radius_mm: f64, cell: f64) -> Self {
        let r = (radius_mm / cell).max(0.0);
        let most = r as isize;
        let half = |dj: isize| (r * r - (dj * dj) as f64).max(0.0).sqrt() as usize;
        Self { rows: (-most..=most).map(|dj| (dj, half(dj))).collect() }
    }

    /// How many nodes it has.
    pub fn count(&self) -> usize {
        self.rows.iter().map(|r| 2 * r.1 + 1).sum()
    }
}

impl Grid {
    /// Nodes over a rectangle, the last at its upper corner or beyond it.
    pub fn over([lo, hi]: [[f64; 2]; 2], cell: f64) -> Self {
        let n = [0, 1].map(|k| ((hi[k] - lo[k]) / cell).max(0.0).ceil() as usize + 1);
        Self { lo, cell, n }
    }

    pub const fn len(&self) -> usize {
        self.n[0] * self.n[1]
    }

    pub const fn place(&self, k: usize) -> [usize; 2] {
        [k % self.n[0], k / self.n[0]]
    }

    pub fn at(&self, k: usize) -> [f64; 2] {
        let place = self.place(k);
        [0, 1].map(|a| self.lo[a] + self.cell * place[a] as f64)
    }

    /// The node nearest to a point; None beside the lattice.
    #[inline]
    pub fn near(&self, p: [f64; 2]) -> Option<usize> {
        let i = ((p[0] - self.lo[0]) / self.cell).round();
        let j = ((p[1] - self.lo[1]) / self.cell).round();
        // No number is within no bounds.
        let inside = i >= 0.0 && j >= 0.0 && i < self.n[0] as f64 && j < self.n[1] as f64;
        inside.then(|| j as usize * self.n[0] + i as usize)
    }

    /// The four nodes around a point, and how far it is from the first along both sides, in cells.
    #[inline]
    pub fn around(&self, p: [f64; 2]) -> Option<([usize; 4], [f64; 2])> {
        let x = (p[0] - self.lo[0]) / self.cell;
        let y = (p[1] - self.lo[1]) / self.cell;
        let [ni, nj] = self.n;
        if !(x >= 0.0 && y >= 0.0 && x <= ni as f64 - 1.0 && y <= nj as f64 - 1.0 && ni > 1 && nj > 1) {
            return None;
        }
        let (i, j) = ((x as usize).min(ni - 2), (y as usize).min(nj - 2));
        let k = j * ni + i;
        Some(([k, k + 1, k + ni, k + ni + 1], [x - i as f64, y - j as f64]))
    }

    /// The nodes next to one: four, or eight with those aslant.
    pub fn beside(&self, k: usize, aslant: bool) -> impl Iterator<Item = usize> + use<> {
        const ALL: [[isize; 2]; 8] = [[1, 0], [0, 1], [-1, 0], [0, -1], [1, 1], [-1, 1], [-1, -1], [1, -1]];
        let ([i, j], [ni, nj]) = (self.place(k), self.n);
        ALL[..if aslant { 8 } else { 4 }].iter().filter_map(move |[di, dj]| {
            let (a, b) = (i.checked_add_signed(*di)?, j.checked_add_signed(*dj)?);
            (a < ni && b < nj).then_some(b * ni + a)
        })
    }

    /// The rows of a disc around a node, as ranges of nodes.
    pub fn disc<'a>(
        &self,
        disc: &'a Disc,
        k: usize,
    ) -> impl Iterator<Item = std::ops::Range<usize>> + use<'a> {
        let ([i, j], [ni, nj]) = (self.place(k), self.n);
        disc.rows.iter().filter_map(move |(dj, half)| {
            let b = j.checked_add_signed(*dj).filter(|b| *b < nj)?;
            Some(b * ni + i.saturating_sub(*half)..b * ni + (i + half + 1).min(ni))
        })
    }

    /// The greatest value of a disc around every node.
    pub fn highest(&self, values: &[f64], disc: &Disc) -> Vec<f64> {
        let [ni, nj] = self.n;
        let mut rows = disc.rows.clone();
        rows.sort_by_key(|r| (r.1, r.0));
        // The greatest of the nodes up to `width` to both sides, which grows from row to row of the disc.
        let (mut wide, mut width) = (values.to_vec(), 0);
        let mut out = vec![f64::NEG_INFINITY; values.len()];
        for (dj, half) in rows {
            while width < half {
                width += 1;
                for j in 0..nj {
                    let (to, from) = (&mut wide[j * ni..(j + 1) * ni], &values[j * ni..(j + 1) * ni]);
                    if width < ni {
                        to[width..].iter_mut().zip(from).for_each(|(t, f)| *t = t.max(*f));
                        to[..ni - width].iter_mut().zip(&from[width..]).for_each(|(t, f)| *t = t.max(*f));
                    }
                }
            }
            for j in 0..nj {
                if let Some(b) = j.checked_add_signed(dj).filter(|b| *b < nj) {
                    let to = &mut out[j * ni..(j + 1) * ni];
                    to.iter_mut().zip(&wide[b * ni..(b + 1) * ni]).for_each(|(t, f)| *t = t.max(*f));
                }
            }
        }
        out
    }

    /// The least value of a disc around every node.
    pub fn lowest(&self, values: &[f64], disc: &Disc) -> Vec<f64> {
        let turned: Vec<f64> = values.iter().map(|v| -v).collect();
        self.highest(&turned, disc).into_iter().map(|v| -v).collect()
    }

    /// The greatest of all `values[m] - lift(distance of m)` around every node, for nodes within a radius.
    pub fn raised(&self, values: &[f64], radius_mm: f64, lift: impl Fn(f64) -> f64) -> Vec<f64> {
        let [ni, nj] = self.n;
        let most = (radius_mm / self.cell).max(0.0) as isize;
        let mut out = vec![f64::NEG_INFINITY; values.len()];
        for dj in -most..=most {
            for di in -most..=most {
                let rho = self.cell * ((di * di + dj * dj) as f64).sqrt();
                if rho > radius_mm || di.unsigned_abs() >= ni {
                    continue;
                }
                let by = lift(rho);
                for j in 0..nj {
                    let Some(b) = j.checked_add_signed(dj).filter(|b| *b < nj) else { continue };
                    let (to, from) = (&mut out[j * ni..(j + 1) * ni], &values[b * ni..(b + 1) * ni]);
                    let shift = di.unsigned_abs();
                    let (to, from) = if di >= 0 {
                        (&mut to[..ni - shift], &from[shift..])
                    } else {
                        (&mut to[shift..], &from[..ni - shift])
                    };
                    to.iter_mut().zip(from).for_each(|(t, f)| *t = t.max(f - by));
                }
            }
        }
        out
    }

    /// Nodes that are connected, four ways, as numbers from 0; [`Grid::NONE`] for nodes that are in none.
    pub fn parts(&self, inside: &[bool]) -> (Vec<u32>, usize) {
        let mut out = vec![Self::NONE; self.len()];
        let mut count = 0;
        let mut open = Vec::new();
        for k in 0..self.len() {
            if !inside[k] || out[k] != Self::NONE {
                continue;
            }
            out[k] = count;
            open.push(k);
            while let Some(k) = open.pop() {
                for m in self.beside(k, false) {
                    if inside[m] && out[m] == Self::NONE {
                        out[m] = count;
                        open.push(m);
                    }
                }
            }
            count += 1;
        }
        (out, count as usize)
    }

    /// No part.
    pub const NONE: u32 = u32::MAX;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::over([[-1.0, 2.0], [5.0, 6.5]], 0.5)
    }

    /// Against all pairs of nodes.
    #[test]
    fn discs_take_the_greatest_and_least_of_their_nodes() {
        let g = grid();
        let values: Vec<f64> = (0..g.len()).map(|k| ((k * 7919) % 101) as f64).collect();
        for radius in [0.0, 0.6, 1.3, 2.0] {
            let disc = Disc::new(radius, g.cell);
            let near = |k: usize, m: usize| {
                let (a, b) = (g.at(k), g.at(m));
                (a[0] - b[0]).hypot(a[1] - b[1])
            };
            let lift = |rho: f64| 3.0 * rho * rho;
            let (high, low) = (g.highest(&values, &disc), g.lowest(&values, &disc));
            let raised = g.raised(&values, radius, lift);
            for k in 0..g.len() {
                let all = || (0..g.len()).filter(|m| near(k, *m) <= radius + 1e-9);
                assert_eq!(high[k], all().map(|m| values[m]).fold(f64::MIN, f64::max));
                assert_eq!(low[k], all().map(|m| values[m]).fold(f64::MAX, f64::min));
                let most = all().map(|m| values[m] - lift(near(k, m))).fold(f64::MIN, f64::max);
                assert!((raised[k] - most).abs() < 1e-9);
                let mut in_disc: Vec<usize> = g.disc(&disc, k).flatten().collect();
                in_disc.sort_unstable();
                assert_eq!(in_disc, all().collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn nodes_and_parts() {
        let g = grid();
        assert_eq!(g.n, [13, 10]);
        assert_eq!(g.near([5.1, 2.2]), Some(12));
        assert_eq!((g.near([5.3, 2.2]), g.near([f64::NAN, 2.2])), (None, None));
        assert_eq!(g.around([-0.75, 6.25]), Some(([104, 105, 117, 118], [0.5, 0.5])));
        assert_eq!(g.beside(0, true).collect::<Vec<_>>(), [1, 13, 14]);
        // Two halves that touch across a corner only.
        let inside: Vec<bool> = (0..g.len()).map(|k| (g.place(k)[0] < 6) == (g.place(k)[1] < 5)).collect();
        let (part, count) = g.parts(&inside);
        assert_eq!((count, part[0], part[g.len() - 1], part[12]), (2, 0, 1, Grid::NONE));
    }
}
