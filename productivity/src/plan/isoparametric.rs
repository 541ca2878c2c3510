//! Isoparametric passes whose spacing the exact strip decides (5C).
//!
//! The face is covered from one side to the other. At a set of columns along the passes a frontier is kept: the
//! parameter up to which the strips so far leave no more than the design height. The next pass lies as far on as
//! every column allows: the swept tool of that pass must still come down to the design height at the frontier. Both
//! questions are asked of the true motion of the tool, so that the cusp between two passes is what they really leave,
//! whatever the surface does between them.

use super::columns::{Column, column_parameters, first_step, rough_columns, stretches};
use super::cover::{across_range, union};
use super::fits::fits;
use super::lead::{LeadField, Leaning};
use super::motion::PassMotion;
use super::resample::{contact_points, resample};
use super::seat::{Averaged, Seat};
use super::walk::Walk;
use super::{Along, MAX_PASSES, Pass, Passes, PlanError, Task, shorter};
use osculate_geom::line::{IsoLine, LineError, SurfaceLine};
use osculate_geom::{Axis, Diagnostic, Interval, Jet2, Uv};
use osculate_tools::strip::{self, StripError, standoff};
use osculate_tools::{Contact, FeedLine};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Rows to each side of a pass in which the stretches that it must run over are looked for.
const COVER_ROWS: i32 = 10;
/// How far on a pass may lie is asked at every so many columns first.
const ASKED_STRIDE: usize = 12;
/// Strip width is computed at every so many columns of a pass.
const WIDTH_STRIDE: usize = 8;

/// One pass to be: the fixed parameter, its direction, and what is known along it.
struct Level {
    fixed: f64,
    reversed: bool,
    /// (parameter along the pass, strip width), ascending.
    widths: Vec<(f64, f64)>,
}

/// A covering of the face by levels.
struct Layout {
    along: Axis,
    /// Range of the fixed parameter that the face covers.
    across: [f64; 2],
    levels: Vec<Level>,
    length_mm: f64,
}

/// Plans isoparametric passes over a face.
///
/// Passes run one way around where the face closes on itself, to and fro elsewhere; lead leans towards the feed on
/// every pass.
///
/// # Errors
/// [`PlanError`]; in particular [`PlanError::Contact`] with the largest fitting radius where the tool would cut
/// deeper than `gouge_mm` beside its contact.
pub fn isoparametric(task: &Task<'_>, along: Along) -> Result<Passes, PlanError> {
    task.check()?;
    if let Leaning::Local(local) = task.lean {
        let one = |axis: Axis, progress: &(dyn Fn(f64) + Sync)| {
            let seat = Seat::new(task, axis);
            let feed = |_: Uv, jet: &Jet2| Some(if axis == Axis::U { jet.du } else { jet.dv });
            let field = LeadField::find(task, local, (&feed, seat.rough()))?;
            let lean = Leaning::Field(&field);
            let passes = isoparametric(&Task { lean, progress, ..*task }, Along::Fixed(axis))?;
            Ok(field.told(passes, task.face))
        };
        return match along {
            Along::Fixed(axis) => one(axis, task.progress),
            Along::Auto => {
                let u = one(Axis::U, &|f| (task.progress)(0.5 * f));
                shorter(u, one(Axis::V, &|f| (task.progress)(0.5 + 0.5 * f)), Passes::length_mm)
            }
        };
    }
    let layout = match along {
        Along::Fixed(axis) => lay_out(task, axis, &|f| (task.progress)(0.5 * f))?,
        Along::Auto => {
            // Both at a time: the progress is that of the one that is less far.
            let far = [0, 1].map(|_| AtomicU64::new(0));
            let at = |k: usize, f: f64| {
                far[k].store(f.to_bits(), Ordering::Relaxed);
                let both = far.each_ref().map(|x| f64::from_bits(x.load(Ordering::Relaxed)));
                (task.progress)(0.5 * both[0].min(both[1]));
            };
            let one = |k: usize, axis: Axis| {
                let made = lay_out(task, axis, &|f| at(k, f));
                at(k, 1.0);
                made
            };
            let (u, v) = rayon::join(|| one(0, Axis::U), || one(1, Axis::V));
            shorter(u, v, |l| l.length_mm)?
        }
    };
    let done = AtomicUsize::new(0);
    let total = layout.levels.len();
    let breaks = task.surface.breaks(layout.along);
    let seat = Seat::new(task, layout.along);
    let built: Vec<Result<Vec<Pass>, LineError>> = layout
        .levels
        .par_iter()
        .enumerate()
        .map(|(k, level)| {
            let passes = build(&seat, task, &layout, k, level, &breaks);
            let n = done.fetch_add(1, Ordering::Relaxed) + 1;
            (task.progress)(0.5 + 0.5 * n as f64 / total as f64);
            passes
        })
        .collect();
    let mut out = Passes::default();
    for b in built {
        out.passes.extend(b.map_err(|e| task.contact(e.into()))?);
    }
    if out.passes.is_empty() {
        return Err(PlanError::Nothing {
            face: task.face.to_owned(),
            why: "no isoparametric line crosses its inside; check the trim loops with inspect".to_owned(),
        });
    }
    let axis = if layout.along == Axis::U { "u" } else { "v" };
    out.diagnostics.push(Diagnostic::note(
        task.face,
        format!("{} isoparametric passes along {axis}, {:.0} mm", out.passes.len(), out.length_mm()),
    ));
    Ok(out)
}

