//! Whether the tool fits along a pass.

use super::line::PassLine;
use super::seat::Seat;
use super::{PlanError, Task};
use osculate_geom::{Darboux, Uv};
use osculate_tools::{ContactError, FeedLine};
use rayon::prelude::*;

/// Angle of a line's tangent from S_u towards S_v, rad.
fn angle(task: &Task<'_>, at: Uv, frame: &Darboux) -> Option<f64> {
    let jet = task.surface.jet2(at);
    let forms = jet.forms().ok()?;
    let [x, y] = forms.frame.map(|e| frame.tangent.dot(&e));
    Some((y * jet.side.sign()).atan2(x))
}

/// Refuses a pass on which the part is too hollow for the tool over more than half its radius or a fifth of the pass.
/// Shorter stretches are roughness, which seating deals with and verification judges.
pub(super) fn fits(seat: &Seat<'_>, line: &dyn PassLine, parameters: &[f64]) -> Result<(), PlanError> {
    let task = seat.task();
    let held: Vec<Option<ContactError>> = parameters
        .par_iter()
        .map(|t| {
            let at = line.uv(*t);
            let (frame, speed) = line.frame(*t).ok()?;
            // The fit depends on the direction of the feed alone, not on how the line bends.
            let feed = FeedLine::Angle(angle(task, at, &frame)?);
            let contact = task.contact_at(at, feed, speed).ok()?;
            let refusal = contact.fits().err()?;
            let wide = seat.wide_lift(line, *t).ok()?;
            (task.surface.contains(at) && wide > task.tolerance.gouge_mm).then_some(refusal)
        })
        .collect();
    let radius = |e: &ContactError| match e {
        ContactError::DoesNotFit { largest_radius_mm, .. } => *largest_radius_mm,
        _ => f64::INFINITY,
    };
    // Arc length along the line: a stretch is long against the tool, or against a face that is smaller than it.
    let points: Vec<_> = parameters.iter().map(|t| task.surface.point(line.uv(*t))).collect();
    let length = |first: usize, last: usize| -> f64 {
        points[first..=last].windows(2).map(|w| (w[1] - w[0]).norm()).sum()
    };
    let limit = (0.5 * task.cutter.radius_mm()).min(0.2 * length(0, points.len().saturating_sub(1)));
    let (mut start, mut worst): (Option<usize>, Option<ContactError>) = (None, None);
    for (k, e) in held.iter().enumerate() {
        let Some(e) = e else {
            (start, worst) = (None, None);
            continue;
        };
        let first = *start.get_or_insert(k);
        if worst.is_none_or(|w| radius(e) < radius(&w)) {
            worst = Some(*e);
        }
        if let Some(w) = worst
            && length(first, k) > limit
        {
            return Err(task.contact(w));
        }
    }
    Ok(())
}
