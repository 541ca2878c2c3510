//! The trajectory planner of LinuxCNC 2.9, as far as time depends on it.
//!
//! The control samples the path once per step (1 ms). Every piece runs at a trapezoid of speed along its length; F,
//! the axes' speeds and accelerations bound it per piece. How pieces meet is decided as they come in (`blend`), the
//! speed at which each may end is found by looking back from the newest piece over the queue (`optimise`), and the
//! steps themselves (`cycle`) add up to the time. Jerk is not limited. A piece with rotary motion is blended with
//! its neighbours parabolically and has half of the axes' acceleration for that: many short five-axis blocks take
//! much longer than their F says.
//!
//! Source: the behaviour of `src/emc/tp` and `src/emc/task/emccanon` of LinuxCNC 2.9, described here in formulas;
//! measured against programs timed on that control. Not modelled: arcs between a programmed circle and its
//! neighbour (such corners are blended parabolically), spindle-synchronised motion, probing, manual overrides.

mod blend;
mod canon;
mod cycle;
mod optimise;
mod segment;

use std::collections::VecDeque;

pub use canon::{Canon, CanonArc, CanonFeed, CanonMove, PathControl};
use segment::Segment;

/// Limits of the control, in mm, deg and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speeds of X, Y, Z, mm/s.
    pub velocity_mm_s: [f64; 3],
    /// Accelerations of X, Y, Z, mm/s^2.
    pub acceleration_mm_s2: [f64; 3],
    /// Speeds of the rotary axes, deg/s.
    pub velocity_deg_s: [f64; 2],
    /// Accelerations of the rotary axes, deg/s^2.
    pub acceleration_deg_s2: [f64; 2],
    /// Greatest speed of the tool along the path, mm/s.
    pub path_velocity_mm_s: f64,
}

/// Sampling time of the control, s.
const STEP_S: f64 = 0.001;

/// Most steps that speeding up to full speed may take. Drives that need longer are sampled more coarsely, so that no
/// machine file makes the model run for hours; usual ones need some hundred steps.
const MOST_RAMP_STEPS: f64 = 1e5;

/// Pieces that wait in the queue before the first one moves: more than the look-ahead sees.
const QUEUE: usize = 64;

/// The planner's queue and clock.
#[derive(Clone, Debug)]
pub(crate) struct Planner {
    queue: VecDeque<Segment>,
    step_s: f64,
    velocity_mm_s: [f64; 3],
    acceleration_mm_s2: [f64; 3],
    cap_mm_s: f64,
    /// Time of feed moves and of rapid moves so far, s.
    cutting_s: f64,
    rapid_s: f64,
    /// Time of every move so far, s, where it is asked for.
    each_s: Option<Vec<f64>>,
}

impl Planner {
    pub fn new(limits: &Limits) -> Self {
        let linear = (0..3).map(|k| limits.velocity_mm_s[k] / limits.acceleration_mm_s2[k]);
        let rotary = (0..2).map(|k| limits.velocity_deg_s[k] / limits.acceleration_deg_s2[k]);
        let ramp_s = linear.chain(rotary).fold(0.0, f64::max);
        Self {
            queue: VecDeque::with_capacity(2 * QUEUE),
            step_s: STEP_S.max(ramp_s / MOST_RAMP_STEPS),
            velocity_mm_s: limits.velocity_mm_s,
            acceleration_mm_s2: limits.acceleration_mm_s2,
            cap_mm_s: limits.path_velocity_mm_s,
            cutting_s: 0.0,
            rapid_s: 0.0,
            each_s: None,
        }
    }

    /// Adds a piece; the clock runs on as far as the queue is full.
    fn add(&mut self, mut segment: Segment) {
        segment.clamp_to_step(self.step_s);
        self.blend(&mut segment);
        self.queue.push_back(segment);
        self.optimise();
        while self.queue.len() > QUEUE {
            self.step();
        }
    }

    /// Runs the queue empty.
    pub fn run_out(&mut self) {
        if let Some(last) = self.queue.back_mut() {
            last.finalize(self.step_s);
        }
        while !self.queue.is_empty() {
            self.step();
        }
    }

    /// Time so far, s: feed moves, rapid moves.
    pub const fn clock_s(&self) -> [f64; 2] {
        [self.cutting_s, self.rapid_s]
    }
}
