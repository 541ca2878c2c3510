//! Standoff of one moving body above one sample, exactly.
//!
//! On the sample's line `p + s n` the body covers at every instant t an interval `[entry, exit]` of s. With
//! D(t, s) the signed distance of the line's point to the body, the interval is where D <= 0. Three cases:
//!
//! - `entry >= 0`: the body is above and leaves `entry`.
//! - `exit < 0`: it lies wholly beneath, on the far side of a thin wall, and does not touch this side.
//! - between: the sample itself is cut away, a gouge as deep as the body must back off along the normal to
//!   clear the sample, `min(-entry, exit)`. For a tool over the surface the exit is beyond its upper end and
//!   this is `-entry`; for one that pokes through from behind it is the exit, which grows from zero as it
//!   breaks through.
//!
//! The least of this over the motion is a root of `f(s) = min over t of D(t, s)` or, for gouges of depth h,
//! of `min over t of max(D(t, -h), D(t, h))`. For a motion that does not turn both are convex, and Newton's
//! method on a convex function from outside is monotone: the entry is approached from below, and a motion
//! that cannot cut lower than what is already cut is given up as soon as the iterate passes that height.

use super::Swept;
use super::body::Body;
use super::piece::{Piece, moving};
use crate::cutter::Line;
use osculate_geom::roots::{End, bracketed};

/// Height of the body's boundary above the sample that counts as touching, mm, per mm of coordinates: the
/// rounding of a distance is some ten units in the last place of the coordinates it is computed from.
const TOUCH: f64 = 1e-14;
/// Accuracy of the instant of deepest reach relative to the piece. The distance is flat there; on sharp rims
/// it is not, and this keeps the height within 1e-11 mm for motions of 10 mm.
pub(super) const EXACT: f64 = 1e-12;
/// Newton steps on f: quadratic at a crossing, halving at a grazing double root (from 1 mm to TOUCH in 25).
const MAX_STEPS: u32 = 60;

/// One body on one piece of a motion, seen from one line.
pub(super) struct Passage<'a> {
    pub body: Body<'a>,
    pub swept: &'a Swept,
    pub piece: Piece,
    pub line: Line,
    /// Accuracy of instants relative to the piece, such as [`EXACT`].
    pub instant: f64,
    /// Distance that counts as touching where it is more than rounding, mm.
    pub met: f64,
}

/// D and its derivatives by instant and height.
#[derive(Clone, Copy)]
struct Instant {
    distance: f64,
    by_t: f64,
    by_s: f64,
}

/// f and its derivative.
#[derive(Clone, Copy)]
struct Lowest {
    value: f64,
    slope: f64,
}

/// The function of instant and height whose minimum over the motion is taken.
#[derive(Clone, Copy)]
enum Probe {
    /// D(t, s).
    Height,
    /// max(D(t, -h), D(t, h)).
    Gouge,
}

impl Passage<'_> {
    fn instant(&self, probe: Probe, t: f64, s: f64) -> Instant {
        let m = moving(self.swept, t);
        let at = |s: f64| {
            let w = self.line.point(s) - m.pose.tip;
            let near = self.body.near(&w, &m.pose.axis);
            let by_t = -near.gradient.dot(&(m.tip_rate + m.turn.cross(&w)));
            Instant { distance: near.distance, by_t, by_s: near.gradient.dot(&self.line.direction) }
        };
        match probe {
            Probe::Height => at(s),
            Probe::Gouge => {
                let (low, high) = (at(-s), at(s));
                if low.distance >= high.distance { Instant { by_s: -low.by_s, ..low } } else { high }
            }
        }
    }

    /// f and f' at height or depth `s`.
    fn lowest(&self, probe: Probe, s: f64) -> Lowest {
        let at = |i: Instant| Lowest { value: i.distance, slope: i.by_s };
        let [lo, hi] = self.piece.range;
        let mut falling = self.instant(probe, lo, s);
        if falling.by_t >= 0.0 {
            return at(falling);
        }
        let mut rising = self.instant(probe, hi, s);
        if rising.by_t <= 0.0 {
            return at(rising);
        }
        let ends = [End { x: lo, f: falling.by_t }, End { x: hi, f: rising.by_t }];
        let mut still = None;
        // The bracket is kept here as well: only its two sides make a slope of f at a kink. Where it does not
        // converge they are still an instant that happens.
        let _ = bracketed(ends[0], ends[1], self.instant * (hi - lo), |t| {
            let i = self.instant(probe, t, s);
            if i.by_t < 0.0 {
                falling = i;
            } else if i.by_t > 0.0 {
                rising = i;
            } else {
                still = Some(i);
            }
            i.by_t
        });
        if let Some(i) = still {
            return at(i);
        }
        // f' is the mixture of both sides' slopes whose derivative by t vanishes (Danskin).
        let share = rising.by_t / (rising.by_t - falling.by_t);
        let slope = share * falling.by_s + (1.0 - share) * rising.by_s;
        Lowest { value: falling.distance.min(rising.distance), slope }
    }

    /// The height that this passage leaves above the sample, mm, where it is lower than `current`; negative
    /// is a gouge, followed down to `-depth`.
    pub fn height(&self, current: f64, depth: f64) -> Option<f64> {
        let size = self.line.origin.coords.amax() + self.swept.from.tip.coords.amax() + self.body.above_mm;
        let touch = (TOUCH * (1.0 + size)).max(self.met);
        let here = self.lowest(Probe::Height, 0.0);
        if here.value > touch {
            return self.entry(here, current, touch);
        }
        let height = -self.gouge(depth, touch);
        (height < current).then_some(height)
    }

    /// The entry above the sample, from f at the sample; None where there is none below `current`.
    fn entry(&self, sample: Lowest, current: f64, touch: f64) -> Option<f64> {
        let turns = self.swept.from.axis != self.swept.to.axis;
        let (mut s, mut here, mut outside) = (0.0, sample, 0.0);
        for _ in 0..MAX_STEPS {
            if here.value > 0.0 {
                if here.slope >= 0.0 {
                    return None;
                }
                outside = s;
            }
            // Only a turning motion, over which f is not quite convex, leads inside with f not falling.
            s = if here.slope < 0.0 { s - here.value / here.slope } else { 0.5 * (outside + s) };
            if s >= current {
                if !turns {
                    return None;
                }
                s = current;
            }
            here = self.lowest(Probe::Height, s);
            if s == current && here.value >= -touch {
                return None;
            }
            if here.value.abs() <= touch {
                break;
            }
        }
        Some(s)
    }

    /// Depth of the gouge at a sample that is inside.
    fn gouge(&self, depth: f64, touch: f64) -> f64 {
        let (mut h, mut here) = (depth, self.lowest(Probe::Gouge, depth));
        if here.value <= 0.0 {
            return depth;
        }
        for _ in 0..MAX_STEPS {
            if here.slope <= 0.0 || here.value.abs() <= touch {
                break;
            }
            h -= here.value / here.slope;
            if h <= 0.0 {
                return 0.0;
            }
            here = self.lowest(Probe::Gouge, h);
        }
        h
    }
}
