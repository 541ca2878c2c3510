//! Tool axes as the rotary joints of a machine see them: which ones are reached, and how long a turn takes.
//!
//! Axes are given in the **part's** frame, as paths give them; the rotation of the part takes them to the frame of the table's
//! reference point. An axis is reached where some branch and some whole turn of the rotary joints leads there within all their
//! limits, as in [`Machine::solve`]. A machine without rotary joints has one axis, one with a single rotary joint a circle of
//! them. Linear joints are not asked: they depend on the place of the tip.

use nalgebra::UnitQuaternion;
use osculate_geom::Unit3;

use crate::machine::{Machine, REACH_TOLERANCE_RAD, angle_about, angle_between, nearest_turn};
use crate::sequence::each_turn;
use crate::solve_options::SolveOptions;

/// The rotary joints of a machine as the axes of a tool see them, for a part that stands turned on the table.
///
/// ```
/// use nalgebra::UnitQuaternion;
/// use osculate_geom::{Unit3, Vec3};
/// use osculate_postproc::{Machine, Orienting};
///
/// let machine = Machine::built_in("trunnion-ac")?;
/// let joints = Orienting::new(&machine, &UnitQuaternion::identity());
/// let up = Vec3::z_axis();
/// let tilted = Unit3::new_normalize(Vec3::new(1.0, 0.0, 1.0));
/// // The tool along the table's axis leaves C free: only A turns, by 45 degrees at 180 degrees a second.
/// let turn_s = joints.turn_s(&up, &tilted).expect("both axes are in range");
/// assert!((turn_s - 0.25).abs() < 1e-6);
/// // A ends at 120 degrees.
/// let below = Unit3::new_normalize(Vec3::new(0.5, 0.0, -1.0));
/// assert!(!joints.reaches(&below));
/// assert!((joints.nearest(&below).angle(&up).to_degrees() - 120.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Orienting<'a> {
    machine: &'a Machine,
    part: UnitQuaternion<f64>,
}

/// What the joints may stand at for one axis.
struct Stances {
    /// Rotary joints within their limits, outer first; endless ones in (-pi, pi].
    rotary_rad: Vec<[f64; 2]>,
    /// The axis lies along the outer joint, which may stand anywhere.
    outer_free: bool,
}

impl<'a> Orienting<'a> {
    /// The joints of `machine` with a part that `part` turns from its own frame to that of the table's reference point, as the
    /// rotation of [`crate::Setup::part_zero`].
    #[must_use]
    pub fn new(machine: &'a Machine, part: &UnitQuaternion<f64>) -> Self {
        Self { machine, part: *part }
    }

    /// Whether the rotary joints reach the axis within their limits. Axes within 1e-7 rad of the border count as reached, as in
    /// posting.
    #[must_use]
    pub fn reaches(&self, axis: &Unit3) -> bool {
        !self.stances(axis).rotary_rad.is_empty()
    }

    /// The least time in s in which the rotary joints turn the tool from one axis to another, each at the greatest speed of its
    /// drive, over all branches and turns of both; `None` where one of the two is not reached.
    ///
    /// It is a lower bound: speeding up and slowing down, and what the linear joints do meanwhile, come on top. Between the two axes the
    /// tool need not stay in their plane. An axis along the outer joint leaves that one free, so that it costs nothing there.
    #[must_use]
    pub fn turn_s(&self, from: &Unit3, to: &Unit3) -> Option<f64> {
        self.quickest(from, to).map(|(took_s, _)| took_s)
    }

    /// By how much each rotary joint turns in the quickest way from one axis to another, rad, not negative, as [`turn_s`](Self::turn_s)
    /// counts; in the order of [`Machine::rotary`], zero for one that is not there. `None` where one of the two axes is not reached.
    #[must_use]
    pub fn turns_rad(&self, from: &Unit3, to: &Unit3) -> Option<[f64; 2]> {
        self.quickest(from, to).map(|(_, turns)| turns)
    }

