//! Three-axis passes along gradient lines with a flat or toroidal cutter (3C, [M86, section 2]).
//!
//! A tool that keeps its axis leaves the widest strip where it goes straight up or down the slope, so that its circle lies
//! across: `2 sqrt(2 h R / (sin alpha + k_y R))`. The tip of the dropped tool describes a surface over the plane across
//! the axis, whose slope is that of the part at the contact; passes are gradient lines of this surface, so that at
//! every instant the tool goes the steepest way there is at its contact. Gradient lines come together and part: a line is
//! laid through a place that the lines so far just do not reach, and goes on as long as it takes in places that no other
//! has. What the passes leave is measured with the swept cutter, as for planes.
//!
//! Undercut [M86]: where the contour line through a place is hollow with a radius smaller than the cutter's circle at the
//! contact, no tool position touches it alone. Such places are left out, and told of with their area and the largest
//! cutter that would do.

use super::course::Course;
use super::ground::{Ground, Lines, asked, design_mm, ground, hide, nothing, told, too_many};
use super::laid::Laid;
use super::rounds::{Round, in_rounds};
use super::task::DropTask;
use super::trace;
use super::wants::{LEVEL, Lost, Want};
use crate::plan::{MAX_PASSES, Pass, Passes, PlanError};
use osculate_geom::{Diagnostic, Point3, Surface};
use rayon::prelude::*;

/// Steps of a line, of the tool's radius, and how short they become where it bends.
const STEP: f64 = 0.2;
const SHORTEST: f64 = 0.01;
/// The turn over half a step above which it is halved, cosine.
const BEND: f64 = 0.995;
/// A contact nearer to the axis than this part of the flat bottom's radius says nothing about the slope.
const INSIDE: f64 = 0.9;
/// Directions of contact and of the face's normal that agree this well, cosine, belong to a smooth contact.
const SMOOTH: f64 = 0.98;
/// A line goes on over places that others have taken in for so many radii of the tool.
const GAP: f64 = 1.0;
/// A line runs past the last place that it takes in by this part of the tool's radius.
const PAST: f64 = 0.05;
/// Steps of a line, at most.
const MOST_STEPS: usize = 200_000;

/// Plans passes up and down the slope with a flat or toroidal cutter that keeps its axis.
///
/// [`DropTask::feed`] is the way on level ground, which has no slope. Places that the tool cannot cut from above are left, and
/// named with their area.
///
/// # Errors
/// [`PlanError`]: a ball or another cutter that is neither flat nor toroidal, a tolerance that is none, no face that the tool
/// reaches from above, or too many passes.
pub fn gradient_3c(task: &DropTask<'_>) -> Result<Passes, PlanError> {
    crate::plan::check_tolerance(&task.tolerance)?;
    if task.cutter.is_ball() || !task.cutter.is_end_mill() {
        return Err(PlanError::Tool { strategy: "gradient_3c", need: "flat or toroidal cutter" });
    }
    let surfaces: Vec<&dyn Surface> = task.faces.iter().chain(task.check).map(|n| n.surface).collect();
    let ground = ground(task, &surfaces, Lines::Gradient)?;
    (task.progress)(0.2);
    let (mut wants, mut lost) = asked(&ground);
    let hidden = hide(&ground, &mut wants);
    lost.push((hidden, "is below another place that the tool touches first"));
    let fits = largest_circle_mm(&ground);
    if wants.is_empty() {
        let advice = fits
            .map_or_else(String::new, |r| format!("; its contour lines take a cutter of radius {r:.3} mm"));
        return Err(nothing(task, &format!("no place of it can be cut from above with this tool{advice}")));
    }
    (task.progress)(0.4);
    let passes = in_rounds(&ground, &mut wants, &mut lost, |wants| {
        let courses = lay(&ground, wants)?;
        let passes = courses.par_iter().flat_map_iter(|c| trace::along(&ground, c)).collect();
        let shares = move |wants: &[Want]| {
            let mut laid = Laid::new(wants);
            courses.iter().for_each(|c| laid.add(c));
            laid.into_shares()
        };
        Ok(Round { passes, shares: Box::new(shares) })
    })?;
    let mut out = told(&ground, in_order(passes), &lost);
    if let Some(r) = fits {
        let text = format!("its tightest hollow contour line takes a cutter of radius {r:.3} mm, not more");
        out.diagnostics.push(Diagnostic::note("gradient_3c", text));
    }
    Ok(out)
}

/// The radius of the tightest hollow contour line among the places that are undercut by it; None where none is.
fn largest_circle_mm(ground: &Ground<'_>) -> Option<f64> {
    let task = ground.task;
    ground
        .places
        .iter()
        .filter(|s| {
            matches!(ground.want(s, [task.tolerance.scallop_mm, ground.spacing]), Err(Lost::TightContour))
        })
        .filter_map(|s| {
            let forms = task.faces[s.face as usize].surface.jet2(s.uv).forms().ok()?;
            let along = task.axis.cross(&s.normal);
            let sine = along.norm();
            // Meusnier: the contour's own curvature is the normal one over the sine of the slope.
            Some(-sine / forms.normal_curvature(&(along / sine)))
        })
        .filter(|r| r.is_finite())
        .min_by(f64::total_cmp)
}