/// The levels of passes along a parameter; `progress` is told the share of the face that they cover so far.
fn lay_out(task: &Task<'_>, along: Axis, progress: &(dyn Fn(f64) + Sync)) -> Result<Layout, PlanError> {
    let surface = task.surface;
    let nothing = || PlanError::Nothing {
        face: task.face.to_owned(),
        why: "its trim loops leave no inside; check them with inspect".to_owned(),
    };
    let [lo, hi] = across_range(surface, along).ok_or_else(nothing)?;
    let across = Interval::new(lo, hi);
    let slack = 1e-7 * (hi - lo);
    let seat = Seat::new(task, along);
    let parameters = column_parameters(&seat, along, across)?;
    let mut columns: Vec<Column> = (0..parameters.len())
        .into_par_iter()
        .map(|k| Column {
            t: parameters[k],
            inside: stretches(surface, along, [lo, hi], &parameters, k),
            frontier: None,
            left: 0.0,
        })
        .collect();
    for c in &mut columns {
        c.advance(lo, slack);
    }
    rough_columns(&seat, along, lo, false, &mut columns);
    let closed = seat.closes(along);
    let mut levels: Vec<Level> = Vec::new();
    let mut length_mm = 0.0;
    let mut guess = first_step(task, along, across);
    while columns.iter().any(|c| c.frontier.is_some()) {
        if levels.len() >= MAX_PASSES {
            return Err(PlanError::TooManyPasses {
                face: task.face.to_owned(),
                limit: MAX_PASSES,
                scallop_mm: task.tolerance.scallop_mm,
            });
        }
        let reversed = !closed && levels.len() % 2 == 1;
        let cover = Cover { seat: &seat, task, along, reversed, hi, guess };
        let next = cover.next(&columns).map_err(|e| task.contact(e.into()))?;
        let reached = columns
            .par_iter()
            .map(|c| match c.frontier {
                Some(f) if f <= next + cover.guess * 50.0 => cover.reached(c, next).map(Some),
                _ => Ok(None),
            })
            .collect::<Result<Vec<_>, LineError>>()
            .map_err(|e| task.contact(e.into()))?;
        let before: f64 = columns.iter().filter_map(|c| c.frontier).sum();
        let open = columns.iter().filter(|c| c.frontier.is_some()).count();
        for (c, r) in columns.iter_mut().zip(reached) {
            if let (Some(f), Some(r)) = (c.frontier, r) {
                c.advance(r.max(f), slack);
            }
        }
        let after: f64 = columns.iter().filter_map(|c| c.frontier).sum();
        if open == columns.iter().filter(|c| c.frontier.is_some()).count() && after - before <= slack * 1e-3 {
            // A pass that covers nothing: the surface does not let the tool down to the design height.
            return Err(PlanError::Nothing {
                face: task.face.to_owned(),
                why: format!(
                    "the tool leaves more than scallop_mm = {} mm beside its own contact near the parameter {next:.6}; \
                     use a smaller tool or a larger lead",
                    task.tolerance.scallop_mm
                ),
            });
        }
        rough_columns(&seat, along, next, reversed, &mut columns);
        let (level, mean_speed) = measure(&seat, along, next, reversed, &columns)?;
        length_mm += mean_speed;
        if let Some(last) = levels.last() {
            guess = (next - last.fixed).max(slack);
        }
        levels.push(level);
        let open = columns.iter().filter_map(|c| c.frontier).fold(hi, f64::min);
        progress((open - lo) / (hi - lo));
    }
    Ok(Layout { along, across: [lo, hi], levels, length_mm })
}