    /// The quickest way between two axes: its time, s, and the turn of each joint, rad.
    fn quickest(&self, from: &Unit3, to: &Unit3) -> Option<(f64, [f64; 2])> {
        let (from, to) = (self.stances(from), self.stances(to));
        let first = usize::from(from.outer_free || to.outer_free);
        let between = |a: &[f64; 2], b: &[f64; 2]| {
            let mut turns = [0.0; 2];
            let joints = self.machine.rotary().iter().enumerate().skip(first);
            let times = joints.map(|(k, &place)| {
                let joint = self.machine.joint_at(place);
                let step = b[k] - a[k];
                let step = if joint.is_endless() { nearest_turn(step, 0.0) } else { step };
                turns[k] = step.abs();
                turns[k] / joint.drive.velocity_per_s
            });
            (times.fold(0.0, f64::max), turns)
        };
        let pairs = from.rotary_rad.iter().flat_map(|a| to.rotary_rad.iter().map(move |b| between(a, b)));
        pairs.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The axes that a machine of three or four axes reaches, no further than `step_rad` of its rotary joint apart; `None` with two
    /// rotary joints, whose axes fill a part of the sphere.
    #[must_use]
    pub fn line(&self, step_rad: f64) -> Option<Vec<Unit3>> {
        let back = self.part.inverse();
        match *self.machine.rotary() {
            [] => Some(vec![back * self.machine.tool_axis()]),
            [only] => {
                let joint = self.machine.joint_at(only);
                let (from, to) = match (joint.min, joint.max) {
                    (Some(from), Some(to)) if to - from < std::f64::consts::TAU => (from, to),
                    _ => (-std::f64::consts::PI, std::f64::consts::PI),
                };
                let steps = ((to - from) / step_rad).ceil().max(1.0);
                let at = |k: usize| from + (to - from) * (k as f64 / steps);
                Some((0..=steps as usize).map(|k| back * self.machine.axis_at(&[at(k), 0.0])).collect())
            }
            _ => None,
        }
    }

    /// The axis nearest to `axis` that the rotary joints reach within their limits: `axis` itself where they reach it,
    /// else one on a border, where rounding decides whether it is reached.
    #[must_use]
    pub fn nearest(&self, axis: &Unit3) -> Unit3 {
        if self.reaches(axis) {
            return *axis;
        }
        // The angle to the wish is least where it cannot change: at a limit of a joint, or where both joints move the tool the
        // same way, which is at the borders of the reachable cone.
        let wish = self.part * axis;
        let stances = match *self.machine.rotary() {
            [] => vec![[0.0; 2]],
            [only] => {
                let outer =
                    angle_about(&self.machine.joint_at(only).direction, &self.machine.tool_axis(), &wish);
                vec![[self.inside(only, outer), 0.0]]
            }
            _ => self.borders(&wish),
        };
        let axes = stances.iter().map(|rotary_rad| self.machine.axis_at(rotary_rad));
        let nearest = axes.min_by(|a, b| angle_between(a, &wish).total_cmp(&angle_between(b, &wish)));
        self.part.inverse() * nearest.unwrap_or_else(|| self.machine.tool_axis())
    }

    /// The joints nearest to a wish (table's frame) along every border of what two rotary joints reach.
    fn borders(&self, wish: &Unit3) -> Vec<[f64; 2]> {
        let (Some(pair), &[outer, inner]) = (self.machine.pair(), self.machine.rotary()) else {
            return Vec::new();
        };
        let [b, a] = [outer, inner].map(|place| self.machine.joint_at(place));
        // At the borders of the cone the tool lies in the plane of both joints.
        let flat = angle_about(&a.direction, &self.machine.tool_axis(), &b.direction);
        let inners = [a.min, a.max, Some(flat), Some(flat + std::f64::consts::PI)];
        let along_inner = inners.into_iter().flatten().map(|inner_rad| {
            let inner_rad = self.inside(inner, inner_rad);
            let tool = self.machine.axis_at(&[0.0, inner_rad]);
            [self.inside(outer, angle_about(&b.direction, &tool, wish)), inner_rad]
        });
        let along_outer = [b.min, b.max]
            .into_iter()
            .flatten()
            .map(|outer_rad| [outer_rad, self.inside(inner, pair.inner_for(outer_rad, wish))]);
        along_inner.chain(along_outer).collect()
    }

    /// The value of a rotary joint within its limits whose direction is nearest to that of an angle.
    fn inside(&self, place: usize, angle_rad: f64) -> f64 {
        let joint = self.machine.joint_at(place);
        let turned = match (joint.min, joint.max) {
            (Some(min), Some(max)) => nearest_turn(angle_rad, 0.5 * (min + max)),
            (Some(end), None) | (None, Some(end)) => {
                let turned = nearest_turn(angle_rad, end);
                let turn = std::f64::consts::TAU.copysign(if joint.min.is_some() { 1.0 } else { -1.0 });
                if joint.excess(turned) > 0.0 { turned + turn } else { turned }
            }
            (None, None) => angle_rad,
        };
        turned.max(joint.min.unwrap_or(turned)).min(joint.max.unwrap_or(f64::INFINITY))
    }

    fn stances(&self, axis: &Unit3) -> Stances {
        let mut rotary_rad = Vec::new();
        let Ok(found) = self.machine.orientations(&(self.part * axis)) else {
            return Stances { rotary_rad, outer_free: false };
        };
        // As near to a pole as programs hold the outer joint.
        let outer_free = found.pole_rad <= SolveOptions::default().singular_cone_rad || self.is_turntable();
        for candidate in found.candidates() {
            each_turn(self.machine, candidate, 1, |inner| {
                if outer_free {
                    rotary_rad.push([0.0, inner]);
                } else {
                    each_turn(self.machine, candidate, 0, |outer| rotary_rad.push([outer, inner]));
                }
            });
        }
        Stances { rotary_rad, outer_free }
    }

    /// Whether the only rotary joint turns about the tool: it may stand anywhere.
    fn is_turntable(&self) -> bool {
        let &[only] = self.machine.rotary() else { return false };
        let sine = self.machine.joint_at(only).direction.cross(&self.machine.tool_axis()).norm();
        sine <= REACH_TOLERANCE_RAD
    }
}

#[cfg(test)]
#[path = "orienting_tests.rs"]
mod tests;
