//! Time of moves with limited speed, acceleration and jerk, from rest to rest.
//!
//! With speed v, acceleration a and no jerk limit, over a distance s:
//!
//! ```text
//! t = s / v + v / a                where s >= v^2 / a (trapezoid), else t = 2 sqrt(s / a)
//! ```
//!
//! With jerk j (seven phases): reaching speed w from rest takes `w / a + a / j` where `w >= a^2 / j`, else
//! `2 sqrt(w / j)`; speeding up and slowing down cover `w` times that time; the rest runs at w = v. Where the distance
//! is too short for v, the peak speed follows from a quadratic or a cube root.

mod joint_demand;
pub mod linuxcnc;
mod lookahead;

pub use joint_demand::{FeedBlock, JointDemand, LargestStep, SlowedBlock, SlowestBlock};
pub use lookahead::{LookAhead, Stretch, block_times_s};

use std::collections::BTreeMap;

use crate::feed::capped_duration;
use crate::machine::{Drive, JointValues, Machine};

/// Time to cover `distance` (mm or rad, the sign does not matter) from rest to rest, s.
///
/// ```
/// use osculate_postproc::machine::Drive;
/// use osculate_postproc::motion::move_time_s;
///
/// let drive = Drive { velocity_per_s: 100.0, acceleration_per_s2: 1000.0, jerk_per_s3: None };
/// // A tenth of a second to speed up, one to slow down: s / v + v / a.
/// assert!((move_time_s(100.0, &drive) - 1.1).abs() < 1e-12);
/// // Too short for full speed: 2 sqrt(s / a).
/// assert!((move_time_s(-2.5, &drive) - 0.1).abs() < 1e-12);
/// // Limited jerk costs a / j more.
/// let smooth = Drive { jerk_per_s3: Some(20_000.0), ..drive };
/// assert!((move_time_s(100.0, &smooth) - 1.15).abs() < 1e-12);
/// ```
#[must_use]
pub fn move_time_s(distance: f64, drive: &Drive) -> f64 {
    let s = distance.abs();
    if s == 0.0 {
        return 0.0;
    }
    let (v, a) = (drive.velocity_per_s, drive.acceleration_per_s2);
    let Some(j) = drive.jerk_per_s3 else {
        return if s >= v * v / a { s / v + v / a } else { 2.0 * (s / a).sqrt() };
    };
    let ramp = |w: f64| if w * j >= a * a { w / a + a / j } else { 2.0 * (w / j).sqrt() };
    if s >= v * ramp(v) {
        return s / v + ramp(v);
    }
    // Peak w with w (w / a + a / j) = s, if it reaches full acceleration; else 2 w sqrt(w / j) = s.
    let shift = 0.5 * a * a / j;
    let peak = (shift * shift + s * a).sqrt() - shift;
    let peak = if peak * j >= a * a { peak } else { (0.25 * s * s * j).cbrt() };
    2.0 * ramp(peak)
}

/// Time of a rapid move from rest to rest, min, with the joint that needs longest.
#[must_use]
pub fn rapid_time_min(machine: &Machine, from: &JointValues, to: &JointValues) -> (f64, Option<usize>) {
    let mut longest = (0.0, None);
    for (place, joint) in machine.joints().iter().enumerate() {
        let t = move_time_s(to[place] - from[place], &joint.drive) / 60.0;
        if t > longest.0 {
            longest = (t, Some(place));
        }
    }
    longest
}

/// A move whose time is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedMove {
    /// Joints before.
    pub from: JointValues,
    /// Joints after.
    pub to: JointValues,
    /// A rapid move: its time follows from the drives alone.
    pub rapid: bool,
    /// Time that F asks for, min; not read in rapid moves.
    pub time_min: f64,
}

/// How long a program takes.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct ProgramTime {
    /// Feed moves, min.
    pub cutting_min: f64,
    /// Rapid moves, min.
    pub rapid_min: f64,
    /// Dwells, min.
    pub dwell_min: f64,
    /// Per joint letter, how many moves it made longer than F asks (or, rapid, how many it bounds).
    pub limited_by: BTreeMap<String, usize>,
}

