//! Inverse kinematics of single poses: which rotary joints point the tool as wanted, and the linear joints then.

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::Pose;

use super::chain::{self, JointValues};
use super::two_axis::{Angles, AxisUnreachable, REACH_TOLERANCE_RAD, angle_about, rotate};
use super::{Joint, Machine};
use crate::setup::Setup;

/// The rotary joints of one way to point the tool; angles in (-pi, pi].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Values of the rotary joints, outer first; entries beyond the machine's joints are zero.
    pub rotary_rad: [f64; 2],
    /// Which of the two solutions: 0 or 1.
    pub branch: usize,
}

/// All ways to point the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientations {
    /// The ways.
    candidates: [Candidate; 2],
    count: usize,
    /// Angle to the nearest pole, rad; infinite where the machine has none.
    pub pole_rad: f64,
}

impl Orientations {
    /// The ways: one or two.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates[..self.count]
    }

    fn single(rotary_rad: [f64; 2]) -> Self {
        let one = Candidate { rotary_rad, branch: 0 };
        Self { candidates: [one; 2], count: 1, pole_rad: f64::INFINITY }
    }
}

/// A joint out of its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beyond {
    /// Place of the joint.
    pub place: usize,
    /// What the joint itself reads, mm at the spindle nose or rad.
    pub at: f64,
    /// By how much it is out, mm or rad.
    pub by: f64,
}

/// What to do near a pole when a pose is solved close to given joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NearWish {
    /// The wished rotary joints.
    pub rotary_rad: [f64; 2],
    /// The axis may be off by this where that keeps the outer joint at its wish, rad.
    pub cone_rad: f64,
}

/// Near a pole an outer joint that is off by psi errs the axis by `psi sin(pole distance)`. Holding the wish is
/// considered up to this many cone angles from the pole; beyond, an exact solution is always near enough.
const HOLD_ZONE_CONES: f64 = 20.0;

/// `angle` plus the whole turns that bring it nearest to `near`.
pub(crate) fn nearest_turn(angle: f64, near: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle + turn * ((near - angle) / turn).round()
}

impl Machine {
    /// All ways to point the tool along `axis` (in the **table's** frame).
    ///
    /// ```
    /// use osculate_geom::{Unit3, Vec3};
    /// use osculate_postproc::Machine;
    ///
    /// let machine = Machine::built_in("trunnion-ac")?;
    /// let leaning = Unit3::new_normalize(Vec3::new(1.0, 0.0, 1.0));
    /// let found = machine.orientations(&leaning)?;
    /// // A leans by 45 degrees to one side or to the other, with C half a turn on.
    /// let a: Vec<f64> = found.candidates().iter().map(|c| c.rotary_rad[1].to_degrees()).collect();
    /// assert!((a[0] + a[1]).abs() < 1e-9 && (a[0].abs() - 45.0).abs() < 1e-9);
    /// // So far it is from where C has no say.
    /// assert!((found.pole_rad.to_degrees() - 45.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AxisUnreachable`] where the rotary joints cannot.
    pub fn orientations(&self, axis: &Unit3) -> Result<Orientations, AxisUnreachable> {
        let u = self.tool_axis();
        match self.rotary() {
            [] => {
                let off_rad = angle_between(&u, axis);
                if off_rad > REACH_TOLERANCE_RAD {
                    return Err(AxisUnreachable { off_rad });
                }
                Ok(Orientations::single([0.0; 2]))
            }
            [only] => {
                let b = &self.joints()[*only].direction;
                let off_rad = (angle_between(b, &u) - angle_between(b, axis)).abs();
                if off_rad > REACH_TOLERANCE_RAD {
                    return Err(AxisUnreachable { off_rad });
                }
                Ok(Orientations::single([angle_about(b, &u, axis), 0.0]))
            }
            _ => {
                let pair = self.pair().expect("a checked machine with two rotary joints has its pair");
                let found = pair.solve(axis)?;
                let candidate = |branch: usize| {
                    let Angles { outer_rad, inner_rad } = found.branches[branch];
                    Candidate { rotary_rad: [outer_rad, inner_rad], branch }
                };
                Ok(Orientations {
                    candidates: [candidate(0), candidate(1)],
                    count: 2,
                    pole_rad: found.pole_rad,
                })
            }
        }
    }

    /// The joints at which the tip is at `tip` (table's frame) with the rotary joints given; `None` where the linear
    /// joints are caught in a plane.
    pub(crate) fn with_tip(
        &self,
        rotary_rad: &[f64; 2],
        tip: &Point3,
        gauge_length_mm: f64,
    ) -> Option<JointValues> {
        let mut values = [0.0; chain::MAX_JOINTS];
        for (place, angle) in self.rotary().iter().zip(rotary_rad) {
            values[*place] = *angle;
        }
        let map = chain::tip_map(self.joints(), &self.tool_axis(), gauge_length_mm, &values);
        let [x, y, z] = map.per_joint;
        let d: Vec3 = tip - map.origin;
        let volume = x.cross(&y).dot(&z);
        // Cramer's rule: the directions are unit vectors, the volume is their conditioning.
        if volume.abs() < super::SMALLEST_VOLUME {
            return None;
        }
        let [i, j, k] = self.linear();
        values[i] = d.cross(&y).dot(&z) / volume;
        values[j] = x.cross(&d).dot(&z) / volume;
        values[k] = x.cross(&y).dot(&d) / volume;
        Some(values)
    }

