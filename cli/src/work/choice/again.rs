//! What is laid out again: what left a little too much, for less; what left less than it may, for more; and what the control goes slower
//! along than it may, with less of the tolerance for the marks of teeth, or a coarser chord.

use super::entry::{Entry, State};
use super::search::{Choice, Contender, Holder};
use crate::job::Overrides;
use crate::work::budget::{self, Shares};
use crate::work::look::{Excess, Objection};
use crate::work::verify::Verification;
use osculate_productivity::rate::FeedLimit;
use osculate_productivity::split::best_share;

/// A plan that leaves no more than this many times the scallop, or goes so deep, is laid out again, for so much
/// less and a little more: depth costs hardly any time.
const LITTLE_TOO_MUCH: f64 = 1.8;
const LESS: f64 = 0.97;
const LESS_DEEP: f64 = 0.9;
/// Of the scallop where that may only be hidden between samples, and the second time: bounds come down as there are fewer places to look at, not in
/// proportion. (Tried on a ridge of a torus and a patch of the teapot.)
const LESS_HIDDEN: [f64; 2] = [0.98, 0.85];
/// Where the marks of teeth cap the feed they are made for this many times the mean speed of the control: it goes faster along some of
/// the way. (Tuned on a patch of the teapot by the time on LinuxCNC.) Less than so much of the share that marks had is worth another plan.
const FASTER: f64 = 6.0;
const WORTH: f64 = 0.7;
/// Where feed moves take the control more than this many times what their words ask for, blocks and corners hold it: the chord tolerance
/// is tried this many times as great, and so on while that takes less, up to this share of the scallop. (Tuned on blades of a compressor, an
/// impeller and a propeller, which take 8 to 13 % less of LinuxCNC's time each time; with a gouge limit of half of the scallop none of them was
/// shown to hold the second time.)
const BRAKED: f64 = 1.1;
const COARSER: f64 = 2.0;
const COARSEST: f64 = 1.0;
/// A chord between one that holds and one that digs in is worth a plan where it is this many times the former. (Tried on a compressor blade, which
/// takes 5 % less with such a chord.)
const NEXT_TO: f64 = 1.2;
/// What planning keeps back of scallop and gouge is a guess, and verification says what was left: it is given too, up to so many times what was,
/// where that is more than this. (Chosen so that a plan is hardly ever made for nothing; tried on surfaces 3 and 4 of M86 and four blades.)
const MOST_MORE: f64 = 1.5;
const WORTH_MORE: f64 = 1.03;

impl Choice<'_> {
    /// From here on only what may take less time than this contender, which holds and counts for so much, is looked at.
    pub fn undercut(&mut self, contender: &Contender, found: &Verification, time_min: f64) {
        let (plans, locals, kept) = self.holder.map_or_else(
            || (self.plans, self.locals().count(), self.kept().count()),
            |h| (h.plans, h.locals, h.kept),
        );
        if self.holder.is_none_or(|h| time_min < h.time_min) {
            self.holder = Some(Holder { entry: contender.entry, time_min, plans, locals, kept });
            let shares = self.entries[contender.entry].shares;
            let marks = less_marks(contender);
            for own in marks.into_iter().chain(coarser(contender)).chain(rounder(contender)) {
                self.again_of(contender.entry, contender, own, shares);
            }
            // What marks are left beyond need shows as room for scallops.
            if marks.is_none()
                && let Some(more) = self.more(contender, found)
            {
                self.again_of(contender.entry, contender, contender.job.overrides(), more);
            }
        }
    }

    /// By how much the control may leave the way of a contender at corners, mm.
    pub(super) fn blend_mm(&self, contender: &Contender) -> f64 {
        budget::blend_mm(&contender.job, self.entries[contender.entry].candidate.three_axis().is_none())
    }

    /// The shares of scallop and gouge for a plan that leaves what it may, where one that holds leaves less at its samples.
    fn more(&self, contender: &Contender, found: &Verification) -> Option<Shares> {
        let Contender { entry: k, job, .. } = contender;
        let (entry, limits) = (&self.entries[*k], job.tolerance());
        let blend_mm = self.blend_mm(contender);
        let marks_mm = found.height_max_mm - found.scallop_max_mm;
        let may = |limit_mm: f64, is_mm: f64, less: f64| {
            let more = less * (limit_mm - blend_mm) / is_mm;
            if more > WORTH_MORE { more.min(MOST_MORE) } else { 1.0 }
        };
        let scallop = may(limits.scallop_mm - marks_mm, found.scallop_max_mm, LESS);
        let gouge = if entry.is_local() { may(limits.gouge_mm, found.gouge_max_mm, LESS_DEEP) } else { 1.0 };
        let Shares { scallop: s, gouge: g, .. } = entry.shares;
        (scallop > 1.0 || gouge > 1.0).then_some(Shares { scallop: s * scallop, gouge: g * gouge })
    }

    /// Adds the plan of a contender laid out again, beside another that is; whether there is room for it.
    fn again_of(&mut self, of: usize, contender: &Contender, own: Overrides, shares: Shares) -> bool {
        if self.entries.iter().filter(|e| e.again.is_some() && e.tried).count() >= self.most.again {
            return false;
        }
        let Contender { entry: k, job, .. } = contender;
        let Entry { candidate, screened, .. } = &self.entries[*k];
        let (candidate, mut screened) = (*candidate, screened.clone());
        // Marks that take less leave room for fewer passes, each at a lesser feed.
        let given = job.with(own);
        let wider = ((1.0 - job.mark_share()) / (1.0 - given.mark_share())).sqrt();
        screened.layout_min *= wider * job.feed_mm_min() / given.feed_mm_min();
        self.entries.push(Entry {
            candidate,
            screened,
            state: State::Open,
            figures: None,
            verified: None,
            shares,
            lessened: [0; 2],
            again: Some((of, own)),
            tried: false,
            elsewhere: false,
        });
        true
    }

    /// Adds the plan of a contender that goes a little too deep laid out again along shorter chords; whether it is. Not for leads that are found place by
    /// place along the usual chords, which are found for less depth.
    pub(super) fn finer(&mut self, contender: &Contender, why: &Objection) -> bool {
        let Contender { entry: k, job, .. } = contender;
        let (entry, own) = (&self.entries[*k], job.overrides());
        let usual_mm = job.with(Overrides { chord_mm: None, ..own }).tolerance().chord_mm;
        let least_mm = match entry.again {
            Some((of, _)) if own.chord_mm.is_some() => {
                let held_mm = self.entries[of].again.and_then(|(_, own)| own.chord_mm);
                NEXT_TO * held_mm.unwrap_or(usual_mm)
            }
            _ => 0.0,
        };
        let open = !job.gives_chord() && (own.chord_mm.is_some() || !entry.is_local());
        let Some(less) = why.dug.filter(|_| open).and_then(|d| less_of(d, LESS_DEEP)) else { return false };
        let chord_mm = less * job.tolerance().chord_mm;
        if chord_mm < least_mm {
            return false;
        }
        let (shares, of) = (entry.shares, entry.again.map_or(*k, |(of, _)| of));
        self.again_of(of, contender, Overrides { chord_mm: Some(chord_mm), blend_mm: None, ..own }, shares)
    }

    /// Has a candidate that leaves a little more than the limit, or goes a little deeper with leads that are found for that, laid out
    /// for less; whether it is. Those along coarser chords than usual dig in for these.
    pub(super) fn for_less(&mut self, k: usize, why: &Objection) -> bool {
        let entry = &mut self.entries[k];
        let coarser = entry.again.is_some_and(|(_, own)| own.chord_mm.is_some());
        let dug = why.dug.filter(|_| entry.is_local() && !coarser);
        let mut again = false;
        let shares = [&mut entry.shares.scallop, &mut entry.shares.gouge];
        let aims: &[f64] = if why.hidden { &LESS_HIDDEN } else { &[LESS] };
        let found = [(why.left, aims), (dug, &[LESS_DEEP])];
        for (((found, aims), share), done) in found.into_iter().zip(shares).zip(&mut entry.lessened) {
            let less = found.zip(aims.get(*done)).and_then(|(found, aim)| less_of(found, *aim));
            if let Some(less) = less {
                *share *= less;
                *done += 1;
                again = true;
            }
        }
        again
    }
}

