//! Passes along levels: where the tool must go on each, and the path there at the chord tolerance.

use super::super::cover::union;
use super::height::Rest;
use super::wants::Want;
use super::{CcPoint, Ground, Pass};
use osculate_tools::Pose;
use rayon::prelude::*;

/// A pass is first looked at in steps of this part of the tool's radius.
const STEP: f64 = 0.25;
/// Steps are not halved below this part of the tool's radius: at a concave corner of faces the path has a kink.
const SHORTEST: f64 = 1e-3;

/// The passes on all levels, to and fro.
pub(super) fn passes(ground: &Ground<'_>, wants: &[Want], levels: &[f64]) -> Vec<Pass> {
    // Wants are in the order of their levels.
    let longest = wants.iter().map(|w| w.reach + w.half).fold(0.0, f64::max);
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
        .filter(|w| (w.at[1] - level).abs() <= w.reach + w.half)
        .map(|w| {
            // Half the way to the next place, and as far as the tool reaches beside its contact.
            let pad = w.half + w.reach;
            [w.at[0] - pad, w.at[0] + pad]
        })
        .collect();
    // A gap shorter than the tool is not worth lifting for.
    union(stretches, ground.task.cutter.radius_mm())
        .into_iter()
        .flat_map(|range| stretch(ground, range, level))
        .collect()
}

/// A resting place on a level.
#[derive(Clone, Copy)]
struct Stop {
    x: f64,
    rest: Rest,
}

fn stretch(ground: &Ground<'_>, [from, to]: [f64; 2], level: f64) -> Vec<Pass> {
    let at = |x: f64| ground.drops.rest([x, level]).map(|rest| Stop { x, rest });
    let radius = ground.task.cutter.radius_mm();
    let steps = ((to - from) / (STEP * radius)).ceil().max(2.0);
    let mut runs: Vec<Vec<Stop>> = vec![Vec::new()];
    let mut last = from;
    // Bounded by the extent of the faces over the tool's radius.
    for k in 0..=steps as usize {
        let x = from + (to - from) * k as f64 / steps;
        let here = at(x);
        let Some(run) = runs.last_mut() else { continue };
        match (here, run.last().copied()) {
            (Some(b), Some(a)) => halve(ground, level, a, b, run),
            (Some(b), None) if k == 0 => run.push(b),
            (Some(b), None) => {
                let a = brink(&at, b, last);
                run.push(a);
                halve(ground, level, a, b, run);
            }
            (None, Some(a)) => {
                let b = brink(&at, a, x);
                halve(ground, level, a, b, run);
                runs.push(Vec::new());
            }
            (None, None) => {}
        }
        last = x;
    }
    runs.into_iter().filter(|r| r.len() >= 2).map(|r| pass(ground, &thin(ground, &r), level)).collect()
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
fn halve(ground: &Ground<'_>, level: f64, a: Stop, b: Stop, run: &mut Vec<Stop>) {
    let chord = ground.task.tolerance.chord_mm;
    let mut stack = if b.x > a.x { vec![b] } else { Vec::new() };
    let mut last = a;
    // Each halving is bounded by the shortest step.
    while let Some(next) = stack.pop() {
        let x = 0.5 * (last.x + next.x);
        let short = next.x - last.x <= SHORTEST * ground.task.cutter.radius_mm();
        let mid = if short { None } else { ground.drops.rest([x, level]) };
        match mid {
            Some(rest) if (rest.tip - 0.5 * (last.rest.tip + next.rest.tip)).abs() > 0.5 * chord => {
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
fn thin(ground: &Ground<'_>, run: &[Stop]) -> Vec<Stop> {
    let chord = 0.5 * ground.task.tolerance.chord_mm;
    let mut out = vec![run[0]];
    let mut at = 0;
    while at + 1 < run.len() {
        let mut next = at + 1;
        while next + 1 < run.len() && next - at < 16 && {
            let (a, b) = (&run[at], &run[next + 1]);
            run[at + 1..=next].iter().all(|s| {
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

fn pass(ground: &Ground<'_>, stops: &[Stop], level: f64) -> Pass {
    let axis = ground.frame.axis;
    let points = stops
        .iter()
        .map(|s| {
            let normal = ground.drops.normal(&s.rest).unwrap_or(axis);
            CcPoint {
                uv: s.rest.uv,
                point: s.rest.point,
                normal,
                pose: Pose { tip: ground.frame.point([s.x, level, s.rest.tip]), axis },
                width_mm: ground.width_mm(&s.rest, normal),
            }
        })
        .collect();
    Pass { points, closed: false }
}
