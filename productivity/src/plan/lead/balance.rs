//! The tilt with which strips reach as far to the left of their contact as to the right.
//!
//! A strip of two contacts has the second one on one side, and which side that is changes along a pass and with its sense: where passes lie as
//! close as the nearer side of each asks for, much of them overlaps. A degree of tilt moves the second contact across and leaves the strip as
//! wide. So at places all over the face the tilt is looked for with which the nearer side reaches furthest, and a coarse spline laid through them: it
//! need be met about only, as the lead that clears the part is found after it.

use super::lean::LocalLead;
use super::need::{Clearance, Stand};
use crate::plan::Task;
use crate::plan::extended::Extended;
use crate::rectangle::{Rectangle, lengths};
use crate::spline::Spline;
use osculate_geom::{Uv, Vec3};
use osculate_tools::Lean;
use osculate_tools::strip::{Chart, Within};
use rayon::prelude::*;

/// Distance of nodes, in radii of the tool, and fewest and most along a parameter.
const APART: f64 = 1.0;
const ALONG: [f64; 2] = [4.0, 12.0];
/// The greatest tilt, rad, and how many are tried to either side.
const MOST_RAD: f64 = 0.35;
const TRIED: i32 = 5;
/// Halvings of their distance around the best of them.
const HALVINGS: u32 = 3;
/// What the greatest tilt must gain at least: axes that lean to one side have more to turn.
const WORTH: f64 = 0.005;
/// Radius of charts, in the cutter's, and misfit accepted, of the tolerance.
const REACH: f64 = 1.2;
const MISFIT: f64 = 0.05;
/// Rounds in which the spline is brought closer to what was found.
const ROUNDS: usize = 4;

/// The tilt over a face for passes that run along `way`.
pub(super) fn tilts(
    task: &Task<'_>,
    local: &LocalLead<'_>,
    clearance: &Clearance<'_>,
    rectangle: &Rectangle,
    way: &(dyn Fn(Uv) -> Option<Vec3> + Sync),
) -> Spline {
    let held = |tilt_rad: f64| Spline::constant(rectangle, [4, 4], tilt_rad);
    match local.tilt_rad {
        Some(tilt_rad) => return held(tilt_rad),
        None if task.cutter.is_ball() => return held(0.0),
        None => {}
    }
    // Beyond the border passes go on, over the face as it would go on.
    let face = &Extended::of(task, None);
    let side = APART * task.cutter.radius_mm();
    let spans =
        lengths(task.surface, rectangle).map(|l| (l / side).clamp(ALONG[0], ALONG[1]).ceil() as usize);
    let place = |k: usize| {
        let (i, j) = (k / (spans[1] + 1), k % (spans[1] + 1));
        rectangle.domain.at(i as f64 / spans[0] as f64, j as f64 / spans[1] as f64)
    };
    let found: Vec<(Uv, f64)> = (0..(spans[0] + 1) * (spans[1] + 1))
        .into_par_iter()
        .filter_map(|k| {
            let at = place(k);
            Some((at, balanced((task, face), local, clearance, at, &way(at)?)?))
        })
        .collect();
    let mut spline = Spline::constant(rectangle, spans, 0.0);
    for _ in 0..ROUNDS {
        // Each pole by the mean of what is missing around it.
        let mut sums = vec![[0.0; 2]; spline.poles.len()];
        for (at, want) in &found {
            let missing = want - spline.jet(*at).value;
            let four = [spline.bases[0].at(at.u), spline.bases[1].at(at.v)];
            for (a, b) in (0..16).map(|n| (n / 4, n % 4)) {
                let weight = four[0].value[a] * four[1].value[b];
                let [sum, weights] = &mut sums[spline.index(four[0].index[a], four[1].index[b])];
                *sum += weight * missing;
                *weights += weight;
            }
        }
        for (pole, [sum, weights]) in spline.poles.iter_mut().zip(sums) {
            if weights > 0.0 {
                *pole += sum / weights;
            }
        }
    }
    spline
}

/// The tilt with which the nearer side of the strip at a place reaches furthest; None where there is no strip.
fn balanced(
    (task, face): (&Task<'_>, &Extended<'_>),
    local: &LocalLead<'_>,
    clearance: &Clearance<'_>,
    at: Uv,
    way: &Vec3,
) -> Option<f64> {
    let (cutter, tolerance) = (task.cutter, task.tolerance);
    if !task.surface.contains(at) {
        return None;
    }
    let chart = Chart::new(face, at, REACH * cutter.radius_mm(), MISFIT * tolerance.scallop_mm).ok()?;
    let [x, y] = chart.forms.frame.map(|e| way.dot(&e));
    let angle_rad = (y * task.surface.jet2(at).side.sign()).atan2(x);
    let within = Within { scallop_mm: tolerance.scallop_mm, gouge_mm: tolerance.gouge_mm };
    let nearer = |tilt_rad: f64| -> Option<f64> {
        let stand: Stand = clearance.stand(at, way, tilt_rad)?;
        let lead_rad = clearance.least(&stand, local.least_rad)? + clearance.missing_rad();
        let strip = chart.strip(cutter, angle_rad, Lean { lead_rad, tilt_rad }, within).ok()?;
        Some(strip.left_mm.min(strip.right_mm))
    };
    let worth = |tilt_rad: f64| {
        let cost = WORTH * (tilt_rad / MOST_RAD).powi(2);
        Some((nearer(tilt_rad)? * (1.0 - cost), tilt_rad))
    };
    // The least tilt of those that are as good.
    let tried = (0..=TRIED).flat_map(|k| [k, -k]).map(|k| MOST_RAD * f64::from(k) / f64::from(TRIED));
    let mut best = tried.filter_map(worth).reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    let mut step = MOST_RAD / f64::from(TRIED);
    for _ in 0..HALVINGS {
        step *= 0.5;
        let near = [best.1 - step, best.1 + step].into_iter().filter(|tilt| tilt.abs() <= MOST_RAD);
        best = near.filter_map(worth).fold(best, |a, b| if b.0 > a.0 { b } else { a });
    }
    Some(best.1)
}
