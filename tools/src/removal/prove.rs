//! The only place where a verdict is made.
//!
//! Faces are looked at evenly, coarsely first: a program that is far off is told so at a fraction of the cost of a right one.
//! Then follow tooth marks, bounds on what hides between samples with more samples where these are not near enough, and the
//! declared raw material. What the limits are compared with is always measured or bounded; what is not looked at stands in the
//! scope.

use super::density::Hidden;
use super::goal::{Goal, Gravity, Program};
use super::job::Cut;
use super::refine::Measured;
use super::tally::Tally;
use super::trial::{LEAST_SAMPLES, Look, ProveError, Trial, changes_of, unbounded};
use super::verdict::{Figures, StockFound, Verdict};

/// A limit exceeded this many times by the first look ends the work: what lies closer would not turn the answer, and no plan
/// that is laid out anew makes good for it.
const HOPELESS: f64 = 10.0;
/// The share of the area left uncut by the first look that ends the work.
const HOPELESS_UNCUT: f64 = 0.05;
/// Rounds in which places between samples that stand too high are counted into an area that is accepted.
const GIVEN_UP: u32 = 3;
/// A first look is this many times as coarse: it costs a twenty-fifth.
const COARSE: f64 = 5.0;
/// Shares of the work, for its progress.
const SHARES: [f64; 3] = [0.05, 0.65, 0.85];

/// Judges a program against a goal.
///
/// `progress` gets the fraction done. The verdict does not depend on the number of threads.
///
/// # Errors
/// [`ProveError`] where there is nothing to judge or it cannot be judged.
pub fn prove(
    goal: &Goal<'_>,
    program: Program<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verdict, ProveError> {
    check(goal, &program)?;
    let changed = changes_of(goal, &program);
    let trial = Trial::new(goal, program, &changed);
    let mut notes = Vec::new();
    let spacing = trial.spacing_mm(&mut notes);
    let mut look = trial.look(COARSE * spacing, &|f| progress(SHARES[0] * f))?;
    let coarse = is_hopeless(&trial, &look.tally);
    if !coarse {
        let rest = SHARES[1] - SHARES[0];
        look = trial.look(spacing, &|f| progress(SHARES[0] + rest * f))?;
        trial.give_up(&mut look, spacing)?;
    }
    let mut marks = trial.marks(&look.measured.samples, &look.measured.cuts);
    let crest_median_mm = trial.crests(&look.measured)?;
    let bounds = goal.looks.between && !coarse;
    let mut refined = if bounds { trial.refine(&mut look, &mut marks)? } else { unbounded() };
    // Samples that were added may stand too high where an area that does is accepted.
    for _ in 0..GIVEN_UP {
        if !bounds || !trial.is_to_give_up(&look) {
            break;
        }
        trial.give_up(&mut look, spacing)?;
        refined = trial.refine(&mut look, &mut marks)?;
    }
    progress(SHARES[2]);
    let stock = if coarse { None } else { trial.carve(&|f| progress(SHARES[2] + (1.0 - SHARES[2]) * f))? };
    progress(1.0);
    let Look { measured, tally, density, lost } = look;
    let Measured { samples, patches, cuts } = measured;
    let bend = patches.iter().flatten().map(|p| p.convex_per_mm.max(p.concave_per_mm)).fold(0.0, f64::max);
    notes.extend(lost);
    let height = |(s, mark): (&Cut, &f64)| {
        if s.standoff_mm > trial.limits.uncut_mm { 0.0 } else { s.standoff_mm.max(0.0) + mark }
    };
    let machined =
        samples.iter().zip(&cuts).zip(&marks.each).filter(|((s, c), _)| !s.check_only && c.by.is_some());
    let with_marks = machined.map(|((_, c), m)| height((c, m))).fold(0.0, f64::max);
    let height_max_mm = tally.scallop_max_mm.max(if marks.known { with_marks } else { 0.0 });
    let figures = Figures {
        added: refined.added,
        spacing_mm: density.spacing_mm,
        hidden: Hidden { scallop_mm: (refined.hidden.scallop_mm - height_max_mm).max(0.0), ..refined.hidden },
        smallest_radius_mm: (bend > 0.0).then(|| 1.0 / bend),
        crest_median_mm,
        mark_max_mm: marks.known.then(|| marks.most_mm()),
        height_max_mm,
        coarse,
        stock,
        tally,
    };
    let (answer, why) = trial.answer(&figures, refined.left_out);
    let told = goal.control.remarks.iter().filter(|r| r.gravity == Gravity::Told).map(|r| r.text.clone());
    let remarks = told.chain(notes).collect();
    Ok(Verdict {
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
    })
}

/// Moves the tools through the declared raw material, whatever else may hold: what is left of it is where the next operation begins. None
/// where none is declared.
///
/// # Errors
/// As [`prove`].
pub fn carve(
    goal: &Goal<'_>,
    program: Program<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Option<StockFound>, ProveError> {
    check(goal, &program)?;
    let changed = changes_of(goal, &program);
    Trial::new(goal, program, &changed).carve(progress)
}

/// Refuses what cannot be judged.
fn check(goal: &Goal<'_>, program: &Program<'_>) -> Result<(), ProveError> {
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
fn is_hopeless(trial: &Trial<'_>, t: &Tally) -> bool {
    let area: f64 = t.histogram.iter().map(|b| b.area_mm2).sum();
    let uncut = t.uncut_area_mm2 - trial.goal.limits.unreached_mm2;
    t.gouge_max_mm > HOPELESS * trial.limits.gouge_mm
        || t.rapid_max_mm.max(t.holder_max_mm) > HOPELESS * trial.limits.collision_mm
        || uncut > HOPELESS_UNCUT * area
}