/// Courses that take in all places.
fn lay(ground: &Ground<'_>, wants: &[Want]) -> Result<Vec<Course>, PlanError> {
    let mut laid = Laid::new(wants);
    let mut out = Vec::new();
    while let Some(k) = laid.next() {
        let Some(course) = line(ground, &laid, wants[k].at) else {
            laid.give_up(k);
            continue;
        };
        laid.add(&course);
        // Whatever rounding says, a place is the start of one line only.
        laid.give_up(k);
        out.push(course);
        if out.len() > MAX_PASSES {
            return Err(too_many(ground.task));
        }
    }
    Ok(out)
}

/// The line through a place, up and down as far as it is needed.
fn line(ground: &Ground<'_>, laid: &Laid<'_>, start: [f64; 2]) -> Option<Course> {
    let first = way(ground, start, [1.0, 0.0])?;
    let back = follow(ground, laid, start, first.map(|x| -x));
    let on = follow(ground, laid, start, first);
    Course::through(back.into_iter().rev().chain([start]).chain(on))
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn unit(a: [f64; 2]) -> Option<[f64; 2]> {
    let long = a[0].hypot(a[1]);
    (long > 0.0).then(|| a.map(|x| x / long))
}

/// The steepest way at a position, with the sense of `before`; that itself on level ground, None where nothing is below.
fn way(ground: &Ground<'_>, c: [f64; 2], before: [f64; 2]) -> Option<[f64; 2]> {
    let rest = ground.drops.rest(c)?;
    let at = ground.frame.of(&rest.point);
    // The tool's lower side rises away from its axis: the contact lies uphill.
    let up = unit([at[0] - c[0], at[1] - c[1]]);
    let cutter = ground.task.cutter;
    let n = ground.drops.normal(&rest).map_or([0.0; 3], |n| ground.frame.along(&n));
    let sine = n[0].hypot(n[1]);
    let level = 2.0 * cutter.core_mm() * sine <= LEVEL * design_mm(&ground.task.tolerance);
    let inside = (at[0] - c[0]).hypot(at[1] - c[1]) < INSIDE * cutter.core_mm();
    let (Some(up), false) = (up, level || inside) else { return Some(before) };
    // The face's normal tells the same more exactly, but not where the tool rests on an edge.
    let up = unit([-n[0], -n[1]]).filter(|d| dot(*d, up) > SMOOTH).unwrap_or(up);
    let sense = if dot(up, before) < 0.0 { -1.0 } else { 1.0 };
    Some(up.map(|x| sense * x))
}

/// The line from a place one way, up to a little past the last place that it takes in.
fn follow(ground: &Ground<'_>, laid: &Laid<'_>, start: [f64; 2], first: [f64; 2]) -> Vec<[f64; 2]> {
    let radius = ground.task.cutter.radius_mm();
    let (mut c, mut dir, mut s) = (start, first, 0.0);
    let mut needed = PAST * radius;
    let mut nodes: Vec<([f64; 2], f64)> = Vec::new();
    for _ in 0..MOST_STEPS {
        let Some((next, turned)) = step(ground, c, dir) else {
            // Up to the brink, wherever it lies in the next step.
            nodes.push(([0, 1].map(|k| c[k] + STEP * radius * dir[k]), s));
            break;
        };
        let long = (next[0] - c[0]).hypot(next[1] - c[1]);
        for w in laid.open(c, next) {
            needed = f64::max(needed, s + w.along * long + w.want.widest() + PAST * radius);
        }
        (c, dir, s) = (next, turned, s + long);
        nodes.push((c, s));
        if s > needed + GAP * radius {
            break;
        }
    }
    let keep = nodes.partition_point(|n| n.1 < needed) + 1;
    nodes.truncate(keep);
    nodes.into_iter().map(|n| n.0).collect()
}

/// One step by the midpoint rule: where it leads, and the way on from there.
fn step(ground: &Ground<'_>, c: [f64; 2], dir: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
    let radius = ground.task.cutter.radius_mm();
    let by = |d: [f64; 2], h: f64| [c[0] + h * d[0], c[1] + h * d[1]];
    let mut h = STEP * radius;
    loop {
        let half = way(ground, by(dir, 0.5 * h), dir);
        let bent = half.is_none_or(|k| dot(k, dir) < BEND);
        if bent && h > SHORTEST * radius {
            h *= 0.5;
            continue;
        }
        let to = by(half?, h);
        return Some((to, way(ground, to, half?)?));
    }
}

/// Passes in an order that keeps the ways between them short, each from the end that is nearer.
fn in_order(passes: Vec<Pass>) -> Vec<Pass> {
    let mut open: Vec<Option<Pass>> = passes.into_iter().map(Some).collect();
    let mut out: Vec<Pass> = Vec::with_capacity(open.len());
    let mut here: Option<Point3> = None;
    loop {
        let ends = |p: &Pass| Some([p.points.first()?.pose.tip, p.points.last()?.pose.tip]);
        let off = |p: &Pass| -> Option<(f64, bool)> {
            let [a, b] = ends(p)?.map(|e| here.map_or(0.0, |h| (e - h).norm()));
            Some(if b < a { (b, true) } else { (a, false) })
        };
        let near = open.iter().enumerate().filter_map(|(k, p)| Some((k, off(p.as_ref()?)?)));
        let Some((k, (_, turned))) = near.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { return out };
        let Some(mut pass) = open[k].take() else { return out };
        if turned {
            pass.points.reverse();
        }
        here = pass.points.last().map(|p| p.pose.tip);
        out.push(pass);
    }
}
