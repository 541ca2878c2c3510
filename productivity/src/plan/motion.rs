//! The exact motion of the tool along a line of a pass, its lead as the task has it there.

use super::Task;
use super::line::PassLine;
use osculate_geom::line::SurfaceLine;
use osculate_tools::sweep::{Moving, SweptMotion};

/// A tool on a line of contact points, held against the frame of `led`, which is that of the line or its average.
pub(super) struct PassMotion<'a> {
    pub task: &'a Task<'a>,
    pub line: &'a dyn PassLine,
    pub led: &'a dyn SurfaceLine,
}

impl SweptMotion for PassMotion<'_> {
    fn at(&self, t: f64) -> Option<Moving> {
        let (frame, speed) = self.led.frame(t).ok()?;
        Some(self.task.lean.moving(self.task.cutter, self.line, t, (&frame, speed)))
    }
}
