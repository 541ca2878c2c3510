//! Passes as level lines of a scalar field over the face.
//!
//! Whatever the field, one engine cuts its level lines into passes: [`reach`] asks the exact motion of the tool how far a
//! pass covers the face to both sides, [`cells`] takes levels as far apart as that allows everywhere, [`trace`] finds
//! all components of a level, and [`passes`] keeps what the trims need of them, in an order that saves links.

mod cell;
mod cells;
mod correct;
mod even;
mod field;
mod fit;
mod meet;
mod passes;
mod reach;
mod trace;
mod ways;

use super::extended::Extended;
use super::lead::{LeadField, Leaning, LocalLead};
use super::seat::Seat;
use super::{Passes, PlanError, Task, Tolerance, shorter};
use crate::rectangle::Rectangle;
use cells::Cells;

pub(super) use even::widest_mm;
use even::{Even, Wish, Wishes, even};
use field::{Face, Height, ScalarField};
use fit::Place;
use osculate_geom::{Axis, Diagnostic, Jet2, Unit3, Uv};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Rounds of leads along the passes and passes for these leads, before widths are corrected.
const LEADS: u32 = 2;

/// Most of the scallop that the chords of the path may take.
const CHORD: f64 = 0.03;

/// Share of the scallop that is left for what lies between the cells, where the lead changes from place to place and with the sense of a pass.
const LED: f64 = 0.02;

/// How often a field is made again with widths that exact strips corrected.
const CORRECTIONS: u32 = 2;

/// The task on the continued face, with chords that leave the scallop to the passes: points cost less than passes.
fn continued_task<'a>(task: &Task<'a>, face: &'a Extended<'_>) -> Task<'a> {
    let t = task.tolerance;
    let chord_mm = t.chord_mm.min(CHORD * t.scallop_mm);
    let scallop_mm =
        if matches!(task.lean, Leaning::Field(_)) { (1.0 - LED) * t.scallop_mm } else { t.scallop_mm };
    Task { surface: face, tolerance: Tolerance { chord_mm, scallop_mm, ..t }, ..*task }
}

/// A field over a face.
fn over<'a>(task: &Task<'a>, field: &'a dyn ScalarField) -> Face<'a> {
    Face { surface: task.surface, rectangle: Rectangle::of(task.surface), field }
}

/// Passes along the level lines of a field over the continued face; its cells where they are known already.
fn level_passes(
    task: &Task<'_>,
    face: &Extended<'_>,
    field: &dyn ScalarField,
    name: &str,
    known: Option<Cells<'_>>,
) -> Result<Passes, PlanError> {
    let task = &continued_task(task, face);
    (task.progress)(0.2);
    let seat = Seat::any(task);
    let mut cells = match known {
        Some(cells) => cells,
        None => Cells::new(&seat, over(task, field))?,
    };
    (task.progress)(0.4);
    let levels = cells.met_levels(&seat)?;
    (task.progress)(0.5);
    let mut passes = passes::passes(&seat, &cells, &levels)?;
    if passes.is_empty() {
        return Err(PlanError::Nothing {
            face: task.face.to_owned(),
            why: format!("no {name} line crosses its inside; check the trim loops with inspect"),
        });
    }
    for p in passes.iter_mut().flat_map(|p| &mut p.points) {
        p.uv = face.inner(p.uv);
    }
    let mut out = Passes { passes, diagnostics: Vec::new() };
    let (n, length) = (out.passes.len(), out.length_mm());
    out.diagnostics.push(Diagnostic::note(
        task.face,
        format!("{n} {name} passes on {} levels, {length:.0} mm", levels.len()),
    ));
    Ok(out)
}

/// Plans passes in parallel planes; lead leans towards the feed on every pass.
///
/// # Errors
/// [`PlanError`]; where the face lies level in the planes, [`PlanError::Contact`]: it has no lines there.
pub fn isoplanar(task: &Task<'_>, normal: Unit3) -> Result<Passes, PlanError> {
    task.check_level()?;
    if let Leaning::Local(local) = task.lean {
        // As level lines grow, uphill to the left.
        let feed = |_: Uv, jet: &Jet2| jet.normal().ok().map(|n| normal.cross(&n));
        // Passes run out over the border: there too the lead must do.
        let face = Extended::of(task, None);
        let task_beyond = Task { surface: &face, ..*task };
        let field = LeadField::find(&task_beyond, local, (&feed, false), Seat::any(task).rough())?;
        let passes = isoplanar(&Task { lean: Leaning::Field(&field), ..*task }, normal)?;
        return Ok(field.told(passes, task.face));
    }
    level_passes(task, &Extended::of(task, None), &Height(normal), "isoplanar", None)
}

