//! The candidates of a job in the order of the least time known of them, and what takes the first of them a level further.

use super::candidates;
use super::effort::Most;
use super::entry::{self, Entry, State};
use super::measured::Measured;
use super::table::{self, Row, text_table};
use crate::failure::Failure;
use crate::job::{Job, Overrides};
use crate::part::{self, Part};
use crate::watch::Watch;
use crate::work::axes::{self, Fields};
use crate::work::budget::Shares;
use crate::work::look::Objection;
use crate::work::program::{Planned, Posted, WallS};
use osculate_geom::Surface;
use osculate_productivity::compare::{Around, Axes, Setting, Tool, screen};
use osculate_productivity::ideal::Patch;
use osculate_productivity::plan::Strategy;

/// Tilts are held too where they were found place by place and that took no more than this many times the least time: axes that turn
/// less may be quicker than wider strips.
const NEAR: f64 = 1.25;
/// By how much of its time a candidate is put back for each plan of its tool and strategy that failed.
const SET_BACK: f64 = 0.3;
/// A plan that promises the least time of all.
pub struct Contender {
    /// Which entry it is.
    pub(super) entry: usize,
    /// The job with its tool.
    pub job: Job,
    /// The plan.
    pub planned: Planned<'static>,
    /// Its program.
    pub posted: Posted,
}

/// The plan that holds and is to be undercut.
#[derive(Clone, Copy)]
pub(super) struct Holder {
    pub entry: usize,
    /// Its time, min.
    pub time_min: f64,
    /// Plans that were made before, and those of them with leads found place by place, and of tools that keep their axis.
    pub plans: usize,
    pub locals: usize,
    pub kept: usize,
}

/// The candidates of a job.
pub struct Choice<'a> {
    /// Its faces.
    pub(super) faces: &'a Part,
    /// The job with each of its tools.
    pub(super) jobs: Vec<Job>,
    pub(super) entries: Vec<Entry>,
    pub(super) plans: usize,
    /// How much is tried.
    pub(super) most: Most,
    /// For each tool the greatest lead at which it dug in, whatever the strategy, rad.
    pub(super) dug_in_rad: Vec<f64>,
    /// For each tool its fields of axes over the faces.
    pub(super) fields: Vec<Fields>,
    pub(super) holder: Option<Holder>,
    /// What a mm2 that is left to other operations counts for, min.
    pub(super) others_min_per_mm2: f64,
}

/// Areas of the faces to machine, with the faces.
pub fn patches(faces: &Part) -> Vec<Patch<'_>> {
    faces.faces.iter().map(|f| Patch { surface: &*f.surface, area_mm2: part::area(f) }).collect()
}

/// What a tool is taken to leave to one of another operation: a ball of this share of its radius, on three axes.
const SMALLER: f64 = 0.25;

/// How long that needs for a mm2 of a plane, min.
fn others_min_per_mm2(job: &Job) -> f64 {
    let (r, h) = (SMALLER * job.cutter().radius_mm(), job.tolerance().scallop_mm);
    let width_mm = 2.0 * (h * (2.0 * r - h)).max(h * r).sqrt();
    1.0 / (width_mm * job.feed_mm_min())
}

const fn keeps_lines(strategy: &Strategy) -> bool {
    matches!(strategy, Strategy::Isoparametric { .. } | Strategy::Regions { .. } | Strategy::Curvature5c)
}

impl<'a> Choice<'a> {
    /// Screens all candidates of a job.
    ///
    /// # Errors
    /// Where none is possible, with every reason in one table.
    pub fn screen(job: &Job, faces: &'a Part) -> Result<Self, Failure> {
        let jobs = job.each_tool();
        let cutters = jobs.iter().map(Job::cutter).collect::<Vec<_>>();
        let holders = jobs.iter().map(Job::holder).collect::<Vec<_>>();
        let mut tools = Vec::with_capacity(jobs.len());
        for (k, one) in jobs.iter().enumerate() {
            tools.push(Tool { cutter: &cutters[k], holder: holders[k], feed_mm_min: one.feed_mm_min() });
        }
        let all = faces.faces.iter().chain(&faces.check);
        let around = Around::of(all.map(|f| (&*f.surface as &dyn Surface, f.id.as_str())));
        let candidates = candidates::of_job(job, faces, &cutters)?;
        let line = axes::line(job, faces);
        let setting = Setting {
            faces: &patches(faces),
            tools: &tools,
            tolerance: job.tolerance(),
            around: &around,
            line: line.as_deref(),
        };
        let screened = screen(&setting, &candidates);
        let entries: Vec<Entry> = candidates
            .into_iter()
            .zip(screened)
            .map(|(candidate, screened)| {
                let state = screened.out.as_ref().map_or(State::Open, |r| State::Out(r.to_string()));
                Entry {
                    candidate,
                    screened,
                    state,
                    figures: None,
                    verified: None,
                    shares: Shares::WHOLE,
                    lessened: [0; 2],
                    again: None,
                    tried: false,
                    elsewhere: false,
                }
            })
            .collect();
        let dug_in_rad = vec![f64::NEG_INFINITY; jobs.len()];
        let fields = jobs.iter().map(|_| Fields::default()).collect();
        let most = Most::of(job.strategy().effort);
        let others_min_per_mm2 = jobs.iter().map(others_min_per_mm2).fold(f64::INFINITY, f64::min);
        let choice = Self {
            faces,
            jobs,
            entries,
            plans: 0,
            most,
            dug_in_rad,
            fields,
            holder: None,
            others_min_per_mm2,
        };
        choice.any_left(job)?;
        Ok(choice)
    }

