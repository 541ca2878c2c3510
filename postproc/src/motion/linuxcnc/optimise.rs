//! Looking ahead: how fast each piece of the queue may end.
//!
//! From the newest piece backwards, `v_out^2 = v_next^2 + 2 a L`, bounded by the greatest speeds of both pieces and by
//! the speed over the kink between them. The newest piece may still be cut by a blend and counts as ending at rest.

use super::Planner;
use super::segment::End;

/// Pieces that the control looks back over.
const DEPTH: usize = 50;
/// A piece this far through is left alone.
const UNDER_WAY: f64 = 0.25;
/// No piece may be passed in fewer steps.
const LEAST_STEPS: f64 = 1.02;

impl Planner {
    /// Sets the speeds at the ends of the pieces before the newest one.
    pub(super) fn optimise(&mut self) {
        let mut broken = false;
        for k in 0..=DEPTH {
            let Some(at) = self.queue.len().checked_sub(k + 1).filter(|at| *at > 0) else { return };
            let before = &self.queue[at - 1];
            if before.ends != End::Tangent {
                if broken {
                    return;
                }
                broken = true;
                continue;
            }
            if before.run.done / before.length >= UNDER_WAY
                || before.run.split.is_some()
                || before.run.blending
            {
                return;
            }
            let this = &self.queue[at];
            let kink = before.kink.unwrap_or(f64::INFINITY);
            let most = before.greatest.min(kink);
            let out = if this.final_length {
                let reach = (this.out * this.out + 2.0 * this.along() * this.length).sqrt();
                reach.min(this.greatest.min(most))
            } else {
                let half = (this.along() * this.length).sqrt();
                most.min(half.min(this.target(self.cap_mm_s)))
            };
            let settled = this.final_length && out == before.out && k > 1;
            let step_s = self.step_s;
            let this = &mut self.queue[at];
            if this.final_length {
                this.greatest = this.greatest.min(this.length / (step_s * LEAST_STEPS));
            } else {
                this.out = 0.0;
            }
            self.queue[at - 1].out = out;
            // Everything further back depends on this speed alone and has it already.
            if settled {
                return;
            }
        }
    }
}
