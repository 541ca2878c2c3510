//! Isoparametric passes whose spacing the exact strip decides (5C).
//!
//! The face is covered from one side to the other. At a set of columns along the passes a frontier is kept: the
//! parameter up to which the strips so far leave no more than the design height. The next pass lies as far on as
//! every column allows: the swept tool of that pass must still come down to the design height at the frontier. Both
//! questions are asked of the true motion of the tool, so that the cusp between two passes is what they really leave,
//! whatever the surface does between them.
//!
//! A tool reaches places beside its contact before or after it comes abreast of them. So a pass runs on until the tool has come
//! deepest at all that it answers for, over the border of the face too, which is continued there ([`Extended`]).

use super::columns::{Column, column_parameters, first_step, rough_columns, stretches};
use super::cover::{across_range, union};
use super::ends::{Ended, Ends};
use super::extended::Extended;
use super::fits::fits;
use super::lead::{Clearance, LeadField, Leaning};
use super::motion::PassMotion;
use super::resample::{contact_points, resample};
use super::seat::Seat;
use super::walk::Walk;
use super::{Along, MAX_PASSES, Pass, Passes, PlanError, Task, Tolerance, shorter};
use osculate_geom::line::{IsoLine, LineError, SurfaceLine};
use osculate_geom::{Axis, Diagnostic, Interval, Jet2, Uv};
use osculate_tools::FeedLine;
use osculate_tools::strip::{self, StripError, standoff};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// Rows to each side of a pass in which the stretches that it must run over are looked for.
const COVER_ROWS: i32 = 10;
/// How far on a pass may lie is asked at every so many columns first.
const ASKED_STRIDE: usize = 12;
/// How far towards its neighbours a pass looks for the face, and how far what lies there is its own: the ridge between two passes
/// is about halfway, but not where axes lean to one side on all passes.
const LOOKED: f64 = 0.75;
const OWN: f64 = 0.55;
/// A pass runs further than it must by this part of its strip's width: what it leaves grows with the square of what it lacks.
const PAST: f64 = 0.05;
/// Strip width is computed at every so many columns of a pass.
const WIDTH_STRIDE: usize = 8;

/// The share of the progress that passes take with the leads of the face alone.
const FIRST: f64 = 0.6;

/// Most of the scallop that the chords of the path may take: points cost less than passes.
const CHORD: f64 = 0.05;

/// The tolerance of a task with chords that leave the scallop to the passes.
pub(super) fn close_chords(task: &Task<'_>) -> Tolerance {
    let t = task.tolerance;
    Tolerance { chord_mm: t.chord_mm.min(CHORD * t.scallop_mm), ..t }
}

/// One pass to be: the fixed parameter, its direction, and what is known along it.
struct Level {
    fixed: f64,
    reversed: bool,
    /// (parameter along the pass, strip width), ascending.
    widths: Vec<(f64, f64)>,
}

