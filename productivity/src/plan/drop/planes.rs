//! Passes in parallel planes.

use super::ground::{Lines, asked, ground, hide, nothing, told, too_many};
use super::rounds::{Round, in_rounds};
use super::task::DropTask;
use super::trace;
use super::wants::Want;
use crate::plan::{MAX_PASSES, Passes, PlanError, check_tolerance};
use osculate_geom::Surface;
use rayon::prelude::*;

/// Plans passes in parallel planes with a tool that keeps its axis.
///
/// Passes run to and fro. Places that the end of the tool cannot cut from above are left, and named with their area.
///
/// # Errors
/// [`PlanError`]: a tolerance that is none, no face that the tool reaches from above, or too many passes.
pub fn drop_cutter(task: &DropTask<'_>) -> Result<Passes, PlanError> {
    check_tolerance(&task.tolerance)?;
    let surfaces: Vec<&dyn Surface> = task.faces.iter().chain(task.check).map(|n| n.surface).collect();
    let ground = ground(task, &surfaces, Lines::Planes)?;
    (task.progress)(0.2);
    let (mut wants, mut lost) = asked(&ground);
    let hidden = hide(&ground, &mut wants);
    lost.push((hidden, "is below another place that the tool touches first"));
    if wants.is_empty() {
        return Err(nothing(
            task,
            "no place of it can be cut from above with this tool; give another axis or a smaller tool",
        ));
    }
    (task.progress)(0.4);
    let passes = in_rounds(&ground, &mut wants, &mut lost, |wants| {
        let levels = levels(wants);
        if levels.len() > MAX_PASSES {
            return Err(too_many(task));
        }
        let passes = trace::passes(&ground, wants, &levels);
        Ok(Round { passes, shares: Box::new(move |wants| shares(&levels, wants)) })
    })?;
    Ok(told(&ground, passes, &lost))
}

/// How far places are off the nearest of levels, of their reach.
pub(super) fn shares(levels: &[f64], wants: &[Want]) -> Vec<f64> {
    let share = |w: &Want| {
        let k = levels.partition_point(|z| *z < w.at[1]);
        let near = [k.checked_sub(1), Some(k)].into_iter().flatten().filter_map(|k| levels.get(k));
        near.map(|z| (z - w.at[1]).abs()).fold(f64::INFINITY, f64::min) / w.reach
    };
    wants.par_iter().map(share).collect()
}

/// Levels that leave no place of the faces out of reach, ascending.
///
/// A want stands for places around it, too: those of them that the level before does not reach must be reached by the next.
pub(super) fn levels(wants: &mut [Want]) -> Vec<f64> {
    wants.sort_by(|a, b| a.at[1].total_cmp(&b.at[1]));
    let least = wants.iter().map(|w| w.reach).fold(f64::INFINITY, f64::min);
    let widest = wants.iter().map(|w| w.half[1]).fold(0.0, f64::max);
    let mut out: Vec<f64> = Vec::new();
    let mut last = f64::NEG_INFINITY;
    loop {
        let from = wants.partition_point(|w| w.at[1] + widest < last + least);
        let mut next = f64::INFINITY;
        for w in &wants[from..] {
            if w.at[1] - widest + least > next {
                break;
            }
            if w.at[1] + w.half[1] > last + w.reach {
                next = next.min((w.at[1] - w.half[1]).max(last + w.reach) + w.reach);
            }
        }
        // Every step goes forward by twice the least reach or ends; the count is checked by the caller.
        if !next.is_finite() || out.len() > MAX_PASSES {
            return out;
        }
        out.push(next);
        last = next;
    }
}