/// The two questions of the frontier, for one pass direction.
struct Cover<'a> {
    seat: &'a Seat<'a>,
    task: &'a Task<'a>,
    along: Axis,
    reversed: bool,
    hi: f64,
    guess: f64,
}

impl Cover<'_> {
    /// Standoff above the design height at column `t`, parameter `point`, of the pass at `pass`.
    fn excess(&self, column: &Column, point: f64, pass: f64) -> Result<f64, LineError> {
        let (task, t) = (self.task, column.t);
        let line = IsoLine { surface: task.surface, along: self.along, fixed: pass, reversed: self.reversed };
        let (frame, speed) = line.frame(t)?;
        // The frame turns forward about b at the normal curvature along the feed.
        let h = task.design_scallop_mm(frame.turn.dot(&frame.left), column.left);
        let averaged = Averaged { seat: self.seat, line: &line };
        let led: &dyn SurfaceLine = if self.seat.rough() { &averaged } else { &line };
        let motion = PassMotion { task, line: &line, led };
        let step = 0.05 * task.cutter.radius_mm() / speed.abs().max(1e-12);
        let at = Uv::from_axis(self.along, t, point);
        let reach = standoff(task.cutter, task.surface, at, &motion, t, step)?;
        Ok(reach.map_or(task.cutter.radius_mm(), |r| r.at_mm - h))
    }

    /// A walk over half a strip.
    const fn walk(&self, from: f64) -> Walk {
        Walk { from, to: self.hi, guess: 0.5 * self.guess, tolerance: 1e-4 * self.guess }
    }

    /// How far on the next pass may lie, so that it covers the frontiers of all columns. A few columns say how far about;
    /// of the others only those that such a pass would not cover are asked more.
    fn next(&self, columns: &[Column]) -> Result<f64, LineError> {
        let open: Vec<(&Column, f64)> = columns.iter().filter_map(|c| c.frontier.map(|f| (c, f))).collect();
        let about = open
            .par_iter()
            .step_by(ASKED_STRIDE)
            .map(|(c, f)| self.furthest_pass(c, *f))
            .collect::<Result<Vec<f64>, LineError>>()?
            .into_iter()
            .fold(self.hi, f64::min);
        let nearer = |(c, f): &(&Column, f64)| -> Result<f64, LineError> {
            let covered = *f >= about || self.excess(c, *f, about)? <= 0.0;
            if covered { Ok(about) } else { self.furthest_pass(c, *f) }
        };
        let all = open.par_iter().map(nearer).collect::<Result<Vec<f64>, LineError>>()?;
        Ok(all.into_iter().fold(about, f64::min))
    }

    /// How far on a pass may lie that still covers the frontier of a column.
    fn furthest_pass(&self, column: &Column, frontier: f64) -> Result<f64, LineError> {
        self.walk(frontier).last_below_near(|pass| self.excess(column, frontier, pass))
    }

    /// How far the strip of a pass reaches at a column.
    fn reached(&self, column: &Column, pass: f64) -> Result<f64, LineError> {
        self.walk(pass).last_below_near(|point| self.excess(column, point, pass))
    }
}

/// Exact strip widths along a level, the check that the tool fits, and the level's length.
fn measure(
    seat: &Seat<'_>,
    along: Axis,
    fixed: f64,
    reversed: bool,
    columns: &[Column],
) -> Result<(Level, f64), PlanError> {
    let task = seat.task();
    let line = IsoLine { surface: task.surface, along, fixed, reversed };
    let width = |t: f64| -> Result<Option<(f64, f64)>, PlanError> {
        let at = Uv::from_axis(along, t, fixed);
        if !task.surface.contains(at) {
            return Ok(None);
        }
        let feed = if reversed { FeedLine::IsoReversed(along) } else { FeedLine::Iso(along) };
        let contact = Contact::new(task.surface, at, task.cutter, feed, task.lean.at(at))
            .map_err(|e| task.contact(e))?;
        match strip::exact(&contact, task.tolerance.scallop_mm) {
            Ok(s) => Ok(Some((t, s.width_mm))),
            // Where a line runs into a pole, or a ripple throws the unseated tool off its own contact, there is no
            // width; the pass itself is still good.
            Err(StripError::Degenerate(_) | StripError::AboveTolerance { .. } | StripError::Edge(_)) => {
                Ok(None)
            }
            Err(e) => Err(task.strip(e)),
        }
    };
    let found: Vec<_> = columns.par_iter().step_by(WIDTH_STRIDE).map(|c| width(c.t)).collect();
    let mut widths = Vec::with_capacity(found.len());
    for f in found {
        widths.extend(f?);
    }
    if widths.is_empty() {
        // A pass shorter than the stride between columns.
        for s in task.surface.spans(along, fixed) {
            widths.extend(width(s.at(0.5))?);
        }
    }
    let parameters: Vec<f64> = columns.iter().map(|c| c.t).collect();
    fits(seat, &line, &parameters)?;
    let mut length = 0.0;
    let mut last = None;
    for c in columns {
        let at = Uv::from_axis(along, c.t, fixed);
        let here = task.surface.contains(at).then(|| task.surface.point(at));
        if let (Some(a), Some(b)) = (last, here) {
            length += (b - a as osculate_geom::Point3).norm();
        }
        last = here;
    }
    Ok((Level { fixed, reversed, widths }, length))
}

