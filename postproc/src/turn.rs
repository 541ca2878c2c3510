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
use osculate_tools::cl::{ClMove, ClPath, Motion};
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
    /// Joints keep their speed where the way goes on, and change it from move to move as fast as they accelerate.
    Through,
    /// No block is faster than its joints can start and stop within it, with half of their acceleration each, and one starts while the
    /// one before stops: LinuxCNC.
    ByBlocks {
        /// How far the tip may stray in a block, mm; none where the control keeps it on its line, and its slides follow.
        tip_tol_mm: Option<f64>,
    },
}

impl Pace {
    /// The least time of a feed move that takes this long by speeds, min, with the joints before the one that leads to it, at its ends, and
    /// how long that one takes at the feed asked for.
    fn least_min(
        self,
        (machine, setup): (&Machine, &Setup),
        m: &Move,
        before: Option<&JointValues>,
        [a, b]: [&JointValues; 2],
    ) -> f64 {
        let acceleration = |k: usize| machine.joints()[k].drive.acceleration_per_s2;
        match self {
            Self::Through => {
                let (Some(before), Some((_, before_min))) = (before, m.before) else { return 0.0 };
                if m.wanted_min <= 0.0 {
                    return 0.0;
                }
                let [t0, t1] = [before_min, m.wanted_min].map(|min| 60.0 * min);
                // At 1/s of the feed a change of speed is 1/s of itself in s times the time.
                let slower = |k: usize| {
                    let change = ((b[k] - a[k]) / t1 - (a[k] - before[k]) / t0).abs();
                    change / (0.5 * (t0 + t1) * acceleration(k))
                };
                let most = (0..machine.joints().len()).map(slower).fold(0.0, f64::max);
                m.wanted_min * most.sqrt()
            }
            Self::ByBlocks { tip_tol_mm } => {
                let least = |k: usize| (b[k] - a[k]).abs() / (0.5 * acceleration(k));
                let rotary = machine.rotary().iter().map(|k| least(*k)).fold(0.0, f64::max);
                let Some(tip_tol_mm) = tip_tol_mm else { return rotary.sqrt() / 60.0 };
                let square = machine.linear().into_iter().map(least).fold(rotary, f64::max);
                // As many blocks as keep the tip on its line, which they leave by the square of their length.
                let middle: JointValues = std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
                let tip = nalgebra::center(&m.ends[0].tip, &m.ends[1].tip);
                let off = (machine.forward(&middle, setup).tip - tip).norm();
                let blocks = (off / tip_tol_mm).sqrt().ceil().max(1.0);
                (square * blocks).sqrt() / 60.0
            }
        }
    }
}

/// A feed move.
#[derive(Clone, Copy)]
struct Move {
    /// Where the feed move before it begins, and how long that takes at the feed asked for, min; none where it is the first.
    before: Option<(Pose, f64)>,
    ends: [Pose; 2],
    /// How long it takes at the feed asked for, min.
    wanted_min: f64,
}

/// Feed moves evenly over the path.
fn moves_of(path: &ClPath) -> Vec<Move> {
    let wanted_min = |from: &ClMove, to: &ClMove| match to.motion {
        Motion::Feed(mm_min) if mm_min > 0.0 => Some((to.pose.tip - from.pose.tip).norm() / mm_min),
        _ => None,
    };
    let moves = &path.moves;
    let all = (1..moves.len()).filter_map(|k| {
        let before = k.checked_sub(2).and_then(|b| {
            let min = wanted_min(&moves[b], &moves[k - 1]).filter(|min| *min > 0.0)?;
            Some((moves[b].pose, min))
        });
        let wanted_min = wanted_min(&moves[k - 1], &moves[k])?;
        Some(Move { before, ends: [moves[k - 1].pose, moves[k].pose], wanted_min })
    });
    let all: Vec<Move> = all.collect();
    let every = all.len().div_ceil(MOST_MOVES).max(1);
    all.iter().step_by(every).copied().collect()
}