/// For how many times as much what leaves or takes a little too much is laid out again, to come to `aim` of what it may; None for more than that, and
/// less.
pub fn less_of(found: Excess, aim: f64) -> Option<f64> {
    let Excess { is_mm, may_mm } = found;
    (is_mm > may_mm && is_mm <= LITTLE_TOO_MUCH * may_mm).then(|| aim * may_mm / is_mm)
}

/// Where the marks of teeth cap the feed and the control does not reach it: with just as much of the tolerance for marks as its speed
/// needs strips become wider.
fn less_marks(of: &Contender) -> Option<Overrides> {
    let job = &of.job;
    if job.feed_limit() != FeedLimit::ToothMark {
        return None;
    }
    let per_min = job.spindle_rpm()? * f64::from(job.tool().teeth().unwrap_or(1));
    let cap_mm = FASTER * of.planned.linked.cutting_length_mm / (of.posted.read.cutting_min() * per_min);
    // By leading orders: how wide strips are for what is left goes with its root.
    let along = |h_mm: f64| job.feed_per_tooth_mm(h_mm).ok_or(());
    let best = best_share(job.tolerance().scallop_mm, cap_mm, along, |h_mm| Ok(h_mm.sqrt())).ok()?;
    let less = best.capped && best.share.chi < WORTH * job.mark_share();
    less.then(|| Overrides { mark_share: Some(best.share.chi), ..job.overrides() })
}

/// Where blocks and corners hold the control, and the job leaves the chord open: longer blocks and rounder corners.
fn coarser(of: &Contender) -> Option<Overrides> {
    let (job, read) = (&of.job, &of.posted.read);
    let braked = read.cutting_min() > BRAKED * read.cutting_time_min;
    let (chord_mm, most_mm) = (COARSER * job.tolerance().chord_mm, COARSEST * job.tolerance().scallop_mm);
    let open = !job.gives_chord() && chord_mm <= most_mm;
    (braked && open).then(|| Overrides { chord_mm: Some(chord_mm), blend_mm: None, ..job.overrides() })
}

/// Where a coarser chord holds with corners as close as the scallop asks for: as round as the chord allows.
fn rounder(of: &Contender) -> Option<Overrides> {
    let job = &of.job;
    let blend_mm = budget::rounder_mm(job);
    let more = job.overrides().chord_mm.is_some() && blend_mm > WORTH_MORE * budget::asked_mm(job);
    more.then(|| Overrides { blend_mm: Some(blend_mm), ..job.overrides() })
}