/// Passes along the level lines of the even field with the shorter predicted path of those that start along u and along v.
fn even_passes(task: &Task<'_>, name: &str, wishes: Wishes<'_>) -> Result<Passes, PlanError> {
    let given = task.lean;
    let along = |grows: Axis| {
        let face = Extended::of(task, Some(grows));
        let even = even(&Task { surface: &face, ..*task }, grows, wishes, &|_| None)?;
        Ok((face, even, grows))
    };
    let (u, v) = rayon::join(|| along(Axis::U), || along(Axis::V));
    let (face, mut even, grows) =
        shorter(u, v, |(_, even, _)| if wishes.followed { even.astray } else { even.length_mm })?;
    // The directions of the passes say what lead they need, and the lead how wide their strips are.
    let mut lead = None;
    if let Leaning::Local(local) = task.lean {
        for _ in 0..LEADS {
            let found = lead_along(task, local, &face, &even)?;
            let task = Task { surface: &face, lean: Leaning::Field(&found), ..*task };
            even = even::even(&task, grows, wishes, &|_| None)?;
            lead = Some(found);
        }
    }
    let task = &Task { lean: lead.as_ref().map_or(task.lean, Leaning::Field), ..*task };
    // The field was made with closed forms of the width: where exact strips say something else it is made again, in the
    // directions that were chosen.
    // The lead follows the lines, so that lines that move with their widths would outrun it.
    let corrections = if lead.is_some() { 1 } else { CORRECTIONS };
    for _ in 0..corrections {
        let fine = &continued_task(task, &face);
        let seat = Seat::any(fine);
        let better = {
            let cells = Cells::new(&seat, over(fine, &even.field))?;
            let Some(widths) = cells.measured_widths(&seat) else {
                if matches!(given, Leaning::Local(_)) {
                    break;
                }
                return finished(
                    level_passes(task, &face, &even.field, name, Some(cells))?,
                    task,
                    name,
                    &even,
                );
            };
            let measured = |at: Uv| cells.locate(at).map(|(k, _)| widths[k]);
            let wishes = Wishes { trusts: &[even.trust], ..wishes };
            even::even(&Task { surface: &face, ..*task }, grows, wishes, &measured)?
        };
        even = better;
    }
    let lead = match given {
        Leaning::Local(local) => Some(lead_along(task, local, &face, &even)?),
        _ => None,
    };
    let task = &Task { lean: lead.as_ref().map_or(task.lean, Leaning::Field), ..*task };
    let passes = level_passes(task, &face, &even.field, name, None)?;
    let passes = match &lead {
        Some(lead) => lead.told(passes, task.face),
        None => passes,
    };
    finished(passes, task, name, &even)
}

/// The lead for passes along the level lines of a field.
fn lead_along(
    task: &Task<'_>,
    local: &LocalLead<'_>,
    face: &Extended<'_>,
    even: &Even,
) -> Result<LeadField, PlanError> {
    let continued = Task { surface: face, ..*task };
    let over = over(&continued, &even.field);
    let feed = |at: Uv, _: &Jet2| over.frame(at, false).ok().map(|f| f.0.tangent.into_inner());
    LeadField::find(&continued, local, (&feed, false), Seat::any(task).rough())
}

/// Passes with a word about their field.
fn finished(mut out: Passes, task: &Task<'_>, name: &str, even: &Even) -> Result<Passes, PlanError> {
    out.diagnostics.push(Diagnostic::note(
        task.face,
        format!(
            "spacing of {name} passes uneven by {:.1} % (root mean square) after {} rounds",
            100.0 * even.deviation,
            even.rounds
        ),
    ));
    Ok(out)
}

/// Plans passes with the same scallop all along: level lines of a field whose gradient is one over the strip width.
///
/// # Errors
/// [`PlanError`].
pub fn isoscallop(task: &Task<'_>) -> Result<Passes, PlanError> {
    task.check_level()?;
    let none = |places: &[Place]| vec![Wish::default(); places.len()];
    even_passes(task, "isoscallop", Wishes { of: &none, trusts: &[0.0], binding: false, followed: false })
}