/// How long feed moves take when no joint is faster than it can be at this pace, min; none where the joints cannot go there.
fn time_min(moves: &[Move], machine: &Machine, setup: &Setup, pace: Pace) -> Option<f64> {
    let first = setup.to_table(&moves.first()?.ends[0]);
    let starts = machine.orientations(&first.axis).ok()?;
    let from = |start: [f64; 2]| {
        let mut rotary_rad = start;
        let mut time = 0.0;
        for m in moves {
            let mut joints = |pose: &Pose| {
                let pose = setup.to_table(pose);
                let wish = NearWish { rotary_rad, cone_rad: CONE_RAD };
                rotary_rad = machine.rotary_near(&pose.axis, &wish).ok()?;
                let joints = machine.with_tip(&rotary_rad, &pose.tip, setup.gauge_length_mm)?;
                machine.out_of_limits(&joints, setup.gauge_length_mm).is_none().then_some(joints)
            };
            let before = match &m.before {
                Some((pose, _)) if pace == Pace::Through => Some(joints(pose)?),
                _ => None,
            };
            let [a, b] = [joints(&m.ends[0])?, joints(&m.ends[1])?];
            let least_min = pace.least_min((machine, setup), m, before.as_ref(), [&a, &b]);
            time += capped_duration(machine, &a, &b, m.wanted_min).duration_min.max(least_min);
        }
        Some(time)
    };
    let times = starts.candidates().iter().filter_map(|c| from(c.rotary_rad));
    times.min_by(f64::total_cmp)
}

/// Those of some turns of the part on the table in which the feed moves of a path seem to take less time than with that of `setup` on
/// a control of this pace, by this share at least: the quickest first, of those about as quick the one that is turned least from
/// `setup`. None for machines without two rotary joints, and for paths that keep the tool's axis.
///
/// With each of them the rotary joints reach all axes of the path within their limits; where they do not as the part stands, that counts
/// as slower than any. Times are those of some of the moves at the speeds and accelerations of joints, with the place of the part as it is: a
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
    let fixed = moves.iter().all(|m| m.ends.iter().all(|p| p.axis == moves[0].ends[0].axis));
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

    /// Zig-zags over a cap around +z: normals within 0.2 rad of it, 0.05 rad apart.
    fn cap() -> ClPath {
        let mut path = ClPath::default();
        for row in -4i32..=4 {
            for k in -20..=20 {
                let k = if row % 2 == 0 { k } else { -k };
                let normal = Vec3::new(0.01 * f64::from(k), 0.05 * f64::from(row), 1.0);
                let axis = Unit3::new_normalize(normal);
                let pose = Pose { tip: Point3::from(axis.into_inner() * 50.0), axis };
                path.moves.push(ClMove { pose, motion: Motion::Feed(3000.0), aloft: false });
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

    /// LinuxCNC starts and stops the joints in every block: where the part is turned for that its own time is less than where it is turned
    /// for the speeds of joints alone, and the estimate is near to it.
    #[test]
    fn turned_for_a_control_that_goes_by_blocks() {
        let machine = Machine::built_in("trunnion-ac").unwrap();
        let setup = Setup { gauge_length_mm: 100.0, ..Setup::default() };
        let (path, turns) = (cap(), tilts(&setup.part_zero.rotation));
        let feed = crate::FeedMode::InverseTime;
        let options = crate::PostOptions::new(crate::Dialect::LinuxCnc, feed);
        let pace = Pace::ByBlocks { tip_tol_mm: Some(options.solve.tip_tol_mm) };
        let read = crate::readback::ReadOptions { timed: true, ..crate::readback::ReadOptions::default() };
        let turned = |pace: Pace| {
            let mut turned = setup;
            turned.part_zero.rotation = quicker_turns(&path, &machine, &setup, &turns, (0.05, pace))[0];
            turned
        };
        let time = |setup: &Setup| {
            let text = crate::post(&path, &machine, setup, &options).unwrap().text;
            let back =
                crate::readback::read(&text, crate::Dialect::LinuxCnc, &machine, setup, &read).unwrap();
            back.control.unwrap().cutting_min
        };
        let (by_blocks, through) = (turned(pace), turned(Pace::Through));
        let times = [&setup, &through, &by_blocks].map(time);
        assert!(times[2] < 0.98 * times[1] && times[1] < times[0], "{times:?}");
        let estimates =
            [&setup, &through, &by_blocks].map(|s| time_min(&moves_of(&path), &machine, s, pace).unwrap());
        assert!(
            estimates.iter().zip(&times).all(|(e, t)| *e > 0.5 * t && *e < 1.5 * t),
            "{estimates:?} {times:?}"
        );
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
