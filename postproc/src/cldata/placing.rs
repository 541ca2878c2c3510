//! Where the points of a text go, and which statements are kept for copies of them; [`super::repeat`] makes these.

use osculate_geom::{Point3, Unit3};

use super::statement::Item;
use super::transform::Transform;

/// What the points that follow are reckoned from.
#[derive(Clone, Debug)]
pub(super) struct Reckoning {
    pub unit_mm: f64,
    pub tracut: Option<Transform>,
    pub axis: Unit3,
    pub tip: Option<Point3>,
}

/// An `INDEX/` that is open.
#[derive(Clone, Debug)]
pub(super) struct Mark {
    pub name: String,
    /// The first statement behind it.
    pub at: usize,
    /// The line of a tool call since then.
    pub tool: Option<usize>,
    pub reckoning: Reckoning,
}

/// Where points go, and what is kept for copies.
#[derive(Clone, Debug, Default)]
pub(super) struct Placing {
    pub tracut: Option<Transform>,
    /// Of the copies in work, from the outermost.
    pub copies: Vec<Transform>,
    /// All together.
    total: Option<Transform>,
    pub marks: Vec<Mark>,
    pub kept: Vec<Item>,
    /// Statements that the copy in work has made.
    pub made: usize,
}

impl Placing {
    /// Where a tip and an axis of the text are.
    pub fn place(&self, tip: Point3, axis: Unit3) -> (Point3, Unit3) {
        self.total.map_or((tip, axis), |t| (t.point(&tip), t.axis(&axis)))
    }

    /// After a change of either.
    pub fn settle(&mut self) {
        let all = self.copies.iter().chain(&self.tracut).copied();
        self.total = all.reduce(|outer, inner| outer.after(&inner));
    }

    /// A tool call: what stands before it is not copied.
    pub fn tool_called(&mut self, line: usize) {
        self.marks.iter_mut().for_each(|m| m.tool = Some(line));
        self.kept.clear();
    }
}
