//! The levels of passes from the reaches of the cells, and which way the passes on them run.
//!
//! A pass on level c covers the part of a cell with `c - up <= phi <= c + down`. So after passes up to c the lowest
//! uncovered value of a cell with values in [low, high] is `f = max(low, c + down)`, and the next pass may lie at
//! `f + up`: the least of these over the cells is taken. No order of the passes along the face is needed, so that level
//! lines may close, part and join.
//!
//! A leaning tool reaches further to one side than to the other where the part winds along the pass: to third order its edge
//! leaves the ground by `1/2 tau y^3 / R` more on one side. Turned round it is the other side. Passes to and fro meet with
//! the same sides in turn, far sides and near sides, so that spacing alternates between wide and narrow and loses nothing.

use super::cell::{Cell, Ways};
use super::cells::Cells;
use crate::plan::seat::Seat;
use crate::plan::{MAX_PASSES, PlanError};

impl Cells<'_> {
    /// The levels of the passes, ascending.
    pub fn levels(&self, seat: &Seat<'_>) -> Result<Vec<f64>, PlanError> {
        let task = seat.task();
        let mut open: Vec<&Cell> = self.cells.iter().filter(|c| c.inside()).collect();
        open.sort_by(|a, b| a.low.total_cmp(&b.low));
        let range = |f: fn(f64, f64) -> f64, of: fn(&Cell) -> f64| open.iter().map(|c| of(c)).reduce(f);
        let (Some(top), Some(bottom)) = (range(f64::max, |c| c.high), range(f64::min, |c| c.low)) else {
            return Ok(Vec::new());
        };
        let slack = 1e-7 * (top - bottom);
        let mut levels: Vec<f64> = Vec::new();
        let mut last = f64::NEG_INFINITY;
        loop {
            let [down, up] = self.ways.around(levels.len());
            let frontier = |c: &Cell| {
                if last < c.floor { c.low } else { c.low.max(last + c.down[down]) }
            };
            // A corner of the face may be all that lies in a cell: its one value is covered like any other.
            open.retain(|c| last < c.floor || last + c.down[down] < c.high - slack);
            let mut next = f64::INFINITY;
            for c in &open {
                if c.low >= next {
                    break;
                }
                let f = frontier(c);
                // What is left below a peak is covered from its middle.
                let reach = c.up[up];
                let up = if f + reach > c.peak { 0.5 * (c.peak - f).max(c.high - f) } else { reach };
                next = next.min(f + up.min(reach));
            }
            if open.is_empty() {
                return Ok(levels);
            }
            if levels.len() >= MAX_PASSES {
                return Err(PlanError::TooManyPasses {
                    face: task.face.to_owned(),
                    limit: MAX_PASSES,
                    scallop_mm: task.tolerance.scallop_mm,
                });
            }
            levels.push(next);
            last = next;
        }
    }

    /// The levels, the first pass run whichever way makes them fewer.
    pub fn fewest_levels(&mut self, seat: &Seat<'_>) -> Result<Vec<f64>, PlanError> {
        let levels = self.levels(seat)?;
        if self.ways == Ways::Either {
            return Ok(levels);
        }
        let before = std::mem::replace(&mut self.ways, Ways::ToAndFro { first_reversed: true });
        let others = self.levels(seat)?;
        if others.len() < levels.len() {
            return Ok(others);
        }
        self.ways = before;
        Ok(levels)
    }
}
