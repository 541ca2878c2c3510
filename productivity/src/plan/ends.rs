//! How far passes may run out over the border of a face before the tool, with the lead of the border, goes into the face behind it.
//!
//! Running out only serves what lies beside a pass at the border. Where the face goes on bent the tool could dig in there, and a lead
//! that keeps it out would be greater on the face itself and make its strips narrower. So a pass ends before, as if the face did,
//! and passes are spaced by what the tool reaches until then. This is asked on rows across the passes, for either sense and end, and
//! between two rows a pass ends with the shorter of them.

use super::Task;
use super::extended::Extended;
use super::lead::Clearance;
use super::seat::Seat;
use osculate_geom::line::IsoLine;
use osculate_geom::{Axis, Domain};
use osculate_tools::sweep::{Moving, SweptMotion};
use rayon::prelude::*;

/// Rows across the passes.
const ROWS: usize = 100;
/// Places on the way out at which the tool is looked at, and halvings of the way between the last two.
const LOOKS: u32 = 8;
const HALVINGS: u32 = 6;

/// The least and the greatest parameter of passes, on rows across them.
pub(super) struct Ends {
    pub along: Axis,
    /// The parameters of the face itself.
    pub own: Domain,
    /// Where the continued face ends.
    whole: [f64; 2],
    /// By row, for passes along the parameter and against it; empty where all end with the continued face.
    rows: Vec<[[f64; 2]; 2]>,
}

impl Ends {
    /// Those of the continued face.
    pub fn whole(face: &Extended<'_>, along: Axis) -> Self {
        let i = face.outer().get(along);
        Self { along, own: face.own(), whole: [i.lo, i.hi], rows: Vec::new() }
    }

    /// Those up to which the tool of a task on the continued face keeps out of the face.
    pub fn clear(task: &Task<'_>, face: &Extended<'_>, along: Axis, clearance: &Clearance<'_>) -> Self {
        let all = Self::whole(face, along);
        let own = all.own.get(along);
        let seat = Seat::new(task, along).held_by(all.own);
        let end = |line: &IsoLine<'_>, from: f64, to: f64| -> f64 {
            let clear = |f: f64| {
                let t = from + (to - from) * f;
                let pose = seat.at(line, t).map(|s| s.0);
                pose.is_ok_and(|pose| !clearance.digs_in(face.inner(line.uv(t)), &pose))
            };
            let step = 1.0 / f64::from(LOOKS);
            let Some(bad) = (1..=LOOKS).map(|k| f64::from(k) * step).find(|f| !clear(*f)) else { return to };
            let (mut low, mut high) = (bad - step, bad);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if clear(middle) { low = middle } else { high = middle }
            }
            from + (to - from) * low
        };
        let row = |k: usize| {
            let fixed = all.own.get(along.other()).at(k as f64 / ROWS as f64);
            [false, true].map(|reversed| {
                let line = IsoLine { surface: task.surface, along, fixed, reversed };
                [end(&line, own.lo, all.whole[0]), end(&line, own.hi, all.whole[1])]
            })
        };
        Self { rows: (0..=ROWS).into_par_iter().map(row).collect(), ..all }
    }

    /// The least and the greatest parameter of a pass.
    pub fn of(&self, fixed: f64, reversed: bool) -> [f64; 2] {
        let i = self.own.get(self.along.other());
        let x = ((fixed - i.lo) / i.length() * ROWS as f64).clamp(0.0, ROWS as f64);
        let near = [x.floor(), x.ceil()].map(|x| self.rows.get(x as usize));
        near.iter()
            .flatten()
            .map(|row| row[usize::from(reversed)])
            .reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])])
            .unwrap_or(self.whole)
    }
}

/// A motion between two parameters.
pub(super) struct Ended<M> {
    pub motion: M,
    pub ends: [f64; 2],
}

impl<M: SweptMotion> SweptMotion for Ended<M> {
    fn at(&self, t: f64) -> Option<Moving> {
        (t >= self.ends[0] && t <= self.ends[1]).then(|| self.motion.at(t)).flatten()
    }
}
