//! Reaches put right where passes meet.
//!
//! The reach at the middle of a cell is asked of passes that would come to lie just as far away as they cover it, and the least
//! of neighbouring cells is counted on. Once levels are taken it is known which two passes meet near a cell: the tool of each
//! is asked what it leaves at that ridge, and since standoffs grow with the square of the distance the levels can then be taken
//! so that the ridges stand at the design height, no lower.

use super::cells::{Cells, place};
use super::reach::met;
use crate::plan::PlanError;
use crate::plan::seat::Seat;
use rayon::prelude::*;

/// Rounds of levels and ridges: reaches change by the square of what levels are moved. In the last they only get shorter.
const ROUNDS: u32 = 3;
/// Places of a cell from which ridges are looked for, in its sides: of half of them in turn, of all in the last round.
const PLACES: [[f64; 2]; 4] = [[0.2, 0.3], [0.8, 0.7], [0.3, 0.8], [0.7, 0.2]];

impl Cells<'_> {
    /// The levels of passes that meet at the design height.
    pub fn met_levels(&mut self, seat: &Seat<'_>) -> Result<Vec<f64>, PlanError> {
        let mut levels = self.levels(seat)?;
        for round in 1..=ROUNDS {
            let places = match round {
                ROUNDS => &PLACES[..],
                odd if odd % 2 == 1 => &PLACES[..2],
                _ => &PLACES[2..],
            };
            self.measure(seat, &levels, places, round < ROUNDS && !seat.rough());
            levels = self.levels(seat)?;
        }
        Ok(levels)
    }

    /// Measures reaches at the ridges between levels, seen from places of the cells; those of cells at which no two passes meet
    /// stay, and longer ones are taken only where that is asked for.
    fn measure(&mut self, seat: &Seat<'_>, levels: &[f64], places: &[[f64; 2]], longer: bool) {
        let n = self.count;
        let found: Vec<Option<[f64; 2]>> = (0..self.cells.len())
            .into_par_iter()
            .map(|k| {
                let c = &self.cells[k];
                let share = c.down / (c.up + c.down);
                let ridge = |[f, g]: [f64; 2]| {
                    let at = place(&self.face, n, (k / n[1]) as f64 + f, (k % n[1]) as f64 + g);
                    let (.., phi) = self.face.at(at)?;
                    let above = levels.partition_point(|l| *l <= phi.value);
                    let between = [*levels.get(above.checked_sub(1)?)?, *levels.get(above)?];
                    met(seat, self.face, at, between, share)
                };
                let whole = c.inside() && !c.at_extreme();
                let all = places.iter().filter(|_| whole).filter_map(|p| ridge(*p));
                all.reduce(|a, b| if b[0] + b[1] < a[0] + a[1] { b } else { a })
            })
            .collect();
        for (c, f) in self.cells.iter_mut().zip(found) {
            // Ripples of rough faces change from place to place within a cell: one place does not speak for it.
            match f {
                Some([up, down]) if longer => (c.up, c.down) = (up, down),
                Some([up, down]) => (c.up, c.down) = (c.up.min(up), c.down.min(down)),
                None => {}
            }
        }
    }
}
