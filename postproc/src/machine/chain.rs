//! Joint chains: forward kinematics.
//!
//! With the joints in order from the part to the tool and every sign read as "tool relative to part", the pose of the
//! tool in the table's frame is one product, no matter which joints carry the part and which the tool:
//!
//! ```text
//! T = D_1(q_1) ... D_k(q_k) . shift(L u) . D_(k+1)(q_(k+1)) ... D_n(q_n),    tip = T (-L u),   axis = T u
//! ```
//!
//! `D` is a shift along or a rotation about the joint's direction, k the last table joint, `u` the tool axis at zero
//! and L the gauge length (tip to gauge point). The shift in the middle is the control's tool length compensation: at
//! zero rotation the linear joints read the place of the **tip**, whatever the tool's length.
//!
//! What the slides themselves know, and with them ends of travel and places of the machine's own frame, is the gauge point at the
//! spindle nose: [`Joint::at_nose`] has the one from the other.

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::Pose;

use super::spec::CarriedSide;

/// The most joints a chain may have: three linear and two rotary.
pub const MAX_JOINTS: usize = 5;

/// Joint values in chain order, mm and rad; entries beyond the machine's joints are zero.
pub type JointValues = [f64; MAX_JOINTS];

/// What a joint does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Values in mm.
    Linear,
    /// Values in rad.
    Rotary,
}

/// What a joint's drive can do; mm or rad per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Greatest speed, per s.
    pub velocity_per_s: f64,
    /// Greatest acceleration, per s^2.
    pub acceleration_per_s2: f64,
    /// Greatest jerk, per s^3; absent: acceleration may step.
    pub jerk_per_s3: Option<f64>,
}

/// A joint of a checked machine.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Joint {
    /// Name in NC programs.
    pub letter: String,
    /// Slide or rotary axis.
    pub kind: JointKind,
    /// Decimals of its positions in NC programs.
    pub decimals: usize,
    /// What it carries.
    pub side: CarriedSide,
    /// Direction of positive values, tool relative to part (the sense is already applied).
    pub direction: Unit3,
    /// A point on the axis of rotation; see [`super::spec`] for where it is measured from.
    pub point: Point3,
    /// By how much a slide is ahead of its word for each mm of gauge length: the word is of the tip, the slide carries the nose. Zero for
    /// rotary joints.
    pub nose_per_mm: f64,
    /// Smallest value, mm or rad; of a slide at the spindle nose.
    pub min: Option<f64>,
    /// Largest value, mm or rad; of a slide at the spindle nose.
    pub max: Option<f64>,
    /// Value where the control's own coordinate reads zero, mm or rad, at the spindle nose, where the machine file says it.
    pub machine_zero: Option<f64>,
    /// Where `G28` leads, in the control's own coordinate, where the machine file says it.
    pub home: Option<f64>,
    /// Where it is out of the way, in the control's own coordinate, where the machine file says it.
    pub retract: Option<f64>,
    /// Speed, acceleration, jerk.
    pub drive: Drive,
}

impl Joint {
    /// Whether the joint turns without end.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.kind == JointKind::Rotary && self.min.is_none() && self.max.is_none()
    }

    /// What the joint itself reads where a program's word for it is `value` and the tool in hand has this gauge length, mm: the control
    /// adds the length to the word of a slide along the tool.
    ///
    /// ```
    /// use osculate_postproc::Machine;
    ///
    /// // A program's Z is of the tip; the slide carries the nose, 100 mm above it. X is the same for both.
    /// let machine = Machine::built_in("trunnion-ac")?;
    /// let [x, _, z] = machine.linear().map(|place| &machine.joints()[place]);
    /// assert_eq!((x.at_nose(5.0, 100.0), z.at_nose(5.0, 100.0)), (5.0, 105.0));
    /// assert_eq!(z.word_at(105.0, 100.0), 5.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn at_nose(&self, value: f64, gauge_length_mm: f64) -> f64 {
        value + self.nose_per_mm * gauge_length_mm
    }

    /// The word for a place of the joint itself: the other way round.
    #[must_use]
    pub fn word_at(&self, at_nose: f64, gauge_length_mm: f64) -> f64 {
        at_nose - self.nose_per_mm * gauge_length_mm
    }

    /// By how much the joint itself ([`Self::at_nose`]) is out of its range; zero inside.
    #[must_use]
    pub fn excess(&self, value: f64) -> f64 {
        let below = self.min.map_or(0.0, |m| m - value);
        let above = self.max.map_or(0.0, |m| value - m);
        below.max(above).max(0.0)
    }

    /// The value at the spindle nose where the control's own coordinate reads zero: as the machine file says; else the top of a slide called
    /// Z, not known where that has no limit, and zero of any other joint.
    #[must_use]
    pub fn own_zero(&self) -> Option<f64> {
        let top = self.kind == JointKind::Linear && self.letter == "Z";
        self.machine_zero.or(if top { self.max } else { Some(0.0) })
    }

    /// `mm` or `deg`.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        match self.kind {
            JointKind::Linear => "mm",
            JointKind::Rotary => "deg",
        }
    }

    /// The value in the unit of [`Self::unit`].
    #[must_use]
    pub fn shown(&self, value: f64) -> f64 {
        match self.kind {
            JointKind::Linear => value,
            JointKind::Rotary => value.to_degrees(),
        }
    }
}

