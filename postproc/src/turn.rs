//! How a part is turned on the table so that the joints hold its path up least.
//!
//! A tool that points along an axis of rotation leaves that joint without a say where it stands, and near it small turns of the
//! tool are large ones of the joint: a part whose normals look up is the slowest there is on a machine with a table that turns
//! about the vertical. Tilted by some tens of degrees the same path may need a tenth of the joint's way.

use crate::feed::capped_duration;
use crate::machine::{Machine, NearWish};
use crate::setup::Setup;
use nalgebra::UnitQuaternion;
use osculate_geom::Vec3;
use osculate_tools::Pose;
use osculate_tools::cl::{ClPath, Motion};
use rayon::prelude::*;

/// Feed moves of a path that are looked at.
const MOST_MOVES: usize = 4000;
/// Tilts that are tried, degrees, each in so many directions.
const TILTS_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];
const DIRECTIONS: u32 = 8;
/// Times up to this multiple of the least count as equal.
const ALIKE: f64 = 1.01;
/// What the tool may be off where that keeps a joint at rest, as in programs, rad.
const CONE_RAD: f64 = 1e-4;

/// A feed move: its ends, and how long it takes at the feed asked for, min.
type Move = ([Pose; 2], f64);

/// Feed moves evenly over the path.
fn moves_of(path: &ClPath) -> Vec<Move> {
    let all = path.moves.windows(2).filter_map(|w| match w[1].motion {
        Motion::Feed(mm_min) if mm_min > 0.0 => {
            let poses = [w[0].pose, w[1].pose];
            Some((poses, (poses[1].tip - poses[0].tip).norm() / mm_min))
        }
        _ => None,
    });
    let all: Vec<Move> = all.collect();
    let every = all.len().div_ceil(MOST_MOVES).max(1);
    all.iter().step_by(every).copied().collect()
}

/// How long feed moves take when no joint is faster than it can be, min; none where the joints cannot go there.
fn time_min(moves: &[Move], machine: &Machine, setup: &Setup) -> Option<f64> {
    let first = setup.to_table(&moves.first()?.0[0]);
    let starts = machine.orientations(&first.axis).ok()?;
    let from = |start: [f64; 2]| {
        let mut rotary_rad = start;
        let mut time = 0.0;
        for (poses, wanted_min) in moves {
            let mut ends = [None; 2];
            for (end, pose) in ends.iter_mut().zip(poses) {
                let pose = setup.to_table(pose);
                let wish = NearWish { rotary_rad, cone_rad: CONE_RAD };
                rotary_rad = machine.rotary_near(&pose.axis, &wish).ok()?;
                let joints = machine.with_tip(&rotary_rad, &pose.tip, setup.gauge_length_mm)?;
                if machine.out_of_limits(&joints).is_some() {
                    return None;
                }
                *end = Some(joints);
            }
            let [Some(a), Some(b)] = ends else { return None };
            time += capped_duration(machine, &a, &b, *wanted_min).duration_min;
        }
        Some(time)
    };
    let times = starts.candidates().iter().filter_map(|c| from(c.rotary_rad));
    times.min_by(f64::total_cmp)
}

/// Turns of the part on the table in which the feed moves of a path seem to take less time than with that of `setup`, by this share
/// at least: the quickest first, of those about as quick the least tilted. None for machines without two rotary joints, and for paths that keep the tool's axis.
///
/// Times are those of some of the moves at the speeds of joints, with the place of the part as it is: a program tells the rest.
#[must_use]
pub fn quicker_turns(
    path: &ClPath,
    machine: &Machine,
    setup: &Setup,
    share: f64,
) -> Vec<UnitQuaternion<f64>> {
    let moves = moves_of(path);
    let fixed = moves.iter().all(|m| m.0.iter().all(|p| p.axis == moves[0].0[0].axis));
    if machine.pair().is_none() || fixed {
        return Vec::new();
    }
    let stands = time_min(&moves, machine, setup);
    let turns: Vec<UnitQuaternion<f64>> = TILTS_DEG
        .iter()
        .flat_map(|deg| {
            (0..DIRECTIONS).map(move |k| {
                let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS)).sin_cos();
                UnitQuaternion::from_scaled_axis(Vec3::new(c, s, 0.0) * deg.to_radians())
            })
        })
        .collect();
    let mut found: Vec<(f64, usize)> = turns
        .par_iter()
        .enumerate()
        .filter_map(|(k, turn)| {
            let mut turned = *setup;
            turned.part_zero.rotation = turn * setup.part_zero.rotation;
            let time = time_min(&moves, machine, &turned)?;
            (stands.is_none_or(|s| time < (1.0 - share) * s)).then_some((time, k))
        })
        .collect();
    // Of those that are as good as the best the least tilted.
    let alike = ALIKE * found.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
    found.sort_by(|a, b| a.0.max(alike).total_cmp(&b.0.max(alike)).then(a.1.cmp(&b.1)));
    found.into_iter().map(|(_, k)| turns[k] * setup.part_zero.rotation).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use osculate_geom::{Point3, Unit3};
    use osculate_tools::cl::ClMove;

    /// Zig-zags over a cap around +z: normals within 0.2 rad of it, 0.05 rad apart.
    fn cap() -> ClPath {
        let mut path = ClPath::default();
        for row in -4i32..=4 {
            for k in -20..=20 {
                let k = if row % 2 == 0 { k } else { -k };
                let normal = Vec3::new(0.01 * f64::from(k), 0.05 * f64::from(row), 1.0);
                let axis = Unit3::new_normalize(normal);
                let pose = Pose { tip: Point3::from(axis.into_inner() * 50.0), axis };
                path.moves.push(ClMove { pose, motion: Motion::Feed(3000.0) });
            }
        }
        path
    }

    #[test]
    fn a_cap_that_looks_up_is_tilted_away_from_the_pole() {
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        let path = cap();
        let found = quicker_turns(&path, &machine, &setup, 0.05);
        let up = found[0] * Vec3::z();
        assert!(up.z < 0.9, "{up:?}");
        // What it promises holds in programs too.
        let time = |setup: &Setup| {
            let options = crate::PostOptions::new(crate::Dialect::Sinumerik, crate::FeedMode::InverseTime);
            crate::post(&path, &machine, setup, &options).unwrap().summary.time_min
        };
        let mut tilted = setup;
        tilted.part_zero.rotation = found[0];
        assert!(time(&tilted) < 0.9 * time(&setup), "{} {}", time(&tilted), time(&setup));
        // And there is no more to be had from there.
        assert!(quicker_turns(&path, &machine, &tilted, 0.05).is_empty());
    }

    #[test]
    fn what_turning_cannot_help_stays() {
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        // No second rotary joint.
        let three = Machine::built_in("3-axis").unwrap();
        assert!(quicker_turns(&cap(), &three, &setup, 0.05).is_empty());
        // A fixed axis.
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let mut path = cap();
        for m in &mut path.moves {
            m.pose.axis = Vec3::z_axis();
        }
        assert!(quicker_turns(&path, &machine, &setup, 0.05).is_empty());
        // Nothing to cut.
        assert!(quicker_turns(&ClPath::default(), &machine, &setup, 0.05).is_empty());
    }
}