/// The passes of one level: stretches of inside, widened by what their strip reaches to both sides, resampled.
fn build(
    seat: &Seat<'_>,
    task: &Task<'_>,
    layout: &Layout,
    k: usize,
    level: &Level,
    breaks: &[f64],
) -> Result<Vec<Pass>, LineError> {
    let surface = task.surface;
    let (along, domain) = (layout.along, surface.domain().get(layout.along));
    let neighbour = |j: Option<usize>| j.and_then(|j| layout.levels.get(j)).map(|l| l.fixed);
    // Towards a neighbour three quarters of the way; at the first and last pass the whole way to the end of the face.
    let below =
        neighbour(k.checked_sub(1)).map_or(layout.across[0], |b| level.fixed - 0.75 * (level.fixed - b));
    let above = neighbour(Some(k + 1)).map_or(layout.across[1], |a| level.fixed + 0.75 * (a - level.fixed));
    let mut stretches = Vec::new();
    for k in -COVER_ROWS..=COVER_ROWS {
        let f = f64::from(k) / f64::from(COVER_ROWS);
        let reach = if k < 0 { level.fixed - below } else { above - level.fixed };
        stretches.extend(surface.spans(along, level.fixed + f * reach).iter().map(|s| [s.lo, s.hi]));
    }
    for at in surface.turns() {
        let x = surface.domain().get(along.other()).bring(at.get(along.other()));
        if x >= below && x <= above {
            let t = domain.bring(at.get(along));
            stretches.push([t, t]);
        }
    }
    // Lines that meet a trim at a slant come nearest to the places between passes beyond it.
    for s in &mut stretches {
        let over = |t: f64| {
            let jet = surface.jet2(Uv::from_axis(along, t, level.fixed));
            let speed = if along == Axis::U { jet.du.norm() } else { jet.dv.norm() };
            let width = interpolate(&level.widths, t);
            if width.is_finite() { 0.5 * width / speed.max(1e-12) } else { 0.0 }
        };
        *s = [(s[0] - over(s[0])).max(domain.lo), (s[1] + over(s[1])).min(domain.hi)];
    }
    let mut stretches = union(stretches, 1e-3 * domain.length());
    if level.reversed {
        stretches.reverse();
    }
    let line = IsoLine { surface, along, fixed: level.fixed, reversed: level.reversed };
    let mut out = Vec::new();
    for s in stretches {
        if s[1] - s[0] <= 1e-9 * domain.length() {
            continue;
        }
        let range = if level.reversed { [s[1], s[0]] } else { s };
        let knots = resample(seat, task, &line, range, breaks)?;
        let mut points = contact_points(&knots, |t| line.uv(t));
        for p in &mut points {
            p.width_mm = interpolate(&level.widths, p.uv.get(along));
        }
        let closed = seat.closes(along) && s[1] - s[0] >= domain.length() * (1.0 - 1e-9);
        out.push(Pass { points, closed });
    }
    Ok(out)
}

/// Linear interpolation in ascending pairs, constant beyond the ends.
fn interpolate(pairs: &[(f64, f64)], t: f64) -> f64 {
    let k = pairs.partition_point(|p| p.0 < t);
    match (k.checked_sub(1).and_then(|j| pairs.get(j)), pairs.get(k)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t - a.0) / (b.0 - a.0),
        (Some(one), None) | (None, Some(one)) => one.1,
        (None, None) => f64::NAN,
    }
}
