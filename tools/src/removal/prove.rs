//! The only way to a verdict.
//!
//! Faces are looked at evenly, coarsely first: a program that is far off is told so at a fraction of the cost of a right one.
//! Then follow tooth marks, bounds on what hides between samples with more samples where these are not near enough, and the
//! declared raw material. What the limits are compared with is always measured or bounded; what is not looked at stands in the
//! scope.

use super::conclude::{COARSE, Closing, check, concluded, is_hopeless};
use super::goal::{Goal, Program};
use super::job::Cut;
use super::steps::GoalStep;
use super::tally::Limits;
use super::trial::{ProveError, Sampled, Trial, changes_of, unbounded};
use super::verdict::{StockFound, Verdict};

/// Rounds at most in which places between samples that stand too high are counted into an area that is accepted, and those that a look
/// left open are looked at again.
const AGAIN: u32 = 8;
/// Operations are judged by this many samples of all faces where the whole is too far off for a look at more.
const OF_STEPS: f64 = 4e5;
/// Shares of the work, for its progress: raw material where operations are judged, the first look, all of it, and what lies between.
const SHARES: [f64; 4] = [0.15, 0.2, 0.75, 0.9];

/// What was found of a program and of its operations.
#[non_exhaustive]
pub struct Proved {
    /// The verdict on the whole.
    pub whole: Verdict,
    /// The verdict on each operation.
    pub steps: Vec<Verdict>,
}

