//! The verdict by what was found, and whether there is anything to judge.

use super::density::Hidden;
use super::goal::{Goal, Gravity, Program};
use super::job::{Cut, Sample};
use super::refine::{Measured, Refined};
use super::tally::Tally;
use super::tooth::Marks;
use super::trial::{LEAST_SAMPLES, Look, ProveError, Sampled, Trial, unbounded};
use super::verdict::{Figures, StockFound, Verdict};

/// A limit exceeded this many times by the first look ends the work: what lies closer would not turn the answer, and no plan
/// that is laid out anew makes good for it.
const HOPELESS: f64 = 10.0;
/// The share of the area left uncut by the first look that ends the work.
const HOPELESS_UNCUT: f64 = 0.05;
/// A first look is this many times as coarse: it costs a twenty-fifth.
pub(super) const COARSE: f64 = 5.0;

/// What a verdict is made of beside a look.
pub(super) struct Closing {
    /// Nothing was looked at closer.
    pub coarse: bool,
    pub refined: Refined,
    /// Of the area that is not reached that where something too high may hide, mm2.
    pub open_mm2: f64,
    pub stock: Option<StockFound>,
    pub notes: Vec<String>,
}

/// The verdict by a first look and, where that is not far off, another: not between the samples, with what was found of raw material.
pub(super) fn looked_at(
    trial: &Trial<'_>,
    stock: Option<StockFound>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verdict, ProveError> {
    let mut notes = Vec::new();
    let spacing = trial.spacing_mm(&mut notes);
    let none = &mut |_: usize, _: &Sampled, _: &[Cut]| Ok(());
    let mut look = trial.look(COARSE * spacing, &[], (none, &|_| {}))?;
    let coarse = is_hopeless(trial, &look.tally);
    if !coarse {
        look = trial.look(spacing, &[], (none, progress))?;
    }
    let mut marks = trial.marks(&look.measured, usize::MAX)?;
    if !coarse {
        trial.give_up(&mut look, &mut marks, spacing)?;
    }
    let crest_median_mm = trial.crests(&look.measured)?;
    let closing = Closing { coarse, refined: unbounded(), open_mm2: 0.0, stock, notes };
    Ok(concluded(trial, look, (&marks, crest_median_mm), closing))
}

/// The verdict by what was found.
pub(super) fn concluded(
    trial: &Trial<'_>,
    look: Look,
    (marks, crest_median_mm): (&Marks, f64),
    Closing { coarse, refined, open_mm2, stock, mut notes }: Closing,
) -> Verdict {
    let goal = trial.goal;
    let Look { measured, tally, density, lost, .. } = look;
    let Measured { samples, patches, cuts } = measured;
    let bend = patches.iter().flatten().map(|p| p.convex_per_mm.max(p.concave_per_mm)).fold(0.0, f64::max);
    notes.extend(lost);
    let height = |(s, mark): (&Cut, &f64)| {
        if s.standoff_mm > trial.limits.uncut_mm { 0.0 } else { s.standoff_mm.max(0.0) + mark }
    };
    let high = |(s, c): &(&Sample, &Cut)| !s.check_only && c.standoff_mm > trial.limits.scallop_mm;
    let high_area_mm2 = samples.iter().zip(&cuts).filter(high).map(|(s, _)| s.area_mm2).sum();
    let machined =
        samples.iter().zip(&cuts).zip(&marks.each).filter(|((s, c), _)| !s.check_only && c.by.is_some());
    let with_marks = machined.map(|((_, c), m)| height((c, m))).fold(0.0, f64::max);
    let height_max_mm = tally.scallop_max_mm.max(if marks.known { with_marks } else { 0.0 });
    let of_stock = stock.as_ref().map(|s| s.too_fast);
    // What a roughing leaves it may have touched at the feed of the air: there raw material tells, where it is known.
    let by_stock = of_stock.is_some() && goal.roughing_mm.is_some();
    let made = || if by_stock { None } else { trial.made_too_fast(&samples, &cuts) };
    let too_fast = of_stock.flatten().or_else(made);
    let figures = Figures {
        added: refined.added,
        spacing_mm: density.spacing_mm,
        hidden: Hidden { scallop_mm: (refined.hidden.scallop_mm - height_max_mm).max(0.0), ..refined.hidden },
        smallest_radius_mm: (bend > 0.0).then(|| 1.0 / bend),
        open_area_mm2: open_mm2,
        high_area_mm2,
        crest_median_mm,
        mark_max_mm: marks.known.then(|| marks.most_mm()),
        height_max_mm,
        coarse,
        too_fast,
        stock,
        tally,
    };
    let (answer, why) = trial.answer(&figures, refined.left_out);
    let told = goal.control.remarks.iter().filter(|r| r.gravity == Gravity::Told).map(|r| r.text.clone());
    let fast = figures.too_fast.map(|fast| trial.feed_words(Some(fast), figures.stock.is_some()));
    let remarks = told.chain(fast).chain(notes).collect();
    Verdict {
        answer,
        only: trial.only(),
        at_samples: goal.limits.at_samples,
        why,
        remarks,
        scope: trial.scope(&figures),
        leaves_only: trial.leaves_only(&figures),
        figures,
        samples,
        cuts,
    }
}

/// Refuses what cannot be judged.
pub(super) fn check(goal: &Goal<'_>, program: &Program<'_>) -> Result<(), ProveError> {
    let (motions, times) = (program.motions.len(), program.times_min.len());
    if motions == 0 {
        return Err(ProveError::NoMotion);
    }
    if times != 0 && times != motions {
        return Err(ProveError::Times { times, motions });
    }
    let (tools, changes) = (goal.tools.len(), program.changes.len());
    if tools != changes + 1 || program.changes.last().is_some_and(|first| *first > motions) {
        return Err(ProveError::Tools { tools, changes });
    }
    if goal.machined.is_empty() {
        return Err(ProveError::NoFace);
    }
    if goal.looks.max_samples < LEAST_SAMPLES {
        return Err(ProveError::Samples { got: goal.looks.max_samples });
    }
    Ok(())
}

/// Whether a coarse look says that the program cannot hold, by far.
pub(super) fn is_hopeless(trial: &Trial<'_>, t: &Tally) -> bool {
    let area: f64 = t.histogram.iter().map(|b| b.area_mm2).sum();
    let uncut = t.uncut_area_mm2 - trial.goal.limits.unreached_mm2;
    t.gouge_max_mm > HOPELESS * trial.limits.gouge_mm
        || t.rapid_max_mm.max(t.holder_max_mm) > HOPELESS * trial.limits.collision_mm
        || uncut > HOPELESS_UNCUT * area
}
