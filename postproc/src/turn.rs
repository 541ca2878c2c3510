//! How a part is turned on the table so that the joints hold its path up least.
//!
//! A tool that points along an axis of rotation leaves that joint without a say where it stands, and near it small turns of the
//! tool are large ones of the joint: a part whose normals look up is the slowest there is on a machine with a table that turns
//! about the vertical. Tilted by some tens of degrees the same path may need a tenth of the joint's way.

use crate::feed::capped_duration;
use crate::machine::{JointValues, Machine, NearWish};
use crate::part_turns::{axes_of, reaches_all};
use crate::setup::Setup;
use nalgebra::UnitQuaternion;
use osculate_tools::Pose;
use osculate_tools::cl::{ClPath, Motion};
use rayon::prelude::*;

/// Feed moves of a path that are looked at.
const MOST_MOVES: usize = 4000;
/// Times up to this multiple of the least count as equal.
const ALIKE: f64 = 1.01;
/// What the tool may be off where that keeps a joint at rest, as in programs, rad.
const CONE_RAD: f64 = 1e-4;

/// How a control goes from one block to the next while rotary joints turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// Joints keep their speed where the way goes on.
    Through,
    /// No block is faster than its joints can start and stop within it, with half of their acceleration each and the start of one while the one
    /// before stops: LinuxCNC.
    ByBlocks {
        /// How far the tip may stray in a block, mm; none where the control keeps it on its line, and its slides alone follow.
        tip_tol_mm: Option<f64>,
    },
}

impl Pace {
    /// The least time of a feed move, min.
    fn least_min(
        self,
        (machine, setup): (&Machine, &Setup),
        poses: &[Pose; 2],
        [a, b]: [&JointValues; 2],
    ) -> f64 {
        let Self::ByBlocks { tip_tol_mm } = self else { return 0.0 };
        let least = |k: usize| (b[k] - a[k]).abs() / (0.5 * machine.joints()[k].drive.acceleration_per_s2);
        let rotary = machine.rotary().iter().map(|k| least(*k)).fold(0.0, f64::max);
        let Some(tip_tol_mm) = tip_tol_mm else { return rotary.sqrt() / 60.0 };
        let square = machine.linear().into_iter().map(least).fold(rotary, f64::max);
        // As many blocks as keep the tip on its line, which they leave by the square of their length.
        let middle: JointValues = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        let tip = nalgebra::center(&poses[0].tip, &poses[1].tip);
        let off = (machine.forward(&middle, setup).tip - tip).norm();
        let blocks = (off / tip_tol_mm).sqrt().ceil().max(1.0);
        (square * blocks).sqrt() / 60.0
    }
}

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

/// How long feed moves take when no joint is faster than it can be at this pace, min; none where the joints cannot go there.
fn time_min(moves: &[Move], machine: &Machine, setup: &Setup, pace: Pace) -> Option<f64> {
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
                if machine.out_of_limits(&joints, setup.gauge_length_mm).is_some() {
                    return None;
                }
                *end = Some(joints);
            }
            let [Some(a), Some(b)] = ends else { return None };
            let least_min = pace.least_min((machine, setup), poses, [&a, &b]);
            time += capped_duration(machine, &a, &b, *wanted_min).duration_min.max(least_min);
        }
        Some(time)
    };
    let times = starts.candidates().iter().filter_map(|c| from(c.rotary_rad));
    times.min_by(f64::total_cmp)
}