/// A covering of the face by levels.
pub(super) struct Layout {
    ends: Ends,
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
    let task = &Task { tolerance: close_chords(task), ..*task };
    if let Leaning::Local(local) = task.lean {
        let one = |axis: Axis, progress: &(dyn Fn(f64) + Sync)| {
            let seat = Seat::new(task, axis);
            let (rough, one_way) = (seat.rough(), seat.closes(axis));
            let feed = |_: Uv, jet: &Jet2| Some(if axis == Axis::U { jet.du } else { jet.dv });
            // Beyond the border the leads of the border do as a rule.
            let field = LeadField::find(task, local, (&feed, one_way), rough)?;
            let led = &Task { lean: Leaning::Field(&field), ..*task };
            let face = Extended::of(led, None);
            let beyond = &Task { surface: &face, ..*led };
            let lay = |ends: Ends, progress: &(dyn Fn(f64) + Sync)| {
                let task = &Task { progress, ..*beyond };
                built(task, &face, lay_out(task, ends, &|f| progress(0.5 * f))?)
            };
            let passes = lay(Ends::whole(&face, axis), &|f| progress(FIRST * f))?;
            let clearance = Clearance::new(task, local, rough);
            let own = face.own().get(axis);
            let out = passes.passes.par_iter().flat_map(|p| &p.points);
            let out = out.filter(|p| p.uv.get(axis) <= own.lo || p.uv.get(axis) >= own.hi);
            let passes = if out.any(|p| clearance.digs_in(p.uv, &p.pose)) {
                lay(Ends::clear(beyond, &face, axis, &clearance), &|f| progress(FIRST + (1.0 - FIRST) * f))?
            } else {
                passes
            };
            progress(1.0);
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
    // Passes run out over the border.
    let face = Extended::of(task, None);
    let task = &Task { surface: &face, ..*task };
    let layout = match along {
        Along::Fixed(axis) => lay_out(task, Ends::whole(&face, axis), &|f| (task.progress)(0.5 * f))?,
        Along::Auto => {
            // Both at a time: the progress is that of the one that is less far.
            let far = [0, 1].map(|_| AtomicU64::new(0));
            let at = |k: usize, f: f64| {
                far[k].store(f.to_bits(), Ordering::Relaxed);
                let both = far.each_ref().map(|x| f64::from_bits(x.load(Ordering::Relaxed)));
                (task.progress)(0.5 * both[0].min(both[1]));
            };
            let one = |k: usize, axis: Axis| {
                let made = lay_out(task, Ends::whole(&face, axis), &|f| at(k, f));
                at(k, 1.0);
                made
            };
            let (u, v) = rayon::join(|| one(0, Axis::U), || one(1, Axis::V));
            shorter(u, v, |l| l.length_mm)?
        }
    };
    built(task, &face, layout)
}

/// The passes of a layout over a continued face.
pub(super) fn built(task: &Task<'_>, face: &Extended<'_>, layout: Layout) -> Result<Passes, PlanError> {
    let done = AtomicUsize::new(0);
    let total = layout.levels.len();
    let along = layout.ends.along;
    let breaks = task.surface.breaks(along);
    let seat = Seat::new(task, along).held_by(face.own());
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
    for p in out.passes.iter_mut().flat_map(|p| &mut p.points) {
        p.uv = face.inner(p.uv);
    }
    let axis = if along == Axis::U { "u" } else { "v" };
    out.diagnostics.push(Diagnostic::note(
        task.face,
        format!("{} isoparametric passes along {axis}, {:.0} mm", out.passes.len(), out.length_mm()),
    ));
    Ok(out)
}

/// The range of the fixed parameter over which a face has an inside.
pub(super) fn inside_across(task: &Task<'_>, ends: &Ends) -> Result<[f64; 2], PlanError> {
    let nothing = || PlanError::Nothing {
        face: task.face.to_owned(),
        why: "its trim loops leave no inside; check them with inspect".to_owned(),
    };
    let sides = ends.own.get(ends.along.other());
    // The end of the inside is found to within rounding.
    let range = across_range(task.surface, ends.along).ok_or_else(nothing)?;
    Ok(range.map(|x| if sides.periodic { x } else { x.clamp(sides.lo, sides.hi) }))
}

/// The levels of passes with given ends; `progress` is told the share of the face that they cover so far.
pub(super) fn lay_out(
    task: &Task<'_>,
    ends: Ends,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Layout, PlanError> {
    let (own, along) = (ends.own, ends.along);
    let surface = task.surface;
    let [lo, hi] = inside_across(task, &ends)?;
    let across = Interval::new(lo, hi);
    let slack = 1e-7 * (hi - lo);
    let seat = Seat::new(task, along).held_by(own);
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
        let cover = Cover { seat: &seat, task, ends: &ends, reversed, hi, guess };
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
    Ok(Layout { ends, across: [lo, hi], levels, length_mm })
}

/// The two questions of the frontier, for one pass direction.
pub(super) struct Cover<'a> {
    pub seat: &'a Seat<'a>,
    pub task: &'a Task<'a>,
    pub ends: &'a Ends,
    pub reversed: bool,
    pub hi: f64,
    pub guess: f64,
}

impl Cover<'_> {
    /// Standoff above the design height at column `t`, parameter `point`, of the pass at `pass`.
    fn excess(&self, column: &Column, point: f64, pass: f64) -> Result<f64, LineError> {
        let (task, along, t) = (self.task, self.ends.along, column.t);
        let line = IsoLine { surface: task.surface, along, fixed: pass, reversed: self.reversed };
        let (frame, speed) = line.frame(t)?;
        // The frame turns forward about b at the normal curvature along the feed.
        let h = task.design_scallop_mm(frame.turn.dot(&frame.left), column.left);
        let ends = self.ends.of(pass, self.reversed);
        let motion = Ended { motion: PassMotion { seat: self.seat, line: &line }, ends };
        let step = 0.05 * task.cutter.radius_mm() / speed.abs().max(1e-12);
        let of = |point: f64| {
            let at = Uv::from_axis(along, t, point);
            standoff(task.cutter, task.surface, at, &motion, t.clamp(ends[0], ends[1]), step)
        };
        // Where the tool is held off, what it would leave if it were not counts from how deep it would then go on its own line. Passes
        // with leads, which lean with the averaged normal, were measured to hold without, with a fifth fewer of them.
        let deep = matches!(task.lean, Leaning::Axes(_)) && column.is_held_off(task);
        let deep_mm = if deep { of(pass)?.map_or(0.0, |r| r.at_mm.min(0.0)) } else { 0.0 };
        Ok(of(point)?.map_or(task.cutter.radius_mm(), |r| r.at_mm - deep_mm - h))
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
    pub fn furthest_pass(&self, column: &Column, frontier: f64) -> Result<f64, LineError> {
        self.walk(frontier).last_below_near(|pass| self.excess(column, frontier, pass))
    }

    /// How far the strip of a pass reaches at a column.
    pub fn reached(&self, column: &Column, pass: f64) -> Result<f64, LineError> {
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
        let (feed, sense) =
            if reversed { (FeedLine::IsoReversed(along), -1.0) } else { (FeedLine::Iso(along), 1.0) };
        let contact = task.contact_at(at, feed, sense).map_err(|e| task.contact(e))?;
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

/// The passes of one level: stretches of inside, as far as the tool must go for them, resampled.
fn build(
    seat: &Seat<'_>,
    task: &Task<'_>,
    layout: &Layout,
    k: usize,
    level: &Level,
    breaks: &[f64],
) -> Result<Vec<Pass>, LineError> {
    let surface = task.surface;
    let along = layout.ends.along;
    let domain = surface.domain().get(along);
    let ends = layout.ends.of(level.fixed, level.reversed);
    let line = IsoLine { surface, along, fixed: level.fixed, reversed: level.reversed };
    let motion = Ended { motion: PassMotion { seat, line: &line }, ends };
    let radius = task.cutter.radius_mm();
    // Length of a mm along the pass, in its parameter.
    let mm = |t: f64| {
        let jet = surface.jet2(Uv::from_axis(along, t, level.fixed));
        1.0 / if along == Axis::U { jet.du.norm() } else { jet.dv.norm() }.max(1e-12)
    };
    let width = |t: f64| Some(interpolate(&level.widths, t)).filter(|w| w.is_finite()).unwrap_or(0.0);
    // How far the pass must go for the ends of a stretch of inside beside it.
    let run_out = |row: f64, [lo, hi]: [f64; 2]| -> Result<[f64; 2], LineError> {
        let abreast = |t: f64, sign: f64| -> Result<f64, LineError> {
            let mm = mm(t);
            let at = Uv::from_axis(along, t, row);
            let from = t.clamp(ends[0], ends[1]);
            let reach = standoff(task.cutter, surface, at, &motion, from, 0.05 * radius * mm)?;
            let past = sign * width(t) * mm;
            let deepest = reach.map_or(t + 0.5 * past, |r| r.t + PAST * past);
            // No further than a strip is wide: from there on it is another place that the tool comes down to.
            let beside = [t, t + past];
            Ok(deepest.clamp(beside[0].min(beside[1]), beside[0].max(beside[1])))
        };
        Ok([abreast(lo, -1.0)?.max(ends[0]), abreast(hi, 1.0)?.min(ends[1])])
    };
    let neighbour = |j: Option<usize>| j.and_then(|j| layout.levels.get(j)).map(|l| l.fixed);
    // Towards a neighbour some way past the ridge between them; at the first and last pass the whole way to the end of the face.
    let to = |next: Option<f64>, end: f64, share: f64| {
        next.map_or(end, |next| level.fixed + share * (next - level.fixed))
    };
    let [before, after] = [neighbour(k.checked_sub(1)), neighbour(Some(k + 1))];
    let within = |share: f64| [to(before, layout.across[0], share), to(after, layout.across[1], share)];
    let [below, above] = within(LOOKED);
    let one_side = matches!(task.lean, Leaning::Axes(_) | Leaning::Sided(_));
    let own = within(if one_side { LOOKED } else { OWN });
    // Beyond what is its own a pass only goes as far as the face does.
    let stretch =
        |row: f64, s: [f64; 2]| if row >= own[0] && row <= own[1] { run_out(row, s) } else { Ok(s) };
    let mut stretches = Vec::new();
    for k in -COVER_ROWS..=COVER_ROWS {
        let f = f64::from(k) / f64::from(COVER_ROWS);
        let row = level.fixed + f * if k < 0 { level.fixed - below } else { above - level.fixed };
        for s in surface.spans(along, row) {
            stretches.push(stretch(row, [s.lo, s.hi])?);
        }
    }
    for at in surface.turns() {
        let x = surface.domain().get(along.other()).bring(at.get(along.other()));
        if x >= below && x <= above {
            let t = domain.bring(at.get(along));
            stretches.push(stretch(x, [t, t])?);
        }
    }
    // A gap narrower than the strip is not worth lifting for.
    let gap = stretches.iter().map(|s| width(s[1]) * mm(s[1])).fold(1e-3 * domain.length(), f64::max);
    let mut stretches = union(stretches, gap);
    if level.reversed {
        stretches.reverse();
    }
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