    /// An error with all reasons where every candidate is out.
    fn any_left(&self, job: &Job) -> Result<(), Failure> {
        if self.entries.iter().any(|e| !matches!(e.state, State::Out(_))) {
            return Ok(());
        }
        Err(Failure::file(
            job.path(),
            format!("no tool and strategy is possible:\n\n{}", text_table(&self.rows())),
        ))
    }

    /// Plans of the tool and strategy of an entry that failed.
    fn failures(&self, entry: &Entry) -> usize {
        let group = |e: &Entry| (e.candidate.tool, e.candidate.strategy, e.is_field());
        let failed = |e: &&Entry| matches!(e.state, State::Out(_)) && e.tried;
        self.entries.iter().filter(failed).filter(|e| group(e) == group(entry)).count()
    }

    /// The candidate to go on with: the first of those that are, within tool and strategy, the best not out.
    fn first(&self) -> Option<usize> {
        if let Some(holder) = &self.holder {
            return self.first_around(holder);
        }
        // Where places may be left out other axes do as well.
        let leaves_out = self.leaves_out();
        if let Some(field) = self.first_field().filter(|_| !leaves_out) {
            return Some(field);
        }
        let holds = self.entries.iter().any(|e| e.verified.is_some_and(|v| v.within_tolerance));
        let more = self.plans < self.most.plans;
        let in_need = !more && !holds && self.plans < self.most.in_need;
        // Leads found place by place wait for a plan that holds, where one is held elsewhere.
        let only_local = self.entries.iter().all(|e| e.candidate.axes != Axes::Held);
        let waiting = |e: &Entry| {
            (leaves_out || !e.is_field())
                && Self::waiting(e)
                && (!e.is_local() || in_need || only_local || e.figures.is_some())
        };
        let group = |e: &Entry| (e.candidate.tool, e.candidate.strategy, e.is_field());
        let mut open: Vec<usize> = Vec::new();
        for (k, e) in self.entries.iter().enumerate().filter(|(_, e)| waiting(e)) {
            // Once one lead is planned it stands for its group until it is out; then those above the leads at which the
            // tool dug in on other lines come first.
            let key = |e: &Entry| {
                let doubtful =
                    !e.is_local() && e.candidate.lean.lead_rad <= self.dug_in_rad[e.candidate.tool];
                (e.figures.is_none(), doubtful, e.least_min())
            };
            let ahead = |o: usize| key(&self.entries[o]) <= key(e);
            match open.iter().position(|o| group(&self.entries[*o]) == group(e)) {
                Some(p) if ahead(open[p]) => {}
                Some(p) => open[p] = k,
                None => open.push(k),
            }
        }
        open.retain(|k| more || in_need || self.entries[*k].figures.is_some());
        let order = |k: &usize| {
            let e = &self.entries[*k];
            let failed = if e.figures.is_some() { 0 } else { self.failures(e) };
            let put_back = e.least_min() * (1.0 + SET_BACK * failed as f64);
            // In need what is planned is settled before more is planned, of which leads found place by place come first.
            let later = in_need && e.figures.is_none();
            ((later, later && !e.is_local(), if in_need { failed } else { 0 }), put_back)
        };
        open.into_iter().min_by(|a, b| {
            let (a, b) = (order(a), order(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        })
    }

    /// Whether tools that do not keep their axis have it from a field alone.
    fn only_fields(&self) -> bool {
        self.entries.iter().all(|e| e.is_field() || e.candidate.strategy.fixed_axis().is_some())
    }

    /// Plans with fields of axes that were tried.
    fn fields_made(&self) -> usize {
        self.entries.iter().filter(|e| e.is_field() && e.tried).count()
    }

    /// The field to go on with while nothing holds: a few are planned, of which the quickest is verified, then the next.
    fn first_field(&self) -> Option<usize> {
        let least =
            |(_, a): &(usize, &Entry), (_, b): &(usize, &Entry)| a.least_min().total_cmp(&b.least_min());
        let fields = || self.entries.iter().enumerate().filter(|(_, e)| e.is_field() && Self::waiting(e));
        let planned = fields().filter(|(_, e)| e.figures.is_some() || e.tried).min_by(least);
        let quicker = |e: &Entry| planned.is_none_or(|(_, p)| e.least_min() < p.least_min());
        let most = if self.only_fields() { self.most.plans } else { self.most.fields };
        let more = self.fields_made() < most;
        let open = fields().filter(|(_, e)| more && !e.tried && quicker(e)).min_by(least);
        open.or(planned).map(|(k, _)| k)
    }

    /// The rank of leads found place by place with another tool than the one that holds: along the lines on which that tool was the
    /// quickest so far that is not out, if it was planned along any that keep theirs, then along those on which it was not planned yet; None for
    /// others.
    fn with_another(&self, entry: &Entry) -> Option<(usize, f64, f64)> {
        let c = &entry.candidate;
        let planned: Vec<&Entry> =
            self.entries.iter().filter(|e| e.candidate.tool == c.tool && e.tried).collect();
        if planned.iter().filter(|e| e.is_local()).count() >= self.most.of_another {
            return None;
        }
        let quickest = planned
            .iter()
            .filter(|e| e.figures.is_some() && Self::waiting(e) && keeps_lines(&e.candidate.strategy))
            .min_by(|a, b| a.least_min().total_cmp(&b.least_min()));
        if let Some(quickest) = quickest.filter(|q| q.candidate.strategy == c.strategy) {
            return Some((5, 0.0, quickest.least_min()));
        }
        let new = planned.iter().all(|e| e.candidate.strategy != c.strategy);
        new.then_some((6, 0.0, entry.least_min()))
    }

    /// Plans with leads found place by place that were tried.
    pub(super) fn locals(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(|e| e.is_local() && e.tried && e.again.is_none())
    }

    /// Plans of tools that keep their axis that were tried.
    pub(super) fn kept(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(|e| e.candidate.three_axis().is_some() && e.tried && e.again.is_none())
    }

    const fn waiting(entry: &Entry) -> bool {
        matches!(entry.state, State::Open | State::Planned(_) | State::Posted(_))
    }

    /// The candidate to go on with that may take less time than one that holds: first what is planned already or to be laid out
    /// for less, whatever its tool; then with the tool that holds leads found place by place, along parameter lines and lines of
    /// curvature first, as these keep their lines whatever the lead; then of its strategy the nearest leads; then other
    /// strategies, each with its nearest lead and the quickest first; then leads found place by place with other tools; then tools that
    /// keep their axis.
    fn first_around(&self, holder: &Holder) -> Option<usize> {
        let held = self.entries[holder.entry].candidate;
        let twin = |e: &Entry| self.entries.iter().find(|of| e.is_held_twin(of));
        let twins = self.locals().filter(|e| twin(e).is_some()).count();
        let own = |e: &&Entry| e.candidate.tool == held.tool && twin(e).is_none();
        let made_local = self.locals().filter(own).count();
        let again = self.entries.iter().filter(|e| e.again.is_some() && e.tried).count();
        let others = self.locals().count() - holder.locals + again;
        let kept = self.kept().count() - holder.kept;
        let made = (self.plans - holder.plans).saturating_sub(others + kept);
        let elsewhere = self.entries.iter().filter(|e| e.elsewhere && !e.is_field()).count();
        let holds = |e: &Entry| e.verified.is_some_and(|v| v.within_tolerance);
        let by_field = !self.leaves_out() && self.entries.iter().any(|e| e.is_field() && holds(e));
        let fields = self.fields_made();
        let most_alone = if self.only_fields() { self.most.plans } else { 0 };
        let order = |e: &Entry| {
            let c = &e.candidate;
            if !Self::waiting(e) || e.least_min() >= holder.time_min {
                return None;
            }
            // What is open and was tried left a little too much, and is laid out for less.
            if e.figures.is_some() || e.tried {
                return Some((0, 0.0, e.least_min()));
            }
            // After all others, of the one that holds then, and last of those that did.
            if let Some((of, _)) = e.again {
                let rank = if of == holder.entry { 8 } else { 9 };
                return (again < self.most.again).then(|| (rank, 0.0, e.least_min()));
            }
            if c.three_axis().is_some() {
                let failed =
                    self.kept().filter(|k| k.candidate.tool == c.tool && matches!(k.state, State::Out(_)));
                return (kept < self.most.kept).then(|| (7, failed.count() as f64, e.least_min()));
            }
            if e.is_field() {
                return (fields < self.most.fields_around.max(most_alone)).then(|| (1, 0.0, e.least_min()));
            }
            if let Some(twin) = twin(e) {
                let near = twin.figures.is_some() && twin.least_min() < NEAR * holder.time_min;
                return (near && twins < self.most.held_twins).then(|| (2, 0.0, twin.least_min()));
            }
            if c.tool != held.tool {
                let most = if by_field { self.most.elsewhere_beside_field } else { self.most.elsewhere };
                let wanted = e.is_local() && keeps_lines(&c.strategy) && elsewhere < most;
                return wanted.then(|| self.with_another(e)).flatten();
            }
            let beside = c.strategy == held.strategy;
            let (made, most) = match (e.is_local(), beside) {
                (true, _) if by_field && matches!(c.strategy, Strategy::Curvature5c) => return None,
                (true, _) => {
                    (made_local, if by_field { self.most.local_beside_field } else { self.most.local })
                }
                (false, _) if by_field => return None,
                (false, true) => (made, self.most.beside),
                (false, false) => (made, self.most.beside + self.most.others),
            };
            let kind = match e.is_local() {
                false => 3 + usize::from(!beside),
                true => 2 - usize::from(keeps_lines(&c.strategy)),
            };
            let away =
                (c.lean.lead_rad - held.lean.lead_rad).abs() + (c.lean.tilt_rad - held.lean.tilt_rad).abs();
            let away = if e.is_local() { 0.0 } else { away };
            (made < most).then_some((kind, away, e.least_min()))
        };
        let ranked = self.entries.iter().enumerate().filter_map(|(k, e)| order(e).map(|o| (o, k)));
        ranked
            .min_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)))
            .map(|(_, k)| k)
    }

    /// The next contender for verification; None where no candidate is left.
    pub fn next(
        &mut self,
        watch: &dyn Watch,
        wall_s: &mut WallS,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<Contender>, Failure> {
        while let Some(k) = self.first() {
            progress((self.plans as f64 / self.most.plans as f64).min(1.0));
            let state = std::mem::replace(&mut self.entries[k].state, State::Taken);
            let job = self.job_of(k);
            self.entries[k].state = match state {
                State::Open => {
                    let held = self.holder.map(|h| self.entries[h.entry].candidate.tool);
                    let entry = &mut self.entries[k];
                    entry.tried = true;
                    entry.elsewhere = held.is_some_and(|tool| tool != entry.candidate.tool);
                    // One that fails is a loser with a reason.
                    self.planned(k).unwrap_or_else(|e| State::Out(e.message().to_owned()))
                }
                State::Planned(planned) => match Posted::of(&job, self.faces, &planned, wall_s, watch) {
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
                    return Ok(Some(Contender { entry: k, job, planned, posted }));
                }
                done => done,
            };
        }
        Ok(None)
    }

    /// The job of an entry: with its tool, and what it is given.
    pub(super) fn job_of(&self, k: usize) -> Job {
        let Entry { candidate, again, .. } = &self.entries[k];
        let job = &self.jobs[candidate.tool];
        let three_axis = candidate.three_axis().copied();
        job.with(again.map_or(Overrides { three_axis, ..Overrides::default() }, |(_, own)| own))
    }

    /// Records that a contender could not be verified.
    pub fn lost(&mut self, contender: &Contender, why: &Failure) {
        self.entries[contender.entry].state = State::Out(why.message().to_owned());
    }

    /// Records what verification said of a contender; `why` it is out where it does not hold. Whether it is laid out anew, for less.
    pub fn record(&mut self, contender: &Contender, measured: Measured, why: Option<Objection>) -> bool {
        let k = contender.entry;
        self.entries[k].verified = Some(measured);
        let Some(objection) = why else { return false };
        let again = self.for_less(k, &objection);
        let finer = !again && self.finer(contender, &objection);
        self.entries[k].state = State::Out(objection.text);
        if again {
            self.entries[k].state = State::Open;
            self.entries[k].figures = None;
        }
        again || finer
    }

    /// The candidates for tables, fastest first, of each tool and strategy the lead that came furthest.
    pub fn rows(&self) -> Vec<Row> {
        table::rows(&self.entries, &self.jobs)
    }

    /// What was done, in words.
    pub fn story(&self) -> String {
        let count = |is: &dyn Fn(&Entry) -> bool| self.entries.iter().filter(|e| is(e)).count();
        let story = format!(
            "{} candidates screened, {} planned, {} posted, {} verified",
            self.entries.len(),
            self.plans,
            count(&|e| e.figures.is_some_and(|f| f.posted_min.is_some())),
            count(&|e| e.verified.is_some())
        );
        let again = self.holder.map(|h| &self.entries[h.entry]).and_then(|e| Some((e.again?.1, e.shares)));
        story + &again.map_or_else(String::new, |(own, shares)| entry::words(own, shares))
    }
}