/// Those of some turns of the part on the table in which the feed moves of a path seem to take less time than with that of `setup` on
/// a control of this pace, by this share at least: the quickest first, of those about as quick the one that is turned least from `setup`. None for machines without two
/// rotary joints, and for paths that keep the tool's axis.
///
/// With each of them the rotary joints reach all axes of the path within their limits; where they do not as the part stands, that counts
/// as slower than any. Times are those of some of the moves at the speeds of joints, with the place of the part as it is: a
/// program tells the rest.
#[must_use]
pub fn quicker_turns(
    path: &ClPath,
    machine: &Machine,
    setup: &Setup,
    turns: &[UnitQuaternion<f64>],
    (share, pace): (f64, Pace),
) -> Vec<UnitQuaternion<f64>> {
    let moves = moves_of(path);
    let fixed = moves.iter().all(|m| m.0.iter().all(|p| p.axis == moves[0].0[0].axis));
    if machine.pair().is_none() || fixed {
        return Vec::new();
    }
    let axes = axes_of(path);
    let rotation = &setup.part_zero.rotation;
    let stands =
        if reaches_all(machine, rotation, &axes) { time_min(&moves, machine, setup, pace) } else { None };
    let mut turns = turns.to_vec();
    turns.sort_by(|a, b| rotation.angle_to(a).total_cmp(&rotation.angle_to(b)));
    let mut found: Vec<(f64, usize)> = turns
        .par_iter()
        .enumerate()
        .filter_map(|(k, turn)| {
            let mut turned = *setup;
            turned.part_zero.rotation = *turn;
            let time = time_min(&moves, machine, &turned, pace)?;
            let quicker = stands.is_none_or(|s| time < (1.0 - share) * s);
            // Some of the moves may be in range where others are not.
            (quicker && reaches_all(machine, turn, &axes)).then_some((time, k))
        })
        .collect();
    // Of those that are as good as the best the least turned.
    let alike = ALIKE * found.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
    found.sort_by(|a, b| a.0.max(alike).total_cmp(&b.0.max(alike)).then(a.1.cmp(&b.1)));
    found.into_iter().map(|(_, k)| turns[k]).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::part_turns::{clamped_turns, tilts};
    use osculate_geom::{Point3, Unit3, Vec3};
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

    /// Tilts of the part as it stands.
    fn tilted(path: &ClPath, machine: &Machine, setup: &Setup) -> Vec<UnitQuaternion<f64>> {
        quicker_turns(path, machine, setup, &tilts(&setup.part_zero.rotation), (0.05, Pace::Through))
    }

    #[test]
    fn a_cap_that_looks_up_is_tilted_away_from_the_pole() {
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        let path = cap();
        let found = tilted(&path, &machine, &setup);
        let up = found[0] * Vec3::z();
        assert!(up.z < 0.9, "{up:?}");
        // What it promises holds in programs too.
        let time = |setup: &Setup| {
            let options = crate::PostOptions::new(crate::Dialect::Sinumerik, crate::FeedMode::InverseTime);
            crate::post(&path, &machine, setup, &options).unwrap().summary.time_min
        };
        let mut aside = setup;
        aside.part_zero.rotation = found[0];
        assert!(time(&aside) < 0.9 * time(&setup), "{} {}", time(&aside), time(&setup));
        // And there is no more to be had from there.
        assert!(tilted(&path, &machine, &aside).is_empty());
    }

    /// Laid on its side the cap is quick too, and can be clamped: a quarter of a turn about one axis.
    #[test]
    fn a_cap_is_laid_on_its_side() {
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        let found = quicker_turns(&cap(), &machine, &setup, &clamped_turns(&machine), (0.05, Pace::Through));
        let laid = found[0].scaled_axis();
        assert!((laid.amax() - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "{laid:?}");
        assert!((laid.norm() - laid.amax()).abs() < 1e-12, "{laid:?}");
    }

    /// One axis of a long path looks aside, at a move that no time is taken of: no turn that puts it out of reach is chosen.
    #[test]
    fn no_turn_overruns_a_joint() {
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        let cap = cap();
        let mut path = ClPath::default();
        // So many moves that every fourth is looked at.
        while path.moves.len() <= 3 * MOST_MOVES {
            path.moves.extend(cap.moves.iter().copied());
        }
        let free = tilted(&path, &machine, &setup);
        let aside = Vec3::x_axis();
        // A ends at 120 degrees, which a tilt by 30 just does not pass.
        let overrun = |turn: &UnitQuaternion<f64>| (turn * aside).z < 121f64.to_radians().cos();
        assert!(free.iter().any(overrun));
        path.moves[4 * 500 + 2].pose.axis = aside;
        let kept = tilted(&path, &machine, &setup);
        assert!(!kept.is_empty() && kept.len() < free.len() && !kept.iter().any(overrun));
    }

    #[test]
    fn what_turning_cannot_help_stays() {
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        // No second rotary joint.
        let three = Machine::built_in("3-axis").unwrap();
        assert!(tilted(&cap(), &three, &setup).is_empty());
        // A fixed axis.
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let mut path = cap();
        for m in &mut path.moves {
            m.pose.axis = Vec3::z_axis();
        }
        assert!(tilted(&path, &machine, &setup).is_empty());
        // Nothing to cut.
        assert!(tilted(&ClPath::default(), &machine, &setup).is_empty());
    }
}
