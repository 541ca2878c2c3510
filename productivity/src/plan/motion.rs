//! The exact motion of the tool along a line of a pass, its lead as the task has it there.

use super::line::PassLine;
use super::seat::Seat;
use osculate_tools::sweep::{Moving, SweptMotion};

/// A tool on a line of contact points, not seated.
pub(super) struct PassMotion<'a> {
    pub seat: &'a Seat<'a>,
    pub line: &'a dyn PassLine,
}

impl SweptMotion for PassMotion<'_> {
    fn at(&self, t: f64) -> Option<Moving> {
        self.seat.moving(self.line, t).ok()
    }
}