/// A rotation and a shift, as columns of the rotated basis; composed from the part outwards.
#[derive(Clone, Copy, Debug)]
struct Frame {
    columns: [Vec3; 3],
    origin: Vec3,
}

impl Frame {
    fn identity() -> Self {
        Self { columns: [Vec3::x(), Vec3::y(), Vec3::z()], origin: Vec3::zeros() }
    }

    fn turn(&self, v: &Vec3) -> Vec3 {
        self.columns[0] * v.x + self.columns[1] * v.y + self.columns[2] * v.z
    }

    fn shifted(mut self, by: &Vec3) -> Self {
        self.origin += self.turn(by);
        self
    }

    fn rotated(self, axis: &Unit3, point: &Point3, angle_rad: f64) -> Self {
        let at = self.shifted(&point.coords);
        let (s, c) = angle_rad.sin_cos();
        let columns = [Vec3::x(), Vec3::y(), Vec3::z()]
            .map(|e| at.turn(&(e * c + axis.cross(&e) * s + axis.into_inner() * (axis.dot(&e) * (1.0 - c)))));
        Self { columns, origin: at.origin }.shifted(&(-point.coords))
    }
}

/// The tip in the table's frame as an affine function of the linear joints, and the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TipMap {
    /// Tip with all linear joints at zero.
    pub origin: Point3,
    /// How the tip moves per mm of each linear joint, in chain order.
    pub per_joint: [Vec3; 3],
    /// Tool axis.
    pub axis: Unit3,
}

/// The tip as a function of the linear joints at fixed rotary joints (`values` of linear joints are not read).
pub(crate) fn tip_map(joints: &[Joint], tool: &Unit3, gauge_length_mm: f64, values: &JointValues) -> TipMap {
    let mut frame = Frame::identity();
    let mut per_joint = [Vec3::zeros(); 3];
    let mut linear = 0;
    let reach = tool.into_inner() * gauge_length_mm;
    let mut crossed_bed = false;
    for (joint, value) in joints.iter().zip(values) {
        if joint.side == CarriedSide::Head && !crossed_bed {
            frame = frame.shifted(&reach);
            crossed_bed = true;
        }
        match joint.kind {
            JointKind::Linear => {
                per_joint[linear] = frame.turn(&joint.direction);
                linear += 1;
            }
            JointKind::Rotary => frame = frame.rotated(&joint.direction, &joint.point, *value),
        }
    }
    if !crossed_bed {
        frame = frame.shifted(&reach);
    }
    let tip = frame.shifted(&(-reach)).origin;
    TipMap { origin: Point3::from(tip), per_joint, axis: Unit3::new_normalize(frame.turn(tool)) }
}

/// The pose of the tool in the table's frame.
pub(crate) fn forward(joints: &[Joint], tool: &Unit3, gauge_length_mm: f64, values: &JointValues) -> Pose {
    let map = tip_map(joints, tool, gauge_length_mm, values);
    let mut tip = map.origin;
    let mut linear = 0;
    for (joint, value) in joints.iter().zip(values) {
        if joint.kind == JointKind::Linear {
            tip += map.per_joint[linear] * *value;
            linear += 1;
        }
    }
    Pose { tip, axis: map.axis }
}
