//! The way between two programmed places: straight or an arc, and as short straight moves of the tool.
//!
//! On an arc the two linear words of the plane turn about the centre, its third word and the rotary words move
//! linearly along with the angle (a helix). Counter-clockwise is from the plane's first axis to its second: X to Y
//! (G17), Z to X (G18), Y to Z (G19).

use osculate_tools::Pose;

use super::state::Known;
use crate::feed::Step;
use crate::linearize::slerp;
use crate::machine::angle_between;

/// An arc in a plane of two linear words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Slots of the plane's first and second axis.
    pub plane: [usize; 2],
    pub centre: [f64; 2],
    pub radius_mm: f64,
    pub start_rad: f64,
    /// Counter-clockwise positive.
    pub sweep_rad: f64,
}

/// What a block says of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ArcWords {
    pub clockwise: bool,
    pub plane: [usize; 2],
    /// I J K of the plane's axes, from the start, mm.
    pub centre_mm: [Option<f64>; 2],
    /// R: negative for the larger arc.
    pub radius_mm: Option<f64>,
}

/// An end point may lie off the circle by this, mm, as controls allow for rounding to three decimals.
const LARGEST_RADIUS_ERROR_MM: f64 = 0.01;

/// Ends nearer than this, mm, are one point, and the arc between them a full circle.
const SAME_POINT_MM: f64 = 1e-9;

impl Arc {
    /// The arc between two places, or by how much (mm) they are on different circles.
    pub fn new(from: &Known, to: &Known, words: &ArcWords) -> Result<Self, f64> {
        let at = |k: &Known| [k.linear[words.plane[0]], k.linear[words.plane[1]]];
        let (a, b) = (at(from), at(to));
        let chord = [b[0] - a[0], b[1] - a[1]];
        let length = chord[0].hypot(chord[1]);
        let turn = if words.clockwise { -1.0 } else { 1.0 };
        let centre = match words.radius_mm {
            Some(r) => {
                let under = r * r - 0.25 * length * length;
                if length < SAME_POINT_MM || under < -LARGEST_RADIUS_ERROR_MM * r.abs() {
                    return Err((0.5 * length - r.abs()).abs());
                }
                // To the left of the chord for the smaller counter-clockwise arc.
                let h = turn * r.signum() * under.max(0.0).sqrt() / length;
                [a[0] + 0.5 * chord[0] - h * chord[1], a[1] + 0.5 * chord[1] + h * chord[0]]
            }
            None => [a[0] + words.centre_mm[0].unwrap_or(0.0), a[1] + words.centre_mm[1].unwrap_or(0.0)],
        };
        let spoke = |p: [f64; 2]| [p[0] - centre[0], p[1] - centre[1]];
        let (p, q) = (spoke(a), spoke(b));
        let (radius_mm, end_mm) = (p[0].hypot(p[1]), q[0].hypot(q[1]));
        if radius_mm < SAME_POINT_MM || (radius_mm - end_mm).abs() > LARGEST_RADIUS_ERROR_MM {
            return Err((radius_mm - end_mm).abs());
        }
        let full = std::f64::consts::TAU;
        let angle = turn * (p[0] * q[1] - p[1] * q[0]).atan2(p[0] * q[0] + p[1] * q[1]);
        let angle = if length < SAME_POINT_MM { full } else { angle.rem_euclid(full) };
        let start_rad = p[1].atan2(p[0]);
        Ok(Self { plane: words.plane, centre, radius_mm, start_rad, sweep_rad: turn * angle })
    }
}

/// A block's way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    pub from: Known,
    pub to: Known,
    pub arc: Option<Arc>,
}

impl Way {
    /// The place at share `t` of the block.
    pub fn at(&self, t: f64) -> Known {
        let mut place = self.from.between(&self.to, t);
        if let Some(arc) = self.arc.filter(|_| t < 1.0) {
            let (s, c) = (arc.start_rad + t * arc.sweep_rad).sin_cos();
            place.linear[arc.plane[0]] = arc.centre[0] + arc.radius_mm * c;
            place.linear[arc.plane[1]] = arc.centre[1] + arc.radius_mm * s;
        }
        place
    }

    /// What F is read over.
    pub fn step(&self) -> Step {
        let mut step = self.from.step_to(&self.to);
        if let Some(arc) = self.arc {
            let rise =
                (0..3).filter(|k| !arc.plane.contains(k)).map(|k| self.to.linear[k] - self.from.linear[k]);
            step.linear_mm = (arc.radius_mm * arc.sweep_rad).hypot(rise.sum());
        }
        step
    }

    /// The largest angle that anything turns by on the way, rad.
    pub fn turned_rad(&self) -> f64 {
        let rotary = self.step().rotary_rad;
        rotary[0].abs().max(rotary[1].abs()).max(self.arc.map_or(0.0, |a| a.sweep_rad.abs()))
    }

    /// Poses along the way with the share of the block at which each is reached, the start left out: straight moves
    /// between them stay within the tolerances (mm and rad). None where that takes more than [`MOST_PIECES`].
    pub fn densified(&self, pose: &dyn Fn(&Known) -> Pose, tolerance: [f64; 2]) -> Option<Vec<(f64, Pose)>> {
        // Looking at three inner points only sees pieces of up to an eighth of a turn reliably. The cap is 512 turns.
        let pieces = (self.turned_rad() / std::f64::consts::FRAC_PI_4).ceil().clamp(1.0, 4096.0);
        let mut cut = Cut { way: self, pose, tolerance, poses: Vec::new() };
        let mut a = (0.0, pose(&self.from));
        let mut k = 1.0;
        while k <= pieces {
            let t = k / pieces;
            let b = (t, pose(&self.at(t)));
            if !cut.halve(a, b, MOST_HALVINGS) {
                return None;
            }
            a = b;
            k += 1.0;
        }
        Some(cut.poses)
    }
}

/// Halvings of a piece at most: 2^-30 of it is below any tolerance.
const MOST_HALVINGS: u32 = 30;

/// Straight moves of one block at most: a full turn of 10 m radius within the finest tolerance in use has fewer.
pub(super) const MOST_PIECES: usize = 100_000;

struct Cut<'a> {
    way: &'a Way,
    pose: &'a dyn Fn(&Known) -> Pose,
    tolerance: [f64; 2],
    poses: Vec<(f64, Pose)>,
}

impl Cut<'_> {
    /// False where there are too many pieces.
    fn halve(&mut self, a: (f64, Pose), b: (f64, Pose), left: u32) -> bool {
        let [tip_mm, axis_rad] = self.tolerance;
        let near = [0.25, 0.5, 0.75].into_iter().all(|s| {
            let true_pose = (self.pose)(&self.way.at(a.0 + (b.0 - a.0) * s));
            let tip = a.1.tip + (b.1.tip - a.1.tip) * s;
            // The deviation between the looked-at points is below 4/3 of what they see, as for a parabola.
            (true_pose.tip - tip).norm() <= 0.75 * tip_mm
                && angle_between(&true_pose.axis, &slerp(&a.1.axis, &b.1.axis, s)) <= 0.75 * axis_rad
        });
        if near || left == 0 {
            self.poses.push(b);
            return self.poses.len() <= MOST_PIECES;
        }
        let t = 0.5 * (a.0 + b.0);
        let middle = (t, (self.pose)(&self.way.at(t)));
        self.halve(a, middle, left - 1) && self.halve(middle, b, left - 1)
    }
}
