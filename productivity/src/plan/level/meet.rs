//! Reaches put right where passes meet.
//!
//! The reach at the middle of a cell is asked of passes that would come to lie just as far away as they cover it, and the least
//! of neighbouring cells is counted on. Once levels are taken it is known which two passes meet near a cell: the tool of each
//! is asked what it leaves at that ridge, and since standoffs grow with the square of the distance the levels can then be taken
//! so that the ridges stand at the design height, no lower.

use super::cell::Ways;
use super::cells::{Cells, place};
use super::reach::met;
use crate::plan::PlanError;
use crate::plan::seat::Seat;
use rayon::prelude::*;

/// Rounds of levels and ridges: reaches change by the square of what levels are moved. In the last they only get shorter.
const ROUNDS: u32 = 3;
/// Places of a cell from which ridges are looked for, in its sides: of half of them in turn, of all in the last round.
const PLACES: [[f64; 2]; 4] = [[0.2, 0.3], [0.8, 0.7], [0.3, 0.8], [0.7, 0.2]];

/// Reaches at a ridge.
struct Met {
    /// Which of the reaches of a cell they are, below and above.
    ways: [usize; 2],
    up: f64,
    down: f64,
}

impl Cells<'_> {
    /// The levels of passes that meet at the design height.
    pub fn met_levels(&mut self, seat: &Seat<'_>) -> Result<Vec<f64>, PlanError> {
        let mut levels = self.fewest_levels(seat)?;
        for round in 1..=ROUNDS {
            let places = match round {
                ROUNDS => &PLACES[..],
                odd if odd % 2 == 1 => &PLACES[..2],
                _ => &PLACES[2..],
            };
            self.measure(seat, &levels, places, round < ROUNDS);
            levels = self.levels(seat)?;
        }
        Ok(levels)
    }

    /// Measures reaches at the ridges between levels, seen from places of the cells; those of cells at which no two passes meet
    /// stay, and longer ones are taken only where that is asked for.
    fn measure(&mut self, seat: &Seat<'_>, levels: &[f64], places: &[[f64; 2]], longer: bool) {
        let n = self.count;
        let found: Vec<Vec<Met>> = (0..self.cells.len())
            .into_par_iter()
            .map(|k| {
                let c = &self.cells[k];
                let ridge = |[f, g]: [f64; 2]| {
                    let at = place(&self.face, n, (k / n[1]) as f64 + f, (k % n[1]) as f64 + g);
                    let (.., phi) = self.face.at(at)?;
                    let above = levels.partition_point(|l| *l <= phi.value);
                    let between = [*levels.get(above.checked_sub(1)?)?, *levels.get(above)?];
                    let ways @ [down, up] = self.ways.around(above);
                    let share = c.down[down] / (c.up[up] + c.down[down]);
                    let reversed = self.ways.reversed(above).map(|r| [!r, r]);
                    let [up, down] = met(seat, self.face, at, between, (share, reversed))?;
                    Some(Met { ways, up, down })
                };
                let whole = c.inside() && !c.at_extreme();
                places.iter().filter(|_| whole).filter_map(|p| ridge(*p)).collect()
            })
            .collect();
        for ((c, rough), all) in self.cells.iter_mut().zip(&self.rough).zip(found) {
            // Ridges with far sides and those with near sides are told apart.
            for ways in [[0, 0], [0, 1], [1, 0]] {
                let Some([up, down]) = all
                    .iter()
                    .filter(|m| m.ways == ways)
                    .map(|m| [m.up, m.down])
                    .reduce(|a, b| if b[0] + b[1] < a[0] + a[1] { b } else { a })
                else {
                    continue;
                };
                for (k, (was, now)) in [(ways[1], (&mut c.up, up)), (ways[0], (&mut c.down, down))] {
                    // Ripples of rough faces change from place to place within a cell: one place does not speak for it.
                    was[k] = if longer && !rough { now } else { was[k].min(now) };
                }
                if self.ways == Ways::Either {
                    (c.up[1], c.down[1]) = (c.up[0], c.down[0]);
                }
            }
        }
    }
}
