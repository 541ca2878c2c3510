//! Passes along levels: where the tool must go on each, and the path there at the chord tolerance.

use super::course::Course;
use super::ground::Ground;
use super::height::Rest;
use super::wants::Want;
use crate::plan::cover::union;
use crate::plan::{CcPoint, Pass};
use osculate_tools::Pose;
use rayon::prelude::*;

/// A pass is first looked at in steps of this part of the tool's radius.
const STEP: f64 = 0.25;
/// Where a chord is looked at besides its middle, as a part of it: over the corner of a face the path can bend down and up again,
/// and cross the chord's middle.
const ASIDE: f64 = 0.27;
/// Steps are not halved below this part of the tool's radius: at a concave corner of faces the path has a kink.
const SHORTEST: f64 = 1e-3;

/// The passes on all levels, to and fro.
pub(super) fn passes(ground: &Ground<'_>, wants: &[Want], levels: &[f64]) -> Vec<Pass> {
    // Wants are in the order of their levels.
    let longest = wants.iter().map(|w| w.reach + w.half[1]).fold(0.0, f64::max);
    let built: Vec<Vec<Pass>> = levels
        .par_iter()
        .map(|level| {
            let first = wants.partition_point(|w| w.at[1] < level - longest);
            let last = wants.partition_point(|w| w.at[1] <= level + longest);
            level_passes(ground, &wants[first..last], *level)
        })
        .collect();
    let mut out = Vec::with_capacity(built.iter().map(Vec::len).sum());
    for (k, level) in built.into_iter().enumerate() {
        let turned = k % 2 == 1;
        let turn = |mut p: Pass| {
            if turned {
                p.points.reverse();
            }
            p
        };
        if turned { out.extend(level.into_iter().rev().map(turn)) } else { out.extend(level) }
    }
    out
}

/// Stretches of a level that some place wants, each one pass.
fn level_passes(ground: &Ground<'_>, wants: &[Want], level: f64) -> Vec<Pass> {
    let stretches: Vec<[f64; 2]> = wants
        .iter()
        .filter(|w| (w.at[1] - level).abs() <= w.reach + w.half[1])
        .map(|w| {
            // Half the way to the next place, and as far as the tool reaches beside its contact.
            let pad = w.half[0] + w.reach;
            [w.at[0] - pad, w.at[0] + pad]
        })
        .collect();
    // A gap shorter than the tool is not worth lifting for.
    union(stretches, ground.task.cutter.radius_mm())
        .into_iter()
        .filter_map(|[from, to]| Course::through([[from, level], [to, level]]))
        .flat_map(|course| along(ground, &course))
        .collect()
}

/// A resting place on a course.
#[derive(Clone, Copy)]
struct Stop {
    /// Length along the course, mm.
    x: f64,
    rest: Rest,
}

/// Lengths at which a course is first looked at: its nodes, and steps between them.
fn looks(course: &Course, step: f64) -> Vec<f64> {
    let mut out = vec![0.0];
    for w in course.lengths().windows(2) {
        // A course of one piece is looked at in its middle, too.
        let least = if course.nodes().len() == 2 { 2.0 } else { 1.0 };
        let steps = ((w[1] - w[0]) / step).ceil().max(least);
        out.extend((1..=steps as usize).map(|k| w[0] + (w[1] - w[0]) * k as f64 / steps));
    }
    out
}

/// The passes along a course: the tool dropped onto the faces, parted where nothing is below it.
pub(super) fn along(ground: &Ground<'_>, course: &Course) -> Vec<Pass> {
    runs(ground, course).into_iter().map(|(pass, _)| pass).collect()
}

