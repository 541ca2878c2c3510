//! Places that stand too high where a goal accepts that some area does.
//!
//! Beside what a tool cannot reach, such as a sharp inner edge, its strips fade out: what stands grows from nothing to all of it.
//! Where a goal accepts an area all that stands higher than the scallop, with the mark that a tooth may leave there, counts into it, with
//! the samples around: between a sample that is low enough and one that is not nothing can be shown. These samples are taken as never
//! touched; all others are judged as ever. So are places between samples in which something too high may hide, where samples ran out.

use super::hidden::doubtful;
use super::job::{Cut, Job, Sample};
use super::refine::Measured;
use super::tooth::Marks;
use super::tree::Ways;
use super::trial::{Look, ProveError, Trial};
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

/// Takes machined samples that stand higher than `scallop_mm` with their marks, and those of their face around them, as never touched. Around those
/// of the first `done` samples that are never touched all was taken already.
pub(super) fn give_up(
    samples: &[Sample],
    (cuts, marks): (&mut [Cut], &mut [f64]),
    scallop_mm: f64,
    (spacing_mm, done): (f64, usize),
) {
    let grid = Grid::new(samples, AROUND * spacing_mm);
    let height = |k: usize| cuts[k].standoff_mm + marks[k];
    let is_none = |k: usize| cuts[k].by.is_none();
    let is_high = |k: &usize| !samples[*k].check_only && (is_none(*k) || height(*k) > scallop_mm);
    let mut given: Vec<bool> = (0..samples.len()).map(|k| is_high(&k)).collect();
    let mut found: Vec<usize> =
        (0..samples.len()).filter(|k| given[*k] && !(*k < done && is_none(*k))).collect();
    let mut rim = found.clone();
    for round in 0..=ROUNDS {
        let mut next = Vec::new();
        for k in rim.iter().flat_map(|k| grid.near(*k)) {
            let joins = round == ROUNDS || height(k) > SKIRT * scallop_mm;
            if joins && !given[k] {
                given[k] = true;
                next.push(k);
            }
        }
        found.extend(&next);
        // The last round goes around all that was found.
        rim = if round + 1 == ROUNDS { found.clone() } else { next };
    }
    for ((cut, mark), given) in cuts.iter_mut().zip(marks).zip(given) {
        if given {
            cut.by = None;
            *mark = 0.0;
        }
    }
}

impl Trial<'_> {
    /// Whether a sample stands too high with its mark where the goal accepts an area that does.
    pub fn is_to_give_up(&self, look: &Look, marks: &Marks) -> bool {
        let Measured { samples, cuts, .. } = &look.measured;
        let high = |((s, c), mark): ((&Sample, &Cut), &f64)| {
            !s.check_only && c.by.is_some() && c.standoff_mm + mark > self.highest_mm()
        };
        self.goal.limits.unreached_mm2 > 0.0 && samples.iter().zip(cuts).zip(&marks.each).any(high)
    }

    /// Where the goal accepts an area that is not reached: takes what stands too high, and what is around it, as never touched.
    pub fn give_up(&self, look: &mut Look, marks: &mut Marks, spacing: f64) -> Result<(), ProveError> {
        if self.goal.limits.unreached_mm2 > 0.0 {
            let Measured { samples, cuts, .. } = &mut look.measured;
            give_up(samples, (cuts, &mut marks.each), self.highest_mm(), (spacing, look.given_up));
            look.given_up = samples.len();
            look.tally = self.tally(samples, cuts, &look.density)?;
        }
        Ok(())
    }

    /// Where the goal accepts an area that is not reached: takes the cells in which something too high may hide as never touched, where
    /// the area accepted suffices for all of them. Their area comes back, mm2; zero where nothing changed.
    pub fn give_up_open(&self, look: &mut Look, marks: &mut Marks) -> Result<f64, ProveError> {
        let room_mm2 = self.goal.limits.unreached_mm2 - look.tally.uncut_area_mm2;
        let Measured { samples, patches, cuts } = &mut look.measured;
        let ways = Ways::of_job(&self.job_without())?;
        let mut open = Vec::new();
        for [low, most_mark] in marks.lots() {
            let of_lot = |k: &usize| low < marks.each[*k] && marks.each[*k] <= most_mark;
            let is_settled = |k: usize| look.settled.each.get(k).is_some_and(|is| *is);
            let own: Vec<usize> = (0..samples.len()).filter(|k| !is_settled(*k) && of_lot(k)).collect();
            let of = |k: &usize| (samples[*k], (patches[*k], cuts[*k]));
            let (samples, (patches, cuts)): (Vec<_>, (Vec<_>, Vec<_>)) = own.iter().map(of).unzip();
            let job = Job { samples: &samples, ..self.job_without() };
            let found = doubtful(&self.surfaces, (&job, &ways), (&patches, &cuts), self.wanted(most_mark))?;
            open.extend(found.into_iter().map(|j| own[j]));
        }
        let area_mm2: f64 = open.iter().map(|k| samples[*k].area_mm2).sum();
        if open.is_empty() || area_mm2 > room_mm2 {
            return Ok(0.0);
        }
        for k in open {
            cuts[k].by = None;
            marks.each[k] = 0.0;
        }
        look.tally = self.tally(samples, cuts, &look.density)?;
        Ok(area_mm2)
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
        give_up(&samples, (&mut cuts, &mut [0.0; 10]), 0.02, (1.0, 0));
        let gone = |cuts: &[Cut]| (0..10).filter(|k| cuts[*k].by.is_none()).collect::<Vec<usize>>();
        assert_eq!(gone(&cuts), [3, 4, 5, 6, 7]);
        // What was given up does not grow by being looked at again; a sample that is added and stands too high takes what is around it.
        give_up(&samples, (&mut cuts, &mut [0.0; 10]), 0.02, (1.0, 10));
        assert_eq!(gone(&cuts), [3, 4, 5, 6, 7]);
        cuts[0] = cut(0.03);
        give_up(&samples, (&mut cuts, &mut [0.0; 10]), 0.02, (1.0, 10));
        assert_eq!(gone(&cuts), [0, 1, 2, 3, 4, 5, 6, 7]);
        let low = || -> Vec<Cut> { heights.iter().map(|h| cut(h.min(0.02))).collect() };
        let mut cuts = low();
        give_up(&samples, (&mut cuts, &mut [0.0; 10]), 0.02, (1.0, 0));
        assert!(cuts.iter().all(|c| c.by.is_some()));
        // The mark of a tooth stands on what is left.
        let mut marks = [0.001; 10];
        marks[1] = 0.011;
        let mut cuts = low();
        give_up(&samples, (&mut cuts, &mut marks), 0.021, (1.0, 0));
        assert!(cuts.iter().all(|c| c.by.is_some()));
        give_up(&samples, (&mut cuts, &mut marks), 0.0205, (1.0, 0));
        assert_eq!(gone(&cuts), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(marks.iter().zip(&cuts).all(|(m, c)| (*m == 0.0) == c.by.is_none()));
    }
}
