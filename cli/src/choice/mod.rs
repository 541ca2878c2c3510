//! Which tool, strategy, direction and lead machine a job fastest: many are screened, few planned, fewer posted.
//!
//! Candidates wait in the order of the least time known of them: by strips at places, then by the planned length, then by the
//! posted program. The first is taken a level further, or out when it fails there, until the first one is posted. What screening
//! leaves out is optimistic as a rule (overlaps, links), so that little is missed. Of the leads of one tool and strategy only
//! the best is open at a time. The work is bounded by counts, not by time: the same job gives the same choice everywhere.

mod candidates;
mod settle;
mod table;

pub use settle::settle;
pub use table::{Row, page_table, text_table};

use crate::failure::Failure;
use crate::job::Job;
use crate::look::Look;
use crate::part::{self, JobFaces};
use crate::passes::{self, Way};
use crate::program::{Planned, Posted, WallS};
use crate::report_fill::Extras;
use osculate_geom::Surface;
use osculate_productivity::compare::{Around, Candidate, Screened, Setting, Tool, screen};
use osculate_productivity::ideal::Patch;
use std::path::Path;

/// Candidates that are planned at most.
const MOST_PLANS: usize = 16;

/// How far a candidate has come.
enum State {
    /// Screened.
    Open,
    /// Planned and looked at: the least time that its length needs, min.
    Planned(Box<Planned<'static>>),
    /// Posted: a contender.
    Posted(Box<(Planned<'static>, Posted)>),
    /// Handed out for verification.
    Taken,
    /// Out, with the reason.
    Out(String),
}

/// Figures of a plan, kept after the plan is gone.
#[derive(Clone, Copy)]
struct Figures {
    passes: usize,
    points: usize,
    cutting_length_mm: f64,
    cutting_min: f64,
    posted_min: Option<f64>,
}

/// One candidate's story.
struct Entry {
    candidate: Candidate,
    screened: Screened,
    state: State,
    figures: Option<Figures>,
    verified: Option<table::Measured>,
}

/// A plan that promises the least time of all.
pub struct Contender {
    /// Which entry it is.
    entry: usize,
    /// The job with its tool.
    pub job: Job,
    /// The plan.
    pub planned: Planned<'static>,
    /// Its program.
    pub posted: Posted,
}

/// The candidates of a job.
pub struct Choice<'a> {
    faces: &'a JobFaces,
    /// The job with each of its tools.
    jobs: Vec<Job>,
    entries: Vec<Entry>,
    plans: usize,
    /// For each tool the greatest lead at which it dug in, whatever the strategy, rad.
    dug_in_rad: Vec<f64>,
}

/// Areas of the faces to machine, with the faces.
pub fn patches(faces: &JobFaces) -> Vec<Patch<'_>> {
    faces.faces.iter().map(|f| Patch { surface: &*f.surface, area_mm2: part::area(f) }).collect()
}

impl<'a> Choice<'a> {
    /// Screens all candidates of a job.
    ///
    /// # Errors
    /// Where none is possible, with every reason in one table.
    pub fn screen(job: &Job, faces: &'a JobFaces) -> Result<Self, Failure> {
        let jobs = job.each_tool();
        let cutters = jobs.iter().map(Job::cutter).collect::<Result<Vec<_>, _>>()?;
        let holders = jobs.iter().map(Job::holder).collect::<Result<Vec<_>, _>>()?;
        let mut tools = Vec::with_capacity(jobs.len());
        for (k, one) in jobs.iter().enumerate() {
            tools.push(Tool {
                cutter: &cutters[k],
                holder: holders[k].as_ref(),
                feed_mm_min: one.feed_mm_min()?,
            });
        }
        let all = faces.faces.iter().chain(&faces.check);
        let around = Around::of(all.map(|f| (&*f.surface as &dyn Surface, f.id.as_str())));
        let candidates = candidates::of_job(job, faces, &cutters)?;
        let setting =
            Setting { faces: &patches(faces), tools: &tools, tolerance: job.tolerance()?, around: &around };
        let screened = screen(&setting, &candidates);
        let entries: Vec<Entry> = candidates
            .into_iter()
            .zip(screened)
            .map(|(candidate, screened)| {
                let state = screened.out.as_ref().map_or(State::Open, |r| State::Out(r.to_string()));
                Entry { candidate, screened, state, figures: None, verified: None }
            })
            .collect();
        let dug_in_rad = vec![f64::NEG_INFINITY; jobs.len()];
        let choice = Self { faces, jobs, entries, plans: 0, dug_in_rad };
        choice.any_left(job)?;
        Ok(choice)
    }

    /// An error with all reasons where every candidate is out.
    fn any_left(&self, job: &Job) -> Result<(), Failure> {
        if self.entries.iter().any(|e| !matches!(e.state, State::Out(_))) {
            return Ok(());
        }
        Err(Failure::file(
            &job.path,
            format!("no tool and strategy is possible:\n\n{}", text_table(&self.rows())),
        ))
    }

    /// The least time known of a candidate, min.
    fn least_min(entry: &Entry) -> f64 {
        match entry.figures {
            Some(Figures { posted_min: Some(t), .. }) => t,
            Some(f) => f.cutting_min,
            None => entry.screened.layout_min,
        }
    }