/// Judges a program against a goal.
///
/// `progress` gets the fraction done. The verdict does not depend on the number of threads.
///
/// ```
/// use osculate_geom::{Domain, Interval, Point3, Vec3, analytic::Plane};
/// use osculate_tools::removal::{Answer, Goal, GoalFace, GoalLimits, GoalStock, GoalTool, Program, Swept, prove};
/// use osculate_tools::{Cutter, Pose};
/// // A flat end of 10 mm along the middle of a plane that is 4 mm wide: once on it, once 0.1 mm too deep.
/// let side = Interval::new(0.0, 4.0);
/// let plane = Plane::new(Domain { u: side, v: side });
/// let cutter = Cutter::cylinder(10.0, 40.0)?;
/// let (faces, tools) = (vec![GoalFace::new("top", &plane)], vec![GoalTool::new(&cutter)]);
/// let goal = Goal::new(faces, tools, GoalStock::Assumed { layer_mm: 0.5 }, GoalLimits::new(0.01, 0.01));
/// let answer = |z: f64| {
///     let at = |x: f64| Pose { tip: Point3::new(x, 2.0, z), axis: Vec3::z_axis() };
///     let motions = [Swept { from: at(-6.0), to: at(10.0), rapid: false, block: 1 }];
///     let program = Program { motions: &motions, times_min: &[], changes: &[] };
///     prove(&goal, program, &|_| ()).map(|verdict| verdict.answer())
/// };
/// assert_eq!(answer(0.0)?, Answer::Held);
/// assert_eq!(answer(-0.1)?, Answer::NotHeld);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ProveError`] where there is nothing to judge or it cannot be judged.
pub fn prove(
    goal: &Goal<'_>,
    program: Program<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verdict, ProveError> {
    prove_in_steps(goal, program, (&[], &[]), progress).map(|proved| proved.whole)
}

/// Judges a program and, when each of them ends, its operations: by what is measured for the whole. `stops` are the numbers of motions
/// after which operations end, ascending; `steps` are none, or one for each stop. The verdict on the whole is that of [`prove`].
///
/// # Errors
/// As [`prove`].
pub fn prove_in_steps(
    goal: &Goal<'_>,
    program: Program<'_>,
    (stops, steps): (&[usize], &[GoalStep<'_>]),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Proved, ProveError> {
    check(goal, &program)?;
    let ordered = stops.windows(2).all(|w| w[0] <= w[1]) && stops.iter().all(|s| *s <= program.motions.len());
    if !ordered || !(steps.is_empty() || steps.len() == stops.len()) {
        return Err(ProveError::Stops { stops: stops.len(), steps: steps.len() });
    }
    let within = |k: usize, f: f64| {
        let begin = if k == 0 { 0.0 } else { SHARES[k - 1] };
        progress(begin + (SHARES.get(k).unwrap_or(&1.0) - begin) * f);
    };
    let changed = changes_of(goal, &program, stops);
    let trial = Trial::new(goal, program, &changed);
    let mut material = None;
    if !steps.is_empty() {
        let touch = |s: &GoalStep<'_>| Limits::new(s.goal.limits.scallop_mm, s.goal.limits.gouge_mm);
        let touches = steps.iter().map(|s| touch(s).collision_mm);
        let touch_mm = touches.fold(trial.limits.collision_mm, f64::min);
        material = trial.carve((stops, touch_mm), &|f| within(0, f))?;
    }
    let mut notes = Vec::new();
    let spacing = trial.spacing_mm(&mut notes);
    let mut look = trial.look(COARSE * spacing, &[], (&mut |_, _, _| Ok(()), &|f| within(1, f)))?;
    let coarse = is_hopeless(&trial, &look.tally);
    let mut found: Vec<Option<StockFound>> = match &mut material {
        Some(m) => std::mem::take(&mut m.at_stops).into_iter().map(Some).collect(),
        None => steps.iter().map(|_| None).collect(),
    };
    let seats: Vec<_> = steps.iter().map(|s| s.seats(goal)).collect();
    let mut judged: Vec<Option<Verdict>> = steps.iter().map(|_| None).collect();
    let mut at_stop = |k: usize, sampled: &Sampled, cuts: &[Cut]| {
        if let Some(seats) = seats.get(k).and_then(Option::as_ref) {
            let stock = found[k].take();
            judged[k] = Some(steps[k].on_samples_of_all((&program, seats), (sampled, cuts), stock)?);
        }
        Ok(())
    };
    if !coarse {
        look = trial.look(spacing, stops, (&mut at_stop, &|f| within(2, f)))?;
    } else if seats.iter().any(Option::is_some) {
        // What is far off in the end need not be so where an operation ends.
        let spacing = trial.spacing_of_mm(OF_STEPS).max(spacing);
        trial.look(spacing, stops, (&mut at_stop, &|f| within(2, f)))?;
    }
    let apart = steps.iter().zip(&mut judged).zip(&mut found).filter(|((_, judged), _)| judged.is_none());
    for ((step, judged), found) in apart {
        *judged = Some(step.on_its_own(&program, found.take(), &|_| {})?);
    }
    let mut marks = trial.marks(&look.measured, usize::MAX)?;
    if !coarse {
        trial.give_up(&mut look, &mut marks, spacing)?;
    }
    let crest_median_mm = trial.crests(&look.measured)?;
    let bounds = goal.looks.between && !coarse;
    let mut refined = if bounds { trial.refine(&mut look, &mut marks)? } else { unbounded() };
    // Samples that were added may stand too high where an area that does is accepted, and end a look that others have not.
    let mut added = refined.added;
    for _ in 0..AGAIN {
        let gives_up = trial.is_to_give_up(&look, &marks);
        let goes_on = refined.added > 0 && !look.is_settled() && trial.holds(&look);
        if !bounds || !(gives_up || goes_on) {
            break;
        }
        if gives_up {
            trial.give_up(&mut look, &mut marks, spacing)?;
        }
        refined = trial.refine(&mut look, &mut marks)?;
        added += refined.added;
    }
    // What is left open counts into an area that is accepted.
    let mut open_mm2 = 0.0;
    if bounds && goal.limits.unreached_mm2 > 0.0 && !look.is_settled() && trial.holds(&look) {
        open_mm2 = trial.give_up_open(&mut look, &mut marks)?;
        if open_mm2 > 0.0 {
            refined = trial.refine(&mut look, &mut marks)?;
            added += refined.added;
        }
    }
    refined.added = added;
    within(3, 1.0);
    let stock = match material {
        _ if coarse => None,
        Some(m) => Some(m.whole),
        None => trial.carve((&[], trial.limits.collision_mm), &|f| within(4, f))?.map(|m| m.whole),
    };
    progress(1.0);
    let whole = concluded(
        &trial,
        look,
        (&marks, crest_median_mm),
        Closing { coarse, refined, open_mm2, stock, notes },
    );
    Ok(Proved { whole, steps: judged.into_iter().flatten().collect() })
}