impl ProgramTime {
    /// All of it, min.
    #[must_use]
    pub fn time_min(&self) -> f64 {
        self.cutting_min + self.rapid_min + self.dwell_min
    }
}

/// The longest that a program may run, min: ten years. What takes longer has a feed, a dwell or a speed in another unit.
pub const LONGEST_MIN: f64 = 10.0 * 365.0 * 24.0 * 60.0;

/// A program that nobody waits for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the program runs for {time_min:.1e} min, longer than ten years: is a feed, a dwell or a speed of the machine in another unit?"
)]
#[non_exhaustive]
pub struct TooLong {
    /// How long it runs, min.
    pub time_min: f64,
}

impl TooLong {
    /// The time, where it is one that can be waited for.
    pub(crate) fn refused(time_min: f64) -> Result<f64, Self> {
        // Not a number is no time either.
        if time_min <= LONGEST_MIN { Ok(time_min) } else { Err(Self { time_min }) }
    }
}

/// Time of a program: feed moves at their F or at the slowest joint's greatest speed, without ramps between them;
/// rapid moves from rest to rest.
///
/// ```
/// use osculate_postproc::{Machine, motion::{TimedMove, program_time}};
///
/// // C turns half around; F asks for a second, and the drive, 360 deg/s, would do it in half of that.
/// let machine = Machine::built_in("trunnion-ac")?;
/// let turn = TimedMove { from: [0.0; 5], to: [std::f64::consts::PI, 0.0, 0.0, 0.0, 0.0], rapid: false, time_min: 1.0 / 60.0 };
/// assert!((60.0 * program_time(&machine, [turn]).time_min() - 1.0).abs() < 1e-12);
/// // Asked for in a tenth of a second it takes half a second, and C is named for it.
/// let time = program_time(&machine, [TimedMove { time_min: 0.1 / 60.0, ..turn }]);
/// assert!((60.0 * time.cutting_min - 0.5).abs() < 1e-12);
/// assert_eq!(time.limited_by["C"], 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn program_time(machine: &Machine, moves: impl IntoIterator<Item = TimedMove>) -> ProgramTime {
    let mut total = ProgramTime::default();
    for m in moves {
        let place = if m.rapid {
            let (t, place) = rapid_time_min(machine, &m.from, &m.to);
            total.rapid_min += t;
            place
        } else {
            let capped = capped_duration(machine, &m.from, &m.to, m.time_min);
            total.cutting_min += capped.duration_min;
            capped.joint
        };
        if let Some(joint) = place.map(|p| &machine.joints()[p]) {
            *total.limited_by.entry(joint.letter.clone()).or_default() += 1;
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(jerk: Option<f64>) -> Drive {
        Drive { velocity_per_s: 500.0 / 3.0, acceleration_per_s2: 1000.0, jerk_per_s3: jerk }
    }

    #[test]
    fn known_profiles() {
        // Six decimals are printed; the first is 0.6 + 1/6.
        let near = |got: f64, want: f64| assert!((got - want).abs() < 6e-7, "{got} is not {want}");
        near(move_time_s(100.0, &drive(None)), 0.766_667);
        near(move_time_s(-100.0, &drive(Some(50_000.0))), 0.786_667);
        near(move_time_s(10.0, &drive(Some(50_000.0))), 0.220_998);
        near(move_time_s(0.1, &drive(Some(50_000.0))), 0.040_000);
        near(move_time_s(10.0, &drive(None)), 0.2);
        assert_eq!(move_time_s(0.0, &drive(None)), 0.0);
    }

    /// Monotone in the distance across all regimes, continuous at their borders, and never below the jerk-free time.
    #[test]
    fn regimes_join() {
        let mut before = 0.0;
        for i in 1..4000 {
            let s = 0.01 * f64::from(i);
            let t = move_time_s(s, &drive(Some(50_000.0)));
            // The steepest slope is at the first step, where t grows with the cube root of s.
            assert!(t > before && (i == 1 || t - before < 0.006), "at {s} mm: {before} then {t}");
            assert!(t >= move_time_s(s, &drive(None)));
            before = t;
        }
    }
}
