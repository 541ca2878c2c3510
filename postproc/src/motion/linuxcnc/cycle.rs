//! One step of the control: the pieces under way move on.
//!
//! The speed of the next step is the largest one from which the piece can still reach its final speed,
//! `v = -a dt / 2 + sqrt(v_out^2 + a (2 s - v dt) + (a dt / 2)^2)`, never above the target. A step in which a piece
//! ends is split between it and the next one.

use super::Planner;
use super::blend::blend_speeds;
use super::segment::{End, Segment};

/// Speeds that are one to the control, mm/s.
const SAME_SPEED: f64 = 1e-8;
/// A piece ends within this of its end, mm.
const AT_END: f64 = 1e-12;
/// Times that are none, s.
const NO_TIME: f64 = 1e-12;
/// Pieces shorter than this, s, speed up evenly instead of by a trapezoid.
const RAMP_S: f64 = 0.01;
/// Steps of one piece that are made singly; usual pieces need some hundred. Bounds the work for absurd limits.
const MOST_STEPS: u32 = 1_000_000;
/// Steps left over where many steps at one speed are made at once.
const MARGIN_STEPS: f64 = 4.0;

impl Planner {
    /// One step; the queue is not empty.
    pub(super) fn step(&mut self) {
        let Some(mut first) = self.queue.pop_front() else { return };
        let mut next = self.queue.pop_front();
        let mut steps = 1.0;
        if !first.run.active {
            self.activate(&mut first);
        }
        if let Some(split) = first.run.split {
            first.run.done = first.length;
            first.run.over = true;
            if let Some(next) = &mut next {
                let mut dt = self.step_s;
                if first.ends == End::Tangent {
                    dt -= split;
                    next.run.speed = first.run.split_speed;
                }
                let after = self.queue.front();
                self.advance(next, after, dt);
            }
        } else {
            steps = self.skipped(&first);
            if steps > 1.0 {
                first.run.done += steps * self.step_s * first.run.speed;
            } else {
                self.regular(&mut first, next.as_mut());
                first.run.steps = first.run.steps.saturating_add(1);
                first.run.over |= first.run.steps > MOST_STEPS;
            }
        }
        let clock = if first.rapid { &mut self.rapid_s } else { &mut self.cutting_s };
        *clock += steps * self.step_s;
        if let Some(spent) = self.each_s.as_mut().and_then(|each| each.get_mut(first.of)) {
            *spent += steps * self.step_s;
        }
        if let Some(next) = next {
            self.queue.push_front(next);
        }
        if !first.run.over {
            self.queue.push_front(first);
        }
    }

    /// How many steps nothing changes in: full speed, far from the end.
    fn skipped(&self, s: &Segment) -> f64 {
        let v = s.run.speed;
        let full = (v - s.target(self.cap_mm_s)).abs() < SAME_SPEED * v;
        if !full || v <= 0.0 || s.run.ramp || s.run.blending {
            return 1.0;
        }
        let stop = 0.5 * v * v / s.along();
        ((s.to_go() - stop) / (v * self.step_s) - MARGIN_STEPS).floor().max(1.0)
    }

    fn activate(&self, s: &mut Segment) {
        let v = s.run.speed + s.out.min(s.target(self.cap_mm_s));
        let t = 2.0 * s.to_go() / v;
        s.run.ramp = s.ends == End::Tangent && !s.rapid && t < RAMP_S && s.to_go() > 0.0;
        s.run.active = true;
        s.run.blending = false;
        s.run.slowing = false;
    }

    fn regular(&mut self, first: &mut Segment, next: Option<&mut Segment>) {
        self.advance(first, next.as_deref(), self.step_s);
        let Some(next) = next else { return };
        if first.ends != End::Parabolic {
            return;
        }
        let targets = [first.target(self.cap_mm_s), next.target(self.cap_mm_s)];
        let (v1, v2, _) = blend_speeds(first, next, targets);
        first.run.blend_speed = v1;
        next.run.blend_speed = v2;
        first.run.blending |= first.run.slowing && first.run.speed < v1;
        if first.run.blending {
            self.advance(next, None, self.step_s);
        }
    }

    /// Moves a piece on by `dt` seconds.
    fn advance(&self, s: &mut Segment, next: Option<&Segment>, dt: f64) {
        let target = s.target(self.cap_mm_s);
        let out = if s.ends == End::Tangent {
            let beyond = next.map_or(0.0, |n| n.target(self.cap_mm_s));
            s.out.min(target.min(beyond))
        } else {
            0.0
        };
        let a = s.along();
        let (acceleration, wanted) = if s.run.ramp && s.ends == End::Tangent && out >= SAME_SPEED {
            let mean = 0.5 * (s.run.speed + out);
            let t = if mean > SAME_SPEED { (s.to_go() / mean).max(1e-16) } else { 1e-16 };
            (((out - s.run.speed) / t).clamp(-a, a), out)
        } else {
            let half = 0.5 * a * dt;
            let under = out * out + a * (2.0 * s.to_go() - s.run.speed * dt);
            let most = -half + if under > 0.0 { (under + half * half).sqrt() } else { 0.0 };
            (((most.min(target) - s.run.speed) / dt.max(NO_TIME)).clamp(-a, a), most)
        };
        let v = s.run.speed + acceleration * dt;
        if v < 0.0 {
            if s.to_go() < s.run.speed * dt {
                s.run.done = s.length;
            }
        } else {
            s.run.done = (s.run.done + 0.5 * (v + s.run.speed) * dt).clamp(0.0, s.length);
        }
        s.run.speed = v.max(0.0);
        s.run.slowing = (wanted - s.run.speed).abs() < SAME_SPEED && acceleration < 0.0;
        self.look_at_end(s, out);
    }

    /// Whether the piece ends within the next step, and how fast.
    fn look_at_end(&self, s: &mut Segment, out: f64) {
        let left = s.to_go();
        let at_rest = matches!(s.ends, End::Stop | End::Exact);
        if left <= AT_END {
            s.run.done = s.length;
            s.run.split = Some(0.0);
            s.run.split_speed = s.run.speed;
            s.run.over |= at_rest;
            return;
        }
        if at_rest {
            return;
        }
        let mean = 0.5 * (s.run.speed + out);
        if mean <= SAME_SPEED {
            return;
        }
        let mut t = left / mean;
        let mut v = out;
        let most = s.along();
        let needed = (out - s.run.speed) / t;
        if needed.abs() > most {
            let a = most.copysign(needed);
            let ratio = s.run.speed / a;
            let under = ratio * ratio + 2.0 / a * left;
            if under < 0.0 {
                return;
            }
            t = -ratio + if a > 0.0 { under.sqrt() } else { -under.sqrt() };
            v = s.run.speed + t * a;
        }
        if t < NO_TIME {
            s.run.done = s.length;
            s.run.split = Some(0.0);
            s.run.split_speed = v;
        } else if t < self.step_s {
            s.run.split = Some(t);
            s.run.split_speed = v;
        }
    }
}