    /// All joint values that put the tool at `pose` (part's frame), rotary angles in (-pi, pi], limits not applied.
    ///
    /// ```
    /// use osculate_geom::{Point3, Unit3, Vec3};
    /// use osculate_postproc::{Machine, Setup};
    /// use osculate_tools::Pose;
    ///
    /// let (machine, setup) = (Machine::built_in("head-b-table-c")?, Setup::at(Vec3::new(10.0, 0.0, 80.0), 120.0));
    /// let pose = Pose { tip: Point3::new(3.0, -4.0, 5.0), axis: Unit3::new_normalize(Vec3::new(0.3, 0.2, 1.0)) };
    /// let ways = machine.inverse(&pose, &setup)?;
    /// // Both branches bring the tool to the same pose.
    /// assert_eq!(ways.len(), 2);
    /// for joints in &ways {
    ///     let back = machine.forward(joints, &setup);
    ///     assert!((back.tip - pose.tip).norm() < 1e-9 && back.axis.angle(&pose.axis) < 1e-7);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AxisUnreachable`] where the rotary joints cannot point the tool so.
    pub fn inverse(&self, pose: &Pose, setup: &Setup) -> Result<Vec<JointValues>, AxisUnreachable> {
        let pose = setup.to_table(pose);
        let found = self.orientations(&pose.axis)?;
        Ok(found
            .candidates()
            .iter()
            .filter_map(|c| self.with_tip(&c.rotary_rad, &pose.tip, setup.gauge_length_mm))
            .collect())
    }

    /// The rotary joints for `axis` (table's frame) that lie nearest to a wish; endless joints count on.
    pub(crate) fn rotary_near(&self, axis: &Unit3, wish: &NearWish) -> Result<[f64; 2], AxisUnreachable> {
        let found = self.orientations(axis)?;
        if let (Some(pair), true) = (self.pair(), found.pole_rad <= HOLD_ZONE_CONES * wish.cone_rad) {
            let [outer_rad, inner] = wish.rotary_rad;
            let inner_rad = pair.inner_for(outer_rad, axis);
            if angle_between(&pair.axis(&Angles { outer_rad, inner_rad }), axis) <= wish.cone_rad {
                return Ok([outer_rad, nearest_turn(inner_rad, inner)]);
            }
        }
        let near = |c: &Candidate| {
            let mut q = c.rotary_rad;
            for (slot, &place) in self.rotary().iter().enumerate() {
                q[slot] = self.turned_near(place, q[slot], wish.rotary_rad[slot]);
            }
            q
        };
        let distance = |q: &[f64; 2]| (0..2).map(|k| (q[k] - wish.rotary_rad[k]).abs()).sum::<f64>();
        let all = found.candidates().iter().map(near);
        Ok(all.min_by(|p, q| distance(p).total_cmp(&distance(q))).expect("there is at least one candidate"))
    }

    /// The turn of `angle` nearest to `near` that the joint's limits allow, or the nearest at all where none does.
    pub(crate) fn turned_near(&self, place: usize, angle: f64, near: f64) -> f64 {
        let joint = &self.joints()[place];
        let best = nearest_turn(angle, near);
        if joint.excess(best) <= LIMIT_SLACK {
            return best;
        }
        let turn = std::f64::consts::TAU;
        let other = if best > near { best - turn } else { best + turn };
        if joint.excess(other) <= LIMIT_SLACK { other } else { best }
    }

    /// The first joint out of its range with a tool of this gauge length.
    pub(crate) fn out_of_limits(&self, values: &JointValues, gauge_length_mm: f64) -> Option<Beyond> {
        (0..self.joints().len()).find_map(|place| {
            let joint = &self.joints()[place];
            let at = joint.at_nose(values[place], gauge_length_mm);
            let by = joint.excess(at);
            (by > LIMIT_SLACK).then_some(Beyond { place, at, by })
        })
    }

    /// Values of the rotary joints, outer first.
    pub(crate) fn rotary_of(&self, values: &JointValues) -> [f64; 2] {
        let mut q = [0.0; 2];
        for (slot, &place) in self.rotary().iter().enumerate() {
            q[slot] = values[place];
        }
        q
    }

    /// The tool axis in the table's frame at the given rotary joints.
    pub(crate) fn axis_at(&self, rotary_rad: &[f64; 2]) -> Unit3 {
        let mut v = self.tool_axis().into_inner();
        for (slot, &place) in self.rotary().iter().enumerate().rev() {
            v = rotate(&self.joints()[place].direction, rotary_rad[slot], &v);
        }
        Unit3::new_normalize(v)
    }

    /// A range check that names the joint: used where a value is reported.
    pub(crate) fn joint_at(&self, place: usize) -> &Joint {
        &self.joints()[place]
    }
}

/// A value may pass a limit by this (mm or rad) before it counts as out: far below what any control displays, far
/// above the rounding of the kinematics at a metre.
pub(crate) const LIMIT_SLACK: f64 = 1e-9;

/// The angle between two directions, exact for small ones.
pub(crate) fn angle_between(a: &Vec3, b: &Vec3) -> f64 {
    let (sine, cosine) = (a.cross(b).norm(), a.dot(b));
    // Neighbours on a path: the series of the arc tangent, whose next term is below a part in 10^18.
    if sine < SMALL_TANGENT * cosine {
        let t = sine / cosine;
        return t * (1.0 - t * t * (1.0 / 3.0 - t * t / 5.0));
    }
    sine.atan2(cosine)
}

/// Tangents of angles whose arc tangent is three terms of its series.
const SMALL_TANGENT: f64 = 1e-3;
