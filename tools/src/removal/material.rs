//! Declared raw material on the way of a program: what is left of it at the end, and at stops.

use super::feeds::TooFast;
use super::goal::GoalStock;
use super::stock::{Carved, Stock, StockJob, Upper};
use super::trial::{ProveError, Trial};
use super::verdict::StockFound;
use std::sync::Arc;

/// What was found of raw material.
pub(super) struct Material {
    /// From the first motion to the last.
    pub whole: StockFound,
    /// From stop to stop: what the motions before each did to it, and what they left.
    pub at_stops: Vec<StockFound>,
}

impl StockFound {
    /// The same with the collisions that are deeper than this alone.
    pub(super) fn deeper_than(mut self, collision_mm: f64) -> Self {
        self.carved.collisions.retain(|c| c.deepest_mm > collision_mm);
        self
    }
}

impl Trial<'_> {
    /// Moves the tools through the declared raw material. Where a collision begins is the least that any of those says who want to know.
    pub fn carve(
        &self,
        (stops, touch_mm): (&[usize], f64),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<Material>, ProveError> {
        let GoalStock::Declared { blank, resolution, .. } = &self.goal.stock else { return Ok(None) };
        let made = Stock::fill(blank, resolution)?;
        let mut stock = made.stock;
        let found = |stock: Arc<Stock>, before, (carved, too_fast): (Carved, Option<TooFast>)| StockFound {
            cell_mm: stock.cell_mm(),
            coarsened_mm: made.coarsened,
            rays: stock.rays(),
            bounds: *stock.bounds(),
            before,
            left: stock.volume(),
            carved,
            too_fast,
            stock,
        };
        let all = self.program.motions.len();
        let first = stock.volume();
        let (mut whole, mut at_stops) =
            ((Carved::default(), None::<TooFast>), Vec::with_capacity(stops.len()));
        let (mut own, mut before) = ((Carved::default(), None::<TooFast>), first);
        let mut begin = 0;
        let mut waiting = stops.iter().copied().peekable();
        for end in self.program.changes.iter().copied().chain([all]) {
            loop {
                let stop = waiting.next_if(|stop| *stop <= end);
                let until = stop.unwrap_or(end);
                if begin < until {
                    let share = |f: f64| progress((begin as f64 + f * (until - begin) as f64) / all as f64);
                    let carved = self.carve_by_one(&mut stock, (begin, until), touch_mm, &share)?;
                    if let Some(fast) = self.too_fast(&carved, begin, self.limits.collision_mm) {
                        own.1 = Some(fast.with(own.1));
                        whole.1 = Some(fast.with(whole.1));
                    }
                    own.0.follow(carved.clone(), begin);
                    whole.0.follow(carved, begin);
                    begin = until;
                }
                if stop.is_none() {
                    break;
                }
                let here = found(Arc::new(stock.clone()), before, std::mem::take(&mut own));
                before = here.left;
                at_stops.push(here);
            }
        }
        // What is left at the last stop is what is left at the end, where nothing moves after it.
        let left = match at_stops.last() {
            Some(last) if stops.last().is_some_and(|stop| *stop >= all) => Arc::clone(&last.stock),
            _ => Arc::new(stock),
        };
        let whole = found(left, first, whole).deeper_than(self.limits.collision_mm);
        Ok(Some(Material { whole, at_stops }))
    }

    /// Some motions of one tool.
    fn carve_by_one(
        &self,
        stock: &mut Stock,
        (begin, end): (usize, usize),
        touch_mm: f64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Carved, ProveError> {
        let tool = &self.goal.tools[self.program.tool_of(begin)];
        let uppers = Upper::all(tool.flutes, tool.shank, tool.holder);
        let motions = &self.program.motions[begin..end];
        Ok(stock.carve(&StockJob { cutter: tool.flutes, uppers: &uppers, motions, touch_mm }, progress)?)
    }
}
