//! Places that stand too high where a goal accepts that some area does.
//!
//! Beside what a tool cannot reach, such as a sharp inner edge, its strips fade out: what stands grows from nothing to all of it.
//! Where a goal accepts an area all that stands higher than the scallop, with the mark that a tooth may leave there, counts into it, with
//! the samples around: between a sample that is low enough and one that is not nothing can be shown. These samples are taken as never
//! touched; all others are judged as ever.

use super::job::{Cut, Sample};
use osculate_geom::Point3;
use std::collections::HashMap;

/// Samples around one that stands too high, in spacings: those of the cells that have it for a corner, and of the next.
const AROUND: f64 = 2.0;
/// Samples there that are higher than this part of the scallop belong to the skirt of what stands, in so many rounds: further off they
/// are the scallops of passes.
const SKIRT: f64 = 0.75;
const ROUNDS: u32 = 3;

/// Samples by the cells of a grid.
struct Grid<'a> {
    samples: &'a [Sample],
    cells: HashMap<[i64; 3], Vec<usize>>,
    side: f64,
}

impl<'a> Grid<'a> {
    fn new(samples: &'a [Sample], side: f64) -> Self {
        let mut out = Self { samples, cells: HashMap::new(), side };
        for (k, s) in samples.iter().enumerate().filter(|(_, s)| !s.check_only) {
            out.cells.entry(out.cell(&s.point)).or_default().push(k);
        }
        out
    }

    fn cell(&self, p: &Point3) -> [i64; 3] {
        // Cells of a part are far fewer than whole numbers.
        [p.x, p.y, p.z].map(|x| (x / self.side).floor() as i64)
    }

    /// Samples of the same face no further off than a cell is long.
    fn near(&self, k: usize) -> impl Iterator<Item = usize> {
        let s = &self.samples[k];
        let [x, y, z] = self.cell(&s.point);
        let cells = (0..27).map(move |c| [x + c / 9 - 1, y + c / 3 % 3 - 1, z + c % 3 - 1]);
        cells.filter_map(|c| self.cells.get(&c)).flatten().copied().filter(move |j| {
            let other = &self.samples[*j];
            other.face == s.face && (other.point - s.point).norm_squared() <= self.side * self.side
        })
    }
}

/// Takes machined samples that stand higher than `scallop_mm` with their marks, and those of their face around them, as never touched.
pub(super) fn give_up(
    samples: &[Sample],
    (cuts, marks): (&mut [Cut], &mut [f64]),
    scallop_mm: f64,
    spacing_mm: f64,
) {
    let grid = Grid::new(samples, AROUND * spacing_mm);
    let height = |k: usize| cuts[k].standoff_mm + marks[k];
    let is_high = |k: &usize| !samples[*k].check_only && (cuts[*k].by.is_none() || height(*k) > scallop_mm);
    let mut given: Vec<bool> = (0..samples.len()).map(|k| is_high(&k)).collect();
    let mut rim: Vec<usize> = (0..samples.len()).filter(is_high).collect();
    for round in 0..=ROUNDS {
        let mut next = Vec::new();
        for k in rim.iter().flat_map(|k| grid.near(*k)) {
            let joins = round == ROUNDS || height(k) > SKIRT * scallop_mm;
            if joins && !given[k] {
                given[k] = true;
                next.push(k);
            }
        }
        // The last round goes around all that was found.
        rim = if round + 1 == ROUNDS { (0..samples.len()).filter(|k| given[*k]).collect() } else { next };
    }
    for ((cut, mark), given) in cuts.iter_mut().zip(marks).zip(given) {
        if given {
            cut.by = None;
            *mark = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::removal::{Body, By};
    use osculate_geom::{Vec3, uv};

    #[test]
    fn what_stands_beside_a_high_place_is_given_up_with_it() {
        let sample = |k: usize, check_only: bool| Sample {
            point: Point3::new(k as f64, 0.0, 0.0),
            normal: Vec3::z_axis(),
            face: 0,
            uv: uv(k as f64, 0.0),
            area_mm2: 1.0,
            check_only,
        };
        let cut = |standoff_mm: f64| Cut {
            standoff_mm,
            by: Some(By { motion: 0, block: 0, body: Body::Cutter, rapid: false }),
            holder: None,
            rapid: None,
        };
        let samples: Vec<Sample> = (0..10).map(|k| sample(k, k == 8)).collect();
        let heights = [0.0, 0.01, 0.0, 0.0, 0.0, 0.03, 0.0, 0.0, 0.0, 0.0];
        let mut cuts: Vec<Cut> = heights.iter().map(|h| cut(*h)).collect();
        give_up(&samples, (&mut cuts, &mut [0.0; 10]), 0.02, 1.0);
        let gone = |cuts: &[Cut]| (0..10).filter(|k| cuts[*k].by.is_none()).collect::<Vec<usize>>();
        assert_eq!(gone(&cuts), [3, 4, 5, 6, 7]);
        let low = || -> Vec<Cut> { heights.iter().map(|h| cut(h.min(0.02))).collect() };
        let mut cuts = low();
        give_up(&samples, (&mut cuts, &mut [0.0; 10]), 0.02, 1.0);
        assert!(cuts.iter().all(|c| c.by.is_some()));
        // The mark of a tooth stands on what is left.
        let mut marks = [0.001; 10];
        marks[1] = 0.011;
        let mut cuts = low();
        give_up(&samples, (&mut cuts, &mut marks), 0.021, 1.0);
        assert!(cuts.iter().all(|c| c.by.is_some()));
        give_up(&samples, (&mut cuts, &mut marks), 0.0205, 1.0);
        assert_eq!(gone(&cuts), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(marks.iter().zip(&cuts).all(|(m, c)| (*m == 0.0) == c.by.is_none()));
    }
}
