//! A candidate laid out: its passes, what is left out of them, its path, and a look at what that leaves.

use super::entry::{Entry, Figures, Left, State};
use super::search::{Choice, Contender};
use crate::failure::Failure;
use crate::job::{Job, Overrides};
use crate::part;
use crate::work::drop;
use crate::work::left_out::{self, Joined};
use crate::work::look::{Look, accepted_mm2};
use crate::work::passes::{self, Way};
use crate::work::plunges;
use crate::work::program::Planned;
use osculate_productivity::compare::{Axes, Candidate};
use osculate_productivity::plan::Strategy;
use osculate_tools::removal::stock::Stock;

/// Leads below this many times one at which the tool dug in are left out.
const STEEPER: f64 = 1.3;

impl Choice<'_> {
    /// Whether what a tool does not reach without harm is left to other operations.
    pub(super) fn leaves_out(&self) -> bool {
        left_out::is_wanted(&self.jobs[0])
    }

    /// What is left of the faces where so much is.
    fn left(&self, area_mm2: f64) -> Left {
        let area_mm2 = if self.leaves_out() { area_mm2 } else { 0.0 };
        let of_mm2 = self.faces.faces.iter().map(part::area).sum();
        Left { area_mm2, of_mm2, min_per_mm2: self.others_min_per_mm2 }
    }

    /// The job that a contender is judged by: what its passes leave to other operations is accepted.
    pub(super) fn judged(&self, contender: &Contender) -> Job {
        let (job, figures) = (&contender.job, &self.entries[contender.entry].figures);
        let others_mm2 = figures.map_or(0.0, |f| f.left.area_mm2);
        let unreached_mm2 = Some(accepted_mm2(job, self.faces, others_mm2));
        job.with(Overrides { unreached_mm2, ..job.overrides() })
    }

    /// What a contender counts for, min, of which so much area stands too high.
    pub(super) fn counted_min(&mut self, contender: &Contender, high_mm2: f64) -> f64 {
        let left = self.left(high_mm2);
        if let Some(f) = &mut self.entries[contender.entry].figures {
            f.left = left;
        }
        left.counted(contender.posted.time_min())
    }

    /// Plans a candidate and looks at what it leaves.
    pub(super) fn planned(&mut self, k: usize) -> Result<State, Failure> {
        self.plans += 1;
        let Entry { candidate: Candidate { tool, strategy, lean, axes }, shares, .. } = self.entries[k];
        let job = &self.job_of(k);
        let fields = &self.fields[tool];
        let way = Way { strategy: &strategy, lean, axes, fields, shares, watch: &() };
        let laid = match &strategy {
            // Over all faces together.
            Strategy::ThreeAxis(kept) => drop::passes(job, self.faces, kept.lines, shares, &|_| {}),
            _ => passes::each_face(job, self.faces, &way, &|_| {}),
        };
        let passes = match laid {
            Ok(p) => p,
            Err(e) => {
                let why = e.message().to_owned();
                self.no_smaller_lead(k);
                return Ok(State::Out(why));
            }
        };
        let Joined { passes, skipped, mut linked, extras } =
            left_out::linked(job, self.faces, (passes, Vec::new()))?;
        let look = Look::at(job, self.faces, &linked)?;
        let left = self.left(look.uncut_mm2);
        self.entries[k].figures = Some(Figures {
            passes: passes.passes.len(),
            points: linked.path.moves.len(),
            cutting_length_mm: linked.cutting_length_mm,
            cutting_min: linked.cutting_length_mm / job.feed_mm_min(),
            posted_min: None,
            left,
        });
        if let Some(objection) = look.objection(job, left.area_mm2)? {
            if objection.dug.is_some() {
                self.no_smaller_lead(k);
            }
            if self.for_less(k, &objection) {
                return self.planned(k);
            }
            return Ok(State::Out(objection.text));
        }
        if let Some(left) = &self.faces.left {
            plunges::slow(&mut Stock::clone(&left.stock), job, job.tolerance().gouge_mm, &mut linked)?;
        }
        Ok(State::Planned(Box::new(Planned {
            passes,
            skipped,
            linked,
            strategy: strategy.name().to_owned(),
            lean,
            axes,
            extras,
            with_strips: true,
        })))
    }

    /// Leaves out the smaller leads of a candidate that digs in: the heel comes down with the lead.
    fn no_smaller_lead(&mut self, k: usize) {
        let Candidate { tool, strategy, lean, axes } = self.entries[k].candidate;
        if axes != Axes::Held {
            return;
        }
        self.dug_in_rad[tool] = self.dug_in_rad[tool].max(lean.lead_rad);
        for e in &mut self.entries {
            let c = &e.candidate;
            let same = (c.tool, c.strategy, c.lean.tilt_rad) == (tool, strategy, lean.tilt_rad);
            let near = c.lean.lead_rad < STEEPER * lean.lead_rad;
            if same && near && c.axes == Axes::Held && matches!(e.state, State::Open) {
                let why = format!("a lead of {:.0} deg does not fit already", lean.lead_rad.to_degrees());
                e.state = State::Out(why);
            }
        }
    }
}