/// The same, each with the lengths of the course from which to which it leads.
pub(super) fn runs(ground: &Ground<'_>, course: &Course) -> Vec<(Pass, [f64; 2])> {
    let at = |x: f64| ground.drops.rest(course.at(x)).map(|rest| Stop { x, rest });
    let mut runs: Vec<Vec<Stop>> = vec![Vec::new()];
    let mut last = 0.0;
    // Bounded by the extent of the faces over the tool's radius.
    for (k, x) in looks(course, STEP * ground.task.cutter.radius_mm()).into_iter().enumerate() {
        let here = at(x);
        let Some(run) = runs.last_mut() else { continue };
        match (here, run.last().copied()) {
            (Some(b), Some(a)) => halve(ground, course, a, b, run),
            (Some(b), None) if k == 0 => run.push(b),
            (Some(b), None) => {
                let a = brink(&at, b, last);
                run.push(a);
                halve(ground, course, a, b, run);
            }
            (None, Some(a)) => {
                let b = brink(&at, a, x);
                halve(ground, course, a, b, run);
                runs.push(Vec::new());
            }
            (None, None) => {}
        }
        last = x;
    }
    runs.into_iter()
        .filter(|r| r.len() >= 2)
        .map(|r| (pass(ground, &thin(ground, course, &r), course), [r[0].x, r[r.len() - 1].x]))
        .collect()
}

/// The last stop from a resting place towards a place where nothing is below the tool.
fn brink(at: &dyn Fn(f64) -> Option<Stop>, mut rests: Stop, mut misses: f64) -> Stop {
    // Thirty halvings leave a billionth of the step.
    for _ in 0..30 {
        match at(0.5 * (rests.x + misses)) {
            Some(s) => rests = s,
            None => misses = 0.5 * (rests.x + misses),
        }
    }
    rests
}

/// Appends `b`, and what is needed between the last stop and it; nothing where it is the last stop.
fn halve(ground: &Ground<'_>, course: &Course, a: Stop, b: Stop, run: &mut Vec<Stop>) {
    let chord = ground.task.tolerance.chord_mm;
    let mut stack = if b.x > a.x { vec![b] } else { Vec::new() };
    let mut last = a;
    // Each halving is bounded by the shortest step.
    while let Some(next) = stack.pop() {
        let x = 0.5 * (last.x + next.x);
        let short = next.x - last.x <= SHORTEST * ground.task.cutter.radius_mm();
        let mid = if short { None } else { ground.drops.rest(course.at(x)) };
        let off = |part: f64, tip: f64| {
            (tip - last.rest.tip - (next.rest.tip - last.rest.tip) * part).abs() > 0.5 * chord
        };
        let aside = || {
            ground
                .drops
                .rest(course.at(last.x + ASIDE * (next.x - last.x)))
                .is_some_and(|r| off(ASIDE, r.tip))
        };
        match mid {
            Some(rest) if off(0.5, rest.tip) || aside() => {
                stack.push(next);
                stack.push(Stop { x, rest });
            }
            _ => {
                // Off an edge, or up a wall: past the edge at its height, and then straight down, or the other way round.
                if short && (next.rest.tip - last.rest.tip).abs() > chord {
                    let high = if next.rest.tip > last.rest.tip { next.rest } else { last.rest };
                    let x = if next.rest.tip > last.rest.tip { last.x } else { next.x };
                    run.push(Stop { x, rest: high });
                }
                run.push(next);
                last = next;
            }
        }
    }
}

/// Leaves out stops that the chord over them passes within the tolerance.
fn thin(ground: &Ground<'_>, course: &Course, run: &[Stop]) -> Vec<Stop> {
    let chord = 0.5 * ground.task.tolerance.chord_mm;
    let mut out = vec![run[0]];
    let mut at = 0;
    while at + 1 < run.len() {
        let mut next = at + 1;
        while next + 1 < run.len() && next - at < 16 && {
            let (a, b) = (&run[at], &run[next + 1]);
            course.stray(a.x, b.x) <= chord
                && run[at + 1..=next].iter().all(|s| {
                    let f = (s.x - a.x) / (b.x - a.x);
                    (s.rest.tip - (a.rest.tip + (b.rest.tip - a.rest.tip) * f)).abs() <= chord
                })
        } {
            next += 1;
        }
        out.push(run[next]);
        at = next;
    }
    out
}

fn pass(ground: &Ground<'_>, stops: &[Stop], course: &Course) -> Pass {
    let axis = ground.frame.axis;
    let points = stops
        .iter()
        .map(|s| {
            let normal = ground.drops.normal(&s.rest).unwrap_or(axis);
            let [x, y] = course.at(s.x);
            CcPoint {
                uv: s.rest.uv,
                point: s.rest.point,
                normal,
                pose: Pose { tip: ground.frame.point([x, y, s.rest.tip]), axis },
                width_mm: ground.width_mm(&s.rest, normal),
            }
        })
        .collect();
    Pass { points, closed: false }
}
