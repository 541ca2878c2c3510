//! Axes between the nodes: where the tool is not clear there the poles around are moved until it is.
//!
//! A place that is not clear looks for the nearest axis that is, in rings around its own, and draws the poles around it towards that
//! axis by what they lack. What stays unclear after some rounds is counted.

use super::field::AxisField;
use crate::plan::extended::Extended;
use osculate_geom::{Point3, Surface, Unit3, Uv, Vec3, any_perpendicular};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Rounds of looking and moving.
const ROUNDS: u32 = 30;
/// Rings around an axis that is not clear, rad: the spacing of directions and what is finer.
const RINGS: [f64; 7] = [0.005, 0.01, 0.02, 0.04, 0.08, 0.12, 0.16];
/// Axes on a ring.
const AROUND: usize = 12;
/// Poles move further than they must by this part, so that rounds end.
const BEYOND: f64 = 0.25;

/// A place that is asked.
#[derive(Clone, Copy)]
struct Asked {
    at: Uv,
    point: Point3,
    normal: Unit3,
}

/// A place where the tool may not be clear.
struct Short {
    at: Uv,
    /// What its axis lacks.
    by: Vec3,
}

/// Whether a tool that touches a point with a normal is clear with an axis.
pub(super) type Clear<'a> = dyn Fn(&Point3, &Unit3, &Unit3) -> bool + Sync + 'a;

/// Brings an axis to where the joints can take it.
pub(super) type Held<'a> = dyn Fn(Unit3) -> Unit3 + Sync + 'a;

/// Moves the poles of a field until the tool is clear at places of a face; how many of them it is not at.
///
/// `held` brings an axis to where the joints can take it.
pub(super) fn settle(
    field: &mut AxisField,
    face: &Extended<'_>,
    places: &[Uv],
    (clear, held): (&Clear<'_>, &Held<'_>),
) -> usize {
    let all: Vec<Asked> = places
        .par_iter()
        .filter_map(|at| {
            let jet = face.jet2(*at);
            let normal = jet.normal().ok()?;
            let axis = field.at(*at).0;
            let is_clear = |a: &Unit3| clear(&jet.point, &normal, a);
            // Beyond the border the tool may have no place to stand at all.
            let stands =
                face.contains(*at) || is_clear(&axis) || nearest_clear(&axis, held, &is_clear).is_some();
            stands.then_some(Asked { at: *at, point: jet.point, normal })
        })
        .collect();
    let mut asked = all.clone();
    let mut best = (usize::MAX, field.spline.poles.clone());
    for round in 0..=ROUNDS {
        let short: Vec<Option<Short>> = asked
            .par_iter()
            .map(|Asked { at, point, normal }| {
                let axis = field.at(*at).0;
                (!clear(point, normal, &axis)).then(|| {
                    let near = nearest_clear(&axis, held, &|a| clear(point, normal, a));
                    Short {
                        at: *at,
                        by: near.map_or_else(Vec3::zeros, |a| a.into_inner() - axis.into_inner()),
                    }
                })
            })
            .collect();
        let count = short.iter().flatten().count();
        if asked.len() == all.len() && count < best.0 {
            best = (count, field.spline.poles.clone());
        }
        if best.0 == 0 || round == ROUNDS {
            break;
        }
        // What was clear may be so no more: every other round all are asked again.
        if round % 2 == 0 {
            let near = asked.iter().zip(&short).filter(|(_, s)| s.is_some());
            asked = near.map(|(a, _)| *a).collect();
        } else {
            asked.clone_from(&all);
        }
        move_poles(field, short.iter().flatten());
    }
    field.spline.poles = best.1;
    best.0
}

/// Moves the poles around places by the mean of what these lack, as they weigh there.
fn move_poles<'a>(field: &mut AxisField, short: impl Iterator<Item = &'a Short>) {
    let n = field.spline.poles.len();
    let mut sums = vec![(Vec3::zeros(), 0.0); n];
    for s in short {
        let ([u, v], _) = field.bases(s.at);
        for (a, b) in (0..16).map(|k| (k / 4, k % 4)) {
            let weight = u.value[a] * v.value[b];
            let (sum, all) = &mut sums[field.spline.index(u.index[a], v.index[b])];
            *sum += s.by * weight;
            *all += weight;
        }
    }
    for (pole, (sum, all)) in field.spline.poles.iter_mut().zip(sums) {
        if all > 0.0 {
            let moved = *pole + sum / all * (1.0 + BEYOND);
            *pole = moved / moved.norm().max(f64::MIN_POSITIVE);
        }
    }
}

/// The nearest clear axis on rings around one.
fn nearest_clear(axis: &Unit3, held: &Held<'_>, clear: &dyn Fn(&Unit3) -> bool) -> Option<Unit3> {
    let x = any_perpendicular(axis);
    let y = axis.cross(&x);
    RINGS.iter().find_map(|ring| {
        (0..AROUND)
            .map(|k| {
                let (s, c) = (2.0 * PI * k as f64 / AROUND as f64).sin_cos();
                held(Unit3::new_normalize(axis.into_inner() + (x.into_inner() * c + y * s) * ring.tan()))
            })
            .find(|a| clear(a))
    })
}
