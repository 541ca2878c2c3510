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
//!
//! Such a motion moves the line's point straight past the body, so that D_tt is known in closed form as well: with c the
//! corner radius, `(D + c)^2` is convex where D + c > 0 and least where D is, and Newton's method on its derivative meets the deepest instant
//! under a ball in one step, elsewhere in a few. What convexity leaves below an instant, `|D_t|` times the room towards the
//! minimum, tells that it is met; where it is not, at kinks, the derivative's sign is bracketed.

use super::Swept;
use super::body::Body;
use super::piece::{Piece, moving};
use crate::cutter::Line;
use osculate_geom::Vec3;
use osculate_geom::roots::{End, bracketed};

/// Height of the body's boundary above the sample that counts as touching, mm, per mm of coordinates: the
/// rounding of a distance is some ten units in the last place of the coordinates it is computed from.
const TOUCH: f64 = 1e-14;
/// Accuracy of the instant of deepest reach relative to the piece. The distance is flat there; on sharp rims
/// it is not, and this keeps the height within 1e-11 mm for motions of 10 mm.
pub(super) const EXACT: f64 = 1e-12;
/// Newton steps on f: quadratic at a crossing, halving at a grazing double root (from 1 mm to TOUCH in 25).
const MAX_STEPS: u32 = 60;
/// Newton steps towards the deepest instant before its bracket is closed by other means.
const MOST_NEWTON: u32 = 8;
/// An instant is the deepest where nothing is deeper by this part of the distance that counts as touching.
const DEEPEST: f64 = 0.5;

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

    /// f and f' at height or depth `s`; the search begins at the instant `guess` and leaves there the deepest one.
    fn lowest(&self, probe: Probe, s: f64, guess: &mut f64) -> Lowest {
        if self.swept.from.axis == self.swept.to.axis {
            let found = match probe {
                Probe::Height => self.straight(s, guess),
                Probe::Gouge => self.straight_gouge(s, guess),
            };
            if let Some(found) = found {
                return found;
            }
        }
        self.bracketed(probe, s)
    }

    /// Height that counts as touching, mm.
    fn touch(&self) -> f64 {
        let size = self.line.origin.coords.amax() + self.swept.from.tip.coords.amax() + self.body.above_mm;
        (TOUCH * (1.0 + size)).max(self.met)
    }

    /// D and f' at height `s` and instant `t` of a motion that does not turn, D_t, and Newton's step towards the least D.
    fn glance(&self, s: f64, t: f64, rate: &Vec3) -> (Lowest, f64, f64) {
        let (from, way) = (&self.swept.from, self.line.direction);
        let w = self.line.point(s) - (from.tip + rate * t);
        let along = w.dot(&from.axis);
        let radial = w - from.axis.into_inner() * along;
        let square = radial.norm_squared();
        let local = self.body.local(square.sqrt(), along);
        // Components of the rate: out from the axis, times the radius, and up it.
        let (out, up) = (radial.dot(rate), rate.dot(&from.axis));
        let by_t = -(local.outwards * out + local.by_z * up);
        let slope = local.outwards * radial.dot(&way) + local.by_z * from.axis.dot(&way);
        // The meridian's curvature along it, and the circle's around the axis.
        let bend = if square > 0.0 {
            let flat = rate.norm_squared() - up * up;
            let tangential = local.outwards * square * up - local.by_z * out;
            local.outwards * (flat - out * out / square) + local.bend * tangential * tangential / square
        } else {
            0.0
        };
        let lift = local.distance + self.body.cutter.corner_mm();
        let step = if lift > 0.0 { by_t * lift / (by_t * by_t + lift * bend) } else { by_t / bend };
        (Lowest { value: local.distance, slope }, by_t, step)
    }

    /// f and f' at height `s` of a motion that does not turn; None where Newton's steps do not meet the deepest instant.
    fn straight(&self, s: f64, guess: &mut f64) -> Option<Lowest> {
        let rate = self.swept.to.tip - self.swept.from.tip;
        let enough = DEEPEST * self.touch();
        let [mut lo, mut hi] = self.piece.range;
        let mut t = guess.clamp(lo, hi);
        for _ in 0..MOST_NEWTON {
            let (here, by_t, step) = self.glance(s, t, &rate);
            // The least D lies on the side to which D falls; at an end of the piece there is no room for it.
            let room = if by_t > 0.0 { t - lo } else { hi - t };
            if by_t.abs() * room <= enough {
                *guess = t;
                return Some(here);
            }
            if by_t > 0.0 {
                hi = t;
            } else {
                lo = t;
            }
            t = (t - step).clamp(lo, hi);
        }
        None
    }

    /// The same for the depth `h` of a gouge, where one of its two ends is the outer one at that end's deepest instant.
    fn straight_gouge(&self, h: f64, guess: &mut f64) -> Option<Lowest> {
        let rate = self.swept.to.tip - self.swept.from.tip;
        for (end, sign) in [(-h, -1.0), (h, 1.0)] {
            let mut t = *guess;
            let here = self.straight(end, &mut t)?;
            if self.glance(-end, t, &rate).0.value <= here.value {
                *guess = t;
                return Some(Lowest { slope: sign * here.slope, ..here });
            }
        }
        None
    }

    /// f and f' at height or depth `s`, from a bracket of the deepest instant.
    fn bracketed(&self, probe: Probe, s: f64) -> Lowest {
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
        let touch = self.touch();
        let mut instant = self.abreast();
        let here = self.lowest(Probe::Height, 0.0, &mut instant);
        if here.value > touch {
            return self.entry(here, current, touch, &mut instant);
        }
        let height = -self.gouge(depth, touch, &mut instant);
        (height < current).then_some(height)
    }

    /// The instant at which the tip of a motion that does not turn is next to the sample, where the search for the deepest begins.
    fn abreast(&self) -> f64 {
        let rate = self.swept.to.tip - self.swept.from.tip;
        let square = rate.norm_squared();
        if square > 0.0 { (self.line.origin - self.swept.from.tip).dot(&rate) / square } else { 0.0 }
    }

    /// The entry above the sample, from f at the sample; None where there is none below `current`.
    ///
    /// Over a turning motion f is not quite convex, and the least distance found may be one of several: Newton's steps are
    /// kept between a height outside and one inside then, and where they do not converge the height inside, which the
    /// body does reach, is the answer.
    fn entry(&self, sample: Lowest, current: f64, touch: f64, instant: &mut f64) -> Option<f64> {
        let turns = self.swept.from.axis != self.swept.to.axis;
        let (mut s, mut here, mut outside) = (0.0, sample, 0.0);
        let mut inside = None;
        for _ in 0..MAX_STEPS {
            if here.value > 0.0 {
                if here.slope >= 0.0 && inside.is_none() {
                    return None;
                }
                outside = s;
            } else {
                inside = Some(s);
            }
            let step = s - here.value / here.slope;
            s = match inside {
                Some(inside) if !(here.slope < 0.0 && step > outside && step < inside) => {
                    0.5 * (outside + inside)
                }
                _ => step,
            };
            if s >= current {
                if !turns {
                    return None;
                }
                s = current;
            }
            here = self.lowest(Probe::Height, s, instant);
            if s == current && here.value >= -touch {
                return None;
            }
            if here.value.abs() <= touch {
                return Some(s);
            }
        }
        inside.filter(|s| *s < current)
    }

    /// Depth of the gouge at a sample that is inside, between a depth that is reached and one that is not.
    fn gouge(&self, depth: f64, touch: f64, instant: &mut f64) -> f64 {
        let (mut h, mut here) = (depth, self.lowest(Probe::Gouge, depth, instant));
        if here.value <= 0.0 {
            return depth;
        }
        let (mut reached, mut beyond) = (0.0, depth);
        for _ in 0..MAX_STEPS {
            if here.value.abs() <= touch {
                return h;
            }
            if here.value > 0.0 {
                beyond = h;
            } else {
                reached = h;
            }
            let step = h - here.value / here.slope;
            h = if here.slope > 0.0 && step > reached && step < beyond {
                step
            } else {
                0.5 * (reached + beyond)
            };
            here = self.lowest(Probe::Gouge, h, instant);
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, CutterSpec, Pose};
    use osculate_geom::{Point3, Unit3};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        /// Newton's steps and the bracket of D_t find the same least distance.
        #[test]
        fn steps_and_bracket_agree(
            kind in 0usize..4,
            r in 0.0..=1.0f64,
            [from, to, p] in prop::array::uniform3(prop::array::uniform3(-8.0..8.0f64)),
            [a, n] in prop::array::uniform2(prop::array::uniform3(-1.0..1.0f64)),
            s in -3.0..3.0f64
        ) {
            let axes = [a, n].map(|v| Unit3::try_new(Vec3::from(v), 0.1));
            let [Some(axis), Some(direction)] = axes else { return Ok(()) };
            let (diameter_mm, length_mm) = (10.0, 12.0);
            let spec = match kind {
                0 => CutterSpec::Ball { diameter_mm, length_mm },
                1 => CutterSpec::Flat { diameter_mm, length_mm },
                2 => CutterSpec::Toroidal { diameter_mm, corner_radius_mm: 4.0 * r + 0.5, length_mm },
                _ => CutterSpec::Barrel {
                    diameter_mm,
                    barrel_radius_mm: 10.0 + 2.0 * r,
                    corner_radius_mm: 1.0 + 3.0 * r,
                    length_mm,
                },
            };
            let cutter = Cutter::try_from(spec).unwrap();
            let pose = |tip: [f64; 3]| Pose { tip: Point3::from(tip), axis };
            let swept = Swept { from: pose(from), to: pose(to), rapid: false, block: 0 };
            let passage = Passage {
                body: Body { cutter: &cutter, above_mm: 0.0, tool: 0, intrudes: false },
                swept: &swept,
                piece: Piece { motion: 0, range: [0.0, 1.0] },
                line: Line { origin: Point3::from(p), direction },
                instant: EXACT,
                met: 0.0,
            };
            for (probe, s) in [(Probe::Height, s), (Probe::Gouge, s.abs())] {
                let mut instant = passage.abreast();
                let here = passage.lowest(probe, s, &mut instant).value;
                // What counts as touching, and what an instant that is off by EXACT of 28 mm leaves at a rim.
                let apart = (here - passage.bracketed(probe, s).value).abs();
                prop_assert!(apart <= passage.touch() + 28.0 * EXACT, "{apart:e}");
            }
        }
    }
}