    /// The candidate to go on with: the first of those that are, within tool and strategy, the best not out.
    fn first(&self) -> Option<usize> {
        let waiting = |e: &Entry| matches!(e.state, State::Open | State::Planned(_) | State::Posted(_));
        let group = |e: &Entry| (e.candidate.tool, e.candidate.strategy);
        let mut open: Vec<usize> = Vec::new();
        for (k, e) in self.entries.iter().enumerate().filter(|(_, e)| waiting(e)) {
            // Once one lead is planned it stands for its group until it is out; then those above the leads at which the
            // tool dug in on other lines come first.
            let key = |e: &Entry| {
                let doubtful = e.candidate.lean.lead_rad <= self.dug_in_rad[e.candidate.tool];
                (e.figures.is_none(), doubtful, Self::least_min(e))
            };
            let ahead = |o: usize| key(&self.entries[o]) <= key(e);
            match open.iter().position(|o| group(&self.entries[*o]) == group(e)) {
                Some(p) if ahead(open[p]) => {}
                Some(p) => open[p] = k,
                None => open.push(k),
            }
        }
        let may_plan = self.plans < MOST_PLANS;
        open.retain(|k| may_plan || self.entries[*k].figures.is_some());
        let least = |k: &usize| Self::least_min(&self.entries[*k]);
        open.into_iter().min_by(|a, b| least(a).total_cmp(&least(b)))
    }

    /// The next contender for verification; None where no candidate is left.
    pub fn next(
        &mut self,
        out: Option<&Path>,
        wall_s: &mut WallS,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<Contender>, Failure> {
        while let Some(k) = self.first() {
            progress(self.plans as f64 / MOST_PLANS as f64);
            let state = std::mem::replace(&mut self.entries[k].state, State::Taken);
            let job = &self.jobs[self.entries[k].candidate.tool];
            self.entries[k].state = match state {
                State::Open => {
                    self.plans += 1;
                    self.planned(k)?
                }
                State::Planned(planned) => match Posted::of(job, self.faces, &planned, wall_s, out) {
                    Ok(posted) => {
                        if let Some(f) = &mut self.entries[k].figures {
                            f.posted_min = Some(posted.time_min());
                        }
                        State::Posted(Box::new((*planned, posted)))
                    }
                    Err(e) => State::Out(e.message().to_owned()),
                },
                State::Posted(both) => {
                    let (planned, posted) = *both;
                    return Ok(Some(Contender { entry: k, job: job.clone(), planned, posted }));
                }
                done => done,
            };
        }
        Ok(None)
    }

    /// Plans a candidate and looks at what it leaves.
    fn planned(&mut self, k: usize) -> Result<State, Failure> {
        let Candidate { tool, strategy, lean } = self.entries[k].candidate;
        let job = &self.jobs[tool];
        let way = Way { strategy: &strategy, lean, out: None };
        let passes = match passes::each_face(job, self.faces, &way, &|_| {}) {
            Ok(p) => p,
            Err(e) => {
                let why = e.message().to_owned();
                self.no_smaller_lead(k);
                return Ok(State::Out(why));
            }
        };
        let linked = passes::linked(job, self.faces, &passes, &job.cutter()?)?;
        self.entries[k].figures = Some(Figures {
            passes: passes.passes.len(),
            points: linked.path.moves.len(),
            cutting_length_mm: linked.cutting_length_mm,
            cutting_min: linked.cutting_length_mm / job.feed_mm_min()?,
            posted_min: None,
        });
        if let Some(objection) = Look::at(job, self.faces, &linked)?.objection(job)? {
            if objection.digs_in {
                self.no_smaller_lead(k);
            }
            return Ok(State::Out(objection.text));
        }
        let (strategy, extras) = (strategy.name().to_owned(), Extras::default());
        Ok(State::Planned(Box::new(Planned { passes, linked, strategy, lean, extras, with_strips: true })))
    }

    /// Leaves out the smaller leads of a candidate that digs in: the heel comes down with the lead.
    fn no_smaller_lead(&mut self, k: usize) {
        let Candidate { tool, strategy, lean } = self.entries[k].candidate;
        self.dug_in_rad[tool] = self.dug_in_rad[tool].max(lean.lead_rad);
        for e in &mut self.entries {
            let c = &e.candidate;
            let same = (c.tool, c.strategy, c.lean.tilt_rad) == (tool, strategy, lean.tilt_rad);
            if same && c.lean.lead_rad < lean.lead_rad && matches!(e.state, State::Open) {
                let why = format!("a lead of {:.0} deg does not fit already", lean.lead_rad.to_degrees());
                e.state = State::Out(why);
            }
        }
    }

    /// Records what verification said of a contender; `why` it is out where it does not hold.
    pub fn record(&mut self, contender: &Contender, measured: table::Measured, why: Option<String>) {
        let entry = &mut self.entries[contender.entry];
        entry.verified = Some(measured);
        if let Some(why) = why {
            entry.state = State::Out(why);
        }
    }

    /// The candidates for tables, fastest first, of each tool and strategy the lead that came furthest.
    pub fn rows(&self) -> Vec<Row> {
        table::rows(self)
    }

    /// What was done, in words.
    pub fn story(&self) -> String {
        let count = |is: &dyn Fn(&Entry) -> bool| self.entries.iter().filter(|e| is(e)).count();
        format!(
            "{} candidates screened, {} planned, {} posted, {} verified",
            self.entries.len(),
            self.plans,
            count(&|e| e.figures.is_some_and(|f| f.posted_min.is_some())),
            count(&|e| e.verified.is_some())
        )
    }
}