/// Plans passes across the direction of the widest strip, as far as they can also be evenly spaced; whatever of both gives
/// the shorter path.
///
/// # Errors
/// [`PlanError`].
pub fn streamline(task: &Task<'_>) -> Result<Passes, PlanError> {
    task.check_level()?;
    let wish = |places: &[Place]| places.par_iter().map(|p| widest(task, p)).collect();
    even_passes(
        task,
        "streamline",
        Wishes { of: &wish, trusts: &[0.0, 0.3, 1.0], binding: false, followed: false },
    )
}

/// Directions in which widths are compared, over half a turn.
const DIRECTIONS: u32 = 36;

/// The direction of the widest strip, trusted by how much wider it is than the narrowest.
fn widest(task: &Task<'_>, place: &Place) -> Wish {
    let widths = (0..DIRECTIONS).map(|k| {
        let (s, c) = (PI * f64::from(k) / f64::from(DIRECTIONS)).sin_cos();
        ([c, s], place.width_mm(task, [c, s]))
    });
    let (mut most, mut least) = (([1.0, 0.0], 0.0), f64::INFINITY);
    for (across, w) in widths {
        if w > most.1 {
            most = (across, w);
        }
        least = least.min(w);
    }
    Wish { across: most.0, trust: 1.0 - least / most.1 }
}

/// Plans passes along the walls that stand beside the face ([`Task::walls`]), from one to the other as evenly spaced as they can be.
///
/// # Errors
/// [`PlanError::Nothing`] where nothing stands beside it; else [`PlanError`].
pub fn along_walls(task: &Task<'_>) -> Result<Passes, PlanError> {
    task.check_level()?;
    let Some(walls) = task.walls.filter(|w| !w.is_empty()) else {
        let why = "the part does not stand up beside it, which along_walls needs; choose another strategy";
        return Err(PlanError::Nothing { face: task.face.to_owned(), why: why.to_owned() });
    };
    let wish = |places: &[Place]| {
        let of = |p: &Place| {
            let (across, trust) = walls.across(&p.jet.point, &p.forms.frame);
            Wish { across, trust }
        };
        places.par_iter().map(of).collect()
    };
    even_passes(task, "along_walls", Wishes { of: &wish, trusts: &[1.0], binding: false, followed: true })
}

/// Difference of the principal curvatures, of its mean over the face, at which a line of curvature is trusted by half:
/// towards an umbilic the lines run as their surroundings let them.
const NEAR_UMBILIC: f64 = 0.15;

/// Plans passes along the lines of the more convex curvature, so that the flatter or hollower one lies across [M86, 5C].
///
/// # Errors
/// [`PlanError::Tool`] for a ball, which has no use of them; else [`PlanError`].
pub fn curvature_5c(task: &Task<'_>) -> Result<Passes, PlanError> {
    task.check_level()?;
    if task.cutter.is_ball() {
        return Err(PlanError::Tool { strategy: "curvature_5c", need: "toroidal or flat cutter" });
    }
    let difference = |p: &Place| {
        let principal = p.forms.principal();
        principal.k_max - principal.k_min
    };
    let wish = |places: &[Place]| places_by_difference(places, difference);
    even_passes(
        task,
        "curvature_5c",
        Wishes { of: &wish, trusts: &[1.0, 0.6], binding: true, followed: false },
    )
}

/// The wish of every place for the flattest direction across, trusted by the difference of the principal curvatures.
fn places_by_difference(places: &[Place], difference: impl Fn(&Place) -> f64) -> Vec<Wish> {
    let inside = || places.iter().filter(|p| p.inside);
    let area: f64 = inside().map(|p| p.area_mm2).sum();
    let mean = inside().map(|p| difference(p) * p.area_mm2).sum::<f64>() / area;
    let half = NEAR_UMBILIC * mean;
    places
        .iter()
        .map(|p| {
            let (d, across) = (difference(p), p.forms.principal().d_min);
            let square = d * d + half * half;
            let trust = if square > 0.0 { d * d / square } else { 0.0 };
            Wish { across: p.forms.frame.map(|e| across.dot(&e)), trust }
        })
        .collect()
}
